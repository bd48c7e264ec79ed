// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Incoming.hh"

#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <utility>

#include "Distributed/CurveOwners.hh"
#include "HalfFace/Errors.hh"
#include "Parallel/Sort.hh"

namespace hfr::mpi {
namespace {

std::uint64_t bits_of(Vec3 p) {
  return mix64(mix64(mix64(std::bit_cast<std::uint64_t>(p.x)) ^ std::bit_cast<std::uint64_t>(p.y)) ^
               std::bit_cast<std::uint64_t>(p.z));
}

std::string differing(std::uint64_t point) {
  return "point " + std::to_string(point) + " comes with different coordinates";
}

}  // namespace

/// A set of ranks for some points, by place.
struct Incoming::Sets {
  static constexpr Index kNone = VertexHandle::kInvalid;
  std::vector<Index> of;
  std::vector<std::vector<int>> ranks;

  void add(Index at, int r) {
    if (of[at] == kNone) {
      of[at] = static_cast<Index>(ranks.size());
      ranks.emplace_back();
    }
    auto& set = ranks[of[at]];
    if (std::find(set.begin(), set.end(), r) == set.end()) set.push_back(r);
  }
  std::span<const int> operator[](Index at) const {
    return of[at] == kNone ? std::span<const int>() : std::span<const int>(ranks[of[at]]);
  }
};

/// Points and cells by number, each once, and all cells by places.
void Incoming::unite() {
  unite_points();
  cells_.reserve(cells_.size() + given_.size());
  for (const CornerRecord& c : std::exchange(given_, {})) {
    PlacedCell& cell = cells_.emplace_back(PlacedCell{c.number, {}, c.region});
    for (std::size_t k = 0; k < 4; ++k) cell.at[k] = static_cast<Index>(place(c.v[k]));
  }
  const auto less = [](const PlacedCell& a, const PlacedCell& b) { return a.number < b.number; };
  const auto middle =
      std::is_sorted_until(cells_.begin(), cells_.end(), less);  // what has come stands behind
  std::sort(middle, cells_.end(), less);
  std::inplace_merge(cells_.begin(), middle, cells_.end(), less);
  cells_.erase(std::unique(cells_.begin(), cells_.end(),
                           [](const PlacedCell& a, const PlacedCell& b) { return a.number == b.number; }),
               cells_.end());
}

/// Those up to the first that is not behind the one before it are in order, and the rest is merged into them.
void Incoming::unite_points() {
  const auto not_behind = [](const PointRecord& a, const PointRecord& b) { return a.number >= b.number; };
  const auto last = std::adjacent_find(points_.begin(), points_.end(), not_behind);
  if (last == points_.end()) return;
  const auto n_in_order = static_cast<std::size_t>(last - points_.begin()) + 1;
  std::vector<par::KeyIndex> rest, scratch;
  rest.reserve(points_.size() - n_in_order);
  for (std::size_t i = n_in_order; i < points_.size(); ++i)
    rest.push_back({points_[i].number, static_cast<std::uint32_t>(i)});
  par::stable_sort({}, rest, scratch);
  std::vector<PointRecord> points;
  points.reserve(points_.size());
  std::vector<Index> to(points_.size());
  const auto put = [&](std::size_t i) {
    if (points.empty() || points.back().number != points_[i].number) points.push_back(points_[i]);
    to[i] = static_cast<Index>(points.size() - 1);
  };
  std::size_t i = 0;
  for (const par::KeyIndex& one : rest) {
    for (; i < n_in_order && points_[i].number <= one.key; ++i) put(i);
    put(one.index);
  }
  for (; i < n_in_order; ++i) put(i);
  points_ = std::move(points);
  move_places(to);
}

/// After points_ has come to be another one.
void Incoming::move_places(const std::vector<Index>& to) {
  for (PlacedCell& c : cells_)
    for (Index& i : c.at) i = to[i];
  block_begin_ = {};
}

/// The points stand in blocks of so many numbers each, of which most have one or two.
void Incoming::make_index() {
  const std::uint64_t range = points_.back().number - points_.front().number;
  for (block_bits_ = 0; (range >> block_bits_) > points_.size();) ++block_bits_;
  block_begin_.assign((range >> block_bits_) + 2, 0);
  for (const PointRecord& p : points_)
    ++block_begin_[((p.number - points_.front().number) >> block_bits_) + 1];
  for (std::size_t b = 1; b < block_begin_.size(); ++b) block_begin_[b] += block_begin_[b - 1];
}

/// Of a number among the points.
std::size_t Incoming::place(std::uint64_t number) {
  if (!points_.empty() && number >= points_.front().number && number <= points_.back().number) {
    if (block_begin_.empty()) make_index();
    const std::size_t block = (number - points_.front().number) >> block_bits_;
    const auto begin = points_.begin() + block_begin_[block], end = points_.begin() + block_begin_[block + 1];
    const auto at = std::lower_bound(begin, end, number,
                                     [](const PointRecord& p, std::uint64_t n) { return p.number < n; });
    if (at != end && at->number == number) return static_cast<std::size_t>(at - points_.begin());
  }
  throw InternalError("a point of a cell has not come along");
}

/// By place: looked up for each corner of each cell, so close together.
std::vector<std::int32_t> Incoming::owners() const {
  std::vector<std::int32_t> owners;
  owners.reserve(points_.size());
  for (const PointRecord& p : points_) owners.push_back(p.owner);
  return owners;
}

/// One more than the largest number of all.
std::uint64_t Incoming::end_of(std::uint64_t mine) const {
  return static_cast<std::uint64_t>(-comm_.min(-static_cast<double>(mine)));
}

/// Numbers of the items that count are 0 … n-1, each once: there are as many, and a sum over hashes of theirs
/// is that over those. n: one more than the largest.
template <class Item, class Counts>
void Incoming::require_each_once(std::uint64_t n, const char* what, const std::vector<Item>& items,
                                 Counts&& counts) const {
  std::uint64_t n_mine = 0, found = 0, wanted = 0;
  for (const Item& item : items) {
    if (!counts(item)) continue;
    ++n_mine;
    found += mix64(item.number);
  }
  const std::string fault = std::string("numbers of ") + what + " have gaps, or come twice";
  HFR_REQUIRE(comm_.sum(n_mine) == n, fault);
  const auto begin = [&](std::uint64_t r) {
    return n / comm_.n_ranks() * r + std::min(r, n % comm_.n_ranks());
  };
  const auto me = static_cast<std::uint64_t>(comm_.rank());
  for (std::uint64_t i = begin(me); i < begin(me + 1); ++i) wanted += mix64(i);
  HFR_REQUIRE(comm_.sum(found - wanted) == 0, fault);
}

void Incoming::find_owners() {
  std::ranges::sort(points_, {}, &PointRecord::number);
  const auto differ = [](const PointRecord& a, const PointRecord& b) {
    return a.number == b.number && bits_of(a.point) != bits_of(b.point);
  };
  const auto other = std::ranges::adjacent_find(points_, differ);
  HFR_REQUIRE(other == points_.end(), differing(other->number));
  unite();
  n_points_ = end_of(points_.empty() ? 0 : points_.back().number + 1);
  n_cells_ = end_of(cells_.empty() ? 0 : cells_.back().number + 1);
  HFR_REQUIRE(n_points_ > 0 && n_cells_ > 0, "there are no cells");
  HFR_REQUIRE(n_points_ <= comm_.sum(points_.size()), "numbers of points have gaps");
  require_each_once(n_cells_, "cells", cells_, [](const PlacedCell&) { return true; });
  for (const auto& [kind, what] :
       {std::pair(LabelRecord::Kind::kFace, "triangles"), std::pair(LabelRecord::Kind::kEdge, "edges")}) {
    const auto counts = [kind = kind](const LabelRecord& r) { return r.kind == kind; };
    std::uint64_t end = 0;
    for (const LabelRecord& r : labels_)
      if (counts(r)) end = std::max(end, r.number + 1);
    require_each_once(end_of(end), what, labels_, counts);
  }
  const std::uint64_t n_ranks = comm_.n_ranks();
  const auto begin = [&](std::uint64_t r) { return (r * n_points_ + n_ranks - 1) / n_ranks; };
  struct Held {
    std::uint64_t number = 0, n_cells = 0, bits = 0;
  };
  std::vector<std::uint64_t> n_cells(points_.size(), 0);
  for (const PlacedCell& c : cells_)
    for (Index i : c.at) ++n_cells[i];
  std::vector<std::vector<Held>> questions(comm_.n_ranks());
  for (std::size_t i = 0; i < points_.size(); ++i)
    questions[points_[i].number * n_ranks / n_points_].push_back(
        {points_[i].number, n_cells[i], bits_of(points_[i].point)});
  const auto answers = comm_.ask(std::move(questions), [&](const std::vector<std::vector<Held>>& asked) {
    const auto me = static_cast<std::uint64_t>(comm_.rank());
    struct Owner {
      std::int32_t rank = -1;
      std::uint64_t n_cells = 0, bits = 0;
    };
    std::vector<Owner> owners(begin(me + 1) - begin(me));
    for (std::size_t r = 0; r < asked.size(); ++r)
      for (const Held& held : asked[r]) {
        Owner& owner = owners[held.number - begin(me)];
        HFR_REQUIRE(owner.rank < 0 || held.bits == owner.bits, differing(held.number));
        if (owner.rank < 0 || held.n_cells > owner.n_cells)
          owner = {static_cast<std::int32_t>(r), held.n_cells, held.bits};
      }
    HFR_REQUIRE(std::all_of(owners.begin(), owners.end(), [](const Owner& o) { return o.rank >= 0; }),
                "numbers of points have gaps");
    std::vector<std::vector<std::int32_t>> ranks(asked.size());
    for (std::size_t r = 0; r < asked.size(); ++r)
      for (const Held& held : asked[r]) ranks[r].push_back(owners[held.number - begin(me)].rank);
    return ranks;
  });
  std::vector<std::size_t> next(comm_.n_ranks(), 0);
  for (PointRecord& p : points_) {
    const std::size_t r = p.number * n_ranks / n_points_;
    p.owner = answers[r][next[r]++];
  }
}

/// Each cell to the ranks that `receivers` adds to the list, with its points.
template <class Receivers>
void Incoming::send(Receivers&& receivers, Incoming& into) {
  std::vector<std::vector<Index>> cells(comm_.n_ranks());
  std::vector<int> list;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    list.clear();
    receivers(cells_[i].at, list);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (int r : list)
      if (r != comm_.rank() || &into != this)
        cells[static_cast<std::size_t>(r)].push_back(static_cast<Index>(i));
  }
  std::vector<Packer> to(comm_.n_ranks());
  std::vector<Index> place_in_message(points_.size(), Sets::kNone);
  for (std::size_t r = 0; r < cells.size(); ++r)
    if (!cells[r].empty()) pack(std::exchange(cells[r], {}), place_in_message, to[r]);
  if (&into != this) cells_ = {};
  for (const Comm::Message& message : comm_.exchange(to)) into.take(message);
  if (&into == this) unite();
}

