// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <petscdmplex.h>
#include <petscsf.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "ScratchFolder.hh"
#include "hfremesh/HalfFace/Generate.hh"

namespace hfr::test {
namespace {

using testing::HasSubstr;

void ok(PetscErrorCode code) { EXPECT_EQ(code, 0); }

/// A DM that goes away by itself.
class Plex {
 public:
  Plex() = default;
  Plex(Plex&& other) noexcept : dm_(std::exchange(other.dm_, nullptr)) {}
  Plex& operator=(Plex&& other) noexcept {
    std::swap(dm_, other.dm_);
    return *this;
  }
  ~Plex() {
    if (dm_) ok(DMDestroy(&dm_));
  }
  DM get() const { return dm_; }
  DM* out() { return &dm_; }

 private:
  DM dm_ = nullptr;
};

MPI_Comm comm_of(DM dm) { return PetscObjectComm(reinterpret_cast<PetscObject>(dm)); }

int n_ranks(MPI_Comm comm) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}

/// Begin and end of the points of one dimension.
std::array<PetscInt, 2> points(DM dm, PetscInt depth) {
  std::array<PetscInt, 2> range = {};
  ok(DMPlexGetDepthStratum(dm, depth, &range[0], &range[1]));
  return range;
}

DMLabel label_of(DM dm, const char* name) {
  DMLabel label = nullptr;
  ok(DMGetLabel(dm, name, &label));
  return label;
}

std::array<double, 3> centre(DM dm, PetscInt p) {
  std::array<double, 3> x = {};
  PetscReal size = 0;
  ok(DMPlexComputeCellGeometryFVM(dm, p, &size, x.data(), nullptr));
  return x;
}

double size_of(DM dm, PetscInt p) {
  PetscReal size = 0;
  ok(DMPlexComputeCellGeometryFVM(dm, p, &size, nullptr, nullptr));
  return size;
}

/// A mesh of the unit cube on all ranks of `comm`: "sides" are the faces of its surface, 1 to 6; "halves"
/// cells, 1 where x < 1/2 and 2 elsewhere.
Plex cube(MPI_Comm comm, const generate::Arrays& arrays, PetscInt overlap = 0) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::vector<PetscInt> cells;
  std::vector<PetscReal> x;
  if (rank == 0) {
    for (const auto& v : arrays.cells)
      for (int i : {1, 0, 2, 3}) cells.push_back(static_cast<PetscInt>(v[static_cast<std::size_t>(i)]));
    for (Vec3 p : arrays.points) x.insert(x.end(), {p.x, p.y, p.z});
  }
  Plex plex, distributed;
  ok(DMPlexCreateFromCellListPetsc(comm, 3, static_cast<PetscInt>(cells.size() / 4),
                                   static_cast<PetscInt>(x.size() / 3), 4, PETSC_TRUE, cells.data(), 3,
                                   x.data(), plex.out()));
  ok(DMCreateLabel(plex.get(), "sides"));
  ok(DMCreateLabel(plex.get(), "halves"));
  ok(DMGetCoordinatesLocalSetUp(plex.get()));
  const auto faces = points(plex.get(), 2), tets = points(plex.get(), 3);
  for (PetscInt f = faces[0]; f < faces[1]; ++f) {
    const auto at = centre(plex.get(), f);
    for (int d = 0; d < 3; ++d)
      for (int end = 0; end < 2; ++end)
        if (std::abs(at[static_cast<std::size_t>(d)] - end) < 1e-12)
          ok(DMLabelSetValue(label_of(plex.get(), "sides"), f, 1 + 2 * d + end));
  }
  for (PetscInt c = tets[0]; c < tets[1]; ++c)
    ok(DMLabelSetValue(label_of(plex.get(), "halves"), c, centre(plex.get(), c)[0] < 0.5 ? 1 : 2));
  ok(DMPlexDistribute(plex.get(), overlap, nullptr, distributed.out()));
  if (distributed.get()) plex = std::move(distributed);
  ok(DMGetCoordinatesLocalSetUp(plex.get()));
  return plex;
}

/// 162 cells and 384; some of the first are inverted.
generate::Arrays tangled() {
  generate::CavityOptions options;
  options.counts = {6, 6, 6};
  options.jitter = 0.3;
  return generate::cavity(options);
}
generate::Arrays regular() { return generate::box({4, 4, 4}); }

