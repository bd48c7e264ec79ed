// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartFixes.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"

namespace hfr::mpi {
namespace {

using Kind = LabelRecord::Kind;

template <std::size_t N>
LabelRecord named(Kind kind, const std::array<VertexHandle, N>& vertices) {
  LabelRecord r;
  for (std::size_t k = 0; k < N; ++k) r.v[k] = vertices[k].idx();
  r.kind = kind;
  return r;
}

/// In the order in which require_fixed_parts() looks for them.
std::vector<LabelRecord> named_by(const SurfaceOptions& options) {
  std::vector<LabelRecord> all;
  for (VertexHandle v : options.fixed_vertices) all.push_back(named<1>(Kind::kFixedVertex, {v}));
  for (const auto& edge : options.fixed_edges) all.push_back(named(Kind::kFixedEdge, edge));
  for (const auto& face : options.fixed_faces) all.push_back(named(Kind::kFixedFace, face));
  return all;
}

std::string name_of(const LabelRecord& r) {
  std::string text = r.kind == Kind::kFixedVertex ? "fix vertex"
                     : r.kind == Kind::kFixedEdge ? "fix edge"
                                                  : "fix face";
  for (std::size_t k = 0; k < r.v.size() && r.v[k] != kNoNumber; ++k)
    text += (k == 0 ? ':' : '-') + std::to_string(r.v[k]);
  return text;
}

/// Those of which this rank has the smallest vertex, as far as their vertices are all here.
std::vector<std::size_t> own_among(const DistributedMesh& parts, const std::vector<LabelRecord>& records) {
  const auto is_here = [&](std::uint64_t number) {
    if (number == kNoNumber) return true;
    const VertexHandle v = parts.vertex_at(number);
    return v.is_valid() && !parts.part().is_deleted(v);
  };
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (std::all_of(records[i].v.begin(), records[i].v.end(), is_here) &&
        parts.is_own(parts.vertex_at(records[i].smallest_vertex())))
      own.push_back(i);
  return own;
}

bool is_fixed(const DistributedMesh& parts, const LabelRecord& r) {
  const TetMesh& part = parts.part();
  const auto v = [&](std::size_t k) { return parts.vertex_at(r.v[k]); };
  if (r.kind == Kind::kFixedVertex) return part.is_fixed(v(0));
  if (r.kind == Kind::kFixedEdge) return part.locks().edges.find({v(0), v(1)}) != nullptr;
  return part.locks().faces.find({v(0), v(1), v(2)}) != nullptr;
}

/// What the parts have of these: their places.
std::set<std::uint64_t> found(const DistributedMesh& parts, const std::vector<LabelRecord>& records) {
  const std::vector<std::size_t> own = own_among(parts, records);
  std::vector<LabelRecord> mine;
  for (std::size_t i : own) {
    mine.push_back(records[i]);
    if (mine.back().kind == Kind::kFixedEdge) mine.back().kind = Kind::kEdge;
    if (mine.back().kind == Kind::kFixedFace) mine.back().kind = Kind::kFace;
  }
  const std::vector<std::uint8_t> has = parts.has_cell(mine);
  std::vector<std::uint64_t> places;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (mine[i].kind == Kind::kFixedVertex || has[i] != 0) places.push_back(own[i]);
  places = parts.comm().all_gather(std::span<const std::uint64_t>(places));
  return {places.begin(), places.end()};
}

void require_patches(const DistributedMesh& parts, const SurfaceOptions& options) {
  std::vector<int> mine;
  const auto& labelled = parts.part().labels().faces.entries();
  for (int patch : options.fixed_patches)
    if (std::ranges::any_of(labelled, [&](const auto& entry) { return entry.value == patch; }))
      mine.push_back(patch);
  const std::vector<int> all = parts.comm().all_gather(std::span<const int>(mine));
  for (int patch : options.fixed_patches)
    HFR_REQUIRE(std::ranges::find(all, patch) != all.end(),
                "fix patch:" + std::to_string(patch) + ": no face has this label");
}

/// As require_fixed_parts() has it.
void require_all(const DistributedMesh& parts, const std::vector<LabelRecord>& records) {
  std::vector<LabelRecord> vertices;
  for (const LabelRecord& r : records)
    for (std::uint64_t v : r.v)
      if (v != kNoNumber) vertices.push_back(named<1>(Kind::kFixedVertex, {VertexHandle(v)}));
  const std::set<std::uint64_t> there = found(parts, vertices), whole = found(parts, records);
  std::size_t vertex = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (std::uint64_t v : records[i].v)
      HFR_REQUIRE(v == kNoNumber || there.contains(vertex++), name_of(records[i]) + ": there are " +
                                                                  std::to_string(parts.n_vertices()) +
                                                                  " vertices, counted from 0");
    HFR_REQUIRE(whole.contains(i), name_of(records[i]) + ": there is no such " +
                                       (records[i].kind == Kind::kFixedEdge ? "edge" : "face"));
  }
}

}  // namespace

PartFixes::PartFixes(DistributedMesh& parts, const SurfaceOptions& options) : parts_(parts) {
  const std::vector<LabelRecord> records = named_by(options);
  if (!records.empty()) require_all(parts, records);
  if (!options.fixed_patches.empty()) require_patches(parts, options);
  if (records.empty()) return;
  std::vector<std::uint64_t> places;
  for (std::size_t i : own_among(parts, records))
    if (!is_fixed(parts, records[i])) places.push_back(i);
  std::vector<LabelRecord> mine;
  for (std::uint64_t i : places) mine.push_back(records[i]);
  parts.hand_out_labels(mine);
  for (std::uint64_t i : parts.comm().all_gather(std::span<const std::uint64_t>(places)))
    fresh_.push_back(records[i]);
}

void PartFixes::release() {
  if (fresh_.empty()) return;
  TetMesh& part = parts_.part();
  Locks& locks = TetMesh::Writer(part).locks();
  for (const LabelRecord& r : fresh_) {
    std::array<VertexHandle, 3> v;
    bool is_here = true;
    for (std::size_t k = 0; k < r.v.size() && r.v[k] != kNoNumber; ++k) {
      v[k] = parts_.vertex_at(r.v[k]);
      is_here = is_here && v[k].is_valid();
    }
    if (!is_here) continue;
    if (r.kind == Kind::kFixedVertex) part.set_fixed(v[0], false);
    if (r.kind == Kind::kFixedEdge) locks.edges.erase_unordered({v[0], v[1]});
    if (r.kind == Kind::kFixedFace) locks.faces.erase_unordered(v);
  }
  parts_.work().frozen = constrained_vertices(part, {});
  fresh_.clear();
}

}  // namespace hfr::mpi
