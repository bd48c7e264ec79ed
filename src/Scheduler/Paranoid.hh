// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_PARANOID_HH
#define HFR_SCHEDULER_PARANOID_HH

#include <functional>
#include <string>
#include <typeinfo>

#include "Scheduler/Workspace.hh"

namespace hfr::detail {

/// What a build with HFR_PARANOID looks at before and after each round and each smoothing pass: all of the
/// mesh, and all that the workspace keeps about it, counted anew. Throws InternalError, which names the
/// operator and the first difference; mesh and workspace are then as they were found. Linear in the mesh
/// however little a round does, and holds a copy of it.
class Paranoid {
 public:
  using Quality = std::function<double(Vec3, Vec3, Vec3, Vec3)>;

  /// Looks at what was there before, so that what came in between (other passes, devices, whoever spoils a
  /// workspace) is not blamed on the operator. `what`: "round" or "pass"; quality: by the operator's metric.
  Paranoid(const TetMesh& mesh, const Workspace& work, const char* what, const std::type_info& op,
           Quality quality);
  /// Looks at what the round has made of it. Rules of a mesh that were broken before count only where they
  /// are more so.
  void look_again() const;

 private:
  void demand(const char* when, const std::string& complaint) const;
  std::string broken_rule() const;
  std::string forgotten_change() const;
  std::string wrong_count() const;
  std::string wrong_cell() const;
  std::string wrong_vertex() const;

  const TetMesh& mesh_;
  const Workspace& work_;
  const char* what_;
  const std::type_info& op_;
  Quality quality_;
  TetMesh before_;
};

}  // namespace hfr::detail

#endif
