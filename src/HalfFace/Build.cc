// SPDX-License-Identifier: BSD-3-Clause
// Connectivity from arrays. Half-faces are gathered by their smallest vertex with a counting sort and matched
// inside these small buckets, so the result depends on the input alone, not on threads.
#include <algorithm>
#include <cmath>
#include <string>

#include "HalfFace/TetMesh.hh"

namespace hfr {
namespace {

using Corners = std::array<Index, 4>;

/// A half-face in the bucket of its smallest vertex.
struct OpenFace {
  Index middle;
  Index largest;
  Index halfface;

  friend bool operator<(const OpenFace& a, const OpenFace& b) {
    if (a.middle != b.middle) return a.middle < b.middle;
    if (a.largest != b.largest) return a.largest < b.largest;
    return a.halfface < b.halfface;
  }
  bool same_face(const OpenFace& o) const { return middle == o.middle && largest == o.largest; }
};

std::array<Index, 3> sorted3(Index a, Index b, Index c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  return {a, b, c};
}

double six_volume(const std::vector<Vec3>& p, const Cell& c) {
  const Vec3 a = p[c.v[0].idx()];
  return dot(p[c.v[1].idx()] - a, cross(p[c.v[2].idx()] - a, p[c.v[3].idx()] - a));
}

}  // namespace

class MeshBuilder {
 public:
  MeshBuilder(std::vector<Vec3> points, par::Policy policy) : policy_(policy) {
    mesh_.points_ = std::move(points);
  }

  TetMesh run(std::span<const Corners> cells, BuildReport* report) {
    check(cells);
    const std::size_t n = cells.size();
    mesh_.cells_.resize(n);
    par::for_each(policy_, n, [&](std::size_t i) {
      for (std::size_t k = 0; k < 4; ++k) mesh_.cells_[i].v[k] = VertexHandle(cells[i][k]);
    });
    match_all();
    BuildReport mended;
    if (n_conflicts_ > 0) {
      mended.reoriented = reorient();
      match_all();
    }
    const auto negative = par::reduce(
        policy_, n, std::int64_t{0},
        [&](std::size_t i) {
          const double d = six_volume(mesh_.points_, mesh_.cells_[i]);
          return d < 0 ? std::int64_t{1} : d > 0 ? std::int64_t{-1} : std::int64_t{0};
        },
        std::plus<>{});
    if (negative > 0) {
      flip_all();
      mended.flipped = true;
    }
    mesh_.hook_.assign(mesh_.points_.size(), CellHandle());
    for (std::size_t i = n; i-- > 0;)  // downwards, so that the smallest cell stays
      for (VertexHandle v : mesh_.cells_[i].v) mesh_.hook_[v.idx()] = CellHandle(i);
    mesh_.vertex_status_.assign(mesh_.points_.size(), 0);
    if (report) *report = std::move(mended);
    return std::move(mesh_);
  }

 private:
  void check(std::span<const Corners> cells) const {
    if (cells.size() > Handle<struct HalfFaceKind>::kInvalid / 12)
      throw ResourceLimit(std::to_string(cells.size()) +
                          " cells are too many for 32-bit indices; build with HFR_INDEX64=ON");
    const std::size_t n_points = mesh_.points_.size();
    const auto first_bad = [&](std::size_t n, auto&& is_bad) {
      return par::reduce(
          policy_, n, n, [&](std::size_t i) { return is_bad(i) ? i : n; },
          [](std::size_t a, std::size_t b) { return std::min(a, b); });
    };
    const std::size_t bad_point = first_bad(n_points, [&](std::size_t i) {
      const Vec3 p = mesh_.points_[i];
      return !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    });
    HFR_REQUIRE(bad_point == n_points, "vertex " + std::to_string(bad_point) +
                                           ": a coordinate is not a finite number; mend the input");
    const std::size_t bad_cell = first_bad(cells.size(), [&](std::size_t i) {
      const Corners& c = cells[i];
      return std::any_of(c.begin(), c.end(), [&](Index v) { return v >= n_points; }) || c[0] == c[1] ||
             c[0] == c[2] || c[0] == c[3] || c[1] == c[2] || c[1] == c[3] || c[2] == c[3];
    });
    if (bad_cell == cells.size()) return;
    for (Index v : cells[bad_cell])
      HFR_REQUIRE(v < n_points, "cell " + std::to_string(bad_cell) + ": vertex index " + std::to_string(v) +
                                    " is out of range; there are " + std::to_string(n_points) + " vertices");
    throw InvalidInput("cell " + std::to_string(bad_cell) + ": a vertex appears twice; remove the cell");
  }

