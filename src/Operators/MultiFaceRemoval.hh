// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_MULTI_FACE_REMOVAL_HH
#define HFR_OPERATORS_MULTI_FACE_REMOVAL_HH

#include <array>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// A tree of faces that lie between the same two apexes. Each step names a face that is in already and one of
/// its edges, and takes in the face on the other side of it.
struct FaceTree {
  static constexpr std::size_t kMaxFaces = 30;

  HalfFaceHandle first;  ///< as the cell of apex a sees it
  std::uint8_t n_steps = 0;
  std::array<std::uint8_t, kMaxFaces - 1> steps{};
};

/// Multi-face removal, the inverse of edge removal: n faces between two apexes a and b go, and an edge from a
/// to b comes; 2n cells become n + 2. The tree of faces that is best to remove with the first one is found by
/// a dynamic programme. With one face it is the 2-3 swap.
template <class Metric>
struct MultiFaceRemoval {
  static constexpr double kSeedNanoseconds = 2'000;
  /// Either half-face of an inner face. The seed of a plan also says which other faces go.
  struct Seed {
    HalfFaceHandle halfface;
    FaceTree tree;

    Seed() = default;
    explicit Seed(HalfFaceHandle h) : halfface(h) { tree.first = h; }
  };
  struct Plan : PlanBase {
    Seed seed;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell

  /// Both cells of the face, or for the seed of a plan all that go.
  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, const Seed& seed) const;
};

}  // namespace hfr

#endif
