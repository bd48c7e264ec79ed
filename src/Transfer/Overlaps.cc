// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Overlaps.hh"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "Transfer/SharedVolume.hh"
#include "Transfer/Stars.hh"
#include "Transfer/TetBox.hh"

namespace hfr {
namespace {

// Shared volume below this share of both cells is what rounding makes of a common face.
constexpr double kNoVolume = 1e-12;
// A cell of which less than this is missing is covered.
constexpr double kCovered = 1e-7;

constexpr double kNanoseconds = 3'000;  // a new cell, about

/// The old cells in question, numbered in the order that they are given in: each with its box and planes,
/// with which others it shares a face, and by vertex.
class Candidates {
 public:
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  /// `cells` ascending.
  Candidates(const TetMesh& mesh, std::span<const CellHandle> cells, par::Policy policy)
      : cells_(cells), boxes_(cells.size()), shapes_(cells.size()), first_of_(mesh.n_vertices() + 1, 0) {
    std::vector<Index> number(mesh.n_cells(), kNone);
    for (std::size_t i = 0; i < cells.size(); ++i) number[cells[i].idx()] = static_cast<Index>(i);
    par::for_each(policy, cells.size(), [&](std::size_t i) {
      const TetPoints points = points_of(mesh, cells[i]);
      boxes_[i] = TetBox(points);
      shapes_[i] = {points, TetPlanes(points), {}, volume6(points) < 0};
      for (std::size_t k = 0; k < 4; ++k) {
        const HalfFaceHandle m = mesh.cell(cells[i]).mate[k];
        shapes_[i].neighbours[k] = m.is_valid() ? number[cell_of(m).idx()] : kNone;
      }
    });
    list_by_vertex(mesh);
    inverted_ = BoxTree(boxes_, par::compact<Index>(policy, cells.size(),
                                                    [&](std::size_t i) { return shapes_[i].is_inverted; }));
  }
  Candidates(const Candidates&) = delete;  // trees look at boxes_
  Candidates& operator=(const Candidates&) = delete;
  /// For near().
  void sort() {
    std::vector<Index> all(cells_.size());
    std::iota(all.begin(), all.end(), Index{0});
    all_ = BoxTree(boxes_, std::move(all));
  }
  struct Shape {
    TetPoints points;
    TetPlanes planes;
    std::array<Index, 4> neighbours;  ///< kNone: none of the candidates
    bool is_inverted = false;
  };
  CellHandle cell(Index number) const { return cells_[number]; }
  const TetBox& box(Index number) const { return boxes_[number]; }
  const Shape& shape(Index number) const { return shapes_[number]; }
  std::size_t size() const { return cells_.size(); }
  std::span<const Index> of(VertexHandle v) const {
    return {of_.data() + first_of_[v.idx()], of_.data() + first_of_[v.idx() + 1]};
  }
  /// The candidate that is this cell; kNone: none is.
  Index number(CellHandle c) const {
    const auto at = std::lower_bound(cells_.begin(), cells_.end(), c);
    return at != cells_.end() && *at == c ? static_cast<Index>(at - cells_.begin()) : kNone;
  }
  /// Those whose box meets this one.
  template <class Visit>
  void near(const TetBox& box, Visit&& visit) const {
    all_.find_near(box, [&](Index i) {
      visit(i);
      return false;
    });
  }
  bool is_near_an_inverted_one(const TetBox& box) const {
    return inverted_.find_near(box, [](Index) { return true; });
  }

 private:
  void list_by_vertex(const TetMesh& mesh) {
    for (CellHandle c : cells_)
      for (VertexHandle v : mesh.cell_vertices(c)) ++first_of_[v.idx() + 1];
    std::partial_sum(first_of_.begin(), first_of_.end(), first_of_.begin());
    of_.resize(first_of_.back());
    std::vector<Index> next(first_of_.begin(), first_of_.end() - 1);
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (VertexHandle v : mesh.cell_vertices(cells_[i])) of_[next[v.idx()]++] = static_cast<Index>(i);
  }

