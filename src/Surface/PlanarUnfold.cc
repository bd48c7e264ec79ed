// SPDX-License-Identifier: BSD-3-Clause
// In the plane what Operators/Unfold.cc does in space: Garanzha, Kaporin, Kudryavtseva, Protais, Ray &
// Sokolov, Foldover-free maps in 50 lines of code, 2021, one vertex at a time. Only + - * / and √.
#include "Surface/PlanarUnfold.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "HalfFace/Layers.hh"
#include "Surface/FaceStars.hh"

namespace hfr {
namespace planes {
namespace {

using surface::Arrays;
using surface::corners;
using surface::FaceStars;
using surface::scaled_normal;
using surface::unit;

/// Of the mean edge: in free mode, what lies no further from a plane is in it, if the distance allows that.
constexpr double kInPlane = 1e-6;
/// Rings of faces round a fold whose vertices move: one number after the other is tried, the last is all.
constexpr std::array<int, 5> kRings = {2, 4, 8, 16, kAllLayers};
constexpr int kSpreading = 60;  // passes that send each vertex to the mean of its neighbours, at first
constexpr int kPasses = 200;    // of the energy, at most
constexpr int kPatience = 40;   // of these without fewer folds
constexpr int kSteps = 3;       // of Newton's method at a vertex, as many halvings of each
/// ε of a star without folds, in mean regular triangles.
constexpr double kFirmness = 0.02;
/// Of a regular triangle with its edges, the least area of one that is no fold.
constexpr double kLeastArea = 1e-6;

struct Point2 {
  double x = 0, y = 0;

  friend Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
  friend Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
  friend Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
  friend bool operator==(Point2, Point2) = default;
};
double dot(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }
double cross(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }

/// A triangle as its vertex at x sees it: the other two, in turn.
struct Side {
  Point2 a, b;

