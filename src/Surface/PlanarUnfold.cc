// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/PlanarUnfold.hh"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "HalfFace/Layers.hh"
#include "Surface/FaceStars.hh"
#include "Surface/PlaneFacets.hh"
#include "Surface/PlaneStar.hh"
#include "Surface/StraightEdges.hh"
#include "Surface/TrialPoints.hh"

namespace hfr {
namespace {

using surface::Arrays;
using surface::corners;
using surface::FaceStars;
using surface::PlaneFacets;
using surface::Point2;
using surface::scaled_normal;
using surface::StraightEdges;
using surface::TrialPoints;
using surface::unit;
using FaceList = std::vector<std::uint32_t>;

/// Of the mean edge: in free mode, what lies no further from a plane is in it, if the distance allows that.
constexpr double kInPlane = 1e-6;
/// Rings of faces round a fold whose vertices move; then twice as many, until these are all of the facet.
constexpr int kFirstRings = 2;
constexpr int kIdlePasses = 40;  // of the energy, without fewer faces of the fold
/// Of a regular triangle with its edges, the least area of one that is no fold.
constexpr double kLeastArea = 1e-6;

template <class T>
void sort_and_unite(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// Tells the faces at the vertices of some faces, for grow_layers().
auto faces_round(const Arrays& arrays, const FaceStars& stars) {
  return [&](std::span<const std::uint32_t> rim, auto&& reach) {
    for (std::uint32_t f : rim)
      for (VertexHandle v : arrays.faces[f])
        for (std::uint32_t g : stars.at(v)) reach(g);
  };
}

/// The surface, as all of its facets see it, and room for each in turn: so each takes as long as it is large.
struct PlaneSurface {
  const Arrays& arrays;
  double tolerance;
  FaceStars stars;
  std::vector<surface::Edge> edges;
  PlaneFacets facets;
  std::vector<FaceList> faces;          ///< per facet, ascending
  std::vector<std::uint8_t> held;       ///< per vertex
  std::vector<std::uint32_t> position;  ///< per vertex: that among the vertices of the facet at hand
  std::vector<std::uint8_t> is_asked;   ///< per face: 0 between uses
  std::vector<surface::Side> sides;     ///< of the vertex at hand

  PlaneSurface(const Arrays& of, double within)
      : arrays(of),
        tolerance(within),
        stars(of),
        edges(surface::find_edges(of)),
        facets(surface::grow_facets(of, edges, within, surface::Look::kEitherWay,
                                    [&](const surface::Edge& e) { return may_be_inside(of, e); })),
        faces(facets.largest.size()),
        held(surface::held_vertices(of)),
        position(of.points.size(), 0),
        is_asked(of.faces.size(), 0) {
    for (std::uint32_t f = 0; f < facets.number.size(); ++f) faces[facets.number[f]].push_back(f);
  }

 private:
  /// Between what has the same labels, and is not to stay.
  static bool may_be_inside(const Arrays& of, const surface::Edge& e) {
    const auto same = [&](const auto& value) { return value[e.f[0]] == value[e.f[1]]; };
    return !std::ranges::binary_search(of.locked_edges, std::array{e.a, e.b}) && same(of.patch) &&
           same(of.inward) && same(of.regions) && !of.locked[e.f[0]] && !of.locked[e.f[1]];
  }
};

/// One plane facet, seen from the side to which most of its area looks.
class PlaneFacet {
 public:
  PlaneFacet(PlaneSurface& surface, std::uint32_t number, std::span<const Vec3> points)
      : surface_(surface), number_(number) {
    for (std::uint32_t f : faces())
      vertices_.insert(vertices_.end(), arrays().faces[f].begin(), arrays().faces[f].end());
    sort_and_unite(vertices_);
    Vec3 sum;
    for (std::uint32_t f : faces()) sum = sum + scaled_normal(corners(points, arrays().faces[f]));
    // As the facet came in: those of its edges that have been put in order since may have moved this face.
    const Triangle t = corners(arrays().points, arrays().faces[surface.facets.largest[number]]);
    Vec3 up = unit(scaled_normal(t));
    if (dot(sum, up) < 0) up = -1.0 * up;
    x_ = unit(t[1] - t[0]);
    y_ = cross(up, x_);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const VertexHandle v = vertices_[i];
      surface.position[v.idx()] = static_cast<std::uint32_t>(i);
      const Vec3 p = points[v.idx()] - t[0];
      at_.push_back({dot(p, x_), dot(p, y_)});
      const bool is_inside = std::ranges::all_of(
          surface.stars.at(v), [&](std::uint32_t f) { return surface.facets.number[f] == number; });
      moves_.push_back(is_inside && !surface.held[v.idx()]);
    }
    before_ = at_;
  }

  bool is_folded(std::uint32_t f) const {
    const auto& v = arrays().faces[f];
    const surface::Side side{at(v[0]), at(v[1])};
    return !(side.twice_area(at(v[2])) > kLeastArea * surface::regular_area(side.sum2(at(v[2]))));
  }
  std::size_t n_folded(const FaceList& of) const {
    return static_cast<std::size_t>(std::ranges::count_if(of, [&](std::uint32_t f) { return is_folded(f); }));
  }
  /// Its faces that look the wrong way or have no area, in sets that hang together at vertices; each
  /// ascending.
  std::vector<FaceList> folds() const {
    FaceList folded;
    std::ranges::copy_if(faces(), std::back_inserter(folded), [&](std::uint32_t f) { return is_folded(f); });
    auto& is_left = surface_.is_asked;
    for (std::uint32_t f : folded) is_left[f] = 1;
    std::vector<FaceList> folds;
    for (std::uint32_t first : folded) {
      if (!std::exchange(is_left[first], std::uint8_t{0})) continue;
      FaceList& fold = folds.emplace_back(1, first);
      grow_layers(fold, kAllLayers, faces_round(arrays(), surface_.stars),
                  [&](std::uint32_t f) { return std::exchange(is_left[f], std::uint8_t{0}) != 0; });
      std::ranges::sort(fold);
    }
    return folds;
  }
  /// The vertices of these faces stay from now on.
  void hold(const FaceList& of) {
    for (std::uint32_t f : of)
      for (VertexHandle v : arrays().faces[f]) moves_[surface_.position[v.idx()]] = 0;
  }
  /// Moves the vertices round one fold until none of its faces is folded any more, and no other has come to
  /// be, in as few rings as that takes; false, and nothing moves, where no number of rings does.
  bool unfold(const FaceList& fold, const std::function<bool()>& stopped) {
    // A face that none of its vertices can open stays a fold.
    const auto may_open = [&](std::uint32_t f) {
      return std::ranges::any_of(arrays().faces[f], [&](VertexHandle v) { return moves(v); });
    };
    if (!std::ranges::all_of(fold, may_open)) return false;
    const auto n_all = static_cast<std::size_t>(std::ranges::count(moves_, std::uint8_t{1}));
    for (int rings = kFirstRings;; rings *= 2) {
      const std::vector<VertexHandle> vertices = movable(fold, rings);
      const bool are_all = vertices.size() == n_all;
      if (are_all && all_are_vain_) return false;
      if (unfold(fold, vertices, stopped)) return true;
      if (stopped()) return false;
      if (are_all) {
        all_are_vain_ = true;
        return false;
      }
    }
  }
  /// Brings the points to where they are now.
  void move(TrialPoints& points) const {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Point2 by = at_[i] - before_[i];
      if (by != Point2{}) points.move(vertices_[i], by.x * x_ + by.y * y_);
    }
  }

