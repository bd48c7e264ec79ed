// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/CellWatch.hh"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include "HalfFace/Errors.hh"
#include "HalfFace/Geometry.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"
#include "Quality/Decisions.hh"
#include "Quality/Lowest.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

// Vertices whose cells are asked for while those of another are looked at.
constexpr std::size_t kAhead = 4;
constexpr double kNanosecondsACell = 40, kNanosecondsAStar = 1'500;  // about

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::infinity();

}  // namespace

CellWatch::CellWatch(const TetMesh& mesh, const RepairTriggers& triggers, par::Policy policy)
    : mesh_(mesh),
      triggers_(triggers),
      policy_(policy),
      trigger_(triggers.min_dihedral > 0 ? dihedral_decision(triggers.min_dihedral) : kNever),
      good_from_(std::max(trigger_, std::numeric_limits<double>::denorm_min())),
      asks_more_(!triggers.metrics.empty() || triggers.jacobian_ratio > 0 || triggers.indicator ||
                 !triggers.indicator_field.empty()) {}

void CellWatch::forget_looks() {
  const std::size_t n = mesh_.n_cells();
  quality_.assign(n, 0.0);
  bad_.assign(n, 0);
  has_bad_ = true;
}

void CellWatch::reset() {
  const std::size_t n = mesh_.n_cells();
  forget_looks();
  forget_excuses();
  if (triggers_.jacobian_ratio > 0) {
    rest_volume_.resize(n);
    par::for_each(policy_, n, [&](std::size_t i) { rest_volume_[i] = volume(mesh_, CellHandle(i)); });
  }
  look_at_all();
}

void CellWatch::forget_excuses() {
  excused_.assign(mesh_.n_cells(), 0);
  left_.assign(mesh_.n_cells(), kNever);
  has_excused_ = false;
}

CellWatch::Memory CellWatch::memory() const {
  Memory memory{.left = {}, .rest_volume = rest_volume_, .excused = {}};
  if (!has_excused_) return memory;
  memory.left = left_;
  memory.excused = excused_;
  return memory;
}

void CellWatch::restore(Memory memory) {
  rest_volume_ = std::move(memory.rest_volume);
  forget_looks();
  forget_excuses();
  if (memory.left.empty()) return;
  left_ = std::move(memory.left);
  excused_ = std::move(memory.excused);
  has_excused_ = true;
}

