// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Remesh/Remesher.hh"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "Arrays.hh"
#include "Callbacks.hh"
#include "Fields.hh"
#include "Mesh.hh"
#include "hfremesh/Remesh/NamedOptions.hh"

namespace hfr::python {
namespace {

using namespace nb::literals;
using OptionTexts = std::vector<std::pair<std::string, std::string>>;

const char* cause_name(RepairCause cause) {
  constexpr const char* kNames[] = {"none",      "inverted", "angle", "metric", "jacobian",
                                    "indicator", "motion",   "steps", "asked"};
  return kNames[static_cast<int>(cause)];
}

std::vector<Vec3> displacement_of(nb::handle object, std::size_t n) {
  std::vector<Vec3> displacement = points_of(object, "displacement");
  if (displacement.size() != n)
    throw nb::value_error(("displacement: an array of shape (" + std::to_string(n) + ", 3) is wanted, not (" +
                           std::to_string(displacement.size()) + ", 3)")
                              .c_str());
  return displacement;
}

/// What a caller gives for a field that there is; ValueError for another shape, or floats for integers.
std::vector<double> values_for(const FieldKind& kind, nb::handle values, std::size_t n) {
  io::Field field = field_of(values, kind.name, n, kind.of_vertices ? "vertex" : "cell");
  if (field.components != kind.components || (kind.integer && !field.integer))
    throw nb::value_error(("field '" + kind.name + "' has " + std::to_string(kind.components) +
                           (kind.integer ? " integer" : "") + " components")
                              .c_str());
  return std::move(field.values);
}

/// hfremesh.Remesher: a mesh of its own, since that one changes; what is read of it is copied.
class OwnedRemesher {
 private:
  void require_idle() const {
    if (is_busy_) throw std::runtime_error("a step of this Remesher is in progress");
  }
  template <class F>
  auto alone(F&& f) {
    struct Idle {
      bool& busy;
      ~Idle() { busy = false; }
    };
    require_idle();
    is_busy_ = true;
    const Idle after{is_busy_};
    callbacks_.begin();
    return f();
  }

 public:
  OwnedRemesher(const Mesh& mesh, const OptionTexts& texts, nb::object progress, nb::object cancel,
                const nb::dict& transfers)
      : progress_(std::move(progress)),
        cancel_(std::move(cancel)),
        callbacks_(progress_, cancel_),
        mesh_(mesh.tets) {
    RemesherOptions options;
    for (const auto& [name, text] : texts) {
      if (name == "min_dihedral" && text == "none")
        options.improve.min_dihedral.reset();
      else
        set_option(options, name, text);
    }
    callbacks_.attach(options.improve);
    require_finite(mesh_.points().data(), mesh_.n_vertices(), "points");
    {
      nb::gil_scoped_release others_run;
      fields_ = field_kinds(mesh_);
    }
    add_transfers(transfers, options);
    nb::gil_scoped_release others_run;
    remesher_ = std::make_unique<Remesher>(mesh_, std::move(options));
  }

  StepResult step(nb::handle displacement) {
    return alone([&] {
      const std::vector<Vec3> d = displacement_of(displacement, mesh_.n_vertices());
      nb::gil_scoped_release others_run;
      return remesher_->step(d);
    });
  }
  MoveResult move(nb::handle displacement) {
    return alone([&] {
      const std::vector<Vec3> d = displacement_of(displacement, mesh_.n_vertices());
      nb::gil_scoped_release others_run;
      return remesher_->move(d);
    });
  }
  RepairResult repair() {
    return alone([&] {
      nb::gil_scoped_release others_run;
      return remesher_->repair();
    });
  }
  std::vector<FieldReport> transfer() {
    return alone([&] {
      nb::gil_scoped_release others_run;
      return remesher_->transfer();
    });
  }

  /// What the garbage collector asks: callbacks may refer to this object.
  int traverse(visitproc visit, void* arg) const {
    Py_VISIT(progress_.ptr());
    Py_VISIT(cancel_.ptr());
    for (const nb::object& transfer : transfers_) Py_VISIT(transfer.ptr());
    return 0;
  }
  void clear() {
    callbacks_.forget();
    progress_.reset();
    cancel_.reset();
    for (nb::object& transfer : transfers_) transfer.reset();
  }

