// SPDX-License-Identifier: BSD-3-Clause
// Liu, Chen & Sun, Small polyhedron reconnection for mesh improvement and its implementation based on
// advancing front technique, 2009; the growing cavity and the choice of the face with the fewest cells:
// Marot, Verhetsel & Remacle, Reviving the search for optimal tetrahedralizations, 2019.
//
// What is found needs no test for overlap. Every face of the cavity is filled from inside and every face
// between new cells from both sides, so the new cells cover each point of the cavity as often as the old ones
// did, once; and since all of them are positive, none lies on another. Tests for crossings only cut branches.
#include "Operators/ClusterSearch.hh"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "Operators/Metrics.hh"

namespace hfr {
namespace {

constexpr std::size_t kPoints = 32;
constexpr std::size_t kFaces = kPoints * (kPoints - 1) * (kPoints - 2) / 6;
constexpr std::size_t kTets = kFaces * (kPoints - 3) / 4;
constexpr std::size_t kMaxFront = 160;
constexpr std::size_t kMaxDepth = 96;
/// Volume that the cells of a branch may claim beyond the cavity's, relative: rounding.
constexpr double kVolumeSlack = 1e-9;

using Point = std::uint8_t;  // number of a point of the cavity
using LocalTet = std::array<Point, 4>;

// Places of sorted pairs, triples and quadruples in tables.
constexpr std::size_t pair_index(std::size_t i, std::size_t j) { return j * (j - 1) / 2 + i; }
constexpr std::size_t triple_index(std::size_t i, std::size_t j, std::size_t k) {
  return k * (k - 1) * (k - 2) / 6 + pair_index(i, j);
}
constexpr std::size_t quad_index(std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
  return l * (l - 1) * (l - 2) * (l - 3) / 24 + triple_index(i, j, k);
}

/// Three points and a side: with a point on that side, (p[0], p[1], p[2], point) or, if `odd`, that with two
/// swapped is positive. p ascending.
struct LocalFace {
  std::array<Point, 3> p;
  bool odd = false;