std::uint8_t CellWatch::badness(CellHandle c) const {
  const double value = quality_[c.idx()];
  unsigned bits = 0;
  if (!(value > 0)) bits |= kIsInverted;
  if (value < trigger_) bits |= kIsBelow;
  const auto& v = mesh_.cell_vertices(c);
  for (const auto& [metric, bound] : triggers_.metrics) {
    const double q =
        reported_quality(metric, mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
    if (metric == Metric::kMaxDihedral ? q > bound : q < bound) bits |= kHasMetric;
  }
  if (triggers_.jacobian_ratio > 0 && volume(mesh_, c) < triggers_.jacobian_ratio * rest_volume_[c.idx()])
    bits |= kIsSqueezed;
  if (triggers_.indicator && triggers_.indicator(mesh_, c)) bits |= kIsIndicated;
  if (is_indicated_ && is_indicated_(c.idx())) bits |= kIsIndicated;
  return static_cast<std::uint8_t>(bits);
}

/// Takes the cell's new decision value, and judges the cell.
void CellWatch::update(CellHandle c, double value) {
  const std::size_t i = c.idx();
  quality_[i] = value;
  bad_[i] = badness(c);
  unsigned excused = excused_[i] & bad_[i];
  if (kStepEffort.is_much_worse(value, left_[i]))
    excused &= ~static_cast<unsigned>(kIsBelow | kHasMetric | kIsSqueezed);
  excused_[i] = static_cast<std::uint8_t>(excused);
}

/// Likewise; what it counts as.
CellWatch::Totals CellWatch::judged(CellHandle c, double value) {
  if (stays_good(c, value)) {
    quality_[c.idx()] = value;
    return {};
  }
  update(c, value);
  return totals_of(c);
}

/// Whether any of n cells from `first` on was bad, or is excused.
bool CellWatch::knows_bad(std::size_t first, std::size_t n) const {
  unsigned bits = 0;
  for (std::size_t i = first; i < first + n; ++i) bits |= static_cast<unsigned>(bad_[i] | excused_[i]);
  return bits != 0;
}

CellWatch::Totals CellWatch::totals_of(CellHandle c) const {
  const std::uint8_t bits = bad_[c.idx()];
  unsigned active = bits & ~static_cast<unsigned>(excused_[c.idx()]);
  if (!triggers_.inverted) active &= ~static_cast<unsigned>(kIsInverted);
  Totals totals;
  totals.active = active != 0 ? 1 : 0;
  totals.inverted = (bits & kIsInverted) != 0 ? 1 : 0;
  for (std::size_t i = 0; i < kReasons; ++i) totals.active_by[i] = active >> i & 1U;
  totals.any = bits != 0;
  return totals;
}

void CellWatch::find_indicator_field() {
  is_indicated_ = nullptr;
  const std::string& name = triggers_.indicator_field;
  if (name.empty()) return;
  const auto try_one = [&]<class T>(const detail::DenseStored& stored, std::type_identity<T>) {
    if (stored.type() != typeid(T)) return;
    const auto* values = &static_cast<const detail::Dense<T>&>(stored).values;
    is_indicated_ = [values](std::size_t i) { return (*values)[i] != T{}; };
  };
  for (const std::shared_ptr<detail::DenseStored>& p : mesh_.properties().cells) {
    if (p->name() != name || p->is_anonymous()) continue;
    try_one(*p, std::type_identity<double>{});
    try_one(*p, std::type_identity<float>{});
    try_one(*p, std::type_identity<std::int64_t>{});
    try_one(*p, std::type_identity<int>{});
  }
  HFR_REQUIRE(is_indicated_, "trigger by field: cells have no field '" + name + "' of single numbers");
}

std::size_t CellWatch::look_at_all() {
  find_indicator_field();
  const std::size_t n = mesh_.n_cells(), n_blocks = (n + kBlock - 1) / kBlock;
  const int n_parts = par::thread_count(policy_, n);
  parts_.assign(static_cast<std::size_t>(n_parts), {});
  block_worst_.resize(n_blocks);
  stale_.assign(n_blocks, 0);
  const bool had_bad = has_bad_;
  par::parts(n_parts, [&](int part) {
    Totals mine;
    const std::size_t end = par::part_begin(n_blocks, n_parts, part + 1);
    for (std::size_t block = par::part_begin(n_blocks, n_parts, part); block < end; ++block) {
      double worst = kNone;
      for_decision_blocks(mesh_, MinDihedral{}, block * kBlock, std::min(n, (block + 1) * kBlock),
                          [&](std::size_t first, const CornerBlock::Lane& values, std::size_t size) {
                            const Floor floor = floor_of(values.data(), values.size(), good_from_);
                            worst = std::min(worst, floor.least);
                            if (floor.holds && !asks_more_ && !(had_bad && knows_bad(first, size)))
                              std::copy_n(values.data(), size, &quality_[first]);
                            else
                              for (std::size_t i = 0; i < size; ++i)
                                mine += judged(CellHandle(first + i), values[i]);
                          });
      block_worst_[block] = worst;
    }
    parts_[static_cast<std::size_t>(part)].totals = mine;
  });
  totals_ = {};
  for (const Part& part : parts_) totals_ += part.totals;
  has_bad_ = totals_.any;
  find_worst(false);
  return n;
}

/// The smallest of quality_, of blocks that are stale or of all.
void CellWatch::find_worst(bool in_all_blocks) {
  const std::size_t n = quality_.size(), n_blocks = (n + kBlock - 1) / kBlock;
  if (in_all_blocks) {
    block_worst_.resize(n_blocks);
    stale_.assign(n_blocks, 1);
  }
  par::Policy policy = policy_;
  if (!in_all_blocks) policy.serial_below *= 4;  // few are stale
  par::for_ranges(policy, n_blocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      if (!stale_[block]) continue;
      double worst = kNone;
      for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i)
        worst = std::min(worst, quality_[i]);
      block_worst_[block] = worst;
      stale_[block] = 0;
    }
  });
  worst_ = kNone;
  for (const double worst : block_worst_) worst_ = std::min(worst_, worst);
}

/// Cells that are to be looked at, in vectors.
class CellWatch::Batch {
 public:
  explicit Batch(CellWatch& watch) : watch_(watch) {}

  void add(CellHandle c) {
    cells_[size_++] = c;
    if (size_ == CornerBlock::kSize) look();
  }
  void look() {
    const TetMesh& mesh = watch_.mesh_;
    for (std::size_t i = 0; i < size_; ++i) {
      const auto& v = mesh.cell_vertices(cells_[i]);
      block_.set(i, mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
    }
    block_decisions(MinDihedral{}, block_, values_);
    for (std::size_t i = 0; i < size_; ++i) watch_.take(cells_[i], values_[i], found_.totals);
    found_.n_cells += size_;
    size_ = 0;
  }
  const Part& found() const { return found_; }

 private:
  CellWatch& watch_;
  CornerBlock block_;
  CornerBlock::Lane values_{};
  std::array<CellHandle, CornerBlock::kSize> cells_;
  std::size_t size_ = 0;
  Part found_;
};

/// look(i, batch) adds cells for each i in [0, n), each cell once in all.
void CellWatch::look_in_parts(std::size_t n, double nanoseconds, const auto& look) {
  find_indicator_field();
  const int n_parts = par::thread_count(policy_.for_items_of(nanoseconds), n);
  parts_.assign(static_cast<std::size_t>(n_parts), {});
  par::parts(n_parts, [&](int part) {
    Batch batch(*this);
    const std::size_t end = par::part_begin(n, n_parts, part + 1);
    for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) look(i, batch);
    batch.look();
    parts_[static_cast<std::size_t>(part)] = batch.found();
  });
  for (const Part& part : parts_) totals_.change({}, part.totals);
  has_bad_ = has_bad_ || totals_.any;
}