  std::span<const CellHandle> cells_;
  std::vector<TetBox> boxes_;
  std::vector<Shape> shapes_;
  std::vector<Index> first_of_, of_;  // by vertex: where its candidates begin, and these
  BoxTree inverted_, all_;
};

/// Candidates that a search has seen; one list serves many searches.
class Seen {
 public:
  explicit Seen(std::size_t n) : stamp_(n, 0) {}
  void forget() { ++now_; }
  /// False when it was seen before.
  bool add(Index i) { return std::exchange(stamp_[i], now_) != now_; }

 private:
  std::vector<std::uint32_t> stamp_;
  std::uint32_t now_ = 0;
};

/// What new cells share with old ones, one after the other.
class Search {
 public:
  explicit Search(const Candidates& candidates) : candidates_(candidates), seen_(candidates.size()) {}

  void begin(const TetPoints& cell) {
    cell_ = cell;
    planes_ = TetPlanes(cell);
    box_ = TetBox(cell);
    volume_ = std::abs(volume6(cell)) / 6;
    seen_.forget();
    parts_.clear();
  }
  /// Looks from a candidate on at those that the cell reaches into, from face to face: from the one that has
  /// the middle of the cell, or where a walk to it ends, from `first`. True when any were found: all there
  /// are where they cover the cell and no inverted candidate, which overlaps others, is near.
  bool look_along_faces(Index first) {
    if (first == Candidates::kNone || !box_.meets(candidates_.box(first))) return false;
    const Index middle = with_middle(first);
    const Index start = middle == Candidates::kNone ? first : middle;
    if (!seen_.add(start)) return false;
    queue_.push_back(start);
    while (!queue_.empty()) {
      const Index at = queue_.back();
      queue_.pop_back();
      const Candidates::Shape& old = candidates_.shape(at);
      if (planes_.is_apart_from(old.points)) continue;
      const Shared shared = share(cell_, old.planes);
      add_if_counts(at, shared.volume);
      if (shared.volume == 0 && old.planes.whole() != 0) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        const Index next = old.neighbours[k];
        if (next == Candidates::kNone || !shared.reaches_beyond[k] || !seen_.add(next)) continue;
        if (box_.meets(candidates_.box(next))) queue_.push_back(next);
      }
    }
    return !parts_.empty();
  }
  bool is_near_an_inverted_one() const { return candidates_.is_near_an_inverted_one(box_); }
  /// Looks at a candidate and, where it is near, at its neighbours, and so on.
  void look_from(Index first) {
    if (first == Candidates::kNone || !seen_.add(first)) return;
    queue_.push_back(first);
    while (!queue_.empty()) {
      const Index at = queue_.back();
      queue_.pop_back();
      if (!look_at(at)) continue;
      for (const Index next : candidates_.shape(at).neighbours)
        if (next != Candidates::kNone && seen_.add(next)) queue_.push_back(next);
    }
  }
  void look_everywhere() {
    candidates_.near(box_, [&](Index i) {
      if (seen_.add(i)) look_at(i);
    });
  }
  bool is_covered() const {
    double covered = 0;
    for (const Overlap& part : parts_) covered += part.volume;
    return std::abs(covered - volume_) <= kCovered * volume_;
  }
  const std::vector<Overlap>& found() {
    std::sort(parts_.begin(), parts_.end(),
              [](const Overlap& a, const Overlap& b) { return a.old_cell < b.old_cell; });
    return parts_;
  }

