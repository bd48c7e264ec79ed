// SPDX-License-Identifier: BSD-3-Clause
// Meshes with labels of all kinds, and what the ranks make of them beside what shared memory does.
#ifndef HFR_UNITTESTS_DISTRIBUTED_LABELLED_HH
#define HFR_UNITTESTS_DISTRIBUTED_LABELLED_HH

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <future>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "Distributed/Parts.hh"
#include "Distributed/SharedFolder.hh"
#include "HalfFace/Check.hh"
#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "IO/ReadWrite.hh"

namespace hfr::test {

/// What of a mesh is labelled or fixed, one in so many; 0: none.
struct Density {
  unsigned boundary = 1, faces = 40, edges = 30, vertices = 9, fixed = 23, repeated = 25;
  bool regions = true;
};

/// A kind of label alone, by turns, everything, and nothing.
inline Density density_of(std::uint64_t seed) {
  switch (seed) {
    case 2:
      return {0, 0, 20, 0, 0, 0, false};  // edges
    case 3:
      return {0, 0, 0, 3, 0, 0, false};  // vertices
    case 4:
      return {2, 15, 0, 0, 0, 4, false};  // faces
    case 5:
      return {0, 0, 0, 0, 4, 0, true};  // fixed vertices and regions
    case 7:
      return {0, 0, 0, 0, 0, 0, false};
    default:
      return {};
  }
}

/// Of each stage, without the searches for the last few cells.
inline ImproveOptions one_iteration() {
  ImproveOptions options;
  options.policy = {};
  options.iterations = 1;
  options.passes_only = true;
  return options;
}

inline ImproveOptions polish_towards(double degrees) {
  ImproveOptions options;
  options.min_dihedral = degrees;
  options.polish_only = true;
  options.policy = {};
  return options;
}

/// Labels in no order that has to do with the cells, some triangles and edges twice or with corners in
/// another order, and names.
inline io::MeshData labelled(const TetMesh& mesh, std::uint64_t seed, const Density& density) {
  std::mt19937_64 engine(seed);
  const auto once_in = [&](unsigned n) { return n > 0 && engine() % n == 0; };
  io::MeshData data = io::disassemble(mesh);
  const std::size_t n = mesh.n_vertices();
  data.vertex_labels.assign(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    if (once_in(density.vertices)) data.vertex_labels[v] = static_cast<int>(engine() % 5) - 2;
    if (once_in(density.fixed)) data.fixed_vertices.push_back(static_cast<Index>(v));
  }
  if (density.vertices == 0) data.vertex_labels.clear();
  std::set<std::array<Index, 2>> edges;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    if (density.regions) data.regions.push_back(mesh.point(v[0]).x + mesh.point(v[1]).y < 0.8 ? 3 : -1);
    for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
      const bool is_boundary = mesh.is_boundary(h);
      if (!is_boundary && mesh.opposite_halfface(h) < h) continue;
      for (bool again = once_in(is_boundary ? density.boundary : density.faces); again;
           again = once_in(density.repeated)) {
        std::array<Index, 3> face;
        std::ranges::transform(mesh.halfface_vertices(h), face.begin(),
                               [](VertexHandle u) { return u.idx(); });
        std::shuffle(face.begin(), face.end(), engine);
        data.triangles.push_back(face);
        data.triangle_labels.push_back(is_boundary ? 10 + static_cast<int>(engine() % 4) : 20);
      }
    }
    for (const auto& e : kEdgeCorners)
      if (once_in(density.edges)) edges.insert({v[e[0]].idx(), v[e[1]].idx()});
  }
  data.edges.assign(edges.begin(), edges.end());
  for (std::size_t i = data.edges.size(); i-- > 0;)
    if (once_in(density.repeated)) data.edges.push_back({data.edges[i][1], data.edges[i][0]});
  for (std::size_t i = 0; i < data.edges.size(); ++i)
    data.edge_labels.push_back(static_cast<int>(engine() % 3));
  std::shuffle(data.triangles.begin(), data.triangles.end(), engine);
  std::shuffle(data.edges.begin(), data.edges.end(), engine);
  data.names = {{{2, 10}, "inlet & outlet"}, {{3, 3}, "steel"}, {{1, 1}, "a seam"}};
  return data;
}

/// A mesh of shared memory after a run.
struct WholeRun {
  TetMesh mesh;
  Result result;
};

