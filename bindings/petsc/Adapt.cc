// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <new>
#include <span>

#include "Plex.hh"
#include "hfremesh/Distributed/Improve.hh"
#include "hfremesh/Distributed/InParts.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/Remesh/NamedOptions.hh"

namespace hfr::petsc {
namespace {

/// What came of the work of all ranks.
struct Outcome {
  NewPlex mine;         ///< what of it this rank gives
  Labelling labelling;  ///< names on all; values on the ranks that give something
  std::size_t n_cells_before = 0, n_cells = 0, n_invalid = 0;  ///< on rank 0, or on all in parts
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

void pack(const std::string& text, mpi::Packer& out) { out.put_all(std::span<const char>(text)); }

std::string unpack_text(mpi::Unpacker& in) {
  const std::vector<char> text = in.get_all<char>();
  return {text.begin(), text.end()};
}

/// The parts of all ranks, on rank 0.
std::vector<LocalPlex> gather(mpi::Comm& comm, const LocalPlex& mine) {
  std::vector<mpi::Packer> to(comm.n_ranks());
  mpi::Packer& out = to[0];
  out.put_all(std::span(mine.numbers).first(mine.n_own));
  out.put_all(std::span(mine.points).first(mine.n_own));
  out.put_all(mine.cells);
  out.put_all(mine.largest);
  out.put_all(mine.marks);
  out.put(static_cast<std::uint64_t>(mine.names.size()));
  for (const std::string& name : mine.names) pack(name, out);
  std::vector<LocalPlex> parts;
  for (const mpi::Comm::Message& message : comm.exchange(to)) {
    mpi::Unpacker in(message.bytes);
    LocalPlex& part = parts.emplace_back();
    part.numbers = in.get_all<std::int64_t>();
    part.points = in.get_all<Vec3>();
    part.n_own = part.points.size();
    part.cells = in.get_all<std::array<std::int64_t, 4>>();
    part.largest = in.get_all<double>();
    part.marks = in.get_all<Mark>();
    for (auto n = in.get<std::uint64_t>(); n > 0; --n) part.names.push_back(unpack_text(in));
  }
  return parts;
}

/// Names of labels, and whether they are closed, from rank 0 to all.
void share_labels(mpi::Comm& comm, Labelling& labelling) {
  mpi::Packer out;
  if (comm.rank() == 0) {
    out.put(static_cast<std::uint64_t>(labelling.labels.size()));
    for (const Labelling::Label& label : labelling.labels) {
      pack(label.name, out);
      out.put(label.is_closed);
    }
  }
  const std::vector<std::byte> bytes = comm.all_gather(std::span<const std::byte>(out.bytes()));
  if (comm.rank() == 0) return;
  mpi::Unpacker in(bytes);
  for (auto n = in.get<std::uint64_t>(); n > 0; --n) {
    const std::string name = unpack_text(in);
    labelling.labels.push_back({name, in.get<bool>()});
  }
}

/// On rank 0, which has the whole.
void work_together(mpi::Comm& comm, const LocalPlex& mine, const ImproveOptions& options, Outcome& outcome) {
  const std::vector<LocalPlex> parts = gather(comm, mine);
  if (comm.rank() == 0) {
    WholePlex whole = put_together(parts);
    outcome.n_cells_before = whole.mesh.n_cells();
    bisect(whole.mesh, whole.largest);
    outcome.n_invalid = mpi::improve(whole.mesh, options, comm).invalid_cells.size();
    outcome.n_cells = whole.mesh.n_cells();
    outcome.mine = new_plex(whole.mesh);
    outcome.labelling = std::move(whole.labelling);
    mpi::dismiss(comm);
  } else {
    mpi::serve(comm);
  }
  share_labels(comm, outcome.labelling);
}

/// What the whole is put together for nevertheless; empty where it can stay in parts.
std::string reason_against_parts(mpi::Comm& comm, const LocalPlex& mine, const ImproveOptions& options) {
  if (comm.size() == 1) return "one rank";
  const auto is_kept = [](double largest) { return largest == kKeep; };
  std::array<std::uint64_t, 2> ranks_with = {
      mine.cells.empty() ? 0U : 1U, std::all_of(mine.largest.begin(), mine.largest.end(), is_kept) ? 0U : 1U};
  comm.sum(ranks_with);
  if (ranks_with[0] <= 1) return "one rank has all cells";
  if (ranks_with[1] > 0) return "there are cells to refine";
  return mpi::reason_against(options);
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

/// Each rank on what it has. Where the mesh has what meshes in parts cannot have, nothing is done, and what
/// is returned says so, on all ranks.
std::string work_in_parts(MPI_Comm on, const LocalPlex& mine, const ImproveOptions& options,
                          Outcome& outcome) {
  mpi::Comm comm(on);
  mpi::DistributedMesh mesh(comm);
  try {
    with_all(comm, [&] { outcome.labelling = put_in_parts(mesh, mine); });
  } catch (const mpi::RankFailed& failed) {
    if (failed.code() != PETSC_ERR_ARG_WRONG) throw;
    outcome.labelling = {};
    return failed.what();
  }
  with_all(comm, [&] {
    const mpi::PartsResult result = mpi::improve(mesh, options);
    outcome.in_parts = true;
    outcome.n_cells_before = result.before.n_cells;
    outcome.n_cells = result.after.n_cells;
    outcome.n_invalid = result.after.n_invalid;
    outcome.mine = new_plex(mesh);
  });
  return {};
}

Outcome run(MPI_Comm on, const LocalPlex& mine, const ImproveOptions& options) {
  Outcome outcome;
  mpi::Comm comm(on);
  try {
    with_all(comm, [&] { outcome.why_together = reason_against_parts(comm, mine, options); });
    // With messages of its own: after a refusal they begin anew.
    if (outcome.why_together.empty()) outcome.why_together = work_in_parts(on, mine, options, outcome);
    if (!outcome.in_parts) with_all(comm, [&] { work_together(comm, mine, options, outcome); });
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

PetscErrorCode adapt_by(DM dm, DMLabel marks, DM* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  LocalPlex mine;
  ImproveOptions options;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  PetscCall(read_options(dm, &options));
  PetscCall(read_plex(dm, marks, &mine));
  const Outcome outcome = run(comm, mine, options);
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
  PetscCheck(
      !metric, PetscObjectComm(reinterpret_cast<PetscObject>(dm)), PETSC_ERR_SUP,
      "hfremesh has no adaptation to a metric yet: DMAdaptLabel() refines cells and improves the mesh");
  std::string wrong;
  PetscErrorCode code = PETSC_SUCCESS;
  try {  // callers are written in C
    code = adapt_by(dm, marks, out);
  } catch (const std::exception& error) {
    wrong = error.what();
  }
  PetscCheck(wrong.empty(), PETSC_COMM_SELF, PETSC_ERR_LIB, "hfremesh: %s", wrong.c_str());
  PetscCall(code);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace hfr::petsc
