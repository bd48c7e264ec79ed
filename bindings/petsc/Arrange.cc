// SPDX-License-Identifier: BSD-3-Clause
// Vertices and cells get their places from an order over all ranks, and what is to be known of a point with a
// label is known on a rank that its vertices choose.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "Bisect.hh"
#include "Plex.hh"
#include "Tuples.hh"
#include "hfremesh/Distributed/Order.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr::petsc {
namespace {

using mpi::Comm;
using mpi::LabelRecord;
using Values = std::vector<Labelling::Value>;

/// Of vertices among those of all ranks: by coordinates, and where these are equal by `ties`.
std::vector<Place> places_of(Comm& comm, const std::vector<Vec3>& points,
                             const std::vector<std::uint64_t>& ties) {
  std::vector<mpi::OrderKey> keys;
  keys.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    keys.push_back({mpi::ordered_bits(points[i].x), mpi::ordered_bits(points[i].y),
                    mpi::ordered_bits(points[i].z), ties[i]});
  return mpi::places_in_order(comm, keys);
}

/// The places of the first n of these vertices.
Tuple tuple_of(const std::vector<Place>& places, std::span<const Index> v) {
  Tuple tuple;
  tuple.fill(kNone);
  std::ranges::transform(v, tuple.begin(), [&](Index i) { return places[i]; });
  return tuple;
}

/// The names of all ranks, in alphabetical order.
std::vector<std::string> common_names(Comm& comm, const std::vector<std::string>& mine) {
  std::string text;
  for (const std::string& name : mine) text += name + '\0';
  const std::vector<char> all = comm.all_gather(std::span<const char>(text.data(), text.size()));
  std::set<std::string> names;
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end = std::find(begin, all.end(), '\0');
    names.emplace(begin, end);
    begin = end + 1;
  }
  return {names.begin(), names.end()};
}

/// A point with a value of a label, or one that bounds such a point.
struct Item {
  Tuple point;
  std::int32_t label = 0, value = 0;
  std::uint8_t bounds = 0;

  std::tuple<Tuple, int> place() const { return {point, label}; }
};

/// Of the points that came to one rank: which labels are closed as far as it sees, and which items another
/// one implies.
class Home {
 public:
  explicit Home(const std::vector<std::vector<Item>>& came) {
    for (const auto& of_rank : came)
      for (const Item& item : of_rank)
        (item.bounds != 0 ? implied_ : marked_)[item.place()].insert(item.value);
  }
  /// By label: bit 0 where a point has a boundary, bit 1 where a part of that has no value.
  std::vector<std::uint8_t> findings(std::size_t n_labels) const {
    std::vector<std::uint8_t> found(n_labels, 0);
    for (const auto& [place, values] : implied_)
      found[static_cast<std::size_t>(std::get<1>(place))] |= marked_.contains(place) ? 1 : 3;
    return found;
  }
  bool implies(const Item& item) const {
    const auto at = implied_.find(item.place());
    return at != implied_.end() && at->second.contains(item.value);
  }

 private:
  std::map<std::tuple<Tuple, int>, std::set<int>> marked_, implied_;
};