/// A run in shared memory beside whatever comes until it is asked for; not before that where it calls back.
inline std::future<WholeRun> run_whole(const std::filesystem::path& in, const ImproveOptions& options) {
  const auto way = options.progress || options.cancel ? std::launch::deferred : std::launch::async;
  return std::async(way, [in, options] {
    WholeRun run{io::read(in), {}};
    run.result = hfr::improve(run.mesh, options);
    return run;
  });
}

/// Reads, improves and writes with all ranks and in shared memory, and compares the bytes. Returns the
/// winners of all passes, or of those of one operator.
inline std::size_t expect_bytes(mpi::Comm& comm, const SharedFolder& folder, const std::filesystem::path& in,
                                const ImproveOptions& options, std::uint64_t at_once = 300,
                                const std::string& op = {}) {
  std::future<WholeRun> whole;
  if (comm.rank() == 0) whole = run_whole(in, options);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, in, at_once);
  const mpi::PartsResult result = mpi::improve(parts, options);
  const mpi::PartsCheck checked = mpi::check(parts);
  EXPECT_TRUE(checked.is_good) << checked.message;
  mpi::write_vtu(parts, folder.path() / "parts.vtu");
  std::size_t n_winners = 0;
  if (comm.rank() == 0) {
    const auto [mesh, shared] = whole.get();
    EXPECT_EQ(check(mesh), Ok);
    for (const PassReport& pass : shared.passes) n_winners += op.empty() || pass.op == op ? pass.winners : 0;
    EXPECT_EQ(shared.goal_reached, result.goal_reached);
    io::write(folder.path() / "whole.vtu", mesh);
    EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
  }
  return comm.from_first(n_winners);
}

/// But for what regions have gained, which parts do not say.
inline void expect_same_surface(const SurfaceReport& a, const SurfaceReport& b) {
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.bound, b.bound);
  EXPECT_EQ(a.hausdorff, b.hausdorff);
  EXPECT_EQ(a.diagonal, b.diagonal);
  EXPECT_EQ(a.unfold_needs, b.unfold_needs);
  EXPECT_EQ(a.volume_change, b.volume_change);
  EXPECT_EQ(a.feature_edges, b.feature_edges);
  EXPECT_EQ(a.triangles_before, b.triangles_before);
  EXPECT_EQ(a.triangles_after, b.triangles_after);
}

/// The same for any run over any mesh: the same bytes, the same passes. Returns what shared memory says of
/// it, on rank 0. `around`: what is done to the parts before the run, and after it.
inline Result expect_same_run(mpi::Comm& comm, const SharedFolder& folder, const std::filesystem::path& in,
                              const ImproveOptions& options,
                              const std::function<void(mpi::DistributedMesh&)>& around = {}) {
  std::future<WholeRun> whole;
  if (comm.rank() == 0) whole = run_whole(in, options);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, in, 300);
  if (around) around(parts);
  const mpi::Pinches pinched = mpi::pinches(parts);
  const mpi::PartsResult result = mpi::improve(parts, options);
  if (around) around(parts);
  const mpi::PartsCheck checked = mpi::check(parts, pinched);
  EXPECT_TRUE(checked.is_good) << checked.message;
  mpi::write_vtu(parts, folder.path() / "parts.vtu");
  Result shared;
  if (comm.rank() == 0) {
    WholeRun run = whole.get();
    shared = std::move(run.result);
    EXPECT_EQ(shared.goal_reached, result.goal_reached);
    EXPECT_EQ(shared.changed, result.changed);
    EXPECT_EQ(shared.invalid_cells.size(), result.after.n_invalid);
    EXPECT_EQ(shared.passes.size(), result.passes.size());
    for (std::size_t i = 0; i < std::min(shared.passes.size(), result.passes.size()); ++i) {
      const PassReport &a = shared.passes[i], &b = result.passes[i];
      EXPECT_EQ(a.stage + " " + a.op, b.stage + " " + b.op) << "pass " << i;
      EXPECT_EQ(a.winners, b.winners) << a.op << ", pass " << i;
      EXPECT_EQ(a.n_inverted, b.n_inverted) << a.op << ", pass " << i;
      EXPECT_EQ(a.worst, b.worst) << a.op << ", pass " << i;
    }
    expect_same_surface(shared.surface, result.surface);
    io::write(folder.path() / "whole.vtu", run.mesh);
    EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
  }
  comm.sum(0);
  return shared;
}

}  // namespace hfr::test

#endif
