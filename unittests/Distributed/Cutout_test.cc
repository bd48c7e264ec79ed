// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Cutout.hh"

#include <gtest/gtest.h>

#include <numeric>
#include <optional>
#include <set>

#include "Distributed/CutoutRound.hh"
#include "Distributed/InParts.hh"
#include "Distributed/PartInsertion.hh"
#include "Distributed/Parts.hh"
#include "HalfFace/Check.hh"
#include "HalfFace/Generate.hh"
#include "Operators/VertexInsertion.hh"
#include "Remesh/PassState.hh"

namespace hfr::test {
namespace {

struct Sides {
  mpi::DistributedMesh parts;
  Whole whole;

  explicit Sides(mpi::Comm& comm) : parts(comm), whole(TetMesh(), MinSine2{}) {
    mpi::GridOptions options;
    options.cavity.counts = {7, 6, 8};
    options.cavity.jitter = 0.3;
    options.cavity.amplitude = 0;
    mpi::generate_in_parts(parts, options);
    parts.work().set_qualities(parts.part(), MinSine2{}, {});
    const generate::Arrays arrays = generate::cavity(options.cavity);
    whole = Whole(build(arrays.points, arrays.cells), MinSine2{});
  }
};

/// Cells with a vertex that so many edges lead to from a cell.
std::set<std::uint64_t> cells_round(const TetMesh& mesh, CellHandle first, int depth) {
  std::set<VertexHandle> vertices(mesh.cell(first).v.begin(), mesh.cell(first).v.end());
  for (int i = 0; i < depth; ++i) {
    const std::set<VertexHandle> before = vertices;
    for (VertexHandle v : before)
      for (CellHandle c : mesh.vertex_cells(v)) vertices.insert(mesh.cell(c).v.begin(), mesh.cell(c).v.end());
  }
  std::set<std::uint64_t> cells;
  for (VertexHandle v : vertices)
    for (CellHandle c : mesh.vertex_cells(v)) cells.insert(c.idx());
  return cells;
}

TEST(NumberIndex, FindsWhatWasPutInHoweverNumbersFall) {
  for (const std::uint64_t step :
       {std::uint64_t{1}, std::uint64_t{1} << 32U, std::uint64_t{0x9e3779b97f4a7c15}})
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
      mpi::NumberIndex index(n);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_TRUE(index.insert(i * step, static_cast<Index>(i)));
        EXPECT_FALSE(index.insert(i * step, 7));
      }
      for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(index[i * step], i);
      EXPECT_EQ(index[n * step], mpi::NumberIndex::kNone);
    }
}

TEST(Cutout, HasTheLayersAskedForRoundACell) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Sides sides(comm);
  for (const std::uint8_t depth : {1, 2, 4})
    for (std::uint64_t i = 0; i < sides.whole.mesh.n_cells(); i += 97) {
      mpi::Cutout cutout(sides.parts, std::span(&i, 1), std::span(&depth, 1));
      EXPECT_EQ(comm.sum(cutout.centres().size()), 1U);
      if (cutout.centres().empty()) {
        EXPECT_EQ(cutout.mesh().n_vertices(), 0U);
        continue;
      }
      std::set<std::uint64_t> found;
      const TetMesh& mesh = cutout.mesh();
      for (CellHandle c : mesh.cells()) {
        found.insert(cutout.number(c));
        const CellHandle there(cutout.number(c));
        for (std::size_t k = 0; k < 4; ++k) {
          ASSERT_EQ(cutout.number(mesh.cell(c).v[k]), sides.whole.mesh.cell(there).v[k].idx());
          const HalfFaceHandle mine = mesh.cell(c).mate[k], theirs = sides.whole.mesh.cell(there).mate[k];
          if (cutout.rim().is_rim[c.idx()] != 0 && !mine.is_valid()) continue;
          ASSERT_EQ(mine.is_valid(), theirs.is_valid());
          if (mine.is_valid()) {
            ASSERT_EQ(cutout.number(cell_of(mine)), cell_of(theirs).idx());
            ASSERT_EQ(corner_of(mine), corner_of(theirs));
          }
        }
        ASSERT_EQ(cutout.work().quality[c.idx()], sides.whole.work.quality[there.idx()]);
      }
      EXPECT_EQ(found, cells_round(sides.whole.mesh, CellHandle(i), depth));
    }
}

