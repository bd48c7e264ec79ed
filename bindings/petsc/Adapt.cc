// SPDX-License-Identifier: BSD-3-Clause
#include <new>
#include <string>
#include <utility>

#include "Plex.hh"
#include "hfremesh/Distributed/Improve.hh"
#include "hfremesh/Distributed/InParts.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/Remesh/NamedOptions.hh"

namespace hfr::petsc {
namespace {

/// What came of the work of all ranks.
struct Outcome {
  NewPlex mine;                                                ///< what of it this rank gives
  Labelling labelling;                                         ///< of all ranks
  std::size_t n_cells_before = 0, n_cells = 0, n_invalid = 0;  ///< the latter on rank 0, or on all in parts
  bool in_parts = false;
  std::string why_together;  ///< where they are not
  int code = 0;              ///< of PETSc, and the same everywhere; 0: all is well
  std::string line;          ///< what went wrong
};

int code_of(const std::exception& error) {
  if (dynamic_cast<const InvalidInput*>(&error)) return PETSC_ERR_ARG_WRONG;
  if (dynamic_cast<const ResourceLimit*>(&error) || dynamic_cast<const std::bad_alloc*>(&error))
    return PETSC_ERR_MEM;
  if (dynamic_cast<const InternalError*>(&error)) return PETSC_ERR_PLIB;
  return PETSC_ERR_LIB;
}

/// On rank 0, which has the whole.
void work_together(mpi::Comm& comm, const mpi::RankArrays& mine, const ImproveOptions& options,
                   Outcome& outcome) {
  TetMesh mesh = put_together(comm, mine);
  if (comm.rank() > 0) {
    mpi::serve(comm);
    return;
  }
  outcome.n_invalid = mpi::improve(mesh, options, comm).invalid_cells.size();
  outcome.n_cells = mesh.n_cells();
  outcome.mine = new_plex(mesh);
  mpi::dismiss(comm);
}

/// What the whole is put together for nevertheless; empty where it can stay in parts.
std::string reason_against_parts(const mpi::Comm& comm, const ImproveOptions& options) {
  return comm.size() == 1 ? "one rank" : mpi::reason_against(options);
}

/// What fails on one rank ends on all of them: with the code of PETSc, as RankFailed.
template <class Act>
void with_all(mpi::Comm& comm, Act&& act) {
  try {
    act();
  } catch (const mpi::RankFailed&) {
    throw;
  } catch (const std::exception& error) {
    throw comm.fail(code_of(error), error.what());
  }
}

/// Each rank on what it has, which is given up.
void work_in_parts(mpi::Comm& comm, mpi::RankArrays& mine, const ImproveOptions& options, Outcome& outcome) {
  mpi::DistributedMesh mesh(comm);
  mpi::from_arrays(mesh, mine, mpi::Keep::kIfEven);
  mine = {};
  const mpi::PartsResult result = mpi::improve(mesh, options);
  outcome.in_parts = true;
  outcome.n_cells = result.after.n_cells;
  outcome.n_invalid = result.after.n_invalid;
  outcome.mine = new_plex(mesh);
}

Outcome run(MPI_Comm on, LocalPlex mine, const ImproveOptions& options) {
  Outcome outcome;
  mpi::Comm comm(on);
  try {
    with_all(comm, [&] {
      outcome.n_cells_before = comm.sum(mine.cells.size());
      Arrangement arranged = arrange(comm, std::move(mine));
      outcome.labelling = std::move(arranged.labelling);
      outcome.why_together = reason_against_parts(comm, options);
      if (outcome.why_together.empty())
        work_in_parts(comm, arranged.arrays, options, outcome);
      else
        work_together(comm, arranged.arrays, options, outcome);
    });
  } catch (const mpi::RankFailed& failed) {
    outcome.code = failed.code();
    outcome.line = failed.what();
  }
  return outcome;
}

/// -dm_hfremesh_NAME for each option that has one text; docs/petsc.md lists them.
PetscErrorCode read_options(DM dm, ImproveOptions* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  PetscMPIInt n_ranks = 1;
  PetscOptions database = nullptr;
  const char* prefix = nullptr;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  PetscCallMPI(MPI_Comm_size(comm, &n_ranks));
  if (n_ranks > 1) out->policy.threads = 1;
  out->statistics = false;
  PetscCall(PetscObjectGetOptions(reinterpret_cast<PetscObject>(dm), &database));
  PetscCall(PetscObjectGetOptionsPrefix(reinterpret_cast<PetscObject>(dm), &prefix));
  for (const NamedOption& option : named_options()) {
    char value[PETSC_MAX_PATH_LEN] = {};
    PetscBool is_set = PETSC_FALSE;
    if (option.repeats) continue;
    const std::string name = std::string("-dm_hfremesh_") + option.name;
    PetscCall(PetscOptionsGetString(database, prefix, name.c_str(), value, sizeof(value), &is_set));
    if (!is_set) continue;
    std::string wrong;
    try {
      set_option(*out, option.name, value[0] ? value : "true");
    } catch (const std::exception& error) {
      wrong = error.what();
    }
    PetscCheck(wrong.empty(), comm, PETSC_ERR_ARG_OUTOFRANGE, "%s: %s", name.c_str(), wrong.c_str());
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode adapt_by(DM dm, Vec metric, DMLabel marks, DM* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  LocalPlex mine;
  ImproveOptions options;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  PetscCall(read_options(dm, &options));
  PetscCall(read_plex(dm, metric, marks, &mine));
  const Outcome outcome = run(comm, std::move(mine), options);
  PetscCheck(outcome.code == 0, comm, static_cast<PetscErrorCode>(outcome.code), "hfremesh: %s",
             outcome.line.c_str());
  PetscCall(PetscInfo(dm, "hfremesh: %zu cells before, %zu after, %zu of them inverted or flat; %s%s\n",
                      outcome.n_cells_before, outcome.n_cells, outcome.n_invalid,
                      outcome.in_parts ? "in parts" : "put together: ", outcome.why_together.c_str()));
  PetscCall(write_plex(dm, outcome.mine, outcome.labelling, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode adapt(DM dm, Vec metric, DMLabel marks, DMLabel, DM* out) {
  PetscFunctionBegin;
  if (metric) {
    PetscBool is_uniform = PETSC_FALSE, is_isotropic = PETSC_FALSE;
    PetscCall(DMPlexMetricIsUniform(dm, &is_uniform));
    PetscCall(DMPlexMetricIsIsotropic(dm, &is_isotropic));
    PetscCheck(
        is_uniform || is_isotropic, PetscObjectComm(reinterpret_cast<PetscObject>(dm)), PETSC_ERR_SUP,
        "hfremesh adapts to sizes that are alike in all directions, and this metric may be another one: "
        "DMPlexMetricCreateUniform() and DMPlexMetricCreateIsotropic() make such");
  }
  std::string wrong;
  PetscErrorCode code = PETSC_SUCCESS;
  try {  // callers are written in C
    code = adapt_by(dm, metric, metric ? nullptr : marks, out);
  } catch (const std::exception& error) {
    wrong = error.what();
  }
  PetscCheck(wrong.empty(), PETSC_COMM_SELF, PETSC_ERR_LIB, "hfremesh: %s", wrong.c_str());
  PetscCall(code);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace hfr::petsc