 private:
  /// False where it is not near.
  bool look_at(Index i) {
    if (!box_.meets(candidates_.box(i))) return false;
    const Candidates::Shape& old = candidates_.shape(i);
    if (!planes_.is_apart_from(old.points)) add_if_counts(i, shared_volume(cell_, old.planes));
    return true;
  }
  void add_if_counts(Index i, double shared) {
    const Candidates::Shape& old = candidates_.shape(i);
    if (shared > kNoVolume * std::min(volume_, old.planes.whole() / 6))
      parts_.push_back({candidates_.cell(i), old.is_inverted ? -shared : shared});
  }
  /// The candidate that has the middle of the cell, by a walk from the first one; kNone where that ends.
  Index with_middle(Index first) const {
    constexpr int kFarthest = 32;  // cells; those of a cavity lie near one another
    const Vec3 middle = 0.25 * (cell_[0] + cell_[1] + cell_[2] + cell_[3]);
    Index at = first;
    for (int i = 0; i < kFarthest && at != Candidates::kNone; ++i) {
      const Candidates::Shape& old = candidates_.shape(at);
      if (old.planes.whole() == 0) return Candidates::kNone;
      const std::array<double, 4> u = old.planes.coordinates(middle);
      const auto least = static_cast<std::size_t>(std::min_element(u.begin(), u.end()) - u.begin());
      if (u[least] >= 0) return at;
      at = old.neighbours[least];
      if (at != Candidates::kNone && !box_.meets(candidates_.box(at))) return Candidates::kNone;
    }
    return Candidates::kNone;
  }

  const Candidates& candidates_;
  Seen seen_;
  TetPoints cell_;
  TetPlanes planes_;
  TetBox box_;
  double volume_ = 0;
  std::vector<Index> queue_;
  std::vector<Overlap> parts_;
};

/// What searches for some of the new cells have found.
struct Found {
  std::vector<std::size_t> n;  ///< by cell
  std::vector<Overlap> parts;
};

/// Reads what was found cell by cell.
class Reader {
 public:
  explicit Reader(const std::vector<Found>& found) : found_(found) {}

  std::span<const Overlap> next() {
    while (cell_ == found_[list_].n.size()) {
      ++list_;
      cell_ = part_ = 0;
    }
    const Overlap* begin = found_[list_].parts.data() + part_;
    const std::size_t n = found_[list_].n[cell_++];
    part_ += n;
    return {begin, n};
  }

 private:
  const std::vector<Found>& found_;
  std::size_t list_ = 0, cell_ = 0, part_ = 0;
};

/// `again`: of the cells that are open, instead of what was found first.
Overlaps joined(const std::vector<Found>& found, std::span<const std::uint8_t> is_open,
                const std::vector<Found>& again) {
  Reader first(found), second(again);
  Overlaps all;
  all.first.reserve(is_open.size() + 1);
  all.first.push_back(0);
  for (const std::uint8_t open : is_open) {
    std::span<const Overlap> parts = first.next();
    if (open != 0) parts = second.next();
    all.parts.insert(all.parts.end(), parts.begin(), parts.end());
    all.first.push_back(all.parts.size());
  }
  return all;
}

}  // namespace

