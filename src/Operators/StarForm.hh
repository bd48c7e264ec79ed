// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_STAR_FORM_HH
#define HFR_OPERATORS_STAR_FORM_HH

#include <limits>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "kernels/star_volume_length.h"

namespace hfr {

inline hfr_real3 to_kernel(Vec3 a) { return hfr_make3(a.x, a.y, a.z); }

/// Volume-length of a vertex's star as a function of where the vertex stands, relative to its present place.
class StarForm {
 public:
  StarForm(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link) {
    const Vec3 origin = mesh.point(v);
    for (HalfFaceHandle h : link) {
      const auto f = mesh.halfface_vertices(h);
      cells_.push_back(hfr_make_star_cell(to_kernel(mesh.point(f[0]) - origin),
                                          to_kernel(mesh.point(f[1]) - origin),
                                          to_kernel(mesh.point(f[2]) - origin)));
    }
  }

  std::span<const hfr_star_cell> cells() const { return cells_; }

  /// Smallest decision value with the vertex moved by x, or anything ≤ floor once it is no better. The cell
  /// that ended the last search is asked first.
  double worst(Vec3 x, double floor) {
    const hfr_real3 at = to_kernel(x);
    double worst = std::numeric_limits<double>::infinity();
    if (killer_ < cells_.size()) {
      worst = hfr_star_decision(cells_[killer_], at);
      if (!(worst > floor)) return worst;
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const double q = hfr_star_decision(cells_[i], at);
      if (q < worst) worst = q;
      if (!(q > floor)) {
        killer_ = i;
        return worst;
      }
    }
    return worst;
  }

 private:
  FixedVector<hfr_star_cell, Star::kCapacity> cells_;
  std::size_t killer_ = 0;
};

}  // namespace hfr

#endif
