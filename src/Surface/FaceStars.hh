// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface.
#ifndef HFR_SURFACE_FACE_STARS_HH
#define HFR_SURFACE_FACE_STARS_HH

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "Surface/Features.hh"

namespace hfr::surface {

/// Which faces of the surface use a vertex, ascending.
class FaceStars {
 public:
  explicit FaceStars(const Arrays& arrays) : first_(arrays.points.size() + 1, 0) {
    for (const auto& f : arrays.faces)
      for (VertexHandle v : f) ++first_[v.idx() + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < arrays.faces.size(); ++i)
      for (VertexHandle v : arrays.faces[i]) faces_[next[v.idx()]++] = static_cast<std::uint32_t>(i);
  }
  std::span<const std::uint32_t> at(VertexHandle v) const {
    return {faces_.data() + first_[v.idx()], first_[v.idx() + 1] - first_[v.idx()]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> faces_;
};

}  // namespace hfr::surface

#endif
