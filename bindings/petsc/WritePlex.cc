// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "Plex.hh"
#include "hfremesh/HalfFace/Circulators.hh"

namespace hfr::petsc {
namespace {

/// `vertices`: their numbers over all ranks, ascending: so a rank's DMPlex has those of its cells.
PetscErrorCode create(MPI_Comm comm, const NewPlex& mine, std::vector<std::uint64_t>* vertices, DM* out) {
  std::vector<PetscInt> cells;
  std::vector<PetscReal> points;
  PetscInt begin = 0, end = 0;

  PetscFunctionBegin;
  for (const auto& v : mine.cells) {
    for (std::size_t i : {1, 0, 2, 3}) cells.push_back(static_cast<PetscInt>(v[i]));  // as PETSc has them
    vertices->insert(vertices->end(), v.begin(), v.end());
  }
  std::sort(vertices->begin(), vertices->end());
  vertices->erase(std::unique(vertices->begin(), vertices->end()), vertices->end());
  for (const Vec3& p : mine.points)
    for (int d = 0; d < 3; ++d) points.push_back(p[d]);
  PetscCall(DMPlexCreateFromCellListParallelPetsc(
      comm, 3, static_cast<PetscInt>(mine.cells.size()), static_cast<PetscInt>(mine.points.size()),
      PETSC_DECIDE, 4, PETSC_TRUE, cells.data(), 3, points.data(), nullptr, nullptr, out));
  PetscCall(DMPlexGetDepthStratum(*out, 0, &begin, &end));
  PetscCheck(static_cast<std::size_t>(end - begin) == vertices->size(), PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "a new DMPlex has %" PetscInt_FMT " vertices, and its cells %zu", end - begin, vertices->size());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Gives the points of this rank that have a value their labels again.
class Marker {
 public:
  /// `vertices`: see create().
  Marker(DM dm, const Labelling& labelling, const std::vector<std::uint64_t>& vertices)
      : dm_(dm), labelling_(labelling), vertices_(vertices) {}

  PetscErrorCode find_labels() {
    PetscFunctionBegin;
    for (const Labelling::Label& label : labelling_.labels) {
      labels_.emplace_back();
      PetscCall(DMGetLabel(dm_, label.name.c_str(), &labels_.back()));
    }
    PetscCall(DMPlexGetDepthStratum(dm_, 0, &first_vertex_, nullptr));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  PetscErrorCode mark_all(const NewPlex& mine) {
    PetscFunctionBegin;
    for (std::size_t c = 0; c < mine.regions.size(); ++c)
      PetscCall(mark(static_cast<PetscInt>(c), mine.regions[c]));
    for (const mpi::LabelRecord& record : mine.labels) PetscCall(mark(record));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  PetscErrorCode mark(PetscInt point, int number) {
    PetscFunctionBegin;
    if (number < 1) PetscFunctionReturn(PETSC_SUCCESS);
    for (const Labelling::Value& v : labelling_.values[static_cast<std::size_t>(number - 1)])
      PetscCall(DMLabelSetValue(labels_[static_cast<std::size_t>(v.label)], point, v.value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// The vertex, or the face or edge between these vertices.
  PetscErrorCode mark(const mpi::LabelRecord& record) {
    PetscInt v[3] = {}, n_given = 0, n = 0, begin = 0, end = 0, found = -1;
    const PetscInt* points = nullptr;

    PetscFunctionBegin;
    for (std::uint64_t number : record.v) {
      if (number == mpi::kNoNumber) continue;
      const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), number);
      if (at == vertices_.end() || *at != number) PetscFunctionReturn(PETSC_SUCCESS);  // no cell has it
      v[n_given++] = first_vertex_ + static_cast<PetscInt>(at - vertices_.begin());
    }
    if (n_given == 1) {
      PetscCall(mark(v[0], record.value));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(DMPlexGetDepthStratum(dm_, n_given - 1, &begin, &end));
    PetscCall(DMPlexGetFullJoin(dm_, n_given, v, &n, &points));
    for (PetscInt i = 0; i < n; ++i)
      if (points[i] >= begin && points[i] < end) found = points[i];
    PetscCall(DMPlexRestoreJoin(dm_, n_given, v, &n, &points));
    PetscCheck(found >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a labelled face or edge is not in the new mesh");
    PetscCall(mark(found, record.value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  DM dm_;
  const Labelling& labelling_;
  const std::vector<std::uint64_t>& vertices_;
  std::vector<DMLabel> labels_;
  PetscInt first_vertex_ = 0;
};

PetscErrorCode set_labels(DM dm, const NewPlex& mine, const std::vector<std::uint64_t>& vertices,
                          const Labelling& labelling) {
  Marker marker(dm, labelling, vertices);

  PetscFunctionBegin;
  for (const Labelling::Label& label : labelling.labels) PetscCall(DMCreateLabel(dm, label.name.c_str()));
  PetscCall(marker.find_labels());
  PetscCall(marker.mark_all(mine));
  for (const Labelling::Label& l : labelling.labels) {
    DMLabel label = nullptr;
    if (!l.is_closed) continue;
    PetscCall(DMGetLabel(dm, l.name.c_str(), &label));
    PetscCall(DMPlexLabelComplete(dm, label));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The way of cutting and the overlap of the old one. A partitioner that says what cell goes where says it of
/// old cells: it is left out.
PetscErrorCode distribute(DM old, DM* dm) {
  PetscPartitioner partitioner = nullptr;
  PetscBool is_shell = PETSC_FALSE;
  PetscInt overlap = 0;
  DM distributed = nullptr;

  PetscFunctionBegin;
  PetscCall(DMPlexGetPartitioner(old, &partitioner));
  PetscCall(
      PetscObjectTypeCompare(reinterpret_cast<PetscObject>(partitioner), PETSCPARTITIONERSHELL, &is_shell));
  if (!is_shell) PetscCall(DMPlexSetPartitioner(*dm, partitioner));
  PetscCall(DMPlexGetOverlap(old, &overlap));
  PetscCall(DMPlexDistribute(*dm, overlap, nullptr, &distributed));
  if (distributed) {
    PetscCall(DMDestroy(dm));
    *dm = distributed;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

NewPlex new_plex(const TetMesh& mesh) {
  using mpi::LabelRecord;
  NewPlex all;
  all.points.assign(mesh.points().begin(), mesh.points().end());
  for (CellHandle c : mesh.cells()) {
    auto& corners = all.cells.emplace_back();
    std::ranges::transform(mesh.cell_vertices(c), corners.begin(), [](VertexHandle v) { return v.idx(); });
    all.regions.push_back(mesh.region(c));
  }
  const auto add = [&](LabelRecord::Kind kind, const auto& vertices, int value) {
    LabelRecord r;
    r.kind = kind;
    r.value = value;
    std::ranges::transform(vertices, r.v.begin(), [](VertexHandle v) { return v.idx(); });
    all.labels.push_back(r);
  };
  const Labels& labels = mesh.labels();
  for (const auto& face : labels.faces.entries()) add(LabelRecord::Kind::kFace, face.vertices, face.value);
  for (const auto& edge : labels.edges.entries()) add(LabelRecord::Kind::kEdge, edge.vertices, edge.value);
  for (VertexHandle v : mesh.vertices())
    if (labels.vertex(v) != 0) add(LabelRecord::Kind::kVertex, std::array{v}, labels.vertex(v));
  return all;
}

PetscErrorCode write_plex(DM old, const NewPlex& mine, const Labelling& labelling, DM* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  PetscMPIInt n_ranks = 1;
  std::vector<std::uint64_t> vertices;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(old), &comm));
  PetscCallMPI(MPI_Comm_size(comm, &n_ranks));
  PetscCall(create(comm, mine, &vertices, out));
  PetscCall(set_labels(*out, mine, vertices, labelling));
  if (n_ranks > 1) PetscCall(distribute(old, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace hfr::petsc
