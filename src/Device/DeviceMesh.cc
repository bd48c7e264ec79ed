// SPDX-License-Identifier: BSD-3-Clause
// The host's side of kernels/*.cl: what is launched in which order, and how much room there is.
#include "Device/DeviceMesh.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <numeric>

#include "Device/KernelArguments.hh"
#include "Device/Queue.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/Writer.hh"
#include "kernels/counters.h"
#include "kernels/volume_length.h"

namespace hfr {
namespace {

using detail::DeviceArray;
namespace kernel = detail::kernel;
using Clock = std::chrono::steady_clock;

constexpr cl_uint kNone = 0xffffffffU;
/// Cells a candidate at first, and words of the arena a candidate; both grow when a round needs more.
constexpr std::size_t kCellsPerCandidate = 4;
constexpr std::size_t kWordsPerCandidate = 12;
constexpr std::size_t kLeastRoom = 1024;
constexpr std::size_t kSpare = 16;  // cells per spare slot
/// Bytes of device memory a cell slot, a vertex and a candidate.
constexpr std::uint64_t kCellBytes = 32 + 8 + 1 + 4 + 16 + 1 + 4 + 4 + 4 + 4 + 2;
constexpr std::uint64_t kVertexBytes = 24 + 4 + 1 + 4 + 4 + 1 + 4 * 8 + 1;
constexpr std::uint64_t kCandidateBytes = 8 + 4 + 4 + 4 + 4 + 1 + 1 + 4 + 4 + 4 * kWordsPerCandidate;
/// Share of the memory that a mesh may take.
constexpr double kLargestShare = 0.9;
constexpr int kLeastRankBits = 8;        // of a key that choose its bin
constexpr unsigned kFewRepetitions = 4;  // of the selection that are launched at once, at least
constexpr unsigned kManyLevels = 64;     // of the colouring that are launched at once at first

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// True when cells have anything that TetMesh::copy_cell_data() copies.
bool has_cell_data(const TetMesh& mesh) {
  if (mesh.has_regions() || !mesh.properties().cells.empty()) return true;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c)
    if (mesh.is_fixed(CellHandle(c)) || mesh.is_selected(CellHandle(c)) || mesh.is_tagged(CellHandle(c)))
      return true;
  return false;
}

std::size_t room_for_cells(std::size_t n, unsigned spare) {
  return n + (spare > 0 ? spare : n / kSpare + kLeastRoom);
}
std::size_t room_for_candidates(std::size_t room, unsigned spare) {
  return spare > 0 ? spare : room / kCellsPerCandidate + kLeastRoom;
}

}  // namespace

struct DeviceMesh::Impl {
  using Counters = std::array<cl_uint, HFR_N_COUNTERS>;

  Impl(const DeviceChoice& choice, DeviceTuning tuning) : spare(tuning.spare), queue(choice, tuning) {}

  /// Runs a kernel on the arrays of its arguments' names.
  template <class Kernel>
  void launch(const Kernel& values) {
    queue.launch(values, Kernel::Arrays::from(*this));
  }
  void require_rounding();
  void reserve_mesh(std::size_t n_cells, std::size_t n_vertices);
  void reserve_candidates(std::size_t n_candidates, std::size_t n_words);
  void grow_cells(std::size_t n_cells);
  Counters read_counters() {
    Counters block{};
    queue.read(counters, block.data(), block.size());
    return block;
  }
  void list(const DeviceLook& look);
  void search(Kind kind, cl_ulong salt);
  template <class Kernel>
  void search_with(cl_ulong salt);
  void rank(Kind kind);
  void repeat_selection(unsigned first, unsigned end);
  void number_slots();
  Counters give_up_winners(cl_uint may_lose);
  void commit(Kind kind, std::uint32_t clock);
  template <class Kernel>
  void write_cells();
  void list_vertices();
  void gather_stars();
  Counters colour();
  template <class Kernel>
  void move_vertices(cl_uint colour, bool newton, cl_uint clock);

  unsigned spare;
  detail::Queue queue;
  std::size_t n_cells = 0, n_vertices = 0, n_free = 0;
  bool has_data = false, has_regions = false;
  double floor = kNoFloor;  // these two of the workspace
  bool holds_damage = true;

