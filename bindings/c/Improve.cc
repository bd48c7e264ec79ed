// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Remesh/Improve.hh"

#include "Arrays.hh"
#include "hfremesh/Quality/CellQuality.hh"
#include "hfremesh/Quality/Statistics.hh"

using namespace hfr;
using namespace hfr::c;

namespace {

static_assert(static_cast<int>(Stop::kGoal) == HFR_STOP_GOAL);
static_assert(static_cast<int>(Stop::kNoProgress) == HFR_STOP_NO_PROGRESS);
static_assert(static_cast<int>(Stop::kIterations) == HFR_STOP_ITERATIONS);
static_assert(static_cast<int>(Stop::kTimeLimit) == HFR_STOP_TIME_LIMIT);
static_assert(static_cast<int>(Stop::kCancelled) == HFR_STOP_CANCELLED);
static_assert(static_cast<int>(Stop::kDeviceLost) == HFR_STOP_DEVICE_LOST);

hfr_statistics figures_of(const hfr_mesh& mesh, const Statistics& s) {
  hfr_statistics out{};
  out.vertices = static_cast<int64_t>(s.vertices);
  out.cells = static_cast<int64_t>(s.cells);
  out.boundary_faces = static_cast<int64_t>(s.boundary_faces);
  out.components = static_cast<int64_t>(s.components);
  out.inverted = static_cast<int64_t>(s.inverted.size());
  out.flat = static_cast<int64_t>(s.flat.size());
  out.worst_cell =
      s.worst_cell.is_valid() ? static_cast<int64_t>(s.worst_cell.idx()) + mesh.base : mesh.base - 1;
  out.min_dihedral = s.min_dihedral.min;
  out.mean_dihedral = s.mean_dihedral;
  out.max_dihedral = s.max_dihedral;
  out.min_quality = s.volume_length.min;
  out.mean_quality = s.volume_length.mean;
  out.volume = s.volume;
  out.absolute_volume = s.absolute_volume;
  out.overlap = s.overlap;
  out.min_edge = s.min_edge;
  out.mean_edge = s.mean_edge;
  out.max_edge = s.max_edge;
  out.surface_ceiling = s.surface_ceiling.degrees;
  return out;
}

}  // namespace

hfr_status hfr_mesh_statistics(hfr_mesh* mesh, int threads, hfr_statistics* out) {
  return guarded(mesh, [&] {
    HFR_REQUIRE(out, "out is NULL");
    HFR_REQUIRE(threads >= 0 && threads <= 1024, "threads: a whole number from 0 to 1024 is wanted");
    par::Policy policy = par::Policy::all();
    if (threads > 0) policy.threads = threads;
    *out = figures_of(*mesh, statistics(mesh->tets, policy));
  });
}

hfr_status hfr_mesh_quality(hfr_mesh* mesh, const char* metric, const hfr_array* values) {
  return guarded(mesh, [&] {
    const Metric chosen = metric_from_name(text_of(metric, "metric"));
    require_array(values, "values", static_cast<std::int64_t>(mesh->tets.n_cells()), 1);
    HFR_REQUIRE(values->type == HFR_FLOAT32 || values->type == HFR_FLOAT64, "values: floats are wanted");
    fill(values, "values", mesh->tets.n_cells(), 1,
         [&](std::size_t i, std::size_t) { return quality(mesh->tets, CellHandle(i), chosen); });
  });
}

hfr_status hfr_improve(hfr_mesh* mesh, const hfr_options* options, hfr_result* result) {
  return guarded(mesh, [&] {
    ImproveOptions chosen = options ? options->options : ImproveOptions();
    chosen.statistics = result != nullptr;
    chosen.maps = true;
    Result made;
    try {
      counted_from_zero(*mesh, [&] { made = improve(mesh->tets, chosen); });
    } catch (const InvalidInput&) {
      throw;  // before anything was done
    } catch (...) {
      mesh->maps = {};
      mesh->invalid_cells.clear();
      throw;
    }
    mesh->maps = std::move(made.maps);
    mesh->invalid_cells = std::move(made.invalid_cells);
    if (!result) return;
    *result = {};
    result->changed = made.changed;
    result->goal_reached = made.goal_reached;
    result->stop = static_cast<int32_t>(made.stop);
    result->invalid_cells = static_cast<int64_t>(mesh->invalid_cells.size());
    result->seconds = made.seconds;
    result->before = figures_of(*mesh, made.before);
    result->after = figures_of(*mesh, made.after);
  });
}
