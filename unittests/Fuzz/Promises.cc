// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/Promises.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "Quality/Metrics.hh"
#include "Remesh/Strategy.hh"

namespace hfr::fuzz {
namespace {

constexpr double kAngleRounding = 1e-6;   // degrees
constexpr long double kRounding = 1e-9L;  // of sums of volumes that are compared
// docs/surface.md: what flat runs keep the volume to, and, as a share of the diagonal, how far from a plane a
// point may be that they take for one of it: a body not much thicker than that is mostly such distances.
constexpr long double kFlatVolume = 1e-12L;
constexpr long double kPlanar = 1e-13L;

class Judge {
 public:
  Judge(const RandomOptions& options, std::vector<Finding>& findings)
      : options_(options.improve), cancels_(options.cancel_at > 0), findings_(findings) {}

  template <class... Args>
  void find(const std::string& promise, fmt::format_string<Args...> text, Args&&... args) {
    findings_.push_back({promise, fmt::format(text, std::forward<Args>(args)...)});
  }

  void compare(const Measure& before, const Measure& after, const SurfaceReport& surface) {
    structure(before, after);
    validity(before, after);
    volumes(before, after, surface.bound);
    distance(before, surface);
    constraints(before, after);
    if (after.worst <= before.worst + kAngleRounding && after.p1 <= before.p1 + kAngleRounding &&
        after.inverted + after.flat >= before.inverted + before.flat &&
        below_goal(after) >= below_goal(before) &&
        worst_of_others(after) <= worst_of_others(before) + kAngleRounding &&
        after.cells > 2 * before.cells + 30)
      find("cells for nothing", "{} -> {} cells, worst {:.4f} -> {:.4f}, p1 {:.4f} -> {:.4f}", before.cells,
           after.cells, before.worst, after.worst, before.p1, after.p1);
  }

  void result(const TetMesh& mesh, const Result& result, bool same_bits) {
    const auto invalid = invalid_cells_of(mesh);
    if (result.invalid_cells != invalid)
      find("invalid_cells", "{} listed, {} counted", result.invalid_cells.size(), invalid.size());
    double worst = 90;
    for (CellHandle c : mesh.cells()) {
      const auto& v = mesh.cell(c).v;
      worst = std::min(worst, reported_quality(Metric::kMinDihedral, mesh.point(v[0]), mesh.point(v[1]),
                                               mesh.point(v[2]), mesh.point(v[3])));
    }
    const double goal = options_.min_dihedral.value_or(0);
    const bool reached = invalid.empty() && worst >= goal - kAngleRounding;
    const bool missed = !invalid.empty() || worst < goal + kAngleRounding;
    if (result.goal_reached ? !reached : !missed)
      find("goal_reached", "{}, with {} invalid cells, worst {:.6f}, goal {}", result.goal_reached,
           invalid.size(), worst, goal);
    if (!result.changed && !same_bits) find("changed", "said to be unchanged, but the bits are others");
    if (mesh.n_logical_cells() != mesh.n_cells() || mesh.n_logical_vertices() != mesh.n_vertices())
      find("dense", "deleted cells or vertices are left");
    stop(result);
    if (options_.statistics) statistics(result, invalid.size(), worst, goal);
  }

 private:
  /// How the surface was to be kept: one that may go nowhere is flat.
  SurfaceMode mode() const {
    const SurfaceOptions& surface = options_.surface;
    return surface.mode == SurfaceMode::kFree && surface.hausdorff == 0.0 ? SurfaceMode::kFlat : surface.mode;
  }

  /// What a run towards a goal has fewer of has been gained, whatever became of the worst.
  std::ptrdiff_t below_goal(const Measure& m) const {
    const double goal = options_.min_dihedral.value_or(kClaimedGoal) - kAngleRounding;
    return std::lower_bound(m.angles.begin(), m.angles.end(), goal) - m.angles.begin();
  }

