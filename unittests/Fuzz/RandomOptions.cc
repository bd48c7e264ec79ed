// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/RandomOptions.hh"

#include <fmt/format.h>

namespace hfr::fuzz {
namespace {

void choose_surface(Random& random, const Complex& complex, ImproveOptions& options) {
#ifdef HFR_HAS_SURFACE
  const double kind = random.unit();
  if (kind < 0.55) return;
  SurfaceOptions& surface = options.surface;
  surface.mode = kind < 0.75 ? SurfaceMode::kFlat : SurfaceMode::kFree;
  if (surface.mode == SurfaceMode::kFree && random.chance(0.5))
    surface.hausdorff = random.pick({0.0, 1e-3, 0.02, 0.1, 1.0});
  if (random.chance(0.15)) surface.feature_angle = random.pick({0.0, 5.0, 20.0, 80.0, 180.0});
  if (random.chance(0.1) && !complex.points.empty())
    surface.fixed_vertices.emplace_back(random.below(complex.points.size()));
#else
  (void)random, (void)complex, (void)options;
#endif
}

void choose_aim(Random& random, std::size_t n_cells, ImproveOptions& options) {
  const double aim = random.unit();
  if (aim < 0.35)
    options.min_dihedral =
        random.pick({1.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 60.0, 70.0});
  else if (aim < (n_cells <= 60 ? 0.5 : 0.36))
    options.raise_min_dihedral = true;
  options.coarsen = random.chance(0.1);
  options.bulk_nodes = random.chance(0.1);
}

void choose_means(Random& random, ImproveOptions& options) {
  if (random.chance(0.2)) {
    options.ops = Ops::kNone;
    for (unsigned bit = 1; bit <= 32; bit *= 2)
      if (random.chance(0.5)) options.ops = options.ops | static_cast<Ops>(bit);
    if (options.ops == Ops::kNone) options.ops = Ops::kCluster;
  }
  if (random.chance(0.2))
    options.smoother = random.pick({Smoother::kCandidates, Smoother::kLaplacian, Smoother::kTaubin});
  if (random.chance(0.2)) options.metric = kMetrics[random.below(kMetrics.size())];
  if (random.chance(0.2)) options.rounds = random.pick({Rounds::kByKind, Rounds::kMixed});
  if (random.chance(0.07)) options.compat = Compat::kJpdc2013;
  if (random.chance(0.2)) options.seed = random.next() % 1000;
}

void choose_limits(Random& random, std::size_t n_cells, RandomOptions& options) {
  ImproveOptions& improve = options.improve;
  if (random.chance(0.15)) improve.iterations = random.from_to(1, 3);
  if (random.chance(0.04)) improve.time_limit = random.pick({0.0, 1e-9, 1e-4, 1e-3});
  if (random.chance(0.12)) options.cancel_at = random.from_to(1, random.pick({3, 10, 60}));
  if (random.chance(0.07)) improve.min_cells = random.below(2 * n_cells + 1);
  if (random.chance(0.07)) improve.max_cells = random.below(3 * n_cells + 1);
}

const char* name_of(Smoother smoother) {
  switch (smoother) {
    case Smoother::kNewton:
      return "newton";
    case Smoother::kCandidates:
      return "candidates";
    case Smoother::kLaplacian:
      return "laplacian";
    case Smoother::kTaubin:
      return "taubin";
  }
  return "";
}

}  // namespace

RandomOptions random_options(std::uint64_t number, const Complex& complex) {
  return random_options(Random(number * 0xd1342543de82ef95ULL ^ 0x6f7074696f6e73ULL), complex);
}

RandomOptions random_options(Random random, const Complex& complex) {
  RandomOptions options;
  options.improve.policy = {1, 1};
  options.threads = random.chance(0.8) ? 3 : random.pick({2, 4, 5, 7});
  if (random.chance(0.2)) return options;  // what most people run
  options.improve.statistics = random.chance(0.7);
  choose_aim(random, complex.cells.size(), options.improve);
  choose_surface(random, complex, options.improve);
  if (random.chance(0.6)) choose_means(random, options.improve);
  if (random.chance(0.6)) choose_limits(random, complex.cells.size(), options);
  return options;
}

std::string RandomOptions::command_line() const {
  const ImproveOptions& o = improve;
  std::string line = "-j 1";
  if (o.min_dihedral) line += fmt::format(" --min-dihedral {}", *o.min_dihedral);
  if (o.raise_min_dihedral) line += " --min-dihedral max";
  if (o.surface.mode == SurfaceMode::kFlat) line += " --surface flat";
  if (o.surface.mode == SurfaceMode::kFree) line += " --surface free";
  if (o.surface.hausdorff) line += fmt::format(" --hausdorff {}", *o.surface.hausdorff);
  if (o.surface.feature_angle != SurfaceOptions().feature_angle)
    line += fmt::format(" --feature-angle {}", o.surface.feature_angle);
  for (VertexHandle v : o.surface.fixed_vertices) line += fmt::format(" --fix vertex:{}", v.idx());
  if (o.coarsen) line += " --coarsen";
  if (o.bulk_nodes) line += " --bulk-nodes";
  if (o.ops != Ops::kDefault) line += " --ops " + ops_to_list(o.ops);
  if (o.smoother != Smoother::kNewton) line += fmt::format(" --smoother {}", name_of(o.smoother));
  if (o.metric != Metric::kVolumeLength) line += fmt::format(" --metric {}", metric_name(o.metric));
  if (o.rounds == Rounds::kByKind) line += " --rounds by-kind";
  if (o.rounds == Rounds::kMixed) line += " --rounds mixed";
  if (o.compat == Compat::kJpdc2013) line += " --compat jpdc2013";
  if (o.iterations > 0) line += fmt::format(" --iterations {}", o.iterations);
  if (o.time_limit < 1e9) line += fmt::format(" --time-limit {}", o.time_limit);
  if (o.min_cells > 0) line += fmt::format(" --min-cells {}", o.min_cells);
  if (o.max_cells > 0) line += fmt::format(" --max-cells {}", o.max_cells);
  if (o.seed != 1) line += fmt::format(" --seed {}", o.seed);
  if (cancel_at > 0) line += fmt::format(" # cancelled at question {}", cancel_at);
  return line;
}

}  // namespace hfr::fuzz