  DeviceArray<cl_uint> counters, sums;
  // Mesh and workspace.
  DeviceArray<cl_uint> cells;  // eight a cell, as hfr::Cell
  DeviceArray<double> points;
  DeviceArray<double> quality, worst;
  DeviceArray<cl_uchar> pending, frozen;
  DeviceArray<cl_uint> changed, star_size, incident_cells, free_cells, origin;
  DeviceArray<cl_int> regions;
  // Of a round.
  DeviceArray<cl_uint> claim, moved, cell_list;
  DeviceArray<cl_uchar> listed;
  DeviceArray<cl_ulong> keys;
  DeviceArray<cl_uint> seeds, offsets, sizes, arena, order, extra_at, freed_at, bins;
  DeviceArray<cl_uchar> won, lost;
  unsigned repetitions = kFewRepetitions;
  // Of a smoothing pass.
  DeviceArray<cl_uchar> marked, colours;
  DeviceArray<cl_uint> vertices, number, begin, cursor, level, next_level, grouped, colour_begin,
      colour_cursor;
  unsigned levels = kManyLevels;
  // By the names that kernels have for what is free when they run; `moved` has four words a cell.
  DeviceArray<cl_uint>&links = moved, &large = moved, &waits = cursor;

  cl_uint cell_count() const { return static_cast<cl_uint>(n_cells); }
  cl_uint free_count() const { return static_cast<cl_uint>(n_free); }
  cl_uint capacity() const { return static_cast<cl_uint>(keys.room); }
};

DeviceMesh::DeviceMesh(const DeviceChoice& choice, DeviceTuning tuning)
    : impl_(std::make_unique<Impl>(choice, tuning)) {
  impl_->require_rounding();
}
DeviceMesh::~DeviceMesh() = default;
const DeviceInfo& DeviceMesh::info() const { return impl_->queue.info(); }
bool DeviceMesh::from_cache() const { return impl_->queue.from_cache(); }
std::vector<KernelTime> DeviceMesh::profile() { return impl_->queue.profile(); }

std::uint64_t DeviceMesh::bytes_needed(std::size_t n_vertices, std::size_t n_cells) {
  const std::uint64_t room = room_for_cells(n_cells, 0);
  return room * kCellBytes + n_vertices * kVertexBytes + room_for_candidates(room, 0) * kCandidateBytes;
}

/// A driver that contracts a*b + c, whatever the source says, is found out here and not in an output.
void DeviceMesh::Impl::require_rounding() {
  constexpr std::size_t kProbes = 64;
  std::vector<cl_uint> tets(8 * kProbes, kNone);
  std::vector<double> coordinates(12 * kProbes), found(kProbes);
  for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = generate::random_unit(1, i);
  for (std::size_t i = 0; i < 4 * kProbes; ++i) tets[8 * (i / 4) + i % 4] = static_cast<cl_uint>(i);
  DeviceArray<cl_uint> probe_cells;
  DeviceArray<double> probe_points, probe_quality;
  queue.reserve(probe_cells, tets.size());
  queue.reserve(probe_points, coordinates.size());
  queue.reserve(probe_quality, kProbes);
  queue.write(probe_cells, tets.data(), tets.size());
  queue.write(probe_points, coordinates.data(), coordinates.size());
  queue.launch(kernel::cell_qualities{.n_cells = cl_uint{kProbes}},
               {.cells = probe_cells, .points = probe_points, .quality = probe_quality});
  queue.read(probe_quality, found.data(), kProbes);
  for (std::size_t i = 0; i < kProbes; ++i) {
    std::array<hfr_real3, 4> p;
    for (std::size_t k = 0; k < 4; ++k)
      p[k] = hfr_make3(coordinates[12 * i + 3 * k], coordinates[12 * i + 3 * k + 1],
                       coordinates[12 * i + 3 * k + 2]);
    if (std::bit_cast<std::uint64_t>(found[i]) !=
        std::bit_cast<std::uint64_t>(hfr_volume_length_decision(p[0], p[1], p[2], p[3])))
      throw DeviceError(queue.info().name +
                        " does not round as the kernels say: its results would not be the processor's");
  }
}

