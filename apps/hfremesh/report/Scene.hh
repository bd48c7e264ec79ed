// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_SCENE_HH
#define HFR_APPS_REPORT_SCENE_HH

#include <array>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::view {

/// Where a mesh is looked at from, and where it is cut; the same for the mesh before and after.
struct Scene {
  Vec3 centre;               ///< of the bounding box
  double radius = 1;         ///< half its diagonal; positive
  std::array<Vec3, 3> axes;  ///< to the right, upwards, towards the eye; unit length
  Vec3 cut_normal;           ///< points at the eye; along an axis of the coordinates
  double cut = 0;            ///< a vertex p with dot(cut_normal, p) > cut lies in the part that is taken away
  std::array<Vec3, 2> frame;  ///< corners of what is seen: its sides in the directions of axes[0] and axes[1]

  bool is_cut_off(Vec3 p) const { return dot(cut_normal, p) > cut; }
};

/// The front half of the mesh is taken away, across whichever of two axes it is thinner in; z is up, unless
/// the mesh is flat in z.
Scene scene_of(const TetMesh& mesh);

/// Where a point is seen in a window of so many pixels: x to the right, y downwards, nearer points with a
/// larger depth. All three are linear in one another on a straight line.
class Projection {
 public:
  Projection(const Scene& scene, double width, double height);
  std::array<double, 3> operator()(Vec3 p) const;

 private:
  Scene scene_;
  double scale_, x_, y_;
};

}  // namespace hfr::view

#endif
