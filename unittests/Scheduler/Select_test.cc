// SPDX-License-Identifier: BSD-3-Clause
// The serial marking loop is the oracle of the lock-free claims; its own is the definition.
#include "Scheduler/Select.hh"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace hfr {
namespace {

struct Clusters {
  std::size_t n_cells = 0;
  std::vector<std::vector<CellHandle>> cells;

  ScopeList scopes(par::Policy policy) const {
    return ScopeList(policy, cells.size(), [&](std::size_t i, Scope& out) {
      out.clear();
      for (CellHandle c : cells[i]) out.push_back(c);
    });
  }
};

/// Clusters of up to 12 cells, near each other in number as those of a mesh are, or anywhere.
Clusters random_clusters(std::uint64_t seed, std::size_t n, std::size_t n_cells) {
  std::mt19937_64 engine(seed);
  Clusters all{n_cells, {}};
  for (std::size_t i = 0; i < n; ++i) {
    std::set<CellHandle> cells;
    const std::size_t size = 1 + engine() % 12;
    const std::size_t reach = engine() % 2 ? n_cells : 40;
    const std::size_t first = engine() % n_cells;
    while (cells.size() < size) cells.insert(CellHandle((first + engine() % reach) % n_cells));
    all.cells.emplace_back(cells.begin(), cells.end());
  }
  return all;
}

struct Selection {
  std::vector<std::uint32_t> winners, claim;
  bool operator==(const Selection&) const = default;
};

Selection marked(const Clusters& clusters) {
  Selection s{{}, std::vector<std::uint32_t>(clusters.n_cells, kUnclaimed)};
  s.winners = select_by_marking(clusters.scopes({}), s.claim);
  return s;
}

Selection claimed(const Clusters& clusters, int threads, std::size_t* sub_rounds = nullptr) {
  const par::Policy policy{threads, 1};
  Selection s{{}, std::vector<std::uint32_t>(clusters.n_cells, kUnclaimed)};
  s.winners = select_by_claims(policy, clusters.scopes(policy), s.claim, sub_rounds);
  return s;
}

TEST(Select, MarkingGivesTheFirstIndependentSetByDefinition) {
  const Clusters clusters = random_clusters(1, 300, 400);
  const Selection s = marked(clusters);
  std::set<CellHandle> taken;
  std::vector<std::uint32_t> wanted;
  for (std::uint32_t i = 0; i < clusters.cells.size(); ++i) {
    if (std::any_of(clusters.cells[i].begin(), clusters.cells[i].end(),
                    [&](CellHandle c) { return taken.contains(c); }))
      continue;
    for (CellHandle c : clusters.cells[i]) {
      taken.insert(c);
      EXPECT_EQ(s.claim[c.idx()], wanted.size());
    }
    wanted.push_back(i);
  }
  EXPECT_EQ(s.winners, wanted);
  EXPECT_GT(wanted.size(), 30U);
  for (std::size_t c = 0; c < clusters.n_cells; ++c)
    EXPECT_EQ(s.claim[c] == kUnclaimed, !taken.contains(CellHandle(c)));
}

TEST(Select, ClaimsGiveTheSetOfTheMarkingForAnyNumberOfThreads) {
  std::size_t n_winners = 0;
  std::size_t n_losers = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Clusters clusters = random_clusters(seed, 20 + 7 * seed, 30 + 10 * seed);
    const Selection wanted = marked(clusters);
    for (int threads : {1, 2, 3, 7}) ASSERT_EQ(claimed(clusters, threads), wanted) << threads << " threads";
    n_winners += wanted.winners.size();
    n_losers += clusters.cells.size() - wanted.winners.size();
  }
  EXPECT_GT(n_winners, 10000U);
  EXPECT_GT(n_losers, 10000U);
}

TEST(Select, AChainWhereEachMeetsTheNextTakesASubRoundALink) {
  Clusters chain{1001, {}};
  for (std::size_t i = 0; i < 1000; ++i) chain.cells.push_back({CellHandle(i), CellHandle(i + 1)});
  std::size_t sub_rounds = 0;
  EXPECT_EQ(claimed(chain, 3, &sub_rounds), marked(chain));
  EXPECT_EQ(sub_rounds, 500U);
}

TEST(Select, TakesClaimsWhereTheyPayAndSaysSo) {
  const Clusters many = random_clusters(3, kClaimCandidates, 50000);
  const Selection wanted = marked(many);
  for (int threads : {1, kClaimThreads}) {
    std::vector<std::uint32_t> claim(many.n_cells, kUnclaimed);
    std::size_t sub_rounds = 0;
    EXPECT_EQ(select({threads, 1}, many.scopes({}), claim, &sub_rounds), wanted.winners);
    EXPECT_EQ(sub_rounds > 1, threads > 1);
  }
}

TEST(Select, NothingToSelectFrom) {
  const Clusters none{5, {}};
  EXPECT_TRUE(marked(none).winners.empty());
  EXPECT_TRUE(claimed(none, 2).winners.empty());
  EXPECT_TRUE(colour_clusters({}, none.scopes({}), 5).empty());
}

TEST(Select, AcceptMayRefuseAClusterWhoseCellsAreFree) {
  const Clusters pair{3, {{CellHandle(0), CellHandle(1)}, {CellHandle(1), CellHandle(2)}}};
  std::vector<std::uint32_t> claim(3, kUnclaimed);
  EXPECT_EQ(select_by_marking(pair.scopes({}), claim, [](std::size_t i) { return i != 0; }),
            (std::vector<std::uint32_t>{1}));
}

TEST(ColourClusters, NoTwoOfAColourShareACellAndEachMeetsAllLowerColours) {
  for (int threads : {1, 2, 7}) {
    const Clusters clusters = random_clusters(5, 500, 800);
    const auto colour = colour_clusters({threads, 1}, clusters.scopes({}), clusters.n_cells);
    std::vector<std::set<std::uint32_t>> colours_at(clusters.n_cells);
    for (std::size_t i = 0; i < colour.size(); ++i)
      for (CellHandle c : clusters.cells[i]) ASSERT_TRUE(colours_at[c.idx()].insert(colour[i]).second);
    for (std::size_t i = 0; i < colour.size(); ++i) {
      std::set<std::uint32_t> met;
      for (CellHandle c : clusters.cells[i])
        met.insert(colours_at[c.idx()].begin(), colours_at[c.idx()].end());
      for (std::uint32_t k = 0; k < colour[i]; ++k) EXPECT_TRUE(met.contains(k));
    }
    EXPECT_GT(*std::max_element(colour.begin(), colour.end()), 3U);
  }
}

}  // namespace
}  // namespace hfr
