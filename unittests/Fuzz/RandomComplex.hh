// SPDX-License-Identifier: BSD-3-Clause
// Random small complexes that a run may meet: what a number names is the same on every machine (up to the
// last bit of sin and exp of the C library).
#ifndef HFR_UNITTESTS_FUZZ_RANDOM_COMPLEX_HH
#define HFR_UNITTESTS_FUZZ_RANDOM_COMPLEX_HH

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "Fuzz/RandomShapes.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::fuzz {

template <std::size_t N>
struct Labelled {
  std::array<Index, N> vertices;
  int label = 0;
};

/// A mesh before any connectivity, with everything that constrains a run. Indices may be out of range, and
/// coordinates no numbers, where `made_of` says "broken".
struct Complex {
  std::vector<Vec3> points;
  std::vector<Corners> cells;
  std::vector<int> regions;  ///< per cell, or empty
  std::vector<Labelled<3>> faces;
  std::vector<Labelled<2>> edges;
  std::vector<int> vertex_labels;  ///< per point, or empty
  std::vector<Index> fixed;
  std::string made_of;  ///< for people
};

/// Connectivity and labels. Throws what build() throws.
inline TetMesh mesh_of(const Complex& complex) {
  TetMesh mesh = build(complex.points, complex.cells);
  for (std::size_t c = 0; c < complex.regions.size(); ++c) mesh.set_region(CellHandle(c), complex.regions[c]);
  for (const Labelled<3>& f : complex.faces)
    mesh.labels().faces.set(
        {VertexHandle(f.vertices[0]), VertexHandle(f.vertices[1]), VertexHandle(f.vertices[2])}, f.label);
  for (const Labelled<2>& e : complex.edges)
    mesh.labels().edges.set({VertexHandle(e.vertices[0]), VertexHandle(e.vertices[1])}, e.label);
  mesh.labels().vertices = complex.vertex_labels;
  for (Index v : complex.fixed) mesh.set_fixed(VertexHandle(v));
  return mesh;
}

namespace detail {

/// As many cells as a part is asked for at most.
inline constexpr std::size_t kLargestPart = 300;

/// Puts together one complex, in the order of random_complex().
class Maker {
 public:
  Maker(const Random& random, std::size_t most) : random_(random), most_(most) {}

  Complex run() {
    take(part(std::min(most_cells(), most_)));
    const int n_parts = random_.chance(0.25) ? random_.from_to(1, 3) : 0;
    for (int i = 0; i < n_parts; ++i) join(part(std::min<std::size_t>(20, most_)));
    disturb();
    if (random_.chance(0.25)) order_at_random();
    split_into_regions();
    label();
    place();
    if (random_.chance(0.02)) break_something();
    return std::move(all_);
  }

 private:
  void say(const std::string& what) { all_.made_of += (all_.made_of.empty() ? "" : ", ") + what; }

  std::size_t most_cells() {
    if (random_.chance(0.08)) return kLargestPart;
    return random_.chance(0.3) ? 100 : 40;
  }