  double sum2(Point2 x) const { return dot(b - a, b - a) + dot(x - a, x - a) + dot(x - b, x - b); }
  double twice_area(Point2 x) const { return cross(b - a, x - a); }
};
/// Twice the area of a regular triangle with this sum of squared edges.
double regular_area(double sum2) { return sum2 / (2.0 * std::sqrt(3.0)); }

/// S / χ, where 1/χ = 2 / (D + r), or without loss of digits 2 (r - D) / ε².
double energy_of(double s, double d, double eps2) {
  const double r = std::sqrt(d * d + eps2);
  return s * 2.0 * (d < 0 ? (r - d) / eps2 : 1.0 / (d + r));
}
double energy(std::span<const Side> sides, Point2 x, double eps2) {
  double sum = 0;
  for (const Side& side : sides) sum += energy_of(side.sum2(x), side.twice_area(x), eps2);
  return sum;
}

/// The step to where a quadratic form with this gradient and Hessian (xx, xy, yy) is least.
std::optional<Point2> solve(const std::array<double, 3>& h, Point2 g) {
  const double det = h[0] * h[2] - h[1] * h[1];
  if (!(h[0] > 0 && det > 1e-12 * h[0] * h[2])) return std::nullopt;
  return Point2{(h[1] * g.y - h[2] * g.x) / det, (h[1] * g.x - h[0] * g.y) / det};
}

/// Newton's step. What the gradients of S and of 1/χ add to the Hessian is left out where it makes it
/// indefinite.
std::optional<Point2> newton_step(std::span<const Side> sides, Point2 x, double eps2) {
  Point2 gradient;
  std::array<double, 3> convex{}, mixed{};
  for (const Side& side : sides) {
    const double s = side.sum2(x), d = side.twice_area(x);
    const double r = std::sqrt(d * d + eps2), e = energy_of(s, d, eps2);
    const Point2 along = side.b - side.a, n{-along.y, along.x};
    const Point2 gs = (1.0 / s) * (4.0 * x - 2.0 * (side.a + side.b));
    gradient = gradient + e * (gs - (1.0 / r) * n);
    const double flat = 4.0 * e / s, steep = e * (r + d) / (r * r * r), both = -e / r;
    convex[0] += flat + steep * n.x * n.x;
    convex[1] += steep * n.x * n.y;
    convex[2] += flat + steep * n.y * n.y;
    mixed[0] += 2.0 * both * gs.x * n.x;
    mixed[1] += both * (gs.x * n.y + gs.y * n.x);
    mixed[2] += 2.0 * both * gs.y * n.y;
  }
  std::array<double, 3> full = convex;
  for (std::size_t i = 0; i < full.size(); ++i) full[i] += mixed[i];
  if (const auto step = solve(full, gradient)) return step;
  return solve(convex, gradient);
}

/// Where a vertex at x makes the energy of its triangles less.
Point2 unfold_star(std::span<const Side> sides, Point2 x) {
  double lowest = 0, regular = 0;
  for (const Side& side : sides) {
    lowest = std::min(lowest, side.twice_area(x));
    regular += regular_area(side.sum2(x));
  }
  const double firm = kFirmness * regular / static_cast<double>(sides.size());
  const double eps2 = 4.0 * firm * (firm - lowest);
  if (!(eps2 > 0)) return x;
  double now = energy(sides, x, eps2);
  for (int i = 0; i < kSteps; ++i) {
    const auto step = newton_step(sides, x, eps2);
    if (!step) break;
    double length = 1, next = now;
    for (int halving = 0; halving <= kSteps; ++halving, length *= 0.5) {
      next = energy(sides, x + length * *step, eps2);
      if (next < now) break;
    }
    if (!(next < now)) break;
    x = x + length * *step;
    now = next;
  }
  return x;
}

using Faces = std::vector<std::uint32_t>;

/// Tells the faces at the vertices of some faces, for grow_layers().
auto faces_round(const Arrays& arrays, const FaceStars& stars) {
  return [&](std::span<const std::uint32_t> rim, auto&& reach) {
    for (std::uint32_t f : rim)
      for (VertexHandle v : arrays.faces[f])
        for (std::uint32_t g : stars.at(v)) reach(g);
  };
}

/// Plane facets: sets of faces that hang together over edges of two faces each, between what has the same
/// labels, in one plane; whichever way they look. Each begins at its largest face.
class PlaneFacets {
 public:
  /// What lies within `tolerance` of a plane is in it.
  PlaneFacets(const Arrays& arrays, double tolerance)
      : edges_(surface::find_edges(arrays)), tolerance_(tolerance) {
    std::vector<std::array<std::uint32_t, 3>> next(arrays.faces.size(), {kNone, kNone, kNone});
    for (const surface::Edge& e : edges_)
      if (may_be_inside(arrays, e))
        for (std::size_t i = 0; i < 2; ++i) next[e.f[i]][e.k[i]] = e.f[1 - i];
    std::vector<double> area;
    for (const auto& f : arrays.faces) area.push_back(norm(scaled_normal(corners(arrays.points, f))));
    Faces order(arrays.faces.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::ranges::greater(), [&](std::uint32_t f) { return area[f]; });
    number_.assign(arrays.faces.size(), kNone);
    for (std::uint32_t first : order) {
      if (number_[first] != kNone) continue;
      const Triangle t = corners(arrays.points, arrays.faces[first]);
      const Vec3 normal = unit(scaled_normal(t));
      const auto is_in_plane = [&](VertexHandle v) {
        return std::abs(dot(normal, arrays.points[v.idx()] - t[0])) <= tolerance_;
      };
      const auto number = static_cast<std::uint32_t>(faces_.size());
      number_[first] = number;
      Faces& faces = faces_.emplace_back(1, first);
      for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::uint32_t g : next[faces[i]]) {
          if (g == kNone || number_[g] != kNone || !std::ranges::all_of(arrays.faces[g], is_in_plane))
            continue;
          number_[g] = number;
          faces.push_back(g);
        }
      }
    }
  }

  /// By facet, its faces.
  std::span<const Faces> faces() const { return faces_; }
  std::uint32_t of(std::uint32_t face) const { return number_[face]; }
  const std::vector<surface::Edge>& edges() const { return edges_; }
  double tolerance() const { return tolerance_; }
  /// Whether no facet goes on over the edge.
  bool is_rim(const surface::Edge& e) const { return !e.manifold || of(e.f[0]) != of(e.f[1]); }

 private:
  static constexpr std::uint32_t kNone = ~0U;

  static bool may_be_inside(const Arrays& arrays, const surface::Edge& e) {
    if (!e.manifold || std::ranges::binary_search(arrays.locked_edges, std::array{e.a, e.b})) return false;
    const auto same = [&](const auto& of) { return of[e.f[0]] == of[e.f[1]]; };
    return same(arrays.patch) && same(arrays.inward) && same(arrays.regions) && !arrays.locked[e.f[0]] &&
           !arrays.locked[e.f[1]];
  }