  const TetMesh& mesh() {
    require_idle();
    return mesh_;
  }
  Remesher& remesher() {
    require_idle();
    return *remesher_;
  }

  /// The field of that name, of "vertices" or "cells" where both have one.
  const FieldKind& kind(const std::string& name, const std::optional<std::string>& of) {
    require_idle();
    if (of && *of != "vertices" && *of != "cells")
      throw nb::value_error(("of: 'vertices' or 'cells', not '" + *of + "'").c_str());
    const auto is_meant = [&](const FieldKind& k) {
      return k.name == name && (!of || k.of_vertices == (*of == "vertices"));
    };
    const auto found = std::ranges::find_if(fields_, is_meant);
    if (found == fields_.end())
      throw nb::key_error(
          ("there is no field '" + name + "': give it to the Mesh that the Remesher is made of").c_str());
    if (std::ranges::count_if(fields_, is_meant) > 1)
      throw nb::value_error(("both vertices and cells have a field '" + name + "': say of='vertices' or " +
                             "of='cells'; a function that carries one over needs another name")
                                .c_str());
    return *found;
  }
  const std::vector<FieldKind>& kinds() const { return fields_; }

  void set_field(const std::string& name, nb::handle values, const std::optional<std::string>& of) {
    const FieldKind& found = kind(name, of);
    const std::size_t n = found.of_vertices ? mesh_.n_vertices() : mesh_.n_cells();
    set_field_values(mesh_, found, values_for(found, values, n));
  }

 private:
  /// Fields that a function of the caller's carries over.
  void add_transfers(const nb::dict& transfers, RemesherOptions& options) {
    for (auto [key, function] : transfers) {
      const std::string name = nb::cast<std::string>(key);
      const std::size_t i = transfers_.size();
      const FieldKind* carried = &kind(name, std::nullopt);  // KeyError where there is no such field
      transfers_.push_back(nb::borrow(function));
      options.fields.push_back(
          {.name = name,
           .how = Transfer::kCallback,
           .callback = [this, i, carried](const TetMesh& old, TetMesh& now, const Edits& edits) {
             const nb::gil_scoped_acquire python;
             carry_over(transfers_[i], *carried, old, now, edits);
           }});
    }
  }
  /// Meshes and edits are copies: whoever keeps them may.
  static void carry_over(const nb::object& function, const FieldKind& kind, const TetMesh& old, TetMesh& now,
                         const Edits& edits) {
    const nb::object values =
        function(nb::cast(Mesh{old, {}, {}}, nb::rv_policy::move),
                 nb::cast(Mesh{now, {}, {}}, nb::rv_policy::move), nb::cast(edits, nb::rv_policy::copy));
    set_field_values(now, kind,
                     values_for(kind, values, kind.of_vertices ? now.n_vertices() : now.n_cells()));
  }