void DeviceMesh::Impl::reserve_mesh(std::size_t n, std::size_t n_points) {
  const std::size_t room = room_for_cells(n, spare);
  queue.reserve(counters, HFR_N_COUNTERS);
  queue.reserve(sums, 3 * std::size_t{queue.groups()});
  queue.reserve(worst, queue.work_items());
  queue.reserve(cells, 8 * room);
  queue.reserve(quality, room);
  queue.reserve(pending, room);
  queue.reserve(free_cells, room);
  queue.reserve(claim, room);
  queue.reserve(moved, 4 * room);
  queue.reserve(cell_list, room);
  queue.reserve(listed, room);
  queue.reserve(origin, has_data ? room : 1);
  queue.reserve(regions, has_regions ? n : 1);
  queue.reserve(points, 3 * n_points);
  for (DeviceArray<cl_uint>* per_vertex : {&changed, &star_size, &incident_cells, &vertices, &number, &begin,
                                           &cursor, &level, &next_level, &grouped})
    queue.reserve(*per_vertex, n_points);
  for (DeviceArray<cl_uchar>* per_vertex : {&frozen, &marked, &colours}) queue.reserve(*per_vertex, n_points);
  queue.reserve(colour_begin, HFR_MAX_COLOURS + 1);
  queue.reserve(colour_cursor, HFR_MAX_COLOURS + 1);
  const std::size_t n_candidates = room_for_candidates(room, spare);
  reserve_candidates(n_candidates, n_candidates * kWordsPerCandidate);
}

void DeviceMesh::Impl::reserve_candidates(std::size_t n_candidates, std::size_t n_words) {
  queue.reserve(keys, n_candidates);
  for (DeviceArray<cl_uint>* array : {&seeds, &offsets, &sizes, &order, &extra_at, &freed_at})
    queue.reserve(*array, n_candidates);
  queue.reserve(won, n_candidates);
  queue.reserve(lost, n_candidates);
  queue.reserve(arena, n_words);
  queue.reserve(bins, std::max(std::bit_ceil(n_candidates), std::size_t{1} << kLeastRankBits));
}

void DeviceMesh::Impl::grow_cells(std::size_t n) {
  const std::size_t before = quality.room;
  if (n <= before) return;
  const std::size_t room = room_for_cells(n, spare);
  queue.grow(cells, 8 * room);
  queue.grow(quality, room);
  queue.grow(pending, room);
  queue.grow(free_cells, room);
  queue.grow(claim, room);
  queue.fill(claim, kNone, before, room - before);
  queue.grow(moved, 4 * room);
  queue.grow(cell_list, room);
  queue.grow(listed, room);
  if (has_data) queue.grow(origin, room);
}

void DeviceMesh::require_room(std::size_t n_vertices, std::size_t n_cells) const {
  const std::uint64_t bytes = bytes_needed(n_vertices, n_cells);
  const auto room = static_cast<std::uint64_t>(kLargestShare * static_cast<double>(info().memory));
  if (bytes > room)
    throw DeviceError("the mesh is too large for " + info().name + ": it needs " +
                      std::to_string(bytes >> 20) + " MiB of the device's memory, and " +
                      std::to_string(room >> 20) + " MiB are there for it");
}

void DeviceMesh::upload(const TetMesh& mesh, const Workspace& work) {
  static_assert(sizeof(Cell) == 8 * sizeof(cl_uint), "device code has 32-bit indices");
  static_assert(HFR_MAX_STAR == Star::kCapacity, "what is smoothed on the host is what is smoothed here");
  Impl& m = *impl_;
  require_room(mesh.n_vertices(), mesh.n_cells());
  m.n_cells = mesh.n_cells();
  m.n_vertices = mesh.n_vertices();
  m.n_free = mesh.free_cells().size();
  m.has_regions = mesh.has_regions();
  m.has_data = has_cell_data(mesh);
  m.floor = work.floor;
  m.holds_damage = work.holds_damage;
  m.reserve_mesh(m.n_cells, m.n_vertices);
  if (m.n_cells > 0)
    m.queue.write(m.cells, reinterpret_cast<const cl_uint*>(&mesh.cell(CellHandle(0))), 8 * m.n_cells);
  m.queue.write(m.points, mesh.point_data(), 3 * m.n_vertices);
  m.queue.write(m.quality, work.quality.data(), m.n_cells);
  m.queue.write(m.pending, work.pending.data(), m.n_cells);
  m.queue.write(m.frozen, work.frozen.data(), m.n_vertices);
  m.queue.write(m.star_size, work.star_size.data(), m.n_vertices);
  m.queue.write(m.changed, work.changed.data(), m.n_vertices);
  std::vector<cl_uint> incident_cells(m.n_vertices);
  for (std::size_t v = 0; v < m.n_vertices; ++v)
    incident_cells[v] = static_cast<cl_uint>(mesh.incident_cell(VertexHandle(v)).idx());
  m.queue.write(m.incident_cells, incident_cells.data(), m.n_vertices);
  std::vector<cl_uint> free_cells;
  for (CellHandle c : mesh.free_cells()) free_cells.push_back(static_cast<cl_uint>(c.idx()));
  m.queue.write(m.free_cells, free_cells.data(), m.n_free);
  if (m.has_data) {
    std::vector<cl_uint> origin(m.origin.room);
    std::iota(origin.begin(), origin.end(), 0U);
    m.queue.write(m.origin, origin.data(), origin.size());
  }
  if (m.has_regions) {
    std::vector<cl_int> regions(m.n_cells);
    for (std::size_t c = 0; c < m.n_cells; ++c) regions[c] = mesh.region(CellHandle(c));
    m.queue.write(m.regions, regions.data(), m.n_cells);
  }
  m.queue.fill(m.claim, kNone, 0, m.claim.room);
}