void CellWatch::look_at(std::span<const CellHandle> cells) {
  look_in_parts(cells.size(), kNanosecondsACell, [&](std::size_t i, Batch& batch) { batch.add(cells[i]); });
}

/// Of a cell that was counted as what it was.
void CellWatch::take(CellHandle c, double value, Totals& changes) {
  const std::size_t i = c.idx();
  const double block_worst = block_worst_[i / kBlock];
  if (value < block_worst || quality_[i] <= block_worst) {
    par::before_shared_access();
    par::atomic(stale_[i / kBlock]).store(1, std::memory_order_relaxed);
  }
  if (stays_good(c, value)) {
    quality_[i] = value;
    return;
  }
  const Totals was = totals_of(c);
  update(c, value);
  changes.change(was, totals_of(c));
}

std::size_t CellWatch::look_at_cells_of(const MovedVertices& moved) {
  const std::span<const VertexHandle> vertices = moved.list();
  look_in_parts(vertices.size(), kNanosecondsAStar, [&](std::size_t i, Batch& batch) {
    const VertexHandle v = vertices[i];
    if (i + kAhead < vertices.size()) {
      const CellHandle next = mesh_.incident_cell(vertices[i + kAhead]);
      if (next.is_valid()) __builtin_prefetch(&mesh_.cell(next));
    }
    // A cell with several of them is looked at from the smallest.
    const auto add = [&](CellHandle c) {
      for (const VertexHandle w : mesh_.cell_vertices(c))
        if (w < v && moved.has(w)) return;
      batch.add(c);
    };
    Star star;
    if (mesh_.gather_star(v, star))
      for (int k = 0; k < star.size; ++k) add(star.cells[static_cast<std::size_t>(k)]);
    else if (mesh_.incident_cell(v).is_valid())
      for (CellHandle c : mesh_.vertex_cells(v)) add(c);
  });
  find_worst(false);
  std::size_t n = 0;
  for (const Part& part : parts_) n += part.n_cells;
  return n;
}

void CellWatch::follow(const Edits& edits, bool was_cut_short) {
  const std::size_t n = mesh_.n_cells();
  carry(quality_, edits.maps.old_cells, 0.0);
  carry(bad_, edits.maps.old_cells, std::uint8_t{0});
  carry(rest_volume_, edits.maps.old_cells, 0.0);
  if (!rest_volume_.empty())
    for (const CreatedCell& c : edits.created_cells) rest_volume_[c.cell.idx()] = volume(mesh_, c.cell);
  if (has_excused_) forget_excuses();
  excused_.resize(n, 0);
  left_.resize(n, kNever);
  totals_ = {};
  has_bad_ = true;
  for_bad([&](CellHandle c) { totals_ += totals_of(c); });
  cells_ = edits.moved_cells;
  for (const CreatedCell& c : edits.created_cells) cells_.push_back(c.cell);
  block_worst_.assign((n + kBlock - 1) / kBlock, kNone);
  stale_.assign(block_worst_.size(), 1);
  look_at(cells_);
  find_worst(true);
  has_bad_ = std::any_of(bad_.begin(), bad_.end(), [](std::uint8_t bits) { return bits != 0; });
  if (!was_cut_short) excuse();
}

template <class Visit>
void CellWatch::for_bad(Visit&& visit) const {
  for (std::size_t i = 0; i < bad_.size(); ++i)
    if (bad_[i] != 0) visit(CellHandle(i));
}

void CellWatch::excuse() {
  if (totals_.active == 0) return;
  totals_ = {};
  has_excused_ = true;
  for_bad([&](CellHandle c) {
    const std::size_t i = c.idx();
    excused_[i] = static_cast<std::uint8_t>(bad_[i] & ~static_cast<unsigned>(kIsInverted));
    left_[i] = quality_[i];
    totals_ += totals_of(c);
  });
}

std::optional<Survey> CellWatch::survey() const {
  constexpr double kSurelyPositive = 1e-30;  // sin²: far from where the test of volumes is in doubt
  if (!(worst_ > kSurelyPositive)) return {};
  return Survey{worst_, 0};
}

RepairCause CellWatch::cause() const {
  constexpr std::array<RepairCause, kReasons> kInOrder = {
      // of Bad
      RepairCause::kInverted, RepairCause::kAngle, RepairCause::kMetric, RepairCause::kJacobian,
      RepairCause::kIndicator};
  for (std::size_t i = 0; i < kReasons; ++i)
    if (totals_.active_by[i] > 0) return kInOrder[i];
  return RepairCause::kNone;
}

std::vector<CellHandle> CellWatch::inverted() const {
  std::vector<CellHandle> cells;
  for (std::size_t i = 0; i < quality_.size(); ++i)
    if (!(quality_[i] > 0)) cells.push_back(CellHandle(i));
  return cells;
}

double CellWatch::min_dihedral() const {
  return report_value(Metric::kMinDihedral, std::min(kRegularDihedral, worst_));
}

}  // namespace hfr