/// DMAdaptLabel() with the cells marked for which `flag` says so, by their centre; DM_ADAPT_DETERMINE for
/// none.
using Flag = std::function<PetscInt(const std::array<double, 3>&)>;
PetscErrorCode adapt(DM dm, const Flag& flag, Plex& out) {
  DMLabel label = nullptr;
  ok(DMLabelCreate(PETSC_COMM_SELF, "adapt", &label));
  const auto cells = points(dm, 3);
  for (PetscInt c = cells[0]; c < cells[1]; ++c)
    if (const PetscInt value = flag(centre(dm, c)); value != DM_ADAPT_DETERMINE)
      ok(DMLabelSetValue(label, c, value));
  const PetscErrorCode code = DMAdaptLabel(dm, label, out.out());
  ok(DMLabelDestroy(&label));
  if (out.get()) ok(DMGetCoordinatesLocalSetUp(out.get()));
  return code;
}
PetscInt nothing(const std::array<double, 3>&) { return DM_ADAPT_DETERMINE; }
PetscInt corner(const std::array<double, 3>& x) {
  return x[0] < 0.5 && x[1] < 0.5 && x[2] < 0.5 ? DM_ADAPT_REFINE : DM_ADAPT_KEEP;
}

/// Calls `visit` with each point that this rank and no other has.
void for_own(DM dm, PetscInt depth, const std::function<void(PetscInt)>& visit) {
  PetscSF sf = nullptr;
  PetscInt n_roots = 0, n = 0;
  const PetscInt* leaves = nullptr;
  ok(DMGetPointSF(dm, &sf));
  ok(PetscSFGetGraph(sf, &n_roots, &n, &leaves, nullptr));
  const auto range = points(dm, depth);
  for (PetscInt p = range[0]; p < range[1]; ++p) {
    bool is_other = false;
    for (PetscInt i = 0; i < n && !is_other; ++i) is_other = (leaves ? leaves[i] : i) == p;
    if (!is_other) visit(p);
  }
}

double sum(DM dm, double mine) {
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, comm_of(dm));
  return mine;
}

/// Area or volume of the points with each value of a label; of those without as value -1.
std::map<int, double> sizes(DM dm, PetscInt depth, const char* name, int most) {
  std::map<int, double> mine, all;
  for_own(dm, depth, [&](PetscInt p) {
    PetscInt value = -1;
    ok(DMLabelGetValue(label_of(dm, name), p, &value));
    mine[static_cast<int>(value)] += size_of(dm, p);
  });
  for (int value = 1; value <= most; ++value) all[value] = sum(dm, mine[value]);
  return all;
}

PetscInt count(DM dm, const Flag& counts) {
  double n = 0;
  for_own(dm, 3, [&](PetscInt c) { n += counts(centre(dm, c)) == DM_ADAPT_REFINE; });
  return static_cast<PetscInt>(sum(dm, n));
}
PetscInt n_cells(DM dm) {
  return count(dm, [](const std::array<double, 3>&) { return PetscInt{DM_ADAPT_REFINE}; });
}

PetscInt n_inverted(DM dm) {
  double n = 0;
  for_own(dm, 3, [&](PetscInt c) {
    PetscReal v[3], j[9], inverse[9], det = 0;
    ok(DMPlexComputeCellGeometryAffineFEM(dm, c, v, j, inverse, &det));
    n += det <= 0;
  });
  return static_cast<PetscInt>(sum(dm, n));
}

std::uint64_t mixed(std::uint64_t h, std::uint64_t x) {
  h = (h ^ x) * 0x9e3779b97f4a7c15ULL;
  return h ^ (h >> 29);
}

