// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Neighbourhoods.hh"

#include <algorithm>
#include <span>
#include <vector>

#include "Remesh/Polish.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// Marks the vertices of cells and of so many layers round them.
std::vector<std::uint8_t> surroundings(const TetMesh& mesh, std::span<const CellHandle> cells, int layers) {
  std::vector<std::uint8_t> marked(mesh.n_vertices(), 0);
  std::vector<VertexHandle> rim, next;
  const auto mark = [&](CellHandle c) {
    for (VertexHandle v : mesh.cell(c).v) {
      if (marked[v.idx()]) continue;
      marked[v.idx()] = 1;
      next.push_back(v);
    }
  };
  for (CellHandle c : cells) mark(c);
  Star star;
  for (int i = 0; i < layers; ++i) {
    rim.swap(next);
    next.clear();
    for (VertexHandle v : rim) {
      if (!mesh.gather_star(v, star))
        for (CellHandle c : mesh.vertex_cells(v)) mark(c);
      for (int k = 0; k < star.size; ++k) mark(star.cells[static_cast<std::size_t>(k)]);
    }
  }
  return marked;
}

}  // namespace

bool improve_neighbourhoods(const Run& run, const std::optional<NeighbourhoodEffort>& effort,
                            double degrees) {
  if (!effort) return false;
  const double decision = dihedral_decision(degrees);
  const FewCells few{.to_dig = effort->few, .to_search = effort->few};
  for (const NeighbourhoodEffort::Try& attempt : effort->tries) {
    const std::vector<CellHandle> left = cells_below(run.mesh, degrees, run.policy());
    if (left.empty()) return true;
    if (left.size() > effort->few || run.control.stopped()) return false;
    const auto around = surroundings(run.mesh, left, attempt.layers);
    PassRunner<MinSine2> runner(run, MinSine2{}, "relief");
    const Focus focus{dihedral_decision(std::min(degrees + attempt.degrees, effort->largest)), around};
    for (int i = 1; i <= effort->iterations && !run.control.stopped(); ++i) {
      const Turn turn{i, focus};
      std::size_t changes = runner.iterate(turn);
      changes += runner.pass(PassKind::kFan, turn);
      if (runner.n_below(focus.below) <= effort->few_to_dig) changes += runner.pass(PassKind::kInsert, turn);
      if (changes == 0) break;
    }
    runner.look_again();
    iterate_below(runner, run.strategy.polish, decision, few);
  }
  return cells_below(run.mesh, degrees, run.policy()).empty();
}

}  // namespace hfr