 private:
  const Arrays& arrays() const { return surface_.arrays; }
  const FaceList& faces() const { return surface_.faces[number_]; }
  Point2& at(VertexHandle v) { return at_[surface_.position[v.idx()]]; }
  Point2 at(VertexHandle v) const { return at_[surface_.position[v.idx()]]; }
  /// Whether all faces of the vertex are in the facet and nothing holds it.
  bool moves(VertexHandle v) const { return moves_[surface_.position[v.idx()]]; }

  bool unfold(const FaceList& fold, const std::vector<VertexHandle>& vertices,
              const std::function<bool()>& stopped) {
    FaceList faces = fold;
    for (VertexHandle v : vertices)
      faces.insert(faces.end(), surface_.stars.at(v).begin(), surface_.stars.at(v).end());
    sort_and_unite(faces);
    std::erase_if(faces, [&](std::uint32_t f) {  // other folds
      return is_folded(f) && !std::ranges::binary_search(fold, f);
    });
    std::vector<Point2> before;
    for (VertexHandle v : vertices) before.push_back(at(v));
    std::size_t fewest = faces.size() + 1;
    for (int idle = 0; idle < kIdlePasses && !stopped(); ++idle) {
      for (VertexHandle v : vertices) at(v) = surface::unfold_in_plane(sides_of(v), at(v));
      const std::size_t n = n_folded(faces);
      if (n == 0) return true;
      if (n < fewest) idle = 0;
      fewest = std::min(fewest, n);
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) at(vertices[i]) = before[i];
    return false;
  }
  std::span<const surface::Side> sides_of(VertexHandle v) const {
    surface_.sides.clear();
    for (std::uint32_t f : surface_.stars.at(v)) {
      const auto& corner = arrays().faces[f];
      const auto k = static_cast<std::size_t>(std::ranges::find(corner, v) - corner.begin());
      surface_.sides.push_back({at(corner[(k + 1) % 3]), at(corner[(k + 2) % 3])});
    }
    return surface_.sides;
  }
  /// Vertices that move, of these faces and of so many rings of the facet's faces round them; ascending.
  std::vector<VertexHandle> movable(const FaceList& fold, int rings) const {
    FaceList near = fold;
    auto& is_in = surface_.is_asked;
    for (std::uint32_t f : near) is_in[f] = 1;
    grow_layers(near, rings, faces_round(arrays(), surface_.stars), [&](std::uint32_t f) {
      return surface_.facets.number[f] == number_ && std::exchange(is_in[f], std::uint8_t{1}) == 0;
    });
    std::vector<VertexHandle> vertices;
    for (std::uint32_t f : near) {
      is_in[f] = 0;
      std::ranges::copy_if(arrays().faces[f], std::back_inserter(vertices),
                           [&](VertexHandle v) { return moves(v); });
    }
    sort_and_unite(vertices);
    return vertices;
  }

