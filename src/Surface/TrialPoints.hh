// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface.
#ifndef HFR_SURFACE_TRIAL_POINTS_HH
#define HFR_SURFACE_TRIAL_POINTS_HH

#include <span>
#include <utility>
#include <vector>

#include "HalfFace/Handles.hh"
#include "HalfFace/Vec3.hh"

namespace hfr::surface {

/// Points of vertices that are moved on trial.
class TrialPoints {
 public:
  explicit TrialPoints(std::span<const Vec3> points) : points_(points.begin(), points.end()) {}

  const std::vector<Vec3>& get() const { return points_; }
  void move(VertexHandle v, Vec3 by) {
    before_.emplace_back(v, points_[v.idx()]);
    points_[v.idx()] = points_[v.idx()] + by;
  }
  /// What has moved since either was called last stays, or goes back.
  void keep() { before_.clear(); }
  void put_back() {
    for (auto at = before_.rbegin(); at != before_.rend(); ++at) points_[at->first.idx()] = at->second;
    before_.clear();
  }

 private:
  std::vector<Vec3> points_;
  std::vector<std::pair<VertexHandle, Vec3>> before_;
};

}  // namespace hfr::surface

#endif
