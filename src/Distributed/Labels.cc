// SPDX-License-Identifier: BSD-3-Clause
// Labels and locks of a mesh in parts: from where they are known to all ranks that hold a cell of theirs.
// From then on they go with the cells. No pass removes what they hang on, so none of them ever changes, but
// for the faces of a surface that may: of those all ranks are told.
#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/WholeStars.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {
namespace {

using Kind = LabelRecord::Kind;

/// Drops all but one of several records of the same vertices. Returns the numbers of those that went.
std::vector<std::uint64_t> drop_repeated(std::vector<LabelRecord>& records, Kind kind) {
  std::vector<std::uint64_t> gone;
  std::size_t n = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const LabelRecord& r = records[i];
    if (r.kind != kind || n == 0 || records[n - 1].kind != kind || records[n - 1].key() != r.key()) {
      records[n++] = r;
      continue;
    }
    gone.push_back(r.number);
    if (kind == Kind::kEdge || kind == Kind::kFace) records[n - 1].value = r.value;
  }
  records.resize(n);
  return gone;
}

/// The numbers of these records get no gaps where others are gone.
void close_gaps(std::vector<LabelRecord>& records, Kind kind, std::vector<std::uint64_t> gone) {
  std::sort(gone.begin(), gone.end());
  for (LabelRecord& r : records)
    if (r.kind == kind)
      r.number -=
          static_cast<std::uint64_t>(std::lower_bound(gone.begin(), gone.end(), r.number) - gone.begin());
}

}  // namespace

std::vector<std::string> DistributedMesh::attach_labels(std::vector<LabelRecord> records) {
  std::sort(records.begin(), records.end(), [](const LabelRecord& a, const LabelRecord& b) {
    return std::tuple(a.kind, a.key(), a.number) < std::tuple(b.kind, b.key(), b.number);
  });
  std::vector<std::string> notes;
  for (const Kind kind : {Kind::kVertex, Kind::kEdge, Kind::kFace, Kind::kFixedVertex}) {
    std::vector<std::uint64_t> gone = drop_repeated(records, kind);
    gone = comm_.all_gather(std::span<const std::uint64_t>(gone));
    if (gone.empty()) continue;
    if (kind == Kind::kEdge || kind == Kind::kFace)
      notes.push_back(std::string(kind == Kind::kFace ? "triangles" : "edges") + " given more than once: " +
                      std::to_string(gone.size()) + "; the last label of each counts");
    close_gaps(records, kind, std::move(gone));
  }
  refuse_loose(records);
  hand_out_labels(records);
  return notes;
}

/// Shared memory lets such an edge or face constrain what goes on at its vertices, and drops it in the end.
void DistributedMesh::refuse_loose(std::span<const LabelRecord> records) const {
  std::array<std::uint64_t, 2> n_loose{};
  const std::vector<std::uint8_t> is_used = has_cell(records);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].kind == Kind::kEdge && !is_used[i]) ++n_loose[0];
    if (records[i].kind == Kind::kFace && !is_used[i]) ++n_loose[1];
  }
  comm_.sum(n_loose);
  HFR_REQUIRE(n_loose[0] + n_loose[1] == 0,
              std::to_string(n_loose[1]) + " triangles and " + std::to_string(n_loose[0]) +
                  " edges are of no tetrahedron; meshes in parts cannot have these yet");
}

std::vector<std::uint8_t> DistributedMesh::has_cell(std::span<const LabelRecord> records) const {
  const auto edge = [&](const LabelRecord& r) { return std::array{vertex_at(r.v[0]), vertex_at(r.v[1])}; };
  const auto face = [&](const LabelRecord& r) {
    return std::array{vertex_at(r.v[0]), vertex_at(r.v[1]), vertex_at(r.v[2])};
  };
  TupleMap<2, bool> edges;
  TupleMap<3, bool> faces;
  for (const LabelRecord& r : records) {
    if (r.kind == Kind::kEdge) edges.set(edge(r), true);
    if (r.kind == Kind::kFace) faces.set(face(r), true);
  }
  const std::vector<std::uint8_t> used_edges = used_entries(mesh_, edges),
                                  used_faces = used_entries(mesh_, faces);
  std::vector<std::uint8_t> has;
  for (const LabelRecord& r : records)  // some of them twice
    has.push_back(r.kind == Kind::kEdge   ? used_edges[edges.position(edge(r))]
                  : r.kind == Kind::kFace ? used_faces[faces.position(face(r))]
                                          : std::uint8_t{0});
  return has;
}

