// SPDX-License-Identifier: BSD-3-Clause
// Meshes in parts that move step by step, beside hfr::Remesher over the whole.
#include "Distributed/Remesher.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "Distributed/Labelled.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/PartTransfer.hh"
#include "Distributed/RankArrays.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/Reorder.hh"

namespace hfr::test {
namespace {

using mpi::RankArrays;

/// Every rank gives the cells of a slab of it.
RankArrays slab_of(const TetMesh& mesh, const mpi::Comm& comm) {
  RankArrays arrays;
  std::vector<std::uint8_t> is_needed(mesh.n_vertices(), 0);
  for (CellHandle c : mesh.cells()) {
    if (c.idx() * comm.n_ranks() / mesh.n_cells() != static_cast<std::size_t>(comm.rank())) continue;
    auto& corners = arrays.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = mesh.cell(c).v[k].idx();
      is_needed[mesh.cell(c).v[k].idx()] = 1;
    }
    arrays.regions.push_back(mesh.region(c));
  }
  for (VertexHandle v : mesh.vertices()) {
    if (is_needed[v.idx()] == 0) continue;
    arrays.vertex_number.push_back(v.idx());
    arrays.points.push_back(mesh.point(v));
  }
  return arrays;
}

std::vector<std::array<Index, 4>> corners_of(const TetMesh& mesh) {
  std::vector<std::array<Index, 4>> cells;
  for (CellHandle c : mesh.cells()) {
    auto& corners = cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.cell(c).v[k].idx();
  }
  return cells;
}

/// Along a swirl about an axis of the unit cube, which leaves its surface where it is.
Vec3 swirl(Vec3 p, double dt) {
  constexpr double kPi = 3.141592653589793;
  const auto hump = [](double t) { return std::sin(kPi * t) * std::sin(kPi * t); };
  const double speed = dt * hump(p.z);
  return {speed * hump(p.x) * std::sin(2 * kPi * p.y), -speed * std::sin(2 * kPi * p.x) * hump(p.y), 0};
}

/// But for those of what is no number.
bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) ||
           (std::isnan(x) && std::isnan(y));
  });
}

/// One field of each kind, on a whole mesh and on its parts.
class Fields {
 public:
  static std::vector<FieldTransfer> all() {
    return {{.name = "t"},
            {.name = "u", .how = Transfer::kQuadratic},
            {.name = "velocity", .how = Transfer::kConserve, .density = "rho"},
            {.name = "rho", .how = Transfer::kConserve},
            {.name = "history", .how = Transfer::kInherit}};
  }

  /// Those that it has.
  static Fields of(TetMesh& whole) { return Fields(whole, 0); }
  explicit Fields(TetMesh& whole) : Fields(whole, 0) {
    for (VertexHandle v : whole.vertices()) {
      const Vec3 p = whole.point(v);
      t_[v] = std::sin(5 * p.x) + p.y * p.z;
      u_[v] = {p.x * p.x, std::cos(3 * p.y + p.x), generate::random_unit(1, v.idx())};
    }
    for (CellHandle c : whole.cells()) {
      rho_[c] = 1 + generate::random_unit(2, c.idx());
      history_[c] = c.idx() + 0.5;
      velocity_[c] = {generate::random_unit(3, c.idx()), -1, generate::random_unit(4, c.idx()) * 1e-3};
    }
  }
  /// Some values that are infinite, or no number.
  void add_what_is_no_number(const TetMesh& whole) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    t_[V(whole.n_vertices() / 2)] = std::numeric_limits<double>::quiet_NaN();
    u_[V(whole.n_vertices() / 3)].y = -kInfinite;
    velocity_[CellHandle(whole.n_cells() / 2)].z = kInfinite;
    history_[CellHandle(5)] = -0.0;
  }
  /// Of points of others the part is given what does not count.
  void give(mpi::Remesher& together, const RankArrays& mine, int rank) const {
    for (const FieldTransfer& field : all()) {
      std::vector<double> values = of_part(field.name, mine);
      const std::size_t width = width_of(field.name);
      for (std::size_t i = 0; is_of_vertices(field.how) && i < mine.points.size(); ++i)
        if (mine.owner[i] != rank) std::fill_n(values.data() + width * i, width, 1e9);
      together.set_field(field.name, values, width);
    }
  }
  void expect_same(const mpi::Remesher& together, const RankArrays& mine, int step) const {
    for (const FieldTransfer& field : all()) {
      const auto given = together.field(field.name);
      EXPECT_TRUE(same_bits(given, of_part(field.name, mine))) << field.name << ", step " << step;
    }
  }

  static std::size_t width_of(const std::string& name) { return name == "u" || name == "velocity" ? 3 : 1; }
  std::vector<double> of_part(const std::string& name, const RankArrays& mine) const {
    std::vector<double> values;
    const auto add = [&](Vec3 x) { values.insert(values.end(), {x.x, x.y, x.z}); };
    for (std::uint64_t v : mine.vertex_number) {
      if (name == "t") values.push_back(t_[V(v)]);
      if (name == "u") add(u_[V(v)]);
    }
    for (std::uint64_t number : mine.cell_number) {
      const CellHandle c(number);
      if (name == "rho") values.push_back(rho_[c]);
      if (name == "history") values.push_back(history_[c]);
      if (name == "velocity") add(velocity_[c]);
    }
    return values;
  }

 private:
  Fields(TetMesh& whole, int)
      : t_(whole.request_vertex_property<double>("t")),
        u_(whole.request_vertex_property<Vec3>("u")),
        rho_(whole.request_cell_property<double>("rho")),
        history_(whole.request_cell_property<double>("history")),
        velocity_(whole.request_cell_property<Vec3>("velocity")) {}

  VertexProperty<double> t_;
  VertexProperty<Vec3> u_;
  CellProperty<double> rho_, history_;
  CellProperty<Vec3> velocity_;
};