/// A number of the points of one dimension with their values of a label, whatever rank has them and whatever
/// they are called there: equal where all coordinates are, to the last bit.
std::uint64_t fingerprint(DM dm, PetscInt depth, const char* name) {
  PetscSection section = nullptr;
  Vec coordinates = nullptr;
  const PetscScalar* x = nullptr;
  std::uint64_t total = 0;
  ok(DMGetCoordinateSection(dm, &section));
  ok(DMGetCoordinatesLocal(dm, &coordinates));
  ok(VecGetArrayRead(coordinates, &x));
  const auto vertices = points(dm, 0);
  for_own(dm, depth, [&](PetscInt p) {
    PetscInt size = 0, value = 0, *closure = nullptr;
    std::vector<std::array<std::uint64_t, 3>> corners;
    ok(DMPlexGetTransitiveClosure(dm, p, PETSC_TRUE, &size, &closure));
    for (PetscInt i = 0; i < size; ++i) {
      PetscInt at = 0;
      if (closure[2 * i] < vertices[0] || closure[2 * i] >= vertices[1]) continue;
      ok(PetscSectionGetOffset(section, closure[2 * i], &at));
      std::memcpy(corners.emplace_back().data(), x + at, 3 * sizeof(double));
    }
    ok(DMPlexRestoreTransitiveClosure(dm, p, PETSC_TRUE, &size, &closure));
    std::sort(corners.begin(), corners.end());
    if (DMLabel label = label_of(dm, name)) ok(DMLabelGetValue(label, p, &value));
    std::uint64_t h = mixed(1, static_cast<std::uint64_t>(value));
    for (const auto& corner : corners)
      for (std::uint64_t bits : corner) h = mixed(h, bits);
    total += h;
  });
  ok(VecRestoreArrayRead(coordinates, &x));
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_UINT64_T, MPI_SUM, comm_of(dm));
  return total;
}

/// With cells to refine and without.
TEST(PetscAdaptor, AnyNumberOfRanksGivesTheMeshOfOne) {
  for (const auto& [overlap, flag] :
       {std::pair<PetscInt, Flag>(0, corner), {1, corner}, {0, nothing}, {1, nothing}}) {
    const Plex alone = cube(PETSC_COMM_SELF, tangled()),
               together = cube(PETSC_COMM_WORLD, tangled(), overlap);
    ASSERT_EQ(fingerprint(alone.get(), 3, "halves"), fingerprint(together.get(), 3, "halves"));
    Plex one, many;
    ASSERT_EQ(adapt(alone.get(), flag, one), 0);
    ASSERT_EQ(adapt(together.get(), flag, many), 0);
    EXPECT_EQ(comm_of(many.get()) == MPI_COMM_NULL, false);
    EXPECT_EQ(n_ranks(comm_of(many.get())), n_ranks(PETSC_COMM_WORLD));
    EXPECT_NE(fingerprint(one.get(), 3, "halves"), fingerprint(alone.get(), 3, "halves"));
    EXPECT_EQ(fingerprint(one.get(), 3, "halves"), fingerprint(many.get(), 3, "halves"));
    EXPECT_EQ(fingerprint(one.get(), 2, "sides"), fingerprint(many.get(), 2, "sides"));
    PetscInt layers = -1;
    ok(DMPlexGetOverlap(many.get(), &layers));
    EXPECT_EQ(layers, n_ranks(PETSC_COMM_WORLD) > 1 ? overlap : 0);
  }
}

#ifdef HFR_HAS_SURFACE
/// One rank has the whole, several have parts.
TEST(PetscAdaptor, ASurfaceThatChangesIsTheSameOnAnyNumberOfRanks) {
  const Plex alone = cube(PETSC_COMM_SELF, tangled()), together = cube(PETSC_COMM_WORLD, tangled());
  Plex frozen;
  ASSERT_EQ(adapt(alone.get(), nothing, frozen), 0);
  for (const char* const mode : {"flat", "free"}) {
    ASSERT_EQ(PetscOptionsSetValue(nullptr, "-dm_hfremesh_surface", mode), 0);
    Plex one, many;
    ASSERT_EQ(adapt(alone.get(), nothing, one), 0);
    ASSERT_EQ(adapt(together.get(), nothing, many), 0);
    EXPECT_NE(fingerprint(one.get(), 3, "halves"), fingerprint(frozen.get(), 3, "halves")) << mode;
    EXPECT_EQ(fingerprint(one.get(), 3, "halves"), fingerprint(many.get(), 3, "halves")) << mode;
    EXPECT_EQ(fingerprint(one.get(), 2, "sides"), fingerprint(many.get(), 2, "sides")) << mode;
    ASSERT_EQ(PetscOptionsClearValue(nullptr, "-dm_hfremesh_surface"), 0);
  }
}
#endif