  void match_all() {
    const std::size_t n_points = mesh_.points_.size();
    const std::size_t n = mesh_.cells_.size();
    // Histograms a part cost n_points each, so more than a few parts would not pay.
    const int n_parts = std::min(par::thread_count(policy_, n), 8);
    std::vector<std::vector<Index>> start(static_cast<std::size_t>(n_parts));
    const auto for_part = [&](int part, auto&& visit) {
      const std::size_t end = par::part_begin(n, n_parts, part + 1);
      for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) {
        const auto& v = mesh_.cells_[i].v;
        for (std::size_t k = 0; k < 4; ++k) {
          const auto& f = kFaceCorners[k];
          visit(sorted3(v[f[0]].idx(), v[f[1]].idx(), v[f[2]].idx()), static_cast<Index>(4 * i + k));
        }
      }
    };
    par::parts(n_parts, [&](int part) {
      auto& count = start[static_cast<std::size_t>(part)];
      count.assign(n_points, 0);
      for_part(part, [&](const std::array<Index, 3>& f, Index) { ++count[f[0]]; });
    });
    std::vector<Index> bucket(n_points + 1);
    Index sum = 0;
    for (std::size_t v = 0; v < n_points; ++v) {
      bucket[v] = sum;
      for (auto& part : start) {
        const Index count = part[v];
        part[v] = sum;
        sum += count;
      }
    }
    bucket[n_points] = sum;
    std::vector<OpenFace> open(4 * n);
    par::parts(n_parts, [&](int part) {
      auto& at = start[static_cast<std::size_t>(part)];
      for_part(part, [&](const std::array<Index, 3>& f, Index h) { open[at[f[0]]++] = {f[1], f[2], h}; });
    });
    n_conflicts_ = par::reduce(
        policy_, n_points, std::int64_t{0},
        [&](std::size_t v) { return match_bucket({open.data() + bucket[v], open.data() + bucket[v + 1]}); },
        std::plus<>{});
  }

  /// Pairs the faces of one bucket; returns how many pairs see their face in the same order.
  std::int64_t match_bucket(std::span<OpenFace> faces) {
    std::int64_t conflicts = 0;
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 0; i < faces.size();) {
      const bool paired = i + 1 < faces.size() && faces[i].same_face(faces[i + 1]);
      const HalfFaceHandle h(faces[i].halfface);
      if (!paired) {
        mesh_.set_mate(h, HalfFaceHandle());
        ++i;
        continue;
      }
      const HalfFaceHandle m(faces[i + 1].halfface);
      if (i + 2 < faces.size() && faces[i].same_face(faces[i + 2])) fail_three_cells(faces.subspan(i, 3));
      mesh_.set_mate(h, m);
      mesh_.set_mate(m, h);
      if (!opposite_order(h, m)) ++conflicts;
      i += 2;
    }
    return conflicts;
  }

  [[noreturn]] void fail_three_cells(std::span<const OpenFace> faces) const {
    const auto v = mesh_.halfface_vertices(HalfFaceHandle(faces[0].halfface));
    std::string message = "face of vertices " + std::to_string(v[0].idx()) + " " + std::to_string(v[1].idx()) +
                          " " + std::to_string(v[2].idx()) + " belongs to more than two cells:";
    for (const OpenFace& face : faces) message += " " + std::to_string(face.halfface / 4);
    throw InvalidInput(message + "; remove all but two");
  }

  bool opposite_order(HalfFaceHandle h, HalfFaceHandle m) const {
    const auto a = mesh_.halfface_vertices(h);
    const auto b = mesh_.halfface_vertices(m);
    for (std::size_t r = 0; r < 3; ++r)
      if (a[0] == b[r]) return a[1] == b[(r + 2) % 3];
    return false;
  }

  /// Puts every cell into the orientation that most cells of its component have; returns those it turned.
  std::vector<CellHandle> reorient() {
    const std::size_t n = mesh_.cells_.size();
    std::vector<std::int8_t> side(n, -1);
    std::vector<CellHandle> component, turned;
    for (std::size_t root = 0; root < n; ++root) {
      if (side[root] >= 0) continue;
      component.assign(1, CellHandle(root));
      side[root] = 0;
      std::size_t on_side[2] = {1, 0};
      for (std::size_t i = 0; i < component.size(); ++i) {
        const CellHandle c = component[i];
        for (int k = 0; k < 4; ++k) {
          const HalfFaceHandle h = halfface_of(c, k);
          const HalfFaceHandle m = mesh_.opposite_halfface(h);
          if (!m.is_valid()) continue;
          const auto wanted =
              static_cast<std::int8_t>(opposite_order(h, m) ? side[c.idx()] : 1 - side[c.idx()]);
          std::int8_t& other = side[cell_of(m).idx()];
          if (other < 0) {
            other = wanted;
            ++on_side[wanted];
            component.push_back(cell_of(m));
          } else if (other != wanted) {
            throw InvalidInput("cells " + std::to_string(c.idx()) + " and " + std::to_string(cell_of(m).idx()) +
                               ": the mesh cannot be oriented (it closes on itself like a Moebius strip)");
          }
        }
      }
      const std::int8_t minority = on_side[1] > on_side[0] ? 0 : 1;
      for (CellHandle c : component)
        if (side[c.idx()] == minority) turned.push_back(c);
    }
    std::sort(turned.begin(), turned.end());
    for (CellHandle c : turned) std::swap(mesh_.cells_[c.idx()].v[2], mesh_.cells_[c.idx()].v[3]);
    return turned;
  }

  void flip_all() {
    par::for_each(policy_, mesh_.cells_.size(), [&](std::size_t i) {
      Cell& c = mesh_.cells_[i];
      std::swap(c.v[2], c.v[3]);
      std::swap(c.mate[2], c.mate[3]);
      for (HalfFaceHandle& m : c.mate) {
        if (!m.is_valid()) continue;
        const int corner = corner_of(m);
        if (corner >= 2) m = halfface_of(cell_of(m), 5 - corner);
      }
    });
  }

  TetMesh mesh_;
  par::Policy policy_;
  std::int64_t n_conflicts_ = 0;
};

TetMesh build(std::vector<Vec3> points, std::span<const std::array<Index, 4>> cells, par::Policy policy,
              BuildReport* report) {
  return MeshBuilder(std::move(points), policy).run(cells, report);
}

}  // namespace hfr