  /// The smallest angle beside those of inverted and flat cells: where these stay, neither the worst angle
  /// nor the 1st percentile of a small mesh tells of its other cells.
  static double worst_of_others(const Measure& m) {
    const std::size_t n_invalid = m.inverted + m.flat;
    return n_invalid < m.angles.size() ? m.angles[n_invalid] : m.worst;
  }

  void structure(const Measure& before, const Measure& after) {
    if (after.rule != Ok) find("check", "{}: {}", rule_name(after.rule), after.rule_message);
    if (after.extra_fans > before.extra_fans)
      find("pinched edges", "{} -> {}", before.extra_fans, after.extra_fans);
    if (after.extra_stars > before.extra_stars)
      find("pinched vertices", "{} -> {}", before.extra_stars, after.extra_stars);
    if (before.labels_fit && !after.labels_fit)
      find("labels", "a labelled face or edge is of no cell any more");
  }

  void validity(const Measure& before, const Measure& after) {
    if (after.inverted > before.inverted)
      find("inverted", "{} -> {} (flat {} -> {})", before.inverted, after.inverted, before.flat, after.flat);
    if (after.inverted + after.flat > before.inverted + before.flat)
      find("invalid", "inverted {} -> {}, flat {} -> {}", before.inverted, after.inverted, before.flat,
           after.flat);
    if (after.inverted_volume >
        before.inverted_volume * (1 + kRounding) + kRounding * kRounding * before.absolute_volume)
      find("overlap", "{:.6g} -> {:.6g} of all volume",
           static_cast<double>(before.inverted_volume / before.absolute_volume),
           static_cast<double>(after.inverted_volume / before.absolute_volume));
    if (!(after.worst >= before.worst - kAngleRounding))
      find("worst angle", "{:.6f} -> {:.6f}", before.worst, after.worst);
  }

  /// Of each region and of the whole.
  void volumes(const Measure& before, const Measure& after, double bound) {
    long double allowed = 0;
    const long double rounding = before.largest_coordinate * 0x1p-52L * before.area;
    if (mode() == SurfaceMode::kFlat)
      allowed =
          kFlatVolume * before.absolute_volume + kPlanar * before.diagonal * before.area + 16 * rounding;
    if (mode() == SurfaceMode::kFree)
      allowed = 2 * bound * before.area + kFlatVolume * before.absolute_volume + 16 * rounding;
    if (mode() == SurfaceMode::kFrozen)
      allowed = 1e-16L * before.absolute_volume * before.cells + 1e-3L * rounding;
    std::map<int, long double> change = after.region_volume;
    for (const auto& [region, volume] : before.region_volume) change[region] -= volume;
    long double whole = 0;
    for (const auto& [region, by] : change) {
      whole += by;
      if (!(std::abs(by) <= allowed))
        find("region volume", "region {} by {:.4g} of {:.4g}, allowed {:.4g}", region,
             static_cast<double>(by), static_cast<double>(before.absolute_volume),
             static_cast<double>(allowed));
    }
    if (!(std::abs(whole) <= allowed))
      find("volume", "by {:.4g} of {:.4g}, allowed {:.4g}", static_cast<double>(whole),
           static_cast<double>(before.absolute_volume), static_cast<double>(allowed));
  }

  void constraints(const Measure& before, const Measure& after) {
    if (after.fixed_vertices != before.fixed_vertices) find("fixed vertices", "moved or gone");
    if (after.vertex_labels != before.vertex_labels) find("vertex labels", "not the same");
    if (mode() == SurfaceMode::kFrozen) {
      if (after.frozen_faces != before.frozen_faces)
        find("frozen faces", "{} of {} are as they were", common(before.frozen_faces, after.frozen_faces),
             before.frozen_faces.size());
      if (after.labelled_edges != before.labelled_edges)
        find("labelled edges", "{} of {} are as they were",
             common(before.labelled_edges, after.labelled_edges), before.labelled_edges.size());
    }
    if (mode() != SurfaceMode::kFlat) return;
    same_sums("patch area", before.patch_area, after.patch_area, 1e-6L * before.area,
              allowed_by_rounding(before));
    same_sums("edge length", before.edge_length, after.edge_length, 1e-6L * std::sqrt(before.area), {});
  }

