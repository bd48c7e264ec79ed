// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "Plex.hh"
#include "hfremesh/HalfFace/Circulators.hh"

namespace hfr::petsc {
namespace {

PetscErrorCode create(MPI_Comm comm, const TetMesh* mesh, DM* out) {
  std::vector<PetscInt> cells;
  std::vector<PetscReal> points;
  PetscInt n_cells = 0, n_vertices = 0;

  PetscFunctionBegin;
  if (mesh) {
    n_cells = static_cast<PetscInt>(mesh->n_cells());
    n_vertices = static_cast<PetscInt>(mesh->n_vertices());
    for (CellHandle c : mesh->cells()) {
      const auto& v = mesh->cell_vertices(c);
      for (std::size_t i : {1, 0, 2, 3})
        cells.push_back(static_cast<PetscInt>(v[i].idx()));  // as PETSc has them
    }
    for (VertexHandle v : mesh->vertices())
      for (int d = 0; d < 3; ++d) points.push_back(mesh->point(v)[d]);
  }
  PetscCall(DMPlexCreateFromCellListParallelPetsc(comm, 3, n_cells, n_vertices, PETSC_DECIDE, 4, PETSC_TRUE,
                                                  cells.data(), 3, points.data(), nullptr, nullptr, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0: gives the points with number `number` their labels again.
class Marker {
 public:
  Marker(DM dm, const Labelling& labelling) : dm_(dm), labelling_(labelling) {}

  PetscErrorCode find_labels() {
    PetscFunctionBegin;
    for (const Labelling::Label& label : labelling_.labels) {
      labels_.emplace_back();
      PetscCall(DMGetLabel(dm_, label.name.c_str(), &labels_.back()));
    }
    PetscCall(DMPlexGetDepthStratum(dm_, 0, &first_vertex_, nullptr));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  PetscErrorCode mark(PetscInt point, int number) {
    PetscFunctionBegin;
    if (number < 1) PetscFunctionReturn(PETSC_SUCCESS);
    for (const Labelling::Value& v : labelling_.values[static_cast<std::size_t>(number - 1)])
      PetscCall(DMLabelSetValue(labels_[static_cast<std::size_t>(v.label)], point, v.value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// The face or edge between vertices.
  template <std::size_t N>
  PetscErrorCode mark(const std::array<VertexHandle, N>& vertices, int number) {
    PetscInt v[N], n = 0, begin = 0, end = 0, found = -1;
    const PetscInt* points = nullptr;

    PetscFunctionBegin;
    for (std::size_t i = 0; i < N; ++i) v[i] = first_vertex_ + static_cast<PetscInt>(vertices[i].idx());
    PetscCall(DMPlexGetDepthStratum(dm_, N - 1, &begin, &end));
    PetscCall(DMPlexGetFullJoin(dm_, N, v, &n, &points));
    for (PetscInt i = 0; i < n; ++i)
      if (points[i] >= begin && points[i] < end) found = points[i];
    PetscCall(DMPlexRestoreJoin(dm_, N, v, &n, &points));
    PetscCheck(found >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a labelled face or edge is not in the new mesh");
    PetscCall(mark(found, number));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  PetscErrorCode mark_all(const TetMesh& mesh) {
    const Labels& labels = mesh.labels();

    PetscFunctionBegin;
    for (CellHandle c : mesh.cells()) PetscCall(mark(static_cast<PetscInt>(c.idx()), mesh.region(c)));
    for (const auto& face : labels.faces.entries()) PetscCall(mark(face.vertices, face.value));
    for (const auto& edge : labels.edges.entries()) PetscCall(mark(edge.vertices, edge.value));
    for (VertexHandle v : mesh.vertices())
      PetscCall(mark(first_vertex_ + static_cast<PetscInt>(v.idx()), labels.vertex(v)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  DM dm_;
  const Labelling& labelling_;
  std::vector<DMLabel> labels_;
  PetscInt first_vertex_ = 0;
};

PetscErrorCode set_labels(DM dm, const TetMesh* mesh, const Labelling& labelling) {
  Marker marker(dm, labelling);

  PetscFunctionBegin;
  for (const Labelling::Label& label : labelling.labels) PetscCall(DMCreateLabel(dm, label.name.c_str()));
  if (mesh) {
    PetscCall(marker.find_labels());
    PetscCall(marker.mark_all(*mesh));
  }
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

PetscErrorCode write_plex(DM old, const TetMesh* mesh, const Labelling& labelling, DM* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  PetscMPIInt n_ranks = 1;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(old), &comm));
  PetscCallMPI(MPI_Comm_size(comm, &n_ranks));
  PetscCall(create(comm, mesh, out));
  PetscCall(set_labels(*out, mesh, labelling));
  if (n_ranks > 1) PetscCall(distribute(old, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace hfr::petsc
