// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Remesh/Remesher.hh"

#include <functional>
#include <memory>

#include "Arrays.hh"

using namespace hfr;
using namespace hfr::c;

struct hfr_remesher {
  hfr_mesh* mesh;  ///< the caller's
  std::unique_ptr<Remesher> remesher;
  std::vector<RepairResult> repairs;  ///< of the last step, or the one of the last repair
  std::vector<CellHandle> refused;
  std::string message;
  bool is_in_callback = false;
};

namespace {

static_assert(static_cast<int>(RepairCause::kAsked) == HFR_CAUSE_ASKED);
static_assert(static_cast<int>(RepairCause::kMotion) == HFR_CAUSE_MOTION);
static_assert(static_cast<int>(RepairCause::kInverted) == HFR_CAUSE_INVERTED);

std::vector<Vec3> displacement_of(const hfr_remesher& r, const hfr_array* array) {
  return points_of(array, "displacement", static_cast<std::int64_t>(r.mesh->tets.n_vertices()));
}

/// What was said of the mesh by the last hfr_improve() is no longer so.
void forget_run(hfr_mesh& mesh) {
  mesh.maps = {};
  mesh.invalid_cells.clear();
}

hfr_step as_it_is(const hfr_remesher& r) {
  hfr_step step{};
  step.fraction = 1;
  step.min_dihedral = r.remesher->min_dihedral();
  step.inverted = static_cast<int64_t>(r.remesher->n_inverted());
  return step;
}

/// What there is to get of a repair: rows, columns, and a number or handle of each place.
struct Table {
  std::size_t rows = 0;
  int columns = 1;
  std::function<double(std::size_t, std::size_t)> value;
};

template <class H>
Table of_handles(const hfr_mesh& mesh, const std::vector<H>& handles) {
  return {handles.size(), 1,
          [&](std::size_t i, std::size_t) { return static_cast<double>(number(mesh, handles[i])); }};
}

Table of_ids(std::span<const std::uint64_t> ids) {
  return {ids.size(), 1, [ids](std::size_t i, std::size_t) { return static_cast<double>(ids[i]); }};
}

Table of_places(const hfr_mesh& mesh, const std::vector<PlacedVertex>& all) {
  return {all.size(), 2, [&](std::size_t i, std::size_t j) {
            return static_cast<double>(j == 0 ? number(mesh, all[i].vertex) : number(mesh, all[i].old_cell));
          }};
}

Table of_weights(const std::vector<PlacedVertex>& all) {
  return {all.size(), 4, [&](std::size_t i, std::size_t j) { return all[i].weights[j]; }};
}

Table of_points(const std::vector<PlacedVertex>& all) {
  return {all.size(), 3, [&](std::size_t i, std::size_t j) { return all[i].point[static_cast<int>(j)]; }};
}

Table of_created_cells(const hfr_mesh& mesh, const Edits& edits) {
  return {edits.created_cells.size(), 5, [&](std::size_t i, std::size_t j) {
            const CreatedCell& c = edits.created_cells[i];
            return static_cast<double>(j == 0 ? number(mesh, c.cell) : number(mesh, c.vertices[j - 1]));
          }};
}

Table of_parents(const hfr_mesh& mesh, const Edits& edits) {
  const Parents& parents = edits.parents();
  auto child = std::make_shared<std::vector<CellHandle>>();
  for (std::size_t i = 0; i < edits.created_cells.size(); ++i)
    child->insert(child->end(), parents.of(i).size(), edits.created_cells[i].cell);
  return {parents.all.size(), 2, [&, child](std::size_t i, std::size_t j) {
            return static_cast<double>(number(mesh, j == 0 ? (*child)[i] : parents.all[i].old_cell));
          }};
}

/// Throws InvalidInput for what there is not.
Table table_of(const hfr_remesher& r, std::int64_t repair, const std::string& what) {
  const hfr_mesh& mesh = *r.mesh;
  if (what == "refused") return of_handles(mesh, r.refused);
  if (what == "vertex_ids") return of_ids(r.remesher->vertex_ids());
  if (what == "cell_ids") return of_ids(r.remesher->cell_ids());
  HFR_REQUIRE(repair >= 0 && std::cmp_less(repair, r.repairs.size()),
              "repair " + std::to_string(repair) + ": there were " + std::to_string(r.repairs.size()));
  const Edits& e = r.repairs[static_cast<std::size_t>(repair)].edits;
  if (what == "removed_cells") return of_handles(mesh, e.removed_cells);
  if (what == "created_cells") return of_created_cells(mesh, e);
  if (what == "moved_cells") return of_handles(mesh, e.moved_cells);
  if (what == "parents") return of_parents(mesh, e);
  if (what == "parent_shares") {
    const std::vector<ParentCell>& all = e.parents().all;
    return {all.size(), 1, [&](std::size_t i, std::size_t) { return all[i].share; }};
  }
  if (what == "removed_vertices") return of_handles(mesh, e.removed_vertices);
  if (what == "created_vertices") return of_places(mesh, e.created_vertices);
  if (what == "created_weights") return of_weights(e.created_vertices);
  if (what == "created_points") return of_points(e.created_vertices);
  if (what == "moved_vertices") return of_places(mesh, e.moved_vertices);
  if (what == "moved_weights") return of_weights(e.moved_vertices);
  if (what == "moved_points") return of_points(e.moved_vertices);
  if (what == "map_vertices") return of_handles(mesh, e.maps.vertices);
  if (what == "map_cells") return of_handles(mesh, e.maps.cells);
  if (what == "old_vertices") return of_handles(mesh, e.maps.old_vertices);
  if (what == "old_cells") return of_handles(mesh, e.maps.old_cells);
  throw InvalidInput("a repair has no '" + what + "'; hfremesh.h lists what it has");
}

/// Work with the remesher that a callback of its own may not ask for.
template <class F>
hfr_status guarded_work(hfr_remesher* r, F&& f) {
  return guarded(r, [&] {
    HFR_REQUIRE(!r->is_in_callback, "a callback that transfers a field may not step, move, repair or reset");
    f();
  });
}

/// Shows the caller this repair as the only one while he carries a field over.
void call_back(hfr_remesher& r, const hfr_options::OnTransfer& field, const TetMesh& old,
               const Edits& edits) {
  hfr_mesh before;
  before.tets = old;
  before.base = r.mesh->base;
  std::vector<RepairResult> others = std::move(r.repairs);
  r.repairs.clear();
  r.repairs.push_back({.edits = edits, .fields = {}});
  r.is_in_callback = true;
  const hfr_transfer shown = {field.name.c_str(), &before, r.mesh, &r};
  const int said = field.call(&shown, field.user);
  r.is_in_callback = false;
  r.repairs = std::move(others);
  HFR_REQUIRE(said == 0, "field '" + field.name + "': its callback failed with " + std::to_string(said));
}

RemesherOptions options_of(hfr_remesher& r, const hfr_options& options) {
  RemesherOptions out = options.remesher;
  for (const hfr_options::OnTransfer& field : options.on_transfer)
    out.fields.push_back({.name = field.name,
                          .how = Transfer::kCallback,
                          .callback = [&r, field](const TetMesh& old, TetMesh&, const Edits& edits) {
                            call_back(r, field, old, edits);
                          }});
  return out;
}

}  // namespace

