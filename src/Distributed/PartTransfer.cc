// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartTransfer.hh"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "Distributed/AskOwners.hh"
#include "Distributed/Buffer.hh"
#include "Distributed/OldRegion.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/PartCavities.hh"
#include "Distributed/PartChanges.hh"
#include "HalfFace/Geometry.hh"
#include "Transfer/Gradients.hh"
#include "Transfer/Locate.hh"
#include "Transfer/NearVertex.hh"
#include "Transfer/Overlaps.hh"
#include "Transfer/PlacedValue.hh"

namespace hfr::mpi {
namespace {

using Named = OldRegion::Named;
constexpr Named kNobody = {kNoNumber, 0};

std::vector<std::uint64_t> numbers_of(const DistributedMesh& mesh, const auto& things) {
  std::vector<std::uint64_t> numbers;
  for (auto thing : things) numbers.push_back(mesh.number(thing));
  return numbers;
}

std::size_t own_place(const std::vector<std::uint64_t>& numbers, std::uint64_t number) {
  const auto at = std::ranges::lower_bound(numbers, number);
  if (at == numbers.end() || *at != number)
    throw InternalError("a rank was asked for a value that it does not own");
  return static_cast<std::size_t>(at - numbers.begin());
}

OldPlaces places_before(const DistributedMesh& old, const DistributedMesh& now, const PartChanges& changes) {
  OldPlaces places;
  const std::vector<std::uint64_t> vertices = numbers_of(old, own_vertices(old));
  for (std::uint64_t number : numbers_of(now, own_vertices(now)))
    places.vertices.push_back(changes.is_old(number) ? own_place(vertices, number) : OldPlaces::kCreated);
  const std::vector<std::uint64_t> cells = numbers_of(old, own_cells(old));
  for (CellHandle c : own_cells(now)) {
    const CellHandle was = changes.old_cell(c);
    places.cells.push_back(was.is_valid() ? own_place(cells, old.number(was)) : OldPlaces::kCreated);
  }
  return places;
}

class PartTransfer {
 public:
  PartTransfer(const DistributedMesh& old, DistributedMesh& now,
               std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered,
               std::span<PartField> fields, par::Policy policy)
      : old_(old),
        now_(now),
        comm_(now.comm()),
        policy_(policy),
        fields_(fields),
        changes_(old, now, renumbered),
        region_(
            old, [this](CellHandle c) { return changes_.has_changed(c); }, policy),
        reports_(fields.size()) {}

  std::vector<FieldReport> run() {
    find_own();
    find_near();
    find_placed();
    const bool of_vertices = has([](const PartField& f) { return is_of_vertices(f.how.how); });
    if (of_vertices) transfer_of_vertices();
    if (has_fields_of_cells()) transfer_of_cells();
    const bool any = comm_.sum(placed_.size() + changed_.size() + region_.n_own_changed()) > 0;
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      reports_[f].name = fields_[f].how.name;
      std::array<std::uint64_t, 2> n = {reports_[f].n_changed, reports_[f].n_outside};
      comm_.sum(n);
      reports_[f].n_changed = static_cast<std::size_t>(n[0]);
      reports_[f].n_outside = static_cast<std::size_t>(n[1]);
    }
    return any ? std::move(reports_) : std::vector<FieldReport>();
  }

 private:
  /// A changed cell of this rank, and the old one that it is; invalid: created.
  struct Changed {
    CellHandle now, old;
  };
  /// A vertex of the part that is new or has moved, own or of a changed cell.
  struct Placed {
    VertexHandle vertex;
    Named near;
    bool is_own = false;
    std::uint64_t old_cell = kNoNumber;
    std::array<double, 4> weights{};
    bool inside = true;
  };

  template <class Is>
  bool has(Is&& is) const {
    return std::any_of(fields_.begin(), fields_.end(), is);
  }
  bool has_fields_of_cells() const {
    return has([](const PartField& f) { return !is_of_vertices(f.how.how); });
  }
  const TetMesh& part() const { return now_.part(); }