  nb::object progress_, cancel_;
  std::vector<nb::object> transfers_;
  Callbacks callbacks_;
  TetMesh mesh_;
  std::vector<FieldKind> fields_;
  std::unique_ptr<Remesher> remesher_;
  bool is_busy_ = false;  // read and written with the interpreter's lock
};

nb::object values_array(const TetMesh& mesh, const FieldKind& kind) {
  std::vector<double> values = field_values(mesh, kind);
  const auto k = static_cast<std::size_t>(kind.components);
  const std::size_t n = values.size() / k;
  const auto made = [&](auto numbers) {
    return k == 1 ? nb::cast(to_array(std::move(numbers))) : nb::cast(to_array(std::move(numbers), {n, k}));
  };
  if (kind.integer) return made(std::vector<std::int64_t>(values.begin(), values.end()));
  return made(std::move(values));
}

Array<double> points_copy(const TetMesh& mesh) {
  const double* first = mesh.point_data();
  return to_array(std::vector<double>(first, first + 3 * mesh.n_vertices()), {mesh.n_vertices(), 3});
}

Array<std::int32_t> cells_copy(const TetMesh& mesh) {
  std::vector<std::int32_t> cells(4 * mesh.n_cells());
  for (std::size_t i = 0; i < cells.size(); ++i)
    cells[i] = static_cast<std::int32_t>(mesh.cell_vertices(CellHandle(i / 4))[i % 4].idx());
  return to_array(std::move(cells), {mesh.n_cells(), 4});
}

int traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  return nb::inst_ready(self) ? nb::inst_ptr<OwnedRemesher>(self)->traverse(visit, arg) : 0;
}

int clear(PyObject* self) {
  // One whose constructor has thrown holds nothing any more.
  if (nb::inst_ready(self)) nb::inst_ptr<OwnedRemesher>(self)->clear();
  return 0;
}

void bind_results(nb::module_& module) {
  constexpr auto part = nb::rv_policy::reference_internal;
  nb::class_<RepairResult>(module, "Repair", "One repair of a step.")
      .def_prop_ro(
          "edits", [](RepairResult& r) -> Edits& { return r.edits; }, part)
      .def_ro("fields", &RepairResult::fields, "What became of the fields that are carried over.")
      .def_prop_ro(
          "stop", [](const RepairResult& r) { return stop_name(r.stop); }, "Why it ended, as Result.stop.")
      .def_ro("goal_reached", &RepairResult::goal_reached);
  nb::class_<MoveResult>(module, "Move", "What a move did.")
      .def_ro("fraction", &MoveResult::fraction, "Of the displacement that was taken.")
      .def_ro("n_moved", &MoveResult::n_moved, "Vertices.")
      .def_ro("n_looked_at", &MoveResult::n_looked_at, "Cells with such a vertex.")
      .def_prop_ro(
          "refused", [](const MoveResult& m) { return handle_array(m.refused); }, kOwned,
          "(k,) int64: with on_inversion 'refuse', the cells that would be inverted or flat.");
  nb::class_<StepResult>(module, "Step", "What a step did.")
      .def_ro("changed", &StepResult::changed,
              "By a repair: connectivity, or points beyond the displacement. Otherwise a solver keeps all it "
              "has.")
      .def_prop_ro(
          "cause", [](const StepResult& s) { return cause_name(s.cause); },
          "Of the first repair: 'none', 'inverted', 'angle', 'metric', 'jacobian', 'indicator', 'motion' or "
          "'steps'.")
      .def_ro("fraction", &StepResult::fraction, "Of the displacement that was taken.")
      .def_ro("n_looked_at", &StepResult::n_looked_at, "Cells with a vertex that was moved.")
      .def_prop_ro(
          "refused", [](const StepResult& s) { return handle_array(s.refused); }, kOwned,
          "(k,) int64: with on_inversion 'refuse', the cells that would be inverted or flat.")
      .def_prop_ro(
          "repairs", [](StepResult& s) -> std::vector<RepairResult>& { return s.repairs; }, part,
          "What the repairs did, each to the mesh that the one before it has left: one, but for sub-steps.")
      .def_prop_ro(
          "edits",
          [](StepResult& s) -> Edits* {
            if (s.repairs.size() > 1)
              throw nb::value_error("a step of several repairs has no edits of its own: see repairs");
            return s.repairs.empty() ? nullptr : &s.repairs[0].edits;
          },
          part, "Of the one repair; None where there was none. ValueError where there were several.")
      .def_ro("min_dihedral", &StepResult::min_dihedral, "After it, degrees.")
      .def_ro("inverted", &StepResult::n_inverted, "After it: cells that are inverted or flat.")
      .def_prop_ro(
          "stop", [](const StepResult& s) { return stop_name(s.stop); }, "Of the last repair.")
      .def_ro("undone", &StepResult::undone,
              "It was cut short while cells were inverted that were not before: mesh and fields are as "
              "before it.")
      .def("__repr__", [](const StepResult& s) {
        return std::string("<hfremesh.Step: ") + (s.changed ? "changed" : "unchanged") + ", cause " +
               cause_name(s.cause) + ", smallest dihedral " + std::to_string(s.min_dihedral) + ", " +
               std::to_string(s.n_inverted) + " inverted>";
      });
}

void bind_reading(nb::class_<OwnedRemesher>& type) {
  type.def_prop_ro("n_vertices", [](OwnedRemesher& r) { return r.mesh().n_vertices(); })
      .def_prop_ro("n_cells", [](OwnedRemesher& r) { return r.mesh().n_cells(); })
      .def_prop_ro(
          "points", [](OwnedRemesher& r) { return points_copy(r.mesh()); }, kOwned, "(n, 3) float64, a copy.")
      .def_prop_ro(
          "cells", [](OwnedRemesher& r) { return cells_copy(r.mesh()); }, kOwned, "(m, 4) int32, a copy.")
      .def_prop_ro(
          "mesh",
          [](OwnedRemesher& r) {
            return Mesh{r.mesh(), {}, {}};
          },
          nb::rv_policy::move, "A Mesh as it is now, with all that hangs on it; a copy.")
      .def_prop_ro(
          "min_dihedral", [](OwnedRemesher& r) { return r.remesher().min_dihedral(); }, "Degrees, now.")
      .def_prop_ro(
          "inverted", [](OwnedRemesher& r) { return r.remesher().n_inverted(); },
          "Inverted and flat cells, now.")
      .def_prop_ro(
          "needs_repair", [](OwnedRemesher& r) { return cause_name(r.remesher().needs_repair()); },
          "Why the mesh is to be repaired, as Step.cause; 'none' where it is not.")
      .def_prop_ro(
          "vertex_ids",
          [](OwnedRemesher& r) {
            const auto ids = r.remesher().vertex_ids();
            return to_array(std::vector<std::uint64_t>(ids.begin(), ids.end()));
          },
          kOwned, "(n,) uint64: numbers that never change, with ids=True.")
      .def_prop_ro(
          "cell_ids",
          [](OwnedRemesher& r) {
            const auto ids = r.remesher().cell_ids();
            return to_array(std::vector<std::uint64_t>(ids.begin(), ids.end()));
          },
          kOwned, "(m,) uint64: numbers that never change, with ids=True.")
      .def_prop_ro("field_names", [](OwnedRemesher& r) {
        std::vector<std::string> names;
        for (const FieldKind& kind : r.kinds()) names.push_back(kind.name);
        return names;
      });
}

}  // namespace