Overlaps find_overlaps(const TetMesh& old, std::span<const NewCell> new_cells,
                       std::span<const CellHandle> old_cells, par::Policy policy) {
  Candidates candidates(old, old_cells, policy);
  /// visit(candidate) for those that may have something of the cell, until it returns true.
  const auto for_near_corners = [&](const NewCell& c, auto&& visit) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (c.places[k].is_valid() && visit(candidates.number(c.places[k]))) return;
      if (!c.near[k].is_valid()) continue;
      for (const Index near : candidates.of(c.near[k]))
        if (visit(near)) return;
    }
  };
  const auto search_all = [&](std::size_t n, double nanoseconds, auto&& search_one) {
    const int n_parts = par::thread_count(policy.for_items_of(nanoseconds), n);
    std::vector<Found> found(static_cast<std::size_t>(n_parts));
    par::parts(n_parts, [&](int part) {
      Search search(candidates);
      Found& mine = found[static_cast<std::size_t>(part)];
      const std::size_t end = par::part_begin(n, n_parts, part + 1);
      for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) {
        search_one(i, search);
        const std::vector<Overlap>& parts = search.found();
        mine.n.push_back(parts.size());
        mine.parts.insert(mine.parts.end(), parts.begin(), parts.end());
      }
    });
    return found;
  };
  std::vector<std::uint8_t> is_open(new_cells.size(), 0);
  const std::vector<Found> first = search_all(new_cells.size(), kNanoseconds, [&](std::size_t i, Search& s) {
    s.begin(new_cells[i].points);
    for_near_corners(new_cells[i], [&](Index near) { return s.look_along_faces(near); });
    is_open[i] = !s.is_covered() || s.is_near_an_inverted_one();
  });
  const std::vector<Index> open =
      par::compact<Index>(policy, new_cells.size(), [&](std::size_t i) { return is_open[i] != 0; });
  if (!open.empty()) candidates.sort();
  const std::vector<Found> second = search_all(open.size(), kNanoseconds, [&](std::size_t i, Search& s) {
    s.begin(new_cells[open[i]].points);
    for_near_corners(new_cells[open[i]], [&](Index near) {
      s.look_from(near);
      return false;
    });
    if (!s.is_covered()) s.look_everywhere();
  });
  return joined(first, is_open, second);
}

std::vector<NewCell> shapes_of(const TetMesh& now, const Edits& edits, std::span<const CellHandle> cells) {
  std::vector<NewCell> out;
  out.reserve(cells.size());
  for (CellHandle c : cells) out.push_back({.vertices = now.cell_vertices(c), .points = points_of(now, c)});
  add_starts(edits, out);
  return out;
}

void add_starts(const Edits& edits, std::span<NewCell> cells) {
  if (cells.empty()) return;
  std::unordered_map<Index, const PlacedVertex*> placed;
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list) placed.emplace(v.vertex.idx(), &v);
  for (NewCell& cell : cells)
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexHandle v = cell.vertices[k];
      cell.near[k] = edits.maps.old_vertices[v.idx()];
      const auto at = placed.find(v.idx());
      if (at == placed.end()) continue;
      cell.near[k] = at->second->near_vertex;
      cell.places[k] = at->second->old_cell;
    }
}

std::vector<CellHandle> old_cells_beside(
    const TetMesh& old, const Overlaps& overlaps, par::Policy policy,
    const std::function<std::vector<NewCell>(std::span<const std::size_t>)>& shapes) {
  std::vector<CellHandle> beside(overlaps.first.size() - 1);
  std::vector<std::size_t> uncovered;
  for (std::size_t i = 0; i < beside.size(); ++i)
    if (overlaps.of(i).empty()) uncovered.push_back(i);
  if (uncovered.empty()) return beside;
  const std::vector<NewCell> cells = shapes(uncovered);
  std::vector<VertexHandle> near;
  for (const NewCell& cell : cells) near.insert(near.end(), cell.near.begin(), cell.near.end());
  const Stars stars(old, near, policy);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    VertexHandle nearest;
    for (VertexHandle v : cells[k].near)
      if (!stars.of(v).empty() && (!nearest.is_valid() || v < nearest)) nearest = v;
    if (nearest.is_valid()) beside[uncovered[k]] = stars.of(nearest).front();
  }
  return beside;
}

std::vector<CellHandle> changed_old_cells(const Edits& edits) {
  std::vector<CellHandle> cells = edits.removed_cells;
  for (CellHandle c : edits.moved_cells) cells.push_back(edits.maps.old_cells[c.idx()]);
  std::sort(cells.begin(), cells.end());
  return cells;
}

std::vector<CellHandle> changed_new_cells(const Edits& edits) {
  std::vector<CellHandle> cells = edits.moved_cells;
  for (const CreatedCell& c : edits.created_cells) cells.push_back(c.cell);
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace hfr
