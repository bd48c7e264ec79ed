// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/OwnItems.hh"

namespace hfr::mpi {
namespace {

/// In the order of numbers. `number_of`: entry → number.
template <std::size_t N, class NumberOf>
std::vector<Labelled<N>> own_labelled(const DistributedMesh& mesh, const TupleMap<N, int>& map,
                                      NumberOf&& number_of) {
  std::vector<Labelled<N>> own;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto& entry = map.entries()[i];
    if (mesh.is_own(*std::min_element(entry.vertices.begin(), entry.vertices.end())))
      own.push_back({number_of(i), entry.vertices, static_cast<std::int32_t>(entry.value)});
  }
  std::sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return own;
}

}  // namespace

Numbering::Numbering(DistributedMesh& mesh) : mesh_(mesh), slots_(mesh.free_slots()) {
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i)
    if (const VertexHandle v(i); mesh.is_own(v) && mesh.part().is_deleted(v)) gone_.push_back(mesh.number(v));
  gone_ = mesh.comm().all_gather(std::span<const std::uint64_t>(gone_));
  std::sort(gone_.begin(), gone_.end());
  n_vertices_ = mesh.n_vertices() - gone_.size();
  vertex_.reserve(mesh.part().n_vertices());
  std::size_t n_gone = 0;
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i) {  // in the order of numbers
    const std::uint64_t number = mesh.number(VertexHandle(i));
    while (n_gone < gone_.size() && gone_[n_gone] < number) ++n_gone;
    vertex_.push_back(number - n_gone);
  }
  std::sort(slots_.begin(), slots_.end());
}

std::vector<VertexHandle> own_vertices(const DistributedMesh& mesh) {
  std::vector<VertexHandle> vertices;
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i)
    if (const VertexHandle v(i); mesh.is_own(v) && !mesh.part().is_deleted(v)) vertices.push_back(v);
  return vertices;
}

std::vector<CellHandle> own_cells(const DistributedMesh& mesh) {
  std::vector<CellHandle> cells;
  for (std::size_t i = 0; i < mesh.part().n_cells(); ++i)
    if (const CellHandle c(i); !mesh.part().is_deleted(c) && mesh.is_own(c)) cells.push_back(c);
  const auto by_number = [&](CellHandle a, CellHandle b) { return mesh.number(a) < mesh.number(b); };
  if (!std::is_sorted(cells.begin(), cells.end(), by_number))
    std::sort(cells.begin(), cells.end(), by_number);
  return cells;
}

OwnLabels::OwnLabels(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  const Labels& labels = part.labels();
  const PartLabels& numbers = mesh.label_numbers();
  faces = own_labelled(mesh, labels.faces, [&](std::size_t i) { return numbers.face_number(i); });
  edges = own_labelled(mesh, labels.edges, [&](std::size_t i) { return numbers.edge_number(i); });
  const auto is_set = [](const auto& one) { return one.label != 0; };
  bool has_region =
      std::any_of(faces.begin(), faces.end(), is_set) || std::any_of(edges.begin(), edges.end(), is_set);
  for (std::size_t c = 0; c < part.n_cells() && part.has_regions() && !has_region; ++c)
    has_region = !part.is_deleted(CellHandle(c)) && part.region(CellHandle(c)) != 0;
  std::array<std::uint64_t, 5> sums = {faces.size(), edges.size(), has_region ? 1U : 0U, 0, 0};
  for (VertexHandle v : own_vertices(mesh)) {
    sums[3] += labels.vertex(v) != 0 ? 1 : 0;
    sums[4] += part.is_fixed(v) ? 1 : 0;
  }
  mesh.comm().sum(sums);
  n_faces = sums[0];
  n_edges = sums[1];
  with_regions = sums[2] > 0;
  with_vertex_labels = sums[3] > 0;
  n_fixed = sums[4];
}

}  // namespace hfr::mpi
