// SPDX-License-Identifier: BSD-3-Clause
// Meshes in parts, and the same passes in shared memory to compare with.
#ifndef HFR_UNITTESTS_DISTRIBUTED_PARTS_HH
#define HFR_UNITTESTS_DISTRIBUTED_PARTS_HH

#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/Near.hh"
#include "Distributed/Partition.hh"
#include "HalfFace/Check.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/Writer.hh"
#include "Operators/Clusters.hh"
#include "Scheduler/Workspace.hh"

namespace hfr::test {

/// The line with which act(parts) is refused, on a rank that finds the fault and on the others; empty where
/// it is not.
template <class Act>
std::string refusal_of(Act&& act) {
  mpi::Comm comm(MPI_COMM_WORLD);
  mpi::DistributedMesh parts(comm);
  try {
    act(parts);
  } catch (const mpi::RankFailed& failed) {
    return failed.what();
  } catch (const std::exception& error) {
    return comm.fail(2, error.what()).what();
  }
  return {};
}

/// A mesh and what rounds keep of it.
struct Whole {
  TetMesh mesh;
  Workspace work;

  template <class Metric>
  Whole(TetMesh input, const Metric& metric) : mesh(std::move(input)) {
    work.attach(mesh, {});
    work.set_qualities(mesh, metric, {});
  }
};

/// A jittered box, all cells of which are positive: what is not is moved half the way back until it is.
inline TetMesh valid_box(Index n, double jitter, std::uint64_t seed) {
  const TetMesh regular = jittered(n, 0, seed);
  TetMesh mesh = jittered(n, jitter, seed);
  for (bool is_valid = false; !is_valid;) {
    is_valid = true;
    for (CellHandle c : mesh.cells()) {
      const auto& v = mesh.cell(c).v;
      if (VolumeLength{}(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) > 0)
        continue;
      is_valid = false;
      for (VertexHandle u : v) mesh.set_point(u, (mesh.point(u) + regular.point(u)) * 0.5);
    }
  }
  return mesh;
}

/// A jittered box without some of its cells.
inline TetMesh torn(Index n, double jitter, double keep, std::uint64_t seed) {
  const generate::Arrays box = generate::jittered_box({n, n, n}, jitter, seed);
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < box.cells.size(); ++i)
    if (generate::random_unit(seed, i) < keep) kept.push_back(box.cells[i]);
  return build(box.points, kept);
}

/// Whose cells stand in memory in an order that has nothing to do with where they lie.
inline TetMesh scattered_box(Index n) {
  generate::Arrays box = generate::jittered_box({n, n, n}, 0.1, 3);
  std::mt19937_64 engine(7);
  std::shuffle(box.cells.begin(), box.cells.end(), engine);
  return build(box.points, box.cells);
}

/// The whole as the parts have it, from `whole` as it was cut, with all that gather() has to bring spoilt.
inline void gather_from_nothing(mpi::DistributedMesh& parts, Whole& whole) {
  if (parts.comm().rank() == 0) {
    TetMesh::Writer writer(whole.mesh);
    for (std::size_t c = 0; c < whole.mesh.n_cells(); ++c) writer.mark_deleted(CellHandle(c));
    for (std::size_t v = 0; v < whole.mesh.n_vertices(); ++v) {
      whole.mesh.set_point(V(v), {-1, -2, -3});
      writer.set_incident_cell(V(v), CellHandle());
    }
    whole.work.quality.assign(whole.work.quality.size(), -1);
    whole.work.pending.assign(whole.work.pending.size(), 0x55);
    whole.work.star_size.assign(whole.work.star_size.size(), 0);
    whole.work.changed.assign(whole.work.changed.size(), 0);
  }
  parts.gather(&whole.mesh, &whole.work, mpi::DistributedMesh::Gather::kEverything);
}

