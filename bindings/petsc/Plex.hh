// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PETSC_PLEX_HH
#define HFR_BINDINGS_PETSC_PLEX_HH

#include <petscdmplex.h>
#include <petscsf.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hfremesh/Distributed/DistributedMesh.hh"
#include "hfremesh/Distributed/RankArrays.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

// From 3.19 on.
#if PETSC_VERSION_LT(3, 19, 0)
#define PETSC_SUCCESS 0
#endif

/// How a DMPlex goes to the library and back. Functions that return a PetscErrorCode throw nothing, the
/// others call nothing of PETSc.
namespace hfr::petsc {

/// A value of a label at a point: cell, face, edge or vertex.
struct Mark {
  int label = 0;  ///< index into the names
  int value = 0;
  int n = 0;                    ///< vertices of the point
  std::array<Index, 4> v = {};  ///< these, by their index on this rank
};

/// What one rank has of a DMPlex: of each point one rank alone, but for vertices.
struct LocalPlex {
  std::vector<std::int64_t> numbers;    ///< of the vertices, over all ranks
  std::vector<Vec3> points;             ///< of the vertices
  std::vector<std::uint8_t> is_shared;  ///< by vertex: other ranks have it, too
  std::vector<std::array<Index, 4>> cells;
  /// By cell: the largest volume that it may have; kKeep for any, kRefine for an eighth of what it has.
  std::vector<double> largest;
  /// By vertex, or none: how long edges are to be there; those longer than √2 times that are halved.
  std::vector<double> sizes;
  std::vector<std::string> names;  ///< of the labels
  std::vector<Mark> marks;
};
inline constexpr double kKeep = 0, kRefine = -1;

/// `metric`: of vertices, or nullptr; then `marks` count, DM_ADAPT_REFINE and so on, which are not carried
/// over, or where these are nullptr, too, the limits of the DM.
PetscErrorCode read_plex(DM dm, Vec metric, DMLabel marks, LocalPlex* out);

/// Labels of a DMPlex as one number a point: what a mesh keeps. A number stands for a set of labels with
/// values.
struct Labelling {
  struct Label {
    std::string name;
    /// Each point of the closure of a point that has the label has it, too. Then only what is no part of
    /// another such closure is kept as a constraint, and closures are labelled again in the end.
    bool is_closed = false;
  };
  struct Value {
    int label = 0, value = 0;
    auto operator<=>(const Value&) const = default;
  };
  std::vector<Label> labels;               ///< by name
  std::vector<std::vector<Value>> values;  ///< of the numbers from 1 on
};

/// What one rank has, halved where it is larger than it may be, with numbers that do not depend on how
/// cells and vertices were distributed and numbered, as long as no two vertices have one place: vertices
/// stand in the order of their coordinates, cells in that of their vertices.
struct Arrangement {
  mpi::RankArrays arrays;  ///< labels and regions are those of `labelling`
  Labelling labelling;     ///< the same on all ranks
};
/// All take part.
Arrangement arrange(mpi::Comm& comm, LocalPlex mine);

/// The mesh of what all ranks have, on rank 0; an empty one elsewhere. All take part.
TetMesh put_together(mpi::Comm& comm, const mpi::RankArrays& mine);

/// What one rank gives of a new DMPlex.
struct NewPlex {
  /// Of its share of all vertices, by number: ranks have about as many each.
  std::vector<Vec3> points;
  std::vector<std::array<std::uint64_t, 4>> cells;  ///< numbers of their vertices
  std::vector<std::int32_t> regions;                ///< by cell, or none
  std::vector<mpi::LabelRecord> labels;             ///< of faces, edges and vertices of these cells
};
NewPlex new_plex(const TetMesh& mesh);         ///< all of it
NewPlex new_plex(mpi::DistributedMesh& mesh);  ///< the cells of each rank; all take part

/// The new DMPlex, interpolated and with labels, on the ranks of `old`; collective. `mine`: what each rank
/// gives, maybe nothing; `labelling`: what its values stand for, the same on all ranks.
PetscErrorCode write_plex(DM old, const NewPlex& mine, const Labelling& labelling, DM* out);

/// The adaptor: DMGenerateRegister() takes it. `metric`: of DMAdaptMetric(), with the labels that it names,
/// which are carried over like all others; nullptr, then `marks` is the label of DMAdaptLabel().
PetscErrorCode adapt(DM dm, Vec metric, DMLabel marks, DMLabel, DM* out);

}  // namespace hfr::petsc

#endif
