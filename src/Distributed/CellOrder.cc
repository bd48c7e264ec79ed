// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/CellOrder.hh"

#include <algorithm>
#include <span>
#include <utility>

#include "Distributed/CommonBox.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/Stretches.hh"
#include "HalfFace/Reorder.hh"
#include "Parallel/Sort.hh"

namespace hfr::mpi {
namespace {

/// A cell on its way to the rank that sorts its stretch of the curve.
struct Placed {
  std::uint64_t place = 0, number = 0;
};

/// The place in the order of all of each, those with a smaller `place` first, then those with a smaller
/// number.
std::vector<std::vector<std::uint64_t>> ranked(Comm& comm, const std::vector<std::vector<Placed>>& asked) {
  std::vector<std::size_t> begins = {0};
  for (const auto& of_rank : asked) begins.push_back(begins.back() + of_rank.size());
  const std::uint64_t n = begins.back();
  std::vector<par::KeyIndex> order, scratch;
  order.reserve(n);
  for (const auto& of_rank : asked)
    for (const Placed& one : of_rank) order.push_back({one.place, static_cast<std::uint32_t>(order.size())});
  par::stable_sort({}, order, scratch);
  scratch = {};
  const auto from = [&](std::uint32_t at) {
    return static_cast<std::size_t>(std::upper_bound(begins.begin(), begins.end(), at) - begins.begin()) - 1;
  };
  const auto number = [&](const par::KeyIndex& item) {
    const std::size_t r = from(item.index);
    return asked[r][item.index - begins[r]].number;
  };
  for (std::size_t i = 0, end = 0; i < n; i = end) {
    for (end = i + 1; end < n && order[end].key == order[i].key;) ++end;
    if (end - i > 1)
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(i),
                order.begin() + static_cast<std::ptrdiff_t>(end),
                [&](const par::KeyIndex& a, const par::KeyIndex& b) { return number(a) < number(b); });
  }
  const auto counts = comm.all_gather(std::span<const std::uint64_t>(&n, 1));
  std::uint64_t next = 0;
  for (int r = 0; r < comm.rank(); ++r) next += counts[static_cast<std::size_t>(r)];
  std::vector<std::vector<std::uint64_t>> answers(asked.size());
  for (std::size_t r = 0; r < asked.size(); ++r) answers[r].resize(asked[r].size());
  for (const par::KeyIndex& item : order) {
    const std::size_t r = from(item.index);
    answers[r][item.index - begins[r]] = next++;
  }
  return answers;
}

}  // namespace

bool is_dense(DistributedMesh& mesh) {
  std::uint64_t n_deleted = 0;
  for (std::size_t i = 0; i < mesh.part().n_vertices(); ++i)
    n_deleted += mesh.is_own(VertexHandle(i)) && mesh.part().is_deleted(VertexHandle(i)) ? 1 : 0;
  return mesh.comm().sum(n_deleted) == 0 && mesh.free_slots().empty();
}

bool is_scattered(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  std::uint64_t n_far = 0;
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c) || !mesh.is_own(c)) continue;
    const std::uint64_t mine = mesh.number(c);
    for (HalfFaceHandle m : part.cell(c).mate) {
      if (!m.is_valid()) continue;
      const std::uint64_t other = mesh.number(cell_of(m));
      n_far += (other > mine ? other - mine : mine - other) >= kFarInOrder ? 1 : 0;
    }
  }
  return hfr::is_scattered(static_cast<std::size_t>(mesh.comm().sum(n_far)),
                           static_cast<std::size_t>(mesh.n_cells()));
}

std::vector<std::uint64_t> numbers_along_curve(DistributedMesh& mesh) {
  Comm& comm = mesh.comm();
  const TetMesh& part = mesh.part();
  const std::vector<VertexHandle> vertices = own_vertices(mesh);
  const Box box = common_box(comm, vertices.size(), [&](std::size_t i) { return part.point(vertices[i]); });
  const CurveGrid grid(SpaceCurve::kMorton, box.low, box.high);
  std::vector<std::uint64_t> numbers(part.n_cells(), kNoNumber);
  const auto take = [&](const std::vector<std::vector<CellHandle>>& cells,
                        const std::vector<std::vector<std::uint64_t>>& answers) {
    for (std::size_t r = 0; r < cells.size(); ++r)
      for (std::size_t i = 0; i < cells[r].size(); ++i) numbers[cells[r][i].idx()] = answers[r][i];
  };
  {
    const std::vector<CellHandle> own = own_cells(mesh);
    const Stretches<> stretches(comm, own.size(), [&](std::size_t i) { return grid.place(part, own[i]); });
    std::vector<std::vector<CellHandle>> cells(comm.n_ranks());
    std::vector<std::vector<Placed>> placed(comm.n_ranks());
    for (CellHandle c : own) {
      const std::uint64_t place = grid.place(part, c);
      const auto rank = static_cast<std::size_t>(stretches.rank_of(place));
      cells[rank].push_back(c);
      placed[rank].push_back({place, mesh.number(c)});
    }
    take(cells, comm.ask(std::move(placed), [&](const auto& asked) { return ranked(comm, asked); }));
  }
  std::vector<std::vector<CellHandle>> cells(comm.n_ranks());
  std::vector<std::vector<std::uint64_t>> old(comm.n_ranks());
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c) || mesh.is_own(c)) continue;
    const auto& v = part.cell(c).v;
    const auto rank = static_cast<std::size_t>(mesh.owner(*std::min_element(v.begin(), v.end())));
    cells[rank].push_back(c);
    old[rank].push_back(mesh.number(c));
  }
  take(cells, comm.ask(std::move(old), [&](std::vector<std::vector<std::uint64_t>> asked) {
    for (auto& of_rank : asked)
      for (std::uint64_t& number : of_rank) number = numbers[mesh.cell_at(number).idx()];
    return asked;
  }));
  return numbers;
}

}  // namespace hfr::mpi