  /// One shape of about as many cells at most; those that are made to have many neighbours are larger.
  Arrays part(std::size_t most) {
    const bool large = most > 100;
    const bool middle = most > 40;
    const double kind = random_.unit();
    if (kind < 0.30) {
      const std::size_t n = 2 + random_.below(most - 1);
      const bool wild = random_.chance(0.5);
      say("glued " + std::to_string(n) + (wild ? " wild" : ""));
      return glued(random_, n, wild);
    }
    if (kind < 0.45) {
      const Index n = middle ? 3 : 2;
      const generate::Counts counts = {1 + static_cast<Index>(random_.below(n)),
                                       1 + static_cast<Index>(random_.below(n)),
                                       1 + static_cast<Index>(random_.below(large ? 6 : n))};
      say("box");
      return generate::box(counts);
    }
    if (kind < 0.53) return said("ball", generate::ball(large ? 2 : 1));
    if (kind < 0.60) return said("lattice", lattice(large ? 3 : 2));
    if (kind < 0.67) {
      const int n = random_.chance(0.3) ? random_.from_to(30, 80) : random_.from_to(3, 32);
      const bool closed = random_.chance(0.7);
      return said((closed ? "ring of " : "fan of ") + std::to_string(n), fan(random_, n, closed));
    }
    if (kind < 0.70 && middle) {
      const bool shell = random_.chance(0.5);
      return said(shell ? "large star with a shell" : "large star", star(random_, 4, shell));
    }
    if (kind < 0.74)
      return said("star", star(random_, 1 + static_cast<Index>(random_.below(2)), random_.chance(0.3)));
    if (kind < 0.82) {
      Arrays torn = generate::box({middle ? 3U : 2U, 2, large ? 4U : 2U});
      tear(random_, torn, random_.between(0.2, 0.9));
      return said("torn box", std::move(torn));
    }
    if (kind < 0.86) return said("slit", slit(random_, middle ? 2 : 1));
    if (kind < 0.90)
      return said("cylinder", generate::cylinder(large ? 2 : 1, large ? 3 : 1, 1, 2, 0, middle ? 90 : 0));
    if (kind < 0.93) {
      generate::CavityOptions options;
      options.counts = {3, 3, large ? 4U : 3U};
      options.seed = random_.next();
      options.amplitude = random_.between(0, 0.6);
      return said("cavity", generate::cavity(options));
    }
    if (kind < 0.96)
      return said("fandisk", generate::fandisk({1, 2, 1}, random_.between(0, 0.4), random_.next()));
    return said("one cell", one_cell());
  }
  Arrays said(const std::string& what, Arrays mesh) {
    say(what);
    return mesh;
  }

  void take(Arrays mesh) {
    if (random_.chance(0.2)) {
      const int n = random_.from_to(1, 6);
      split_cells(random_, mesh, n);
      say(std::to_string(n) + " split");
    }
    all_.points = std::move(mesh.points);
    all_.cells = std::move(mesh.cells);
  }

  /// Adds a part that shares nothing, a vertex, or an edge with what is there.
  void join(const Arrays& other) {
    if (other.cells.empty() || all_.cells.empty()) return;
    const std::size_t n_shared = random_.below(3);
    const Corners& here = random_.pick(all_.cells);
    const Corners& there = random_.pick(other.cells);
    say("at " + std::string(n_shared == 0 ? "nothing" : n_shared == 1 ? "a vertex" : "an edge"));
    std::vector<Index> to(other.points.size());
    const Vec3 shift = n_shared == 0 ? random_.step(2) : all_.points[here[0]] - other.points[there[0]];
    for (std::size_t v = 0; v < to.size(); ++v) {
      to[v] = static_cast<Index>(all_.points.size());
      for (std::size_t k = 0; k < n_shared; ++k)
        if (there[k] == v) to[v] = here[k];
      if (to[v] == all_.points.size()) all_.points.push_back(other.points[v] + shift);
    }
    for (const Corners& c : other.cells) all_.cells.push_back({to[c[0]], to[c[1]], to[c[2]], to[c[3]]});
  }

