// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/WorkBalance.hh"

#include <algorithm>
#include <numeric>
#include <utility>

#include "Distributed/CommonBox.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/WholeStars.hh"
#include "HalfFace/Reorder.hh"
#include "Parallel/Sort.hh"
#include "Remesh/Survey.hh"

namespace hfr::mpi {
namespace {

// To mend a poor cell takes as long as to hand over so many cells and to take them back, about; or as what
// has to be done anew for so many that a rank holds, where any change hands.
constexpr std::uint64_t kCellsForOne = 8, kHeldForOne = 200;
// What it takes to ask all ranks, in poor cells.
constexpr std::uint64_t kLeast = 100;
// Cells that a rank hands over: one message holds them.
constexpr std::uint64_t kMostMoved = 10'000'000;

VertexHandle smallest_vertex(const Cell& cell) { return *std::min_element(cell.v.begin(), cell.v.end()); }

/// Own vertices that have cells, by where they lie on a curve through the whole.
std::vector<VertexHandle> along_curve(const DistributedMesh& parts) {
  const TetMesh& part = parts.part();
  std::vector<VertexHandle> vertices = own_vertices(parts);
  std::erase_if(vertices, [&](VertexHandle v) { return !part.incident_cell(v).is_valid(); });
  const Box box =
      common_box(parts.comm(), vertices.size(), [&](std::size_t i) { return part.point(vertices[i]); });
  const CurveGrid grid(SpaceCurve::kHilbert, box.low, box.high);
  std::vector<par::KeyIndex> keys, scratch;
  keys.reserve(vertices.size());
  for (VertexHandle v : vertices) keys.push_back({grid.place(part.point(v)), v.idx()});
  par::stable_sort({}, keys, scratch);
  std::transform(keys.begin(), keys.end(), vertices.begin(),
                 [](const par::KeyIndex& key) { return VertexHandle(key.index); });
  return vertices;
}

/// Of own cells, by their smallest vertices.
std::vector<std::uint32_t> poor_cells_of(const DistributedMesh& parts, double goal, par::Policy policy) {
  std::vector<std::uint32_t> n_poor(parts.part().n_vertices(), 0);
  for (CellHandle c : cells_below(parts.part(), goal, policy))
    if (parts.is_own(c)) ++n_poor[smallest_vertex(parts.part().cell(c)).idx()];
  return n_poor;
}

/// Who is to own which vertex, where this rank keeps what it has on the curve up to its share of poor cells,
/// and what comes then, up to the last one, goes to the ranks that have less, in turn.
std::vector<int> shared_out(const DistributedMesh& parts, std::span<const std::uint32_t> n_poor,
                            std::span<const std::uint64_t> given) {
  std::vector<int> to(n_poor.size(), parts.comm().rank());
  const std::uint64_t all = std::accumulate(n_poor.begin(), n_poor.end(), std::uint64_t{0});
  const std::uint64_t to_give = std::accumulate(given.begin(), given.end(), std::uint64_t{0});
  const std::vector<VertexHandle> curve = along_curve(parts);
  if (to_give == 0) return to;
  std::size_t receiver = 0;
  std::uint64_t passed = 0, end = all - to_give;  // end: of the stretch of the receiver, or of what stays
  bool stays = true;
  for (VertexHandle v : curve) {
    if (passed == all) break;
    while (passed >= end) {
      if (!stays) ++receiver;
      stays = false;
      end += given[receiver];
    }
    if (!stays) to[v.idx()] = static_cast<int>(receiver);
    passed += n_poor[v.idx()];
  }
  return to;
}

}  // namespace

std::vector<std::uint64_t> gifts(std::span<const std::uint64_t> counts, int from) {
  const std::uint64_t n = counts.size();
  const std::uint64_t share = (std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) + n - 1) / n;
  std::vector<std::uint64_t> given(counts.size(), 0);
  std::size_t receiver = 0;
  std::uint64_t room = 0;
  for (std::size_t giver = 0; giver < counts.size(); ++giver)
    for (std::uint64_t left = counts[giver] > share ? counts[giver] - share : 0; left > 0;) {
      for (; room == 0; ++receiver) room = counts[receiver] < share ? share - counts[receiver] : 0;
      const std::uint64_t some = std::min(left, room);
      if (giver == static_cast<std::size_t>(from)) given[receiver - 1] += some;
      left -= some;
      room -= some;
    }
  return given;
}

