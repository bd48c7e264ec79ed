// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_FIELDS_HH
#define HFR_APPS_FIELDS_HH

#include <string>
#include <vector>

#include "hfremesh/IO/MeshData.hh"

namespace hfr::app {

/// Where the vertices of a mesh with fields on them are before a run, to tell afterwards how many of the
/// values are no longer at their place.
class PointsOfFields {
 public:
  explicit PointsOfFields(const io::MeshData& before);

  /// One line when there are such values in what was made of it.
  std::vector<std::string> notes(const io::MeshData& after) const;

 private:
  std::vector<Vec3> points_;  ///< ascending; none where there are no fields
};

}  // namespace hfr::app

#endif
