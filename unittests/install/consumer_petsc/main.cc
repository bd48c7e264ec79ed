// SPDX-License-Identifier: BSD-3-Clause
#include <petscdmplex.h>

#include <hfremesh_petsc.h>

/// One tetrahedron, adapted by name: it stays what it is.
int main(int argc, char** argv) {
  const PetscInt cells[4] = {1, 0, 2, 3};
  const PetscReal points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  DM dm = nullptr, adapted = nullptr;
  PetscInt begin = 0, end = 0;
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscCall(hfremesh_petsc_register());
  PetscCall(PetscOptionsSetValue(nullptr, "-dm_adaptor", "hfremesh"));
  PetscCall(DMPlexCreateFromCellListPetsc(PETSC_COMM_WORLD, 3, 1, 4, 4, PETSC_TRUE, cells, 3, points, &dm));
  PetscCall(DMAdaptLabel(dm, nullptr, &adapted));
  PetscCall(DMPlexGetHeightStratum(adapted, 0, &begin, &end));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%d cell\n", static_cast<int>(end - begin)));
  PetscCall(DMDestroy(&adapted));
  PetscCall(DMDestroy(&dm));
  PetscCall(PetscFinalize());
  return end - begin == 1 ? 0 : 1;
}
