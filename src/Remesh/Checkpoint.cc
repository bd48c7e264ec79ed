// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Checkpoint.hh"

#include <algorithm>
#include <utility>
#include <vector>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// Relative: sums of volumes and angles that are nothing but rounded otherwise are the same.
constexpr double kRounding = 1e-12;
/// A better worst angle alone is worth a copy once one cell in so many has been changed: a copy costs about
/// 15 ns a cell, a change some microseconds.
constexpr std::size_t kChangesShare = 16;

bool is_more(double a, double b) { return a > b + kRounding * std::abs(b); }

}  // namespace

void restore(TetMesh& mesh, std::shared_ptr<TetMesh> copy) {
  if (copy.use_count() == 1)
    mesh.restore(std::move(*copy));
  else
    mesh.restore(TetMesh(*copy));
}

Standing standing_of(const TetMesh& mesh, const Survey& found, par::Policy policy) {
  Standing standing;
  standing.worst = found.worst;
  if (found.n_invalid == 0) return standing;
  std::vector<double> volumes;
  for (CellHandle c : invalid_cells(mesh, policy)) {
    const auto& v = mesh.cell(c).v;
    const Vec3 a = mesh.point(v[0]), b = mesh.point(v[1]), p = mesh.point(v[2]), q = mesh.point(v[3]);
    if (orientation(a, b, p, q) == 0) {
      ++standing.n_flat;
      continue;
    }
    ++standing.n_inverted;
    volumes.push_back(std::abs(Volume{}(a, b, p, q)) / 6.0);
  }
  std::sort(volumes.begin(), volumes.end());  // so that their sum is the same in any order
  for (double volume : volumes) standing.overlap += volume;
  return standing;
}

bool is_no_worse(const Standing& now, const Standing& before) {
  return now.n_inverted <= before.n_inverted &&
         now.n_inverted + now.n_flat <= before.n_inverted + before.n_flat &&
         !is_more(now.overlap, before.overlap) && !is_more(before.worst, now.worst);
}

bool is_better(const Standing& a, const Standing& b) {
  if (a.n_inverted != b.n_inverted) return a.n_inverted < b.n_inverted;
  if (a.n_flat != b.n_flat) return a.n_flat < b.n_flat;
  if (is_more(a.overlap, b.overlap) || is_more(b.overlap, a.overlap)) return a.overlap < b.overlap;
  return a.worst > b.worst;
}

Checkpoint::Checkpoint(const TetMesh& input, const Survey& found, par::Policy policy)
    : policy_(policy), input_(standing_of(input, found, policy)) {}

void Checkpoint::keep(TetMesh& mesh, bool valid, std::size_t n_changes) {
  if (valid && !input_.is_valid()) return;
  if (kept_) {
    const std::size_t n_since = std::max(n_changes, kept_after_) - std::min(n_changes, kept_after_);
    const bool little = n_since < mesh.n_logical_cells() / kChangesShare;
    if (n_changes == kept_after_ || (valid && little)) return;
    const Standing now = standing(mesh);
    if (!is_no_worse(now, input_) || !is_better(now, kept_standing_)) return;
    const bool fewer = now.n_inverted + now.n_flat < kept_standing_.n_inverted + kept_standing_.n_flat;
    if (little && !fewer) return;
    require_sound(mesh);
    kept_standing_ = now;
  } else {
    kept_standing_ = n_changes == 0 ? input_ : standing(mesh);
  }
  kept_ = std::make_shared<TetMesh>(mesh);
  kept_after_ = n_changes;
}

void Checkpoint::put_back(TetMesh& mesh) {
  restore(mesh, std::exchange(kept_, nullptr));
  restored_ = true;
}

void Checkpoint::require_sound(TetMesh& mesh) {
  // What was put back since the copy was made (see Trial) may be older than the copy, with fewer slots.
  const bool is_older = mesh.n_cells() < kept_->n_cells() || mesh.n_vertices() < kept_->n_vertices();
  const CheckResult found = is_older ? check(mesh, {.last = Rule::kDuplicateEdge, .policy = policy_})
                                     : check_changes(mesh, *kept_, policy_);
  if (found) return;
  put_back(mesh);
  throw InternalError("a rule of the mesh was broken on the way (" + std::string(rule_name(found.rule)) +
                      ": " + found.message + "); please report this, with the mesh and the options");
}

bool Checkpoint::settle(TetMesh& mesh, bool known_no_worse, const std::function<void()>& mend) {
  if (!kept_) return false;
  if (known_no_worse) {  // than anything that was kept, either
    require_sound(mesh);
    return false;
  }
  Standing now = standing(mesh);
  if (!is_no_worse(now, input_)) {
    now.worst = input_.worst;
    if (is_no_worse(now, input_)) mend();
    now = standing(mesh);
  }
  require_sound(mesh);
  const bool mended = now.n_inverted <= kept_standing_.n_inverted &&
                      now.n_inverted + now.n_flat <= kept_standing_.n_inverted + kept_standing_.n_flat;
  if (is_no_worse(now, input_) && mended) return false;
  put_back(mesh);
  return true;
}

void Checkpoint::settle_after_failure(TetMesh& mesh) noexcept {
  if (!kept_) return;
  try {
    if (check_changes(mesh, *kept_, policy_) && is_no_worse(standing(mesh), input_)) return;
  } catch (...) {  // too little memory to look: what was kept is safe
  }
  put_back(mesh);
}

}  // namespace hfr
