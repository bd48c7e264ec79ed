// SPDX-License-Identifier: BSD-3-Clause
// What put_together() does on one rank, without it: vertices and cells get their places from an order over
// all ranks, and what is to be known of a point with a label is known on a rank that its vertices choose.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

#include "Plex.hh"
#include "Tuples.hh"
#include "hfremesh/Distributed/Order.hh"
#include "hfremesh/Distributed/RankArrays.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::petsc {
namespace {

using mpi::Comm;
using mpi::LabelRecord;
using Place = std::uint64_t;
using Point = Tuple<Place>;
using Values = std::vector<Labelling::Value>;

/// Places of this rank's vertices among those of all: by coordinates, then by their numbers.
class Places {
 public:
  Places(Comm& comm, const LocalPlex& mine) {
    std::vector<mpi::OrderKey> keys;
    keys.reserve(mine.points.size());
    for (std::size_t i = 0; i < mine.points.size(); ++i) {
      const Vec3& p = mine.points[i];
      keys.push_back({mpi::ordered_bits(p.x), mpi::ordered_bits(p.y), mpi::ordered_bits(p.z),
                      static_cast<std::uint64_t>(mine.numbers[i])});
    }
    places_ = mpi::places_in_order(comm, keys);
    for (std::size_t i = 0; i < places_.size(); ++i) of_number_.emplace(mine.numbers[i], places_[i]);
  }

  const std::vector<Place>& all() const { return places_; }
  Point at(const std::array<std::int64_t, 4>& numbers, int n) const {
    Point v;
    v.fill(kNone<Place>);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      const auto found = of_number_.find(numbers[i]);
      HFR_REQUIRE(found != of_number_.end(), "the DMPlex names a vertex that no rank has");
      v[i] = found->second;
    }
    return v;
  }

 private:
  std::vector<Place> places_;
  std::unordered_map<std::int64_t, Place> of_number_;
};

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
  Point point;
  std::int32_t label = 0, value = 0;
  std::uint8_t bounds = 0;

  std::tuple<Point, int> place() const { return {point, label}; }
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
  std::map<std::tuple<Point, int>, std::set<int>> marked_, implied_;
};

/// Fills in the names of labels and whether they are closed. Returns the values of this rank's points that
/// are kept as constraints.
std::map<Point, Values> values_of(Comm& comm, const LocalPlex& mine, const Places& places,
                                  Labelling& labelling) {
  const std::vector<std::string> names = common_names(comm, mine.names);
  std::vector<std::int32_t> label_of;  // by own name
  for (const std::string& name : mine.names)
    label_of.push_back(static_cast<std::int32_t>(std::ranges::lower_bound(names, name) - names.begin()));
  const auto home_of = [&](const Point& point) {
    std::uint64_t hash = 0;
    for (Place v : point) hash = mix64(hash ^ v);
    return hash % comm.n_ranks();
  };
  std::vector<std::vector<Item>> items(comm.n_ranks());
  for (const Mark& mark : mine.marks) {
    const Item item{point_of(places.at(mark.v, mark.n)), label_of[static_cast<std::size_t>(mark.label)],
                    mark.value, 0};
    items[home_of(item.point)].push_back(item);
    for (const Point& face : faces_of(item.point))
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
  std::map<Point, Values> values;
  for (std::size_t r = 0; r < items.size(); ++r)
    for (std::size_t i = 0; i < items[r].size(); ++i) {
      const Item& item = items[r][i];
      if (item.bounds != 0) continue;
      if (is_closed[static_cast<std::size_t>(item.label)] != 0 && implied[r][i] != 0) continue;
      values[item.point].push_back({item.label, item.value});
    }
  for (auto& [point, set] : values) {
    std::ranges::sort(set);
    set.erase(std::ranges::unique(set).begin(), set.end());
  }
  return values;
}

/// Numbers from 1 on for the sets of all ranks.
std::map<Values, int> number_sets(Comm& comm, const std::map<Point, Values>& values, Labelling& labelling) {
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

LabelRecord::Kind kind_of(int n_vertices) {
  return n_vertices == 1   ? LabelRecord::Kind::kVertex
         : n_vertices == 2 ? LabelRecord::Kind::kEdge
                           : LabelRecord::Kind::kFace;
}

/// Gives points their values: regions of cells, labels of the others.
void attach(const std::map<Point, Values>& values, const std::map<Values, int>& numbers,
            mpi::RankArrays& arrays) {
  for (const auto& [point, set] : values) {
    const int n = n_vertices(point);
    if (n == 4) continue;
    LabelRecord r;
    r.kind = kind_of(n);
    std::copy_n(point.begin(), n, r.v.begin());
    r.value = numbers.at(set);
    arrays.labels.push_back(r);
  }
  for (const Point& cell : arrays.cells) {
    const auto at = values.find(point_of(cell));
    arrays.regions.push_back(at == values.end() ? 0 : numbers.at(at->second));
  }
}

}  // namespace

Labelling put_in_parts(mpi::DistributedMesh& mesh, const LocalPlex& mine) {
  Comm& comm = mesh.comm();
  const Places places(comm, mine);
  mpi::RankArrays arrays;
  arrays.vertex_number = places.all();
  arrays.points = mine.points;
  arrays.cells.reserve(mine.cells.size());
  for (const auto& cell : mine.cells) arrays.cells.push_back(turned(places.at(cell, 4)));
  arrays.cell_number = mpi::places_in_order(comm, arrays.cells);
  Labelling labelling;
  const std::map<Point, Values> values = values_of(comm, mine, places, labelling);
  attach(values, number_sets(comm, values, labelling), arrays);
  mpi::from_arrays(mesh, arrays);
  return labelling;
}

NewPlex new_plex(mpi::DistributedMesh& mesh) {
  Comm& comm = mesh.comm();
  mpi::RankArrays arrays = mpi::own_arrays(mesh);
  std::uint64_t n_own = 0;
  for (int owner : arrays.owner) n_own += owner == comm.rank() ? 1 : 0;
  NewPlex mine;
  mine.n_vertices = comm.sum(n_own);
  const auto begin = [&](std::uint64_t r) {
    return (r * mine.n_vertices + comm.n_ranks() - 1) / comm.n_ranks();
  };
  std::vector<mpi::Packer> to(comm.n_ranks());
  for (std::size_t i = 0; i < arrays.points.size(); ++i) {
    if (arrays.owner[i] != comm.rank()) continue;
    mpi::Packer& out = to[arrays.vertex_number[i] * comm.n_ranks() / mine.n_vertices];
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
