// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_CHECKPOINT_HH
#define HFR_REMESH_CHECKPOINT_HH

#include <functional>
#include <limits>
#include <memory>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Remesh/Survey.hh"

namespace hfr {

/// Makes the mesh what the copy is, and takes the copy for it where nobody else has it.
void restore(TetMesh& mesh, std::shared_ptr<TetMesh> copy);

/// What no run may leave worse than it was.
struct Standing {
  std::size_t n_inverted = 0;
  std::size_t n_flat = 0;
  double overlap = 0;                                      ///< sum of |volume| of the inverted cells
  double worst = std::numeric_limits<double>::infinity();  ///< smallest decision value of MinDihedral

  bool is_valid() const { return n_inverted + n_flat == 0; }
};
/// Of a mesh in which survey() has found that. Does not depend on the order of the cells. Another pass over
/// them where some are invalid.
Standing standing_of(const TetMesh& mesh, const Survey& found, par::Policy policy);
/// No more inverted cells, no more inverted and flat ones together, no more overlap, no smaller worst angle.
bool is_no_worse(const Standing& now, const Standing& before);
/// Fewer inverted cells; if as many, fewer inverted and flat ones; if as many, less overlap; if as much, a
/// larger worst angle.
bool is_better(const Standing& a, const Standing& b);

/// Sees to it that a run ends no worse than it began, whatever ends it. Stages that may lower what counts are
/// announced: before the first of them the mesh is copied, and again before later ones where it is no worse
/// than the input and better than what is kept. At the end the mesh stays as it is, or becomes what was kept.
/// A run that announces nothing makes no copy. One copy is held at a time: its memory is that of the mesh.
///
/// What is kept and what is left in the end is tested for rules that operators have broken since the last
/// copy. The input is taken to keep the kernel's rules.
class Checkpoint {
 public:
  Checkpoint(const TetMesh& input, const Survey& found, par::Policy policy);

  const Standing& input() const { return input_; }
  bool has_copy() const { return kept_ != nullptr; }
  /// The mesh as it was after so many operators, where that is what is kept; it is not to be changed.
  std::shared_ptr<TetMesh> copy_after(std::size_t n_changes) const {
    return n_changes == kept_after_ ? kept_ : nullptr;
  }
  /// Whether the run may end with this mesh.
  bool allows(const TetMesh& mesh) const { return is_no_worse(standing(mesh), input_); }

  /// Before a stage that may leave a mesh like this one worse: `valid` without inverted or flat cells, and
  /// `n_changes` operators committed so far. Does nothing for a valid mesh that comes from an invalid one,
  /// because no stage makes valid cells invalid. Throws InternalError, with the mesh as it was kept, where a
  /// rule has been broken.
  void keep(TetMesh& mesh, bool valid, std::size_t n_changes);

  /// At the end of a run, before garbage is collected: where the mesh has become worse than the input, puts
  /// back what was kept; true when it did. Where the smallest angle alone is worse, mend() is called before.
  /// With `known_no_worse`, which is of the mesh that met its goal, only the rules are tested. Throws
  /// InternalError, with the mesh as it was kept, where one has been broken.
  bool settle(TetMesh& mesh, bool known_no_worse, const std::function<void()>& mend);
  /// The same after an exception, when the mesh may be in any state.
  void settle_after_failure(TetMesh& mesh) noexcept;

  /// Operators that were committed in what is or was kept.
  std::size_t changes_kept() const { return kept_after_; }
  /// Whether the mesh of before the first change has been put back.
  bool is_input() const { return restored_ && kept_after_ == 0; }

 private:
  Standing standing(const TetMesh& mesh) const { return standing_of(mesh, survey(mesh, policy_), policy_); }
  void put_back(TetMesh& mesh);
  /// Throws InternalError, with the mesh as it was kept, where the mesh breaks a rule that the copy keeps.
  void require_sound(TetMesh& mesh);

  par::Policy policy_;
  Standing input_;
  std::shared_ptr<TetMesh> kept_;  // a Snapshot may have it, too
  Standing kept_standing_;
  std::size_t kept_after_ = 0;  // changes
  bool restored_ = false;
};

}  // namespace hfr

#endif
