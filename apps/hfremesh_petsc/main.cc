// SPDX-License-Identifier: BSD-3-Clause
// hfremesh-petsc: a mesh from any file that PETSc reads, improved in parts by all ranks, and written as
// PETSc's HDF5, from which any other number of ranks reads it. docs/petsc.md tells the story.
#include <petscdmplex.h>
#include <petscsf.h>
#include <petscviewer.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "hfremesh_petsc.h"

// From 3.19 on.
#if PETSC_VERSION_LT(3, 19, 0)
#define PETSC_SUCCESS 0
#endif

namespace {

// As the other tools have them: docs/exit-codes.md.
constexpr int kWrongUsage = 1, kNoInput = 2, kStillInvalid = 4;

constexpr char kUsage[] =
    "Usage: hfremesh-petsc IN -o OUT.h5 [OPTION ...]\n"
    "\n"
    "Improves a mesh of tetrahedra with all ranks: mpirun -n 4 hfremesh-petsc in.h5 -o out.h5\n"
    "\n"
    "IN                       .h5 of PETSc, .msh, or what else DMPlexCreateFromFile() reads\n"
    "-o OUT.h5                where to write, as PETSc's HDF5, with all labels\n"
    "-dm_hfremesh_NAME VALUE  an option of hfremesh, with underscores: -dm_hfremesh_min_dihedral 15\n"
    "-NAME [VALUE]            an option of PETSc: -info :dm, -log_view\n";

struct Files {
  const char *in = nullptr, *out = nullptr;
};

/// What is no option of PETSc's; its options and their values are left to it. False where IN and OUT are not
/// both there, once.
bool parse(int argc, char** argv, Files& files) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "-o") == 0) {
      if (i + 1 == argc || files.out) return false;
      files.out = argv[++i];
    } else if (argv[i][0] == '-') {
      if (i + 1 < argc && argv[i + 1][0] != '-') ++i;
    } else {
      if (files.in) return false;
      files.in = argv[i];
    }
  }
  return files.in && files.out;
}

std::string part_of(const char* path) { return std::string(path) + ".part"; }

