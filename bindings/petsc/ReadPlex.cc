// SPDX-License-Identifier: BSD-3-Clause
#include <climits>
#include <cmath>
#include <cstring>
#include <new>

#include "Plex.hh"

namespace hfr::petsc {
namespace {

/// Points of a DMPlex and who has them.
struct Points {
  DM dm = nullptr;
  PetscInt begin[4] = {}, end[4] = {};  ///< by dimension
  PetscInt first = 0;                   ///< of the chart
  std::vector<std::uint8_t> is_other;   ///< of the chart: another rank has the point
  std::vector<std::uint8_t> is_shared;  ///< of the chart: more than one rank know of it

  bool is_mine(PetscInt p) const { return !is_other[static_cast<std::size_t>(p - first)]; }
};

/// Collective: ranks without cells have to hear of it, too.
PetscErrorCode require_cells_of_type(DM dm, MPI_Comm comm) {
  PetscInt begin = 0, end = 0;
  int other = -1;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  for (PetscInt c = begin; c < end; ++c) {
    DMPolytopeType type = DM_POLYTOPE_UNKNOWN;
    PetscCall(DMPlexGetCellType(dm, c, &type));
    if (type != DM_POLYTOPE_TETRAHEDRON) other = type;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &other, 1, MPI_INT, MPI_MAX, comm));
  PetscCheck(other < 0, comm, PETSC_ERR_SUP, "hfremesh adapts tetrahedra; there are cells of type %s",
             DMPolytopeTypes[other]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode require_tetrahedra(DM dm) {
  PetscInt dim = 0, coordinate_dim = 0;
  PetscBool is_plex = PETSC_FALSE, is_localized = PETSC_FALSE;
  DMPlexInterpolatedFlag interpolated = DMPLEX_INTERPOLATED_INVALID;
  MPI_Comm comm = MPI_COMM_NULL;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(dm), DMPLEX, &is_plex));
  PetscCheck(is_plex, comm, PETSC_ERR_SUP, "hfremesh adapts a DMPlex, and no other DM");
  PetscCall(DMGetDimension(dm, &dim));
  PetscCall(DMGetCoordinateDim(dm, &coordinate_dim));
  PetscCheck(dim == 3 && coordinate_dim == 3, comm, PETSC_ERR_SUP,
             "hfremesh adapts meshes of dimension 3; this one has %" PetscInt_FMT
             ", in space of %" PetscInt_FMT,
             dim, coordinate_dim);
  PetscCall(DMPlexIsInterpolatedCollective(dm, &interpolated));
  PetscCheck(interpolated == DMPLEX_INTERPOLATED_FULL, comm, PETSC_ERR_SUP,
             "hfremesh needs faces and edges: call DMPlexInterpolate() before");
  PetscCall(DMGetCoordinatesLocalized(dm, &is_localized));
  PetscCheck(!is_localized, comm, PETSC_ERR_SUP, "hfremesh does not adapt periodic meshes");
  PetscCall(require_cells_of_type(dm, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_points(DM dm, Points* out) {
  PetscSF sf = nullptr;
  PetscInt end = 0, n_roots = 0, n_leaves = 0;
  const PetscInt *leaves = nullptr, *n_copies = nullptr;

  PetscFunctionBegin;
  out->dm = dm;
  for (int d = 0; d < 4; ++d) PetscCall(DMPlexGetDepthStratum(dm, d, &out->begin[d], &out->end[d]));
  PetscCall(DMPlexGetChart(dm, &out->first, &end));
  out->is_other.assign(static_cast<std::size_t>(end - out->first), 0);
  PetscCall(DMGetPointSF(dm, &sf));
  PetscCall(PetscSFGetGraph(sf, &n_roots, &n_leaves, &leaves, nullptr));
  for (PetscInt i = 0; i < n_leaves; ++i)  // -1 leaves where nothing is shared
    out->is_other[static_cast<std::size_t>((leaves ? leaves[i] : i) - out->first)] = 1;
  out->is_shared = out->is_other;
  if (n_roots >= 0) {
    PetscCall(PetscSFComputeDegreeBegin(sf, &n_copies));
    PetscCall(PetscSFComputeDegreeEnd(sf, &n_copies));
    for (PetscInt p = 0; p < n_roots; ++p)
      if (n_copies[p] > 0) out->is_shared[static_cast<std::size_t>(p - out->first)] = 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// What there is to know of a point from its closure.
struct Closure {
  std::array<Index, 4> v = {};  ///< its vertices, in the order in which PETSc has them
  int n = 0;                    ///< of them
  bool is_to_refine = false;    ///< a point of it is marked DM_ADAPT_REFINE
  int unknown = DM_ADAPT_KEEP;  ///< a flag of a point of it that is none of PETSc's
};

/// `marks` may be nullptr.
PetscErrorCode look_at(const Points& points, PetscInt p, DMLabel marks, Closure* out) {
  PetscInt size = 0;
  PetscInt* closure = nullptr;

  PetscFunctionBegin;
  *out = {};
  PetscCall(DMPlexGetTransitiveClosure(points.dm, p, PETSC_TRUE, &size, &closure));
  for (PetscInt i = 0; i < size; ++i) {
    const PetscInt q = closure[2 * i];
    PetscInt flag = DM_ADAPT_KEEP;
    if (marks) PetscCall(DMLabelGetValue(marks, q, &flag));
    if (flag < DM_ADAPT_DETERMINE || flag > DM_ADAPT_COARSEN) out->unknown = static_cast<int>(flag);
    out->is_to_refine = out->is_to_refine || flag == DM_ADAPT_REFINE;
    if (q >= points.begin[0] && q < points.end[0] && out->n < 4)
      out->v[static_cast<std::size_t>(out->n++)] = static_cast<Index>(q - points.begin[0]);
  }
  PetscCall(DMPlexRestoreTransitiveClosure(points.dm, p, PETSC_TRUE, &size, &closure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode read_vertices(const Points& points, LocalPlex* out) {
  PetscSection section = nullptr;
  Vec coordinates = nullptr;
  const PetscScalar* x = nullptr;
  IS numbers = nullptr;
  const PetscInt* number = nullptr;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateSection(points.dm, &section));
  PetscCall(DMGetCoordinatesLocal(points.dm, &coordinates));
  PetscCall(DMPlexGetVertexNumbering(points.dm, &numbers));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(ISGetIndices(numbers, &number));
  for (PetscInt v = points.begin[0]; v < points.end[0]; ++v) {
    const PetscInt global = number[v - points.begin[0]];  // -1 - n of others' ones
    PetscInt at = 0;
    PetscCall(PetscSectionGetOffset(section, v, &at));
    out->numbers.push_back(global < 0 ? -(global + 1) : global);
    out->points.push_back({PetscRealPart(x[at]), PetscRealPart(x[at + 1]), PetscRealPart(x[at + 2])});
    out->is_shared.push_back(points.is_shared[static_cast<std::size_t>(v - points.first)]);
  }
  PetscCall(ISRestoreIndices(numbers, &number));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// What DMRefine() sets: a volume for all cells, or one by place.
PetscErrorCode refinement_limit(const Points& points, PetscInt c, double* out) {
  PetscReal limit = 0, volume = 0, centroid[3] = {};
  PetscErrorCode (*function)(const PetscReal[], PetscReal*) = nullptr;

  PetscFunctionBegin;
  PetscCall(DMPlexGetRefinementFunction(points.dm, &function));
  PetscCall(DMPlexGetRefinementLimit(points.dm, &limit));
  if (function) {
    PetscCall(DMPlexComputeCellGeometryFVM(points.dm, c, &volume, centroid, nullptr));
    PetscCall((*function)(centroid, &limit));
  }
  *out = limit > 0 ? static_cast<double>(limit) : kKeep;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The one value of a metric that is the same everywhere, from whichever rank has it; 0 where it is not.
PetscErrorCode uniform_value(DM dm, Vec metric, double* out) {
  PetscBool is_uniform = PETSC_FALSE;
  const PetscScalar* m = nullptr;
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(DMPlexMetricIsUniform(dm, &is_uniform));
  if (!is_uniform) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetLocalSize(metric, &n));
  PetscCall(VecGetArrayRead(metric, &m));
  if (n > 0) *out = PetscRealPart(m[0]);
  PetscCall(VecRestoreArrayRead(metric, &m));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, out, 1, MPI_DOUBLE, MPI_MAX,
                             PetscObjectComm(reinterpret_cast<PetscObject>(dm))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Of a metric that is alike in all directions, which is 1 / size² at each vertex; `uniform`: everywhere,
/// unless it is 0. `wrong`: one is no positive number.
PetscErrorCode read_sizes(const Points& points, Vec metric, double uniform, LocalPlex* out, int* wrong) {
  DM dm = nullptr;
  PetscSection section = nullptr;
  const PetscScalar* m = nullptr;
  PetscInt n = 0;

  PetscFunctionBegin;
  if (uniform == 0) {
    PetscCall(VecGetDM(metric, &dm));
    if (dm) PetscCall(DMGetLocalSection(dm, &section));
  }
  PetscCall(VecGetLocalSize(metric, &n));
  PetscCall(VecGetArrayRead(metric, &m));
  for (PetscInt v = points.begin[0]; v < points.end[0]; ++v) {
    PetscInt at = n;
    if (section) PetscCall(PetscSectionGetOffset(section, v, &at));
    const double value = uniform != 0 ? uniform : at < n ? static_cast<double>(PetscRealPart(m[at])) : 0.0;
    if (!(value > 0 && std::isfinite(value))) *wrong = 1;
    out->sizes.push_back(1 / std::sqrt(value));
  }
  PetscCall(VecRestoreArrayRead(metric, &m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// `unknown`: a flag of some point that is none of PETSc's.
PetscErrorCode read_cells(const Points& points, DMLabel marks, bool has_limits, LocalPlex* out,
                          int* unknown) {
  PetscFunctionBegin;
  for (PetscInt c = points.begin[3]; c < points.end[3]; ++c) {
    Closure closure;
    double largest = kKeep;
    if (!points.is_mine(c)) continue;
    PetscCall(look_at(points, c, marks, &closure));
    if (closure.unknown != DM_ADAPT_KEEP) *unknown = closure.unknown;
    if (has_limits) PetscCall(refinement_limit(points, c, &largest));
    out->cells.push_back(closure.v);
    out->largest.push_back(closure.is_to_refine ? kRefine : largest);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode read_label(const Points& points, DMLabel label, LocalPlex* out) {
  const char* name = nullptr;
  IS values = nullptr;
  const PetscInt* value = nullptr;
  PetscInt n_values = 0;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName(reinterpret_cast<PetscObject>(label), &name));
  out->names.emplace_back(name);
  PetscCall(DMLabelGetValueIS(label, &values));
  PetscCall(ISGetLocalSize(values, &n_values));
  PetscCall(ISGetIndices(values, &value));
  for (PetscInt i = 0; i < n_values; ++i) {
    IS stratum = nullptr;
    const PetscInt* point = nullptr;
    PetscInt n_points = 0;
    PetscCall(DMLabelGetStratumIS(label, value[i], &stratum));
    if (!stratum) continue;
    PetscCall(ISGetLocalSize(stratum, &n_points));
    PetscCall(ISGetIndices(stratum, &point));
    for (PetscInt j = 0; j < n_points; ++j) {
      if (!points.is_mine(point[j])) continue;
      Closure closure;
      PetscCall(look_at(points, point[j], nullptr, &closure));
      out->marks.push_back(
          {static_cast<int>(out->names.size()) - 1, static_cast<int>(value[i]), closure.n, closure.v});
    }
    PetscCall(ISRestoreIndices(stratum, &point));
    PetscCall(ISDestroy(&stratum));
  }
  PetscCall(ISRestoreIndices(values, &value));
  PetscCall(ISDestroy(&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Labels that a DMPlex makes of its points itself.
bool is_of_points(const char* name) {
  for (const char* own : {"depth", "celltype"})
    if (std::strcmp(name, own) == 0) return true;
  return false;
}

PetscErrorCode read_labels(const Points& points, DMLabel marks, LocalPlex* out) {
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(DMGetNumLabels(points.dm, &n));
  for (PetscInt i = 0; i < n; ++i) {
    const char* name = nullptr;
    DMLabel label = nullptr;
    PetscCall(DMGetLabelName(points.dm, i, &name));
    PetscCall(DMGetLabelByNum(points.dm, i, &label));
    if (!is_of_points(name) && label != marks) PetscCall(read_label(points, label, out));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode read_plex(DM dm, Vec metric, DMLabel marks, LocalPlex* out) {
  MPI_Comm comm = MPI_COMM_NULL;
  Points points;
  // What goes wrong on one rank ends all of them: a flag that is none, and no memory.
  struct {
    int unknown = INT_MIN, no_memory = 0, size = 0;
  } wrong;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm(reinterpret_cast<PetscObject>(dm), &comm));
  PetscCall(require_tetrahedra(dm));
  PetscCall(DMGetCoordinatesLocalSetUp(dm));  // or asking for one point is collective
  PetscCall(find_points(dm, &points));
  double uniform = 0;
  if (metric) PetscCall(uniform_value(dm, metric, &uniform));
  try {
    PetscCall(read_vertices(points, out));
    if (metric) PetscCall(read_sizes(points, metric, uniform, out, &wrong.size));
    PetscCall(read_cells(points, marks, !metric && !marks, out, &wrong.unknown));
    PetscCall(read_labels(points, marks, out));
  } catch (const std::bad_alloc&) {
    wrong.no_memory = 1;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wrong, 3, MPI_INT, MPI_MAX, comm));
  PetscCheck(!wrong.no_memory, comm, PETSC_ERR_MEM, "hfremesh: not enough memory for the mesh");
  PetscCheck(!wrong.size, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "hfremesh: the metric has a value that is not above 0, or none at a vertex");
  PetscCheck(wrong.unknown == INT_MIN, comm, PETSC_ERR_SUP,
             "hfremesh knows DM_ADAPT_DETERMINE, KEEP, REFINE and COARSEN; a point has flag %d",
             wrong.unknown);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace hfr::petsc