  void find_own() {
    own_vertices_ = own_vertices(now_);
    own_cells_ = own_cells(now_);
    own_old_vertices_ = numbers_of(old_, own_vertices(old_));
    own_old_cells_ = numbers_of(old_, own_cells(old_));
    from_ = places_before(old_, now_, changes_);
    for (std::size_t i = 0; i < own_cells_.size(); ++i) {
      const bool is_new = from_.cells[i] == OldPlaces::kCreated;
      const CellHandle was = is_new ? CellHandle() : old_.cell_at(own_old_cells_[from_.cells[i]]);
      if (is_new || changes_.has_moved(was, own_cells_[i])) changed_.push_back({own_cells_[i], was});
    }
  }

  /// As find_near_vertices() of Edits.cc; after each layer others learn of it.
  void find_near() {
    near_.assign(part().n_vertices(), kNobody);
    std::vector<VertexHandle> open;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      const VertexHandle v(i);
      if (part().is_deleted(v)) continue;
      if (changes_.is_old(now_.number(v)))
        near_[i] = {now_.number(v), now_.owner(v)};
      else if (now_.is_own(v))
        open.push_back(v);
    }
    if (comm_.sum(open.size()) == 0) return;
    const Stars stars(part(), open, policy_);
    const auto held_by = now_.held_by_others();
    struct Told {
      std::uint64_t vertex = 0;
      Named near;
    };
    for (std::uint64_t n_found = 1; n_found > 0;) {
      std::vector<std::pair<VertexHandle, Named>> layer;
      for (VertexHandle v : open) {
        const VertexHandle u = neighbour_with_near_vertex(
            part(), v, stars.of(v), [&](VertexHandle w) { return near_[w.idx()] != kNobody; });
        if (u.is_valid()) layer.emplace_back(v, near_[u.idx()]);
      }
      for (const auto& [v, near] : layer) near_[v.idx()] = near;
      std::vector<Packer> to(comm_.n_ranks());
      for (std::size_t r = 0; r < to.size(); ++r)
        for (VertexHandle v : held_by[r])
          if (std::ranges::binary_search(open, v) && near_[v.idx()] != kNobody)
            to[r].put(Told{now_.number(v), near_[v.idx()]});
      const Comm::Exchanged came = comm_.exchange(to, layer.size());
      for (const Comm::Message& message : came.messages)
        for (Unpacker in(message.bytes); !in.at_end();) {
          const auto told = in.get<Told>();
          if (const VertexHandle v = now_.vertex_at(told.vertex); v.is_valid()) near_[v.idx()] = told.near;
        }
      std::erase_if(open, [&](VertexHandle v) { return near_[v.idx()] != kNobody; });
      n_found = came.sum;
    }
  }

  /// Which vertices are new or have moved, and where they lie in the old mesh.
  void find_placed() {
    std::vector<VertexHandle> asked;
    for (VertexHandle v : own_vertices_) {
      const VertexHandle was =
          changes_.is_old(now_.number(v)) ? old_.vertex_at(now_.number(v)) : VertexHandle();
      if (!was.is_valid() || !(old_.part().point(was) == part().point(v))) asked.push_back(v);
    }
    if (has_fields_of_cells())
      for (const Changed& c : changed_)
        for (VertexHandle v : part().cell(c.now).v) asked.push_back(v);
    std::ranges::sort(asked);
    asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
    std::vector<Named> stars;
    for (VertexHandle v : asked)
      if (near_[v.idx()] != kNobody) stars.push_back(near_[v.idx()]);
    region_.ask_for_stars(std::move(stars));
    for (VertexHandle v : asked) {
      const Named& near = near_[v.idx()];
      const VertexHandle was = near == kNobody ? VertexHandle() : region_.vertex_at(near.number);
      const bool is_there =
          changes_.is_old(now_.number(v)) && was.is_valid() && region_.mesh().point(was) == part().point(v);
      if (!is_there) placed_.push_back({v, near, now_.is_own(v), kNoNumber, {}, true});
    }
    std::vector<std::size_t> open(placed_.size());
    for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
    while (comm_.sum(open.size()) > 0) open = locate_all(open);
  }

