// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_CHECKPOINT_HH
#define HFR_REMESH_CHECKPOINT_HH

#include <functional>
#include <memory>
#include <string>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Remesh/RunControl.hh"
#include "Remesh/Standing.hh"
#include "Remesh/Survey.hh"

namespace hfr {

class MeshInParts;

/// A copy of the mesh of a run: one of these.
struct MeshCopy {
  std::shared_ptr<TetMesh> mesh;
  std::shared_ptr<const void> parts;  ///< see MeshInParts::copy()

  explicit operator bool() const { return mesh || parts; }
};
/// `parts`: where the mesh is part of one that is in parts; null: it is all there is.
MeshCopy copy_of(const TetMesh& mesh, MeshInParts* parts);
/// Makes the mesh what the copy is, and takes the copy for it where nobody else has it.
void restore(TetMesh& mesh, MeshInParts* parts, MeshCopy copy);

/// Sees to it that a run ends no worse than it began, whatever ends it. Stages that may lower what counts are
/// announced: before the first of them the mesh is copied, and again before later ones where it is no worse
/// than the input and better than what is kept. At the end the mesh stays as it is, or becomes what was kept.
/// A run that announces nothing makes no copy. One copy is held at a time: its memory is that of the mesh.
///
/// What is kept and what is left in the end is tested for rules that operators have broken since the last
/// copy; see trust(). The input is taken to keep the kernel's rules.
class Checkpoint {
 public:
  Checkpoint(const TetMesh& input, const Survey& found, par::Policy policy, const KnownValues& known = {});
  /// Of a mesh in parts, each of whose ranks has one, and calls all of it at the same time as the others. The
  /// meshes that it is given are parts.
  Checkpoint(MeshInParts& parts, par::Policy policy);

  const Standing& input() const { return input_; }
  bool has_copy() const { return bool(kept_); }
  /// This mesh of the run, where it is what is kept; it is not to be changed.
  MeshCopy copy_of_revision(Revision revision) const {
    return revision == kept_revision_ ? kept_ : MeshCopy();
  }
  /// Whether the run may end with this mesh.
  bool allows(const TetMesh& mesh) const { return is_no_worse(standing(mesh), input_); }

  /// Before a stage that may leave a mesh like this one worse: `valid` without inverted or flat cells. Does
  /// nothing for a valid mesh that comes from an invalid one, because no stage makes valid cells invalid.
  /// Throws InternalError, with the mesh as it was kept, where a rule has been broken.
  void keep(TetMesh& mesh, bool valid, Revision revision);

  /// Of a mesh that was changed where rules could be broken, and in which none can be from here on: it is
  /// tested now, and not again until distrust(). Does nothing without a copy, where the mesh is what is kept,
  /// or before may_trust(). Throws as keep() does.
  void trust(TetMesh& mesh, Revision revision);
  void may_trust(bool may) { may_trust_ = may; }
  void distrust() { is_trusted_ = false; }
  bool is_trusted() const { return is_trusted_; }

  /// At the end of a run, before garbage is collected: where the mesh has become worse than the input, puts
  /// back what was kept; true when it did. Where the smallest angle alone is worse, mend() is called before.
  /// With `known_no_worse`, which is of the mesh that met its goal, only the rules are tested. Throws
  /// InternalError, with the mesh as it was kept, where one has been broken.
  bool settle(TetMesh& mesh, bool known_no_worse, const std::function<void()>& mend);
  /// The same after an exception, when the mesh may be in any state.
  void settle_after_failure(TetMesh& mesh) noexcept;

  /// What is or was kept.
  Revision kept_revision() const { return kept_revision_; }
  /// Whether the mesh of before the first change has been put back.
  bool is_input() const { return restored_ && kept_revision_ == Revision(); }

 private:
  Standing standing(const TetMesh& mesh) const;
  std::size_t n_cells(const TetMesh& mesh) const;
  void put_back(TetMesh& mesh);
  /// Throws InternalError, with the mesh as it was kept, where the mesh breaks a rule that the copy keeps.
  /// Does not look where no rule can be broken.
  void require_sound(TetMesh& mesh);
  /// The first rule that it breaks since the copy was made; empty where it breaks none.
  std::string fault_of(const TetMesh& mesh) const;

  par::Policy policy_;
  MeshInParts* parts_ = nullptr;
  Standing input_;
  MeshCopy kept_;  // a Snapshot may have it, too
  Standing kept_standing_;
  Revision kept_revision_;
  bool restored_ = false;
  bool may_trust_ = false, is_trusted_ = false;
};

}  // namespace hfr

#endif
