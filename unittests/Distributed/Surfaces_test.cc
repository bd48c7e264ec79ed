// SPDX-License-Identifier: BSD-3-Clause
// Meshes in parts whose surface may change, beside what shared memory makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "Distributed/LabelOrder.hh"
#include "Distributed/Labelled.hh"
#include "Distributed/PartPatchSearch.hh"
#include "Distributed/Remesher.hh"
#include "HalfFace/Generate.hh"
#include "Remesh/Patch.hh"
#include "Remesh/Remesher.hh"

namespace hfr::test {
namespace {

ImproveOptions on_surface(SurfaceMode mode, double goal = 0, bool polish_only = false) {
  ImproveOptions options;
  options.surface.mode = mode;
  if (goal > 0) options.min_dihedral = goal;
  options.polish_only = polish_only;
  options.policy = {};
  return options;
}

/// A box with dents, as scans have them, of which every vertex of the surface may give way.
TetMesh dented(Index n, double jitter, std::uint64_t seed) {
  TetMesh mesh = valid_box(n, jitter, seed);
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> by(-0.06, 0.06);
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    const double bulge = 0.15 * std::sin(3 * p.x) * std::sin(3 * p.y) * std::sin(3 * p.z);
    const double step = by(engine) / n;
    mesh.set_point(v, {p.x + bulge + step, p.y - bulge, p.z + 0.5 * bulge + step});
  }
  return mesh;
}

/// What the passes of runs have done, by operator.
struct Winners {
  std::map<std::string, std::size_t> of_op;

  void add(const Result& result) {
    for (const PassReport& pass : result.passes)
      of_op[pass.stage == "patches" ? "patches" : pass.op] += pass.winners;
  }
  bool has_all(std::initializer_list<const char*> ops) const {
    return std::all_of(ops.begin(), ops.end(), [&](const char* op) {
      const auto at = of_op.find(op);
      EXPECT_TRUE(at != of_op.end() && at->second > 0) << "nothing is done by " << op;
      return at != of_op.end() && at->second > 0;
    });
  }
};

class SurfacesInParts : public testing::Test {
 protected:
  Result run(const TetMesh& mesh, const ImproveOptions& options) {
    if (comm.rank() == 0) io::write(path, mesh);
    comm.sum(0);
    Result result = expect_same_run(comm, folder, path, options);
    winners.add(result);
    return result;
  }
  void run(const io::MeshData& data, const ImproveOptions& options) {
    if (comm.rank() == 0) io::write_mesh(path, data);
    comm.sum(0);
    winners.add(expect_same_run(comm, folder, path, options));
  }

  mpi::Comm comm{MPI_COMM_WORLD};
  SharedFolder folder{comm};
  std::filesystem::path path = folder.path() / "in.vtu";
  Winners winners;
};

TEST_F(SurfacesInParts, APolishHasTheBytesOfSharedMemory) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree})
    for (const double goal : {20.0, 32.0}) {
      SCOPED_TRACE(goal);
      ImproveOptions options = on_surface(mode, goal, /*polish_only=*/true);
      options.policy.threads = goal > 30 ? 2 : 1;
      run(valid_box(6, 0.36, 1), options);
      run(dented(6, 0.3, 2), options);
    }
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all({"surface swap", "surface node", "surface smooth", "surface split"}));
  }
}

TEST_F(SurfacesInParts, WholeRunsHaveTheBytesOfSharedMemory) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree})
    for (const double goal : {0.0, 28.0}) {
      SCOPED_TRACE(goal);
      run(dented(4, 0.3, 3), on_surface(mode, goal));
      run(valid_box(4, 0.45, 4), on_surface(mode, goal));
    }
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all({"surface swap", "surface node", "surface smooth"}));
  }
}

/// Most cells miss what lies beyond the claim, and nothing else keeps the worst angle down.
TEST_F(SurfacesInParts, TargetsThatWereLeftOutForManyCellsHaveTheBytesOfSharedMemory) {
  TetMesh pressed = valid_box(5, 0.2, 7);
  for (VertexHandle v : pressed.vertices()) {
    const Vec3 p = pressed.point(v);
    pressed.set_point(v, {p.x, p.y, 0.3 * p.z});
  }
  const Result result = run(pressed, on_surface(SurfaceMode::kFlat));
  // sin² of 25 degrees: the run ends at 20 where they stay left out.
  if (comm.rank() == 0) {
    EXPECT_GT(result.passes.back().worst, 0.18);
  }
}

