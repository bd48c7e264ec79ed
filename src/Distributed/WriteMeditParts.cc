// SPDX-License-Identifier: BSD-3-Clause
// A mesh in the files of ParMmg: each rank writes its own cells with all their vertices, and, for each rank
// that it meets, the faces between them. A rank holds all cells round the vertices of its own ones, so each
// side knows of these faces what the other one knows.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "Distributed/AttachedArrays.hh"
#include "Distributed/InParts.hh"
#include "Distributed/OwnItems.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeditPart.hh"
#include "IO/OutputFile.hh"

namespace hfr::mpi {
namespace {

/// A face between an own cell and one of another rank.
struct Between {
  std::array<std::uint64_t, 3> key;  ///< numbers of its vertices, ascending
  std::array<VertexHandle, 3> v;     ///< as the own cell sees them
  std::size_t entry = 0;             ///< in Labels::faces, or their number
};
using Interfaces = std::map<int, std::vector<Between>>;  // by the other rank

/// What this rank writes.
class OwnPart {
 public:
  explicit OwnPart(DistributedMesh& mesh)
      : mesh_(mesh), part_(mesh.part()), numbering_(mesh), cells_(own_cells(mesh)) {
    HFR_REQUIRE(!cells_.empty(), "rank " + std::to_string(mesh.comm().rank()) +
                                     " has no cells, and ParMmg takes no part without: there are too many "
                                     "ranks for this mesh");
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    HFR_REQUIRE(numbering_.n_vertices() <= kMost && numbering_.n_cells() <= kMost,
                "ParMmg numbers vertices and cells with 32 bits");
    find_interfaces();
  }

  /// All take part.
  io::MeditPart make() {
    io::MeditPart part;
    part.n_parts = mesh_.comm().size();
    part.by_triangles = true;
    put_vertices(part.mesh);
    put_cells(part.mesh);
    put_edges(part.mesh);
    const std::vector<Index> triangle_of = put_labelled_faces(part.mesh);
    part.mesh.names = part_.labels().names;
    const std::vector<std::uint64_t> first = first_numbers();
    for (std::size_t k = 0; const auto& [other, faces] : interfaces_) {
      io::MeditInterface& interface = part.interfaces.emplace_back();
      interface.part = other;
      for (std::size_t i = 0; i < faces.size(); ++i) {
        interface.number.push_back(static_cast<std::int64_t>(first[k] + i + 1));
        interface.items.push_back(faces[i].entry < triangle_of.size() ? triangle_of[faces[i].entry]
                                                                      : put_plain(faces[i], part.mesh));
      }
      ++k;
    }
    return part;
  }