  std::size_t index() const { return triple_index(p[0], p[1], p[2]); }
};

LocalFace make_face(Point a, Point b, Point c) {
  LocalFace f{{a, b, c}, false};
  const auto order = [&](std::size_t i, std::size_t j) {
    if (f.p[j] >= f.p[i]) return;
    std::swap(f.p[i], f.p[j]);
    f.odd = !f.odd;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return f;
}

/// Distinct vertices in the order in which the cells name them.
using Points = FixedVector<VertexHandle, kPoints>;
bool add_points(const TetMesh& mesh, CellHandle c, std::size_t limit, Points& points) {
  for (VertexHandle v : mesh.cell(c).v) {
    if (std::find(points.begin(), points.end(), v) != points.end()) continue;
    if (points.size() == limit) return false;
    points.push_back(v);
  }
  return true;
}

/// All ways to fill one cavity, best worst cell first found and then raised.
template <class Metric>
class Search {
 public:
  Search(const TetMesh& mesh, const Metric& metric, const Points& points, std::size_t max_nodes)
      : metric_(metric), n_(points.size()), nodes_left_(max_nodes) {
    for (std::size_t i = 0; i < n_; ++i) p_[i] = mesh.point(points[i]);
    std::fill_n(values_.begin(), quad_index(0, 1, 2, n_), kUnknown);
    std::fill_n(state_.begin(), triple_index(0, 1, n_), kFree);
    std::fill_n(face_pierced_.begin(), triple_index(0, 1, n_), kNotAsked);
    std::fill_n(edge_pierces_.begin(), pair_index(0, n_), kNotAsked);
  }

  /// A face of the cavity as seen from inside.
  void add_outer(Point a, Point b, Point c) {
    const LocalFace f = make_face(a, b, c);
    outer_.push_back(f);
    front_.push_back(f);
    state_[f.index()] = f.odd ? kOpenOdd : kOpenEven;
  }

  /// Largest worst value above `floor` over all fillings whose cells have `volume6` in sum; `floor` when
  /// there is none or it was not found in time.
  double solve(double floor, double volume6) {
    best_ = floor;
    branch(front_, std::numeric_limits<double>::infinity(), volume6, kVolumeSlack * volume6);
    return best_;
  }
  const FixedVector<LocalTet, kMaxDepth>& found() const { return found_; }

 private:
  using Front = FixedVector<LocalFace, kMaxFront>;
  enum State : std::uint8_t { kFree, kOpenEven, kOpenOdd, kFilled };
  enum Answer : std::uint8_t { kNotAsked, kNo, kYes };
  static constexpr double kUnknown = -2e300;

  struct Candidate {
    Point apex;
    double value;
  };
  using Candidates = FixedVector<Candidate, kPoints>;

  bool crosses(Vec3 a, Vec3 b, Vec3 x, Vec3 y, Vec3 z) const {
    const int above = orientation(x, y, z, a);
    if (above == 0 || above * orientation(x, y, z, b) >= 0) return false;
    const int side = orientation(a, b, x, y);
    return side != 0 && side == orientation(a, b, y, z) && side == orientation(a, b, z, x);
  }
  static bool has(const std::array<Point, 3>& f, Point i) { return f[0] == i || f[1] == i || f[2] == i; }

  /// True when the edge goes through a face of the cavity.
  bool edge_is_barred(Point i, Point j) {
    Answer& answer = edge_pierces_[pair_index(i, j)];
    if (answer == kNotAsked) {
      answer = kNo;
      for (const LocalFace& f : outer_) {
        if (has(f.p, i) || has(f.p, j)) continue;
        if (crosses(p_[i], p_[j], p_[f.p[0]], p_[f.p[1]], p_[f.p[2]])) answer = kYes;
      }
    }
    return answer == kYes;
  }
  /// True when an edge of the cavity's surface goes through the face.
  bool face_is_barred(Point i, Point j, Point k) {
    Answer& answer = face_pierced_[triple_index(i, j, k)];
    if (answer == kNotAsked) {
      answer = kNo;
      const std::array<Point, 3> face = {i, j, k};
      for (const LocalFace& f : outer_) {
        for (std::size_t e = 0; e < 3; ++e) {
          const Point a = f.p[e];
          const Point b = f.p[(e + 1) % 3];
          if (has(face, a) || has(face, b)) continue;
          if (crosses(p_[a], p_[b], p_[i], p_[j], p_[k])) answer = kYes;
        }
      }
    }
    return answer == kYes;
  }

  /// Decision value of the cell on four ascending points, times -1 where it is (i, j, l, k) that is positive;
  /// 0 when neither is or the cell cannot be part of any filling.
  double value(Point i, Point j, Point k, Point l) {
    double& known = values_[quad_index(i, j, k, l)];
    if (known != kUnknown) return known;
    known = 0;
    double v = metric_(p_[i], p_[j], p_[k], p_[l]);
    double sign = 1;
    if (!(v > 0)) {
      v = metric_(p_[i], p_[j], p_[l], p_[k]);
      sign = -1;
    }
    if (!(v > best_)) return known;  // the bound only rises
    if (edge_is_barred(i, j) || edge_is_barred(i, k) || edge_is_barred(i, l) || edge_is_barred(j, k) ||
        edge_is_barred(j, l) || edge_is_barred(k, l) || face_is_barred(i, j, k) || face_is_barred(i, j, l) ||
        face_is_barred(i, k, l) || face_is_barred(j, k, l))
      return known;
    if (holds_a_point({i, j, k, l}, sign > 0)) return known;
    known = sign * v;
    return known;
  }
  bool holds_a_point(LocalTet t, bool positive) const {
    if (!positive) std::swap(t[2], t[3]);
    for (std::size_t i = 0; i < n_; ++i) {
      if (std::find(t.begin(), t.end(), i) != t.end()) continue;
      bool inside = true;
      for (const auto& f : kFaceCorners)
        inside = inside && orientation(p_[t[f[0]]], p_[t[f[1]]], p_[t[f[2]]], p_[i]) > 0;
      if (inside) return true;
    }
    return false;
  }

  /// The cell of a face and an apex on its side; 0 when it is on the other.
  double value_on(const LocalFace& f, Point apex) {
    std::array<Point, 4> s = {f.p[0], f.p[1], f.p[2], apex};
    bool odd = f.odd;
    for (std::size_t i = 3; i > 0 && s[i] < s[i - 1]; --i) {
      std::swap(s[i], s[i - 1]);
      odd = !odd;
    }
    const double v = value(s[0], s[1], s[2], s[3]);
    return odd ? -v : v;
  }

  /// The three faces of the cell of `f` and an apex that are not f, as seen from inside of the cell.
  static std::array<LocalFace, 3> sides(const LocalFace& f, Point apex) {
    const auto [a, b, c] = f.p;
    std::array<LocalFace, 3> s = {make_face(b, a, apex), make_face(c, b, apex), make_face(a, c, apex)};
    // (a, b, c, apex) is positive, or with `odd` its mirror image.
    for (LocalFace& side : s) side.odd = side.odd != f.odd;
    return s;
  }
  bool fits(const LocalFace& f, Point apex) const {
    for (const LocalFace& s : sides(f, apex)) {
      const State state = state_[s.index()];
      if (state == kFilled || state == (s.odd ? kOpenEven : kOpenOdd)) return false;
    }
    return true;
  }
  void candidates(const LocalFace& f, std::size_t limit, Candidates& out) {
    out.clear();
    for (std::size_t i = 0; i < n_ && out.size() < limit; ++i) {
      const Point apex = static_cast<Point>(i);
      if (has(f.p, apex)) continue;
      const double v = value_on(f, apex);
      if (v > best_ && fits(f, apex)) out.push_back({apex, v});
    }
  }

  /// `front`: faces that wait for a cell on their side. `worst`: of the cells placed so far.
  void branch(const Front& front, double worst, double volume6, double slack) {
    if (front.empty()) {
      best_ = worst;
      found_ = placed_;
      return;
    }
    if (nodes_left_ == 0 || placed_.size() == kMaxDepth) return;
    --nodes_left_;
    Candidates choice;
    std::size_t at = front.size();
    Candidates now;
    for (std::size_t i = 0; i < front.size() && (at == front.size() || choice.size() > 1); ++i) {
      candidates(front[i], at == front.size() ? kPoints : choice.size(), now);
      if (now.empty()) return;
      if (at != front.size() && now.size() >= choice.size()) continue;
      choice = now;
      at = i;
    }
    std::sort(choice.begin(), choice.end(), [](const Candidate& x, const Candidate& y) {
      return x.value > y.value || (x.value == y.value && x.apex < y.apex);
    });
    const LocalFace f = front[at];
    for (const Candidate& c : choice) {
      if (!(c.value > best_)) return;  // what was found meanwhile is better than all that is left
      place(front, f, c, worst, volume6, slack);
    }
  }

  void place(const Front& front, const LocalFace& f, const Candidate& c, double worst, double volume6,
             double slack) {
    LocalTet t = {f.p[0], f.p[1], f.p[2], c.apex};
    std::sort(t.begin(), t.end());
    if (value(t[0], t[1], t[2], t[3]) < 0) std::swap(t[2], t[3]);
    const Vec3 o = p_[t[0]];
    const double det = dot(p_[t[1]] - o, cross(p_[t[2]] - o, p_[t[3]] - o));
    if (volume6 - det < -slack) return;
    Front next;
    for (const LocalFace& g : front)
      if (g.index() != f.index()) next.push_back(g);
    const std::array<LocalFace, 3> around = sides(f, c.apex);
    std::array<State, 3> before;
    for (std::size_t i = 0; i < 3; ++i) {
      const LocalFace& s = around[i];
      State& state = state_[s.index()];
      before[i] = state;
      if (state == kFree) {
        if (next.size() + 1 == kMaxFront) {
          for (std::size_t k = 0; k < i; ++k) state_[around[k].index()] = before[k];
          return;
        }
        next.push_back({s.p, !s.odd});
        state = s.odd ? kOpenEven : kOpenOdd;
      } else {  // it waited for this side
        for (std::size_t k = 0; k < next.size(); ++k) {
          if (next[k].index() != s.index()) continue;
          next[k] = next[next.size() - 1];
          next.resize(next.size() - 1);
          break;
        }
        state = kFilled;
      }
    }
    const State own = state_[f.index()];
    state_[f.index()] = kFilled;
    placed_.push_back(t);
    branch(next, std::min(worst, c.value), volume6 - det, slack);
    placed_.resize(placed_.size() - 1);
    state_[f.index()] = own;
    for (std::size_t k = 3; k-- > 0;) state_[around[k].index()] = before[k];
  }

  const Metric& metric_;
  std::size_t n_;
  std::size_t nodes_left_;
  double best_ = 0;
  RawArray<Vec3, kPoints> p_;
  RawArray<double, kTets> values_;
  RawArray<State, kFaces> state_;
  RawArray<Answer, kFaces> face_pierced_;
  RawArray<Answer, kPoints*(kPoints - 1) / 2> edge_pierces_;
  FixedVector<LocalFace, GrownCells::kMaxFaces> outer_;
  Front front_;
  FixedVector<LocalTet, kMaxDepth> placed_, found_;
};

/// Takes in the cell behind the outer face whose opposite point is nearest to `centre`; points that are in
/// already come first. False when nothing can be taken in without exceeding the limit of points.
bool grow_nearest(const TetMesh& mesh, GrownCells& cells, Points& points, Vec3 centre, std::size_t limit) {
  struct Way {
    double distance;
    HalfFaceHandle h;
  };
  FixedVector<Way, GrownCells::kMaxFaces> ways;
  for (HalfFaceHandle h : cells.outer()) {
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (!m.is_valid()) continue;
    const VertexHandle v = mesh.halfface_opposite_vertex(m);
    const bool is_in = std::find(points.begin(), points.end(), v) != points.end();
    if (!is_in && points.size() == limit) continue;
    ways.push_back({is_in ? -1.0 : norm2(mesh.point(v) - centre), h});
  }
  std::sort(ways.begin(), ways.end(), [](const Way& a, const Way& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.h < b.h);
  });
  for (const Way& way : ways) {
    if (!cells.grow(way.h)) continue;
    add_points(mesh, cells.cells()[cells.cells().size() - 1], limit, points);
    return true;
  }
  return false;
}

}  // namespace

template <class Metric>
void ClusterSearch<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  seed.growth.cells(mesh, out);
}

