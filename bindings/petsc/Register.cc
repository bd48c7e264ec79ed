// SPDX-License-Identifier: BSD-3-Clause
#include "Plex.hh"
#include "hfremesh_petsc.h"

namespace {

bool is_registered = false;  // of the process, as is PETSc's list of adaptors, which PetscFinalize() empties

PetscErrorCode forget() {
  is_registered = false;
  return PETSC_SUCCESS;
}

/// For -dm_generator hfremesh: PETSc calls it unasked.
PetscErrorCode refuse_to_generate(DM boundary, PetscBool, DM*) {
  PetscFunctionBegin;
  SETERRQ(PetscObjectComm(reinterpret_cast<PetscObject>(boundary)), PETSC_ERR_SUP,
          "hfremesh adapts meshes, and makes none of a boundary: -dm_generator has to name another");
}

}  // namespace

PetscErrorCode hfremesh_petsc_register(void) {
  PetscFunctionBegin;
  if (is_registered) PetscFunctionReturn(PETSC_SUCCESS);
  // The package empties the list in the end.
  PetscCall(DMInitializePackage());
  constexpr PetscInt kOnlyByName =
      -1;  // PETSc's own stand before it in the list, and it is no generator of any
  PetscCall(DMGenerateRegister("hfremesh", refuse_to_generate, nullptr, hfr::petsc::adapt, kOnlyByName));
  PetscCall(PetscRegisterFinalize(forget));
  is_registered = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// What PETSc calls of a library that -dll_prepend or -dll_append names.
PETSC_EXTERN PetscErrorCode PetscDLLibraryRegister_hfremesh_petsc(void) {
  PetscFunctionBegin;
  PetscCall(hfremesh_petsc_register());
  PetscFunctionReturn(PETSC_SUCCESS);
}
