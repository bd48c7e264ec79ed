// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "HalfFace/Errors.hh"
#include "Remesh/Improve.hh"

namespace hfr::test {
namespace {

TEST(Ops, ListsRoundTrip) {
  for (unsigned bits = 1; bits < 64; ++bits) {
    const Ops ops = static_cast<Ops>(bits);
    EXPECT_EQ(ops_from_list(ops_to_list(ops)), ops) << ops_to_list(ops);
  }
  EXPECT_EQ(ops_from_list("edge,face,node,smooth,insert"), Ops::kDefault);
  EXPECT_EQ(ops_from_list("smooth,edge"), Ops::kEdge | Ops::kSmooth);
  EXPECT_EQ(ops_from_list("edge,edge"), Ops::kEdge);
}

TEST(Ops, UnknownAndEmptyNamesAreRefusedWithTheListOfNames) {
  for (const char* list : {"", "edgy", "edge,,face", " edge", "EDGE", "edge;face"}) {
    try {
      ops_from_list(list);
      ADD_FAILURE() << "accepted '" << list << "'";
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("edge, face, node, smooth, insert"));
    }
  }
}

TEST(Options, RoundsAreKnownByName) {
  EXPECT_EQ(rounds_from_name("auto"), Rounds::kAuto);
  EXPECT_EQ(rounds_from_name("by-kind"), Rounds::kByKind);
  EXPECT_EQ(rounds_from_name("mixed"), Rounds::kMixed);
  for (const char* name : {"", "Mixed", "bykind"}) EXPECT_THROW(rounds_from_name(name), InvalidInput);
}

TEST(Smoothers, AreFoundByNameAndOthersRefused) {
  EXPECT_EQ(smoother_from_name("newton"), Smoother::kNewton);
  EXPECT_EQ(smoother_from_name("candidates"), Smoother::kCandidates);
  EXPECT_EQ(smoother_from_name("laplacian"), Smoother::kLaplacian);
  EXPECT_EQ(smoother_from_name("taubin"), Smoother::kTaubin);
  for (const char* name : {"", "Newton", "newton "}) EXPECT_THROW(smoother_from_name(name), InvalidInput);
}

}  // namespace
}  // namespace hfr::test