  std::vector<surface::Edge> edges_;
  std::vector<std::uint32_t> number_;
  std::vector<Faces> faces_;
  double tolerance_;
};

/// The points, and what they were since it was asked for last.
class Points {
 public:
  explicit Points(std::span<const Vec3> points) : points_(points.begin(), points.end()) {}

  const std::vector<Vec3>& get() const { return points_; }
  void move(VertexHandle v, Vec3 by) {
    before_.emplace_back(v, points_[v.idx()]);
    points_[v.idx()] = points_[v.idx()] + by;
  }
  void keep() { before_.clear(); }
  void put_back() {
    for (auto at = before_.rbegin(); at != before_.rend(); ++at) points_[at->first.idx()] = at->second;
    before_.clear();
  }

 private:
  std::vector<Vec3> points_;
  std::vector<std::pair<VertexHandle, Vec3>> before_;
};

/// Straight edges between two planes, from corner to corner. Their inner vertices may slide along them.
class StraightEdges {
 public:
  StraightEdges(const PlaneFacets& facets, const FaceStars& stars, std::span<const std::uint8_t> held,
                std::size_t n_vertices)
      : facets_(facets), stars_(stars), held_(held), rim_(n_vertices) {
    for (std::uint32_t i = 0; i < facets.edges().size(); ++i)
      if (const surface::Edge& e = facets.edges()[i]; facets.is_rim(e))
        for (VertexHandle v : {e.a, e.b}) rim_[v.idx()].push_back(i);
  }

  /// Puts vertices that have passed one another back in order along the edges of a facet, each between its
  /// ends. Returns the facets whose rims have changed, ascending.
  std::vector<std::uint32_t> unfold(std::uint32_t facet, const Arrays& arrays, Points& points) const {
    std::vector<VertexHandle> vertices;
    for (std::uint32_t f : facets_.faces()[facet])
      std::ranges::copy_if(arrays.faces[f], std::back_inserter(vertices),
                           [&](VertexHandle v) { return !rim_[v.idx()].empty() && !slides(v); });
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::vector<std::uint32_t> changed;
    for (VertexHandle v : vertices) {
      for (std::uint32_t first : rim_[v.idx()]) {
        const surface::Edge& e = facets_.edges()[first];
        if (!e.manifold || (facets_.of(e.f[0]) != facet && facets_.of(e.f[1]) != facet)) continue;
        const std::vector<VertexHandle> chain = chain_from(v, first);
        if (chain.size() < 3 || !(chain.front() < chain.back()) || !unfold(chain, points)) continue;
        for (std::uint32_t f : e.f) changed.push_back(facets_.of(f));
      }
    }
    std::ranges::sort(changed);
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    return changed;
  }

