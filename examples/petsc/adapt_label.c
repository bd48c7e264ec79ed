/* SPDX-License-Identifier: BSD-3-Clause */
/* A mesh from a file, cells near a point refined, all of it improved: DMAdaptLabel() with HFRemesh.
 *   hfremesh generate cavity -o cavity.msh
 *   mpicc adapt_label.c $(pkg-config --cflags --libs PETSc) -lm -o adapt_label
 *   mpirun -n 2 ./adapt_label -dm_plex_filename cavity.msh -dm_adaptor hfremesh \
 *     -dll_prepend /usr/lib/libhfremesh_petsc.so
 * The program knows nothing of HFRemesh: any that calls DMAdaptLabel() is run so. */
#include <petscdmplex.h>

/* Gives the faces of the boundary the label "sides": 1 to 6, by the side of the unit cube that they look to. */
static PetscErrorCode label_sides(DM dm) {
  DMLabel sides;
  PetscInt begin, end;

  PetscFunctionBeginUser;
  PetscCall(DMCreateLabel(dm, "sides"));
  PetscCall(DMGetLabel(dm, "sides", &sides));
  PetscCall(DMPlexGetHeightStratum(dm, 1, &begin, &end));
  for (PetscInt f = begin; f < end; ++f) {
    PetscReal area, x[3], normal[3];
    PetscCall(DMPlexComputeCellGeometryFVM(dm, f, &area, x, normal));
    for (int d = 0; d < 3; ++d) {
      if (PetscAbsReal(x[d]) < 1e-9) PetscCall(DMLabelSetValue(sides, f, 1 + 2 * d));
      if (PetscAbsReal(x[d] - 1) < 1e-9) PetscCall(DMLabelSetValue(sides, f, 2 + 2 * d));
    }
  }
  PetscFunctionReturn(0);
}

/* Marks the cells whose centre is near the origin. */
static PetscErrorCode mark(DM dm, DMLabel adapt) {
  PetscInt begin, end;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  for (PetscInt c = begin; c < end; ++c) {
    PetscReal volume, x[3];
    PetscCall(DMPlexComputeCellGeometryFVM(dm, c, &volume, x, NULL));
    if (x[0] < 0.2 && x[1] < 0.2 && x[2] < 0.2) PetscCall(DMLabelSetValue(adapt, c, DM_ADAPT_REFINE));
  }
  PetscFunctionReturn(0);
}

/* Cells of all ranks, how many of them are inverted, and the area of the side x = 0 by its label. */
static PetscErrorCode print(DM dm, const char* when) {
  MPI_Comm comm = PetscObjectComm((PetscObject)dm);
  PetscInt begin, end, n_faces = 0, counts[2] = {0, 0};
  PetscReal side = 0;
  IS faces = NULL;
  const PetscInt* face = NULL;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  for (PetscInt c = begin; c < end; ++c) {
    PetscReal v0[3], J[9], inverse[9], det;
    PetscCall(DMPlexComputeCellGeometryAffineFEM(dm, c, v0, J, inverse, &det));
    counts[1] += det <= 0;
  }
  counts[0] = end - begin;
  PetscCall(DMGetStratumIS(dm, "sides", 1, &faces));
  if (faces) {
    PetscCall(ISGetLocalSize(faces, &n_faces));
    PetscCall(ISGetIndices(faces, &face));
    for (PetscInt i = 0; i < n_faces; ++i) {
      PetscReal area;
      PetscCall(DMPlexComputeCellGeometryFVM(dm, face[i], &area, NULL, NULL));
      side += area;
    }
    PetscCall(ISRestoreIndices(faces, &face));
    PetscCall(ISDestroy(&faces));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &side, 1, MPIU_REAL, MPI_SUM, comm));
  PetscCall(PetscPrintf(comm, "%s: %" PetscInt_FMT " cells, %" PetscInt_FMT " inverted; side 1 has area %g\n",
                        when, counts[0], counts[1], (double)side));
  PetscFunctionReturn(0);
}

int main(int argc, char** argv) {
  DM dm, adapted;
  DMLabel adapt;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(DMCreate(PETSC_COMM_WORLD, &dm));
  PetscCall(DMSetType(dm, DMPLEX));
  PetscCall(DMSetFromOptions(dm)); /* reads and distributes the mesh */
  PetscCall(DMGetCoordinatesLocalSetUp(dm));
  PetscCall(label_sides(dm));
  PetscCall(print(dm, "before"));

  PetscCall(DMLabelCreate(PETSC_COMM_SELF, "adapt", &adapt));
  PetscCall(mark(dm, adapt));
  PetscCall(DMAdaptLabel(dm, adapt, &adapted));
  PetscCall(DMLabelDestroy(&adapt));

  PetscCall(DMGetCoordinatesLocalSetUp(adapted));
  PetscCall(print(adapted, "after"));
  PetscCall(DMViewFromOptions(adapted, NULL, "-adapted_view"));
  PetscCall(DMDestroy(&adapted));
  PetscCall(DMDestroy(&dm));
  PetscCall(PetscFinalize());
  return 0;
}