/// What is said with -info, by rank 0.
std::string info_of(const std::function<void()>& act) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "info";
  ok(PetscInfoSetFile(path.c_str(), "w"));
  ok(PetscInfoAllow(PETSC_TRUE));
  act();
  ok(PetscInfoAllow(PETSC_FALSE));
  ok(PetscInfoSetFile(nullptr, nullptr));
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    std::ifstream in(entry.path());
    all.append(std::istreambuf_iterator<char>(in), {});
  }
  int size = static_cast<int>(all.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  all.resize(static_cast<std::size_t>(size));
  MPI_Bcast(all.data(), size, MPI_CHAR, 0, PETSC_COMM_WORLD);
  return all;
}

/// No rank has the whole, unless it had to be put together, which is said.
TEST(PetscAdaptor, AMeshStaysInPartsWhereItCan) {
  const bool alone = n_ranks(PETSC_COMM_WORLD) == 1;
  const Plex before = cube(PETSC_COMM_WORLD, tangled());
  Plex a, b, c, d;
  EXPECT_THAT(info_of([&] { adapt(before.get(), nothing, a); }),
              HasSubstr(alone ? "put together: one rank" : "0 of them inverted or flat; in parts"));
  EXPECT_THAT(info_of([&] { adapt(before.get(), corner, b); }),
              HasSubstr(alone ? "put together: one rank" : "0 of them inverted or flat; in parts"));
#ifdef HFR_HAS_SURFACE
  ASSERT_EQ(PetscOptionsSetValue(nullptr, "-dm_hfremesh_surface", "flat"), 0);
  EXPECT_THAT(info_of([&] { adapt(before.get(), nothing, c); }),
              HasSubstr(alone ? "put together: one rank" : "0 of them inverted or flat; in parts"));
  ASSERT_EQ(PetscOptionsClearValue(nullptr, "-dm_hfremesh_surface"), 0);
#endif
  ASSERT_EQ(PetscOptionsSetValue(nullptr, "-dm_hfremesh_smoother", "laplacian"), 0);
  EXPECT_THAT(info_of([&] { adapt(before.get(), nothing, d); }),
              HasSubstr(alone ? "put together: one rank" : "put together: other smoothers than newton"));
  ASSERT_EQ(PetscOptionsClearValue(nullptr, "-dm_hfremesh_smoother"), 0);
}

TEST(PetscAdaptor, CellsThatAreOrderedAgainstTheirNeighboursStayInParts) {
  generate::Arrays arrays = regular();
  std::swap(arrays.cells[7][1], arrays.cells[7][2]);
  const Plex before = cube(PETSC_COMM_WORLD, arrays);
  Plex after;
  const std::string line = info_of([&] { EXPECT_EQ(adapt(before.get(), nothing, after), 0); });
  EXPECT_THAT(line, HasSubstr(n_ranks(PETSC_COMM_WORLD) == 1 ? "put together: one rank" : "in parts"));
  EXPECT_EQ(n_inverted(after.get()), 0);
}

/// Two boxes that meet in one vertex alone.
TEST(PetscAdaptor, MeshesThatTouchInAVertexStayInParts) {
  generate::Arrays arrays = regular();
  const generate::Arrays other = regular();
  const auto n = static_cast<Index>(arrays.points.size());
  Index common = 0;  // of the first: the corner (1, 1, 1)
  for (Index v = 0; v < n; ++v)
    if (arrays.points[v] == Vec3{1, 1, 1}) common = v;
  for (Vec3 p : other.points) arrays.points.push_back(p + Vec3{1, 1, 1});
  for (auto cell : other.cells) {
    for (Index& v : cell) v = other.points[v] == Vec3{0, 0, 0} ? common : v + n;
    arrays.cells.push_back(cell);
  }
  for (Index v = 0; v < n; ++v)
    if (other.points[v] == Vec3{0, 0, 0}) arrays.points[n + v] = {9, 9, 9};  // of no cell
  const Plex before = cube(PETSC_COMM_WORLD, arrays);
  Plex after;
  const std::string line = info_of([&] { EXPECT_EQ(adapt(before.get(), nothing, after), 0); });
  EXPECT_THAT(line, HasSubstr(n_ranks(PETSC_COMM_WORLD) == 1 ? "put together: one rank" : "in parts"));
  EXPECT_EQ(n_inverted(after.get()), 0);
  EXPECT_GT(n_cells(after.get()), 600);
}