/// Regions, whose interfaces may change as well, and labels, which go with the faces, in the same order.
TEST_F(SurfacesInParts, LabelsAndInterfacesHaveTheBytesOfSharedMemory) {
  Density faces;
  faces.faces = faces.edges = faces.vertices = faces.fixed = 0;
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree})
    for (const std::uint64_t seed : {1, 2}) {
      SCOPED_TRACE(seed);
      const TetMesh mesh = seed == 1 ? valid_box(5, 0.38, seed) : dented(5, 0.3, seed);
      io::MeshData data = labelled(mesh, seed, faces);
      for (std::size_t i = 0; i < data.triangle_labels.size(); ++i)
        data.triangle_labels[i] = i % 9 == 0 ? 12 : 11;
      run(data, on_surface(mode, 25));
      ImproveOptions options = on_surface(mode, 25, /*polish_only=*/true);
      options.surface.fixed_patches.push_back(12);
      run(data, options);
      run(labelled(mesh, seed, density_of(seed)), on_surface(mode, 20));
    }
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all(
        {"surface interface", "surface swap", "surface node", "surface smooth", "surface split", "patches"}));
  }
}

/// Inverted cells inside and at a surface that is folded over, which is spread first.
TEST_F(SurfacesInParts, TangledMeshesHaveTheBytesOfSharedMemory) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    run(jittered(2, 0.8, 5), on_surface(mode, 12));
    TetMesh lowered = kuhn_box(4);  // a lid that has passed vertices of the walls and their edges
    for (VertexHandle v : lowered.vertices())
      if (const Vec3 p = lowered.point(v); p.z == 1) lowered.set_point(v, {p.x, p.y, 0.6});
    run(lowered, on_surface(mode, 12));
    ImproveOptions options = on_surface(mode, 20, /*polish_only=*/true);
    options.surface.hausdorff = 0.1;  // of which unfolding takes more than half
    run(built(generate::cylinder(3, 8, 1, 2, 0, 65)), options);
  }
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all({"surface unfold", "plane unfold"}));
  }
}

TEST_F(SurfacesInParts, OptionsHaveTheBytesOfSharedMemory) {
  const TetMesh mesh = dented(4, 0.33, 6);
  std::vector<ImproveOptions> all(5, on_surface(SurfaceMode::kFree));
  all[0].coarsen = true;
  all[1].raise_min_dihedral = true, all[1].iterations = 2;
  all[2].max_cells = 400, all[2].surface.hausdorff = 0.02;
  all[3].surface.feature_angle = 15, all[3].rounds = Rounds::kByKind, all[3].bulk_nodes = true;
  all[4].surface.hausdorff = 0, all[4].ops = without(Ops::kDefault, Ops::kInsert);
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    if (i != 1) all[i].passes_only = true;
    run(mesh, all[i]);
  }
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all({"surface volume"}));
  }
}

/// Vertices where two boxes touch, whose cells no walk finds all of.
TEST_F(SurfacesInParts, PinchedVerticesHaveTheBytesOfSharedMemory) {
  generate::Arrays arrays = generate::box({3, 3, 3});
  const Index n = static_cast<Index>(arrays.points.size());
  const std::vector<Corners> cells = arrays.cells;
  for (Index i = 1; i < n; ++i) arrays.points.push_back(arrays.points[i] + Vec3{1, 1, 1});
  for (Corners cell : cells) {
    for (Index& v : cell) v += n - 1;  // the first one is the last of the other box
    arrays.cells.push_back(cell);
  }
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> by(-0.09, 0.09);
  for (Vec3& p : arrays.points) p = p + Vec3{by(engine), by(engine), by(engine)};
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree})
    run(build(arrays.points, arrays.cells), on_surface(mode, 25));
  if (comm.rank() == 0) {
    EXPECT_TRUE(winners.has_all({"surface swap", "surface node", "surface smooth"}));
  }
}

/// A run that is cancelled at some question, while folds are spread or between passes, ends where shared
/// memory does.
TEST_F(SurfacesInParts, CancelledRunsHaveTheBytesOfSharedMemory) {
  const TetMesh folded = built(generate::cylinder(3, 8, 1, 2, 0, 65));
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree})
    for (const int at : {1, 2, 30, 90, 150}) {
      SCOPED_TRACE(at);
      ImproveOptions options = on_surface(mode, 20, /*polish_only=*/true);
      options.surface.hausdorff = 0.1;
      int n_asked = 0;
      options.cancel = [&] { return ++n_asked >= at; };
      mpi::DistributedMesh parts(comm);
      if (comm.rank() == 0) io::write(path, folded);
      comm.sum(0);
      mpi::read_ranges(parts, path, 300);
      mpi::improve(parts, options);
      mpi::write_vtu(parts, folder.path() / "parts.vtu");
      if (comm.rank() != 0) continue;
      n_asked = 0;
      TetMesh mesh = io::read(path);
      const Result shared = hfr::improve(mesh, options);
      EXPECT_EQ(shared.stop, Stop::kCancelled);
      io::write(folder.path() / "whole.vtu", mesh);
      EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
    }
}