  /// Moves vertices: from good meshes to such in which everything is inverted, flat or in one point.
  void disturb() {
    const double kind = random_.unit();
    if (kind < 0.30) return;
    if (kind < 0.70) {
      const double size = random_.pick({0.02, 0.1, 0.2, 0.3, 0.5, 1.0});
      const bool few = random_.chance(0.3);
      for (Vec3& p : all_.points)
        if (!few || random_.chance(0.2)) p = p + random_.step(size);
      return say("jitter " + std::to_string(size).substr(0, 4) + (few ? " of few" : ""));
    }
    if (kind < 0.80) {  // a vertex through the face opposite
      const int n = random_.from_to(1, 4);
      for (int i = 0; i < n; ++i) reflect(random_.pick(all_.cells), random_.below(4));
      return say(std::to_string(n) + " reflected");
    }
    if (kind < 0.86) {
      const int n = random_.from_to(1, 3);
      for (int i = 0; i < n; ++i) all_.points[random_.below(all_.points.size())] = random_.pick(all_.points);
      return say(std::to_string(n) + " in the place of others");
    }
    if (kind < 0.90) {
      const int axis = random_.from_to(0, 2);
      const double height = random_.pick({0.0, 0.0, 1e-3, 1e-12, 1e-17});
      for (Vec3& p : all_.points) p[axis] *= height;
      return say(height == 0 ? "all in a plane" : "pressed flat");
    }
    if (kind < 0.91) {
      for (Vec3& p : all_.points) p = random_.chance(0.5) ? Vec3{0, 0, 0} : Vec3{p.x, 0, 0};
      return say("all on a line");
    }
    if (kind < 0.96) {  // many equal qualities and volumes that are exactly 0
      const double grid = random_.pick({1.0, 2.0, 4.0});
      for (Vec3& p : all_.points)
        for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * grid);
      return say("whole numbers");
    }
    for (Vec3& p : all_.points) p.x = -p.x;
    say("mirrored");
  }
  void reflect(const Corners& c, std::size_t k) {
    const Triangle f = face_of(c, k);
    const Vec3 a = all_.points[f[0]];
    const Vec3 up = cross(all_.points[f[1]] - a, all_.points[f[2]] - a);
    if (norm2(up) == 0) return;
    Vec3& p = all_.points[c[k]];
    p = p - (random_.pick({1.0, 1.3, 2.0}) * dot(p - a, up) / norm2(up)) * up;
  }

  /// Another order of cells, points and corners; the corners are no longer in a positive order.
  void order_at_random() {
    random_.shuffle(all_.cells);
    std::vector<Index> to(all_.points.size());
    for (std::size_t v = 0; v < to.size(); ++v) to[v] = static_cast<Index>(v);
    random_.shuffle(to);
    std::vector<Vec3> points(to.size());
    for (std::size_t v = 0; v < to.size(); ++v) points[to[v]] = all_.points[v];
    all_.points = std::move(points);
    const bool corners = random_.chance(0.3);
    for (Corners& c : all_.cells) {
      for (Index& v : c) v = to[v];
      if (corners && random_.chance(0.5)) std::swap(c[random_.below(4)], c[random_.below(4)]);
    }
    say("in random order");
  }

  void split_into_regions() {
    if (!random_.chance(0.25) || all_.cells.empty()) return;
    const int n = random_.from_to(2, 4);
    const bool by_place = random_.chance(0.6);
    Vec3 low = all_.points[all_.cells[0][0]], high = low;
    for (const Vec3& p : all_.points) {
      low.x = std::min(low.x, p.x);
      high.x = std::max(high.x, p.x);
    }
    for (const Corners& c : all_.cells) {
      double x = 0;
      for (Index v : c) x += 0.25 * all_.points[v].x;
      const double at = high.x > low.x ? (x - low.x) / (high.x - low.x) : 0;
      all_.regions.push_back(by_place ? static_cast<int>(std::min(at * n, n - 1.0)) : random_.from_to(1, n));
    }
    say(std::to_string(n) + (by_place ? " regions" : " mixed regions"));
  }