  PlaneSurface& surface_;
  std::uint32_t number_;
  std::vector<VertexHandle> vertices_;  // ascending
  std::vector<Point2> at_, before_;     // of these
  std::vector<std::uint8_t> moves_;
  Vec3 x_, y_;                 // axes in the plane
  bool all_are_vain_ = false;  // moving all vertices has not opened one fold
};

/// Opens the folds of all facets, then those that only straight edges have room for.
class PlaneUnfolder {
 public:
  PlaneUnfolder(const Arrays& arrays, double tolerance, const std::function<bool()>& stopped)
      : surface_(arrays, tolerance),
        stopped_([&stopped] { return stopped && stopped(); }),
        points_(arrays.points) {}

  const std::vector<Vec3>& points() const { return points_.get(); }

  PlanarUnfolding unfold() {
    PlanarUnfolding done;
    for (std::uint32_t i = 0; i < surface_.faces.size(); ++i) {
      if (all_look_alike(surface_.faces[i])) continue;
      if (stopped_()) break;
      outcomes_[i] = unfold(i, /*may_have_slits=*/true);
      done.n_folded += outcomes_[i].n_folded;
    }
    points_.keep();
    if (std::ranges::any_of(outcomes_, [](const auto& o) { return o.second.n_left > 0; })) unfold_edges();
    for (const auto& [facet, outcome] : outcomes_) done.n_left += outcome.n_left;
    for (std::size_t i = 0; i < points().size(); ++i)
      done.n_moved += points()[i] == surface_.arrays.points[i] ? 0 : 1;
    return done;
  }

