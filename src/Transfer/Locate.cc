// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Locate.hh"

#include <algorithm>
#include <limits>
#include <vector>

#include "Transfer/SharedVolume.hh"

namespace hfr {
namespace {

// A coordinate above this counts as inside: what rounding leaves of a point on a face.
constexpr double kOnFace = -1e-10;
constexpr int kPatience = 256;                // cells of a walk that come no nearer to the point
constexpr std::size_t kLargestSearch = 4096;  // cells of the layers round about

/// Coordinates of the point in the cell; false for a flat one.
bool weigh(const TetMesh& mesh, CellHandle c, Vec3 point, std::array<double, 4>& weights) {
  const TetPoints t = points_of(mesh, c);
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], e3 = t[3] - t[0], x = point - t[0];
  const double whole = dot(e1, cross(e2, e3));
  if (whole == 0) return false;
  weights[1] = dot(x, cross(e2, e3)) / whole;
  weights[2] = dot(x, cross(e3, e1)) / whole;
  weights[3] = dot(x, cross(e1, e2)) / whole;
  weights[0] = 1 - weights[1] - weights[2] - weights[3];
  return std::all_of(weights.begin(), weights.end(), [](double w) { return w - w == 0; });
}

double least(const std::array<double, 4>& weights) {
  return *std::min_element(weights.begin(), weights.end());
}

/// The best place among cells that were looked at.
class Best {
 public:
  Best(const TetMesh& mesh, Vec3 point, CutFaces* cut) : mesh_(mesh), point_(point), cut_(cut) {}

  /// True when the cell has the point.
  bool look_at(CellHandle c) {
    std::array<double, 4> weights{};
    if (!weigh(mesh_, c, point_, weights)) return false;
    const double value = least(weights);
    if (value > value_) {
      value_ = value;
      place_ = {c, weights, value >= kOnFace};
    }
    return place_.inside;
  }
  /// The cell behind a face; invalid where there is none, which is noted where one is missing.
  CellHandle behind(HalfFaceHandle h) {
    const HalfFaceHandle m = mesh_.opposite_halfface(h);
    if (m.is_valid()) return cell_of(m);
    if (cut_ && cut_->is_cut[h.idx()] != 0) cut_->met.push_back(h);
    return {};
  }
  bool is_cut_short() const { return cut_ && !cut_->met.empty(); }
  double value() const { return value_; }
  const Place& place() const { return place_; }

 private:
  const TetMesh& mesh_;
  Vec3 point_;
  CutFaces* cut_;
  Place place_;
  double value_ = -std::numeric_limits<double>::infinity();
};

/// Through the face that the point lies farthest beyond, from cell to cell. True when the point is found.
bool walk(const TetMesh& mesh, Vec3 point, CellHandle c, Best& best) {
  CellHandle from;
  for (int n_in_vain = 0; n_in_vain < kPatience;) {
    std::array<double, 4> weights{};
    if (!weigh(mesh, c, point, weights)) return false;
    const double before = best.value();
    if (best.look_at(c)) return true;
    n_in_vain = best.value() > before ? 0 : n_in_vain + 1;
    std::array<int, 4> order = {0, 1, 2, 3};
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return weights[static_cast<std::size_t>(a)] < weights[static_cast<std::size_t>(b)];
    });
    CellHandle next;
    for (int k : order) {
      if (!(weights[static_cast<std::size_t>(k)] < 0)) break;
      const CellHandle there = best.behind(halfface_of(c, k));
      if (best.is_cut_short()) return false;
      if (!there.is_valid() || there == from) continue;
      next = there;
      break;
    }
    if (!next.is_valid()) return false;
    from = c;
    c = next;
  }
  return false;
}

/// Layers of cells round the first ones, until one brings nothing nearer.
void search(const TetMesh& mesh, std::vector<CellHandle> cells, Best& best) {
  std::vector<CellHandle> known = cells;
  std::sort(known.begin(), known.end());
  int in_vain = 0;
  while (!cells.empty() && known.size() < kLargestSearch && in_vain < 2) {
    const double before = best.value();
    for (CellHandle c : cells)
      if (best.look_at(c)) return;
    in_vain = best.value() > before ? 0 : in_vain + 1;
    std::vector<CellHandle> layer;
    for (CellHandle c : cells)
      for (const HalfFaceHandle h : mesh.cell_halffaces(c)) {
        const CellHandle there = best.behind(h);
        if (there.is_valid() && !std::binary_search(known.begin(), known.end(), there))
          layer.push_back(there);
      }
    if (best.is_cut_short()) return;
    std::sort(layer.begin(), layer.end());
    layer.erase(std::unique(layer.begin(), layer.end()), layer.end());
    const auto n_known = static_cast<std::ptrdiff_t>(known.size());
    known.insert(known.end(), layer.begin(), layer.end());
    std::inplace_merge(known.begin(), known.begin() + n_known, known.end());
    cells = std::move(layer);
  }
}

}  // namespace

Place locate(const TetMesh& mesh, Vec3 point, std::span<const CellHandle> star, CutFaces* cut) {
  Best best(mesh, point, cut);
  for (CellHandle c : star)
    if (best.look_at(c)) return best.place();
  if (best.place().cell.is_valid() && walk(mesh, point, best.place().cell, best)) return best.place();
  if (!best.is_cut_short()) search(mesh, {star.begin(), star.end()}, best);
  return best.place();
}

}  // namespace hfr