/// To the last bit, free list and incident cells included; workspaces where there are cells.
inline void expect_same(const Whole& a, const Whole& b, bool also_pending = true) {
  EXPECT_TRUE(identical(a.mesh, b.mesh));
  ASSERT_EQ(a.mesh.n_cells(), b.mesh.n_cells());
  std::size_t n_different = 0;
  for (std::size_t c = 0; c < a.mesh.n_cells(); ++c)
    if (!a.mesh.is_deleted(C(c)))
      n_different += a.work.quality[c] == b.work.quality[c] &&
                             (!also_pending || a.work.pending[c] == b.work.pending[c]) &&
                             a.mesh.region(C(c)) == b.mesh.region(C(c))
                         ? 0
                         : 1;
  EXPECT_EQ(n_different, 0U) << "qualities, pending bits or regions";
  EXPECT_EQ(a.work.star_size, b.work.star_size);
  EXPECT_EQ(a.work.changed, b.work.changed);
  EXPECT_EQ(a.work.clock, b.work.clock);
}

/// Of each vertex of the whole, how many edges it is away from one of this rank's own; 3: three or more.
inline std::vector<int> edges_to_own(const mpi::DistributedMesh& parts, const Whole& whole) {
  std::vector<int> distance(whole.mesh.n_vertices(), 3);
  for (std::size_t i = 0; i < parts.part().n_vertices(); ++i)
    if (parts.is_own(V(i))) distance[parts.number(V(i))] = 0;
  for (int step = 1; step <= 2; ++step)
    for (CellHandle c : whole.mesh.cells())
      for (VertexHandle u : whole.mesh.cell(c).v)
        for (VertexHandle w : whole.mesh.cell(c).v)
          if (distance[w.idx()] == step - 1 && distance[u.idx()] > step) distance[u.idx()] = step;
  return distance;
}

/// near() and within_two() are what the cells say, as far as they are exact.
inline void expect_near_sets(const mpi::DistributedMesh& parts, const std::vector<int>& distance) {
  const TetMesh& part = parts.part();
  mpi::RankSets one(part.n_vertices(), parts.comm().size()), two = one;
  std::vector<Index> all(part.n_cells());
  std::iota(all.begin(), all.end(), Index{0});
  mpi::find_near(
      part, all, [&](VertexHandle v) { return parts.owner(v); }, one, two);
  std::size_t n_wrong = 0;
  for (std::size_t i = 0; i < part.n_vertices(); ++i) {
    const int d = distance[parts.number(V(i))];
    if (part.is_deleted(V(i)) || !part.incident_cell(V(i)).is_valid()) continue;
    n_wrong += d <= 2 && !std::ranges::equal(one[i], parts.near(V(i))) ? 1 : 0;
    n_wrong += d <= 1 && !std::ranges::equal(two[i], parts.within_two(V(i))) ? 1 : 0;
    n_wrong += d == 0 && !std::ranges::equal(two[i], parts.told(V(i))) ? 1 : 0;
  }
  EXPECT_EQ(n_wrong, 0U) << "sets of near ranks";
}