WorkBalance::WorkBalance(DistributedMesh& parts, double goal, par::Policy policy)
    : parts_(parts), n_vertices_before_(parts.n_vertices()) {
  Comm& comm = parts.comm();
  if (comm.size() == 1) return;
  const Comm::InPhase phase(comm, Phase::kHandOut);
  const std::vector<std::uint32_t> n_poor = poor_cells_of(parts, goal, policy);
  const std::uint64_t mine = std::accumulate(n_poor.begin(), n_poor.end(), std::uint64_t{0});
  const std::vector<std::uint64_t> counts = comm.all_gather(std::span<const std::uint64_t>(&mine, 1));
  const std::uint64_t all = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const std::uint64_t saved = *std::max_element(counts.begin(), counts.end()) - all / counts.size();
  const auto most_held = static_cast<std::uint64_t>(-comm.min(-static_cast<double>(parts.part().n_cells())));
  if (saved < kLeast + most_held / kHeldForOne) return;
  const std::vector<int> to = shared_out(parts, n_poor, gifts(counts, comm.rank()));
  std::uint64_t n_moved = 0;
  for (CellHandle c : parts.part().cells())
    if (parts.is_own(c) && to[smallest_vertex(parts.part().cell(c)).idx()] != comm.rank()) ++n_moved;
  const auto most_moved = static_cast<std::uint64_t>(-comm.min(-static_cast<double>(n_moved)));
  if (most_moved == 0 || saved * kCellsForOne < most_moved || most_moved > kMostMoved) return;
  is_lent_ = true;
  hand_over(to);
}

void WorkBalance::hand_over(std::span<const int> to) {
  Comm& comm = parts_.comm();
  std::vector<std::vector<std::uint64_t>> lent(comm.n_ranks());
  for (std::size_t v = 0; v < to.size(); ++v)
    if (to[v] != comm.rank()) lent[static_cast<std::size_t>(to[v])].push_back(parts_.number(VertexHandle(v)));
  std::vector<Packer> packed(comm.n_ranks());
  for (std::size_t r = 0; r < lent.size(); ++r)
    if (!lent[r].empty()) packed[r].put_all(std::exchange(lent[r], {}));
  for (const Comm::Message& message : comm.exchange(packed))
    for (std::uint64_t number : Unpacker(message.bytes).get_all<std::uint64_t>())
      borrowed_.push_back({number, message.from});
  std::ranges::sort(borrowed_, {}, &Borrowed::number);
  parts_.change_owners(to);
}

void WorkBalance::give_back() {
  if (!std::exchange(is_lent_, false)) return;
  const Comm::InPhase phase(parts_.comm(), Phase::kHandOut);
  const TetMesh& part = parts_.part();
  const auto lender = [&](VertexHandle v) {
    const auto at = std::ranges::lower_bound(borrowed_, parts_.number(v), {}, &Borrowed::number);
    return at != borrowed_.end() && at->number == parts_.number(v) ? at->from : parts_.comm().rank();
  };
  WholeStars stars(part, parts_.work());
  std::vector<int> to(part.n_vertices(), parts_.comm().rank());
  for (VertexHandle v : own_vertices(parts_)) {
    to[v.idx()] = lender(v);
    if (parts_.number(v) < n_vertices_before_ || !part.incident_cell(v).is_valid()) continue;
    VertexHandle first;  // of the neighbours that were there
    stars.for_cells(v, [&](CellHandle c) {
      for (VertexHandle u : part.cell(c).v)
        if (parts_.is_own(u) && parts_.number(u) < n_vertices_before_ && (!first.is_valid() || u < first))
          first = u;
    });
    if (first.is_valid()) to[v.idx()] = lender(first);
  }
  parts_.change_owners(to);
}

}  // namespace hfr::mpi