void expect_same_reports(const std::vector<FieldReport>& a, const std::vector<FieldReport>& b, int step) {
  ASSERT_EQ(a.size(), b.size()) << "step " << step;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].n_changed, b[i].n_changed) << a[i].name << ", step " << step;
    EXPECT_EQ(a[i].n_outside, b[i].n_outside) << a[i].name << ", step " << step;
    EXPECT_TRUE(same_bits(a[i].integral, b[i].integral)) << a[i].name << ", step " << step;
    EXPECT_TRUE(same_bits(a[i].lost, b[i].lost)) << a[i].name << ", step " << step;
  }
}

void expect_same_ids(const Remesher& alone, const mpi::Remesher& together, const RankArrays& mine, int step) {
  const auto vertices = together.vertex_ids(), cells = together.cell_ids();
  ASSERT_EQ(vertices.size(), mine.points.size()) << "step " << step;
  ASSERT_EQ(cells.size(), mine.cells.size()) << "step " << step;
  bool same = true;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    same = same && vertices[i] == alone.vertex_ids()[mine.vertex_number[i]];
  for (std::size_t i = 0; i < cells.size(); ++i)
    same = same && cells[i] == alone.cell_ids()[mine.cell_number[i]];
  EXPECT_TRUE(same) << "ids, step " << step;
}

/// What hfr::Remesher says on all ranks, each of which has the whole, and the parts, step by step: the same.
/// Returns how many steps have repaired.
template <class Displacement>
int expect_same_steps(const TetMesh& input, const RemesherOptions& options, int n_steps,
                      Displacement&& displacement, int* n_refused = nullptr, int* n_undone = nullptr,
                      const RemesherOptions* in_parts = nullptr, const std::function<void()>& between = {}) {
  mpi::Comm comm(MPI_COMM_WORLD);
  TetMesh whole = input;
  std::optional<Fields> fields;
  if (!options.fields.empty()) fields.emplace(whole);
  Remesher alone(whole, options);
  mpi::Remesher together(comm, slab_of(input, comm), in_parts ? *in_parts : options);
  RankArrays mine = together.arrays();
  const bool is_manifold = mpi::check(together.mesh()).is_good;
  if (fields) fields->give(together, mine, comm.rank());
  int n_repairs = 0;
  for (int step = 0; step < n_steps; ++step) {
    std::vector<Vec3> of_whole, of_mine;
    for (VertexHandle v : whole.vertices()) of_whole.push_back(displacement(step, whole.point(v)));
    for (const Vec3& p : mine.points) of_mine.push_back(displacement(step, p));
    for (std::size_t i = 0; i < of_mine.size(); ++i)
      if (mine.owner[i] != comm.rank()) of_mine[i] = {9, 9, 9};  // which does not count
    const StepResult a = alone.step(of_whole);
    if (between) between();
    const mpi::PartsStep b = together.step(of_mine);
    EXPECT_EQ(a.cause, b.cause) << "step " << step;
    EXPECT_EQ(a.changed, b.changed) << "step " << step;
    EXPECT_EQ(a.fraction, b.fraction) << "step " << step;
    EXPECT_EQ(a.min_dihedral, b.min_dihedral) << "step " << step;
    EXPECT_EQ(a.n_inverted, b.n_inverted) << "step " << step;
    EXPECT_EQ(a.refused.size(), b.refused.size()) << "step " << step;
    for (std::size_t i = 0; i < std::min(a.refused.size(), b.refused.size()); ++i)
      EXPECT_EQ(a.refused[i].idx(), b.refused[i]);
    EXPECT_EQ(a.repairs.size(), b.repairs.size()) << "step " << step;
    EXPECT_EQ(a.stop, b.stop) << "step " << step;
    EXPECT_EQ(a.undone, b.undone) << "step " << step;
    n_repairs += static_cast<int>(b.repairs.size());
    if (n_refused) *n_refused += b.refused.empty() ? 0 : 1;
    if (n_undone) *n_undone += b.undone ? 1 : 0;
    mine = together.arrays();
    EXPECT_EQ(comm.sum(mine.cells.size()), whole.n_cells());
    bool same = true;
    for (std::size_t i = 0; i < mine.points.size(); ++i)
      same = same && mine.points[i] == whole.point(V(mine.vertex_number[i]));
    for (std::size_t i = 0; i < mine.cells.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k)
        same = same && V(mine.cells[i][k]) == whole.cell(CellHandle(mine.cell_number[i])).v[k];
    EXPECT_TRUE(same) << "step " << step;
    if (options.ids) expect_same_ids(alone, together, mine, step);
    if (fields) {
      fields->expect_same(together, mine, step);
      for (std::size_t i = 0; i < std::min(a.repairs.size(), b.repairs.size()); ++i)
        expect_same_reports(a.repairs[i].fields, b.repairs[i].fields, step);
    }
    EXPECT_TRUE(!is_manifold || mpi::check(together.mesh()).is_good) << "step " << step;
  }
  return n_repairs;
}

RemesherOptions towards(double goal, double trigger) {
  RemesherOptions options;
  options.improve.min_dihedral = goal;
  options.improve.policy = {};
  options.triggers.min_dihedral = trigger;
  return options;
}

TEST(PartRemesher, StepsAreThoseOfSharedMemory) {
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 4 == 3 ? 0 : 0.03); };
  const int n = expect_same_steps(valid_box(8, 0.1, 1), towards(15, 12), 14, move);
  EXPECT_GT(n, 3);
  EXPECT_LT(n, 14);
}