void DeviceMesh::download(TetMesh& mesh, Workspace& work, par::Policy policy) {
  Impl& m = *impl_;
  // All of it before the first write to the mesh: should the device fail now, the mesh is still whole.
  std::vector<cl_uint> cells(8 * m.n_cells);
  std::vector<double> points(3 * m.n_vertices);
  std::vector<cl_uint> incident_cells(m.n_vertices), free_cells(m.n_free), origin(m.has_data ? m.n_cells : 0);
  std::vector<double> quality(m.n_cells);
  std::vector<std::uint8_t> pending(m.n_cells);
  std::vector<std::uint32_t> star_size(m.n_vertices), changed(m.n_vertices);
  m.queue.read(m.cells, cells.data(), cells.size());
  m.queue.read(m.points, points.data(), points.size());
  m.queue.read(m.incident_cells, incident_cells.data(), incident_cells.size());
  m.queue.read(m.free_cells, free_cells.data(), free_cells.size());
  m.queue.read(m.origin, origin.data(), origin.size());
  m.queue.read(m.quality, quality.data(), quality.size());
  m.queue.read(m.pending, pending.data(), pending.size());
  m.queue.read(m.star_size, star_size.data(), star_size.size());
  m.queue.read(m.changed, changed.data(), changed.size());

  std::vector<std::pair<std::size_t, std::size_t>> inherits;  // a slot, and whose data it takes
  for (Index c : par::compact<Index>(policy, origin.size(), [&](std::size_t i) { return origin[i] != i; }))
    inherits.emplace_back(c, origin[c]);
  TetMesh::Writer writer(mesh);
  // By way of spare slots: a slot may give its data away and take another's.
  writer.resize_cells(m.n_cells + inherits.size());
  for (std::size_t i = 0; i < inherits.size(); ++i)
    mesh.copy_cell_data(CellHandle(inherits[i].second), CellHandle(m.n_cells + i));
  for (std::size_t i = 0; i < inherits.size(); ++i)
    mesh.copy_cell_data(CellHandle(m.n_cells + i), CellHandle(inherits[i].first));
  writer.resize_cells(m.n_cells);
  par::for_each(policy, m.n_cells, [&](std::size_t c) {
    Cell& cell = writer.cell(CellHandle(c));
    for (std::size_t k = 0; k < 4; ++k) {
      cell.v[k] = VertexHandle(cells[8 * c + k]);
      cell.mate[k] = HalfFaceHandle(cells[8 * c + 4 + k]);
    }
  });
  std::copy(points.begin(), points.end(), mesh.point_data());
  // Only a vertex that was removed loses its cells.
  const auto is_gone = [&](std::size_t v) {
    return incident_cells[v] == kNone && mesh.incident_cell(VertexHandle(v)).is_valid();
  };
  for (Index v : par::compact<Index>(policy, m.n_vertices, is_gone)) writer.mark_deleted(VertexHandle(v));
  par::for_each(policy, m.n_vertices, [&](std::size_t v) {
    if (!mesh.is_deleted(VertexHandle(v)))
      writer.set_incident_cell(VertexHandle(v), CellHandle(incident_cells[v]));
  });
  writer.free_cells().clear();
  for (cl_uint c : free_cells) writer.free_cells().push_back(CellHandle(c));
  work.quality = std::move(quality);
  work.pending = std::move(pending);
  work.star_size = std::move(star_size);
  work.changed = std::move(changed);
  work.claim.assign(m.n_cells, kUnclaimed);
  work.all_touched = true;
}