/// This rank holds of the whole what it should, and no more: cells with a vertex within two edges of own
/// ones, as the whole has them, mates among them included.
inline void expect_part_of(const mpi::DistributedMesh& parts, const Whole& whole) {
  const TetMesh& part = parts.part();
  const std::vector<int> distance = edges_to_own(parts, whole);
  expect_near_sets(parts, distance);
  const auto should_hold = [&](CellHandle c) {
    const auto& v = whole.mesh.cell(c).v;
    return std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return distance[u.idx()] <= 2; });
  };
  std::size_t n_missing = 0, n_other_corners = 0, n_other_values = 0, n_other_mates = 0, n_held = 0;
  for (CellHandle c : whole.mesh.cells()) {
    if (!should_hold(c)) continue;
    ++n_held;
    const CellHandle here = parts.cell_at(c.idx());
    if (!here.is_valid() || part.is_deleted(here)) {
      ++n_missing;
      continue;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (parts.number(part.cell(here).v[k]) != whole.mesh.cell(c).v[k].idx()) ++n_other_corners;
      if (part.point(part.cell(here).v[k]) != whole.mesh.point(whole.mesh.cell(c).v[k])) ++n_other_values;
      const HalfFaceHandle m = whole.mesh.cell(c).mate[k], mine = part.cell(here).mate[k];
      const bool is_open = !m.is_valid() || !should_hold(cell_of(m));
      if (is_open ? mine.is_valid()
                  : !mine.is_valid() || corner_of(mine) != corner_of(m) ||
                        parts.number(cell_of(mine)) != cell_of(m).idx())
        ++n_other_mates;
    }
    if (parts.work().quality[here.idx()] != whole.work.quality[c.idx()]) ++n_other_values;
  }
  for (std::size_t i = 0; i < part.n_vertices(); ++i) {
    const auto v = parts.number(V(i));
    if (distance[v] > 2 || whole.mesh.is_deleted(V(v))) continue;
    const CellHandle mine = part.incident_cell(V(i)), theirs = whole.mesh.incident_cell(V(v));
    if (parts.work().star_size[i] != whole.work.star_size[v] ||
        parts.work().changed[i] != whole.work.changed[v] || mine.is_valid() != theirs.is_valid() ||
        (mine.is_valid() && parts.number(mine) != theirs.idx()))
      ++n_other_values;
  }
  std::size_t n_there = 0;
  for (std::size_t c = 0; c < part.n_cells(); ++c) n_there += part.is_deleted(C(c)) ? 0 : 1;
  EXPECT_EQ(n_missing, 0U);
  EXPECT_EQ(n_other_corners, 0U);
  EXPECT_EQ(n_other_mates, 0U);
  EXPECT_EQ(n_other_values, 0U);
  EXPECT_EQ(n_there, n_held);
}

/// The same passes on both, cut in every way; compares after each call of `passes`, which gives the counts of
/// what it did.
template <class Metric, class Passes>
void expect_same_for_parts(const TetMesh& input, const Metric& metric, int repetitions, std::size_t at_least,
                           Passes&& passes) {
  for (const mpi::Partition how :
       {mpi::Partition::kGraph, mpi::Partition::kCoordinates, mpi::Partition::kNumbers}) {
    mpi::Comm comm(MPI_COMM_WORLD);
    const bool first = comm.rank() == 0;
    Whole whole(input, metric);
    Whole cut = whole;
    const auto owner = mpi::partition(comm, first ? &cut.mesh : nullptr, how);
    mpi::DistributedMesh parts(comm);
    parts.scatter(&cut.mesh, &cut.work, owner);
    std::size_t n_changes = 0;
    for (int i = 0; i < repetitions; ++i) {
      const RoundCounts a = passes(whole);
      const RoundCounts b = passes(parts);
      n_changes += a.winners;
      EXPECT_EQ(a.seeds, b.seeds);
      EXPECT_EQ(a.candidates, b.candidates);
      EXPECT_EQ(a.winners, b.winners);
      EXPECT_EQ(a.held_back, b.held_back);
      EXPECT_EQ(whole.mesh.n_logical_cells(), parts.n_cells());
      expect_part_of(parts, whole);
      Whole together = cut;
      gather_from_nothing(parts, together);
      if (first) {
        expect_same(whole, together);
        EXPECT_EQ(check(together.mesh), Ok);
      }
      if (comm.sum(testing::Test::HasFailure() ? 1 : 0) > 0) return;
    }
    parts.gather(&cut.mesh, &cut.work, mpi::DistributedMesh::Gather::kChanged);
    if (first) expect_same(whole, cut, /*also_pending=*/false);
    EXPECT_GE(n_changes, at_least) << "the passes no longer find anything to do";
  }
}

}  // namespace hfr::test

#endif
