// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PICTURE_HH
#define HFR_APPS_REPORT_PICTURE_HH

#include <string>

#include "Canvas.hh"
#include "Scene.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Quality/Statistics.hh"

namespace hfr::view {

/// A mesh before and after, side by side, as in Fig. 7 of D'Amato & Vénere (2013): the front half cut away so
/// that cells inside are seen, those below kPoorBelow in colour, wherever they are, inverted and flat ones
/// shining through; below it the histogram of all dihedral angles with the smallest and the largest. Meshes
/// are drawn when they are handed over and may change or go after that.
class Picture {
 public:
  static constexpr int kUsualWidth = 1600;  ///< pixels; the height is 5/8 of the width

  /// The view and the cut are those that fit this mesh. `width`: of the sheet in pixels. Precondition for
  /// both meshes: nothing is deleted.
  Picture(const TetMesh& before, const std::string& name, int width, par::Policy policy);
  void add_after(const TetMesh& mesh, const std::string& name, par::Policy policy);

  /// The whole sheet; statistics are those of the two meshes.
  Canvas finish(const Statistics& before, const Statistics& after) const;

 private:
  void add_mesh(const TetMesh& mesh, const std::string& name, int place, par::Policy policy);

  Scene scene_;
  Canvas sheet_;
};

}  // namespace hfr::view

#endif
