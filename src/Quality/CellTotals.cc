// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/CellTotals.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

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

// The six dihedrals of a cell as complex numbers on a common scale.
struct Angles {
  std::array<double, 6> cosine;  ///< normalised
  std::array<double, 6> sine;
};

Angles angles_of(const hfr_tet_frame& f) {
  const double r0 = 1.0 / std::sqrt(f.q0);
  const double r1 = 1.0 / std::sqrt(f.q1);
  const double r2 = 1.0 / std::sqrt(f.q2);
  const double r3 = 1.0 / std::sqrt(f.q3);
  Angles a;
  const auto set = [&](std::size_t edge, hfr_cos_sin angle, double scale) {
    a.cosine[edge] = angle.cosine * scale;
    a.sine[edge] = angle.sine * scale;
  };
  set(0, hfr_dihedral_cos_sin(f, 0), r2 * r3);
  set(1, hfr_dihedral_cos_sin(f, 1), r1 * r3);
  set(2, hfr_dihedral_cos_sin(f, 2), r1 * r2);
  set(3, hfr_dihedral_cos_sin(f, 3), r0 * r3);
  set(4, hfr_dihedral_cos_sin(f, 4), r0 * r2);
  set(5, hfr_dihedral_cos_sin(f, 5), r0 * r1);
  return a;
}

// Sum of the dihedrals of a positive cell in radians. It lies between 2π and 3π (Gaddum 1952), so the
// argument of the product of the six unit numbers tells it: one arc tangent instead of six.
double angle_sum(const Angles& a) {
  double re = 1.0;
  double im = 0.0;
  for (std::size_t edge = 0; edge < 6; ++edge) {
    const double next = re * a.cosine[edge] - im * a.sine[edge];
    im = re * a.sine[edge] + im * a.cosine[edge];
    re = next;
  }
  double angle = std::atan2(im, re);
  // rounding can carry a sum next to 2π or 3π over the cut
  if (angle < -0.5 * kPi) angle += 2.0 * kPi;
  return 2.0 * kPi + angle;
}

class CellPass {
 public:
  CellPass(const TetMesh& mesh, const AngleBins& bins, CellTotals& totals)
      : mesh_(mesh), bins_(bins), totals_(totals) {}

  void visit(CellHandle c, double& min_dihedral, double& volume_length) {
    const Cell& cell = mesh_.cell(c);
    const hfr_real3 p0 = to_real3(mesh_.point(cell.v[0]));
    const hfr_real3 p1 = to_real3(mesh_.point(cell.v[1]));
    const hfr_real3 p2 = to_real3(mesh_.point(cell.v[2]));
    const hfr_real3 p3 = to_real3(mesh_.point(cell.v[3]));
    const hfr_tet_frame frame = hfr_make_frame(p0, p1, p2, p3);
    min_dihedral = hfr_min_dihedral_of(frame);
    volume_length = hfr_volume_length_decision(p0, p1, p2, p3);
    ++totals_.cells;
    count_faces(c, cell);
    add_region(c, frame.det, min_dihedral);
    add_lengths(frame);
    totals_.det.add(frame.det);
    totals_.absolute_det.add(std::abs(frame.det));
    if (min_dihedral < totals_.min_decision || !totals_.worst_cell.is_valid()) {
      totals_.min_decision = min_dihedral;
      totals_.worst_cell = c;
    }
    const double q = hfr_volume_length_report(volume_length);
    totals_.volume_length.add(q);
    if (frame.det < 0.0) totals_.inverted.push_back(c);
    if (frame.det == 0.0) totals_.flat.push_back(c);
    if (frame.det >= 0.0)
      ++totals_.volume_length_histogram[std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * q))];
    if (min_dihedral > 0.0)
      add_angles(frame, min_dihedral);
    else
      add_angles_one_by_one(frame, min_dihedral);
  }

 private:
  void count_faces(CellHandle c, const Cell& cell) {
    for (const HalfFaceHandle m : cell.mate) {
      if (!m.is_valid())
        ++totals_.boundary_faces;
      else if (mesh_.has_regions() && mesh_.region(cell_of(m)) != mesh_.region(c))
        ++totals_.interface_halffaces;
    }
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

  void add_lengths(const hfr_tet_frame& f) {
    const double low = std::min({f.l01, f.l02, f.l03, f.l12, f.l13, f.l23});
    const double high = std::max({f.l01, f.l02, f.l03, f.l12, f.l13, f.l23});
    totals_.min_length2 = totals_.cells == 1 ? low : std::min(totals_.min_length2, low);
    totals_.max_length2 = std::max(totals_.max_length2, high);
    totals_.lengths.add(((std::sqrt(f.l01) + std::sqrt(f.l02)) + (std::sqrt(f.l03) + std::sqrt(f.l12))) +
                        (std::sqrt(f.l13) + std::sqrt(f.l23)));
  }

  void add_angles(const hfr_tet_frame& frame, double min_dihedral) {
    const Angles angles = angles_of(frame);
    for (const double cosine : angles.cosine) ++totals_.dihedral_histogram[bins_(cosine)];
    totals_.angles.add(angle_sum(angles));
    totals_.min_angles.add(std::asin(std::sqrt(std::min(min_dihedral, 1.0))));
    totals_.max_decision = std::min(totals_.max_decision, hfr_max_dihedral_of(frame));
  }

  // Flat, inverted or so small that squares underflow: nothing may be divided by.
  void add_angles_one_by_one(const hfr_tet_frame& frame, double min_dihedral) {
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
  CellTotals& totals_;
  const FixedSum empty_det_ = totals_.det;
  RegionTotals* region_ = nullptr;
  int region_number_ = 0;
};

}  // namespace