/// All cells are worked on, and scattered ones get other numbers.
TEST(PartRemesher, RepairsWithoutAGoalAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 12);
  options.improve.min_dihedral.reset();
  options.triggers.every = 3;
  const auto move = [](int, Vec3 p) { return swirl(p, 0.02); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 2), options, 7, move), 2);
}

TEST(PartRemesher, MovesThatInvertAreRefusedOrMended) {
  RemesherOptions options = towards(15, 10);
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 2 == 0 ? 0.25 : 0.01); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 3), options, 4, move), 2);
  options.on_inversion = OnInversion::kRefuse;
  int n_refused = 0;
  expect_same_steps(valid_box(6, 0.1, 3), options, 4, move, &n_refused);
  EXPECT_GE(n_refused, 1);
  EXPECT_LT(n_refused, 4);
}

TEST(PartRemesher, RepairsByMetricsAndMotionAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 0);
  options.triggers.metrics = {{Metric::kVolumeLength, 0.35}, {Metric::kMaxDihedral, 155}};
  const auto move = [](int, Vec3 p) { return swirl(p, 0.02); };
  const int n = expect_same_steps(valid_box(6, 0.1, 2), options, 10, move);
  EXPECT_GE(n, 2);
  EXPECT_LT(n, 10);
  options.triggers.metrics.clear();
  options.triggers.motion = 0.2;
  const int m = expect_same_steps(valid_box(6, 0.1, 2), options, 8, move);
  EXPECT_GE(m, 2);
  EXPECT_LT(m, 8);
  options.on_inversion = OnInversion::kRefuse;  // a move that is refused leads nowhere
  int n_refused = 0;
  const auto wild = [](int step, Vec3 p) { return swirl(p, step % 2 == 0 ? 0.4 : 0.02); };
  expect_same_steps(valid_box(6, 0.1, 2), options, 8, wild, &n_refused);
  EXPECT_GE(n_refused, 1);
}

/// A box that is squeezed and let go again: cells have the volume at rest of when they were made.
TEST(PartRemesher, RepairsByVolumeAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 0);
  options.triggers.jacobian_ratio = 0.5;
  const auto move = [](int step, Vec3 p) {
    const auto inside = [](double t) { return t * (1 - t); };  // the surface stays
    return (step % 3 == 2 ? -1.0 : 5.0) * inside(p.x) * inside(p.y) * Vec3{0, 0, -inside(p.z)} +
           swirl(p, 0.01);
  };
  const int n = expect_same_steps(valid_box(6, 0.1, 2), options, 12, move);
  EXPECT_GE(n, 3);
  EXPECT_LT(n, 12);
  options.improve.min_dihedral.reset();  // over all cells
  options.ids = true;
  EXPECT_GE(expect_same_steps(valid_box(5, 0.1, 2), options, 8, move), 2);
}

/// Made while the box is twice as wide: once it is as before, they have less volume than then, and others as
/// much as ever.
TEST(PartRemesher, CellsThatARepairHasMadeHaveTheirOwnVolumesAtRest) {
  RemesherOptions options = towards(36, 0);
  options.triggers.jacobian_ratio = 0.2;
  options.triggers.every = 1;  // which is no cause where there is another
  const auto move = [](int step, Vec3 p) { return (step == 0 ? 1.0 : -0.5) * p; };
  EXPECT_EQ(expect_same_steps(valid_box(6, 0.1, 2), options, 2, move), 2);
}

TEST(PartRemesher, IdsAreThoseOfSharedMemory) {
  RemesherOptions options = towards(20, 17);
  options.ids = true;
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 4 == 3 ? 0 : 0.03); };
  EXPECT_GE(expect_same_steps(valid_box(8, 0.1, 1), options, 12, move), 3);
  options.fields = Fields::all();
  options.on_inversion = OnInversion::kSubsteps;
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 3), options, 2, [](int, Vec3 p) { return swirl(p, 0.5); }),
            4);
}

/// Cut short at once: what was moved stays, unless cells are inverted by then; nothing is excused.
TEST(PartRemesher, StepsThatAreCutShortAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 12);
  options.ids = true;
  options.fields = Fields::all();
  options.triggers.motion = 3;
  options.improve.surface.fixed_vertices = {V(3), V(150)};
  int step = 0, n_undone = 0;
  const auto stops = [&] { return step % 3 == 2; };
  options.improve.cancel = stops;
  const auto move = [&](int i, Vec3 p) {
    step = i;
    return swirl(p, i == 5 ? 0.25 : i % 3 == 0 && i > 0 ? 0 : 0.04);  // at rest after each cut
  };
  for (const bool by_substeps : {false, true}) {
    options.on_inversion = by_substeps ? OnInversion::kSubsteps : OnInversion::kRepair;
    EXPECT_GT(expect_same_steps(valid_box(6, 0.1, 3), options, 12, move, nullptr, &n_undone), 2);
  }
  EXPECT_GE(n_undone, 1);
  options.improve.cancel = {};
  options.improve.time_limit = 1e-9;
  options.on_inversion = OnInversion::kRepair;
  n_undone = 0;
  const auto fold = [&](int i, Vec3 p) { return swirl(p, i == 1 ? 0.5 : 0.04); };
  expect_same_steps(valid_box(6, 0.1, 3), options, 2, fold, nullptr, &n_undone);
  EXPECT_EQ(n_undone, 1);
}

