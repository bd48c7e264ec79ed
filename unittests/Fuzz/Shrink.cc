// SPDX-License-Identifier: BSD-3-Clause
// Delta debugging (Zeller and Hildebrandt, Simplifying and isolating failure-inducing input, 2002): parts are
// left out as long as the same promise stays broken.
#include <algorithm>
#include <functional>

#include "Fuzz/Case.hh"

namespace hfr::fuzz {
namespace {

constexpr int kMostRuns = 3000;

class Shrinker {
 public:
  Shrinker(Case found, std::string promise, std::string folder)
      : best_(std::move(found)), promise_(std::move(promise)), folder_(std::move(folder)) {}

  Case run() {
    for (std::size_t before = 0; before != size(best_) && runs_ < kMostRuns;) {
      before = size(best_);
      simpler_options();
      fewer_constraints();
      fewer_cells();
    }
    accept([](Case& c) { drop_unused_points(c.complex); });
    return std::move(best_);
  }

 private:
  static std::size_t size(const Case& c) {
    return c.complex.cells.size() + c.complex.faces.size() + c.complex.edges.size() + c.complex.fixed.size() +
           c.options.command_line().size();
  }

  bool accept(const std::function<void(Case&)>& change) {
    if (++runs_ > kMostRuns) return false;
    Case tried = best_;
    change(tried);
    const Outcome outcome = run_case(tried, folder_);
    const bool same = std::any_of(outcome.findings.begin(), outcome.findings.end(),
                                  [&](const Finding& f) { return f.promise == promise_; });
    if (same) best_ = std::move(tried);
    return same;
  }

  void simpler_options() {
    const ImproveOptions plain;
    const std::string before = best_.options.command_line();
    const auto unless_same = [&](const std::function<void(ImproveOptions&)>& change) {
      Case tried = best_;
      change(tried.options.improve);
      if (tried.options.command_line() != best_.options.command_line())
        accept([&](Case& c) { change(c.options.improve); });
    };
    if (best_.options.cancel_at > 0) accept([](Case& c) { c.options.cancel_at = 0; });
    unless_same([&](ImproveOptions& o) { o.surface = plain.surface; });
    unless_same([&](ImproveOptions& o) { o.surface.hausdorff.reset(); });
    unless_same([&](ImproveOptions& o) { o.surface.feature_angle = plain.surface.feature_angle; });
    unless_same([&](ImproveOptions& o) { o.surface.fixed_vertices.clear(); });
    unless_same([&](ImproveOptions& o) { o.min_dihedral.reset(), o.raise_min_dihedral = false; });
    unless_same([&](ImproveOptions& o) { o.ops = plain.ops; });
    unless_same([&](ImproveOptions& o) { o.smoother = plain.smoother; });
    unless_same([&](ImproveOptions& o) { o.metric = plain.metric; });
    unless_same([&](ImproveOptions& o) { o.rounds = plain.rounds; });
    unless_same([&](ImproveOptions& o) { o.compat = plain.compat; });
    unless_same([&](ImproveOptions& o) { o.iterations = 0; });
    unless_same([&](ImproveOptions& o) { o.min_cells = 0; });
    unless_same([&](ImproveOptions& o) { o.max_cells = 0; });
    unless_same([&](ImproveOptions& o) { o.coarsen = false; });
    unless_same([&](ImproveOptions& o) { o.bulk_nodes = false; });
    unless_same([&](ImproveOptions& o) { o.seed = 1; });
    for (unsigned bit = 1; bit <= 32; bit *= 2) {
      const Ops fewer = without(best_.options.improve.ops, static_cast<Ops>(bit));
      if (fewer != Ops::kNone)
        unless_same([&](ImproveOptions& o) { o.ops = without(o.ops, static_cast<Ops>(bit)); });
    }
  }

  void fewer_constraints() {
    if (!best_.complex.regions.empty()) accept([](Case& c) { c.complex.regions.clear(); });
    if (!best_.complex.faces.empty()) accept([](Case& c) { c.complex.faces.clear(); });
    if (!best_.complex.edges.empty()) accept([](Case& c) { c.complex.edges.clear(); });
    if (!best_.complex.vertex_labels.empty()) accept([](Case& c) { c.complex.vertex_labels.clear(); });
    if (!best_.complex.fixed.empty()) accept([](Case& c) { c.complex.fixed.clear(); });
  }

  void fewer_cells() {
    for (std::size_t n = (best_.complex.cells.size() + 1) / 2; n >= 1; n = n == 1 ? 0 : (n + 1) / 2) {
      for (std::size_t at = 0; at < best_.complex.cells.size() && runs_ < kMostRuns;) {
        if (best_.complex.cells.size() <= 1 || !accept([&](Case& c) { cut(c.complex, at, n); })) at += n;
      }
    }
  }

  static void cut(Complex& complex, std::size_t at, std::size_t n) {
    const auto from = static_cast<std::ptrdiff_t>(at);
    const auto to = static_cast<std::ptrdiff_t>(std::min(at + n, complex.cells.size()));
    complex.cells.erase(complex.cells.begin() + from, complex.cells.begin() + to);
    if (!complex.regions.empty())
      complex.regions.erase(complex.regions.begin() + from, complex.regions.begin() + to);
    const auto gone = [&](const auto& labelled) {
      return std::none_of(complex.cells.begin(), complex.cells.end(), [&](const Corners& c) {
        return std::all_of(labelled.vertices.begin(), labelled.vertices.end(),
                           [&](Index v) { return std::find(c.begin(), c.end(), v) != c.end(); });
      });
    };
    std::erase_if(complex.faces, gone);
    std::erase_if(complex.edges, gone);
  }

  static void drop_unused_points(Complex& complex) {
    std::vector<Index> to(complex.points.size(), 0);
    for (const Corners& c : complex.cells)
      for (Index v : c) to[v] = 1;
    std::vector<Vec3> points;
    std::vector<int> labels;
    std::vector<Index> fixed;
    for (std::size_t v = 0; v < to.size(); ++v) {
      if (to[v] == 0) continue;
      to[v] = static_cast<Index>(points.size());
      points.push_back(complex.points[v]);
      if (!complex.vertex_labels.empty()) labels.push_back(complex.vertex_labels[v]);
      if (std::find(complex.fixed.begin(), complex.fixed.end(), v) != complex.fixed.end())
        fixed.push_back(to[v]);
    }
    for (Corners& c : complex.cells)
      for (Index& v : c) v = to[v];
    for (auto& face : complex.faces)
      for (Index& v : face.vertices) v = to[v];
    for (auto& edge : complex.edges)
      for (Index& v : edge.vertices) v = to[v];
    complex.points = std::move(points);
    complex.vertex_labels = std::move(labels);
    complex.fixed = std::move(fixed);
  }

  Case best_;
  std::string promise_, folder_;
  int runs_ = 0;
};

}  // namespace

Case shrink(Case found, const std::string& promise, const std::string& folder) {
  return Shrinker(std::move(found), promise, folder).run();
}

}  // namespace hfr::fuzz
