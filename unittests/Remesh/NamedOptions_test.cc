// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/NamedOptions.hh"

#include <gmock/gmock.h>

#include <map>

#include "HalfFace/Errors.hh"

namespace hfr {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string refusal(ImproveOptions& options, const std::string& name, const std::string& value) {
  try {
    set_option(options, name, value);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(NamedOptions, GoalIsANumberOrMaxAndTheLastOneCounts) {
  ImproveOptions options;
  set_option(options, "min_dihedral", "20.5");
  EXPECT_EQ(options.min_dihedral, 20.5);
  set_option(options, "min_dihedral", "max");
  EXPECT_TRUE(options.raise_min_dihedral);
  EXPECT_FALSE(options.min_dihedral);
  set_option(options, "min-dihedral", "15");
  EXPECT_FALSE(options.raise_min_dihedral);
  EXPECT_EQ(options.min_dihedral, 15);
}

TEST(NamedOptions, WhatIsFixedAddsUp) {
  ImproveOptions options;
  set_option(options, "fix", "patch:-3");
  set_option(options, "fix", "vertex:7");
  set_option(options, "fix", "edge:1-2");
  set_option(options, "fix", "face:4-5-6");
  set_option(options, "fix", "vertex:8");
  set_option(options, "periodic", "1:2");
  const SurfaceOptions& s = options.surface;
  EXPECT_EQ(s.fixed_patches, std::vector<int>{-3});
  EXPECT_EQ(s.fixed_vertices, (std::vector{VertexHandle(7), VertexHandle(8)}));
  EXPECT_EQ(s.fixed_edges, (std::vector{std::array{VertexHandle(1), VertexHandle(2)}}));
  EXPECT_EQ(s.fixed_faces, (std::vector{std::array{VertexHandle(4), VertexHandle(5), VertexHandle(6)}}));
  EXPECT_EQ(s.periodic, (std::vector{std::array{1, 2}}));
}

TEST(NamedOptions, NoInsertTakesFromTheOperators) {
  ImproveOptions options;
  set_option(options, "ops", "edge,insert");
  set_option(options, "no_insert", "true");
  EXPECT_EQ(options.ops, Ops::kEdge);
  set_option(options, "no_insert", "off");
  EXPECT_EQ(options.ops, Ops::kEdge | Ops::kInsert);
}

/// A text that each option takes. Who adds an option adds it here.
const std::map<std::string, std::string> kGood = {
    {"min_dihedral", "20"}, {"iterations", "3"},     {"time_limit", "1.5"},  {"surface", "free"},
    {"hausdorff", "0.1"},   {"feature_angle", "30"}, {"fix", "patch:1"},     {"periodic", "1:2"},
    {"min_cells", "10"},    {"max_cells", "20"},     {"coarsen", "1"},       {"metric", "mean-ratio"},
    {"ops", "edge"},        {"no_insert", "on"},     {"bulk_nodes", "true"}, {"polish_only", "true"},
    {"passes_only", "on"},  {"rounds", "mixed"},     {"smoother", "taubin"}, {"compat", "jpdc2013"},
    {"seed", "5"},          {"threads", "2"},        {"device", "auto"},     {"hybrid", "true"},
    {"work_group", "64"}};

TEST(NamedOptions, EveryOptionTakesItsTextAndRefusesAnother) {
  for (const NamedOption& option : named_options()) {
    ASSERT_TRUE(kGood.contains(option.name)) << option.name;
    ImproveOptions options;
    EXPECT_EQ(refusal(options, option.name, kGood.at(option.name)), "") << option.name;
    for (const char* bad :
         {"", "nan", "-1e99", "12x", "patch:", "edge:1-", "face:1-2", "vertex:-1", "1:", "é"})
      EXPECT_THAT(refusal(options, option.name, bad), StartsWith(option.name)) << option.name << " " << bad;
  }
  EXPECT_EQ(named_options().size(), kGood.size());
}

TEST(NamedOptions, NumbersOutOfRangeAreRefusedAtOnce) {
  ImproveOptions options;
  EXPECT_THAT(refusal(options, "min_dihedral", "71"), HasSubstr("(0, 70.5)"));
  EXPECT_THAT(refusal(options, "min_dihedral", "0"), HasSubstr("'0'"));
  EXPECT_THAT(refusal(options, "time_limit", "0"), HasSubstr("above 0"));
  EXPECT_THAT(refusal(options, "time_limit", "inf"), HasSubstr("'inf'"));
  EXPECT_THAT(refusal(options, "work_group", "3"), HasSubstr("power of two"));
  EXPECT_THAT(refusal(options, "threads", "1025"), HasSubstr("1024"));
  EXPECT_THAT(refusal(options, "fix", "vertex:18446744073709551615"), HasSubstr("vertex:N"));
  EXPECT_FALSE(options.min_dihedral);
  EXPECT_TRUE(options.surface.fixed_vertices.empty());
}

TEST(NamedOptions, UnknownNamesAreListed) {
  ImproveOptions options;
  EXPECT_THAT(refusal(options, "min_angle", "20"),
              AllOf(HasSubstr("no option is called 'min_angle'"), HasSubstr("min_dihedral")));
}

const std::map<std::string, std::string> kGoodOfRemesher = {{"trigger", "8"},
                                                            {"trigger_inverted", "off"},
                                                            {"trigger_metric", "mean-ratio:0.2"},
                                                            {"trigger_jacobian", ".5"},
                                                            {"trigger_motion", "2"},
                                                            {"trigger_every", "10"},
                                                            {"trigger_field", "marked"},
                                                            {"on_inversion", "refuse"},
                                                            {"max_substeps", "4"},
                                                            {"motion", "elastic"},
                                                            {"transfer", "T:linear"},
                                                            {"parents", "off"},
                                                            {"ids", "true"}};

TEST(NamedOptions, ARemesherTakesItsOwnAndThoseOfItsRepairs) {
  for (const NamedOption& option : named_remesher_options()) {
    ASSERT_TRUE(kGoodOfRemesher.contains(option.name)) << option.name;
    RemesherOptions options;
    EXPECT_NO_THROW(set_option(options, option.name, kGoodOfRemesher.at(option.name))) << option.name;
    for (const char* bad :
         {"", "nan", "-1e99", "12x", ":", "T:", ":linear", "T:paint", "mean-ratio:", "beauty:1"}) {
      if (std::string_view(option.name) == "trigger_field" && *bad) continue;  // a field may be called so
      try {
        set_option(options, option.name, bad);
        ADD_FAILURE() << option.name << " takes " << bad;
      } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), StartsWith(option.name));
      }
    }
  }
  EXPECT_EQ(named_remesher_options().size(), kGoodOfRemesher.size());
  RemesherOptions options;
  set_option(options, "min_dihedral", "18");
  EXPECT_EQ(options.improve.min_dihedral, 18);
  EXPECT_THROW(set_option(options, "min_angle", "18"), InvalidInput);
}

TEST(NamedOptions, FieldsAreNamedWithTheirWay) {
  RemesherOptions options;
  set_option(options, "transfer", "rho:conserve");
  set_option(options, "transfer", "u:conserve:rho");
  set_option(options, "transfer", "a:b:inherit");
  ASSERT_EQ(options.fields.size(), 3U);
  EXPECT_EQ(options.fields[0].name, "rho");
  EXPECT_EQ(options.fields[0].density, "");
  EXPECT_EQ(options.fields[1].name, "u");
  EXPECT_EQ(options.fields[1].density, "rho");
  EXPECT_EQ(options.fields[1].how, Transfer::kConserve);
  EXPECT_EQ(options.fields[2].name, "a:b");
  EXPECT_EQ(options.fields[2].how, Transfer::kInherit);
}

}  // namespace
}  // namespace hfr
