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

namespace hfr {
namespace {

// Shared volume below this share of both cells is what rounding makes of a common face.
constexpr double kNoVolume = 1e-12;
// A cell of which less than this is missing is covered.
constexpr double kCovered = 1e-7;

struct Box {
  Vec3 low, high;

  Box() = default;
  explicit Box(const TetPoints& t) : low(t[0]), high(t[0]) {
    for (const Vec3& p : t)
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
  }
  bool meets(const Box& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
           low.z <= o.high.z && o.low.z <= high.z;
  }
};

/// The old cells in question, numbered in the order that they are given in: each with its box and planes,
/// with which others it shares a face, and by vertex and by where it begins along x.
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
      boxes_[i] = Box(points);
      shapes_[i] = {points, TetPlanes(points), {}, volume6(points) < 0};
      for (std::size_t k = 0; k < 4; ++k) {
        const HalfFaceHandle m = mesh.cell(cells[i]).mate[k];
        shapes_[i].neighbours[k] = m.is_valid() ? number[cell_of(m).idx()] : kNone;
      }
    });
    list_by_vertex(mesh);
    by_x_.reserve(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      by_x_.emplace_back(boxes_[i].low.x, static_cast<Index>(i));
      widest_ = std::max(widest_, boxes_[i].high.x - boxes_[i].low.x);
    }
    std::sort(by_x_.begin(), by_x_.end());
  }
  struct Shape {
    TetPoints points;
    TetPlanes planes;
    std::array<Index, 4> neighbours;  ///< kNone: none of the candidates
    bool is_inverted = false;
  };
  CellHandle cell(Index number) const { return cells_[number]; }
  const Box& box(Index number) const { return boxes_[number]; }
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
  /// Those that may meet the box.
  template <class Visit>
  void near(const Box& box, Visit&& visit) const {
    auto at = std::lower_bound(by_x_.begin(), by_x_.end(), std::pair(box.low.x - widest_, Index(0)));
    for (; at != by_x_.end() && at->first <= box.high.x; ++at) visit(at->second);
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
  std::vector<Box> boxes_;
  std::vector<Shape> shapes_;
  std::vector<Index> first_of_, of_;  // by vertex: where its candidates begin, and these
  std::vector<std::pair<double, Index>> by_x_;
  double widest_ = 0;
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
    box_ = Box(cell);
    volume_ = std::abs(volume6(cell)) / 6;
    seen_.forget();
    parts_.clear();
  }
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
  std::vector<Overlap> take() {
    std::sort(parts_.begin(), parts_.end(),
              [](const Overlap& a, const Overlap& b) { return a.old_cell < b.old_cell; });
    return parts_;
  }

 private:
  /// False where it is not near.
  bool look_at(Index i) {
    if (!box_.meets(candidates_.box(i))) return false;
    const Candidates::Shape& old = candidates_.shape(i);
    if (planes_.is_apart_from(old.points)) return true;
    const double shared = shared_volume(cell_, old.planes);
    if (shared > kNoVolume * std::min(volume_, old.planes.whole() / 6))
      parts_.push_back({candidates_.cell(i), old.is_inverted ? -shared : shared});
    return true;
  }

  const Candidates& candidates_;
  Seen seen_;
  TetPoints cell_;
  TetPlanes planes_;
  Box box_;
  double volume_ = 0;
  std::vector<Index> queue_;
  std::vector<Overlap> parts_;
};

}  // namespace

Overlaps find_overlaps(const TetMesh& old, const TetMesh& now, const Edits& edits,
                       std::span<const CellHandle> new_cells, std::span<const CellHandle> old_cells,
                       par::Policy policy) {
  const Candidates candidates(old, old_cells, policy);
  std::unordered_map<Index, CellHandle> place;
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list)
      if (v.old_cell.is_valid()) place.emplace(v.vertex.idx(), v.old_cell);
  std::vector<std::vector<Overlap>> found(new_cells.size());
  constexpr double kNanoseconds = 10'000;  // a cell, about
  par::for_ranges(policy.for_items_of(kNanoseconds), new_cells.size(),
                  [&](std::size_t begin, std::size_t end) {
                    Search search(candidates);
                    for (std::size_t i = begin; i < end; ++i) {
                      search.begin(points_of(now, new_cells[i]));
                      for (VertexHandle v : now.cell_vertices(new_cells[i])) {
                        const auto at = place.find(v.idx());
                        if (at != place.end()) search.look_from(candidates.number(at->second));
                        const VertexHandle source = edits.maps.sources[v.idx()];
                        if (!source.is_valid()) continue;
                        for (const Index near : candidates.of(source)) search.look_from(near);
                      }
                      if (!search.is_covered()) search.look_everywhere();
                      found[i] = search.take();
                    }
                  });
  Overlaps all;
  all.first.reserve(new_cells.size() + 1);
  all.first.push_back(0);
  for (const auto& parts : found) {
    all.parts.insert(all.parts.end(), parts.begin(), parts.end());
    all.first.push_back(all.parts.size());
  }
  return all;
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