/// A line on what cannot be read or written, the same on all ranks; empty where both can. What HDF5 says of
/// that fills a page.
PetscErrorCode look_at(const Files& files, std::string* wrong, int* code) {
  PetscMPIInt rank = 0;
  int found = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    std::error_code error;
    if (!std::ifstream(files.in)) {
      found = 1;
    } else if (!std::ofstream(part_of(files.out))) {
      found = 2;
    } else {
      std::filesystem::remove(part_of(files.out), error);
    }
  }
  PetscCallMPI(MPI_Bcast(&found, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  if (found == 1) *wrong = std::string(files.in) + ": cannot be opened";
  if (found == 2) *wrong = std::string(files.out) + ": cannot be written";
  if (found > 0) *code = found == 1 ? kNoInput : kWrongUsage;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode read_mesh(const char* path, DM* dm) {
  PetscFunctionBegin;
  PetscCall(PetscOptionsSetValue(nullptr, "-dm_plex_filename", path));
  PetscCall(DMCreate(PETSC_COMM_WORLD, dm));
  PetscCall(DMSetType(*dm, DMPLEX));
  PetscCall(DMSetFromOptions(*dm));  // reads and distributes the mesh
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The file is whole or not there.
PetscErrorCode write_mesh(DM dm, const char* path) {
  PetscViewer viewer = nullptr;
  PetscMPIInt rank = 0;
  int failed = 0;
  const std::string part = part_of(path);

  PetscFunctionBegin;
  PetscCall(PetscObjectSetName(reinterpret_cast<PetscObject>(dm), "mesh"));
  PetscCall(PetscViewerCreate(PETSC_COMM_WORLD, &viewer));
  PetscCall(PetscViewerSetType(viewer, PETSCVIEWERHDF5));
  PetscCall(PetscViewerFileSetMode(viewer, FILE_MODE_WRITE));
  PetscCall(PetscViewerFileSetName(viewer, part.c_str()));
  PetscCall(PetscViewerPushFormat(viewer, PETSC_VIEWER_HDF5_PETSC));
  PetscCall(DMView(dm, viewer));
  PetscCall(PetscViewerPopFormat(viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    std::error_code error;
    std::filesystem::rename(part, path, error);
    failed = error ? 1 : 0;
  }
  PetscCallMPI(MPI_Bcast(&failed, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  PetscCheck(failed == 0, PETSC_COMM_WORLD, PETSC_ERR_FILE_WRITE, "%s cannot be given its name; it is %s",
             path, part.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Cells of all ranks, and how many of them are inverted or flat.
PetscErrorCode count(DM dm, std::array<PetscInt, 2>* counts) {
  PetscInt begin = 0, end = 0, n_leaves = 0;
  const PetscInt* leaves = nullptr;
  PetscSF sf = nullptr;
  const auto add = [&](PetscInt c, PetscInt times) {
    PetscReal v0[3], jacobian[9], inverse[9], det = 0;
    PetscCall(DMPlexComputeCellGeometryAffineFEM(dm, c, v0, jacobian, inverse, &det));
    (*counts)[0] += times;
    (*counts)[1] += det > 0 ? 0 : times;
    return static_cast<PetscErrorCode>(PETSC_SUCCESS);
  };

  PetscFunctionBegin;
  *counts = {};
  PetscCall(DMGetCoordinatesLocalSetUp(dm));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  for (PetscInt c = begin; c < end; ++c) PetscCall(add(c, 1));
  PetscCall(DMGetPointSF(dm, &sf));
  PetscCall(PetscSFGetGraph(sf, nullptr, &n_leaves, &leaves, nullptr));
  for (PetscInt i = 0; i < n_leaves; ++i)  // of an overlap: other ranks have counted these
    if (const PetscInt p = leaves ? leaves[i] : i; p >= begin && p < end) PetscCall(add(p, -1));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts->data(), 2, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode run(const Files& files, int* code) {
  DM dm = nullptr, improved = nullptr;
  std::array<PetscInt, 2> before{}, after{};

  PetscFunctionBegin;
  std::string wrong;
  PetscCall(look_at(files, &wrong, code));
  if (!wrong.empty()) {
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, PETSC_STDERR, "hfremesh-petsc: %s\n", wrong.c_str()));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(hfremesh_petsc_register());
  PetscCall(PetscOptionsSetValue(nullptr, "-dm_adaptor", "hfremesh"));
  PetscCall(read_mesh(files.in, &dm));
  PetscCall(count(dm, &before));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %" PetscInt_FMT " cells, %" PetscInt_FMT " inverted or flat\n",
                        files.in, before[0], before[1]));
  PetscCall(DMAdaptLabel(dm, nullptr, &improved));
  PetscCall(DMDestroy(&dm));
  PetscCall(count(improved, &after));
  PetscCall(write_mesh(improved, files.out));
  PetscCall(DMDestroy(&improved));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %" PetscInt_FMT " cells, %" PetscInt_FMT " inverted or flat\n",
                        files.out, after[0], after[1]));
  if (after[1] > 0) *code = kStillInvalid;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

int main(int argc, char** argv) {
  Files files;
  int code = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, nullptr, kUsage));
  if (argc == 2 && std::strcmp(argv[1], "--help") == 0) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s", kUsage));
  } else if (argc == 2 && std::strcmp(argv[1], "--version") == 0) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "hfremesh-petsc %s\n", HFR_VERSION));
  } else if (parse(argc, argv, files)) {
    PetscCall(run(files, &code));
  } else {
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, PETSC_STDERR, "%s", kUsage));
    code = kWrongUsage;
  }
  PetscCall(PetscFinalize());
  return code;
}