/// At many of the questions that a run of shared memory and of the parts asks; one rank cancels, and the
/// others have not been told how.
TEST(PartRemesher, StepsThatAreCutShortAnywhereAreThoseOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const bool by_substeps : {false, true}) {
    RemesherOptions options = towards(15, 12);
    options.ids = true;
    options.triggers.jacobian_ratio = 0.2;
    options.improve.surface.fixed_vertices = {V(170), V(229), V(278), V(285)};
    if (by_substeps) options.on_inversion = OnInversion::kSubsteps;
    options.max_substeps = 1;
    int step = 0, n_asked = 0, n_undone = 0;
    const auto move = [&](int i, Vec3 p) {
      if (step != i) n_asked = 0;
      step = i;
      return swirl(p, i == 0 ? 0.05 : i > 1 ? 0.15 : by_substeps ? 3.0 : 1.0);
    };
    for (int at = 1; at < 70; at += 3) {
      SCOPED_TRACE(at);
      const auto cancel = [&] {
        if (step != 1) return false;
        ++n_asked;
        return n_asked >= at;
      };
      options.improve.cancel = cancel;
      RemesherOptions in_parts = options;
      if (comm.rank() != comm.size() - 1) in_parts.improve.cancel = nullptr;
      step = n_asked = 0;
      // Questions are counted anew between the step of the whole and that of the parts.
      expect_same_steps(valid_box(6, 0.1, 3), options, 4, move, nullptr, &n_undone, &in_parts,
                        [&] { n_asked = 0; });
      if (comm.sum(HasFailure() ? 1 : 0) > 0) return;
    }
    EXPECT_GE(n_undone, 2);
  }
}

/// Whatever is inverted: no rank turns it, as if it had been written the other way round.
TEST(PartRemesher, BodyThatIsTurnedInsideOutStaysSo) {
  const TetMesh box = valid_box(5, 0.1, 3);
  std::vector<Vec3> points(box.points().begin(), box.points().end());
  std::vector<std::array<Index, 4>> cells = corners_of(box);
  const auto n = static_cast<Index>(points.size());
  for (const Vec3 p : {Vec3{2, 0, 0}, Vec3{3, 0, 0}, Vec3{2, 1, 0}, Vec3{2, 0, 1}}) points.push_back(p);
  cells.push_back({n, n + 1, n + 2, n + 3});
  const auto move = [](int step, Vec3 p) {
    if (p.x > 1.5) return step == 1 && p.z > 0.5 ? Vec3{0, 0, -1.5} : Vec3{};
    return swirl(p, 0.06);
  };
  EXPECT_GE(expect_same_steps(build(points, cells), towards(15, 12), 4, move), 2);
  // Nor is a step undone because of what was inverted before it.
  RemesherOptions options = towards(15, 12);
  options.ids = true;
  int step = 0, n_undone = 0;
  options.improve.cancel = [&] { return step == 2; };
  const auto note_step = [&](int i, Vec3 p) {
    step = i;
    return move(i, p);
  };
  EXPECT_GE(expect_same_steps(build(points, cells), options, 4, note_step, nullptr, &n_undone), 2);
  EXPECT_EQ(n_undone, 0);
}

/// What has been travelled, and how many steps ago there was a repair, is as before a step that is undone.
TEST(PartRemesher, StepsAfterOneThatIsUndoneAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 5);
  int step = 0;
  options.improve.cancel = [&] { return step == 3; };
  const auto move = [&](int i, Vec3 p) {
    step = i;
    return swirl(p, i == 3 ? 0.3 : 0.01);
  };
  for (const bool by_motion : {true, false}) {
    options.triggers.motion = by_motion ? 0.4 : 0;
    options.triggers.every = by_motion ? 0 : 5;
    int n_undone = 0;
    const int n = expect_same_steps(valid_box(6, 0.1, 3), options, 12, move, nullptr, &n_undone);
    EXPECT_EQ(n_undone, 1);
    EXPECT_GE(n, 1);
    EXPECT_LT(n, 8);
  }
}

/// A step that is cut short, sooner or later, either leaves no more inverted cells than there were, or
/// everything as it was, and the next step is the one of a Remesher that has never begun it.
TEST(PartRemesher, StepThatIsUndoneLeavesNoTrace) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const TetMesh mesh = valid_box(6, 0.1, 3);
  RemesherOptions options = towards(15, 12);
  options.ids = true;
  options.fields = Fields::all();
  options.on_inversion = OnInversion::kSubsteps;
  options.max_substeps = 3;
  options.triggers.jacobian_ratio = 0.2;
  options.improve.surface.fixed_vertices = {V(40), V(170), V(300)};
  int asked = 0, last = std::numeric_limits<int>::max();
  options.improve.cancel = [&] { return comm.rank() == comm.size() - 1 && ++asked > last; };
  TetMesh whole = mesh;
  const Fields values(whole);
  const auto begin = [&] {
    auto remesher = std::make_unique<mpi::Remesher>(comm, slab_of(mesh, comm), options);
    values.give(*remesher, remesher->arrays(), comm.rank());
    return remesher;
  };
  const auto step = [&](mpi::Remesher& remesher, double far) {
    std::vector<Vec3> displacement;
    for (const Vec3& p : remesher.arrays().points) displacement.push_back(swirl(p, far));
    asked = 0;
    return remesher.step(displacement);
  };
  const auto expect_same = [&](mpi::Remesher& a, mpi::Remesher& b, int n) {
    const RankArrays x = a.arrays(), y = b.arrays();
    EXPECT_TRUE(x.points == y.points && x.cells == y.cells && x.owner == y.owner) << n;
    EXPECT_TRUE(x.vertex_number == y.vertex_number && x.cell_number == y.cell_number) << n;
    for (const FieldTransfer& field : options.fields)
      EXPECT_TRUE(same_bits(a.field(field.name), b.field(field.name))) << field.name << ", " << n;
  };
  int n_undone = 0, n_cut = 0;
  const auto never = begin();
  step(*never, 0.04);
  EXPECT_TRUE(mpi::check(never->mesh()).is_good);
  for (int n = 28; n < 56; n += 3) {
    const auto remesher = begin();
    last = std::numeric_limits<int>::max();
    step(*remesher, 0.04);
    const std::vector<std::uint64_t> ids(remesher->cell_ids().begin(), remesher->cell_ids().end());
    const std::vector<std::uint64_t> of_vertices(remesher->vertex_ids().begin(),
                                                 remesher->vertex_ids().end());
    last = n;
    const mpi::PartsStep cut = step(*remesher, 2.5);
    last = std::numeric_limits<int>::max();
    n_cut += cut.stop == Stop::kCancelled ? 1 : 0;
    EXPECT_TRUE(cut.n_inverted == 0 || cut.stop != Stop::kCancelled) << n;
    EXPECT_TRUE(mpi::check(remesher->mesh()).is_good) << n;
    if (!cut.undone) continue;
    ++n_undone;
    EXPECT_EQ(cut.repairs.size(), 0U);
    expect_same(*remesher, *never, n);
    EXPECT_TRUE(std::ranges::equal(remesher->cell_ids(), ids));
    EXPECT_TRUE(std::ranges::equal(remesher->vertex_ids(), of_vertices));
    const auto other = begin();
    step(*other, 0.04);
    for (int i = 0; i < 3; ++i) {
      const mpi::PartsStep a = step(*remesher, 0.1), b = step(*other, 0.1);
      EXPECT_EQ(a.cause, b.cause);
      EXPECT_EQ(a.min_dihedral, b.min_dihedral);
      expect_same(*remesher, *other, n);
    }
  }
  EXPECT_GE(n_cut, 3);
  EXPECT_GE(n_undone, 1);
}