void bind_remesher(nb::module_& module) {
  bind_results(module);
  PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse)},
                         {Py_tp_clear, reinterpret_cast<void*>(&clear)},
                         {0, nullptr}};
  nb::class_<OwnedRemesher> type(
      module, "Remesher", nb::type_slots(slots),
      "A mesh inside of a simulation: its vertices move step by step, and what has become "
      "bad is repaired. Works on a copy of the mesh that it is made of.");
  type.def(nb::init<const Mesh&, const OptionTexts&, nb::object, nb::object, const nb::dict&>(), "mesh"_a,
           "options"_a, "progress"_a.none(), "cancel"_a.none(), "transfers"_a)
      .def("step", &OwnedRemesher::step, "displacement"_a,
           "Moves the vertices by `displacement`, (n, 3), looks at their cells, and where a trigger calls "
           "for it "
           "repairs the mesh and carries the fields over. Raises ValueError, before anything is moved, for "
           "another "
           "shape or a displacement that is not finite, with the first index. KeyboardInterrupt ends the "
           "step with a "
           "valid mesh: see Step.undone. What a callback raises is raised here, and mesh and fields are as "
           "before.")
      .def("move", &OwnedRemesher::move, "displacement"_a, "Moves the vertices and looks at their cells.")
      .def("repair", &OwnedRemesher::repair,
           "Repairs the mesh whatever the triggers say; then call transfer().")
      .def("transfer", &OwnedRemesher::transfer, "Carries the fields over the last repair().")
      .def(
          "field",
          [](OwnedRemesher& r, const std::string& name, const std::optional<std::string>& of) {
            return values_array(r.mesh(), r.kind(name, of));
          },
          "name"_a, "of"_a = nb::none(),
          "A field's values, a copy: one row a vertex or cell. KeyError where there is none; ValueError "
          "where "
          "vertices and cells have one each and `of`, 'vertices' or 'cells', does not say which.")
      .def("set_field", &OwnedRemesher::set_field, "name"_a, "values"_a, "of"_a = nb::none(),
           "Replaces a field's values. KeyError where there is none of the name, ValueError for another "
           "shape, floats for integers, or a name that is of vertices and of cells, without `of`.");
  bind_reading(type);
}

}  // namespace hfr::python
