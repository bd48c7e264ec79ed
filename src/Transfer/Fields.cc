// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Fields.hh"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "IO/FieldLayout.hh"
#include "Transfer/Conserve.hh"
#include "Transfer/Gradients.hh"
#include "Transfer/Overlaps.hh"
#include "Transfer/PlacedValue.hh"

namespace hfr {
namespace {

using detail::DenseStored;

constexpr std::array<std::pair<std::string_view, Transfer>, 4> kNames = {{{"linear", Transfer::kLinear},
                                                                          {"quadratic", Transfer::kQuadratic},
                                                                          {"inherit", Transfer::kInherit},
                                                                          {"conserve", Transfer::kConserve}}};

DenseStored* find(const PropertySet::DenseList& list, const std::string& name) {
  for (const std::shared_ptr<DenseStored>& p : list)
    if (p->name() == name && !p->is_anonymous()) return p.get();
  return nullptr;
}

/// Floating-point values of one property, whatever its type, by item and component.
class Values {
 public:
  virtual ~Values() = default;
  virtual int n_components() const = 0;
  virtual double get(std::size_t i, int k) const = 0;
  virtual void set(std::size_t i, int k, double x) = 0;
};

template <class T>
class ValuesOf final : public Values {
 public:
  explicit ValuesOf(detail::Dense<T>& property)
      : property_(property), n_components_(io::n_components(property.preset, property.values)) {}
  int n_components() const override { return n_components_; }
  double get(std::size_t i, int k) const override { return io::Layout<T>::get(property_.values[i], k); }
  void set(std::size_t i, int k, double x) override { io::Layout<T>::set(property_.values[i], k, x); }

 private:
  detail::Dense<T>& property_;
  int n_components_;
};

template <class... T>
std::unique_ptr<Values> values_of_one(DenseStored& property) {
  std::unique_ptr<Values> found;
  const auto try_one = [&]<class U>(std::type_identity<U>) {
    if (property.type() == typeid(U))
      found = std::make_unique<ValuesOf<U>>(static_cast<detail::Dense<U>&>(property));
  };
  (try_one(std::type_identity<T>{}), ...);
  return found;
}

/// Null for a property of another type.
std::unique_ptr<Values> values_of(DenseStored& property) {
  return values_of_one<double, float, Vec3, std::vector<double>, std::array<double, 2>, std::array<double, 3>,
                       std::array<double, 4>, std::array<double, 6>, std::array<double, 9>,
                       std::array<float, 2>, std::array<float, 3>, std::array<float, 4>, std::array<float, 6>,
                       std::array<float, 9>>(property);
}

/// The property that a transfer works on; throws InvalidInput where there is none that it could.
DenseStored& required(const TetMesh& mesh, const std::string& name, Transfer how) {
  const bool of_vertices = is_of_vertices(how);
  const auto& list = of_vertices ? mesh.properties().vertices : mesh.properties().cells;
  const auto& other = of_vertices ? mesh.properties().cells : mesh.properties().vertices;
  DenseStored* found = find(list, name);
  const std::string kind = of_vertices ? "vertices" : "cells";
  if (!found && find(other, name))
    throw InvalidInput("field '" + name + "' is one of " + (of_vertices ? "cells" : "vertices") +
                       ", and is to be transferred as one of " + kind);
  if (!found) throw InvalidInput("there is no field '" + name + "' of " + kind);
  if (how != Transfer::kInherit && !values_of(*found))
    throw InvalidInput("field '" + name + "' does not hold floating-point numbers: it can be inherited only" +
                       (of_vertices ? ", as a field of cells" : ""));
  return *found;
}

/// Linearly, and with gradients bent.
void transfer_interpolated(const TetMesh& old, TetMesh& now, const Edits& edits, const std::string& name,
                           const Gradients* gradients, FieldReport& report) {
  const auto from = values_of(required(old, name, Transfer::kLinear));
  const auto to = values_of(required(now, name, Transfer::kLinear));
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list) {
      const bool has_place = v.old_cell.is_valid();
      report.n_outside += has_place && v.inside ? 0 : 1;
      if (!has_place && !v.near_vertex.is_valid()) continue;
      ++report.n_changed;
      for (int k = 0; k < from->n_components(); ++k) {
        const auto get = [&](VertexHandle u) { return from->get(u.idx(), k); };
        to->set(v.vertex.idx(), k, has_place ? value_at(old, v, gradients, get) : get(v.near_vertex));
      }
    }
}

/// The old cells that vertices have been put in.
std::vector<CellHandle> places_of(const Edits& edits) {
  std::vector<CellHandle> cells;
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list)
      if (v.old_cell.is_valid()) cells.push_back(v.old_cell);
  return cells;
}

void transfer_inherited(const TetMesh& old, TetMesh& now, const Edits& edits, const std::string& name,
                        par::Policy policy, FieldReport& report) {
  const DenseStored& from = required(old, name, Transfer::kInherit);
  DenseStored& to = required(now, name, Transfer::kInherit);
  const Parents& parents = edits.parents();
  const auto shapes = [&](std::span<const std::size_t> places) {
    std::vector<CellHandle> cells;
    for (const std::size_t i : places) cells.push_back(edits.created_cells[i].cell);
    return shapes_of(now, edits, cells);
  };
  const std::vector<CellHandle> beside = old_cells_beside(old, *overlaps_of_created(edits), policy, shapes);
  for (std::size_t i = 0; i < edits.created_cells.size(); ++i) {
    const bool is_covered = !parents.of(i).empty();
    report.n_outside += is_covered ? 0 : 1;
    const CellHandle parent = is_covered ? parents.of(i).front().old_cell : beside[i];
    if (!parent.is_valid()) continue;
    ++report.n_changed;
    to.copy_from(from, parent.idx(), edits.created_cells[i].cell.idx());
  }
}

