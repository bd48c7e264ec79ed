// SPDX-License-Identifier: BSD-3-Clause
// The paper's CONFORM for one cavity. Faces are matched by their vertices; a cavity has a dozen cells as a
// rule, a few hundred at most, so an open-addressing table on the stack serves.
#include "Operators/Replace.hh"
#include "HalfFace/Writer.hh"
#include "Operators/WriteCells.hh"

#include <algorithm>
#include <bit>
#include <vector>

namespace hfr {
namespace {

/// Half-faces waiting for their partner, keyed by their three vertices.
class OpenFaces {
 public:
  explicit OpenFaces(std::size_t n_faces) {
    std::size_t size = 32;
    while (size < 2 * n_faces) size *= 2;
    mask_ = size - 1;
    std::fill_n(value_.begin(), size, -1);
  }

  /// Returns what stands under the face's vertices and takes it out; else stores `value` there and returns
  /// -1.
  std::int32_t exchange(std::array<VertexHandle, 3> face, std::int32_t value) {
    std::sort(face.begin(), face.end());
    std::uint64_t h = face[0].idx();
    h = (h * 0x9e3779b97f4a7c15ULL) ^ face[1].idx();
    h = (h * 0x9e3779b97f4a7c15ULL) ^ face[2].idx();
    for (std::size_t at = (h * 0x9e3779b97f4a7c15ULL >> 40) & mask_;; at = (at + 1) & mask_) {
      if (value_[at] == -1) {
        value_[at] = value;
        key_[at] = face;
        return -1;
      }
      if (value_[at] >= 0 && key_[at] == face) {
        const std::int32_t found = value_[at];
        value_[at] = kTaken;
        return found;
      }
    }
  }

 private:
  static constexpr std::size_t kMaxSize = 16 * Cavity::kCapacity;  // twice the faces of what goes and comes
  static_assert(std::has_single_bit(kMaxSize) && kMaxSize == 2 * (4 * (2 * Cavity::kCapacity)));
  static constexpr std::int32_t kTaken = -2;
  std::size_t mask_;
  RawArray<std::int32_t, kMaxSize> value_;
  RawArray<std::array<VertexHandle, 3>, kMaxSize> key_;
};

bool is_removed(const Cavity& cavity, CellHandle c) {
  return std::find(cavity.removed.begin(), cavity.removed.end(), c) != cavity.removed.end();
}

/// visit(half-face of a removed cell, its mate) for each outer face, in a fixed order.
template <class Visit>
void for_outer_faces(const TetMesh& mesh, const Cavity& cavity, Visit&& visit) {
  for (CellHandle c : cavity.removed) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (!m.is_valid() || !is_removed(cavity, cell_of(m))) visit(h, m);
    }
  }
}

}  // namespace

void write_cells(TetMesh& mesh, const Cavity& cavity, std::span<const CellHandle> slots,
                 VertexHandle new_vertex, std::vector<OuterFace>& notes) {
  HFR_ASSERT(slots.size() == cavity.created.size());
  TetMesh::Writer writer(mesh);
  const std::size_t first_note = notes.size();
  OpenFaces open(4 * (cavity.created.size() + cavity.removed.size()));
  for_outer_faces(mesh, cavity, [&](HalfFaceHandle h, HalfFaceHandle m) {
    open.exchange(mesh.halfface_vertices(h), static_cast<std::int32_t>(notes.size() - first_note));
    notes.push_back({h, m, HalfFaceHandle()});
  });
  for (const CavityPart& part : parts_of(cavity))
    for (std::size_t i = part.n_created; i < part.n_removed; ++i)
      writer.mark_deleted(cavity.removed[part.first_removed + i]);
  const auto n_notes = static_cast<std::int32_t>(notes.size() - first_note);
  for (std::size_t i = 0; i < cavity.created.size(); ++i) {
    Cell& cell = writer.cell(slots[i]);
    cell.v = cavity.created[i];
    cell.mate = {};  // a face that nothing is behind, new or old, stays on the boundary
    for (VertexHandle& v : cell.v)
      if (v == Cavity::kNewVertex) v = new_vertex;
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(slots[i], k);
      const std::int32_t partner =
          open.exchange(mesh.halfface_vertices(h), n_notes + static_cast<std::int32_t>(4 * i) + k);
      if (partner < 0) continue;
      if (partner < n_notes) {
        OuterFace& note = notes[first_note + static_cast<std::size_t>(partner)];
        note.after = h;
        writer.set_mate(h, note.behind);
      } else {
        const std::int32_t other = partner - n_notes;
        const HalfFaceHandle g = halfface_of(slots[static_cast<std::size_t>(other / 4)], other % 4);
        writer.set_mate(h, g);
        writer.set_mate(g, h);
      }
    }
  }
}

void replace(TetMesh& mesh, const Cavity& cavity) {
  if (cavity.moved.is_valid()) {
    mesh.set_point(cavity.moved, cavity.target);
    return;
  }
  TetMesh::Writer writer(mesh);
  std::vector<CellHandle> slots, freed;
  std::vector<CellHandle>& free = writer.free_cells();
  for (const CavityPart& part : parts_of(cavity)) {
    const CellHandle* removed = cavity.removed.begin() + part.first_removed;
    for (std::size_t i = 0; i < part.n_removed; ++i)
      (i < part.n_created ? slots : freed).push_back(removed[i]);
    for (std::size_t i = part.n_removed; i < part.n_created; ++i) {
      if (free.empty()) {
        writer.resize_cells(mesh.n_cells() + 1);
        free.push_back(CellHandle(mesh.n_cells() - 1));
      }
      slots.push_back(free.back());
      free.pop_back();
      mesh.copy_cell_data(removed[0], slots.back());
    }
  }
  free.insert(free.end(), freed.begin(), freed.end());
  VertexHandle new_vertex;
  if (cavity.new_vertex) {
    new_vertex = mesh.add_vertex(*cavity.new_vertex);
    mesh.copy_vertex_data(nearest_vertex(mesh, cavity), new_vertex);
  }
  Heirs heirs;
  find_heirs(mesh, cavity, heirs);
  std::vector<OuterFace> notes;
  write_cells(mesh, cavity, slots, new_vertex, notes);
  for (const OuterFace& note : notes)
    if (note.behind.is_valid()) writer.set_mate(note.behind, note.after);
  for (std::size_t i = slots.size(); i-- > 0;)
    for (VertexHandle v : mesh.cell(slots[i]).v) writer.set_incident_cell(v, slots[i]);
  inherit_labels(mesh, heirs, new_vertex);
  if (cavity.removed_vertex.is_valid()) writer.mark_deleted(cavity.removed_vertex);
}

}  // namespace hfr
