// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartWatch.hh"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "Distributed/OwnItems.hh"
#include "HalfFace/Geometry.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Strategy.hh"

namespace hfr::mpi {

PartWatch::PartWatch(const RepairTriggers& triggers, par::Policy policy)
    : triggers_(triggers),
      policy_(policy),
      trigger_(triggers.min_dihedral > 0 ? dihedral_decision(triggers.min_dihedral)
                                         : -std::numeric_limits<double>::infinity()) {}

void PartWatch::set_rest_volumes(const DistributedMesh& mesh, std::span<const double> volumes) {
  if (triggers_.jacobian_ratio <= 0) return;
  rest_volume_.assign(mesh.part().n_cells(), 0.0);
  const std::vector<CellHandle> cells = own_cells(mesh);
  for (std::size_t i = 0; i < cells.size(); ++i) rest_volume_[cells[i].idx()] = volumes[i];
}

void PartWatch::look(DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  bad_.clear();
  double worst = std::numeric_limits<double>::infinity();
  const int n_parts = par::thread_count(policy_, part.n_cells());
  std::vector<Found> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int p) {
    Found mine;
    for_decisions(part, MinDihedral{}, par::part_begin(part.n_cells(), n_parts, p),
                  par::part_begin(part.n_cells(), n_parts, p + 1), [&](std::size_t i, double value) {
                    const CellHandle c(i);
                    if (part.is_deleted(c) || !mesh.is_own(c)) return;
                    mine.worst = std::min(mine.worst, value);
                    if (const unsigned bits = badness(part, c, value); bits != 0)
                      mine.bad.push_back({c, value, bits});
                  });
    found[static_cast<std::size_t>(p)] = std::move(mine);
  });
  for (Found& one : found) {
    worst = std::min(worst, one.worst);
    bad_.insert(bad_.end(), one.bad.begin(), one.bad.end());
  }
  for (auto& one : excused_) narrow(one.first, one.second);
  std::erase_if(excused_, [](const auto& one) { return one.second.bits == 0; });
  // Inverted; and what calls for a repair: by an inversion, angle, metric, volume.
  std::array<std::uint64_t, 5> sums{};
  for (const Bad& one : bad_) {
    const auto excuse = excused_.find(one.cell);
    const unsigned active = excuse == excused_.end() ? one.bits : one.bits & ~excuse->second.bits;
    sums[0] += (one.bits & kIsInverted) != 0 ? 1 : 0;
    sums[1] += (active & kIsInverted) != 0 && triggers_.inverted ? 1 : 0;
    sums[2] += (active & kIsBelow) != 0 ? 1 : 0;
    sums[3] += (active & kHasMetric) != 0 ? 1 : 0;
    sums[4] += (active & kIsSqueezed) != 0 ? 1 : 0;
  }
  worst_ = mesh.comm().sum_and_min(sums, worst);
  n_inverted_ = sums[0];
  cause_ = sums[1] > 0   ? RepairCause::kInverted
           : sums[2] > 0 ? RepairCause::kAngle
           : sums[3] > 0 ? RepairCause::kMetric
           : sums[4] > 0 ? RepairCause::kJacobian
                         : RepairCause::kNone;
}

void PartWatch::follow(DistributedMesh& mesh, bool was_cut_short) {
  excused_.clear();
  look(mesh);
  if (was_cut_short || cause_ == RepairCause::kNone) return;
  for (const Bad& one : bad_)
    if (const unsigned bits = one.bits & ~static_cast<unsigned>(kIsInverted); bits != 0)
      excused_[one.cell] = {bits, one.value};
  look(mesh);
}

std::uint64_t PartWatch::count_inverted(const DistributedMesh& mesh) {
  const TetMesh& part = mesh.part();
  std::uint64_t n = 0;
  for_decisions(part, MinDihedral{}, 0, part.n_cells(), [&](std::size_t i, double value) {
    const CellHandle c(i);
    n += !(value > 0) && !part.is_deleted(c) && mesh.is_own(c) ? 1 : 0;
  });
  return mesh.comm().sum(n);
}

double PartWatch::min_dihedral() const {
  return report_value(Metric::kMinDihedral, std::min(kRegularDihedral, worst_));
}

std::vector<std::uint64_t> PartWatch::inverted(const DistributedMesh& mesh) const {
  std::vector<std::uint64_t> numbers;
  for (const Bad& one : bad_)
    if ((one.bits & kIsInverted) != 0) numbers.push_back(mesh.number(one.cell));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

unsigned PartWatch::badness(const TetMesh& part, CellHandle c, double value) const {
  unsigned bits = 0;
  if (!(value > 0)) bits |= kIsInverted;
  if (value < trigger_) bits |= kIsBelow;
  const auto& v = part.cell(c).v;
  for (const auto& [metric, bound] : triggers_.metrics) {
    const double q =
        reported_quality(metric, part.point(v[0]), part.point(v[1]), part.point(v[2]), part.point(v[3]));
    if (metric == Metric::kMaxDihedral ? q > bound : q < bound) bits |= kHasMetric;
  }
  if (triggers_.jacobian_ratio > 0 && volume(part, c) < triggers_.jacobian_ratio * rest_volume_[c.idx()])
    bits |= kIsSqueezed;
  return bits;
}

/// Takes out of the excuse what it does not hold for any more.
void PartWatch::narrow(CellHandle c, Excuse& excuse) const {
  const auto at = std::ranges::lower_bound(bad_, c, {}, &Bad::cell);
  excuse.bits &= at != bad_.end() && at->cell == c ? at->bits : 0U;
  if (excuse.bits != 0 && kStepEffort.is_much_worse(at->value, excuse.left)) excuse.bits = 0;
}

}  // namespace hfr::mpi