void DistributedMesh::hand_out_labels(std::span<const LabelRecord> records) {
  std::vector<std::vector<LabelRecord>> to(comm_.n_ranks());
  RankSet holders(near2_.words());
  WholeStars stars(mesh_, work_);
  for (const LabelRecord& r : records) {
    holders.clear();
    const VertexHandle v = vertex_at(r.smallest_vertex());
    const auto has_all = [&](const Cell& cell) {
      return std::all_of(r.v.begin(), r.v.end(),
                         [&](std::uint64_t n) { return n == kNoNumber || cell.has(vertex_at(n)); });
    };
    if (mesh_.incident_cell(v).is_valid())
      stars.for_cells(v, [&](CellHandle c) {
        if (in_zone_[c.idx()] != 0 && has_all(mesh_.cell(c)))
          for (VertexHandle u : mesh_.cell(c).v) holders.add(near2_[u.idx()]);
      });
    holders.remove(comm_.rank());
    for_ranks(holders.bits(), [&](int rank) { to[static_cast<std::size_t>(rank)].push_back(r); });
  }
  std::vector<Packer> packed(comm_.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (!to[r].empty()) packed[r].put_all(to[r]);
  add_labels(records);
  for (const Comm::Message& message : comm_.exchange(packed))
    add_labels(Unpacker(message.bytes).get_all<LabelRecord>());
}

void DistributedMesh::follow_face_labels() {
  struct Numbered {
    std::uint64_t number = 0;
    LabelOrder::Face v{};
  };
  std::vector<Numbered> faces;
  const auto entries = mesh_.labels().faces.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto& v = entries[i].vertices;
    if (is_own(*std::min_element(v.begin(), v.end())))
      faces.push_back({labels_.face_number(i), {number(v[0]), number(v[1]), number(v[2])}});
  }
  faces = comm_.all_gather(std::span<const Numbered>(faces));
  std::sort(faces.begin(), faces.end(),
            [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  std::vector<LabelOrder::Face> order;
  for (const Numbered& one : faces) order.push_back(one.v);
  face_order_.assign(order);
}

void DistributedMesh::change_face_labels(std::span<const LabelOrder::Face> gone,
                                         std::span<const LabelledFace> set) {
  const auto here = [&](const LabelOrder::Face& f) {
    return std::array{vertex_at(f[0]), vertex_at(f[1]), vertex_at(f[2])};
  };
  const auto is_here = [](const std::array<VertexHandle, 3>& v) {
    return std::all_of(v.begin(), v.end(), [](VertexHandle u) { return u.is_valid(); });
  };
  for (const LabelOrder::Face& f : gone) {
    face_order_.erase(f);
    if (const auto v = here(f); is_here(v)) labels_.erase_face(mesh_, v);
  }
  TupleMap<3, std::int32_t> come;
  for (const LabelledFace& one : set) {
    face_order_.set(one.v);
    if (const auto v = here(one.v); is_here(v)) come.set(v, one.label);
  }
  if (come.empty()) return;
  const std::vector<std::uint8_t> is_used = used_entries(mesh_, come);
  for (std::size_t i = 0; i < come.size(); ++i)
    if (is_used[i] != 0) labels_.set_face(mesh_, come.entries()[i].vertices, come.entries()[i].value);
}

void DistributedMesh::leave_face_labels() {
  labels_.number_faces(mesh_, [&](const std::array<VertexHandle, 3>& v) {
    return face_order_.number({number(v[0]), number(v[1]), number(v[2])});
  });
  face_order_.clear();
}

/// Those of rank 0's mesh.
void DistributedMesh::scatter_labels(const TetMesh* mesh, std::span<const int> owner) {
  std::vector<std::vector<LabelRecord>> to(comm_.n_ranks());
  const auto send = [&](LabelRecord r) {
    to[static_cast<std::size_t>(owner[r.smallest_vertex()])].push_back(r);
  };
  const auto send_all = [&](const auto& map, Kind kind) {
    LabelRecord r;
    r.kind = kind;
    for (const auto& entry : map.entries()) {
      for (std::size_t k = 0; k < entry.vertices.size(); ++k) r.v[k] = entry.vertices[k].idx();
      r.value = static_cast<std::int32_t>(entry.value);
      send(r);
      ++r.number;
    }
  };
  if (comm_.rank() == 0) {
    send_all(mesh->labels().faces, Kind::kFace);
    send_all(mesh->labels().edges, Kind::kEdge);
    send_all(mesh->locks().faces, Kind::kFixedFace);
    send_all(mesh->locks().edges, Kind::kFixedEdge);
    LabelRecord r;
    for (r.v[0] = 0; r.v[0] < mesh->n_vertices(); ++r.v[0]) {
      const VertexHandle v(r.v[0]);
      r.value = mesh->labels().vertex(v);
      r.kind = Kind::kVertex;
      if (r.value != 0) send(r);
      r.kind = Kind::kFixedVertex;
      if (mesh->is_fixed(v)) send(r);
    }
  }
  std::vector<Packer> packed(comm_.n_ranks());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (!to[r].empty()) packed[r].put_all(to[r]);
  std::vector<LabelRecord> mine;
  const Comm::Exchanged came = comm_.exchange(packed, 0);
  for (const Comm::Message& message : came.messages) mine = Unpacker(message.bytes).get_all<LabelRecord>();
  hand_out_labels(mine);
}

}  // namespace hfr::mpi
