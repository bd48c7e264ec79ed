# SPDX-License-Identifier: BSD-3-Clause
# Component petsc of find_package(hfremesh): hfremesh::petsc, a shared library. Included by hfremeshConfig.cmake. Whoever
# calls hfremesh_petsc_register() has PETSc already, and links it as before.
include("${CMAKE_CURRENT_LIST_DIR}/hfremesh-petscTargets.cmake")
set(hfremesh_petsc_FOUND TRUE)