  /// A vertex on a patch's outline is rounded to coordinates beside it, which moves the sides there by that
  /// much: at most two distances of doubles have been seen. Along an edge's own line such a step counts for
  /// its square alone.
  static std::map<int, long double> allowed_by_rounding(const Measure& before) {
    std::map<int, long double> allowed = before.patch_edges;
    for (auto& [label, length] : allowed) length *= 2 * 0x1p-52L * before.largest_coordinate;
    return allowed;
  }

  void same_sums(const char* promise, const std::map<int, long double>& before,
                 std::map<int, long double> after, long double allowed,
                 const std::map<int, long double>& more_allowed) {
    for (const auto& [label, sum] : before) after[label] -= sum;
    for (const auto& [label, by] : after) {
      const auto more = more_allowed.find(label);
      const long double bound = allowed + (more == more_allowed.end() ? 0 : more->second);
      if (std::abs(by) > bound)
        find(promise, "label {} by {:.4g}, allowed {:.4g}", label, static_cast<double>(by),
             static_cast<double>(bound));
    }
  }

  template <class Set>
  static std::size_t common(const Set& a, const Set& b) {
    std::vector<typename Set::value_type> both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both.size();
  }

  void stop(const Result& result) {
    const bool possible = result.stop == Stop::kGoal         ? result.goal_reached && options_.min_dihedral
                          : result.stop == Stop::kCancelled  ? cancels_
                          : result.stop == Stop::kTimeLimit  ? std::isfinite(options_.time_limit)
                          : result.stop == Stop::kIterations ? options_.iterations > 0
                                                             : result.stop == Stop::kNoProgress;
    if (!possible) find("stop", "number {}", static_cast<int>(result.stop));
  }

  void distance(const Measure& before, const SurfaceReport& surface) {
    const double rounding = 1e-12 * surface.diagonal + 8 * 0x1p-52 * before.largest_coordinate;
    if (surface.hausdorff > surface.bound * (1 + 1e-6) + rounding)
      find("hausdorff", "{:.6g} of {:.6g}", surface.hausdorff, surface.bound);
  }

  void statistics(const Result& result, std::size_t n_invalid, double worst, double goal) {
    if (result.after.inverted.size() + result.after.flat.size() != n_invalid)
      find("statistics", "{} invalid cells, counted {}",
           result.after.inverted.size() + result.after.flat.size(), n_invalid);
    if (std::abs(result.after.min_dihedral.min - worst) > kAngleRounding)
      find("statistics", "worst angle {}, found {}", result.after.min_dihedral.min, worst);
    if (goal > 0 && !result.goal_reached && result.stuck.empty() && worst < goal - kAngleRounding)
      find("statistics", "a goal is missed and no cell is stuck");
    for (const StuckCell& cell : result.stuck)
      if (!(cell.degrees < result.stuck_below + kAngleRounding))
        find("statistics", "a stuck cell of {} degrees", cell.degrees);
  }

  const ImproveOptions& options_;
  bool cancels_;
  std::vector<Finding>& findings_;
};

}  // namespace

void compare_meshes(const Measure& before, const Measure& after, const RandomOptions& options,
                    const SurfaceReport& surface, std::vector<Finding>& findings) {
  Judge(options, findings).compare(before, after, surface);
}

void compare_result(const TetMesh& mesh, const Result& result, bool same_bits, const RandomOptions& options,
                    std::vector<Finding>& findings) {
  Judge(options, findings).result(mesh, result, same_bits);
}

}  // namespace hfr::fuzz
