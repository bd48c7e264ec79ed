/* SPDX-License-Identifier: BSD-3-Clause */
/* A mesh from a file, refined to a size and improved: DMAdaptMetric() with HFRemesh.
 *   hfremesh generate cavity -o cavity.msh
 *   mpicc adapt_metric.c $(pkg-config --cflags --libs PETSc) -lm -o adapt_metric
 *   mpirun -n 2 ./adapt_metric -dm_plex_filename cavity.msh -dm_adaptor hfremesh \
 *     -dll_prepend /usr/lib/libhfremesh_petsc.so
 * The program knows nothing of HFRemesh: any that calls DMAdaptMetric() with a metric that is alike in all
 * directions is run so. */
#include <petscdmplex.h>
#include <petscsf.h>

/* Gives the faces of the boundary of the unit cube the label "surface". */
static PetscErrorCode label_surface(DM dm) {
  PetscInt begin, end;

  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocalSetUp(dm));
  PetscCall(DMCreateLabel(dm, "surface"));
  PetscCall(DMPlexGetHeightStratum(dm, 1, &begin, &end));
  for (PetscInt f = begin; f < end; ++f) {
    PetscReal area, x[3];
    PetscCall(DMPlexComputeCellGeometryFVM(dm, f, &area, x, NULL));
    for (int d = 0; d < 3; ++d)
      if (PetscAbsReal(x[d]) < 1e-9 || PetscAbsReal(x[d] - 1) < 1e-9)
        PetscCall(DMSetLabelValue(dm, "surface", f, 1));
  }
  PetscFunctionReturn(0);
}

/* Cells of all ranks, the longest edge, and the area of the side x = 0, whose faces PETSc has labelled: 6 of
 * the "Face Sets". */
static PetscErrorCode print(DM dm, const char* when) {
  MPI_Comm comm = PetscObjectComm((PetscObject)dm);
  PetscInt begin, end, n_faces = 0, n_cells;
  PetscReal longest = 0, surface = 0;
  IS faces = NULL;
  const PetscInt* face = NULL;

  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocalSetUp(dm));
  PetscCall(DMPlexGetDepthStratum(dm, 1, &begin, &end));
  for (PetscInt e = begin; e < end; ++e) {
    PetscReal length;
    PetscCall(DMPlexComputeCellGeometryFVM(dm, e, &length, NULL, NULL));
    longest = PetscMax(longest, length);
  }
  PetscCall(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  n_cells = end - begin;
  PetscCall(DMGetStratumIS(dm, "surface", 1, &faces));
  if (faces) {
    PetscCall(ISGetLocalSize(faces, &n_faces));
    PetscCall(ISGetIndices(faces, &face));
    for (PetscInt i = 0; i < n_faces; ++i) {
      PetscReal area;
      PetscCall(DMPlexComputeCellGeometryFVM(dm, face[i], &area, NULL, NULL));
      surface += area;
    }
    PetscCall(ISRestoreIndices(faces, &face));
    PetscCall(ISDestroy(&faces));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &n_cells, 1, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &longest, 1, MPIU_REAL, MPI_MAX, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &surface, 1, MPIU_REAL, MPI_SUM, comm));
  PetscCall(PetscPrintf(comm, "%s: %" PetscInt_FMT " cells, longest edge %.2f; the surface has area %g\n",
                        when, n_cells, (double)longest, (double)surface));
  PetscFunctionReturn(0);
}

int main(int argc, char** argv) {
  const PetscReal size = 0.07;
  DM dm, adapted;
  Vec metric;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(DMCreate(PETSC_COMM_WORLD, &dm));
  PetscCall(DMSetType(dm, DMPLEX));
  PetscCall(DMSetFromOptions(dm)); /* reads and distributes the mesh */
  PetscCall(label_surface(dm));
  PetscCall(print(dm, "before"));

  PetscCall(DMPlexMetricCreateUniform(dm, 0, 1 / (size * size), &metric));
  PetscCall(DMAdaptMetric(dm, metric, NULL, NULL, &adapted));
  PetscCall(VecDestroy(&metric));

  PetscCall(print(adapted, "after"));
  PetscCall(DMDestroy(&adapted));
  PetscCall(DMDestroy(&dm));
  PetscCall(PetscFinalize());
  return 0;
}