std::vector<double> component(const Values& values, std::span<const CellHandle> cells, int k) {
  std::vector<double> out(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) out[i] = values.get(cells[i].idx(), k);
  return out;
}

void transfer_conserved(const TetMesh& old, TetMesh& now, const Cavities& cavities,
                        const FieldTransfer& field, FieldReport& report) {
  const auto from = values_of(required(old, field.name, Transfer::kConserve));
  const auto to = values_of(required(now, field.name, Transfer::kConserve));
  std::vector<double> old_density, new_density;
  if (!field.density.empty()) {
    old_density =
        component(*values_of(required(old, field.density, Transfer::kConserve)), cavities.old_cells(), 0);
    new_density =
        component(*values_of(required(now, field.density, Transfer::kConserve)), cavities.new_cells(), 0);
  }
  report.n_changed = cavities.new_cells().size();
  for (std::size_t i = 0; i < cavities.new_cells().size(); ++i)
    report.n_outside += cavities.is_outside(i) ? 1 : 0;
  for (int k = 0; k < from->n_components(); ++k) {
    std::vector<double> fallback = component(*to, cavities.new_cells(), k);
    for (std::size_t i = 0; i < fallback.size(); ++i)
      if (cavities.beside(i).is_valid()) fallback[i] = from->get(cavities.beside(i).idx(), k);
    const Conserved conserved =
        conserve(cavities, component(*from, cavities.old_cells(), k), old_density, new_density, fallback);
    for (std::size_t i = 0; i < conserved.values.size(); ++i)
      to->set(cavities.new_cells()[i].idx(), k, conserved.values[i]);
    report.integral.push_back(conserved.integral);
    report.lost.push_back(conserved.lost);
  }
}

}  // namespace

Transfer transfer_from_name(std::string_view name) {
  for (const auto& [known, transfer] : kNames)
    if (name == known) return transfer;
  throw InvalidInput("'" + std::string(name) +
                     "' is no way to transfer a field: linear, quadratic, inherit, conserve");
}

bool is_of_vertices(Transfer how) { return how == Transfer::kLinear || how == Transfer::kQuadratic; }

void validate_fields(const TetMesh& mesh, std::span<const FieldTransfer> fields) {
  for (const FieldTransfer& field : fields) {
    if (field.how == Transfer::kCallback) {
      HFR_REQUIRE(field.callback,
                  "field '" + field.name + "' is to be transferred by a callback, and has none");
      continue;
    }
    required(mesh, field.name, field.how);
    const auto is_same = [&](const FieldTransfer& f) {
      return f.name == field.name && f.how != Transfer::kCallback &&
             is_of_vertices(f.how) == is_of_vertices(field.how);
    };
    HFR_REQUIRE(std::count_if(fields.begin(), fields.end(), is_same) == 1,
                "field '" + field.name + "' is to be transferred in two ways: name one");
    if (field.density.empty()) continue;
    HFR_REQUIRE(field.how == Transfer::kConserve,
                "field '" + field.name + "' has a density, which only conserved fields have");
    const auto density = values_of(required(mesh, field.density, Transfer::kConserve));
    HFR_REQUIRE(density->n_components() == 1, "the density '" + field.density + "' of field '" + field.name +
                                                  "' has more than one component");
    HFR_REQUIRE(
        std::any_of(fields.begin(), fields.end(),
                    [&](const FieldTransfer& f) {
                      return f.name == field.density && f.how == Transfer::kConserve && f.density.empty();
                    }),
        "the density '" + field.density + "' of field '" + field.name + "' has to be conserved itself");
  }
}

std::vector<FieldReport> transfer_fields(const TetMesh& old, TetMesh& now, const Edits& edits,
                                         std::span<const FieldTransfer> fields, par::Policy policy) {
  validate_fields(old, fields);
  std::vector<FieldReport> reports(fields.size());
  std::optional<Cavities> cavities;
  std::optional<Gradients> gradients;
  // Densities before what they weigh, callbacks when all else is done.
  for (const int turn : {0, 1, 2})
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const FieldTransfer& field = fields[i];
      const bool is_callback = field.how == Transfer::kCallback;
      if (turn != (is_callback ? 2 : field.density.empty() ? 0 : 1)) continue;
      reports[i].name = field.name;
      switch (field.how) {
        case Transfer::kLinear:
          transfer_interpolated(old, now, edits, field.name, nullptr, reports[i]);
          break;
        case Transfer::kQuadratic:
          if (!gradients) gradients.emplace(old, places_of(edits), policy);
          transfer_interpolated(old, now, edits, field.name, &*gradients, reports[i]);
          break;
        case Transfer::kInherit:
          transfer_inherited(old, now, edits, field.name, policy, reports[i]);
          break;
        case Transfer::kConserve:
          if (!cavities) cavities.emplace(old, now, edits, policy);
          transfer_conserved(old, now, *cavities, field, reports[i]);
          break;
        case Transfer::kCallback:
          field.callback(old, now, edits);
          break;
      }
    }
  return reports;
}

}  // namespace hfr
