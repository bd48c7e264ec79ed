// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_FIELDS_HH
#define HFR_APPS_FIELDS_HH

#include <string>
#include <vector>

#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Parallel/Policy.hh"

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

/// The line that says so, of fields with these names.
std::string note_on_values_elsewhere(const std::vector<std::string>& names, std::size_t n_elsewhere,
                                     std::size_t n_vertices);

/// Fails with exit code 1 where a field of cells of that name cannot be written to `output`. `name` empty:
/// none is asked for.
void require_quality_array(const std::string& name, const std::string& output,
                           const io::WriteOptions& options);

/// Adds a field of cells to `data`: the smallest dihedral angle of each in degrees, negative in a cell whose
/// volume is. Takes the place of a field of cells of that name. `data` is as io::disassemble() gives it.
void add_quality_array(const std::string& name, par::Policy policy, io::MeshData& data);

}  // namespace hfr::app

#endif
