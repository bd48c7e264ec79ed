// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/CellTotals.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "Quality/CellBlock.hh"
#include "Quality/Metrics.hh"

namespace hfr::detail {
namespace {

constexpr double kPi = std::numbers::pi;

// Bin of an angle by its cosine, without an arc cosine: a guess from a table, then at most a few steps along
// the thresholds. Angles within 1e-10 degrees below a threshold go to the bin above it, so that the right
// angles of regular meshes do not scatter.
class AngleBins {
 public:
  static constexpr int kBins = 36;

  AngleBins() {
    for (int i = 0; i <= kBins; ++i)
      threshold_[static_cast<std::size_t>(i)] = std::cos(kPi * (5.0 * i - 1e-10) / 180.0);
    threshold_[0] = 2.0;
    threshold_[kBins] = -2.0;
    for (int i = 0; i < kSteps; ++i) guess_[static_cast<std::size_t>(i)] = walk(0, 1.0 - 2.0 * i / kSteps);
  }

  /// NaN goes to bin 0.
  std::size_t operator()(double cosine) const {
    const double at = 0.5 * kSteps * (1.0 - std::clamp(cosine, -1.0, 1.0));
    const auto step = at >= 0.0 ? std::min<std::size_t>(static_cast<std::size_t>(at), kSteps - 1) : 0U;
    return walk(guess_[step], cosine);
  }

 private:
  static constexpr int kSteps = 1024;

  std::size_t walk(std::size_t bin, double cosine) const {
    while (cosine <= threshold_[bin + 1]) ++bin;
    return bin;
  }

  std::array<double, kBins + 1> threshold_{};
  std::array<std::size_t, kSteps> guess_{};
};

// Bin of a cell's smallest dihedral by its decision value, which is sin²: the whole degrees that the cell
// does not miss as a goal. The guess is the bin of the step's lower end.
class SmallestAngleBins {
 public:
  static constexpr std::size_t kBins = 71;  // the regular cell has 70.53 degrees

  SmallestAngleBins() {
    for (std::size_t i = 1; i < kBins; ++i) threshold_[i] = dihedral_decision(static_cast<double>(i));
    threshold_[kBins] = 2.0;
    for (std::size_t i = 0; i < kSteps; ++i) guess_[i] = walk(0, static_cast<double>(i) / kSteps);
  }

  /// Whatever is not positive, and NaN, goes to bin 0.
  std::size_t operator()(double decision) const {
    if (!(decision > 0.0)) return 0;
    const auto step = static_cast<std::size_t>(kSteps * std::min(decision, 1.0));
    return walk(guess_[std::min(step, kSteps - 1)], decision);
  }

 private:
  static constexpr std::size_t kSteps = 1024;

  std::size_t walk(std::size_t bin, double decision) const {
    while (decision >= threshold_[bin + 1]) ++bin;
    return bin;
  }

  std::array<double, kBins + 1> threshold_{};
  std::array<std::size_t, kSteps> guess_{};
};

// Gathers cells into blocks and adds up what comes out.
class CellPass {
 public:
  /// `held`: 1 for the vertices of labelled and of fixed faces; empty where there are none.
  CellPass(const TetMesh& mesh, const AngleBins& bins, const SmallestAngleBins& smallest_bins,
           std::span<const std::uint8_t> held, CellValues& values, CellTotals& totals)
      : mesh_(mesh),
        bins_(bins),
        smallest_bins_(smallest_bins),
        held_(held),
        values_(values),
        totals_(totals) {}

  void visit(CellHandle c) {
    const Cell& cell = mesh_.cell(c);
    for (std::size_t corner = 0; corner < 4; ++corner)
      block_.set_corner(corner, in_block_, mesh_.point(cell.v[corner]));
    cells_[in_block_] = c;
    count_faces(c, cell);
    if (++in_block_ == CellBlock::kSize) finish_block();
  }

  void finish_block() {
    if (in_block_ == 0) return;
    evaluate(block_);
    for (std::size_t i = 0; i < in_block_; ++i) add(i);
    in_block_ = 0;
  }

 private:
  void add(std::size_t i) {
    const CellHandle c = cells_[i];
    const double det = block_.det[i];
    const double min_dihedral = block_.min_dihedral[i];
    values_.min_dihedral[c.idx()] = min_dihedral;
    values_.volume_length[c.idx()] = block_.volume_length[i];
    ++totals_.cells;
    add_region(c, det, min_dihedral);
    totals_.min_length2 =
        totals_.cells == 1 ? block_.min_length2[i] : std::min(totals_.min_length2, block_.min_length2[i]);
    totals_.max_length2 = std::max(totals_.max_length2, block_.max_length2[i]);
    totals_.lengths.add(block_.length_sum[i]);
    for (const CellBlock::Lane& length2 : block_.length2) totals_.length_bins.add(length2[i]);
    if (min_dihedral < totals_.min_decision || !totals_.worst_cell.is_valid()) {
      totals_.min_decision = min_dihedral;
      totals_.worst_cell = c;
    }
    const double q = block_.q[i];
    totals_.volume_length.add(q);
    if (det < 0.0) {
      totals_.inverted.push_back(c);
      totals_.negative_det.add(det);
    } else {
      ++totals_.volume_length_histogram[std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * q))];
      ++totals_.min_dihedral_histogram[smallest_bins_(min_dihedral)];
    }
    if (det == 0.0) totals_.flat.push_back(c);
    if (min_dihedral > 0.0)
      add_angles(i);
    else
      add_angles_one_by_one(c, min_dihedral);
  }