/// Points of the cells, ascending, and the cells by places among these. `place_in_message`: by place here, of
/// which none is known before and after.
void Incoming::pack(std::span<const Index> cells, std::vector<Index>& place_in_message, Packer& to) const {
  std::vector<Index> places;
  for (Index c : cells)
    for (Index i : cells_[c].at)
      if (std::exchange(place_in_message[i], 0) == Sets::kNone) places.push_back(i);
  std::sort(places.begin(), places.end());
  std::vector<PointRecord> points;
  points.reserve(places.size());
  for (Index i : places) {
    place_in_message[i] = static_cast<Index>(points.size());
    points.push_back(points_[i]);
  }
  std::vector<PlacedCell> packed;
  packed.reserve(cells.size());
  for (Index c : cells) {
    PlacedCell& cell = packed.emplace_back(cells_[c]);
    for (Index& i : cell.at) i = place_in_message[i];
  }
  for (Index i : places) place_in_message[i] = Sets::kNone;
  to.put_all(points);
  to.put_all(packed);
}

/// What pack() has made. Points and cells stand behind what is here, until unite().
void Incoming::take(const Comm::Message& message) {
  Unpacker in(message.bytes);
  const auto first = static_cast<Index>(points_.size());
  const std::size_t n_cells = cells_.size();
  in.append_to(points_);
  in.append_to(cells_);
  for (std::size_t i = n_cells; i < cells_.size(); ++i)
    for (Index& at : cells_[i].at) at += first;
}