 private:
  bool slides(VertexHandle v) const {
    const auto& rim = rim_[v.idx()];
    if (held_[v.idx()] || rim.size() != 2) return false;
    std::array<std::array<std::uint32_t, 2>, 2> sides;
    for (std::size_t i = 0; i < 2; ++i) {
      const surface::Edge& e = facets_.edges()[rim[i]];
      if (!e.manifold) return false;
      sides[i] = {facets_.of(e.f[0]), facets_.of(e.f[1])};
      std::ranges::sort(sides[i]);
    }
    return sides[0] == sides[1] && std::ranges::all_of(stars_.at(v), [&](std::uint32_t f) {
             return std::ranges::find(sides[0], facets_.of(f)) != sides[0].end();
           });
  }
  std::vector<VertexHandle> chain_from(VertexHandle v, std::uint32_t edge) const {
    std::vector<VertexHandle> chain = {v};
    for (;;) {
      const surface::Edge& e = facets_.edges()[edge];
      const VertexHandle next = e.a == chain.back() ? e.b : e.a;
      chain.push_back(next);
      if (!slides(next)) return chain;
      const auto& rim = rim_[next.idx()];
      edge = rim[0] == edge ? rim[1] : rim[0];
    }
  }
  /// Spreads as few vertices as have half the room there that all of the edge would give them evenly; false
  /// where none moves.
  bool unfold(const std::vector<VertexHandle>& chain, Points& points) const {
    const Vec3 origin = points.get()[chain.front().idx()];
    const Vec3 along = points.get()[chain.back().idx()] - origin;
    const double length = norm(along);
    const Vec3 axis = unit(along);
    std::vector<double> at;
    for (VertexHandle v : chain) {
      const Vec3 p = points.get()[v.idx()] - origin;
      at.push_back(dot(p, axis));
      if (!(norm(p - at.back() * axis) <= facets_.tolerance())) return false;
    }
    const std::size_t last = chain.size() - 1;
    const double least = 0.5 * length / static_cast<double>(last);
    if (!(least > facets_.tolerance())) return false;
    const std::vector<double> before = at;
    for (std::size_t i = 0; i < last; ++i) {
      if (at[i + 1] > at[i]) continue;
      std::size_t low = i, high = i + 1;
      const auto step = [&] { return (at[high] - at[low]) / static_cast<double>(high - low); };
      while ((low > 0 || high < last) && step() < least) {
        if (low > 0) --low;
        if (high < last) ++high;
      }
      const double gap = step(), from = at[low];
      for (std::size_t k = low + 1; k < high; ++k) at[k] = from + static_cast<double>(k - low) * gap;
      i = high - 1;  // what lies before has stayed in order
    }
    for (std::size_t i = 1; i < last; ++i)
      if (at[i] != before[i]) points.move(chain[i], (at[i] - before[i]) * axis);
    return at != before;
  }

  const PlaneFacets& facets_;
  const FaceStars& stars_;
  std::span<const std::uint8_t> held_;
  std::vector<std::vector<std::uint32_t>> rim_;  // by vertex, the edges of its rims
};

/// What facets share, so that each takes as long as it is large.
struct Scratch {
  std::vector<std::uint32_t> number;   ///< per vertex: that within the facet at hand
  std::vector<std::uint8_t> is_asked;  ///< per face: 0 between uses
};

/// One plane facet, seen from the side to which most of its area looks.
class Facet {
 public:
  Facet(const Arrays& arrays, std::span<const Vec3> points, const FaceStars& stars, const PlaneFacets& facets,
        std::uint32_t number, std::span<const std::uint8_t> held, Scratch& scratch)
      : arrays_(arrays), stars_(stars), facets_(facets), number_(number), scratch_(scratch) {
    const Faces& faces = facets.faces()[number];
    for (std::uint32_t f : faces)
      vertices_.insert(vertices_.end(), arrays.faces[f].begin(), arrays.faces[f].end());
    std::ranges::sort(vertices_);
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    Vec3 sum;
    std::uint32_t largest = faces.front();
    const auto area = [&](std::uint32_t f) { return scaled_normal(corners(points, arrays_.faces[f])); };
    for (std::uint32_t f : faces) {
      sum = sum + area(f);
      if (norm2(area(f)) > norm2(area(largest))) largest = f;
    }
    const Triangle t = corners(points, arrays_.faces[largest]);
    Vec3 up = unit(scaled_normal(t));
    if (dot(sum, up) < 0) up = -1.0 * up;
    x_ = unit(t[1] - t[0]);
    y_ = cross(up, x_);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const VertexHandle v = vertices_[i];
      scratch.number[v.idx()] = static_cast<std::uint32_t>(i);
      const Vec3 p = points[v.idx()] - t[0];
      at_.push_back({dot(p, x_), dot(p, y_)});
      moves_.push_back(!held[v.idx()] && std::ranges::all_of(stars.at(v), [&](std::uint32_t g) {
        return facets.of(g) == number;
      }));
    }
    before_ = at_;
  }

