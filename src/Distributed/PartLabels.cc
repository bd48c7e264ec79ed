// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartLabels.hh"

#include <algorithm>

#include "HalfFace/Errors.hh"

namespace hfr::mpi {
namespace {

/// Appends what has these vertices. `number_of`: entry → number.
template <std::size_t N, class T, class NumberOf>
void append(std::vector<LabelRecord>& records, const TupleMap<N, T>& map, LabelRecord::Kind kind,
            const std::array<VertexHandle, N>& vertices, NumberOf&& number_of) {
  const std::size_t at = map.position(vertices);
  if (at == map.size()) return;
  const auto& entry = map.entries()[at];
  LabelRecord r;
  for (std::size_t k = 0; k < N; ++k) r.v[k] = entry.vertices[k].idx();
  r.number = number_of(at);
  r.value = static_cast<std::int32_t>(entry.value);
  r.kind = kind;
  records.push_back(r);
}

}  // namespace

/// One pass over the cells: no star of this part has to be whole for it, and what is fixed is few.
void PartLabels::fix(TetMesh& mesh, const Locks& locks) {
  const auto& edges = locks.edges;
  const auto& faces = locks.faces;
  if (edges.empty() && faces.empty()) return;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.is_deleted(CellHandle(c))) continue;
    const auto& v = mesh.cell(CellHandle(c)).v;
    // A lock hangs on vertices, so any cell of theirs will do.
    for (std::size_t e = 0; e < kEdgeCorners.size() && !edges.empty(); ++e)
      if (edges.find({v[kEdgeCorners[e][0]], v[kEdgeCorners[e][1]]}))
        mesh.set_fixed(EdgeHandle(kEdgeCorners.size() * c + e));
    for (std::size_t k = 0; k < kFaceCorners.size() && !faces.empty(); ++k)
      if (faces.find({v[kFaceCorners[k][0]], v[kFaceCorners[k][1]], v[kFaceCorners[k][2]]}))
        mesh.set_fixed(FaceHandle(kFaceCorners.size() * c + k));
  }
}

void PartLabels::put(TetMesh& mesh, const LabelRecord& r, const std::array<VertexHandle, 3>& v,
                     Locks& locks) {
  using Kind = LabelRecord::Kind;
  const std::size_t n = r.v[1] == kNoNumber ? 1 : r.v[2] == kNoNumber ? 2 : 3;
  for (std::size_t k = 0; k < n; ++k)
    if (!v[k].is_valid()) throw InternalError("a label has come to a part that lacks a vertex of it");
  Labels& labels = mesh.labels();
  switch (r.kind) {
    case Kind::kVertex:
      if (labels.vertices.empty()) labels.vertices.resize(mesh.n_vertices(), 0);
      labels.vertices[v[0].idx()] = r.value;
      break;
    case Kind::kEdge:
      labels.edges.set({v[0], v[1]}, r.value);
      if (edge_number_.size() < labels.edges.size()) edge_number_.push_back(r.number);
      break;
    case Kind::kFace:
      labels.faces.set(v, r.value);
      if (face_number_.size() < labels.faces.size()) face_number_.push_back(r.number);
      break;
    case Kind::kFixedVertex:
      mesh.set_fixed(v[0]);
      break;
    case Kind::kFixedEdge:
      locks.edges.set({v[0], v[1]}, true);
      break;
    case Kind::kFixedFace:
      locks.faces.set(v, true);
      break;
  }
}

/// As TupleMap does.
bool PartLabels::erase_face(TetMesh& mesh, const std::array<VertexHandle, 3>& v) {
  auto& faces = mesh.labels().faces;
  const std::size_t at = faces.position(v);
  if (!faces.erase_unordered(v)) return false;
  face_number_[at] = face_number_.back();
  face_number_.pop_back();
  return true;
}

void PartLabels::set_face(TetMesh& mesh, const std::array<VertexHandle, 3>& v, std::int32_t label) {
  mesh.labels().faces.set(v, label);
  face_number_.resize(mesh.labels().faces.size(), kNoNumber);
}

std::vector<LabelRecord> PartLabels::found_at(const TetMesh& mesh, std::span<const std::uint8_t> frozen,
                                              std::span<const CellHandle> cells,
                                              std::span<const VertexHandle> vertices) const {
  using Kind = LabelRecord::Kind;
  std::vector<LabelRecord> records;
  const Labels& labels = mesh.labels();
  const Locks& locks = mesh.locks();
  const auto none = [](std::size_t) { return std::uint64_t{0}; };
  for (VertexHandle v : vertices) {
    LabelRecord r;
    r.v[0] = v.idx();
    r.value = labels.vertex(v);
    if (r.value != 0) records.push_back(r);
    r.kind = Kind::kFixedVertex;
    if (mesh.is_fixed(v)) records.push_back(r);
  }
  const bool of_faces = !labels.faces.empty() || !locks.faces.empty();
  const bool of_edges = !labels.edges.empty() || !locks.edges.empty();
  if (!of_faces && !of_edges) return records;
  for (CellHandle c : cells) {
    const auto& v = mesh.cell(c).v;
    const auto may_have = [&](VertexHandle u) { return frozen.empty() || frozen[u.idx()] != 0; };
    if (std::count_if(v.begin(), v.end(), may_have) < 2) continue;
    for (const auto& f : kFaceCorners) {
      if (!of_faces) break;
      const std::array<VertexHandle, 3> face = {v[f[0]], v[f[1]], v[f[2]]};
      append(records, labels.faces, Kind::kFace, face, [&](std::size_t i) { return face_number_[i]; });
      append(records, locks.faces, Kind::kFixedFace, face, none);
    }
    for (const auto& e : kEdgeCorners) {
      if (!of_edges) break;
      const std::array<VertexHandle, 2> edge = {v[e[0]], v[e[1]]};
      append(records, labels.edges, Kind::kEdge, edge, [&](std::size_t i) { return edge_number_[i]; });
      append(records, locks.edges, Kind::kFixedEdge, edge, none);
    }
  }
  return records;
}

}  // namespace hfr::mpi