  void label() {
    if (!random_.chance(0.3) || all_.cells.empty()) return;
    const double share = random_.pick({0.02, 0.1, 0.5});
    const bool on_boundary = random_.chance(0.5);
    if (random_.chance(0.6)) {
      const Arrays arrays{all_.points, all_.cells, {}};
      std::vector<Triangle> faces = open_faces(arrays);
      if (!on_boundary)
        for (const Corners& c : all_.cells) faces.push_back(face_of(c, random_.below(4)));
      std::set<Triangle> known;
      for (const Triangle& f : faces)
        if (random_.chance(share) && known.insert(sorted(f)).second)
          all_.faces.push_back({f, random_.from_to(0, 3)});
      say("labelled faces");
    }
    if (random_.chance(0.5)) {
      std::set<std::array<Index, 2>> known;
      for (const Corners& c : all_.cells) {
        const auto& e = kEdgeCorners[random_.below(6)];
        const Index a = std::min(c[e[0]], c[e[1]]), b = std::max(c[e[0]], c[e[1]]);
        if (random_.chance(share) && known.insert({a, b}).second)
          all_.edges.push_back({{a, b}, random_.from_to(0, 3)});
      }
      say("labelled edges");
    }
    if (random_.chance(0.4)) {
      for (std::size_t v = 0; v < all_.points.size(); ++v)
        all_.vertex_labels.push_back(random_.chance(share) ? static_cast<int>(v) + 1 : 0);
      say("labelled vertices");
    }
    if (random_.chance(0.5)) {
      for (std::size_t v = 0; v < all_.points.size(); ++v)
        if (random_.chance(share)) all_.fixed.push_back(static_cast<Index>(v));
      say("fixed vertices");
    }
  }

  /// Where in space, and how large.
  void place() {
    const double kind = random_.unit();
    if (kind < 0.72) return;
    if (kind < 0.84) {
      const double scale = random_.pick({1e-150, 1e150, 1e-300, 1e300, 1e-30, 1e30, 1e-9, 1e6});
      for (Vec3& p : all_.points) p = scale * p;
      return say("times " + short_number(scale));
    }
    if (kind < 0.95) {
      const double by = random_.pick({1e6, 1e6, 1e9, 1e12, 1e15});
      const Vec3 shift = random_.chance(0.5) ? Vec3{by, by, by} : random_.step(by);
      for (Vec3& p : all_.points) p = p + shift;
      return say("offset " + short_number(by));
    }
    const double thin = random_.pick({1e-2, 1e-4, 1e-8});
    for (Vec3& p : all_.points) p.z *= thin;
    say("thin " + short_number(thin));
  }
  static std::string short_number(double x) {
    const int exponent = static_cast<int>(std::lround(std::log10(x)));
    return "1e" + std::to_string(exponent);
  }

  /// What build() has to refuse.
  void break_something() {
    if (all_.cells.empty()) return;
    const std::size_t at = random_.below(all_.cells.size());
    switch (random_.below(5)) {
      case 0:
        all_.points[all_.cells[at][0]].y =
            random_.pick({std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()});
        break;
      case 1:
        all_.cells[at][random_.below(4)] = static_cast<Index>(all_.points.size());
        break;
      case 2:
        all_.cells[at][3] = all_.cells[at][0];
        break;
      case 3:
        all_.cells.push_back(all_.cells[at]);
        if (!all_.regions.empty()) all_.regions.push_back(0);
        break;
      default: {  // a third cell at faces that have two
        Corners third = all_.cells[at];
        third[random_.below(4)] = static_cast<Index>(all_.points.size());
        all_.points.push_back({0.3, 0.4, 0.5});
        if (!all_.vertex_labels.empty()) all_.vertex_labels.push_back(0);
        all_.cells.push_back(third);
        if (!all_.regions.empty()) all_.regions.push_back(0);
      }
    }
    say("broken");
  }

  Random random_;
  std::size_t most_;  ///< cells that a part is asked for at most; some shapes have more
  Complex all_;
};

}  // namespace detail

/// The complex of that number: 1 to 40 cells, some to a few hundred, up to 1,300 with stars of more than 256.
inline Complex random_complex(std::uint64_t number) {
  return detail::Maker(Random(number * 0x9e3779b97f4a7c15ULL ^ 0x68667266757a7aULL), detail::kLargestPart)
      .run();
}
/// What the numbers that come next make, of parts of about `most` cells; some shapes have more.
inline Complex random_complex(const Random& random, std::size_t most) {
  return detail::Maker(random, most).run();
}

}  // namespace hfr::fuzz

#endif