CellTotals::CellTotals(double max_det, double max_length)
    : det(max_det),
      absolute_det(max_det),
      angles(32.0),
      min_angles(4.0),
      volume_length(2.0),
      lengths(8.0 * max_length) {}

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
  inverted.insert(inverted.end(), next.inverted.begin(), next.inverted.end());
  flat.insert(flat.end(), next.flat.begin(), next.flat.end());
  for (std::size_t i = 0; i < dihedral_histogram.size(); ++i)
    dihedral_histogram[i] += next.dihedral_histogram[i];
  for (std::size_t i = 0; i < volume_length_histogram.size(); ++i)
    volume_length_histogram[i] += next.volume_length_histogram[i];
  det.add(next.det);
  absolute_det.add(next.absolute_det);
  angles.add(next.angles);
  min_angles.add(next.min_angles);
  volume_length.add(next.volume_length);
  lengths.add(next.lengths);
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
  const int n_parts = par::thread_count(policy, n);
  std::vector<CellTotals> totals(static_cast<std::size_t>(n_parts), CellTotals(max_det, max_length));
  par::parts(n_parts, [&](int part) {
    CellPass pass(mesh, bins, totals[static_cast<std::size_t>(part)]);
    const std::size_t end = par::part_begin(n, n_parts, part + 1);
    for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i)
      if (!mesh.is_deleted(CellHandle(i)))
        pass.visit(CellHandle(i), values.min_dihedral[i], values.volume_length[i]);
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

double boundary_determinant(const TetMesh& mesh, par::Policy policy, Vec3 centre, double max_det) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<FixedSum> sums(static_cast<std::size_t>(n_parts), FixedSum(max_det));
  par::parts(n_parts, [&](int part) {
    FixedSum mine(max_det);
    const std::size_t end = par::part_begin(n, n_parts, part + 1);
    for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) {
      const CellHandle c(i);
      if (mesh.is_deleted(c)) continue;
      for (int corner = 0; corner < 4; ++corner) {
        const HalfFaceHandle h = halfface_of(c, corner);
        if (mesh.opposite_halfface(h).is_valid()) continue;
        const auto [x, y, z] = mesh.halfface_vertices(h);
        // (x, y, z, opposite corner) is positive, so from outside the face turns the other way
        mine.add(hfr_orient6(to_real3(centre), to_real3(mesh.point(x)), to_real3(mesh.point(z)),
                             to_real3(mesh.point(y))));
      }
    }
    sums[static_cast<std::size_t>(part)] = mine;
  });
  FixedSum all(max_det);
  for (const FixedSum& part : sums) all.add(part);
  return all.value();
}

}  // namespace hfr::detail