/// By numbers, which change with repairs.
TEST(PartRemesher, WhatIsFixedStaysSo) {
  const TetMesh mesh = valid_box(6, 0.1, 5);
  RemesherOptions options = towards(18, 15);
  const auto corners = [&](std::size_t c) { return mesh.cell(CellHandle(c)).v; };
  options.improve.surface.fixed_vertices = {V(40), V(170), V(300)};
  options.improve.surface.fixed_edges = {{corners(400)[0], corners(400)[2]},
                                         {corners(900)[1], corners(900)[3]}};
  options.improve.surface.fixed_faces = {{corners(700)[0], corners(700)[1], corners(700)[2]}};
  const auto move = [](int, Vec3 p) { return swirl(p, 0.03); };
  EXPECT_GE(expect_same_steps(mesh, options, 16, move), 4);
  options.fields = Fields::all();
  options.on_inversion = OnInversion::kSubsteps;
  const auto far = [](int, Vec3 p) { return swirl(p, 0.3); };
  EXPECT_GE(expect_same_steps(mesh, options, 2, far), 2);
}

/// A move is taken in parts, with repairs between them over which what is left of it has to get.
TEST(PartRemesher, SubstepsAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 10);
  options.on_inversion = OnInversion::kSubsteps;
  const auto move = [](int, Vec3 p) { return swirl(p, 0.8); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 3), options, 2, move), 6);
  options.fields = Fields::all();
  options.max_substeps = 2;  // then the rest as a whole
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 4), options, 2, move), 5);
  // A few vertices, of which hfr::Remesher looks at the cells alone; what they travel, and what is fixed.
  const auto few = [](int, Vec3 p) {
    const double r = norm(p - Vec3{0.5, 0.5, 0.5});
    return r < 0.25 ? Vec3{0.3, 0.1, 0} : Vec3{};
  };
  options.max_substeps = 16;
  options.triggers.motion = 0.5;
  options.improve.surface.fixed_vertices = {V(3), V(150)};
  EXPECT_GE(expect_same_steps(valid_box(7, 0.1, 3), options, 3, few), 4);
  // Nothing can be taken, and nothing be mended.
  const TetMesh one =
      build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
  const auto through = [](int, Vec3 p) { return p.z > 0.5 ? Vec3{0, 0, -1.5} : Vec3{}; };
  EXPECT_GE(expect_same_steps(one, towards(15, 10), 2, through), 1);
  RemesherOptions in_parts = towards(15, 10);
  in_parts.on_inversion = OnInversion::kSubsteps;
  EXPECT_GE(expect_same_steps(one, in_parts, 2, through), 1);
}

#ifdef HFR_HAS_SURFACE
/// A body that is sheared, whose surface gives way.
TEST(PartRemesher, RepairsOfASurfaceThatMayChangeAreThoseOfSharedMemory) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    RemesherOptions options = towards(20, 17);
    options.improve.surface.mode = mode;
    const auto move = [](int step, Vec3 p) {
      return Vec3{0.3 * p.z * p.z + 0.02 * step * p.y, 0, 0.05 * p.x};
    };
    EXPECT_GE(expect_same_steps(valid_box(5, 0.15, 4), options, 3, move), 2);
  }
}
#endif

/// A wedge of the surface that nothing mends calls for one repair, and for another one once it is worse.
TEST(PartRemesher, WhatARepairHadToLeaveCallsForNoOther) {
  TetMesh mesh = valid_box(5, 0.1, 4);
  const auto flatten = [](int step, Vec3 p) {  // the whole box, but once
    return Vec3{0, 0, step == 0 ? -0.85 * p.z : step == 3 ? -0.5 * p.z : 0.0};
  };
  RemesherOptions options = towards(25, 20);
  options.improve.max_cells = mesh.n_cells();
  const int n = expect_same_steps(mesh, options, 5, flatten);
  EXPECT_GE(n, 2);
  EXPECT_LE(n, 3);
  options.triggers.min_dihedral = 0;
  options.triggers.metrics = {{Metric::kVolumeLength, 0.5}};
  const int m = expect_same_steps(mesh, options, 5, flatten);
  EXPECT_GE(m, 1);
  EXPECT_LE(m, 3);
  // Also after a step that was undone.
  int step = 0, n_undone = 0;
  options.improve.cancel = [&] { return step == 2; };
  const auto flatten_and_fold = [&](int i, Vec3 p) {
    step = i;
    if (i == 3) return Vec3{};
    return i == 2 ? Vec3{p.x > 0.3 && p.x < 0.5 ? 0.4 : 0.0, 0, 0} : flatten(i, p);
  };
  expect_same_steps(mesh, options, 4, flatten_and_fold, nullptr, &n_undone);
  EXPECT_EQ(n_undone, 1);
}

