// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_UNFOLDING_HH
#define HFR_REMESH_UNFOLDING_HH

#include <array>
#include <cstddef>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Quality/Damage.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

struct UntangleEffort;

/// How tangled the cells are that are worked on.
struct Tangle {
  std::size_t n_invalid = 0;
  double overlap = 0;  ///< six times the volume of the invalid ones, summed in the order of the cells

  /// Fewer cells, or so much less of them that it shows. While vertices find their places, cells become more
  /// at first, and where they are all on their way, fewer only in the end.
  bool is_less_than(const Tangle& other) const;
};

/// The surroundings of invalid cells while their vertices are moved, in a mesh or in the parts of one: the
/// same moves in both. What is moved falls into patches that share no cell; each keeps its moves only if it
/// has fewer invalid cells afterwards, or fewer inverted ones, and none of the two has become more.
class Unfolding {
 public:
  virtual ~Unfolding() = default;
  /// Finds the invalid cells; returns how many there are.
  virtual std::size_t look() = 0;
  /// Vertices of these and of so many layers round them.
  virtual std::size_t n_within(int layers) = 0;
  /// Takes these vertices, but for those that must stay, with all cells that a move may change; returns how
  /// many. What follows is about them, and not to be called where there are none.
  virtual std::size_t take(int layers) = 0;
  virtual Tangle tangle() = 0;
  /// Each vertex towards the mean of its neighbours, of each as often as they share a cell, by `over` times
  /// the way. Returns the sum of the ways, in the order of the vertices.
  virtual double relax(double over) = 0;
  /// All vertices back to where they were when they were taken.
  virtual void put_back() = 0;
  /// Each vertex to where unfold() sends it.
  virtual void sweep() = 0;
  /// Puts the vertices of patches that have not gained back to where they were when they were taken. Returns
  /// the number of moved vertices that stay.
  virtual std::size_t keep_what_helps() = 0;

 protected:
  // What stands once for meshes and parts.
  /// Six times the volume of a cell, without its sign, if it is invalid; -1 otherwise.
  static double overlap_of(const TetMesh& mesh, CellHandle c);
  /// By how much relax() moves a vertex; `link`: the half-faces opposite it, in the order of their cells.
  static Vec3 relaxation(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                         double over);
  /// To where sweep() does.
  static Vec3 unfolded(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                       const UntangleEffort& effort);
  /// Whether a patch keeps its moves.
  static bool helps(const Workspace& work, const Damage& was, const Damage& is);

  static constexpr double kUnfoldNanoseconds = 5'000;  // a vertex
};

/// Ends of a box, so that it can be grown.
struct Box {
  Vec3 low, high;
};
/// Of the vertices that have cells.
Box box_of(const TetMesh& mesh);

}  // namespace hfr

#endif