template <class Metric>
auto ClusterSearch<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  static_assert(kMaxPoints == kPoints && kMaxCreated == kMaxDepth);
  constexpr std::size_t kFewestCells = 3;
  const std::size_t limit = std::min(max_points, kMaxPoints);
  GrownCells cells(mesh, seed.cell);
  Points points;
  add_points(mesh, seed.cell, limit, points);
  const Vec3 centre = 0.25 * ((mesh.point(points[0]) + mesh.point(points[1])) +
                              (mesh.point(points[2]) + mesh.point(points[3])));
  double old_worst = quality[seed.cell.idx()];
  double volume6 = 0;
  const auto take = [&](CellHandle c) {
    const auto& v = mesh.cell(c).v;
    const Vec3 o = mesh.point(v[0]);
    volume6 += dot(mesh.point(v[1]) - o, cross(mesh.point(v[2]) - o, mesh.point(v[3]) - o));
    old_worst = std::min(old_worst, quality[c.idx()]);
    return !rim || !rim->look(cells, c);  // what lies behind the rim is not known here
  };
  if (!take(seed.cell)) return std::nullopt;
  for (bool more = true; more;) {
    const std::size_t n_points = points.size();
    // All cells between points that are in, then the next point.
    GrownCells wider = cells;
    Points wider_points = points;
    more = grow_nearest(mesh, wider, wider_points, centre, limit);
    const bool complete = !more || wider_points.size() > n_points;
    if (complete && cells.cells().size() >= kFewestCells) {
      Search<Metric> search(mesh, metric, points, max_nodes);
      const auto local = [&](VertexHandle v) {
        return static_cast<Point>(std::find(points.begin(), points.end(), v) - points.begin());
      };
      for (HalfFaceHandle h : cells.outer()) {
        const auto f = mesh.halfface_vertices(h);
        search.add_outer(local(f[0]), local(f[1]), local(f[2]));
      }
      // Inverted cells would look better when smaller; what is found is positive throughout.
      const double floor = std::max({gain * old_worst, old_worst, 0.0});
      const double worst = search.solve(floor, volume6);
      if (worst > floor) {
        Plan plan;
        plan.seed = seed;
        plan.seed.growth = cells.growth();
        plan.old_worst = old_worst;
        plan.new_worst = worst;
        plan.n_removed = static_cast<std::uint32_t>(cells.cells().size());
        plan.n_created = static_cast<std::uint32_t>(search.found().size());
        std::copy(search.found().begin(), search.found().end(), plan.created.begin());
        return plan;
      }
    }
    if (!more) break;
    cells = wider;
    points = wider_points;
    if (!take(cells.cells()[cells.cells().size() - 1])) break;
  }
  return std::nullopt;
}

template <class Metric>
void ClusterSearch<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  Scope cells;
  plan.seed.growth.cells(mesh, cells);
  out.clear();
  Points points;
  for (CellHandle c : cells) {
    out.removed.push_back(c);
    add_points(mesh, c, kMaxPoints, points);
  }
  for (std::size_t i = 0; i < plan.n_created; ++i) {
    const auto& t = plan.created[i];
    out.created.push_back({points[t[0]], points[t[1]], points[t[2]], points[t[3]]});
  }
}

template <class Metric>
Tet ClusterSearch<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  Tet names = mesh.cell(seed.cell).v;
  std::sort(names.begin(), names.end());
  return names;
}

HFR_INSTANTIATE_FOR_METRICS(ClusterSearch)

}  // namespace hfr
