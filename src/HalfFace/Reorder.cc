// SPDX-License-Identifier: BSD-3-Clause
// Hilbert places after J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004): undo the
// excess work of each level from the top bit down, then Gray-decode.
#include "HalfFace/Reorder.hh"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>

#include "Parallel/Sort.hh"

namespace hfr {
namespace {

constexpr int kBits = 21;

/// Puts two zero bits between the bits of x.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

CurveGrid grid_of(const TetMesh& mesh, SpaceCurve curve, par::Policy policy) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Box {
    Vec3 low = {kInfinity, kInfinity, kInfinity}, high = {-kInfinity, -kInfinity, -kInfinity};
  };
  const Box box = par::reduce(
      policy, mesh.n_vertices(), Box{},
      [&](std::size_t i) {
        const Vec3 p = mesh.point(VertexHandle(i));
        return Box{p, p};
      },
      [](Box a, const Box& b) {
        for (int i = 0; i < 3; ++i) {
          a.low[i] = std::min(a.low[i], b.low[i]);
          a.high[i] = std::max(a.high[i], b.high[i]);
        }
        return a;
      });
  return {curve, box.low, box.high};
}

/// Old → new when the things that exist(i) are sorted by place(i).
template <class H, class Exists, class Place>
std::vector<H> sorted_places(par::Policy policy, std::size_t n, std::size_t& n_new, Exists&& exists,
                             Place&& place) {
  if (n > std::numeric_limits<std::uint32_t>::max())
    throw ResourceLimit("reorder: " + std::to_string(n) + " things are more than the sort can number");
  const std::vector<std::uint32_t> kept = par::compact<std::uint32_t>(policy, n, exists);
  std::vector<par::KeyIndex> items(kept.size());
  par::for_each(policy, items.size(), [&](std::size_t i) { items[i] = {place(kept[i]), kept[i]}; });
  std::vector<par::KeyIndex> scratch;
  par::stable_sort(policy, items, scratch);
  n_new = items.size();
  std::vector<H> to(n);
  par::for_each(policy, items.size(), [&](std::size_t i) { to[items[i].index] = H(i); });
  return to;
}

}  // namespace

CurveGrid::CurveGrid(SpaceCurve curve, Vec3 low, Vec3 high) : curve_(curve), low_(low) {
  double size = 0;
  for (int i = 0; i < 3; ++i) size = std::max(size, high[i] - low[i]);
  scale_ = size > 0 ? ((1 << kBits) - 1) / size : 0;
}

std::uint64_t CurveGrid::place(Vec3 p) const {
  const auto step = [&](int i) { return static_cast<std::uint32_t>((p[i] - low_[i]) * scale_); };
  return curve_place(curve_, step(0), step(1), step(2));
}

std::uint64_t CurveGrid::place(const TetMesh& mesh, CellHandle c) const {
  const auto& v = mesh.cell(c).v;
  return place(0.25 * ((mesh.point(v[0]) + mesh.point(v[1])) + (mesh.point(v[2]) + mesh.point(v[3]))));
}

std::uint64_t curve_place(SpaceCurve curve, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  if (curve == SpaceCurve::kHilbert) {
    std::uint32_t axis[3] = {x, y, z};
    for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1) {
      const std::uint32_t below = bit - 1;
      for (std::uint32_t& a : axis) {
        if (a & bit) {
          axis[0] ^= below;
        } else {
          const std::uint32_t swap = (axis[0] ^ a) & below;
          axis[0] ^= swap;
          a ^= swap;
        }
      }
    }
    axis[1] ^= axis[0];
    axis[2] ^= axis[1];
    std::uint32_t flip = 0;
    for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1)
      if (axis[2] & bit) flip ^= bit - 1;
    x = axis[0] ^ flip;
    y = axis[1] ^ flip;
    z = axis[2] ^ flip;
  }
  return spread(x) << 2 | spread(y) << 1 | spread(z);
}

void order_cells(TetMesh& mesh, std::span<const CellHandle> order, par::Policy policy) {
  HFR_REQUIRE(!mesh.needs_garbage_collection() && order.size() == mesh.n_cells(),
              "order_cells: " + std::to_string(order.size()) + " cells are named of " +
                  std::to_string(mesh.n_cells()) + ", or some are deleted");
  GarbageMap map;
  map.vertices.resize(mesh.n_vertices());
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) map.vertices[i] = VertexHandle(i);
  map.cells.resize(mesh.n_cells());
  for (std::size_t i = 0; i < order.size(); ++i) {
    HFR_REQUIRE(
        order[i].is_valid() && order[i].idx() < map.cells.size() && !map.cells[order[i].idx()].is_valid(),
        "order_cells: cell " + std::to_string(i) + " in the order is none, or comes twice");
    map.cells[order[i].idx()] = CellHandle(i);
  }
  mesh.renumber(map, mesh.n_vertices(), order.size(), policy);
}

void restore_cell_order(TetMesh& mesh, std::span<const CellHandle> went_to, par::Policy policy) {
  std::vector<CellHandle> order;
  for (CellHandle c : went_to)
    if (c.is_valid()) order.push_back(c);
  order_cells(mesh, order, policy);
}

bool is_scattered(const TetMesh& mesh, par::Policy policy) {
  if (mesh.n_cells() <= kFarInOrder) return false;
  const std::size_t n_far = par::reduce(
      policy, mesh.n_cells(), std::size_t{0},
      [&](std::size_t i) {
        std::size_t n = 0;
        for (HalfFaceHandle m : mesh.cell(CellHandle(i)).mate) {
          const std::size_t other = cell_of(m).idx();
          n += m.is_valid() && (other > i ? other - i : i - other) >= kFarInOrder ? 1 : 0;
        }
        return n;
      },
      std::plus<>{});
  return is_scattered(n_far, mesh.n_cells());
}

GarbageMap reorder(TetMesh& mesh, const ReorderOptions& options) {
  const CurveGrid grid = grid_of(mesh, options.curve, options.policy);
  GarbageMap map;
  std::size_t n_vertices = 0;
  std::size_t n_cells = 0;
  map.vertices = sorted_places<VertexHandle>(
      options.policy, mesh.n_vertices(), n_vertices,
      [&](std::size_t i) { return !mesh.is_deleted(VertexHandle(i)); },
      [&](std::size_t i) -> std::uint64_t {
        return options.vertices ? grid.place(mesh.point(VertexHandle(i))) : 0;
      });
  map.cells = sorted_places<CellHandle>(
      options.policy, mesh.n_cells(), n_cells, [&](std::size_t i) { return !mesh.is_deleted(CellHandle(i)); },
      [&](std::size_t i) { return grid.place(mesh, CellHandle(i)); });
  mesh.renumber(map, n_vertices, n_cells, options.policy);
  return map;
}

}  // namespace hfr
