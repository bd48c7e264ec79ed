// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_DAMAGE_HH
#define HFR_QUALITY_DAMAGE_HH

#include "HalfFace/TetMesh.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "kernels/damage.h"

namespace hfr {

/// Counts of the inverted and the flat cells of a cluster, six times the volume of the inverted ones, and the
/// worst angle; the formulas are in kernels/damage.h. By it every change of cells that are not all positive
/// is judged, besides their worst decision value.
class Damage {
 public:
  int n_inverted() const { return sum_.n_inverted; }
  int n_invalid() const { return sum_.n_inverted + sum_.n_flat; }
  double overlap() const { return sum_.overlap; }
  /// Decision value of MinDihedral.
  double worst() const { return sum_.worst; }

  /// One more cell, its vertices in the order in which they are stored.
  void add(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    sum_ = hfr_damage_with(sum_, to_real3(a), to_real3(b), to_real3(c), to_real3(d));
  }
  void add(const TetMesh& mesh, CellHandle c) {
    const auto& v = mesh.cell(c).v;
    add(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
  }
  /// Those of another cluster, after those that there are.
  void join(const Damage& other) {
    sum_.n_inverted += other.sum_.n_inverted;
    sum_.n_flat += other.sum_.n_flat;
    sum_.overlap += other.sum_.overlap;
    sum_.worst = hfr_lesser(sum_.worst, other.sum_.worst);
  }
  /// The same with vertex v at x.
  void add(const TetMesh& mesh, CellHandle c, VertexHandle v, Vec3 x) {
    const auto& w = mesh.cell(c).v;
    const auto at = [&](std::size_t i) { return w[i] == v ? x : mesh.point(w[i]); };
    add(at(0), at(1), at(2), at(3));
  }
  /// Never more inverted cells, never more inverted and flat ones together, no more overlap unless fewer
  /// cells are inverted, and no worst angle below `floor` (Workspace::floor) unless it has not become worse.
  bool may_become(const Damage& after, double floor) const {
    return hfr_damage_may_become(sum_, after.sum_, floor) != 0;
  }

 private:
  hfr_damage sum_ = hfr_no_damage();
};

}  // namespace hfr

#endif