/// Fills in the names of labels and whether they are closed. Returns the values of this rank's points that
/// are kept as constraints.
std::map<Tuple, Values> values_of(Comm& comm, const LocalPlex& mine, const std::vector<Place>& places,
                                  Labelling& labelling) {
  const std::vector<std::string> names = common_names(comm, mine.names);
  std::vector<std::int32_t> label_of;  // by own name
  for (const std::string& name : mine.names)
    label_of.push_back(static_cast<std::int32_t>(std::ranges::lower_bound(names, name) - names.begin()));
  const auto home_of = [&](const Tuple& point) {
    std::uint64_t hash = 0;
    for (Place v : point) hash = mix64(hash ^ v);
    return hash % comm.n_ranks();
  };
  std::vector<std::vector<Item>> items(comm.n_ranks());
  for (const Mark& mark : mine.marks) {
    const Item item{point_of(tuple_of(places, std::span(mark.v).first(static_cast<std::size_t>(mark.n)))),
                    label_of[static_cast<std::size_t>(mark.label)], mark.value, 0};
    items[home_of(item.point)].push_back(item);
    for (const Tuple& face : faces_of(item.point))
      items[home_of(face)].push_back({face, item.label, item.value, 1});
  }
  std::vector<std::uint8_t> is_closed(names.size(), 0);
  const auto implied = comm.ask(items, [&](const std::vector<std::vector<Item>>& came) {
    const Home home(came);
    const std::vector<std::uint8_t> all =
        comm.all_gather(std::span<const std::uint8_t>(home.findings(names.size())));
    for (std::size_t l = 0; l < names.size(); ++l) {
      std::uint8_t found = 0;
      for (std::size_t i = l; i < all.size(); i += names.size()) found |= all[i];
      is_closed[l] = found == 1 ? 1 : 0;
    }
    std::vector<std::vector<std::uint8_t>> answers(came.size());
    for (std::size_t r = 0; r < came.size(); ++r)
      for (const Item& item : came[r]) answers[r].push_back(home.implies(item) ? 1 : 0);
    return answers;
  });
  for (std::size_t l = 0; l < names.size(); ++l) labelling.labels.push_back({names[l], is_closed[l] != 0});
  std::map<Tuple, Values> values;
  for (std::size_t r = 0; r < items.size(); ++r)
    for (std::size_t i = 0; i < items[r].size(); ++i) {
      const Item& item = items[r][i];
      if (item.bounds != 0) continue;
      if (is_closed[static_cast<std::size_t>(item.label)] != 0 && implied[r][i] != 0) continue;
      values[item.point].push_back({item.label, item.value});
    }
  for (auto& [point, set] : values) {
    std::ranges::sort(set);
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  return values;
}

/// Numbers from 1 on for the sets of all ranks.
std::map<Values, int> number_sets(Comm& comm, const std::map<Tuple, Values>& values, Labelling& labelling) {
  std::set<Values> mine, all;
  for (const auto& [point, set] : values) mine.insert(set);
  mpi::Packer out;
  for (const Values& set : mine) out.put_all(set);
  const std::vector<std::byte> bytes = comm.all_gather(std::span<const std::byte>(out.bytes()));
  for (mpi::Unpacker in(bytes); !in.at_end();) all.insert(in.get_all<Labelling::Value>());
  std::map<Values, int> numbers;
  for (const Values& set : all) {
    labelling.values.push_back(set);
    numbers[set] = static_cast<int>(labelling.values.size());
  }
  return numbers;
}

/// What a rank has, by its indices of vertices, as it is before anything is halved.
Simplices simplices_of(Comm& comm, LocalPlex& mine, const std::vector<Place>& places, Labelling& labelling,
                       std::vector<std::int32_t>& vertex_values) {
  const std::map<Tuple, Values> values = values_of(comm, mine, places, labelling);
  const std::map<Values, int> numbers = number_sets(comm, values, labelling);
  const auto value_at = [&](const Tuple& v) {
    const auto at = values.find(point_of(v));
    return at == values.end() ? 0 : numbers.at(at->second);
  };
  Simplices out;
  for (Place place : places) out.ids.push_back({0, place});
  out.points = std::move(mine.points);
  out.is_shared = std::move(mine.is_shared);
  out.sizes = std::move(mine.sizes);
  out.cells.reserve(mine.cells.size());
  for (std::size_t c = 0; c < mine.cells.size(); ++c) {
    Simplices::Cell& cell = out.cells.emplace_back();
    cell.v = turned(mine.cells[c], [&](Index v) { return places[v]; });
    cell.value = value_at(tuple_of(places, cell.v));
    cell.largest = mine.largest[c];
    if (cell.largest == kRefine) cell.largest = volume_of(out, cell) / 8;
  }
  vertex_values.assign(out.points.size(), 0);
  std::set<Tuple> done;
  for (const Mark& mark : mine.marks) {
    const Tuple v = tuple_of(places, std::span(mark.v).first(static_cast<std::size_t>(mark.n)));
    const int value = value_at(v);
    if (value == 0 || mark.n == 4 || !done.insert(point_of(v)).second) continue;
    if (mark.n == 3) out.faces.push_back({{mark.v[0], mark.v[1], mark.v[2]}, value});
    if (mark.n == 2) out.edges.push_back({{mark.v[0], mark.v[1]}, value});
    if (mark.n == 1) vertex_values[mark.v[0]] = value;
  }
  return out;
}

template <std::size_t N>
void add_labels(const std::vector<Simplices::Labelled<N>>& items, const std::vector<Place>& places,
                LabelRecord::Kind kind, std::vector<LabelRecord>& labels) {
  LabelRecord r;
  r.kind = kind;
  for (const auto& item : items) {
    std::ranges::transform(item.v, r.v.begin(), [&](Index i) { return places[i]; });
    r.value = item.value;
    labels.push_back(r);
  }
}

}  // namespace

