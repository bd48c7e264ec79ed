// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Checkpoint.hh"

#include <algorithm>
#include <utility>
#include <vector>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "Quality/Metrics.hh"
#include "Remesh/MeshInParts.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// A better worst angle alone is worth a copy once one cell in so many has been changed: a copy costs about
/// 15 ns a cell, a change some microseconds.
constexpr std::size_t kChangesShare = 16;

}  // namespace

MeshCopy copy_of(const TetMesh& mesh, MeshInParts* parts) {
  if (parts) return {nullptr, parts->copy()};
  return {std::make_shared<TetMesh>(mesh), nullptr};
}

void restore(TetMesh& mesh, MeshInParts* parts, MeshCopy copy) {
  if (parts)
    parts->put_back(copy.parts);
  else if (copy.mesh.use_count() == 1)
    mesh.restore(std::move(*copy.mesh));
  else
    mesh.restore(TetMesh(*copy.mesh));
}

Checkpoint::Checkpoint(const TetMesh& input, const Survey& found, par::Policy policy,
                       const KnownValues& known)
    : policy_(policy), input_(standing_of(input, found, policy, known)) {}

Checkpoint::Checkpoint(MeshInParts& parts, par::Policy policy)
    : policy_(policy), parts_(&parts), input_(parts.standing()) {}

Standing Checkpoint::standing(const TetMesh& mesh) const {
  return parts_ ? parts_->standing() : standing_of(mesh, survey(mesh, policy_), policy_);
}

std::size_t Checkpoint::n_cells(const TetMesh& mesh) const {
  return parts_ ? parts_->n_cells() : mesh.n_logical_cells();
}

void Checkpoint::keep(TetMesh& mesh, bool valid, Revision revision) {
  if (valid && !input_.is_valid()) return;
  if (kept_) {
    const auto [fewer_changes, more_changes] = std::minmax(revision.n_changes, kept_revision_.n_changes);
    const std::size_t n_since = more_changes - fewer_changes;
    const bool little = n_since < n_cells(mesh) / kChangesShare;
    if (revision == kept_revision_ || (valid && little)) return;
    const Standing now = standing(mesh);
    if (!is_no_worse(now, input_) || !is_better(now, kept_standing_)) return;
    const bool fewer = now.n_inverted + now.n_flat < kept_standing_.n_inverted + kept_standing_.n_flat;
    if (little && !fewer) return;
    require_sound(mesh);
    kept_standing_ = now;
  } else {
    kept_standing_ = revision == Revision() ? input_ : standing(mesh);
  }
  kept_ = copy_of(mesh, parts_);
  kept_revision_ = revision;
}

void Checkpoint::trust(TetMesh& mesh, Revision revision) {
  if (!may_trust_ || !kept_ || revision == kept_revision_) return;
  require_sound(mesh);
  is_trusted_ = true;
}

void Checkpoint::put_back(TetMesh& mesh) {
  restore(mesh, parts_, std::exchange(kept_, {}));
  restored_ = true;
}

void Checkpoint::require_sound(TetMesh& mesh) {
  if (is_trusted_) return;
  const std::string fault = parts_ ? parts_->fault(kept_.parts) : fault_of(mesh);
  if (fault.empty()) return;
  put_back(mesh);
  throw InternalError("a rule of the mesh was broken on the way (" + fault +
                      "); please report this, with the mesh and the options");
}

std::string Checkpoint::fault_of(const TetMesh& mesh) const {
  const TetMesh& kept = *kept_.mesh;
  // What was put back since the copy was made (see Trial) may be older than the copy, with fewer slots.
  const bool is_older = mesh.n_cells() < kept.n_cells() || mesh.n_vertices() < kept.n_vertices();
  const CheckResult found = is_older ? check(mesh, {.last = Rule::kDuplicateEdge, .policy = policy_})
                                     : check_changes(mesh, kept, policy_);
  return found ? std::string() : std::string(rule_name(found.rule)) + ": " + found.message;
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
    if (check_changes(mesh, *kept_.mesh, policy_) && is_no_worse(standing(mesh), input_)) return;
  } catch (...) {  // too little memory to look: what was kept is safe
  }
  put_back(mesh);
}

}  // namespace hfr