void DeviceMesh::Impl::list(const DeviceLook& look) {
  queue.fill(counters, cl_uint{0}, 0, counters.room);
  launch(kernel::list_cells{.n_cells = cell_count(),
                            .below = look.below,
                            .since = cl_uint{look.since},
                            .everything_bit = cl_uint{look.pending_bit}});
  launch(kernel::scan_sums{.n = cl_uint{queue.groups()}, .n_rows = cl_uint{1}, .first = cl_uint{HFR_LISTED}});
  queue.launch(kernel::write_flagged{.n = cell_count()}, {.flags = listed, .sums = sums, .list = cell_list});
}

template <class Kernel>
void DeviceMesh::Impl::search_with(cl_ulong salt) {
  launch(Kernel{.has_regions = cl_uint{has_regions ? 1U : 0U},
                .salt = salt,
                .capacity = capacity(),
                .arena_capacity = static_cast<cl_uint>(arena.room)});
}

void DeviceMesh::Impl::search(Kind kind, cl_ulong salt) {
  if (kind == Kind::kFace) {
    search_with<kernel::search_faces>(salt);
  } else if (kind == Kind::kEdge) {
    search_with<kernel::search_edges>(salt);
    search_with<kernel::search_large_rings>(salt);
  } else if (queue.is_cpu_style()) {
    search_with<kernel::search_all_stars>(salt);
  } else {
    search_with<kernel::search_small_stars>(salt);
    search_with<kernel::search_large_stars>(salt);
  }
}

void DeviceMesh::Impl::rank(Kind kind) {
  // The first 4 bits of a key are its quality bucket, where most are alike; the next are as good as random.
  const int n_bits = std::clamp(static_cast<int>(std::bit_width(keys.room)) - 1, kLeastRankBits, 22);
  const auto n_bins = cl_uint{1} << n_bits;
  const auto shift = static_cast<cl_uint>(64 - n_bits);
  queue.fill(bins, cl_uint{0}, 0, n_bins);
  launch(kernel::rank_count{.capacity = capacity(), .shift = shift});
  queue.launch(kernel::sum_parts{.n = n_bins}, {.values = bins, .sums = sums});
  launch(
      kernel::scan_sums{.n = cl_uint{queue.groups()}, .n_rows = cl_uint{1}, .first = cl_uint{HFR_WINNERS}});
  queue.launch(kernel::scan_parts{.n = n_bins}, {.values = bins, .sums = sums});
  launch(kernel::rank_scatter{.capacity = capacity(), .shift = shift});
  const cl_uint seed_kind = kind == Kind::kEdge   ? HFR_OF_EDGE
                            : kind == Kind::kFace ? HFR_OF_FACE
                                                  : HFR_OF_VERTEX;
  launch(kernel::rank_sort{.kind = seed_kind, .n_bins = n_bins});
}

void DeviceMesh::Impl::repeat_selection(unsigned first, unsigned end) {
  for (cl_uint s = first; s < end; ++s) {
    launch(kernel::select_claim{.repetition = s, .n = capacity()});
    launch(kernel::select_decide{.repetition = s, .n = capacity()});
    launch(kernel::select_lose{.repetition = s, .n = capacity()});
    launch(kernel::select_release{.repetition = s, .n = capacity()});
  }
}

void DeviceMesh::Impl::number_slots() {
  launch(kernel::slot_sums{.capacity = capacity()});
  launch(
      kernel::scan_sums{.n = cl_uint{queue.groups()}, .n_rows = cl_uint{3}, .first = cl_uint{HFR_WINNERS}});
  launch(kernel::slot_numbers{.capacity = capacity()});
}

/// Keeps a round's loss of cells within bounds, as Round::keep_number_of_cells() does.
DeviceMesh::Impl::Counters DeviceMesh::Impl::give_up_winners(cl_uint may_lose) {
  launch(kernel::give_up_winners{.capacity = capacity(), .may_lose = may_lose});
  number_slots();
  return read_counters();
}

template <class Kernel>
void DeviceMesh::Impl::write_cells() {
  launch(Kernel{.capacity = capacity(),
                .n_free = free_count(),
                .n_cells = cell_count(),
                .has_data = cl_uint{has_data ? 1U : 0U}});
}