  bool is_folded(std::uint32_t f) const {
    const auto& v = arrays_.faces[f];
    const Side side{at(v[0]), at(v[1])};
    return !(side.twice_area(at(v[2])) > kLeastArea * regular_area(side.sum2(at(v[2]))));
  }
  /// Its faces that look the wrong way or have no area, in sets that hang together at vertices.
  std::vector<Faces> folds() const {
    Faces folded;
    std::ranges::copy_if(facets_.faces()[number_], std::back_inserter(folded),
                         [&](std::uint32_t f) { return is_folded(f); });
    for (std::uint32_t f : folded) scratch_.is_asked[f] = 1;
    std::vector<Faces> folds;
    for (std::uint32_t first : folded) {
      if (!std::exchange(scratch_.is_asked[first], std::uint8_t{0})) continue;
      grow_layers(folds.emplace_back(1, first), kAllLayers, faces_round(arrays_, stars_),
                  [&](std::uint32_t f) { return std::exchange(scratch_.is_asked[f], std::uint8_t{0}) != 0; });
    }
    return folds;
  }
  /// The vertices of these faces stay from now on.
  void hold(const Faces& faces) {
    for (std::uint32_t f : faces)
      for (VertexHandle v : arrays_.faces[f]) moves_[scratch_.number[v.idx()]] = 0;
  }
  /// Moves the vertices round one fold until none of its faces is folded any more, and no other has come to
  /// be, in as few rings as that takes; false, and nothing moves, where no number of rings does.
  bool unfold(const Faces& fold, const std::function<bool()>& stopped) {
    // A face that none of its vertices can open stays a fold.
    const auto may_open = [&](std::uint32_t f) {
      return std::ranges::any_of(arrays_.faces[f], [&](VertexHandle v) { return moves(v); });
    };
    if (!std::ranges::all_of(fold, may_open)) return false;
    std::size_t n_before = 0;
    for (int rings : kRings) {
      if (rings == kAllLayers && all_are_vain_) return false;
      const std::vector<VertexHandle> vertices = movable(fold, rings);
      if (vertices.size() == n_before) return false;
      n_before = vertices.size();
      if (unfold(fold, vertices, stopped)) return true;
      all_are_vain_ = all_are_vain_ || rings == kAllLayers;
    }
    return false;
  }
  /// Brings the points to where they are now.
  void move(Points& points) const {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Point2 by = at_[i] - before_[i];
      if (by != Point2{}) points.move(vertices_[i], by.x * x_ + by.y * y_);
    }
  }

 private:
  bool unfold(const Faces& fold, const std::vector<VertexHandle>& vertices,
              const std::function<bool()>& stopped) {
    Faces faces = fold;
    for (VertexHandle v : vertices) faces.insert(faces.end(), stars_.at(v).begin(), stars_.at(v).end());
    std::ranges::sort(faces);
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    std::erase_if(faces, [&](std::uint32_t f) {  // other folds
      return is_folded(f) && std::ranges::find(fold, f) == fold.end();
    });
    std::vector<Point2> before;
    for (VertexHandle v : vertices) before.push_back(at(v));
    const auto put_back = [&] {
      for (std::size_t i = 0; i < vertices.size(); ++i) at(vertices[i]) = before[i];
    };
    for (int spreading : {0, kSpreading}) {
      put_back();
      for (int pass = 0; pass < spreading && !stopped(); ++pass)
        for (VertexHandle v : vertices) at(v) = middle_of_neighbours(v);
      std::size_t fewest = faces.size() + 1;
      for (int pass = 0, idle = 0; pass < kPasses && idle < kPatience && !stopped(); ++pass, ++idle) {
        for (VertexHandle v : vertices) at(v) = unfold_star(sides_of(v), at(v));
        const auto n = static_cast<std::size_t>(
            std::ranges::count_if(faces, [&](std::uint32_t f) { return is_folded(f); }));
        if (n == 0) return true;
        if (n < fewest) idle = 0;
        fewest = std::min(fewest, n);
      }
    }
    put_back();
    return false;
  }
  Point2& at(VertexHandle v) { return at_[scratch_.number[v.idx()]]; }
  Point2 at(VertexHandle v) const { return at_[scratch_.number[v.idx()]]; }
  /// Whether all faces of the vertex are in the facet and nothing holds it.
  bool moves(VertexHandle v) const { return moves_[scratch_.number[v.idx()]]; }
  std::vector<Side> sides_of(VertexHandle v) const {
    std::vector<Side> sides;
    for (std::uint32_t f : stars_.at(v)) {
      const auto& corner = arrays_.faces[f];
      const auto k = static_cast<std::size_t>(std::ranges::find(corner, v) - corner.begin());
      sides.push_back({at(corner[(k + 1) % 3]), at(corner[(k + 2) % 3])});
    }
    return sides;
  }
  Point2 middle_of_neighbours(VertexHandle v) const {
    Point2 sum;
    const std::vector<Side> sides = sides_of(v);
    for (const Side& side : sides) sum = sum + (side.a + side.b);
    return (0.5 / static_cast<double>(sides.size())) * sum;
  }
  /// Vertices that move, of these faces and of so many rings of the facet's faces round them; ascending.
  std::vector<VertexHandle> movable(const Faces& fold, int rings) const {
    Faces near = fold;
    for (std::uint32_t f : near) scratch_.is_asked[f] = 1;
    grow_layers(near, rings, faces_round(arrays_, stars_), [&](std::uint32_t f) {
      return facets_.of(f) == number_ && std::exchange(scratch_.is_asked[f], std::uint8_t{1}) == 0;
    });
    std::vector<VertexHandle> vertices;
    for (std::uint32_t f : near) {
      scratch_.is_asked[f] = 0;
      std::ranges::copy_if(arrays_.faces[f], std::back_inserter(vertices),
                           [&](VertexHandle v) { return moves(v); });
    }
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  const Arrays& arrays_;
  const FaceStars& stars_;
  const PlaneFacets& facets_;
  std::uint32_t number_;
  Scratch& scratch_;
  std::vector<VertexHandle> vertices_;  // ascending
  std::vector<Point2> at_, before_;     // of these
  std::vector<std::uint8_t> moves_;
  Vec3 x_, y_;                 // axes in the plane
  bool all_are_vain_ = false;  // moving all vertices has not opened one fold
};