TEST(PartRemesher, RegionsStay) {
  const generate::Arrays box = generate::two_region_box({6, 6, 6});
  TetMesh mesh = build(box.points, box.cells);
  for (std::size_t c = 0; c < box.regions.size(); ++c) mesh.set_region(CellHandle(c), box.regions[c]);
  const auto move = [](int, Vec3 p) { return swirl(p, 0.03); };
  EXPECT_GE(expect_same_steps(mesh, towards(15, 12), 8, move), 1);
}

/// Also in their order, which no rank knows alone: the files are the same after repairs.
TEST(PartRemesher, LabelsStayInTheirOrder) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, labelled(valid_box(6, 0.1, 5), 5, {2, 60, 60, 15, 40, 0, true}));
  comm.sum(0);
  mpi::DistributedMesh first(comm);
  mpi::read_ranges(first, path);
  mpi::Remesher together(comm, mpi::own_arrays(first), towards(15, 12));
  together.mesh().part().labels().names = first.part().labels().names;
  TetMesh whole = io::read(path);
  Remesher alone(whole, towards(15, 12));
  int n_changed = 0;
  for (int step = 0; step < 10; ++step) {
    std::vector<Vec3> of_whole, of_mine;
    for (VertexHandle v : whole.vertices()) of_whole.push_back(swirl(whole.point(v), 0.03));
    for (const Vec3& p : together.arrays().points) of_mine.push_back(swirl(p, 0.03));
    alone.step(of_whole);
    n_changed += together.step(of_mine).changed ? 1 : 0;
  }
  EXPECT_GE(n_changed, 2);
  mpi::write_vtu(together.mesh(), folder.path() / "parts.vtu");
  if (comm.rank() != 0) return;
  io::write(folder.path() / "whole.vtu", whole);
  EXPECT_TRUE(bytes_of(folder.path() / "parts.vtu") == bytes_of(folder.path() / "whole.vtu"));
}

/// Of every kind, over repairs of a few cells and of all.
TEST(PartRemesher, FieldsAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 12);
  options.fields = Fields::all();
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 4 == 3 ? 0 : 0.03); };
  EXPECT_GT(expect_same_steps(valid_box(8, 0.1, 1), options, 12, move), 3);
  options.improve.min_dihedral.reset();
  options.triggers.every = 2;
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 2), options, 4, move), 2);
}

/// A run over everything numbers cells anew that are scattered in memory.
TEST(PartRemesher, FieldsAndIdsOfScatteredCellsAreThoseOfSharedMemory) {
  const TetMesh box = valid_box(17, 0.1, 2);
  std::vector<std::array<Index, 4>> cells = corners_of(box);
  std::mt19937_64 engine(1);
  for (std::size_t i = 1; i < cells.size(); ++i) std::swap(cells[i], cells[engine() % (i + 1)]);
  const TetMesh mesh = build({box.points().begin(), box.points().end()}, cells);
  ASSERT_TRUE(is_scattered(mesh));
  RemesherOptions options = towards(15, 12);
  options.improve.min_dihedral.reset();
  options.improve.iterations = 1;
  options.triggers.every = 1;
  options.triggers.jacobian_ratio = 0.5;
  options.ids = true;
  options.fields = Fields::all();
  EXPECT_EQ(expect_same_steps(mesh, options, 2, [](int, Vec3 p) { return swirl(p, 0.02); }), 2);
}

/// More ranks than the mesh has work for, and two bodies that share a vertex.
TEST(PartRemesher, FieldsOfSmallAndOfPinchedMeshesAreThoseOfSharedMemory) {
  RemesherOptions options = towards(20, 17);
  options.triggers.every = 1;
  options.fields = Fields::all();
  const auto move = [](int, Vec3 p) { return Vec3{0.1 * p.z * p.y, 0.05 * p.x * p.x, 0}; };
  for (const Index n : {1, 2}) expect_same_steps(valid_box(n, 0.1, 4), options, 2, move);
  const TetMesh box = valid_box(4, 0.2, 5);
  std::vector<Vec3> points(box.points().begin(), box.points().end());
  std::vector<std::array<Index, 4>> cells = corners_of(box);
  const auto n = static_cast<Index>(points.size());
  Index first = 0;
  for (Index v = 0; v < n; ++v)
    if (norm(points[v]) < norm(points[first])) first = v;
  for (Index v = 0; v < n; ++v) points.push_back(2 * points[first] - points[v]);
  for (std::size_t c = 0; c < box.n_cells(); ++c) {
    auto corners = cells[c];
    for (Index& v : corners) v = v == first ? v : v + n;
    std::swap(corners[2], corners[3]);
    cells.push_back(corners);
  }
  points[n + first] = {9, 9, 9};
  points.erase(points.begin() + n + first);
  for (auto& corners : cells)
    for (Index& v : corners) v -= v > n + first ? 1 : 0;
  expect_same_steps(build(points, cells), options, 3, move);
}

/// Cells overlap in the mesh as it was.
TEST(PartRemesher, FieldsOverInvertedCellsAreThoseOfSharedMemory) {
  RemesherOptions options = towards(15, 10);
  options.fields = Fields::all();
  const auto move = [](int step, Vec3 p) { return swirl(p, step % 2 == 0 ? 0.25 : 0.01); };
  EXPECT_GE(expect_same_steps(valid_box(6, 0.1, 3), options, 4, move), 2);
}

