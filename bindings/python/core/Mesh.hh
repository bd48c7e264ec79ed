// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PYTHON_MESH_HH
#define HFR_BINDINGS_PYTHON_MESH_HH

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Remesh/Result.hh"

namespace hfr::python {

namespace nb = nanobind;

/// hfremesh.Mesh: connectivity that never changes, so that views of its arrays stay valid as long as it
/// lives.
struct Mesh {
  TetMesh tets;
  BuildReport build;
  std::vector<std::string> notes;  ///< what a reader had to say
};

/// 0: every core.
par::Policy policy_of(int threads);

void bind_mesh(nb::module_& module);
void bind_statistics(nb::module_& module);
void bind_improve(nb::module_& module);
void bind_files(nb::module_& module);
void bind_edits(nb::module_& module);
void bind_remesher(nb::module_& module);

}  // namespace hfr::python

#endif
