// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_OPERATOR_HH
#define HFR_OPERATORS_OPERATOR_HH

#include <algorithm>
#include <concepts>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Cavity.hh"

namespace hfr {

/// First members of every plan: what ranking and slot assignment need.
struct PlanBase {
  double old_worst = 0;         ///< smallest decision value among the cells of the cluster as it is
  double new_worst = 0;         ///< and as it would be; always > old_worst
  std::uint32_t n_removed = 0;  ///< cells that go
  std::uint32_t n_created = 0;  ///< cells that come; both 0 when a vertex only moves
  bool removes_vertex = false;
  bool adds_vertex = false;
  /// Where the cluster lies in two regions: of n_removed and n_created, those of the first, which come first
  /// in the scope and among the created.
  std::uint16_t n_removed_first = 0;
  std::uint16_t n_created_first = 0;
};

/// What the scheduler needs of a local operator.
///  - scope: every cell that the operator may write for this seed.
///  - evaluate: pure; nothing when the cluster would not get better. Reads cells of the scope, points, and
///  what
///    the operator itself was given. No allocation.
///  - cavity: says in full what the plan does; cannot fail. Its removed cells are the scope, in the scope's
///  order.
///    The writing is the scheduler's, because the mates of a cavity's outer faces depend on the other
///    cavities of the same round.
///  - identity: vertices that name the seed whatever the storage order, for priorities among equals.
///  - metric: gives the decision value of a cell. Rounds write the qualities of the cells that they make with
///    it, so an operator that measures nothing holds the metric that the workspace's qualities are in.
/// A seed may lie on the boundary: what has no mate has none afterwards. A cavity has one new vertex at most.
template <class Op>
concept LocalOperator = std::derived_from<typename Op::Plan, PlanBase> &&
    std::is_trivially_copyable_v<typename Op::Plan> &&
    requires(const Op op, const TetMesh& mesh, typename Op::Seed seed, const typename Op::Plan& plan,
             Scope& scope, Cavity& cavity) {
  { op.scope(mesh, seed, scope) } -> std::same_as<void>;
  { op.evaluate(mesh, seed) } -> std::same_as<std::optional<typename Op::Plan>>;
  { op.cavity(mesh, plan, cavity) } -> std::same_as<void>;
  { op.identity(mesh, seed) } -> std::same_as<Tet>;
  { plan.seed } -> std::convertible_to<typename Op::Seed>;
  op.metric;
};

/// An operator whose evaluation is dear, and falls into steps of parts that read the mesh and write nothing
/// but a place of their own: where few seeds wait, the parts of a step run at the same time.
///  - Parts: what has been found out about one seed; made of the seed.
///  - n_parts: parts of the step; 0: the evaluation has ended, and any step after it has none either. May put
///    in order what the step before found.
///  - evaluate_part: one of them.
///  - plan: what comes of all; evaluate() is to give the same (see evaluate_in_turn()).
template <class Op>
concept EvaluatesInParts = LocalOperator<Op> &&
    std::constructible_from<typename Op::Parts, typename Op::Seed> &&
    requires(const Op op, const TetMesh& mesh, typename Op::Parts& parts, int step, std::size_t part) {
  { op.n_parts(parts, step) } -> std::same_as<std::size_t>;
  { op.evaluate_part(mesh, parts, step, part) } -> std::same_as<void>;
  { op.plan(mesh, parts) } -> std::same_as<std::optional<typename Op::Plan>>;
};

/// The parts of one seed, one after the other.
template <class Op>
std::optional<typename Op::Plan> evaluate_in_turn(const Op& op, const TetMesh& mesh,
                                                  const typename Op::Seed& seed) {
  typename Op::Parts parts(seed);
  for (int step = 0;; ++step) {
    const std::size_t n = op.n_parts(parts, step);
    if (n == 0) return op.plan(mesh, parts);
    for (std::size_t i = 0; i < n; ++i) op.evaluate_part(mesh, parts, step, i);
  }
}

/// What a plan says of its cavity and the cavity does not hold; empty where they agree. Rounds hand out slots
/// by the plan and write by the cavity, so builds with assertions stop where the two differ. `scope` is that
/// of the plan's seed.
std::string_view disagreement(const PlanBase& plan, const Cavity& cavity, std::span<const CellHandle> scope);

/// What identity() of an operator on an edge gives: its ends in ascending order, then two invalid handles.
inline Tet edge_identity(const TetMesh& mesh, EdgeHandle edge) {
  const auto [a, b] = mesh.edge_vertices(edge);
  return {std::min(a, b), std::max(a, b), VertexHandle(), VertexHandle()};
}

/// About how long a seed takes to evaluate, so that few dear ones are shared among threads as well as many
/// cheap ones. Operators whose seeds take much longer than the default say so in kSeedNanoseconds.
template <class Op>
constexpr double seed_nanoseconds() {
  if constexpr (requires { Op::kSeedNanoseconds; })
    return Op::kSeedNanoseconds;
  else
    return 1'000;
}

/// Per-vertex byte: 1 where the vertex must stay: boundary, interface between regions, on a labelled face
/// inside or a labelled edge, or fixed, itself or with an edge or a face.
std::vector<std::uint8_t> constrained_vertices(const TetMesh& mesh, par::Policy policy = {});
/// Number of cells of each vertex.
std::vector<std::uint32_t> star_sizes(const TetMesh& mesh, par::Policy policy = {});
/// True when the cells of v do not connect through faces, or are too many for a Star: an operator that walks
/// its star would miss some. `star_size`: all cells of v.
bool is_pinched(const TetMesh& mesh, VertexHandle v, std::uint32_t star_size, Star& scratch);
/// Per-vertex byte: 1 where the vertex is pinched; empty when none is. Walks only stars of which one cell
/// does not show that they are in one piece: on an ordered mesh, few.
std::vector<std::uint8_t> pinched_vertices(const TetMesh& mesh, std::span<const std::uint32_t> star_size,
                                           par::Policy policy = {});
/// constrained_vertices() and those that are pinched. Walks every star; a run asks for the few vertices that
/// it comes upon instead.
std::vector<std::uint8_t> frozen_vertices(const TetMesh& mesh, par::Policy policy = {});

}  // namespace hfr

#endif