#ifdef HFR_HAS_SURFACE
/// New cells lie beyond the mesh as it was, in part and as a whole.
TEST(PartRemesher, FieldsWhereTheSurfaceChangesAreThoseOfSharedMemory) {
  RemesherOptions options = towards(20, 17);
  options.improve.surface.mode = SurfaceMode::kFree;
  options.fields = Fields::all();
  const auto move = [](int step, Vec3 p) { return Vec3{0.3 * p.z * p.z + 0.02 * step * p.y, 0, 0.05 * p.x}; };
  EXPECT_GE(expect_same_steps(valid_box(5, 0.15, 4), options, 3, move), 2);
}
#endif

/// Moves that are as wild as they come: also far beyond what a rank has of others.
TEST(PartRemesher, FieldsOfRandomMovesAreThoseOfSharedMemory) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto random = [&](std::uint64_t i) { return generate::random_unit(seed, i); };
    RemesherOptions options = towards(10 + 5 * std::abs(random(1)), 8);
    if (random(2) > 0.3) options.improve.min_dihedral.reset();
#ifdef HFR_HAS_SURFACE
    if (random(3) > 0.3)
      options.improve.surface.mode = random(3) > 0.6 ? SurfaceMode::kFree : SurfaceMode::kFlat;
#endif
    options.triggers.every = 1;
    options.triggers.jacobian_ratio = 0.5;
    options.ids = true;
    options.fields = Fields::all();
    const double far = std::pow(10, -2 + 1.5 * random(4));
    const auto move = [&](int step, Vec3 p) {
      const auto bits = [&](double x) { return static_cast<std::uint64_t>(std::llround(1e6 * x)); };
      const std::uint64_t at = bits(p.x) + 1'000'003 * bits(p.y) + 998'244'353 * bits(p.z);
      if (random(at + static_cast<std::uint64_t>(step)) < 0.4) return swirl(p, 0.5 * far);
      const auto inside = [](double t) { return t * (1 - t); };  // the surface stays
      return (4 * far * inside(p.x) * inside(p.y) * inside(p.z)) *
             Vec3{random(at + 1), random(at + 2), random(at + 3)};
    };
    expect_same_steps(valid_box(static_cast<Index>(4 + seed % 4), 0.12, seed), options, 3, move);
    if (HasFailure()) {
      ADD_FAILURE() << "seed " << seed;
      return;
    }
  }
}

/// What transfer_fields() and transfer_in_parts() make of a mesh of which vertices are moved and one cell may
/// be taken away.
template <class Moved>
void expect_same_transfer(Moved&& moved, CellHandle gone = {}) {
  mpi::Comm comm(MPI_COMM_WORLD);
  TetMesh whole = valid_box(6, 0.1, 7);
  Fields fields(whole);
  fields.add_what_is_no_number(whole);
  mpi::DistributedMesh parts(comm);
  mpi::from_arrays(parts, slab_of(whole, comm));
  const auto old_parts = parts.copy();
  const auto old = std::make_shared<const TetMesh>(whole);
  for (VertexHandle v : whole.vertices()) whole.set_point(v, moved(v.idx(), whole.point(v)));
  for (std::size_t i = 0; i < parts.part().n_vertices(); ++i)
    parts.part().set_point(V(i), moved(parts.number(V(i)), parts.part().point(V(i))));
  MeshMaps maps;
  for (VertexHandle v : whole.vertices()) maps.vertices.push_back(v);
  for (CellHandle c : whole.cells()) maps.cells.push_back(c);
  maps.old_vertices = maps.sources = maps.vertices;
  if (gone.is_valid()) {
    whole.delete_cell(gone);
    const GarbageMap garbage = whole.collect_garbage();
    ASSERT_EQ(whole.n_vertices(), old->n_vertices());
    maps.cells = garbage.cells;
    if (const CellHandle c = parts.cell_at(gone.idx()); c.is_valid()) parts.detach(c);
    parts.free_slots().push_back(gone.idx());
  }
  maps.old_cells.assign(whole.n_cells(), {});
  for (std::size_t i = 0; i < maps.cells.size(); ++i)
    if (maps.cells[i].is_valid()) maps.old_cells[maps.cells[i].idx()] = CellHandle(i);
  const std::vector<FieldTransfer> how = Fields::all();
  const Edits edits = make_edits(old, whole, maps, {});
  const std::vector<FieldReport> reports = transfer_fields(*old, whole, edits, how, {});

  const auto own_of = [&](const RankArrays& mine) {  // without points of others
    RankArrays own = mine;
    own.vertex_number.clear();
    for (std::size_t i = 0; i < mine.points.size(); ++i)
      if (mine.owner[i] == comm.rank()) own.vertex_number.push_back(mine.vertex_number[i]);
    return own;
  };
  RankArrays before, after = own_of(mpi::own_arrays(parts));
  before.vertex_number = after.vertex_number;
  for (CellHandle c : mpi::own_cells(*old_parts)) before.cell_number.push_back(old_parts->number(c));
  TetMesh as_it_was = *old;
  const Fields given = Fields::of(as_it_was);
  std::vector<mpi::PartField> in_parts;
  for (const FieldTransfer& field : how)
    in_parts.push_back({field, Fields::width_of(field.name), given.of_part(field.name, before)});
  const auto found = mpi::transfer_in_parts(*old_parts, parts, {}, in_parts, {});
  for (const mpi::PartField& field : in_parts)
    EXPECT_TRUE(same_bits(field.values, fields.of_part(field.how.name, after))) << field.how.name;
  expect_same_reports(reports, found, 0);
}

