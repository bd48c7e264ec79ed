// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/CellWatch.hh"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include "HalfFace/Errors.hh"
#include "HalfFace/Geometry.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

// Where fewer vertices than 1 in so many have moved, their cells are gathered; else all are looked at.
constexpr std::size_t kManyMoved = 4;

constexpr double kNever = -std::numeric_limits<double>::infinity();

}  // namespace

CellWatch::CellWatch(const TetMesh& mesh, const RepairTriggers& triggers, par::Policy policy)
    : mesh_(mesh),
      triggers_(triggers),
      policy_(policy),
      trigger_(triggers.min_dihedral > 0 ? dihedral_decision(triggers.min_dihedral) : kNever),
      asks_more_(!triggers.metrics.empty() || triggers.jacobian_ratio > 0 || triggers.indicator ||
                 !triggers.indicator_field.empty()) {}

void CellWatch::forget_looks() {
  const std::size_t n = mesh_.n_cells();
  quality_.assign(n, 0.0);
  bad_.assign(n, 0);
  has_bad_ = true;
  stamp_.assign(n, 0);
  stamp_now_ = 0;
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
  if (value < kStepEffort.much_worse * left_[i]) excused &= ~static_cast<unsigned>(kIsBelow);
  excused_[i] = static_cast<std::uint8_t>(excused);
}

CellWatch::Totals CellWatch::totals_of(CellHandle c) const {
  const std::uint8_t bits = bad_[c.idx()];
  unsigned active = bits & ~static_cast<unsigned>(excused_[c.idx()]);
  if (!triggers_.inverted) active &= ~static_cast<unsigned>(kIsInverted);
  return {static_cast<std::size_t>(active != 0 ? 1 : 0), static_cast<std::size_t>(bits & kIsInverted ? 1 : 0),
          static_cast<std::uint8_t>(active), bits != 0};
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

void CellWatch::look_at_all() {
  find_indicator_field();
  const std::size_t n = mesh_.n_cells();
  const int n_parts = par::thread_count(policy_, n);
  partial_.assign(static_cast<std::size_t>(n_parts), {});
  const bool had_bad = has_bad_;
  par::parts(n_parts, [&](int part) {
    Totals mine;
    for_decisions(mesh_, MinDihedral{}, par::part_begin(n, n_parts, part),
                  par::part_begin(n, n_parts, part + 1), [&](std::size_t i, double value) {
                    if (had_bad ? stays_good(CellHandle(i), value) : is_plainly_good(value)) {
                      quality_[i] = value;
                      return;
                    }
                    update(CellHandle(i), value);
                    mine += totals_of(CellHandle(i));
                  });
    partial_[static_cast<std::size_t>(part)] = mine;
  });
  totals_ = {};
  for (const Totals& part : partial_) totals_ += part;
  has_bad_ = totals_.any;
}

void CellWatch::look_at(std::span<const CellHandle> cells) {
  find_indicator_field();
  CornerBlock block;
  CornerBlock::Lane values{};
  for (std::size_t first = 0; first < cells.size(); first += CornerBlock::kSize) {
    const auto some = cells.subspan(first, std::min(CornerBlock::kSize, cells.size() - first));
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto& v = mesh_.cell_vertices(some[i]);
      block.set(i, mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
    }
    block_decisions(MinDihedral{}, block, values);
    for (std::size_t i = 0; i < some.size(); ++i) take(some[i], values[i]);
  }
  if (totals_.active == 0) totals_.bits = 0;
}

/// Of a cell that was counted as what it was.
void CellWatch::take(CellHandle c, double value) {
  if (stays_good(c, value)) {
    quality_[c.idx()] = value;
    return;
  }
  const Totals was = totals_of(c);
  update(c, value);
  has_bad_ = has_bad_ || bad_[c.idx()] != 0;
  const Totals is = totals_of(c);
  totals_.active += is.active - was.active;
  totals_.inverted += is.inverted - was.inverted;
  totals_.bits |= is.bits;
}

std::size_t CellWatch::look_at_cells_of(std::span<const VertexHandle> vertices) {
  if (vertices.size() * kManyMoved >= mesh_.n_vertices()) {
    look_at_all();
    return mesh_.n_cells();
  }
  if (++stamp_now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0U);
    stamp_now_ = 1;
  }
  cells_.clear();
  Star star;
  const auto add = [&](CellHandle c) {
    if (stamp_[c.idx()] == stamp_now_) return;
    stamp_[c.idx()] = stamp_now_;
    cells_.push_back(c);
  };
  for (VertexHandle v : vertices) {
    if (mesh_.gather_star(v, star))
      for (int i = 0; i < star.size; ++i) add(star.cells[static_cast<std::size_t>(i)]);
    else if (mesh_.incident_cell(v).is_valid())
      for (CellHandle c : mesh_.vertex_cells(v)) add(c);
  }
  look_at(cells_);
  return cells_.size();
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
  stamp_.resize(n, 0);  // an old stamp is no more than another cell's old one
  totals_ = {};
  has_bad_ = true;
  for_bad([&](CellHandle c) { totals_ += totals_of(c); });
  cells_ = edits.moved_cells;
  for (const CreatedCell& c : edits.created_cells) cells_.push_back(c.cell);
  look_at(cells_);
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
  double worst = std::numeric_limits<double>::infinity();
  for (const double q : quality_) worst = std::min(worst, q);
  if (!(worst > kSurelyPositive)) return {};
  return Survey{worst, 0};
}

RepairCause CellWatch::cause() const {
  if (totals_.active == 0) return RepairCause::kNone;
  if (totals_.bits & kIsInverted) return RepairCause::kInverted;
  if (totals_.bits & kIsBelow) return RepairCause::kAngle;
  if (totals_.bits & kHasMetric) return RepairCause::kMetric;
  if (totals_.bits & kIsSqueezed) return RepairCause::kJacobian;
  return RepairCause::kIndicator;
}

std::vector<CellHandle> CellWatch::inverted() const {
  std::vector<CellHandle> cells;
  for (std::size_t i = 0; i < quality_.size(); ++i)
    if (!(quality_[i] > 0)) cells.push_back(CellHandle(i));
  return cells;
}

double CellWatch::min_dihedral() const {
  double worst = kRegularDihedral;
  for (const double q : quality_) worst = std::min(worst, q);
  return report_value(Metric::kMinDihedral, worst);
}

}  // namespace hfr