void DeviceMesh::Impl::commit(Kind kind, std::uint32_t clock) {
  if (kind == Kind::kVertex)
    launch(kernel::commit_stars{.capacity = capacity()});
  else if (kind == Kind::kEdge)
    write_cells<kernel::commit_edges>();
  else
    write_cells<kernel::commit_faces>();
  launch(kernel::commit_mates{
      .n = capacity(), .n_free = free_count(), .n_cells = cell_count(), .clock = cl_uint{clock}});
  launch(kernel::commit_free{.n = capacity(), .n_free = free_count()});
}

std::size_t DeviceMesh::n_logical_cells() const { return impl_->n_cells - impl_->n_free; }

RoundCounts DeviceMesh::round(Kind kind, const DeviceLook& look, std::uint64_t seed, std::uint32_t clock,
                              std::size_t may_lose) {
  Impl& m = *impl_;
  RoundCounts counts;
  const auto start = Clock::now();
  m.list(look);
  if (kind == Kind::kVertex) m.list_vertices();
  unsigned launched = m.repetitions;
  Impl::Counters block{};
  for (;;) {
    m.search(kind, seed + clock);
    m.rank(kind);
    m.launch(kernel::select_begin{.capacity = m.capacity()});
    m.repeat_selection(0, launched);
    m.number_slots();
    block = m.read_counters();
    const std::size_t n_candidates = block[HFR_CANDIDATES];
    const std::size_t n_words = block[HFR_ARENA];
    if (n_candidates <= m.keys.room && n_words <= m.arena.room) break;
    // Too little room: what was found is dropped, and found again.
    m.reserve_candidates(std::max(m.keys.room, n_candidates + n_candidates / 4),
                         std::max(m.arena.room, n_words + n_words / 4));
    m.queue.fill(m.claim, kNone, 0, m.claim.room);
    Impl::Counters again{};
    again[HFR_LISTED] = block[HFR_LISTED];
    again[HFR_VERTICES] = block[HFR_VERTICES];
    m.queue.write(m.counters, again.data(), again.size());
  }
  if (block[HFR_LISTED] == 0) return counts;
  while (block[HFR_UNDECIDED + launched] > 0) {
    const unsigned more = std::min(launched + kFewRepetitions, unsigned{HFR_SUB_ROUNDS - 1});
    if (more == launched) throw DeviceError("the selection among candidates did not come to an end");
    m.repeat_selection(launched, more);
    launched = more;
    m.number_slots();
    block = m.read_counters();
  }
  counts.rounds = 1;
  counts.seeds = block[HFR_SEEDS];
  counts.candidates = block[HFR_CANDIDATES];
  if (kind == Kind::kVertex && block[HFR_FREED] > may_lose) {
    counts.held_back = block[HFR_WINNERS];
    block = m.give_up_winners(static_cast<cl_uint>(may_lose));
    counts.held_back -= block[HFR_WINNERS];
  }
  counts.winners = block[HFR_WINNERS];
  while (block[HFR_UNDECIDED + counts.sub_rounds] > 0) ++counts.sub_rounds;
  m.repetitions = std::max(kFewRepetitions, static_cast<unsigned>(counts.sub_rounds));
  counts.seconds_evaluate = since(start);
  if (look.pending_bit) m.launch(kernel::clear_pending{.bit = cl_uint{look.pending_bit}});
  if (counts.winners == 0) return counts;
  const std::size_t extra = block[HFR_EXTRA];
  const std::size_t reused = std::min(extra, m.n_free);
  if (m.n_cells + extra - reused > TetMesh::kMostCells)
    throw ResourceLimit("the mesh would have too many cells for the indices of this build");
  m.grow_cells(m.n_cells + extra - reused);
  m.commit(kind, clock + 1);
  m.n_cells += extra - reused;
  m.n_free += block[HFR_FREED] - reused;
  return counts;
}

void DeviceMesh::Impl::list_vertices() {
  const auto n = static_cast<cl_uint>(n_vertices);
  queue.fill(marked, cl_uchar{0}, 0, n_vertices);
  launch(kernel::mark_vertices{});
  queue.launch(kernel::count_flags{.n = n}, {.flags = marked, .sums = sums});
  launch(
      kernel::scan_sums{.n = cl_uint{queue.groups()}, .n_rows = cl_uint{1}, .first = cl_uint{HFR_VERTICES}});
  queue.launch(kernel::write_flagged{.n = n}, {.flags = marked, .sums = sums, .list = vertices});
}

