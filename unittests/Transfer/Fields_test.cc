// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Fields.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "HalfFace/Geometry.hh"
#include "Transfer/TwoMeshes.hh"

namespace hfr::test {
namespace {

using ::testing::HasSubstr;

std::string message(const std::function<void()>& f) {
  try {
    f();
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

double linear(Vec3 p) { return 3 - 2 * p.x + 5 * p.y + 0.25 * p.z; }

/// Two meshes with a property on the old one; the new one has it with nonsense.
struct WithFields : TwoMeshes {
  using TwoMeshes::TwoMeshes;
  template <class T, class Value>
  void add_vertex_field(const std::string& name, Value&& value) {
    auto p = old.request_vertex_property<T>(name);
    for (VertexHandle v : old.vertices()) p[v] = value(old.point(v));
    auto q = now.request_vertex_property<T>(name);
    for (VertexHandle v : now.vertices())
      if (maps.old_vertices[v.idx()].is_valid()) q[v] = p[maps.old_vertices[v.idx()]];
  }
  template <class T, class Value>
  void add_cell_field(const std::string& name, Value&& value) {
    auto p = old.request_cell_property<T>(name);
    for (CellHandle c : old.cells()) p[c] = value(c);
    auto q = now.request_cell_property<T>(name);
    for (CellHandle c : now.cells())
      if (maps.old_cells[c.idx()].is_valid()) q[c] = p[maps.old_cells[c.idx()]];
  }
  std::vector<FieldReport> transfer(std::vector<FieldTransfer> fields) {
    return transfer_fields(old, now, edits(), fields, {});
  }
};

TEST(TransferLinear, LinearFunctionsOfAnyTypeAreExact) {
  WithFields two(5, 0.15, 1);
  two.add_vertex_field<double>("T", linear);
  two.add_vertex_field<float>("f", [](Vec3 p) { return static_cast<float>(linear(p)); });
  two.add_vertex_field<Vec3>("x", [](Vec3 p) { return p; });
  const auto reports = two.transfer({{.name = "T"}, {.name = "f"}, {.name = "x"}});
  const auto t = two.now.get_vertex_property<double>("T");
  const auto f = two.now.get_vertex_property<float>("f");
  const auto x = two.now.get_vertex_property<Vec3>("x");
  for (VertexHandle v : two.now.vertices()) {
    EXPECT_NEAR((*t)[v], linear(two.now.point(v)), 1e-13);
    EXPECT_NEAR((*f)[v], linear(two.now.point(v)), 1e-6);
    EXPECT_NEAR(norm((*x)[v] - two.now.point(v)), 0, 1e-14);
  }
  const Edits edits = two.edits();
  for (const FieldReport& report : reports) {
    EXPECT_EQ(report.n_changed, edits.created_vertices.size() + edits.moved_vertices.size());
    EXPECT_EQ(report.n_outside, 0U);
  }
}

TEST(TransferLinear, ConstantStaysOneToTheBitAndVerticesThatHaveNotMovedKeepTheirs) {
  WithFields two(5, 0.15, 2);
  two.add_vertex_field<double>("c", [](Vec3) { return 0.1; });
  two.add_vertex_field<double>("noise", [](Vec3 p) { return std::sin(1e6 * (p.x + 2 * p.y + 3 * p.z)); });
  two.transfer({{.name = "c"}, {.name = "noise"}});
  const auto c = two.now.get_vertex_property<double>("c");
  const auto noise = two.now.get_vertex_property<double>("noise");
  const auto was = std::as_const(two.old).get_vertex_property<double>("noise");
  std::size_t n_kept = 0;
  for (VertexHandle v : two.now.vertices()) {
    EXPECT_EQ((*c)[v], 0.1);
    const VertexHandle o = two.maps.old_vertices[v.idx()];
    if (!o.is_valid() || !(two.now.point(v) == two.old.point(o))) continue;
    EXPECT_EQ((*noise)[v], (*was)[o]);
    ++n_kept;
  }
  EXPECT_GT(n_kept, 100U);
}

/// Of all vertices that have moved or are new: by how much the field is off at most, and in the mean.
std::pair<double, double> off(const WithFields& two, const std::string& name,
                              const std::function<double(Vec3)>& exact) {
  const auto field = two.now.get_vertex_property<double>(name);
  double most = 0, sum = 0;
  std::size_t n = 0;
  for (VertexHandle v : two.now.vertices()) {
    const double error = std::abs((*field)[v] - exact(two.now.point(v)));
    most = std::max(most, error);
    sum += error;
    n += error > 0 ? 1 : 0;
  }
  return {most, sum / static_cast<double>(std::max<std::size_t>(n, 1))};
}

TEST(TransferQuadratic, LinearFunctionsAreExactAndConstantsStayToTheBit) {
  WithFields two(5, 0.15, 1);
  two.add_vertex_field<double>("T", linear);
  two.add_vertex_field<double>("c", [](Vec3) { return 0.1; });
  two.add_vertex_field<Vec3>("x", [](Vec3 p) { return p; });
  const auto reports = two.transfer({{.name = "T", .how = Transfer::kQuadratic},
                                     {.name = "c", .how = Transfer::kQuadratic},
                                     {.name = "x", .how = Transfer::kQuadratic}});
  const auto t = two.now.get_vertex_property<double>("T");
  const auto c = two.now.get_vertex_property<double>("c");
  const auto x = two.now.get_vertex_property<Vec3>("x");
  for (VertexHandle v : two.now.vertices()) {
    EXPECT_NEAR((*t)[v], linear(two.now.point(v)), 1e-13);
    EXPECT_EQ((*c)[v], 0.1);
    EXPECT_NEAR(norm((*x)[v] - two.now.point(v)), 0, 1e-14);
  }
  const Edits edits = two.edits();
  EXPECT_EQ(reports[0].n_changed, edits.created_vertices.size() + edits.moved_vertices.size());
  EXPECT_GT(reports[0].n_changed, 10U);
}

TEST(TransferQuadratic, SmoothFunctionIsCloserThanLinearly) {
  const auto smooth = [](Vec3 p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + p.z * p.z; };
  for (const unsigned seed : {1U, 2U, 3U}) {
    WithFields two(8, 0.15, seed);
    two.add_vertex_field<double>("linear", smooth);
    two.add_vertex_field<double>("bent", smooth);
    two.transfer({{.name = "linear"}, {.name = "bent", .how = Transfer::kQuadratic}});
    EXPECT_LT(off(two, "bent", smooth).second, 0.5 * off(two, "linear", smooth).second);
  }
}

TEST(TransferQuadratic, NoValueLeavesTheRangeOfTheCornersThatTheVertexLiesBetween) {
  WithFields two(6, 0.15, 5);
  two.add_vertex_field<double>("step", [](Vec3 p) { return p.x < 0.5 ? 0.0 : 1.0; });
  two.transfer({{.name = "step", .how = Transfer::kQuadratic}});
  const auto step = two.now.get_vertex_property<double>("step");
  std::size_t n_between = 0;
  for (VertexHandle v : two.now.vertices()) {
    EXPECT_GE((*step)[v], 0);
    EXPECT_LE((*step)[v], 1);
    n_between += (*step)[v] > 0 && (*step)[v] < 1 ? 1 : 0;
  }
  EXPECT_GT(n_between, 5U) << "no vertex lies where the field jumps";
}

TEST(TransferQuadratic, SizeOfTheMeshDoesNotMatter) {
  std::vector<double> values;
  for (const double scale : {1.0, 0x1p-100, 0x1p100}) {
    WithFields two(4, 0.15, 6);
    for (TetMesh* mesh : {&two.old, &two.now})
      for (VertexHandle v : mesh->vertices()) mesh->set_point(v, scale * mesh->point(v));
    two.add_vertex_field<double>("T", [&](Vec3 p) { return std::sin(3 * p.x / scale) + p.y / scale; });
    two.transfer({{.name = "T", .how = Transfer::kQuadratic}});
    const auto t = two.now.get_vertex_property<double>("T");
    double sum = 0;
    for (VertexHandle v : two.now.vertices()) sum += (*t)[v];
    values.push_back(sum);
  }
  EXPECT_NEAR(values[1], values[0], 1e-9);
  EXPECT_NEAR(values[2], values[0], 1e-9);
}

TEST(TransferInherited, CreatedCellsHaveTheValueOfTheCellThatTheyCoverMostOf) {
  WithFields two(5, 0.15, 3);
  two.add_cell_field<int>("material", [](CellHandle c) { return static_cast<int>(c.idx()); });
  two.add_cell_field<std::string>("name", [](CellHandle c) { return "cell " + std::to_string(c.idx()); });
  const Edits edits = two.edits();
  two.transfer(
      {{.name = "material", .how = Transfer::kInherit}, {.name = "name", .how = Transfer::kInherit}});
  const auto material = two.now.get_cell_property<int>("material");
  const auto name = two.now.get_cell_property<std::string>("name");
  for (std::size_t i = 0; i < edits.created_cells.size(); ++i) {
    const CellHandle c = edits.created_cells[i].cell, parent = edits.parents().of(i).front().old_cell;
    EXPECT_EQ((*material)[c], static_cast<int>(parent.idx()));
    EXPECT_EQ((*name)[c], "cell " + std::to_string(parent.idx()));
  }
  for (CellHandle c : two.now.cells())
    if (edits.maps.old_cells[c.idx()].is_valid()) {
      EXPECT_EQ((*material)[c], static_cast<int>(edits.maps.old_cells[c.idx()].idx()));
    }
}

TEST(TransferConserved, IntegralsOfEachComponentStay) {
  WithFields two(6, 0.15, 4);
  two.add_cell_field<double>("rho", [&](CellHandle c) { return 2 + std::sin(1.0 * c.idx()); });
  two.add_cell_field<Vec3>("u", [&](CellHandle c) {
    return Vec3{std::cos(3.0 * c.idx()), 1, 0.1 * (c.idx() % 7)};
  });
  const auto sums = [](const TetMesh& mesh) {
    std::array<double, 4> s{};
    const auto rho = mesh.get_cell_property<double>("rho");
    const auto u = mesh.get_cell_property<Vec3>("u");
    for (CellHandle c : mesh.cells()) {
      const double mass = volume(mesh, c) * (*rho)[c];
      s[0] += mass;
      for (int k = 0; k < 3; ++k) s[static_cast<std::size_t>(k) + 1] += mass * (*u)[c][k];
    }
    return s;
  };
  // The velocity stands first: its density is transferred before it all the same.
  const auto reports = two.transfer({{.name = "u", .how = Transfer::kConserve, .density = "rho"},
                                     {.name = "rho", .how = Transfer::kConserve}});
  const auto before = sums(two.old), after = sums(two.now);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(after[k], before[k], 1e-13 * std::abs(before[k]));
  ASSERT_EQ(reports[0].lost.size(), 3U);
  for (const double lost : reports[0].lost) EXPECT_NEAR(lost, 0, 1e-15);
  const auto u = two.now.get_cell_property<Vec3>("u");
  for (CellHandle c : two.now.cells()) EXPECT_EQ((*u)[c].y, 1);
}

TEST(TransferByCallback, IsCalledOnceWithBothMeshes) {
  WithFields two(4, 0.1, 5);
  int n_calls = 0;
  two.transfer({{.name = "own",
                 .how = Transfer::kCallback,
                 .callback = [&](const TetMesh& a, TetMesh& b, const Edits& e) {
                   ++n_calls;
                   EXPECT_EQ(&a, &two.old);
                   EXPECT_EQ(&b, &two.now);
                   EXPECT_FALSE(e.created_cells.empty());
                 }}});
  EXPECT_EQ(n_calls, 1);
}

TEST(TransferFields, WhatCannotBeTransferredIsNamed) {
  WithFields two(3, 0.1, 1);
  two.add_vertex_field<double>("T", linear);
  two.add_vertex_field<int>("n", [](Vec3) { return 1; });
  two.add_cell_field<int>("material", [](CellHandle) { return 1; });
  two.add_cell_field<Vec3>("u", [](CellHandle) { return Vec3{}; });
  two.add_cell_field<double>("rho", [](CellHandle) { return 1.0; });
  const auto says = [&](FieldTransfer field) {
    return message([&] { validate_fields(two.old, std::vector{field}); });
  };
  EXPECT_EQ(says({.name = "T"}), "");
  EXPECT_THAT(message([&] {
                validate_fields(two.old,
                                std::vector<FieldTransfer>{{.name = "rho", .how = Transfer::kConserve},
                                                           {.name = "rho", .how = Transfer::kInherit}});
              }),
              HasSubstr("'rho' is to be transferred in two ways"));
  EXPECT_THAT(says({.name = "Q"}), HasSubstr("no field 'Q' of vertices"));
  EXPECT_THAT(says({.name = "rho"}), HasSubstr("'rho' is one of cells"));
  EXPECT_THAT(says({.name = "n"}), HasSubstr("'n' does not hold floating-point numbers"));
  EXPECT_THAT(says({.name = "material", .how = Transfer::kConserve}), HasSubstr("inherited only"));
  EXPECT_THAT(says({.name = "u", .how = Transfer::kConserve, .density = "rho"}),
              HasSubstr("conserved itself"));
  EXPECT_THAT(says({.name = "rho", .how = Transfer::kConserve, .density = "u"}),
              HasSubstr("more than one component"));
  EXPECT_THAT(says({.name = "own", .how = Transfer::kCallback}), HasSubstr("has none"));
  EXPECT_THAT(message([] { transfer_from_name("copy"); }), HasSubstr("linear, quadratic, inherit, conserve"));
}

TEST(TransferFields, SameBitsForAnyNumberOfThreads) {
  std::map<int, std::vector<double>> results;
  for (const int threads : {1, 2, 5}) {
    WithFields two(8, 0.15, 6);
    two.add_vertex_field<double>("T", linear);
    two.add_cell_field<double>("rho", [&](CellHandle c) { return 2 + std::sin(1.0 * c.idx()); });
    const par::Policy policy{.threads = threads, .serial_below = 0};
    const std::vector<FieldTransfer> fields = {{.name = "T"}, {.name = "rho", .how = Transfer::kConserve}};
    transfer_fields(two.old, two.now, two.edits(policy), fields, policy);
    auto& out = results[threads];
    for (const double x : two.now.get_vertex_property<double>("T")->values()) out.push_back(x);
    for (const double x : two.now.get_cell_property<double>("rho")->values()) out.push_back(x);
  }
  EXPECT_EQ(results[1], results[2]);
  EXPECT_EQ(results[1], results[5]);
}

}  // namespace
}  // namespace hfr::test