/// Of own vertices that have others' within so many edges: the owners of these. One edge less round own
/// vertices all cells are here.
Incoming::Sets Incoming::near_own(int edges) {
  const std::vector<std::int32_t> owner = owners();
  Sets one{std::vector<Index>(points_.size(), Sets::kNone), {}};  // of any vertex: owners of its neighbours
  for (const auto& [number, at, region] : cells_) {
    if (std::all_of(at.begin(), at.end(), [&, &at = at](Index i) { return owner[i] == owner[at[0]]; }))
      continue;
    for (Index v : at)
      for (Index w : at) one.add(v, owner[w]);
  }
  Sets two = one;
  if (edges == 2)
    for (const auto& [number, at, region] : cells_)
      for (Index w : at)
        for (int r : one[w])
          for (Index v : at) two.add(v, r);
  for (std::size_t i = 0; i < owner.size(); ++i)
    if (owner[i] != comm_.rank()) two.of[i] = Sets::kNone;
  return two;
}

void Incoming::keep_near(std::uint8_t most) {
  const auto far = static_cast<std::uint8_t>(most + 1);
  std::vector<std::uint8_t> edges(points_.size(), far);
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (points_[i].owner == comm_.rank()) edges[i] = 0;
  const auto nearest = [&](const PlacedCell& c) {
    return std::min(std::min(edges[c.at[0]], edges[c.at[1]]), std::min(edges[c.at[2]], edges[c.at[3]]));
  };
  for (std::uint8_t step = 1; step < far; ++step)
    for (const PlacedCell& c : cells_) {
      if (nearest(c) != step - 1) continue;
      for (Index i : c.at) edges[i] = std::min(edges[i], step);
    }
  std::erase_if(cells_, [&](const PlacedCell& c) { return nearest(c) == far; });
  std::vector<std::uint8_t> stays(points_.size(), 0);
  for (std::size_t i = 0; i < points_.size(); ++i) stays[i] = edges[i] == 0 ? 1 : 0;
  for (const PlacedCell& c : cells_)
    for (Index i : c.at) stays[i] = 1;
  std::vector<Index> to(points_.size());
  std::size_t n = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!stays[i]) continue;
    to[i] = static_cast<Index>(n);
    points_[n++] = points_[i];
  }
  points_.resize(n);
  move_places(to);
}