void DeviceMesh::Impl::gather_stars() {
  queue.fill(number, kNone, 0, n_vertices);
  queue.fill(colours, cl_uchar{HFR_MAX_COLOURS}, 0, n_vertices);
  launch(kernel::number_vertices{});
  launch(kernel::sum_begins{});
  launch(kernel::scan_sums{.n = cl_uint{queue.groups()}, .n_rows = cl_uint{1}, .first = cl_uint{HFR_LINKS}});
  launch(kernel::scan_begins{});
  launch(kernel::gather_links{.n_cells = cell_count()});
  launch(kernel::prepare_colours{});
}

/// Counters once every vertex has its colour, or once it is known that a star is too large.
DeviceMesh::Impl::Counters DeviceMesh::Impl::colour() {
  cl_uint step = 0;
  for (;;) {
    for (const cl_uint end = step + levels; step < end; ++step) {
      launch(kernel::colour_level{.step = step});
      std::swap(level, next_level);
    }
    const Counters block = read_counters();
    if (block[HFR_BIG_STARS] > 0) return block;
    if (block[HFR_COLOURED] == block[HFR_VERTICES]) {
      launch(kernel::begin_colours{});
      launch(kernel::group_colours{});
      return block;
    }
  }
}

template <class Kernel>
void DeviceMesh::Impl::move_vertices(cl_uint colour, bool newton, cl_uint clock) {
  launch(Kernel{.colour = colour,
                .use_newton = cl_uint{newton ? 1U : 0U},
                .clock = clock,
                .holds_damage = cl_uint{holds_damage ? 1U : 0U},
                .floor_value = floor});
}

std::optional<RoundCounts> DeviceMesh::smooth(const DeviceLook& look, bool newton, std::uint32_t clock) {
  Impl& m = *impl_;
  RoundCounts counts;
  auto start = Clock::now();
  m.list(look);
  m.list_vertices();
  m.gather_stars();
  const Impl::Counters block = m.colour();
  if (block[HFR_BIG_STARS] > 0 || block[HFR_COLOUR_SIZE + HFR_MAX_COLOURS] > 0) return std::nullopt;
  if (look.pending_bit) m.launch(kernel::clear_pending{.bit = cl_uint{look.pending_bit}});
  if (block[HFR_VERTICES] == 0) return counts;
  counts.seconds_select = since(start);
  start = Clock::now();
  for (cl_uint c = 0; c < HFR_MAX_COLOURS && block[HFR_COLOUR_SIZE + c] > 0; ++c) {
    if (m.queue.is_cpu_style()) {
      m.move_vertices<kernel::smooth_all_stars>(c, newton, clock + 1);
    } else {
      m.move_vertices<kernel::smooth_small_stars>(c, newton, clock + 1);
      m.move_vertices<kernel::smooth_large_stars>(c, newton, clock + 1);
    }
  }
  counts.rounds = 1;
  counts.seeds = block[HFR_VERTICES];
  counts.winners = m.read_counters()[HFR_MOVED];
  counts.candidates = counts.winners;
  counts.seconds_evaluate = since(start);
  return counts;
}

DeviceMesh::Tally DeviceMesh::tally() {
  Impl& m = *impl_;
  m.queue.fill(m.counters, cl_uint{0}, 0, m.counters.room);
  m.launch(kernel::tally_qualities{.n_cells = m.cell_count()});
  std::vector<double> worst(m.queue.work_items());
  m.queue.read(m.worst, worst.data(), worst.size());
  return {m.read_counters()[HFR_INVALID_CELLS], *std::min_element(worst.begin(), worst.end())};
}

double DeviceMesh::smallest_dihedral() {
  Impl& m = *impl_;
  m.launch(kernel::tally_dihedrals{.n_cells = m.cell_count()});
  std::vector<double> worst(m.queue.work_items());
  m.queue.read(m.worst, worst.data(), worst.size());
  return *std::min_element(worst.begin(), worst.end());
}

std::vector<double> DeviceMesh::qualities() {
  Impl& m = *impl_;
  std::vector<double> values(m.n_cells);
  m.launch(kernel::cell_qualities{.n_cells = m.cell_count()});
  m.queue.read(m.quality, values.data(), values.size());
  return values;
}

}  // namespace hfr