TEST(PetscAdaptor, InvertedCellsAreMendedAndLabelsKept) {
  const Plex before = cube(PETSC_COMM_WORLD, tangled());
  Plex after;
  ASSERT_GT(n_inverted(before.get()), 0);
  ASSERT_EQ(adapt(before.get(), nothing, after), 0);
  EXPECT_EQ(n_inverted(after.get()), 0);
  for (const auto& [side, area] : sizes(after.get(), 2, "sides", 6)) EXPECT_NEAR(area, 1, 1e-12) << side;
  for (PetscInt depth : {0, 1})  // a label that was not complete is no more so now
    for_own(after.get(), depth, [&](PetscInt p) {
      PetscInt value = 0;
      ok(DMLabelGetValue(label_of(after.get(), "sides"), p, &value));
      EXPECT_EQ(value, -1);
    });
  double volume = 0;
  for (const auto& [half, part] : sizes(after.get(), 3, "halves", 2)) {
    EXPECT_GT(part, 0.3) << half;
    volume += part;
  }
  EXPECT_NEAR(volume, 1, 1e-12);
}

TEST(PetscAdaptor, MarkedCellsAreHalvedToAnEighthAndOthersKeepTheirSize) {
  const Plex before = cube(PETSC_COMM_WORLD, regular());
  Plex after;
  ASSERT_EQ(adapt(before.get(), corner, after), 0);
  const PetscInt marked = count(before.get(), corner), now = count(after.get(), corner);
  EXPECT_GT(now, 6 * marked);
  EXPECT_LT(now, 12 * marked);
  const Flag far = [](const std::array<double, 3>& x) {
    return std::max({x[0], x[1], x[2]}) > 0.8 ? PetscInt{DM_ADAPT_REFINE} : PetscInt{DM_ADAPT_KEEP};
  };
  EXPECT_LT(count(after.get(), far), 1.2 * count(before.get(), far));
  EXPECT_EQ(n_inverted(after.get()), 0);
  for (const auto& [side, area] : sizes(after.get(), 2, "sides", 6)) EXPECT_NEAR(area, 1, 1e-12) << side;
  for (const auto& [half, part] : sizes(after.get(), 3, "halves", 2)) EXPECT_NEAR(part, 0.5, 1e-12) << half;
}

/// As programs have them that set boundary conditions: each labelled face with its edges and vertices.
TEST(PetscAdaptor, CompleteLabelsAreCompleteAgain) {
  for (const Flag& flag : {Flag(corner), Flag(nothing)}) {
    const Plex before = cube(PETSC_COMM_WORLD, tangled());
    ASSERT_EQ(DMCreateLabel(before.get(), "marker"), 0);
    ASSERT_EQ(DMPlexMarkBoundaryFaces(before.get(), 1, label_of(before.get(), "marker")), 0);
    ASSERT_EQ(DMPlexLabelComplete(before.get(), label_of(before.get(), "marker")), 0);
    Plex after;
    ASSERT_EQ(adapt(before.get(), flag, after), 0);
    for (PetscInt depth : {0, 1}) {
      double n_marked = 0, n_missing = 0;
      const auto range = points(after.get(), depth);
      for (PetscInt p = range[0]; p < range[1]; ++p) {
        PetscInt n = 0, value = -1, *star = nullptr;
        bool is_on_surface = false;
        ok(DMPlexGetTransitiveClosure(after.get(), p, PETSC_FALSE, &n, &star));
        const auto faces = points(after.get(), 2);
        for (PetscInt i = 0; i < n; ++i) {
          PetscInt side = -1;
          if (star[2 * i] < faces[0] || star[2 * i] >= faces[1]) continue;
          ok(DMLabelGetValue(label_of(after.get(), "sides"), star[2 * i], &side));
          is_on_surface = is_on_surface || side > 0;
        }
        ok(DMPlexRestoreTransitiveClosure(after.get(), p, PETSC_FALSE, &n, &star));
        ok(DMLabelGetValue(label_of(after.get(), "marker"), p, &value));
        n_marked += value == 1;
        n_missing += is_on_surface && value != 1;
      }
      EXPECT_GT(sum(after.get(), n_marked), 100);
      EXPECT_EQ(sum(after.get(), n_missing), 0);
    }
  }
}