/// Vertices that stay wherever they are.
std::vector<std::uint8_t> held_vertices(const Arrays& arrays) {
  std::vector<std::uint8_t> held(arrays.points.size(), 0);
  const auto hold = [&](const auto& vertices) {
    for (VertexHandle v : vertices) held[v.idx()] = 1;
  };
  hold(arrays.locked_vertices);
  for (const auto& e : arrays.locked_edges) hold(e);
  for (std::size_t i = 0; i < arrays.faces.size(); ++i)
    if (arrays.locked[i] || arrays.interface[i]) hold(arrays.faces[i]);
  return held;
}

/// Opens the folds of all facets, then those that only straight edges have room for.
class PlaneUnfolder {
 public:
  PlaneUnfolder(const Arrays& arrays, double tolerance, const std::function<bool()>& stopped)
      : arrays_(arrays),
        stopped_([&stopped] { return stopped && stopped(); }),
        stars_(arrays),
        facets_(arrays, tolerance),
        held_(held_vertices(arrays)),
        points_(arrays.points),
        scratch_{std::vector<std::uint32_t>(arrays.points.size(), 0),
                 std::vector<std::uint8_t>(arrays.faces.size(), 0)} {}

  const std::vector<Vec3>& points() const { return points_.get(); }

  PlanarUnfolding unfold() {
    PlanarUnfolding done;
    for (std::uint32_t i = 0; i < facets_.faces().size(); ++i) {
      if (all_look_alike(facets_.faces()[i])) continue;
      if (stopped_()) break;
      const Outcome outcome = unfold(i, /*is_rim_moved=*/false);
      done.n_folded += outcome.n_folded;
      outcomes_[i] = outcome;
    }
    points_.keep();
    if (std::ranges::any_of(outcomes_, [](const auto& o) { return o.second.n_left > 0; })) unfold_edges();
    for (const auto& [facet, outcome] : outcomes_) done.n_left += outcome.n_left;
    for (std::size_t i = 0; i < points().size(); ++i)
      done.n_moved += points()[i] == arrays_.points[i] ? 0 : 1;
    return done;
  }

 private:
  struct Outcome {
    std::size_t n_folded = 0, n_left = 0;
    bool has_slit = false;  ///< what looks like a fold, and has sound cells behind it
  };