Arrangement arrange(Comm& comm, LocalPlex mine) {
  for (const Vec3& p : mine.points)  // halving would come to no end
    HFR_REQUIRE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
                "a coordinate of the DMPlex is not a finite number");
  Arrangement arranged;
  std::vector<std::uint64_t> ties(mine.numbers.begin(), mine.numbers.end());
  std::vector<Place> places = places_of(comm, mine.points, ties);
  std::vector<std::int32_t> vertex_values;
  Simplices simplices = simplices_of(comm, mine, places, arranged.labelling, vertex_values);
  mine = {};
  const std::size_t n_before = simplices.points.size();
  bisect(comm, simplices);
  for (std::size_t v = n_before; v < simplices.points.size(); ++v) ties.push_back(simplices.ids[v].a);
  if (comm.sum(simplices.points.size() - n_before) > 0) places = places_of(comm, simplices.points, ties);

  mpi::RankArrays& arrays = arranged.arrays;
  add_labels(simplices.faces, places, LabelRecord::Kind::kFace, arrays.labels);
  add_labels(simplices.edges, places, LabelRecord::Kind::kEdge, arrays.labels);
  LabelRecord r;
  for (std::size_t v = 0; v < vertex_values.size(); ++v)
    if (r.v[0] = places[v], r.value = vertex_values[v]; r.value != 0) arrays.labels.push_back(r);
  arrays.cells.reserve(simplices.cells.size());
  for (const Simplices::Cell& c : simplices.cells) {
    arrays.cells.push_back(turned(tuple_of(places, c.v), [](Place place) { return place; }));
    arrays.regions.push_back(c.value);
  }
  simplices.cells = {};
  arrays.vertex_number = std::move(places);
  arrays.points = std::move(simplices.points);
  arrays.cell_number = mpi::places_in_order(comm, arrays.cells);
  return arranged;
}

NewPlex new_plex(mpi::DistributedMesh& mesh) {
  Comm& comm = mesh.comm();
  mpi::RankArrays arrays = mpi::own_arrays(mesh);
  std::uint64_t n_own = 0;
  for (int owner : arrays.owner) n_own += owner == comm.rank() ? 1 : 0;
  NewPlex mine;
  const std::uint64_t n_vertices = comm.sum(n_own);
  const auto begin = [&](std::uint64_t r) { return (r * n_vertices + comm.n_ranks() - 1) / comm.n_ranks(); };
  std::vector<mpi::Packer> to(comm.n_ranks());
  for (std::size_t i = 0; i < arrays.points.size(); ++i) {
    if (arrays.owner[i] != comm.rank()) continue;
    mpi::Packer& out = to[arrays.vertex_number[i] * comm.n_ranks() / n_vertices];
    out.put(arrays.vertex_number[i]);
    out.put(arrays.points[i]);
  }
  const auto me = static_cast<std::uint64_t>(comm.rank());
  mine.points.resize(begin(me + 1) - begin(me));
  for (const Comm::Message& message : comm.exchange(to))
    for (mpi::Unpacker in(message.bytes); !in.at_end();) {
      const auto number = in.get<std::uint64_t>();
      mine.points[number - begin(me)] = in.get<Vec3>();
    }
  mine.cells = std::move(arrays.cells);
  mine.regions = std::move(arrays.regions);
  mine.labels = std::move(arrays.labels);
  return mine;
}

}  // namespace hfr::petsc
