// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_LABELS_HH
#define HFR_DISTRIBUTED_PART_LABELS_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::mpi {

inline constexpr std::uint64_t kNoNumber = std::numeric_limits<std::uint64_t>::max();

/// What hangs on a vertex, an edge or a face of the whole: a label, or that it is fixed.
struct LabelRecord {
  enum class Kind : std::uint8_t { kVertex, kEdge, kFace, kFixedVertex, kFixedEdge, kFixedFace };

  std::array<std::uint64_t, 3> v = {kNoNumber, kNoNumber, kNoNumber};  ///< vertices, in the order as given
  std::uint64_t number = 0;  ///< among what the whole has of this kind
  std::int32_t value = 0;    ///< the label
  Kind kind = Kind::kVertex;

  std::uint64_t smallest_vertex() const { return std::min(std::min(v[0], v[1]), v[2]); }
  std::array<std::uint64_t, 3> key() const {  ///< of the same vertices in any order
    auto sorted = v;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

/// Labels and locks in a mesh that is a part of one, and what numbers they have in the whole. What hangs on
/// edges and faces stays where cells go that have them: it is true of the whole all the same, until a surface
/// that changes takes it away.
class PartLabels {
 public:
  /// Into the mesh. `vertex_at`: number → vertex; those of a record are there, with a cell that has them.
  template <class VertexAt>
  void add(TetMesh& mesh, std::span<const LabelRecord> records, VertexAt&& vertex_at) {
    Locks locks;
    for (const LabelRecord& r : records) {
      std::array<VertexHandle, 3> v;
      for (std::size_t k = 0; k < 3; ++k)
        if (r.v[k] != kNoNumber) v[k] = vertex_at(r.v[k]);
      put(mesh, r, v, locks);
    }
    fix(mesh, locks);
  }
  /// Of these vertices, and of the edges and faces of these cells; some of them twice. `frozen`: by vertex, 0
  /// for those that are on no edge or face with a label or that is fixed; empty where that is not known.
  /// `number`: vertex → number.
  template <class Number>
  std::vector<LabelRecord> of(const TetMesh& mesh, std::span<const std::uint8_t> frozen,
                              std::span<const CellHandle> cells, std::span<const VertexHandle> vertices,
                              Number&& number) const {
    std::vector<LabelRecord> records = found_at(mesh, frozen, cells, vertices);
    for (LabelRecord& r : records)
      for (std::uint64_t& v : r.v)
        if (v != kNoNumber) v = number(VertexHandle(v));
    return records;
  }
  /// Where the surface changes: a face loses its label, false where it has none; or it gets one, with its
  /// vertices in that order.
  bool erase_face(TetMesh& mesh, const std::array<VertexHandle, 3>& v);
  void set_face(TetMesh& mesh, const std::array<VertexHandle, 3>& v, std::int32_t label);
  /// `number_of`: vertices of a face → its number.
  template <class NumberOf>
  void number_faces(const TetMesh& mesh, NumberOf&& number_of) {
    const auto entries = mesh.labels().faces.entries();
    for (std::size_t i = 0; i < entries.size(); ++i) face_number_[i] = number_of(entries[i].vertices);
  }
  /// Of entry i of Labels::faces, and of Labels::edges.
  std::uint64_t face_number(std::size_t i) const { return face_number_[i]; }
  std::uint64_t edge_number(std::size_t i) const { return edge_number_[i]; }

 private:
  void put(TetMesh& mesh, const LabelRecord& record, const std::array<VertexHandle, 3>& v, Locks& locks);
  /// Fixes these edges and faces where a cell has them.
  static void fix(TetMesh& mesh, const Locks& locks);
  /// With handles in place of numbers.
  std::vector<LabelRecord> found_at(const TetMesh& mesh, std::span<const std::uint8_t> frozen,
                                    std::span<const CellHandle> cells,
                                    std::span<const VertexHandle> vertices) const;

  std::vector<std::uint64_t> face_number_, edge_number_;  // by entry
};

}  // namespace hfr::mpi

#endif