/// Whatever does not come to the rim is what it is in the whole; with enough layers nothing does.
TEST(Cutout, InsertionThatStaysOffTheRimIsThatOfTheWhole) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Sides sides(comm);
  std::array<std::uint64_t, 5> n_met{}, n_same{};
  for (const std::uint8_t depth : {1, 2, 3, 4})
    for (std::uint64_t i = 0; i < sides.whole.mesh.n_cells(); i += 41) {
      mpi::Cutout cutout(sides.parts, std::span(&i, 1), std::span(&depth, 1));
      if (cutout.centres().empty()) continue;
      using Op = VertexInsertion<MinSine2>;
      Op here{MinSine2{}, cutout.work().quality};
      here.rim = &cutout.rim();
      const auto found = here.evaluate(cutout.mesh(), Op::Seed(cutout.cell_at(i)));
      if (cutout.rim().has_met[cutout.cell_at(i).idx()] != 0) {
        ++n_met[depth];
        continue;
      }
      const Op there{MinSine2{}, sides.whole.work.quality};
      const auto expected = there.evaluate(sides.whole.mesh, Op::Seed(CellHandle(i)));
      ASSERT_EQ(found.has_value(), expected.has_value());
      if (!found) continue;
      ++n_same[depth];
      EXPECT_EQ(found->place, expected->place);
      EXPECT_EQ(found->new_worst, expected->new_worst);
      Scope mine, theirs;
      here.scope(cutout.mesh(), found->seed, mine);
      there.scope(sides.whole.mesh, expected->seed, theirs);
      ASSERT_EQ(mine.size(), theirs.size());
      for (std::size_t k = 0; k < mine.size(); ++k) EXPECT_EQ(cutout.number(mine[k]), theirs[k].idx());
    }
  comm.sum(n_met);
  comm.sum(n_same);
  EXPECT_GT(n_met[1], 0U);
  EXPECT_GT(n_met[1], n_met[2]);
  EXPECT_GE(n_met[2], n_met[3]);
  EXPECT_EQ(n_met[4], 0U);
  EXPECT_GT(n_same[2], 10U);
  EXPECT_GT(n_same[4], 10U);
}

/// Where links are checked, what two winners without a common cell would make is made by the first alone.
TEST(Cutout, WinnersMakeNothingTwice) {
  mpi::Comm comm(MPI_COMM_WORLD);
  Sides sides(comm);
  const std::vector<std::uint64_t> cells = {3, 700, 1300};
  const std::vector<std::uint8_t> depth(cells.size(), 1);
  mpi::Cutout cutout(sides.parts, cells, depth);
  PlanBase plan;
  plan.n_removed = 1;
  plan.n_created = 4;
  plan.adds_vertex = true;
  std::vector<CellHandle> scopes;
  for (std::uint64_t number : cutout.centres()) scopes.push_back(cutout.cell_at(number));
  /// Each takes one cell; of three, the first two would make the same.
  class Three : public RoundPlace::Candidates {
   public:
    Three(const PlanBase& plan, std::span<const CellHandle> scopes) : plan_(plan), scopes_(scopes) {}
    std::vector<std::uint64_t> keys;

    std::size_t size() const override { return keys.size(); }
    std::uint64_t key(std::size_t i) const override { return keys[i]; }
    SeedName name(std::size_t) const override { return {}; }
    SeedAddress seed(std::size_t i) const override { return {scopes_[i], {}}; }
    const PlanBase& plan(std::size_t) const override { return plan_; }
    std::span<const CellHandle> scope(std::size_t i) const override { return scopes_.subspan(i, 1); }
    std::vector<std::uint64_t> made(std::size_t i) const override {
      return {keys[i] == 2 ? 5U : 4U, 6U + keys[i]};
    }

   private:
    const PlanBase& plan_;
    std::span<const CellHandle> scopes_;
  } candidates(plan, scopes);
  for (std::uint64_t centre : cutout.centres())
    candidates.keys.push_back(static_cast<std::uint64_t>(std::ranges::find(cells, centre) - cells.begin()));
  const auto winners = [&](bool check_links, std::size_t may_gain) {
    std::vector<std::uint64_t> found;
    mpi::CutoutRound round(cutout, sides.parts);
    for (const auto& one : round.select(candidates, kNoLimit, may_gain, check_links).winners) {
      found.push_back(candidates.key(one.candidate));
      EXPECT_EQ(one.fresh.size(), 3U);
    }
    found = comm.all_gather(std::span<const std::uint64_t>(found));
    std::ranges::sort(found);
    return found;
  };
  EXPECT_EQ(winners(false, kNoLimit), (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(winners(true, kNoLimit), (std::vector<std::uint64_t>{0, 2}));
  EXPECT_EQ(winners(false, 6), (std::vector<std::uint64_t>{0, 1}));
}

TEST(Cutout, InsertionIsTheSameHoweverManyLayersAreTriedFirst) {
  mpi::Comm comm(MPI_COMM_WORLD);
  std::optional<Whole> expected;
  for (const std::uint8_t depth : {6, 1, 2}) {
    Sides sides(comm);
    std::vector<Index> all(sides.parts.part().n_cells());
    std::iota(all.begin(), all.end(), Index{0});
    const double below = dihedral_decision(14);
    const Ranks::Dig dig{
        {PassKind::kInsert, Metric::kMinSine, below, 0, 1, kNoLimit, kNoLimit}, 1, false, kNoLimit};
    std::vector<std::uint64_t> waiting;
    std::size_t n_winners = 0;
    for (int i = 0; i < 3; ++i) {
      const Worklist list(sides.parts.part(), {}, std::span<const Index>(all), [&](CellHandle c) {
        return i == 0 && !sides.parts.part().is_deleted(c) && sides.parts.work().quality[c.idx()] < below;
      });
      n_winners += mpi::insert_in_parts(sides.parts, dig, list, waiting, depth).winners;
    }
    EXPECT_GT(n_winners, 20U);
    gather_from_nothing(sides.parts, sides.whole);
    if (comm.rank() != 0) continue;
    EXPECT_EQ(check(sides.whole.mesh), Ok);
    if (expected)
      expect_same(*expected, sides.whole);
    else
      expected = std::move(sides.whole);
  }
}

}  // namespace
}  // namespace hfr::test