hfr_status hfr_remesher_new(hfr_mesh* mesh, const hfr_options* options, hfr_remesher** out) {
  if (out) *out = nullptr;
  return guarded(mesh, [&] {
    HFR_REQUIRE(out, "out is NULL");
    auto made = std::make_unique<hfr_remesher>();
    made->mesh = mesh;
    made->remesher =
        std::make_unique<Remesher>(mesh->tets, options ? options_of(*made, *options) : RemesherOptions());
    *out = made.release();
  });
}

void hfr_remesher_free(hfr_remesher* remesher) { delete remesher; }

const char* hfr_remesher_message(const hfr_remesher* remesher) {
  return remesher ? remesher->message.c_str() : "the remesher is NULL";
}

hfr_status hfr_remesher_step(hfr_remesher* r, const hfr_array* displacement, hfr_step* step) {
  return guarded_work(r, [&] {
    StepResult done = r->remesher->step(displacement_of(*r, displacement));
    if (done.changed) forget_run(*r->mesh);
    r->repairs = std::move(done.repairs);
    r->refused = std::move(done.refused);
    if (!step) return;
    *step = as_it_is(*r);
    step->changed = done.changed;
    step->cause = static_cast<int32_t>(done.cause);
    step->stop = static_cast<int32_t>(done.stop);
    step->undone = done.undone;
    step->repairs = static_cast<int64_t>(r->repairs.size());
    step->looked_at = static_cast<int64_t>(done.n_looked_at);
    step->refused = static_cast<int64_t>(r->refused.size());
    step->fraction = done.fraction;
  });
}

hfr_status hfr_remesher_move(hfr_remesher* r, const hfr_array* displacement, hfr_step* step) {
  return guarded_work(r, [&] {
    MoveResult done = r->remesher->move(displacement_of(*r, displacement));
    r->repairs.clear();
    r->refused = std::move(done.refused);
    if (!step) return;
    *step = as_it_is(*r);
    step->looked_at = static_cast<int64_t>(done.n_looked_at);
    step->refused = static_cast<int64_t>(r->refused.size());
    step->fraction = done.fraction;
  });
}

hfr_status hfr_remesher_repair(hfr_remesher* r, hfr_step* step) {
  return guarded_work(r, [&] {
    RepairResult done = r->remesher->repair();
    forget_run(*r->mesh);
    r->refused.clear();
    r->repairs.clear();
    r->repairs.push_back(std::move(done));
    if (!step) return;
    *step = as_it_is(*r);
    step->changed = !r->repairs[0].edits.empty();
    step->cause = HFR_CAUSE_ASKED;
    step->stop = static_cast<int32_t>(r->repairs[0].stop);
    step->repairs = 1;
  });
}

hfr_status hfr_remesher_transfer(hfr_remesher* r) {
  return guarded_work(r, [&] { r->remesher->transfer(); });
}

int hfr_remesher_needs_repair(const hfr_remesher* r) {
  return r ? static_cast<int>(r->remesher->needs_repair()) : HFR_CAUSE_NONE;
}

hfr_status hfr_remesher_reset(hfr_remesher* r) {
  return guarded_work(r, [&] {
    r->remesher->reset();
    r->repairs.clear();
    r->refused.clear();
  });
}

int64_t hfr_remesher_count(const hfr_remesher* r, int64_t repair, const char* what) {
  if (!r || !what) return -1;
  try {
    return static_cast<int64_t>(table_of(*r, repair, what).rows);
  } catch (...) {  // a word or a repair that there is not
    return -1;
  }
}

hfr_status hfr_remesher_get(hfr_remesher* r, int64_t repair, const char* what, const hfr_array* values) {
  return guarded(r, [&] {
    const std::string name(text_of(what, "what"));
    const Table table = table_of(*r, repair, name);
    fill(values, name, table.rows, table.columns, table.value);
  });
}
