// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_GROWN_CELLS_HH
#define HFR_OPERATORS_GROWN_CELLS_HH

#include <algorithm>
#include <array>
#include <cstdint>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"

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

/// A growing set of cells and its outer half-faces, as seen from inside.
class GrownCells {
 public:
  static constexpr std::size_t kMaxFaces = 2 * Growth::kMaxCells + 2;

  GrownCells(const TetMesh& mesh, CellHandle first) : mesh_(&mesh) {
    growth_.first = first;
    cells_.push_back(first);
    for (int k = 0; k < 4; ++k) outer_.push_back(halfface_of(first, k));
    values_.resize(4);
  }

  const Growth& growth() const { return growth_; }
  const FixedVector<CellHandle, Growth::kMaxCells>& cells() const { return cells_; }
  const FixedVector<HalfFaceHandle, kMaxFaces>& outer() const { return outer_; }
  /// A number per outer half-face, for the caller's use; grow() takes it along.
  double& value(std::size_t i) { return values_[i]; }
  /// Outer half-faces from this one on came with the last step.
  std::size_t n_kept() const { return n_kept_; }
  bool has(CellHandle c) const { return std::find(cells_.begin(), cells_.end(), c) != cells_.end(); }

  /// Takes in the cell behind an outer half-face. False, with nothing changed, when there is none, the face
  /// may not vanish, there is no room, or a vertex would lie inside with no outer face.
  bool grow(HalfFaceHandle h) {
    if (cells_.full() || mesh_->is_constrained(h)) return false;
    const HalfFaceHandle m = mesh_->opposite_halfface(h);
    const CellHandle c = cell_of(m);
    FixedVector<HalfFaceHandle, 4> closed;  // outer half-faces that would lie inside
    FixedVector<HalfFaceHandle, 4> fresh;
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle behind = mesh_->opposite_halfface(halfface_of(c, k));
      if (behind.is_valid() && has(cell_of(behind))) {
        if (mesh_->is_constrained(behind)) return false;
        closed.push_back(behind);
      } else {
        fresh.push_back(halfface_of(c, k));
      }
    }
    for (VertexHandle v : mesh_->cell(c).v)
      if (!stays_outside(v, closed, fresh)) return false;
    const auto index =
        static_cast<std::size_t>(std::find(cells_.begin(), cells_.end(), cell_of(h)) - cells_.begin());
    growth_.steps[growth_.n_steps++] = static_cast<std::uint8_t>(4 * index + h.idx() % 4);
    cells_.push_back(c);
    std::size_t n = 0;
    for (std::size_t i = 0; i < outer_.size(); ++i) {
      if (contains(closed, outer_[i])) continue;
      values_[n] = values_[i];
      outer_[n++] = outer_[i];
    }
    n_kept_ = n;
    outer_.resize(n);
    values_.resize(n);
    for (HalfFaceHandle f : fresh) outer_.push_back(f);
    values_.resize(outer_.size());
    return true;
  }

 private:
  template <class List>
  static bool contains(const List& list, HalfFaceHandle h) {
    return std::find(list.begin(), list.end(), h) != list.end();
  }
  bool touches(HalfFaceHandle h, VertexHandle v) const {
    return mesh_->halfface_opposite_vertex(h) != v && mesh_->cell(cell_of(h)).has(v);
  }
  template <class List>
  bool stays_outside(VertexHandle v, const List& closed, const List& fresh) const {
    for (HalfFaceHandle f : fresh)
      if (touches(f, v)) return true;
    for (HalfFaceHandle o : outer_)
      if (touches(o, v) && !contains(closed, o)) return true;
    return false;
  }

  const TetMesh* mesh_;
  Growth growth_;
  FixedVector<CellHandle, Growth::kMaxCells> cells_;
  FixedVector<HalfFaceHandle, kMaxFaces> outer_;
  FixedVector<double, kMaxFaces> values_;
  std::size_t n_kept_ = 0;
};

}  // namespace hfr

#endif
