// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Remesh/Improve.hh"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <utility>

#include "Arrays.hh"
#include "Callbacks.hh"
#include "Mesh.hh"
#include "hfremesh/Remesh/NamedOptions.hh"
#include "hfremesh/Transfer/Edits.hh"
#include "hfremesh/Transfer/Fields.hh"

namespace hfr::python {
namespace {

using namespace nb::literals;
using OptionTexts = std::vector<std::pair<std::string, std::string>>;

/// A run's result with the mesh that it made.
struct Improved {
  Mesh mesh;
  Result result;
  std::vector<FieldReport> transferred;
};

ImproveOptions options_of(const OptionTexts& texts) {
  ImproveOptions options;
  for (const auto& [name, text] : texts) set_option(options, name, text);
  return options;
}

Improved improve_copy(const Mesh& mesh, const OptionTexts& texts, nb::handle progress, nb::handle cancel,
                      bool statistics, bool maps, const std::vector<std::string>& transfers) {
  ImproveOptions options = options_of(texts);
  options.statistics = statistics;
  options.maps = maps || !transfers.empty();
  Callbacks callbacks(progress, cancel);
  callbacks.attach(options);
  require_finite(mesh.tets.points().data(), mesh.tets.n_vertices(), "points");
  RemesherOptions fields;
  for (const std::string& text : transfers) set_option(fields, "transfer", text);
  validate_fields(mesh.tets, fields.fields);
  Improved out;
  out.mesh.tets = mesh.tets;  // while nobody else runs, who could write its points
  std::shared_ptr<const TetMesh> old;
  if (!fields.fields.empty()) old = std::make_shared<const TetMesh>(mesh.tets);
  nb::gil_scoped_release others_run;
  out.result = improve(out.mesh.tets, options);
  if (!fields.fields.empty()) {
    const Edits edits = make_edits(old, out.mesh.tets, out.result.maps, options.policy);
    out.transferred = transfer_fields(*old, out.mesh.tets, edits, fields.fields, options.policy);
  }
  return out;
}

std::string plan_of(const Mesh& mesh, const OptionTexts& texts) {
  const ImproveOptions options = options_of(texts);
  nb::gil_scoped_release others_run;
  return plan(mesh.tets, options);
}

std::vector<nb::tuple> option_rows(bool of_remesher) {
  std::vector<nb::tuple> rows;
  for (const NamedOption& o : of_remesher ? named_remesher_options() : named_options())
    rows.push_back(nb::make_tuple(o.name, o.value, o.about, o.repeats));
  return rows;
}

void bind_parts(nb::module_& module) {
  nb::class_<Progress>(module, "Progress", "Where a run is.")
      .def_ro("stage", &Progress::stage)
      .def_ro("iteration", &Progress::iteration, "From 1, within the stage.")
      .def_ro("fraction", &Progress::fraction, "0 to 1 of the whole run, an estimate.")
      .def_ro("inverted", &Progress::n_inverted, "Inverted cells now.")
      .def_ro("min_dihedral", &Progress::min_dihedral, "Degrees, now.");
  nb::class_<StuckCell>(module, "StuckCell", "A cell below the goal, and what keeps it there.")
      .def_prop_ro("cell", [](const StuckCell& s) { return s.cell.idx(); })
      .def_ro("degrees", &StuckCell::degrees, "Its smallest dihedral; not above 0 where inverted or flat.")
      .def_prop_ro(
          "reason", [](const StuckCell& s) { return kStuckReasonNames[static_cast<std::size_t>(s.reason)]; },
          "'folded surface', 'surface ceiling', 'input feature', 'surface feature', 'max cells', 'time "
          "limit', "
          "'cancelled', 'iterations', 'device lost' or 'not found'.")
      .def_prop_ro(
          "is_proven", [](const StuckCell& s) { return is_proof(s.reason); },
          "Whether no mesh that keeps the faces has a larger angle there.")
      .def_ro("n_frozen_vertices", &StuckCell::n_frozen_vertices)
      .def("__repr__", [](const StuckCell& s) {
        return "<hfremesh.StuckCell " + std::to_string(s.cell.idx()) + ": " + std::to_string(s.degrees) +
               " degrees, " + kStuckReasonNames[static_cast<std::size_t>(s.reason)] + ">";
      });
  nb::class_<SurfaceReport>(module, "SurfaceReport",
                            "What became of the surface; lengths in the mesh's units.")
      .def_ro("bound", &SurfaceReport::bound, "Largest distance that was allowed.")
      .def_ro("hausdorff", &SurfaceReport::hausdorff,
              "Largest distance between the surfaces before and after.")
      .def_ro("diagonal", &SurfaceReport::diagonal)
      .def_ro("unfold_needs", &SurfaceReport::unfold_needs,
              "hausdorff that would let folds of the surface be unfolded; 0 where it does.")
      .def_ro("volume_change", &SurfaceReport::volume_change, "A share of the enclosed volume.")
      .def_ro("triangles_before", &SurfaceReport::triangles_before)
      .def_ro("triangles_after", &SurfaceReport::triangles_after);
}

void bind_result(nb::module_& module) {
  constexpr auto part = nb::rv_policy::reference_internal;
  nb::class_<Improved>(module, "Result", "What a run did, and the mesh that it made.")
      .def_prop_ro(
          "mesh", [](Improved& r) -> Mesh& { return r.mesh; }, part, "The mesh after the run.")
      .def_prop_ro(
          "changed", [](const Improved& r) { return r.result.changed; },
          "Whether anything is another than before.")
      .def_prop_ro(
          "goal_reached", [](const Improved& r) { return r.result.goal_reached; },
          "Nothing inverted or flat, and min_dihedral met where given.")
      .def_prop_ro(
          "stop", [](const Improved& r) { return stop_name(r.result.stop); },
          "'goal', 'no progress', 'iterations', 'time limit', 'cancelled' or 'device lost'.")
      .def_prop_ro(
          "before", [](Improved& r) -> Statistics& { return r.result.before; }, part,
          "Figures of the mesh before; all 0 with statistics=False.")
      .def_prop_ro(
          "after", [](Improved& r) -> Statistics& { return r.result.after; }, part,
          "Figures of the mesh after; all 0 with statistics=False.")
      .def_prop_ro(
          "surface", [](Improved& r) -> SurfaceReport& { return r.result.surface; }, part,
          "What became of the surface; all 0 while it is frozen.")
      .def_prop_ro(
          "maps", [](Improved& r) -> MeshMaps& { return r.result.maps; }, part,
          "What became of vertices and cells; empty with maps=False.")
      .def_prop_ro(
          "stuck", [](const Improved& r) { return r.result.stuck; },
          "A list of StuckCell: those below stuck_below, with what keeps each.")
      .def_prop_ro(
          "stuck_below", [](const Improved& r) { return r.result.stuck_below; }, "Degrees.")
      .def_prop_ro(
          "invalid_cells", [](const Improved& r) { return handle_array(r.result.invalid_cells); },
          "(k,) int64: inverted or flat cells that remain.", kOwned)
      .def_ro("transferred", &Improved::transferred, "What became of the fields of `transfer`.")
      .def_prop_ro(
          "seconds", [](const Improved& r) { return r.result.seconds; },
          "Of the work itself, statistics apart.")
      .def_prop_ro(
          "device", [](const Improved& r) { return r.result.device; },
          "Name of the device that was used; empty: none.")
      .def_prop_ro(
          "device_note", [](const Improved& r) { return r.result.device_note; },
          "Why a device that was wanted was not used, or not to the end.");
}

}  // namespace

void bind_improve(nb::module_& module) {
  bind_parts(module);
  bind_result(module);
  module.def("improve", &improve_copy, "mesh"_a, "options"_a, "progress"_a.none(), "cancel"_a.none(),
             "statistics"_a, "maps"_a, "transfer"_a,
             "Improves a copy of the mesh; options as pairs of name and text.");
  module.def("plan", &plan_of, "mesh"_a, "options"_a, "What improve() would do, as text.");
  module.def(
      "edits",
      [](const Mesh& old, const Improved& run) {
        auto kept =
            std::make_shared<const TetMesh>(old.tets);  // while nobody else runs, who could write its points
        nb::gil_scoped_release others_run;
        return make_edits(std::move(kept), run.mesh.tets, run.result.maps, par::Policy::all());
      },
      "old"_a, "run"_a, "What a run did, element by element.");
  module.def("options", &option_rows, "of_remesher"_a = false,
             "Each option's name, what its text may be, what it is about, and whether it repeats.");
}

}  // namespace hfr::python