/// Otherwise all faces and edges inside would be constraints, and nothing could be mended.
TEST(PetscAdaptor, AClosedLabelOfAllCellsHoldsNothing) {
  const Plex plain = cube(PETSC_COMM_WORLD, tangled()), labelled = cube(PETSC_COMM_WORLD, tangled());
  ASSERT_EQ(DMCreateLabel(labelled.get(), "body"), 0);
  DMLabel body = label_of(labelled.get(), "body");
  for (PetscInt c = points(labelled.get(), 3)[0]; c < points(labelled.get(), 3)[1]; ++c)
    ASSERT_EQ(DMLabelSetValue(body, c, 7), 0);
  ASSERT_EQ(DMPlexLabelComplete(labelled.get(), body), 0);
  for (const Flag& flag : {Flag(corner), Flag(nothing)}) {
    Plex a, b;
    ASSERT_EQ(adapt(plain.get(), flag, a), 0);
    ASSERT_EQ(adapt(labelled.get(), flag, b), 0);
    EXPECT_EQ(fingerprint(a.get(), 3, "halves"), fingerprint(b.get(), 3, "halves"));
    for (PetscInt depth = 0; depth < 4; ++depth)
      for_own(b.get(), depth, [&](PetscInt p) {
        PetscInt value = -1;
        ok(DMLabelGetValue(label_of(b.get(), "body"), p, &value));
        EXPECT_EQ(value, 7);
      });
  }
}

TEST(PetscAdaptor, RefinementLimitsOfADmAreKept) {
  const Plex before = cube(PETSC_COMM_WORLD, regular());
  ASSERT_EQ(DMPlexSetRefinementUniform(before.get(), PETSC_FALSE), 0);
  ASSERT_EQ(DMPlexSetRefinementLimit(before.get(), 1.0 / 1500), 0);
  Plex after;
  ASSERT_EQ(DMRefine(before.get(), PETSC_COMM_WORLD, after.out()), 0);
  ASSERT_NE(after.get(), nullptr);
  ok(DMGetCoordinatesLocalSetUp(after.get()));
  EXPECT_GT(n_cells(before.get()), 0);
  EXPECT_GT(n_cells(after.get()), 1500);
}

/// What PETSc was told of an error, instead of printing it.
std::string last_error;
PetscErrorCode keep_error(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                          const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) last_error = message;
  return code;
}

struct Refusal {
  PetscErrorCode code = {};
  std::string line;
};
Refusal refusal_of(const std::function<PetscErrorCode()>& call) {
  last_error.clear();
  ok(PetscPushErrorHandler(keep_error, nullptr));
  const PetscErrorCode code = call();
  ok(PetscPopErrorHandler());
  return {code, last_error};
}

TEST(PetscAdaptor, WhatItDoesNotAdaptIsRefusedInALine) {
  Plex flat, out;
  const PetscInt sides[2] = {2, 2};
  ASSERT_EQ(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 2, PETSC_FALSE, sides, nullptr, nullptr, nullptr,
                                PETSC_TRUE, flat.out()),
            0);
  Refusal refusal = refusal_of([&] { return DMAdaptLabel(flat.get(), nullptr, out.out()); });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("hfremesh adapts meshes of dimension 3; this one has 2"));
  Plex bricks;
  ASSERT_EQ(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 3, PETSC_FALSE, nullptr, nullptr, nullptr, nullptr,
                                PETSC_TRUE, bricks.out()),
            0);
  refusal = refusal_of([&] { return DMAdaptLabel(bricks.get(), nullptr, out.out()); });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("hfremesh adapts tetrahedra; there are cells of type hexahedron"));
}

double longest_edge(DM dm) {
  double longest = 0;
  for_own(dm, 1, [&](PetscInt e) { longest = std::max(longest, size_of(dm, e)); });
  MPI_Allreduce(MPI_IN_PLACE, &longest, 1, MPI_DOUBLE, MPI_MAX, comm_of(dm));
  return longest;
}