/// An edge of the patch between two labelled faces of its boundary: faces of the whole's boundary, where all
/// of these have labels and no others.
EdgeHandle labelled_edge(const TetMesh& patch) {
  for (CellHandle c : patch.cells())
    for (Index e = 0; e < 6; ++e) {
      const auto ends = patch.edge_vertices(EdgeHandle(6 * c.idx() + e));
      int n = 0, n_labelled = 0;
      for (CellHandle d : patch.cells())
        for (HalfFaceHandle h : patch.cell_halffaces(d)) {
          const auto f = patch.halfface_vertices(h);
          const bool has_both =
              std::count(f.begin(), f.end(), ends[0]) + std::count(f.begin(), f.end(), ends[1]) == 2;
          if (!patch.is_boundary(h) || !has_both) continue;
          ++n;
          n_labelled += patch.labels().faces.find(f) ? 1 : 0;
        }
      if (n == 2 && n_labelled == 2) return EdgeHandle(6 * c.idx() + e);
    }
  return {};
}

/// A patch that cuts labelled faces of the surface: the list of labels has the order of shared memory.
TEST(PartPatchSearch, LabelsOfASurfaceThatChangesComeHome) {
  mpi::Comm comm(MPI_COMM_WORLD);
  TetMesh mesh = valid_box(6, 0.2, 5);
  std::vector<std::uint64_t> at_surface;
  int label = 0;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    mesh.labels().faces.set(mesh.halfface_vertices(h), 1 + label++ % 3);
    at_surface.push_back(cell_of(h).idx());
  }
  Whole whole(mesh, MinSine2{});
  Whole cut = whole;
  const auto owner =
      mpi::partition(comm, comm.rank() == 0 ? &cut.mesh : nullptr, mpi::Partition::kCoordinates);
  mpi::DistributedMesh parts(comm);
  parts.scatter(&cut.mesh, &cut.work, owner);
  parts.follow_face_labels();
  const std::vector<std::uint64_t> centres = {at_surface.front(), at_surface[at_surface.size() / 2]};
  const auto split = [](const Patch& patch) {
    TetMesh changed = patch.mesh();
    const EdgeHandle e = labelled_edge(changed);
    EXPECT_TRUE(e.is_valid());
    changed.split_edge(e);
    return changed;
  };
  mpi::search_patches_in_parts(parts, centres, 1, nullptr, [&](PatchPlace& place) {
    for (CellHandle c : place.worst()) {
      const Patch patch(place.mesh(), c, 1);
      place.put_back(patch, split(patch));
    }
    return PatchesDone{2, 2, 2, true, false, false};
  });
  for (std::uint64_t c : centres) {
    const Patch patch(whole.mesh, C(c), 1);
    patch.put_back(whole.mesh, split(patch));
  }
  parts.leave_face_labels();
  const auto expected = whole.mesh.labels().faces.entries();
  const auto mine = parts.part().labels().faces.entries();
  EXPECT_EQ(expected.size(), at_surface.size() + 4);
  std::uint64_t n_own = 0;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    std::array<VertexHandle, 3> v;
    std::ranges::transform(mine[i].vertices, v.begin(), [&](VertexHandle u) { return V(parts.number(u)); });
    const std::uint64_t number = parts.label_numbers().face_number(i);
    ASSERT_LT(number, expected.size());
    EXPECT_EQ(expected[number].vertices, v);
    EXPECT_EQ(expected[number].value, mine[i].value);
    n_own += parts.is_own(*std::ranges::min_element(mine[i].vertices)) ? 1 : 0;
  }
  EXPECT_EQ(comm.sum(n_own), expected.size()) << "a label is lost, or two ranks have it for theirs";
}

/// As TupleMap has it.
TEST(LabelOrder, IsThatOfATupleMap) {
  mpi::LabelOrder order;
  TupleMap<3, int> map;
  std::mt19937_64 engine(1);
  for (int step = 0; step < 3000; ++step) {
    const std::array<std::uint64_t, 3> v = {engine() % 6, 6 + engine() % 6, 12 + engine() % 6};
    const std::array<VertexHandle, 3> h = {V(v[2]), V(v[0]), V(v[1])};
    if (engine() % 2 == 0) {
      order.set(v);
      map.set(h, step);
    } else {
      order.erase(v);
      map.erase_unordered(h);
    }
    ASSERT_EQ(order.size(), map.size());
  }
  EXPECT_GT(map.size(), 50U);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto& v = map.entries()[i].vertices;
    EXPECT_EQ(order.number({v[0].idx(), v[1].idx(), v[2].idx()}), i);
  }
}

}  // namespace
}  // namespace hfr::test