  bool all_look_alike(const Faces& faces) const {
    Vec3 sum;
    const auto area = [&](std::uint32_t f) { return scaled_normal(corners(points(), arrays_.faces[f])); };
    for (std::uint32_t f : faces) sum = sum + area(f);
    return std::ranges::all_of(faces, [&](std::uint32_t f) { return dot(area(f), sum) > 0; });
  }
  /// The two sides of a slit lie on one another as the layers of a fold do; but cells behind what a fold has
  /// turned over are inverted.
  bool is_fold(const Faces& faces) const {
    const auto n = std::ranges::count_if(faces, [&](std::uint32_t f) { return arrays_.at_invalid[f] != 0; });
    return 2 * static_cast<std::size_t>(n) > faces.size();
  }
  /// `is_rim_moved`: which folds faces of any cells.
  Outcome unfold(std::uint32_t number, bool is_rim_moved) {
    Facet facet(arrays_, points(), stars_, facets_, number, held_, scratch_);
    Outcome outcome;
    std::vector<Faces> folds = facet.folds();
    const std::size_t n_all = folds.size();
    if (!is_rim_moved)
      for (const Faces& fold : folds)
        if (!is_fold(fold)) facet.hold(fold);
    if (!is_rim_moved) std::erase_if(folds, [&](const Faces& fold) { return !is_fold(fold); });
    outcome.has_slit = folds.size() < n_all;
    const auto is_open = [&](const Faces& fold) {
      return std::ranges::none_of(fold, [&](std::uint32_t f) { return facet.is_folded(f); });
    };
    for (const Faces& fold : folds) {
      outcome.n_folded += fold.size();
      if (!stopped_() && !is_open(fold)) facet.unfold(fold, stopped_);
    }
    for (const Faces& fold : folds)
      outcome.n_left += static_cast<std::size_t>(
          std::ranges::count_if(fold, [&](std::uint32_t f) { return facet.is_folded(f); }));
    facet.move(points_);
    return outcome;
  }
  /// Facet by facet of those with folds left: puts the vertices of its straight edges back in order, and
  /// unfolds what that has changed. It stays where fewer faces are folded.
  void unfold_edges() {
    const StraightEdges edges(facets_, stars_, held_, arrays_.points.size());
    std::vector<std::uint32_t> facets;
    for (const auto& [facet, outcome] : outcomes_)
      if (outcome.n_left > 0) facets.push_back(facet);
    for (std::uint32_t facet : facets) {
      if (stopped_() || outcomes_[facet].n_left == 0) continue;
      std::map<std::uint32_t, Outcome> now;
      std::size_t n_before = 0, n_left = 0;
      bool has_slit = false;
      for (std::uint32_t i : edges.unfold(facet, arrays_, points_)) {
        const auto known = outcomes_.find(i);
        if (known != outcomes_.end()) {
          n_before += known->second.n_left;
          has_slit = has_slit || known->second.has_slit;
        }
        now[i];
      }
      for (auto& [i, outcome] : now) {
        if (has_slit) break;
        outcome = unfold(i, /*is_rim_moved=*/true);
        n_left += outcome.n_left;
      }
      if (has_slit || stopped_() || n_left >= n_before) {
        points_.put_back();
        continue;
      }
      points_.keep();
      for (const auto& [i, outcome] : now) outcomes_[i] = outcome;
    }
  }

  const Arrays& arrays_;
  std::function<bool()> stopped_;
  FaceStars stars_;
  PlaneFacets facets_;
  std::vector<std::uint8_t> held_;
  Points points_;
  Scratch scratch_;
  std::map<std::uint32_t, Outcome> outcomes_;  // of facets whose faces do not all look alike
};

}  // namespace
}  // namespace planes

std::optional<std::vector<Vec3>> unfold_planes(const surface::Arrays& arrays, const SurfaceOptions& options,
                                               const std::function<bool()>& stopped, PlanarUnfolding& done) {
  done = {};
  if (options.mode == SurfaceMode::kFrozen || arrays.faces.empty()) return std::nullopt;
  const double least = surface::flat_tolerance(arrays);
  const double most = std::max(least, planes::kInPlane * surface::mean_edge(arrays));
  const bool is_flat = options.mode == SurfaceMode::kFlat;
  planes::PlaneUnfolder unfolder(
      arrays, is_flat ? least : std::clamp(surface::allowed_distance(arrays, options), least, most), stopped);
  done = unfolder.unfold();
  if (done.n_moved == 0) return std::nullopt;
  return unfolder.points();
}

PlanarUnfolding unfold_planes(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy,
                              const std::function<bool()>& stopped) {
  PlanarUnfolding done;
  const auto points = unfold_planes(surface::gather(mesh, options, policy), options, stopped, done);
  if (!points) return done;
  for (VertexHandle v : mesh.vertices())
    if ((*points)[v.idx()] != mesh.point(v)) mesh.set_point(v, (*points)[v.idx()]);
  return done;
}

}  // namespace hfr