/// Edges become no longer than the metric asks for, about; sides keep their labels, and ranks do not matter.
TEST(PetscAdaptor, UniformMetricsMakeEdgesShortEnough) {
  constexpr double kSize = 0.15;
  std::vector<std::uint64_t> fingerprints;
  for (MPI_Comm comm : {PETSC_COMM_SELF, PETSC_COMM_WORLD}) {
    const Plex before = cube(comm, regular());
    Plex after;
    Vec metric = nullptr;
    ok(DMPlexMetricCreateUniform(before.get(), 0, 1 / (kSize * kSize), &metric));
    ASSERT_EQ(DMAdaptMetric(before.get(), metric, label_of(before.get(), "sides"),
                            label_of(before.get(), "halves"), after.out()),
              0);
    ok(VecDestroy(&metric));
    ok(DMGetCoordinatesLocalSetUp(after.get()));
    EXPECT_GT(longest_edge(before.get()), 0.4);
    EXPECT_LT(longest_edge(after.get()), 1.3 * 1.4142 * kSize);
    EXPECT_GT(n_cells(after.get()), 2000);
    EXPECT_EQ(n_inverted(after.get()), 0);
    for (const auto& [side, area] : sizes(after.get(), 2, "sides", 6)) EXPECT_NEAR(area, 1, 1e-12) << side;
    for (const auto& [half, part] : sizes(after.get(), 3, "halves", 2)) EXPECT_NEAR(part, 0.5, 1e-12) << half;
    fingerprints.push_back(fingerprint(after.get(), 3, "halves"));
  }
  EXPECT_EQ(fingerprints[0], fingerprints[1]);
}

/// As an indicator of an error asks for it: small cells at one corner of the cube.
TEST(PetscAdaptor, IsotropicMetricsRefineWhereTheyAskForIt) {
  const Plex before = cube(PETSC_COMM_WORLD, regular());
  Plex after;
  Vec indicator = nullptr, metric = nullptr;
  DM scalar = nullptr;
  PetscFE fe = nullptr;
  ok(DMClone(before.get(), &scalar));
  ok(PetscFECreateLagrange(PETSC_COMM_SELF, 3, 1, PETSC_TRUE, 1, PETSC_DETERMINE, &fe));
  ok(DMSetField(scalar, 0, nullptr, reinterpret_cast<PetscObject>(fe)));
  ok(DMCreateDS(scalar));
  ok(PetscFEDestroy(&fe));
  ok(DMCreateLocalVector(scalar, &indicator));
  PetscErrorCode (*const size)(PetscInt, PetscReal, const PetscReal*, PetscInt, PetscScalar*, void*) =
      [](PetscInt, PetscReal, const PetscReal* x, PetscInt, PetscScalar* u, void*) {
        const double h = x[0] + x[1] + x[2] < 0.6 ? 0.1 : 1;
        *u = 1 / (h * h);
        return PetscErrorCode(0);
      };
  auto* function = size;
  ok(DMProjectFunctionLocal(scalar, 0, &function, nullptr, INSERT_ALL_VALUES, indicator));
  ok(DMPlexMetricCreateIsotropic(before.get(), 0, indicator, &metric));
  ASSERT_EQ(DMAdaptMetric(before.get(), metric, nullptr, nullptr, after.out()), 0);
  ok(DMGetCoordinatesLocalSetUp(after.get()));
  const Flag far = [](const std::array<double, 3>& x) {
    return std::max({x[0], x[1], x[2]}) > 0.8 ? PetscInt{DM_ADAPT_REFINE} : PetscInt{DM_ADAPT_KEEP};
  };
  const Flag near = [](const std::array<double, 3>& x) {
    return x[0] + x[1] + x[2] < 0.5 ? PetscInt{DM_ADAPT_REFINE} : PetscInt{DM_ADAPT_KEEP};
  };
  EXPECT_GT(count(after.get(), near), 5 * count(before.get(), near));
  EXPECT_LT(count(after.get(), far), 1.3 * count(before.get(), far));
  EXPECT_EQ(n_inverted(after.get()), 0);
  ok(VecSet(metric, -1));
  Plex none;
  const Refusal refusal =
      refusal_of([&] { return DMAdaptMetric(before.get(), metric, nullptr, nullptr, none.out()); });
  EXPECT_EQ(refusal.code, PETSC_ERR_ARG_OUTOFRANGE);
  EXPECT_THAT(refusal.line, HasSubstr("the metric has a value that is not above 0"));
  ok(VecDestroy(&metric));
  ok(VecDestroy(&indicator));
  ok(DMDestroy(&scalar));
}

