// SPDX-License-Identifier: BSD-3-Clause
#include "IO/MeshShare.hh"

#include <algorithm>

#include "HalfFace/Errors.hh"
#include "IO/VtuSlices.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

using Open = std::unique_ptr<MeshShare> (*)(const std::filesystem::path&, const Processes&, std::uint64_t);

Open opener(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".vtu") return vtu_share;
  if (extension == ".mesh" || extension == ".meshb") return medit_share;
  if (extension == ".msh") return gmsh_share;
  return nullptr;
}

/// Even ranges of the arrays.
class VtuShare : public MeshShare {
 public:
  VtuShare(const std::filesystem::path& path, const Processes& processes, std::uint64_t at_once)
      : file_(path), rank_(processes.rank), at_once_(at_once) {
    for (std::uint64_t r = 0; r <= processes.n; ++r) {
      begins_.push_back((r * file_.n_points() + processes.n - 1) / processes.n);
      item_begins_.push_back((r * file_.n_items() + processes.n - 1) / processes.n);
    }
    VtuSlices::Kinds mine;
    for (std::size_t i = 0; i < n_portions(); ++i) mine += file_.kinds(begin(i), begin(i + 1));
    const auto all = processes.gather(std::span<const VtuSlices::Kinds>(&mine, 1));
    for (std::size_t r = 0; r < rank_; ++r) next_ += all[r];
    for (const VtuSlices::Kinds& kinds : all) n_cells_ += kinds.cells;
    names_ = file_.names();
    point_fields_ = file_.point_fields();
    cell_fields_ = file_.cell_fields();
    notes_ = file_.notes();
  }

  SharePoints points() override {
    SharePoints points;
    points.first = begins_[rank_];
    const std::uint64_t end = begins_[rank_ + 1];
    points.points = file_.points(points.first, end);
    points.labels = file_.vertex_labels(points.first, end);
    points.fixed = file_.fixed(points.first, end);
    points.rows = file_.point_rows(points.first, end);
    return points;
  }
  std::size_t n_portions() const override {
    return static_cast<std::size_t>((item_begins_[rank_ + 1] - item_begins_[rank_] + at_once_ - 1) /
                                    at_once_);
  }
  /// In turn, from the first.
  ShareItems portion(std::size_t i) override {
    ShareItems items = file_.items(begin(i), begin(i + 1));
    items.cells.first = next_.cells;
    items.triangles.first = next_.triangles;
    items.edges.first = next_.edges;
    next_ += {items.cells.corners.size(), items.triangles.corners.size(), items.edges.corners.size()};
    return items;
  }

 private:
  std::uint64_t begin(std::size_t i) const {
    return std::min(item_begins_[rank_] + i * at_once_, item_begins_[rank_ + 1]);
  }

  VtuSlices file_;
  std::size_t rank_;
  std::uint64_t at_once_;
  std::vector<std::uint64_t> item_begins_;
  VtuSlices::Kinds next_;  // numbers of the next ones
};

}  // namespace

std::unique_ptr<MeshShare> vtu_share(const std::filesystem::path& path, const Processes& processes,
                                     std::uint64_t at_once) {
  return std::make_unique<VtuShare>(path, processes, at_once);
}

bool has_shares(const std::filesystem::path& path) { return opener(path) != nullptr; }

std::unique_ptr<MeshShare> open_share(const std::filesystem::path& path, const Processes& processes,
                                      std::uint64_t at_once) {
  const Open open = opener(path);
  HFR_REQUIRE(open != nullptr, path.string() + ": files of this type cannot be read in ranges");
  std::unique_ptr<MeshShare> share = open(path, processes, at_once);
  HFR_REQUIRE(share->n_points() > 0 && share->n_cells() > 0, path.string() + ": it has no cells");
  return share;
}

}  // namespace hfr::io
