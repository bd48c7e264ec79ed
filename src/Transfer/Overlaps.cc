// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Overlaps.hh"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
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

/// The old cells in question: each with its box and planes, and by where it begins along x.
class Candidates {
 public:
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  Candidates(const TetMesh& mesh, std::span<const CellHandle> cells)
      : n_(cells.size()), number_(mesh.n_cells(), kNone) {
    by_x_.reserve(cells.size());
    shapes_.reserve(cells.size());
    for (CellHandle c : cells) {
      number_[c.idx()] = static_cast<Index>(by_x_.size());
      const TetPoints points = points_of(mesh, c);
      shapes_.push_back({Box(points), points, TetPlanes(points), volume6(points) < 0});
      const Box& box = shapes_.back().box;
      by_x_.emplace_back(box.low.x, c);
      widest_ = std::max(widest_, box.high.x - box.low.x);
    }
    std::sort(by_x_.begin(), by_x_.end());
  }
  struct Shape {
    Box box;
    TetPoints points;
    TetPlanes planes;
    bool is_inverted;
  };
  const Shape& shape(Index number) const { return shapes_[number]; }
  std::size_t size() const { return n_; }
  /// 0 … size()-1; kNone for a cell that is none of them.
  Index number(CellHandle c) const { return number_[c.idx()]; }
  /// Those that may meet the box.
  template <class Visit>
  void near(const Box& box, Visit&& visit) const {
    auto at = std::lower_bound(by_x_.begin(), by_x_.end(), std::pair(box.low.x - widest_, CellHandle(0)));
    for (; at != by_x_.end() && at->first <= box.high.x; ++at) visit(at->second);
  }

 private:
  std::size_t n_;
  std::vector<Index> number_;
  std::vector<Shape> shapes_;
  std::vector<std::pair<double, CellHandle>> by_x_;
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

/// What one new cell shares with old ones.
class Search {
 public:
  Search(const TetMesh& old, const Candidates& candidates, Seen& seen, const TetPoints& cell)
      : old_(old),
        candidates_(candidates),
        seen_(seen),
        cell_(cell),
        planes_(cell),
        box_(cell),
        volume_(std::abs(volume6(cell)) / 6) {
    seen_.forget();
  }

  /// Looks at an old cell and, where it is near, at its neighbours, and so on.
  void look_from(CellHandle c) {
    if (!is_new(c)) return;
    queue_.push_back(c);
    while (!queue_.empty()) {
      const CellHandle at = queue_.back();
      queue_.pop_back();
      if (!look_at(at)) continue;
      for (const HalfFaceHandle m : old_.cell(at).mate)
        if (m.is_valid() && is_new(cell_of(m))) queue_.push_back(cell_of(m));
    }
  }
  void look_everywhere() {
    candidates_.near(box_, [&](CellHandle c) {
      if (is_new(c)) look_at(c);
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
    return std::move(parts_);
  }

 private:
  /// True the first time that a candidate is asked about.
  bool is_new(CellHandle c) {
    const Index i = candidates_.number(c);
    return i != Candidates::kNone && seen_.add(i);
  }
  /// False where it is not near.
  bool look_at(CellHandle c) {
    const Candidates::Shape& old = candidates_.shape(candidates_.number(c));
    if (!box_.meets(old.box)) return false;
    if (planes_.is_apart_from(old.points)) return true;
    const double shared = shared_volume(cell_, old.planes);
    if (shared > kNoVolume * std::min(volume_, old.planes.whole() / 6))
      parts_.push_back({c, old.is_inverted ? -shared : shared});
    return true;
  }

  const TetMesh& old_;
  const Candidates& candidates_;
  Seen& seen_;
  TetPoints cell_;
  TetPlanes planes_;
  Box box_;
  double volume_;
  std::vector<CellHandle> queue_;
  std::vector<Overlap> parts_;
};

template <class Cells>
void add_cells_of(const TetMesh& mesh, VertexHandle v, Cells& cells) {
  if (!v.is_valid() || !mesh.incident_cell(v).is_valid()) return;
  for (CellHandle c : mesh.vertex_cells(v)) cells.push_back(c);
}

}  // namespace

Overlaps find_overlaps(const TetMesh& old, const TetMesh& now, const Edits& edits,
                       std::span<const CellHandle> new_cells, std::span<const CellHandle> old_cells,
                       par::Policy policy) {
  const Candidates candidates(old, old_cells);
  std::unordered_map<Index, CellHandle> place;
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list)
      if (v.old_cell.is_valid()) place.emplace(v.vertex.idx(), v.old_cell);
  std::vector<std::vector<Overlap>> found(new_cells.size());
  constexpr double kNanoseconds = 10'000;  // a cell, about
  par::for_ranges(policy.for_items_of(kNanoseconds), new_cells.size(),
                  [&](std::size_t begin, std::size_t end) {
                    Seen seen(candidates.size());
                    std::vector<CellHandle> from;
                    for (std::size_t i = begin; i < end; ++i) {
                      Search search(old, candidates, seen, points_of(now, new_cells[i]));
                      from.clear();
                      for (VertexHandle v : now.cell_vertices(new_cells[i])) {
                        const auto at = place.find(v.idx());
                        if (at != place.end()) from.push_back(at->second);
                        add_cells_of(old, edits.maps.sources[v.idx()], from);
                      }
                      for (CellHandle c : from) search.look_from(c);
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