  void count_faces(CellHandle c, const Cell& cell) {
    for (int corner = 0; corner < 4; ++corner) {
      const HalfFaceHandle h = halfface_of(c, corner);
      const HalfFaceHandle m = cell.mate[static_cast<std::size_t>(corner)];
      const bool is_boundary = !m.is_valid();
      const bool is_interface = !is_boundary && has_regions_ && mesh_.region(cell_of(m)) != mesh_.region(c);
      totals_.boundary_faces += is_boundary ? 1 : 0;
      totals_.interface_halffaces += is_interface ? 1 : 0;
      if (is_boundary || is_interface || (may_be_held(h) && mesh_.is_constrained(h)))
        totals_.constrained.push_back(h);
    }
  }

  /// False for nearly all faces inside, without a look at what is labelled or fixed.
  bool may_be_held(HalfFaceHandle h) const {
    if (held_.empty()) return false;
    const auto f = mesh_.halfface_vertices(h);
    return held_[f[0].idx()] && held_[f[1].idx()] && held_[f[2].idx()];
  }

  void add_region(CellHandle c, double det, double min_dihedral) {
    const int region = mesh_.region(c);
    if (region_ == nullptr || region != region_number_) {
      const auto [at, is_new] = totals_.regions.try_emplace(region);
      if (is_new) at->second.det = empty_det_;
      region_ = &at->second;
      region_number_ = region;
    }
    ++region_->cells;
    region_->inverted += det < 0.0;
    region_->flat += det == 0.0;
    region_->det.add(det);
    region_->min_decision = std::min(region_->min_decision, min_dihedral);
  }

  void add_angles(std::size_t i) {
    for (const CellBlock::Lane& cosine : block_.cosine) ++totals_.dihedral_histogram[bins_(cosine[i])];
    totals_.angles.add(block_.angle_sum[i]);
    totals_.min_angles.add(block_.min_angle[i]);
    totals_.max_decision = std::min(totals_.max_decision, block_.max_dihedral[i]);
  }

  // Flat, inverted or so small that squares underflow: nothing may be divided by.
  void add_angles_one_by_one(CellHandle c, double min_dihedral) {
    const Cell& cell = mesh_.cell(c);
    const auto point = [&](std::size_t corner) { return to_real3(mesh_.point(cell.v[corner])); };
    const hfr_tet_frame frame = hfr_make_frame(point(0), point(1), point(2), point(3));
    double sum = 0.0;
    for (int edge = 0; edge < 6; ++edge) {
      const hfr_cos_sin angle = hfr_dihedral_cos_sin(frame, edge);
      const double radians = std::atan2(angle.sine, angle.cosine);
      sum += radians;
      if (frame.det >= 0.0) ++totals_.dihedral_histogram[bins_(std::cos(radians))];
    }
    totals_.angles.add(sum);
    totals_.min_angles.add(-std::asin(std::sqrt(std::min(-min_dihedral, 1.0))));
    if (frame.det == 0.0) totals_.max_decision = 0.0;
  }

  const TetMesh& mesh_;
  const AngleBins& bins_;
  const SmallestAngleBins& smallest_bins_;
  const std::span<const std::uint8_t> held_;
  CellValues& values_;
  CellTotals& totals_;
  CellBlock block_;
  std::array<CellHandle, CellBlock::kSize> cells_;
  std::size_t in_block_ = 0;
  const bool has_regions_ = mesh_.has_regions();
  const bool has_inner_constraints_ = has_regions_ || !mesh_.labels().faces.empty() || !mesh_.locks().empty();
  const FixedSum empty_det_ = totals_.negative_det;
  RegionTotals* region_ = nullptr;
  int region_number_ = 0;
};

std::vector<std::uint8_t> vertices_of_held_faces(const TetMesh& mesh) {
  std::vector<std::uint8_t> held;
  const auto mark = [&](const auto& entries) {
    if (!entries.empty()) held.resize(mesh.n_vertices(), 0);
    for (const auto& entry : entries)
      for (const VertexHandle v : entry.vertices) held[v.idx()] = 1;
  };
  mark(mesh.labels().faces.entries());
  mark(mesh.locks().faces.entries());
  return held;
}

}  // namespace