TEST(PetscAdaptor, MetricsWithDirectionsAndGenerationAreRefused) {
  const Plex box = cube(PETSC_COMM_WORLD, regular());
  Plex out;
  Vec metric = nullptr;
  ok(DMPlexMetricCreate(box.get(), 0, &metric));
  Refusal refusal = refusal_of([&] { return DMAdaptMetric(box.get(), metric, nullptr, nullptr, out.out()); });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("hfremesh adapts to sizes that are alike in all directions"));
  ok(VecDestroy(&metric));
  refusal = refusal_of([&] { return DMPlexGenerate(box.get(), "hfremesh", PETSC_TRUE, out.out()); });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("makes none of a boundary"));
}

TEST(PetscAdaptor, FlagsThatPetscDoesNotNameAreRefused) {
  const Plex box = cube(PETSC_COMM_SELF, regular());
  Plex out;
  const Refusal refusal = refusal_of([&] {
    return adapt(
        box.get(), [](const std::array<double, 3>&) { return PetscInt{7}; }, out);
  });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("has flag 7"));
}

/// Ranks without such a flag hear of it, too, and wait for nobody.
TEST(PetscAdaptor, AFlagOnOneRankAloneEndsAll) {
  const Plex before = cube(PETSC_COMM_WORLD, regular());
  Plex out;
  const Refusal refusal = refusal_of([&] {
    return adapt(
        before.get(),
        [](const std::array<double, 3>& c) { return PetscInt{c[0] + c[1] + c[2] < 0.5 ? 7 : DM_ADAPT_KEEP}; },
        out);
  });
  EXPECT_EQ(refusal.code, PETSC_ERR_SUP);
  EXPECT_THAT(refusal.line, HasSubstr("has flag 7"));
}

TEST(PetscAdaptor, OptionsAreThoseOfTheToolAndWrongOnesAreRefused) {
  const Plex before = cube(PETSC_COMM_WORLD, tangled());
  Plex after;
  ASSERT_EQ(PetscOptionsSetValue(nullptr, "-dm_hfremesh_min_dihedral", "much"), 0);
  const Refusal refusal = refusal_of([&] { return adapt(before.get(), nothing, after); });
  EXPECT_EQ(refusal.code, PETSC_ERR_ARG_OUTOFRANGE);
  EXPECT_THAT(refusal.line, HasSubstr("-dm_hfremesh_min_dihedral: "));
  ASSERT_EQ(PetscOptionsSetValue(nullptr, "-dm_hfremesh_min_dihedral", "5"), 0);
  ASSERT_EQ(adapt(before.get(), nothing, after), 0);
  Plex whole;
  ASSERT_EQ(PetscOptionsClearValue(nullptr, "-dm_hfremesh_min_dihedral"), 0);
  ASSERT_EQ(adapt(before.get(), nothing, whole), 0);
  EXPECT_NE(fingerprint(after.get(), 3, "halves"), fingerprint(whole.get(), 3, "halves"));
}

/// A fault of the mesh that only the library finds, on rank 0: all ranks get the error and its line.
TEST(PetscAdaptor, WhatTheLibraryRefusesIsAnErrorOnEveryRank) {
  generate::Arrays twice = regular();
  twice.points[0] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  const Plex before = cube(PETSC_COMM_WORLD, twice);
  Plex after;
  const Refusal refusal = refusal_of([&] { return adapt(before.get(), nothing, after); });
  EXPECT_EQ(refusal.code, PETSC_ERR_ARG_WRONG);
  EXPECT_THAT(refusal.line, HasSubstr("hfremesh: "));
  EXPECT_THAT(refusal.line, HasSubstr("finite"));
}

}  // namespace
}  // namespace hfr::test
