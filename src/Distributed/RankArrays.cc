// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/RankArrays.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "Distributed/Incoming.hh"
#include "Distributed/Order.hh"
#include "Distributed/OwnItems.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {
namespace {

using Kind = LabelRecord::Kind;

constexpr std::size_t n_vertices(Kind kind) {
  switch (kind) {
    case Kind::kEdge:
    case Kind::kFixedEdge:
      return 2;
    case Kind::kFace:
    case Kind::kFixedFace:
      return 3;
    case Kind::kVertex:
    case Kind::kFixedVertex:
      break;
  }
  return 1;
}

void require_sound(const RankArrays& arrays) {
  HFR_REQUIRE(arrays.points.size() == arrays.vertex_number.size(),
              std::to_string(arrays.points.size()) + " points and " +
                  std::to_string(arrays.vertex_number.size()) + " numbers of vertices");
  HFR_REQUIRE(arrays.cell_number.empty() || arrays.cell_number.size() == arrays.cells.size(),
              std::to_string(arrays.cells.size()) + " cells and " +
                  std::to_string(arrays.cell_number.size()) + " numbers of cells");
  HFR_REQUIRE(arrays.regions.empty() || arrays.regions.size() == arrays.cells.size(),
              std::to_string(arrays.cells.size()) + " cells and " + std::to_string(arrays.regions.size()) +
                  " regions");
  for (std::size_t i = 0; i < arrays.points.size(); ++i) {
    const Vec3& p = arrays.points[i];
    HFR_REQUIRE(
        std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
        "a coordinate of vertex " + std::to_string(arrays.vertex_number[i]) + " is not a finite number");
  }
}

/// The points of cells and labels have to be given with them.
void require_points(const RankArrays& arrays) {
  std::vector<std::uint64_t> given = arrays.vertex_number;
  if (!std::is_sorted(given.begin(), given.end())) std::sort(given.begin(), given.end());
  const auto require = [&](std::uint64_t v, const char* what, std::size_t i) {
    HFR_REQUIRE(std::binary_search(given.begin(), given.end(), v),
                what + std::to_string(i) + " of this rank has vertex " + std::to_string(v) +
                    ", whose point it does not give");
  };
  for (std::size_t c = 0; c < arrays.cells.size(); ++c)
    for (std::uint64_t v : arrays.cells[c]) require(v, "cell ", c);
  for (std::size_t i = 0; i < arrays.labels.size(); ++i)
    for (std::size_t k = 0; k < n_vertices(arrays.labels[i].kind); ++k)
      require(arrays.labels[i].v[k], "label ", i);
}

/// How many the ranks before this one have.
std::uint64_t n_before(Comm& comm, std::uint64_t mine) {
  const auto all = comm.all_gather(std::span<const std::uint64_t>(&mine, 1));
  std::uint64_t n = 0;
  for (std::size_t r = 0; r < static_cast<std::size_t>(comm.rank()); ++r) n += all[r];
  return n;
}

void add_cells(Comm& comm, const RankArrays& arrays, Incoming& incoming) {
  std::array<std::uint64_t, 2> sums = {arrays.cells.size(), arrays.cell_number.size()};
  comm.sum(sums);
  HFR_REQUIRE(sums[1] == 0 || sums[1] == sums[0], "some ranks give numbers of cells, and others do not");
  std::uint64_t number = sums[1] > 0 ? 0 : n_before(comm, arrays.cells.size());
  incoming.reserve_cells(arrays.cells.size());
  for (std::size_t c = 0; c < arrays.cells.size(); ++c) {
    if (sums[1] > 0) number = arrays.cell_number[c];
    incoming.add(CornerRecord{number++, arrays.cells[c], arrays.regions.empty() ? 0 : arrays.regions[c]});
  }
}

/// Each kind by itself: by number, then by rank, then as they stand.
void add_labels(Comm& comm, const RankArrays& arrays, Incoming& incoming) {
  for (const Kind kind :
       {Kind::kVertex, Kind::kEdge, Kind::kFace, Kind::kFixedVertex, Kind::kFixedEdge, Kind::kFixedFace}) {
    std::vector<LabelRecord> records;
    std::vector<OrderKey> keys;
    for (const LabelRecord& r : arrays.labels) {
      if (r.kind != kind) continue;
      keys.push_back({r.number, static_cast<std::uint64_t>(comm.rank()), records.size(), 0});
      records.push_back(r);
    }
    const std::vector<std::uint64_t> places = places_in_order(comm, keys);
    for (std::size_t i = 0; i < records.size(); ++i) {
      LabelRecord& r = records[i];
      r.number = places[i];
      std::fill(r.v.begin() + static_cast<std::ptrdiff_t>(n_vertices(kind)), r.v.end(), kNoNumber);
      incoming.add(r);
    }
  }
}

}  // namespace

std::vector<std::string> from_arrays(DistributedMesh& mesh, const RankArrays& arrays, Keep keep,
                                     Inverted inverted) {
  Comm& comm = mesh.comm();
  const Comm::InPhase phase(comm, Phase::kHandOut);
  require_sound(arrays);
  require_points(arrays);
  Incoming incoming(comm);
  for (std::size_t i = 0; i < arrays.points.size(); ++i)
    incoming.add(PointRecord{arrays.vertex_number[i], arrays.points[i], comm.rank()});
  add_cells(comm, arrays, incoming);
  incoming.find_owners();
  if (keep == Keep::kIfEven) incoming.even_out();
  add_labels(comm, arrays, incoming);
  incoming.hand_to_owners(incoming);
  return incoming.make_parts(mesh, "the arrays", inverted);
}

RankArrays own_arrays(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  const Numbering numbering(mesh);
  const std::vector<CellHandle> cells = own_cells(mesh);
  std::vector<std::uint8_t> is_needed(part.n_vertices(), 0);
  for (VertexHandle v : own_vertices(mesh)) is_needed[v.idx()] = 1;
  RankArrays arrays;
  arrays.cells.reserve(cells.size());
  arrays.cell_number.reserve(cells.size());
  for (CellHandle c : cells) {
    auto& corners = arrays.cells.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle v = part.cell(c).v[k];
      corners[k] = numbering(v);
      is_needed[v.idx()] = 1;
    }
    arrays.cell_number.push_back(numbering(c));
  }
  if (part.has_regions())
    for (CellHandle c : cells) arrays.regions.push_back(part.region(c));
  std::vector<VertexHandle> vertices;
  for (std::size_t i = 0; i < part.n_vertices(); ++i)
    if (is_needed[i] != 0) vertices.emplace_back(i);
  for (VertexHandle v : vertices) {
    arrays.vertex_number.push_back(numbering(v));
    arrays.points.push_back(part.point(v));
    arrays.owner.push_back(mesh.owner(v));
  }
  arrays.labels = mesh.labels_of(cells, vertices);
  for (LabelRecord& r : arrays.labels)
    for (std::uint64_t& v : r.v)
      if (v != kNoNumber) v = numbering(mesh.vertex_at(v));
  const auto key = [](const LabelRecord& r) { return std::tuple(r.kind, r.number, r.key()); };
  std::ranges::sort(arrays.labels, {}, key);
  arrays.labels.erase(
      std::unique(arrays.labels.begin(), arrays.labels.end(),
                  [&](const LabelRecord& a, const LabelRecord& b) { return key(a) == key(b); }),
      arrays.labels.end());
  return arrays;
}

}  // namespace hfr::mpi
