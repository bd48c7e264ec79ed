// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <tuple>
#include <vector>

#include "Plex.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::petsc {

using mpi::LabelRecord;

TetMesh put_together(mpi::Comm& comm, const mpi::RankArrays& mine) {
  std::vector<mpi::Packer> to(comm.n_ranks());
  mpi::Packer& out = to[0];
  out.put_all(mine.vertex_number);
  out.put_all(mine.points);
  out.put_all(mine.cell_number);
  out.put_all(mine.cells);
  out.put_all(mine.regions);
  out.put_all(mine.labels);
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;
  std::vector<int> regions;
  std::vector<LabelRecord> labels;
  for (const mpi::Comm::Message& message : comm.exchange(to)) {
    mpi::Unpacker in(message.bytes);
    const auto put = [](auto& all, std::uint64_t number, const auto& value) {
      if (number >= all.size()) all.resize(static_cast<std::size_t>(number) + 1);
      all[static_cast<std::size_t>(number)] = value;
    };
    const auto vertex_numbers = in.get_all<std::uint64_t>();
    const auto its_points = in.get_all<Vec3>();
    for (std::size_t i = 0; i < vertex_numbers.size(); ++i) put(points, vertex_numbers[i], its_points[i]);
    const auto cell_numbers = in.get_all<std::uint64_t>();
    const auto its_cells = in.get_all<std::array<std::uint64_t, 4>>();
    const auto its_regions = in.get_all<std::int32_t>();
    for (std::size_t c = 0; c < cell_numbers.size(); ++c) {
      std::array<Index, 4> corners{};
      std::ranges::transform(its_cells[c], corners.begin(),
                             [](std::uint64_t v) { return static_cast<Index>(v); });
      put(cells, cell_numbers[c], corners);
      put(regions, cell_numbers[c], its_regions[c]);
    }
    const auto its_labels = in.get_all<LabelRecord>();
    labels.insert(labels.end(), its_labels.begin(), its_labels.end());
  }
  if (comm.rank() != 0) return {};
  TetMesh mesh = build(std::move(points), cells);
  for (std::size_t c = 0; c < regions.size(); ++c)
    if (regions[c] != 0) mesh.set_region(CellHandle(c), regions[c]);
  std::ranges::sort(labels, {}, [](const LabelRecord& r) { return std::tuple(r.kind, r.key()); });
  for (const LabelRecord& r : labels) {
    const VertexHandle a(r.v[0]), b(r.v[1]), c(r.v[2]);
    if (r.kind == LabelRecord::Kind::kFace) mesh.labels().faces.set({a, b, c}, r.value);
    if (r.kind == LabelRecord::Kind::kEdge) mesh.labels().edges.set({a, b}, r.value);
    if (r.kind != LabelRecord::Kind::kVertex) continue;
    mesh.labels().vertices.resize(mesh.n_vertices(), 0);
    mesh.labels().vertices[a.idx()] = r.value;
  }
  return mesh;
}

}  // namespace hfr::petsc