 private:
  int owner(CellHandle c) const {
    const auto& v = part_.cell(c).v;
    return mesh_.owner(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])));
  }
  void find_interfaces() {
    for (CellHandle c : cells_)
      for (HalfFaceHandle h : part_.cell_halffaces(c)) {
        if (part_.is_boundary(h)) continue;
        const int other = owner(cell_of(part_.opposite_halfface(h)));
        if (other == mesh_.comm().rank()) continue;
        Between face;
        const auto v = part_.halfface_vertices(h);
        std::copy(v.begin(), v.end(), face.v.begin());
        for (std::size_t k = 0; k < 3; ++k) face.key[k] = numbering_(v[k]);
        std::sort(face.key.begin(), face.key.end());
        face.entry = part_.labels().faces.position(face.v);
        interfaces_[other].push_back(face);
      }
    for (auto& [other, faces] : interfaces_)
      std::sort(faces.begin(), faces.end(), [](const Between& a, const Between& b) { return a.key < b.key; });
  }
  /// Numbers of faces in the whole follow on one another from pair to pair of ranks.
  std::vector<std::uint64_t> first_numbers() {
    using Pair = std::array<std::uint64_t, 3>;  // ranks, and faces between them
    const auto me = static_cast<std::uint64_t>(mesh_.comm().rank());
    std::vector<Pair> mine;
    for (const auto& [other, faces] : interfaces_)
      if (static_cast<std::uint64_t>(other) > me)
        mine.push_back({me, static_cast<std::uint64_t>(other), faces.size()});
    std::map<std::array<std::uint64_t, 2>, std::uint64_t> begin;
    std::uint64_t n = 0;
    for (const auto& [a, b, count] : mesh_.comm().all_gather(std::span<const Pair>(mine))) {
      begin[{a, b}] = n;
      n += count;
    }
    HFR_REQUIRE(n <= std::numeric_limits<std::int32_t>::max(), "ParMmg numbers triangles with 32 bits");
    std::vector<std::uint64_t> first;
    for (const auto& [other, faces] : interfaces_) {
      const auto it = static_cast<std::uint64_t>(other);
      first.push_back(begin.at({std::min(me, it), std::max(me, it)}));
    }
    return first;
  }

  void put_vertices(io::MeshData& data) {
    place_.assign(part_.n_vertices(), VertexHandle::kInvalid);
    for (CellHandle c : cells_)
      for (VertexHandle v : part_.cell(c).v) place_[v.idx()] = 0;
    for (std::size_t i = 0; i < place_.size(); ++i) {
      if (place_[i] == VertexHandle::kInvalid) continue;
      const VertexHandle v(i);
      place_[i] = static_cast<Index>(data.points.size());
      if (part_.is_fixed(v)) data.fixed_vertices.push_back(place_[i]);
      data.points.push_back(part_.point(v));
      data.vertex_labels.push_back(part_.labels().vertex(v));
    }
  }
  void put_cells(io::MeshData& data) const {
    for (CellHandle c : cells_) {
      auto& corners = data.cells.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) corners[k] = place_[part_.cell(c).v[k].idx()];
      data.regions.push_back(part_.region(c));
    }
  }
  template <std::size_t N>
  void put(const std::array<VertexHandle, N>& v, int label, std::vector<std::array<Index, N>>& items,
           std::vector<int>& labels) const {
    auto& item = items.emplace_back();
    for (std::size_t k = 0; k < N; ++k) item[k] = place_[v[k].idx()];
    labels.push_back(label);
  }
  /// Entries that own cells have, in the order of their numbers.
  template <class Map, class NumberOf, class Visit>
  static std::vector<std::size_t> entries_of(const Map& map, NumberOf&& number_of, Visit&& visit) {
    std::vector<std::size_t> entries;
    if (map.empty()) return entries;
    visit([&](const auto& vertices) {
      if (const std::size_t at = map.position(vertices); at < map.size()) entries.push_back(at);
    });
    const auto less = [&](std::size_t a, std::size_t b) { return number_of(a) < number_of(b); };
    std::sort(entries.begin(), entries.end(), less);
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    return entries;
  }
  void put_edges(io::MeshData& data) const {
    const auto& edges = part_.labels().edges;
    const auto all = entries_of(
        edges, [&](std::size_t i) { return mesh_.label_numbers().edge_number(i); },
        [&](auto&& see) {
          for (CellHandle c : cells_)
            for (const auto& e : kEdgeCorners) {
              const auto& v = part_.cell(c).v;
              see(std::array<VertexHandle, 2>{v[e[0]], v[e[1]]});
            }
        });
    for (const std::size_t i : all)
      put(edges.entries()[i].vertices, edges.entries()[i].value, data.edges, data.edge_labels);
  }
  /// Returns, of each entry of Labels::faces, its place among the triangles.
  std::vector<Index> put_labelled_faces(io::MeshData& data) const {
    const auto& faces = part_.labels().faces;
    const auto all = entries_of(
        faces, [&](std::size_t i) { return mesh_.label_numbers().face_number(i); },
        [&](auto&& see) {
          for (CellHandle c : cells_)
            for (const auto& f : kFaceCorners) {
              const auto& v = part_.cell(c).v;
              see(std::array<VertexHandle, 3>{v[f[0]], v[f[1]], v[f[2]]});
            }
        });
    std::vector<Index> place(faces.size(), VertexHandle::kInvalid);
    for (const std::size_t i : all) {
      place[i] = static_cast<Index>(data.triangles.size());
      put(faces.entries()[i].vertices, faces.entries()[i].value, data.triangles, data.triangle_labels);
    }
    return place;
  }
  /// A triangle that is there for the interface alone.
  Index put_plain(const Between& face, io::MeshData& data) const {
    put(face.v, 0, data.triangles, data.triangle_labels);
    return static_cast<Index>(data.triangles.size() - 1);
  }

  DistributedMesh& mesh_;
  const TetMesh& part_;
  Numbering numbering_;
  std::vector<CellHandle> cells_;
  Interfaces interfaces_;
  std::vector<Index> place_;  // of vertices among those of the part
};

}  // namespace

std::vector<std::string> write_medit_parts(DistributedMesh& mesh, const std::filesystem::path& path) {
  Comm& comm = mesh.comm();
  HFR_REQUIRE(path.extension() == ".mesh", path.string() + ": ParMmg's files of parts are .mesh alone");
  const io::MeditPart part = OwnPart(mesh).make();
  io::OutputFile file(io::medit_part_path(path, comm.rank()));
  std::vector<std::string> notes = io::write_medit_part(file, part);
  file.finish();
  comm.sum(0);  // all are written, or a rank has failed
  file.commit();
  comm.sum(0);
  if (mesh.arrays())
    for (std::string& note : mesh.arrays()->notes_on_leaving_out()) notes.push_back(std::move(note));
  const std::filesystem::path next = io::medit_part_path(path, comm.size());
  std::error_code error;
  if (std::filesystem::exists(next, error))
    notes.push_back(next.string() + " is there as well, from a run on more ranks");
  return notes;
}

}  // namespace hfr::mpi
