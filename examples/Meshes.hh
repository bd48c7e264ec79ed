// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_EXAMPLES_MESHES_HH
#define HFR_EXAMPLES_MESHES_HH

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/HalfFace/TetMesh.hh>
#include <hfremesh/IO/ReadWrite.hh>
#include <vector>

namespace example {

/// Where meshes are written to that somebody may want to look at; nowhere without a name. Pictures are made
/// by `hfremesh report before.vtu after.vtu --png both.png`.
class Folder {
 public:
  explicit Folder(const char* name) {
    if (!name) return;
    path_ = name;
    std::filesystem::create_directories(path_);
  }
  bool is_wanted() const { return !path_.empty(); }
  const std::filesystem::path& path() const { return path_; }
  void write(const char* name, const hfr::TetMesh& mesh) const {
    if (is_wanted()) hfr::io::write(path_ / name, mesh);
  }

 private:
  std::filesystem::path path_;
};

/// The cube from -1 to 1 with an ellipsoid of these half-axes left out of its middle: about 5.8 n³ cells. The
/// cells follow rays from the ellipsoid to the cube.
inline hfr::TetMesh box_round_ellipsoid(hfr::Index n, hfr::Vec3 half_axes) {
  const hfr::generate::Arrays grid = hfr::generate::box({n, n, n}, {-1, -1, -1}, {1, 1, 1});
  const auto size = [](hfr::Vec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); };
  // A cube of about the ellipsoid's size is left out of the grid, and its surface drawn onto the ellipsoid.
  const double cube =
      2.0 * std::max(1.0, std::round(0.25 * (n % 2) + n * 0.15)) / n + (n % 2 ? 1.0 / n : 0.0);
  std::vector<hfr::Vec3> points;
  std::vector<hfr::Index> number(grid.points.size(), hfr::VertexHandle::kInvalid);
  std::vector<std::array<hfr::Index, 4>> cells;
  for (const auto& corners : grid.cells) {
    hfr::Vec3 middle;
    for (hfr::Index v : corners) middle = middle + 0.25 * grid.points[v];
    if (size(middle) < cube) continue;
    auto& cell = cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      hfr::Index& v = number[corners[k]];
      if (v == hfr::VertexHandle::kInvalid) {
        v = static_cast<hfr::Index>(points.size());
        const hfr::Vec3 p = grid.points[corners[k]];
        const double t = std::max(0.0, (size(p) - cube) / (1 - cube));
        const hfr::Vec3 q = (1 / hfr::norm(p)) * p;
        points.push_back((1 - t) * hfr::Vec3{half_axes.x * q.x, half_axes.y * q.y, half_axes.z * q.z} +
                         t * p);
      }
      cell[k] = v;
    }
  }
  return hfr::build(points, cells);
}

}  // namespace example

#endif