 private:
  struct Outcome {
    std::size_t n_folded = 0, n_left = 0;
    bool has_slit = false;
  };

  bool all_look_alike(const FaceList& faces) const {
    Vec3 sum;
    const auto area = [&](std::uint32_t f) {
      return scaled_normal(corners(points(), surface_.arrays.faces[f]));
    };
    for (std::uint32_t f : faces) sum = sum + area(f);
    return std::ranges::all_of(faces, [&](std::uint32_t f) { return dot(area(f), sum) > 0; });
  }
  /// The two sides of a slit lie on one another as the layers of a fold do; but cells behind what a fold has
  /// turned over are inverted.
  bool is_slit(const FaceList& faces) const {
    const auto n =
        std::ranges::count_if(faces, [&](std::uint32_t f) { return surface_.arrays.at_invalid[f] != 0; });
    return 2 * static_cast<std::size_t>(n) <= faces.size();
  }
  /// `may_have_slits`: not of a facet without one whose rim has moved, which the cells do not know of yet.
  Outcome unfold(std::uint32_t number, bool may_have_slits) {
    PlaneFacet facet(surface_, number, points());
    Outcome outcome;
    std::vector<FaceList> folds = facet.folds();
    if (may_have_slits)
      outcome.has_slit = std::erase_if(folds, [&](const FaceList& fold) {
                           if (!is_slit(fold)) return false;
                           facet.hold(fold);
                           return true;
                         }) > 0;
    for (const FaceList& fold : folds) {
      outcome.n_folded += fold.size();
      if (!stopped_() && facet.n_folded(fold) > 0) facet.unfold(fold, stopped_);
    }
    for (const FaceList& fold : folds) outcome.n_left += facet.n_folded(fold);
    facet.move(points_);
    return outcome;
  }
  /// Facet by facet of those with folds left: puts the vertices of its straight edges back in order, and
  /// unfolds what that has changed. It stays where fewer faces are folded.
  void unfold_edges() {
    const StraightEdges edges(surface_.arrays, surface_.edges, surface_.facets, surface_.tolerance,
                              surface_.stars, surface_.held);
    FaceList facets;
    for (const auto& [facet, outcome] : outcomes_)
      if (outcome.n_left > 0) facets.push_back(facet);
    for (std::uint32_t facet : facets) {
      if (stopped_() || outcomes_[facet].n_left == 0) continue;
      std::map<std::uint32_t, Outcome> now;
      std::size_t n_before = 0, n_left = 0;
      bool has_slit = false;
      for (std::uint32_t i : edges.unfold(surface_.faces[facet], points_)) {
        now[i];
        const auto known = outcomes_.find(i);
        if (known == outcomes_.end()) continue;
        n_before += known->second.n_left;
        has_slit = has_slit || known->second.has_slit;
      }
      for (auto& [i, outcome] : now) {
        if (has_slit) break;
        outcome = unfold(i, /*may_have_slits=*/false);
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

  PlaneSurface surface_;
  std::function<bool()> stopped_;
  TrialPoints points_;
  std::map<std::uint32_t, Outcome> outcomes_;  // of facets whose faces do not all look alike
};

}  // namespace

std::optional<std::vector<Vec3>> unfold_planes(const surface::Arrays& arrays, const SurfaceOptions& options,
                                               const std::function<bool()>& stopped, PlanarUnfolding& done) {
  done = {};
  if (options.mode == SurfaceMode::kFrozen || arrays.faces.empty()) return std::nullopt;
  const double least = surface::flat_tolerance(arrays);
  const double most = std::max(least, kInPlane * surface::mean_edge(arrays));
  const bool is_flat = options.mode == SurfaceMode::kFlat;
  PlaneUnfolder unfolder(
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
