// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Incoming.hh"

#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <utility>

#include "Distributed/CurveOwners.hh"
#include "HalfFace/Errors.hh"

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

/// Points and cells by number, each once.
void Incoming::unite() {
  const auto by_number = [](auto& items) {
    const auto less = [](const auto& a, const auto& b) { return a.number < b.number; };
    const auto middle =
        std::is_sorted_until(items.begin(), items.end(), less);  // what has come stands behind
    std::sort(middle, items.end(), less);
    std::inplace_merge(items.begin(), middle, items.end(), less);
    items.erase(std::unique(items.begin(), items.end(),
                            [](const auto& a, const auto& b) { return a.number == b.number; }),
                items.end());
  };
  by_number(points_);
  by_number(cells_);
  forget_places();
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

/// body(cell, places of its corners) for all cells.
template <class Body>
void Incoming::for_cells(Body&& body) {
  if (places_.empty()) {
    places_.reserve(cells_.size());
    for (const CornerRecord& c : cells_) {
      Places& at = places_.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) at[k] = static_cast<Index>(place(c.v[k]));
    }
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) body(cells_[i], places_[i]);
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
  require_each_once(n_cells_, "cells", cells_, [](const CornerRecord&) { return true; });
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
  for_cells([&](const CornerRecord&, const Places& at) {
    for (Index i : at) ++n_cells[i];
  });
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
  std::vector<std::vector<CornerRecord>> cells(comm_.n_ranks());
  std::vector<int> list;
  for_cells([&](const CornerRecord& c, const Places& at) {
    list.clear();
    receivers(c, at, list);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (int r : list)
      if (r != comm_.rank() || &into != this) cells[static_cast<std::size_t>(r)].push_back(c);
  });
  std::vector<Packer> to(comm_.n_ranks());
  for (std::size_t r = 0; r < cells.size(); ++r) {
    if (cells[r].empty()) continue;
    std::vector<std::uint64_t> numbers;
    for (const CornerRecord& c : cells[r]) numbers.insert(numbers.end(), c.v.begin(), c.v.end());
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<PointRecord> points;
    for (std::uint64_t number : numbers) points.push_back(points_[place(number)]);
    to[r].put_all(points);
    to[r].put_all(std::exchange(cells[r], {}));
  }
  for (const Comm::Message& message : comm_.exchange(to)) {
    Unpacker in(message.bytes);
    const auto points = in.get_all<PointRecord>();
    into.points_.insert(into.points_.end(), points.begin(), points.end());
    const auto came = in.get_all<CornerRecord>();
    into.cells_.insert(into.cells_.end(), came.begin(), came.end());
  }
  if (&into == this) unite();
}

/// Of own vertices that have others' within so many edges: the owners of these. One edge less round own
/// vertices all cells are here.
Incoming::Sets Incoming::near_own(int edges) {
  Sets one{std::vector<Index>(points_.size(), Sets::kNone), {}};  // of any vertex: owners of its neighbours
  for_cells([&](const CornerRecord&, const Places& at) {
    if (std::all_of(at.begin(), at.end(), [&](Index i) { return owner(i) == owner(at[0]); })) return;
    for (Index v : at)
      for (Index w : at) one.add(v, owner(w));
  });
  Sets two = one;
  if (edges == 2)
    for_cells([&](const CornerRecord&, const Places& at) {
      for (Index w : at)
        for (int r : one[w])
          for (Index v : at) two.add(v, r);
    });
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (points_[i].owner != comm_.rank()) two.of[i] = Sets::kNone;
  return two;
}