DistributedMesh::Piece Incoming::piece() {
  DistributedMesh::Piece piece;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;
  keep_near(2);
  points.reserve(points_.size());
  piece.vertex_number.reserve(points_.size());
  piece.owner.reserve(points_.size());
  for (const PointRecord& p : std::exchange(points_, {})) {
    piece.vertex_number.push_back(p.number);
    piece.owner.push_back(p.owner);
    points.push_back(p.point);
  }
  const bool has_regions =
      std::any_of(cells_.begin(), cells_.end(), [](const PlacedCell& c) { return c.region != 0; });
  std::vector<std::int32_t> regions;
  cells.reserve(cells_.size());
  piece.cell_number.reserve(cells_.size());
  for (const PlacedCell& c : std::exchange(cells_, {})) {
    piece.cell_number.push_back(c.number);
    cells.push_back(c.at);
    if (has_regions) regions.push_back(c.region);
  }
  block_begin_ = {};
  piece.mesh = build(std::move(points), cells, {}, nullptr, NonManifold::kKeep, Turning::kConflicts);
  const auto was_turned = [&](std::size_t i) {
    return piece.mesh.cell(CellHandle(i)).v[2].idx() != cells[i][2];
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!was_turned(i)) continue;
    piece.turned.resize(cells.size(), 0);
    piece.turned[i] = 1;
  }
  for (std::size_t c = 0; c < regions.size(); ++c) piece.mesh.set_region(CellHandle(c), regions[c]);
  return piece;
}

void Incoming::send_labels(Incoming& to) {
  std::vector<std::vector<LabelRecord>> sent(comm_.n_ranks());
  for (const LabelRecord& r : std::exchange(labels_, {}))
    sent[static_cast<std::size_t>(points_[place(r.smallest_vertex())].owner)].push_back(r);
  std::vector<Packer> packed(comm_.n_ranks());
  for (std::size_t r = 0; r < sent.size(); ++r)
    if (!sent[r].empty()) packed[r].put_all(std::exchange(sent[r], {}));
  for (const Comm::Message& message : comm_.exchange(packed)) {
    const auto came = Unpacker(message.bytes).get_all<LabelRecord>();
    to.labels_.insert(to.labels_.end(), came.begin(), came.end());
  }
}

void Incoming::even_out() {
  constexpr double kUneven = 1.5;
  std::uint64_t n_own = 0;
  for (const PointRecord& p : points_) n_own += p.owner == comm_.rank() ? 1 : 0;
  const double most = -comm_.min(-static_cast<double>(n_own));
  if (most * static_cast<double>(comm_.n_ranks()) <= kUneven * static_cast<double>(n_points_)) return;
  const CurveOwners owner(comm_, points_.size(), [&](std::size_t i) { return points_[i].point; });
  for (PointRecord& p : points_) p.owner = owner(p.point);
}

void Incoming::hand_to_owners(Incoming& to) {
  unite();
  send_labels(to);
  send(
      [owner = owners()](const std::array<Index, 4>& at, std::vector<int>& receivers) {
        for (Index i : at) receivers.push_back(owner[i]);
      },
      to);
  if (&to == this) keep_near(0);
}

std::vector<std::string> Incoming::make_parts(DistributedMesh& mesh, const std::filesystem::path& file,
                                              Inverted inverted) {
  unite();
  for (int edges = 1; edges <= 2; ++edges) {
    const Sets near = near_own(edges);
    send(
        [&](const std::array<Index, 4>& at, std::vector<int>& to) {
          for (Index v : at) to.insert(to.end(), near[v].begin(), near[v].end());
        },
        *this);
  }
  std::vector<std::string> notes;
  try {
    const Turned turned = mesh.assemble(piece(), n_points_, n_cells_, inverted);
    if (turned.whole) notes.push_back("orders all cells the other way round; they were flipped as a whole");
    if (turned.n_alone > 0)
      notes.push_back(std::to_string(turned.n_alone) +
                      " cells were written the other way round than the rest, and are as it now");
    const std::vector<std::string> others = mesh.attach_labels(std::exchange(labels_, {}));
    notes.insert(notes.end(), others.begin(), others.end());
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
  return notes;
}

}  // namespace hfr::mpi