/// To the other side of the mesh, so that searches cross the parts of all ranks, and new cells cover old ones
/// of any.
TEST(PartTransfer, VerticesThatGoFarHaveTheValuesOfSharedMemory) {
  expect_same_transfer([&](std::uint64_t number, Vec3 p) {
    const auto goes = [](double t) { return t > 0.2 && t < 0.8; };
    if (!goes(p.x) || !goes(p.y) || !goes(p.z)) return p;
    return number % 3 == 0 ? Vec3{1 - p.x, 1 - p.y, p.z} : number % 3 == 1 ? p + Vec3{0.02, -0.03, 0.01} : p;
  });
}

/// Cells of which nothing was in the mesh before, some beside ones of other ranks.
TEST(PartTransfer, CellsBeyondTheMeshHaveTheValuesOfSharedMemory) {
  expect_same_transfer([](std::uint64_t, Vec3 p) { return p.z > 0.4 ? p + Vec3{0, 0.1 * p.x, 2} : p; });
}

/// What it held is lost, and said to be.
TEST(PartTransfer, CellThatGoesAloneIsReportedAsInSharedMemory) {
  expect_same_transfer([](std::uint64_t, Vec3 p) { return p; }, CellHandle(2));
  expect_same_transfer([](std::uint64_t, Vec3 p) { return p; }, CellHandle(6 * 6 * 6 * 6 - 3));
}

TEST(PartRemesher, FieldsThatAreNotThereAreRefused) {
  mpi::Comm comm(MPI_COMM_WORLD);
  RemesherOptions options = towards(15, 10);
  options.fields = {{.name = "rho", .how = Transfer::kConserve}};
  mpi::Remesher remesher(comm, slab_of(valid_box(4, 0.1, 1), comm), options);
  const auto refusal = [](auto&& act) {
    try {
      act();
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::size_t n = remesher.arrays().cells.size();
  const std::vector<Vec3> rest(remesher.arrays().points.size());
  EXPECT_THAT(refusal([&] { remesher.step(rest); }), testing::HasSubstr("'rho' has no values yet"));
  EXPECT_THAT(refusal([&] { remesher.field("u"); }), testing::HasSubstr("'u' is not named"));
  EXPECT_THAT(refusal([&] { remesher.set_field("rho", std::vector<double>(n + 1)); }),
              testing::HasSubstr("cells of this rank"));
  remesher.set_field("rho", std::vector<double>(2 * n), 2);
  EXPECT_EQ(refusal([&] { remesher.step(rest); }), "");
  options.fields.push_back({.name = "rho"});
  EXPECT_THAT(refusal([&] { mpi::Remesher(comm, slab_of(valid_box(4, 0.1, 1), comm), options); }),
              testing::HasSubstr("'rho' is named twice"));
  if (comm.size() == 1) return;
  const std::size_t components = comm.rank() == 0 ? 1 : 2;
  EXPECT_THAT(refusal([&] { remesher.set_field("rho", std::vector<double>(components * n), components); }),
              testing::HasSubstr("another number of them elsewhere"));
}

TEST(PartRemesher, WhatIsNotThereIsRefusedByName) {
  mpi::Comm comm(MPI_COMM_WORLD);
  RankArrays arrays = slab_of(valid_box(4, 0.1, 1), comm);
  const auto refusal = [&](auto&& change) {
    RemesherOptions options = towards(15, 10);
    change(options);
    try {
      mpi::Remesher remesher(comm, arrays, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal([](RemesherOptions&) {}), "");
  const RankArrays arrays_as_they_are = arrays;
  for (Vec3& p : arrays.points) p = 1e31 * p;
  EXPECT_THAT(refusal([](RemesherOptions&) {}), testing::HasSubstr("beyond 1e30"));
  arrays = arrays_as_they_are;
  EXPECT_EQ(refusal([](RemesherOptions& o) { o.motion = Motion::kElastic; }),
            "a Remesher in parts does not have vertices that follow others yet");
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.motion = Motion::kLaplace; }), testing::HasSubstr("follow"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.fields = {{.name = "u", .how = Transfer::kCallback}}; }),
              testing::HasSubstr("fields by callback"));

  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.indicator_field = "bad"; }),
              testing::HasSubstr("indicator"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.maps = true; }), testing::HasSubstr("maps"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.improve.surface.fixed_vertices = {V(9999)}; }),
              testing::HasSubstr("fix vertex:9999"));
  EXPECT_THAT(refusal([](RemesherOptions& o) {
                o.improve.surface.fixed_edges = {{V(0), V(99)}};
              }),
              testing::HasSubstr("fix edge:0-99"));
  EXPECT_THAT(refusal([](RemesherOptions& o) { o.triggers.min_dihedral = 20; }),
              testing::HasSubstr("must not be above the goal"));
}

TEST(PartRemesher, WrongDisplacementsAreRefusedOnAllRanks) {
  mpi::Comm comm(MPI_COMM_WORLD);
  for (const bool too_many : {true, false}) {
    const std::string line = [&]() -> std::string {
      mpi::Comm own(MPI_COMM_WORLD);
      mpi::Remesher remesher(own, slab_of(valid_box(4, 0.1, 1), own), towards(15, 10));
      std::vector<Vec3> displacement(remesher.arrays().points.size());
      if (own.rank() == own.size() - 1 && too_many) displacement.emplace_back();
      if (own.rank() == own.size() - 1 && !too_many)
        displacement[2].y = std::numeric_limits<double>::infinity();
      try {
        remesher.step(displacement);
      } catch (const mpi::RankFailed& failed) {
        return failed.what();
      } catch (const InvalidInput& error) {
        return own.fail(2, error.what()).what();
      }
      return "it was taken";
    }();
    EXPECT_THAT(line, testing::HasSubstr(too_many ? "displacement: has " : "is not finite"));
  }
}

}  // namespace
}  // namespace hfr::test