CellTotals::CellTotals(double max_det, double max_length)
    : negative_det(max_det),
      angles(32.0),
      min_angles(4.0),
      volume_length(2.0),
      lengths(8.0 * max_length),
      length_bins(max_length) {}

void CellTotals::merge(const CellTotals& next) {
  if (next.cells == 0) return;
  min_length2 = cells == 0 ? next.min_length2 : std::min(min_length2, next.min_length2);
  max_length2 = std::max(max_length2, next.max_length2);
  if (cells == 0 || next.min_decision < min_decision) worst_cell = next.worst_cell;
  min_decision = std::min(min_decision, next.min_decision);
  max_decision = std::min(max_decision, next.max_decision);
  cells += next.cells;
  boundary_faces += next.boundary_faces;
  interface_halffaces += next.interface_halffaces;
  constrained.insert(constrained.end(), next.constrained.begin(), next.constrained.end());
  inverted.insert(inverted.end(), next.inverted.begin(), next.inverted.end());
  flat.insert(flat.end(), next.flat.begin(), next.flat.end());
  for (std::size_t i = 0; i < dihedral_histogram.size(); ++i)
    dihedral_histogram[i] += next.dihedral_histogram[i];
  for (std::size_t i = 0; i < min_dihedral_histogram.size(); ++i)
    min_dihedral_histogram[i] += next.min_dihedral_histogram[i];
  for (std::size_t i = 0; i < volume_length_histogram.size(); ++i)
    volume_length_histogram[i] += next.volume_length_histogram[i];
  negative_det.add(next.negative_det);
  angles.add(next.angles);
  min_angles.add(next.min_angles);
  volume_length.add(next.volume_length);
  lengths.add(next.lengths);
  length_bins.add(next.length_bins);
  for (const auto& [region, theirs] : next.regions) {
    const auto [at, is_new] = regions.try_emplace(region, theirs);
    if (is_new) continue;
    at->second.cells += theirs.cells;
    at->second.inverted += theirs.inverted;
    at->second.flat += theirs.flat;
    at->second.det.add(theirs.det);
    at->second.min_decision = std::min(at->second.min_decision, theirs.min_decision);
  }
}

CellTotals gather_cells(const TetMesh& mesh, par::Policy policy, double max_det, double max_length,
                        CellValues& values) {
  const std::size_t n = mesh.n_cells();
  values.min_dihedral.resize(n);
  values.volume_length.resize(n);
  const AngleBins bins;
  const SmallestAngleBins smallest_bins;
  const std::vector<std::uint8_t> held = vertices_of_held_faces(mesh);
  const int n_parts = par::thread_count(policy, n);
  std::vector<CellTotals> totals(static_cast<std::size_t>(n_parts), CellTotals(max_det, max_length));
  par::parts(n_parts, [&](int part) {
    CellPass pass(mesh, bins, smallest_bins, held, values, totals[static_cast<std::size_t>(part)]);
    const std::size_t end = par::part_begin(n, n_parts, part + 1);
    for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i)
      if (!mesh.is_deleted(CellHandle(i))) pass.visit(CellHandle(i));
    pass.finish_block();
  });
  CellTotals all(max_det, max_length);
  for (const CellTotals& part : totals) all.merge(part);
  if (all.cells == n) return all;
  std::size_t live = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (mesh.is_deleted(CellHandle(i))) continue;
    values.min_dihedral[live] = values.min_dihedral[i];
    values.volume_length[live++] = values.volume_length[i];
  }
  values.min_dihedral.resize(live);
  values.volume_length.resize(live);
  return all;
}

/// Adds a·b·c to twice the precision of a double: faces far from the centre cancel nearly all of it.
static void add_product(double a, double b, double c, FixedSum& sum) {
  const double high = a * b, low = std::fma(a, b, -high);
  const double product = high * c;
  sum.add(product);
  sum.add(std::fma(high, c, -product) + low * c);
}

/// Vertices are rounded to the centre once, each for all of its faces, so a closed surface stays closed.
double boundary_determinant(const TetMesh& mesh, std::span<const HalfFaceHandle> faces, Vec3 centre,
                            double max_det) {
  FixedSum sum(max_det);
  for (const HalfFaceHandle h : faces) {
    if (mesh.opposite_halfface(h).is_valid()) continue;
    const auto [x, y, z] = mesh.halfface_vertices(h);
    // (x, y, z, opposite corner) is positive, so from outside the face turns the other way
    const Vec3 p = mesh.point(x) - centre, q = mesh.point(z) - centre, r = mesh.point(y) - centre;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      add_product(p[i], q[j], r[k], sum);
      add_product(-p[i], q[k], r[j], sum);
    }
  }
  return sum.value();
}

}  // namespace hfr::detail
