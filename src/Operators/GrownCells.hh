// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_GROWN_CELLS_HH
#define HFR_OPERATORS_GROWN_CELLS_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "Parallel/Atomic.hh"
#include "Quality/Lowest.hh"

namespace hfr {

/// How a set of cells grew out of one of them: each step names a half-face of a cell that is in already, and
/// takes in the cell behind it. A byte a step, so that a plan can hold it and give the cells again, in order.
struct Growth {
  static constexpr std::size_t kMaxCells = 64;  // index of a cell and a corner fit into a byte

  CellHandle first;
  std::uint8_t n_steps = 0;
  std::array<std::uint8_t, kMaxCells - 1> steps{};

  void cells(const TetMesh& mesh, Scope& out) const {
    out.clear();
    out.push_back(first);
    for (std::size_t i = 0; i < n_steps; ++i)
      out.push_back(cell_of(mesh.opposite_halfface(halfface_of(out[steps[i] / 4U], steps[i] % 4))));
  }
};
static_assert(sizeof(Growth) <= 72);

/// Seed of an operator whose cluster grows from a cell. That of a plan also says which cells go; `cell` is
/// then the one they grew from.
struct CellSeed {
  CellHandle cell;
  Growth growth;

  CellSeed() = default;
  explicit CellSeed(CellHandle c) : cell(c) { growth.first = c; }
};

/// A growing set of cells and its outer half-faces, as seen from inside.
class GrownCells {
 public:
  static constexpr std::size_t kMaxFaces = 2 * Growth::kMaxCells + 2;

  GrownCells(const TetMesh& mesh, CellHandle first) : mesh_(&mesh) {
    growth_.first = first;
    push(first);
    for (int k = 0; k < 4; ++k) outer_.push_back(halfface_of(first, k));
    values_.resize(4);
  }

  const Growth& growth() const { return growth_; }
  const FixedVector<CellHandle, Growth::kMaxCells>& cells() const { return cells_; }
  const FixedVector<HalfFaceHandle, kMaxFaces>& outer() const { return outer_; }
  /// A number per outer half-face, for the caller's use; grow() takes it along.
  double& value(std::size_t i) { return values_[i]; }
  /// The outer half-face with the smallest value, the first of equals, and this value; invalid where no value
  /// is a number below infinity.
  struct Least {
    HalfFaceHandle face;
    double value;
  };
  Least least() {
    std::size_t n = outer_.size();
    for (; n % kLowestBlock != 0; ++n) values_.begin()[n] = HFR_INFINITY;
    const Lowest lowest = lowest_of(values_.begin(), n);
    return {lowest.value < HFR_INFINITY ? outer_[lowest.at] : HalfFaceHandle{}, lowest.value};
  }
  /// Outer half-faces from this one on came with the last step.
  std::size_t n_kept() const { return n_kept_; }
  bool has(CellHandle c) const {
    return ((marks_[mark_of(c) / 64] >> (mark_of(c) % 64)) & 1U) != 0 && contains(cells_, c);
  }

  /// Takes in the cell behind an outer half-face. False, with nothing changed, when there is none, the face
  /// may not vanish, there is no room, or a vertex would lie inside with no outer face.
  bool grow(HalfFaceHandle h) {
    if (cells_.full() || mesh_->is_constrained(h)) return false;
    const HalfFaceHandle m = mesh_->opposite_halfface(h);
    const CellHandle c = cell_of(m);
    FixedVector<HalfFaceHandle, 4> closed;  // outer half-faces that would lie inside
    FixedVector<int, 4> fresh;              // corners of c opposite those that would be outer ones
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle behind = mesh_->opposite_halfface(halfface_of(c, k));
      if (behind == h) {
        closed.push_back(behind);
      } else if (behind.is_valid() && has(cell_of(behind))) {
        if (mesh_->is_constrained(behind)) return false;
        closed.push_back(behind);
      } else {
        fresh.push_back(k);
      }
    }
    for (int k = 0; fresh.size() < 2 && k < 4; ++k) {  // two faces of a cell have all its vertices
      const bool on_fresh = !fresh.empty() && fresh[0] != k;
      if (!on_fresh && !stays_outside(mesh_->cell(c).v[static_cast<std::size_t>(k)], closed)) return false;
    }
    const auto index =
        static_cast<std::size_t>(std::find(cells_.begin(), cells_.end(), cell_of(h)) - cells_.begin());
    growth_.steps[growth_.n_steps++] = static_cast<std::uint8_t>(4 * index + h.idx() % 4);
    push(c);
    for (HalfFaceHandle gone : closed) {
      HalfFaceHandle* const at = std::find(outer_.begin(), outer_.end(), gone);
      HFR_ASSERT(at != outer_.end());
      double* const value = values_.begin() + (at - outer_.begin());
      std::copy(at + 1, outer_.end(), at);
      std::copy(value + 1, values_.end(), value);
      outer_.resize(outer_.size() - 1);
      values_.resize(outer_.size());
    }
    n_kept_ = outer_.size();
    for (int k : fresh) outer_.push_back(halfface_of(c, k));
    values_.resize(outer_.size());
    return true;
  }

 private:
  template <class List, class Item>
  static bool contains(const List& list, Item item) {
    return std::find(list.begin(), list.end(), item) != list.end();
  }
  /// Cells whose marks differ are not the same.
  static std::size_t mark_of(CellHandle c) { return c.idx() % kMarks; }
  void push(CellHandle c) {
    cells_.push_back(c);
    marks_[mark_of(c) / 64] |= std::uint64_t{1} << (mark_of(c) % 64);
  }
  bool touches(HalfFaceHandle h, VertexHandle v) const {
    return mesh_->halfface_opposite_vertex(h) != v && mesh_->cell(cell_of(h)).has(v);
  }
  bool stays_outside(VertexHandle v, const FixedVector<HalfFaceHandle, 4>& closed) const {
    for (HalfFaceHandle o : outer_)
      if (touches(o, v) && !contains(closed, o)) return true;
    return false;
  }

  static constexpr std::size_t kMarks = 512;

  const TetMesh* mesh_;
  Growth growth_;
  FixedVector<CellHandle, Growth::kMaxCells> cells_;
  std::array<std::uint64_t, kMarks / 64> marks_{};  // those of cells_, so that most others need no search
  FixedVector<HalfFaceHandle, kMaxFaces> outer_;
  FixedVector<double, kMaxFaces + kLowestBlock> values_;  // with room for least() to fill up
  std::size_t n_kept_ = 0;
};

/// Of a mesh that is cut out of a larger one: which cells lack a neighbour for that. What grows is right
/// until it takes one of these in; that it has is noted here.
struct CutRim {
  std::vector<std::uint8_t> is_rim;  ///< by cell
  /// By cell: 1 where something that grew for it, or from it, has come to the rim. Written from several
  /// threads.
  mutable std::vector<std::uint8_t> has_met;

  /// Whether the cell that was taken in lies there.
  bool look(const GrownCells& cells, CellHandle taken) const { return look(cells.growth().first, taken); }
  /// Of what grows for that cell.
  bool look(CellHandle centre, CellHandle taken) const {
    if (is_rim[taken.idx()] == 0) return false;
    par::atomic(has_met[centre.idx()]).store(1, std::memory_order_relaxed);
    return true;
  }
};

namespace detail {

/// A cavity, the place of the new vertex, and what they would be worth.
struct Site {
  Growth growth;
  Vec3 place;
  double old_worst = 0;
  double new_worst = -std::numeric_limits<double>::infinity();
};

}  // namespace detail
}  // namespace hfr

#endif