void Incoming::keep_near(std::uint8_t most) {
  const auto far = static_cast<std::uint8_t>(most + 1);
  std::vector<std::uint8_t> edges(points_.size(), far);
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (points_[i].owner == comm_.rank()) edges[i] = 0;
  const auto nearest = [&](const Places& at) {
    return std::min(std::min(edges[at[0]], edges[at[1]]), std::min(edges[at[2]], edges[at[3]]));
  };
  for (std::uint8_t step = 1; step < far; ++step)
    for_cells([&](const CornerRecord&, const Places& at) {
      if (nearest(at) != step - 1) return;
      for (Index i : at) edges[i] = std::min(edges[i], step);
    });
  std::vector<std::uint8_t> stays(points_.size(), 0);
  for (std::size_t i = 0; i < points_.size(); ++i) stays[i] = edges[i] == 0 ? 1 : 0;
  std::size_t n_cells = 0;
  std::vector<std::uint8_t> is_near(cells_.size(), 0);
  for_cells([&](const CornerRecord& c, const Places& at) {
    if (nearest(at) == far) return;
    for (Index i : at) stays[i] = 1;
    is_near[static_cast<std::size_t>(&c - cells_.data())] = 1;
  });
  for (std::size_t c = 0; c < cells_.size(); ++c)
    if (is_near[c]) cells_[n_cells++] = cells_[c];
  cells_.resize(n_cells);
  std::size_t n = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (stays[i]) points_[n++] = points_[i];
  points_.resize(n);
  forget_places();
}

DistributedMesh::Piece Incoming::piece() {
  DistributedMesh::Piece piece;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;
  keep_near(2);
  for (const PointRecord& p : points_) {
    piece.vertex_number.push_back(p.number);
    piece.owner.push_back(p.owner);
    points.push_back(p.point);
  }
  cells.reserve(cells_.size());
  piece.cell_number.reserve(cells_.size());
  for_cells([&](const CornerRecord& c, const Places& at) {
    piece.cell_number.push_back(c.number);
    cells.push_back(at);
  });
  std::vector<std::int32_t> regions;
  if (std::any_of(cells_.begin(), cells_.end(), [](const CornerRecord& c) { return c.region != 0; }))
    for (const CornerRecord& c : cells_) regions.push_back(c.region);
  points_ = {};
  cells_ = {};
  forget_places();
  piece.mesh = build(std::move(points), cells, {}, nullptr, NonManifold::kKeep, Turning::kConflicts);
  const auto was_turned = [&](CellHandle c) { return piece.mesh.cell(c).v[2].idx() != cells[c.idx()][2]; };
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (HalfFaceHandle m : piece.mesh.cell(CellHandle(i)).mate)
      HFR_REQUIRE(!m.is_valid() || was_turned(CellHandle(i)) == was_turned(cell_of(m)),
                  "cells " + std::to_string(piece.cell_number[i]) + " and " +
                      std::to_string(piece.cell_number[cell_of(m).idx()]) +
                      " are ordered against one another, and a mesh in parts has to be oriented alike; "
                      "hfremesh turns such cells");
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
      [&](const CornerRecord&, const Places& at, std::vector<int>& receivers) {
        for (Index i : at) receivers.push_back(owner(i));
      },
      to);
  if (&to == this) keep_near(0);
}

std::vector<std::string> Incoming::make_parts(DistributedMesh& mesh, const std::filesystem::path& file) {
  unite();
  for (int edges = 1; edges <= 2; ++edges) {
    const Sets near = near_own(edges);
    send(
        [&](const CornerRecord&, const Places& at, std::vector<int>& to) {
          for (Index v : at) to.insert(to.end(), near[v].begin(), near[v].end());
        },
        *this);
  }
  std::vector<std::string> notes;
  try {
    const Turned turned = mesh.assemble(piece(), n_points_, n_cells_);
    if (turned.whole) notes.push_back("orders all cells the other way round; they were flipped as a whole");
    if (turned.n_alone > 0)
      notes.push_back(std::to_string(turned.n_alone) +
                      " cells were written the other way round than the rest, and are as it now");
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
  const std::vector<std::string> others = mesh.attach_labels(std::exchange(labels_, {}));
  notes.insert(notes.end(), others.begin(), others.end());
  return notes;
}

}  // namespace hfr::mpi