  /// Returns those of which the search has come to where the region ends; by then it goes on there.
  std::vector<std::size_t> locate_all(std::span<const std::size_t> open) {
    const TetMesh& mesh = region_.mesh();
    const auto near_of = [&](std::size_t i) {
      return placed_[i].near == kNobody ? VertexHandle() : region_.vertex_at(placed_[i].near.number);
    };
    std::vector<VertexHandle> near;
    for (std::size_t i : open) near.push_back(near_of(i));
    const Stars stars(mesh, near, policy_);
    std::vector<Place> places(open.size());
    std::vector<CutFaces> cuts(open.size(), CutFaces{region_.is_cut()});
    constexpr double kNanoseconds = 2'000;  // a vertex, about
    par::for_each_dynamic(policy_.for_items_of(kNanoseconds), open.size(), 64, [&](std::size_t k) {
      places[k] = locate(mesh, part().point(placed_[open[k]].vertex), stars.of(near[k]), &cuts[k]);
    });
    std::vector<std::size_t> again;
    std::vector<Named> beyond;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Placed& v = placed_[open[k]];
      if (!cuts[k].met.empty()) {
        for (HalfFaceHandle h : cuts[k].met)
          for (VertexHandle u : mesh.cell(cell_of(h)).v) beyond.push_back(region_.name(u));
        again.push_back(open[k]);
        continue;
      }
      if (places[k].cell.is_valid()) v.old_cell = region_.number(places[k].cell);
      v.weights = places[k].weights;
      v.inside = places[k].inside;
    }
    region_.ask_for_stars(std::move(beyond));
    return again;
  }

  /// With handles of the part and of the region.
  PlacedVertex as_placed(const Placed& v) const {
    PlacedVertex placed;
    placed.vertex = v.vertex;
    if (v.near != kNobody) placed.near_vertex = region_.vertex_at(v.near.number);
    placed.point = part().point(v.vertex);
    if (v.old_cell != kNoNumber) placed.old_cell = region_.cell_at(v.old_cell);
    placed.weights = v.weights;
    placed.inside = v.inside;
    return placed;
  }

  void transfer_of_vertices() {
    const bool bends = has([](const PartField& f) { return f.how.how == Transfer::kQuadratic; });
    if (bends) {
      std::vector<Named> corners;
      for (const Placed& v : placed_)
        if (v.is_own && v.old_cell != kNoNumber)
          for (VertexHandle u : region_.mesh().cell(region_.cell_at(v.old_cell)).v)
            corners.push_back(region_.name(u));
      region_.ask_for_stars(std::move(corners));
    }
    const TetMesh& mesh = region_.mesh();
    std::vector<PlacedVertex> placed;
    std::vector<CellHandle> cells;
    for (const Placed& v : placed_) {
      if (!v.is_own) continue;
      placed.push_back(as_placed(v));
      if (placed.back().old_cell.is_valid()) cells.push_back(placed.back().old_cell);
    }
    std::optional<Gradients> gradients;
    if (bends) gradients.emplace(mesh, cells, policy_);
    std::vector<VertexHandle> needed;
    for (const PlacedVertex& v : placed) {
      if (!v.old_cell.is_valid()) {
        if (v.near_vertex.is_valid()) needed.push_back(v.near_vertex);
        continue;
      }
      for (VertexHandle u : mesh.cell(v.old_cell).v) {
        needed.push_back(u);
        if (bends)
          for (const Gradients::Term& term : gradients->terms(u)) needed.push_back(term.neighbour);
      }
    }
    std::ranges::sort(needed);
    needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
    std::vector<Named> names;
    for (VertexHandle v : needed) names.push_back(region_.name(v));
    const std::size_t width = width_of([](const PartField& f) { return is_of_vertices(f.how.how); });
    const std::vector<double> rows =
        ask_owners<double>(comm_, names, width, [&](std::uint64_t n, std::vector<double>& out) {
          append_row(own_place(own_old_vertices_, n), true, out);
        });
    std::size_t first = 0;  // column of the field
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      PartField& field = fields_[f];
      if (!is_of_vertices(field.how.how)) continue;
      std::vector<double> values = carried(field, from_.vertices);
      const Gradients* const by = field.how.how == Transfer::kQuadratic ? &*gradients : nullptr;
      for (const PlacedVertex& v : placed) {
        const bool has_place = v.old_cell.is_valid();
        reports_[f].n_outside += has_place && v.inside ? 0 : 1;
        if (!has_place && !v.near_vertex.is_valid()) continue;
        ++reports_[f].n_changed;
        const auto at = static_cast<std::size_t>(std::ranges::lower_bound(own_vertices_, v.vertex) -
                                                 own_vertices_.begin());
        for (std::size_t k = 0; k < field.n_components; ++k) {
          const auto get = [&](VertexHandle u) {
            const auto i = static_cast<std::size_t>(std::ranges::lower_bound(needed, u) - needed.begin());
            return rows[width * i + first + k];
          };
          values[field.n_components * at + k] = has_place ? value_at(mesh, v, by, get) : get(v.near_vertex);
        }
      }
      first += field.n_components;
      field.values = std::move(values);
    }
  }

  void transfer_of_cells() {
    std::vector<TetBox> boxes;
    for (const Changed& c : changed_) boxes.emplace_back(points_of(part(), c.now));
    region_.ask_for_changed(boxes);
    const TetMesh& mesh = region_.mesh();
    std::vector<CellHandle> old_cells;
    for (std::size_t i = 0; i < mesh.n_cells(); ++i)
      if (region_.is_changed(CellHandle(i))) old_cells.emplace_back(i);
    std::vector<NewCell> cells;
    for (const Changed& c : changed_) cells.push_back(shape_of(c.now));
    Overlaps overlaps = find_overlaps(mesh, cells, old_cells, policy_);
    std::vector<CellHandle> beside =
        old_cells_beside(mesh, overlaps, policy_, [&](std::span<const std::size_t> places) {
          std::vector<NewCell> uncovered;
          for (const std::size_t i : places) uncovered.push_back(cells[i]);
          return uncovered;
        });
    needed_cells_ = old_cells;
    for (CellHandle c : beside)
      if (c.is_valid()) needed_cells_.push_back(c);
    std::ranges::sort(needed_cells_);
    needed_cells_.erase(std::unique(needed_cells_.begin(), needed_cells_.end()), needed_cells_.end());
    std::vector<Named> names;
    for (CellHandle c : needed_cells_) names.push_back({region_.number(c), region_.owner(c)});
    cell_width_ = width_of([](const PartField& f) { return !is_of_vertices(f.how.how); });
    cell_rows_ =
        ask_owners<double>(comm_, names, cell_width_, [&](std::uint64_t n, std::vector<double>& out) {
          append_row(own_place(own_old_cells_, n), false, out);
        });
    inherit(cells, overlaps, beside);
    if (has([](const PartField& f) { return f.how.how == Transfer::kConserve; }))
      conserve_all(std::move(old_cells), std::move(overlaps), std::move(beside));
  }

  NewCell shape_of(CellHandle c) const {
    NewCell cell{.vertices = part().cell(c).v, .points = points_of(part(), c)};
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle v = cell.vertices[k];
      if (near_[v.idx()] != kNobody) cell.near[k] = region_.vertex_at(near_[v.idx()].number);
      const auto at = std::ranges::lower_bound(placed_, v, {}, &Placed::vertex);
      if (at != placed_.end() && at->vertex == v && at->old_cell != kNoNumber)
        cell.places[k] = region_.cell_at(at->old_cell);
    }
    return cell;
  }

  void inherit(std::span<const NewCell> cells, const Overlaps& overlaps, std::span<const CellHandle> beside) {
    if (!has([](const PartField& f) { return f.how.how == Transfer::kInherit; })) return;
    const Parents parents = parents_of(cells, overlaps, policy_);
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      PartField& field = fields_[f];
      if (field.how.how != Transfer::kInherit) continue;
      std::vector<double> values = carried(field, from_.cells);
      for (std::size_t i = 0; i < changed_.size(); ++i) {
        if (changed_[i].old.is_valid()) continue;
        const bool is_covered = !parents.of(i).empty();
        reports_[f].n_outside += is_covered ? 0 : 1;
        const CellHandle parent = is_covered ? parents.of(i).front().old_cell : beside[i];
        if (!parent.is_valid()) continue;
        ++reports_[f].n_changed;
        for (std::size_t k = 0; k < field.n_components; ++k)
          values[field.n_components * place_of(changed_[i].now) + k] = old_value(f, k, parent);
      }
      field.values = std::move(values);
    }
  }

  void conserve_all(std::vector<CellHandle> old_cells, Overlaps overlaps, std::vector<CellHandle> beside) {
    std::vector<CellHandle> new_cells;
    std::vector<std::uint64_t> new_numbers;
    std::vector<double> new_volume;
    std::vector<PartCavities::NewNeighbour> neighbours;
    for (std::size_t i = 0; i < changed_.size(); ++i) {
      const CellHandle c = changed_[i].now;
      new_cells.push_back(c);
      new_numbers.push_back(now_.number(c));
      new_volume.push_back(volume(part(), c));
      if (!overlaps.of(i).empty()) continue;
      for (HalfFaceHandle m : part().cell(c).mate) {
        if (!m.is_valid()) continue;
        const auto& v = part().cell(cell_of(m)).v;
        const VertexHandle first = std::min(std::min(v[0], v[1]), std::min(v[2], v[3]));
        neighbours.push_back({i, now_.number(cell_of(m)), now_.owner(first)});
      }
    }
    PartCavities parts(comm_, region_, old_cells, new_cells, new_numbers, std::move(overlaps),
                       std::move(new_volume), beside, neighbours);
    const auto column = [&](std::size_t f, std::size_t k) {
      std::vector<double> values;
      for (CellHandle c : old_cells) values.push_back(old_value(f, k, c));
      return values;
    };
    std::map<std::string, std::size_t> by_name;
    for (std::size_t f = 0; f < fields_.size(); ++f)
      if (fields_[f].how.how == Transfer::kConserve) by_name[fields_[f].how.name] = f;
    std::map<std::string, std::vector<double>> new_densities;
    // Densities before what they weigh.
    for (const bool has_density : {false, true})
      for (std::size_t f = 0; f < fields_.size(); ++f) {
        PartField& field = fields_[f];
        if (field.how.how != Transfer::kConserve || field.how.density.empty() == has_density) continue;
        std::vector<double> old_density, new_density;
        if (has_density) {
          old_density = column(by_name.at(field.how.density), 0);
          new_density = new_densities.at(field.how.density);
        }
        std::vector<double> values = carried(field, from_.cells);
        reports_[f].n_changed = changed_.size();
        for (std::size_t i = 0; i < changed_.size(); ++i)
          reports_[f].n_outside += parts.cavities().is_outside(i) ? 1 : 0;
        for (std::size_t k = 0; k < field.n_components; ++k) {
          std::vector<double> fallback;
          for (std::size_t i = 0; i < changed_.size(); ++i)
            fallback.push_back(beside[i].is_valid() ? old_value(f, k, beside[i]) : 0.0);
          const Conserved conserved =
              conserve(parts.cavities(), column(f, k), old_density, new_density, fallback, &parts);
          for (std::size_t i = 0; i < changed_.size(); ++i)
            values[field.n_components * place_of(changed_[i].now) + k] = conserved.values[i];
          reports_[f].integral.push_back(conserved.integral);
          reports_[f].lost.push_back(conserved.lost);
          if (k == 0) new_densities[field.how.name] = conserved.values;
        }
        field.values = std::move(values);
      }
  }

  // --- values ---

  template <class Of>
  std::size_t width_of(Of&& of) const {
    std::size_t width = 0;
    for (const PartField& field : fields_) width += of(field) ? field.n_components : 0;
    return width;
  }
  /// What the fields that are not transferred yet have of one thing; of vertices, or of cells.
  void append_row(std::size_t at, bool of_vertices, std::vector<double>& out) const {
    for (const PartField& field : fields_) {
      if (is_of_vertices(field.how.how) != of_vertices) continue;
      const auto* row = field.values.data() + field.n_components * at;
      out.insert(out.end(), row, row + field.n_components);
    }
  }
  double old_value(std::size_t f, std::size_t k, CellHandle c) const {
    std::size_t first = 0;
    for (std::size_t g = 0; g < f; ++g)
      first += is_of_vertices(fields_[g].how.how) ? 0 : fields_[g].n_components;
    const auto at =
        static_cast<std::size_t>(std::ranges::lower_bound(needed_cells_, c) - needed_cells_.begin());
    return cell_rows_[cell_width_ * at + first + k];
  }
  std::size_t place_of(CellHandle now) const {
    const auto at = std::ranges::lower_bound(own_cells_, now_.number(now), {},
                                             [&](CellHandle c) { return now_.number(c); });
    return static_cast<std::size_t>(at - own_cells_.begin());
  }
  /// The old values of what was there, and 0 for what was not. `from`: by thing of this rank, its place among
  /// those that it had.
  static std::vector<double> carried(const PartField& field, const std::vector<std::size_t>& from) {
    std::vector<double> values(field.n_components * from.size(), 0.0);
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i] != OldPlaces::kCreated)
        std::copy_n(field.values.data() + field.n_components * from[i], field.n_components,
                    values.data() + field.n_components * i);
    return values;
  }

  const DistributedMesh& old_;
  DistributedMesh& now_;
  Comm& comm_;
  par::Policy policy_;
  std::span<PartField> fields_;
  PartChanges changes_;
  OldRegion region_;
  std::vector<VertexHandle> own_vertices_;  // of the mesh as it is, as the next two
  std::vector<CellHandle> own_cells_;       // in the order of numbers
  std::vector<Changed> changed_;
  std::vector<Named> near_;                                      // by vertex of the part: the old one near it
  std::vector<Placed> placed_;                                   // ascending
  std::vector<std::uint64_t> own_old_vertices_, own_old_cells_;  // numbers
  OldPlaces from_;                                               // which of those each was
  std::vector<CellHandle> needed_cells_;                         // of the region, ascending
  std::size_t cell_width_ = 0;
  std::vector<double> cell_rows_;  // of these: what all fields of cells have
  std::vector<FieldReport> reports_;
};

}  // namespace

std::vector<FieldReport> transfer_in_parts(
    const DistributedMesh& old, DistributedMesh& now,
    std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered, std::span<PartField> fields,
    par::Policy policy) {
  const Comm::InPhase phase(now.comm(), Phase::kBorder);
  return PartTransfer(old, now, renumbered, fields, policy).run();
}

OldPlaces old_places(const DistributedMesh& old, const DistributedMesh& now,
                     std::span<const std::pair<std::uint64_t, std::uint64_t>> renumbered) {
  return places_before(old, now, PartChanges(old, now, renumbered));
}

/// By way of the rank that keeps that stretch of the numbers.
template <class T>
std::vector<T> rows_where_wanted(Comm& comm, std::uint64_t n, std::span<const std::uint64_t> had,
                                 std::span<const T> rows, std::size_t width,
                                 std::span<const std::uint64_t> wanted) {
  const std::uint64_t stretch = std::max<std::uint64_t>(1, (n + comm.n_ranks() - 1) / comm.n_ranks());
  const auto keeper = [&](std::uint64_t number) { return static_cast<std::size_t>(number / stretch); };
  const auto row_at = [&](std::span<const std::uint64_t> numbers, std::uint64_t number) {
    const auto at = std::ranges::lower_bound(numbers, number);
    return at != numbers.end() && *at == number ? static_cast<std::size_t>(at - numbers.begin())
                                                : numbers.size();
  };
  std::vector<Packer> to(comm.n_ranks());
  for (std::size_t i = 0; i < had.size(); ++i) {
    if (std::ranges::binary_search(wanted, had[i])) continue;
    Packer& out = to[keeper(had[i])];
    out.put(had[i]);
    for (std::size_t k = 0; k < width; ++k) out.put(rows[width * i + k]);
  }
  std::map<std::uint64_t, std::vector<T>> kept;
  for (const Comm::Message& message : comm.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      std::vector<T>& row = kept[in.get<std::uint64_t>()];
      for (std::size_t k = 0; k < width; ++k) row.push_back(in.get<T>());
    }
  std::vector<Named> asked;
  for (std::uint64_t number : wanted)
    if (row_at(had, number) == had.size())
      asked.push_back({number, static_cast<std::int64_t>(keeper(number))});
  const std::vector<T> fetched =
      ask_owners<T>(comm, asked, width, [&](std::uint64_t number, std::vector<T>& out) {
        const auto at = kept.find(number);
        if (at == kept.end()) throw InternalError("nobody has a value that a rank wants");
        out.insert(out.end(), at->second.begin(), at->second.end());
      });
  std::vector<T> all;
  all.reserve(width * wanted.size());
  std::size_t next = 0;
  for (std::uint64_t number : wanted) {
    const std::size_t i = row_at(had, number);
    const T* row = i < had.size() ? rows.data() + width * i : fetched.data() + width * next++;
    all.insert(all.end(), row, row + width);
  }
  return all;
}

template std::vector<double> rows_where_wanted(Comm&, std::uint64_t, std::span<const std::uint64_t>,
                                               std::span<const double>, std::size_t,
                                               std::span<const std::uint64_t>);
template std::vector<std::uint64_t> rows_where_wanted(Comm&, std::uint64_t, std::span<const std::uint64_t>,
                                                      std::span<const std::uint64_t>, std::size_t,
                                                      std::span<const std::uint64_t>);

}  // namespace hfr::mpi
