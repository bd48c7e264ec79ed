// SPDX-License-Identifier: BSD-3-Clause
// The tree is Eigen's KdBVH: in double precision, with the same answer on every run, and it comes with the
// package that the points of the surface need anyway. (Embree works in single precision, nanoflann knows
// points only, Boost.Geometry has no triangles in space, and libigl is not packaged everywhere.)
#include "Surface/InputSurface.hh"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/BVH>

#include "Surface/Features.hh"
#include "Surface/NearTriangle.hh"

namespace hfr {

using surface::scaled_normal;

namespace {

using Box = Eigen::AlignedBox<double, 3>;
using Tree = Eigen::KdBVH<double, 3, int>;

Eigen::Vector3d eigen(Vec3 p) { return {p.x, p.y, p.z}; }

/// Height over the longest edge below which nearest_point() loses too many digits to differences of products.
constexpr double kThin = 1e-2;

/// Nearest point of a thin triangle, in coordinates along its longest edge and from that to the third corner,
/// each of which is right to its own last digits.
Vec3 nearest_point_of_thin(std::array<Vec3, 3> t, Vec3 x) {
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (norm2(t[(k + 1) % 3] - t[k]) > norm2(t[(longest + 1) % 3] - t[longest])) longest = k;
  std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(longest), t.end());
  const Vec3 base = t[1] - t[0];
  const Vec3 side = t[2] - t[0];
  const double base2 = norm2(base);
  if (!(base2 > 0)) return t[0];
  const double foot = dot(side, base) / base2;
  Vec3 height = side - foot * base;
  height = height - (dot(height, base) / base2) * base;  // what rounding has left along the base
  const double height2 = norm2(height);
  const double of_third = height2 > 0 ? dot(x - t[0], height) / height2 : 0;
  const double of_second = dot(x - t[0], base) / base2 - of_third * foot;
  if (of_third >= 0 && of_second >= 0 && of_second + of_third <= 1)
    return t[0] + of_second * base + of_third * side;
  Vec3 nearest = t[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 p = nearest_point(std::array<Vec3, 2>{t[k], t[(k + 1) % 3]}, x);
    if (norm2(p - x) < norm2(nearest - x)) nearest = p;
  }
  return nearest;
}

}  // namespace

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5; written with differences only, so that equal
// coordinates stay equal.
Vec3 nearest_point(const std::array<Vec3, 3>& t, Vec3 x) {
  const Vec3 ab = t[1] - t[0];
  const Vec3 ac = t[2] - t[0];
  const Vec3 ax = x - t[0];
  const double d1 = dot(ab, ax);
  const double d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vec3 bx = x - t[1];
  const double d3 = dot(ab, bx);
  const double d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 - d3 > 0 ? t[0] + (d1 / (d1 - d3)) * ab : t[0];
  const Vec3 cx = x - t[2];
  const double d5 = dot(ab, cx);
  const double d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 - d6 > 0 ? t[0] + (d2 / (d2 - d6)) * ac : t[0];
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    return sum > 0 ? t[1] + ((d4 - d3) / sum) * (t[2] - t[1]) : t[1];
  }
  const double sum = va + vb + vc;
  return t[0] + (vb / sum) * ab + (vc / sum) * ac;
}

Vec3 nearest_point(const std::array<Vec3, 2>& s, Vec3 x) {
  const Vec3 along = s[1] - s[0];
  const double length2 = norm2(along);
  const double share = length2 > 0 ? dot(x - s[0], along) / length2 : 0.0;
  if (!(share > 0)) return s[0];
  return share < 1 ? s[0] + share * along : s[1];
}

Vec3 exact_nearest_point(const std::array<Vec3, 3>& t, Vec3 x) {
  const double longest2 = std::max({norm2(t[1] - t[0]), norm2(t[2] - t[1]), norm2(t[0] - t[2])});
  return norm(scaled_normal(t)) < kThin * longest2 ? nearest_point_of_thin(t, x) : nearest_point(t, x);
}

struct InputSurface::Impl {
  bool exact = false;
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<std::array<Vec3, 2>> segments;
  std::vector<Vec3> normals;
  std::vector<NearTriangle> near;  // the triangles, prepared for is_within()
  Tree tree;

  template <class Items>
  void plant(const Items& items) {
    std::vector<int> numbers(items.size());
    std::vector<Box> boxes(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      numbers[i] = static_cast<int>(i);
      for (Vec3 p : items[i]) boxes[i].extend(eigen(p));
    }
    tree.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  }

  double distance2(Vec3 x, std::size_t i) const { return norm2(nearest_of(i, x) - x); }
  Vec3 nearest_of(std::size_t i, Vec3 x) const {
    if (!segments.empty()) return nearest_point(segments[i], x);
    return exact ? exact_nearest_point(triangles[i], x) : nearest_point(triangles[i], x);
  }

  /// The state of one search: what is nearest so far, and how near it must be to count.
  struct Search {
    Vec3 x;
    const Vec3* side = nullptr;  // of the normals that count
    double limit2 = std::numeric_limits<double>::infinity();
    Hit hit{{}, std::numeric_limits<double>::infinity(), 0};  // distance is squared
  };

  void look(Search& search, std::size_t i) const {
    if (search.side && dot(normals[i], *search.side) < 0) return;
    const Vec3 p = nearest_of(i, search.x);
    const double d2 = norm2(p - search.x);
    if (d2 < search.hit.distance && d2 <= search.limit2) {
      search.hit = {p, d2, i};
      search.limit2 = d2;
    }
  }

  /// Down the tree, the nearer child first; what is further than the limit is left out, which shrinks to
  /// what has been found. Ends early once done() says so. (Eigen::BVMinimize keeps a queue on the heap and
  /// knows no limit: five times slower where the answer is near.)
  template <class Done>
  void descend(Search& search, Done&& done) const {
    struct Place {
      int index;
      double distance2;
    };
    constexpr std::size_t kDepth = 96;  // the tree halves its items at every level
    std::array<Place, kDepth> stack;
    std::size_t n = 0;
    const Eigen::Vector3d place = eigen(search.x);
    const auto push = [&](int index) {
      stack[n++] = {index, tree.getVolume(index).squaredExteriorDistance(place)};
    };
    const auto look_at = [&](int index) {
      Tree::VolumeIterator child = nullptr, last_child = nullptr;
      Tree::ObjectIterator item = nullptr, last_item = nullptr;
      tree.getChildren(index, child, last_child, item, last_item);
      for (; item != last_item; ++item) look(search, static_cast<std::size_t>(*item));
      const std::size_t first = n;
      for (; child != last_child; ++child) push(*child);
      if (n == first + 2 && stack[first].distance2 < stack[first + 1].distance2)
        std::swap(stack[first], stack[first + 1]);
    };
    look_at(tree.getRootIndex());
    while (n > 0 && !done()) {
      const Place at = stack[--n];
      if (at.distance2 <= search.limit2) look_at(at.index);
    }
  }

  static Hit result(Search& search) {
    search.hit.distance = std::sqrt(search.hit.distance);
    return search.hit;
  }
  Hit nearest(Vec3 x, const Vec3* side, double limit, std::span<const std::uint32_t> guesses) const {
    Search search{x, side, limit * limit};
    for (std::uint32_t i : guesses) look(search, i);
    descend(search, [] { return false; });
    return result(search);
  }
};

InputSurface::InputSurface(std::span<const std::array<Vec3, 3>> triangles, bool exact) : impl_(new Impl) {
  impl_->exact = exact;
  impl_->triangles.assign(triangles.begin(), triangles.end());
  for (const auto& t : triangles) {
    const Vec3 n = scaled_normal(t);
    const double length = norm(n);
    impl_->near.emplace_back(t);
    impl_->normals.push_back(length > 0 ? (1.0 / length) * n : Vec3{});
  }
  impl_->plant(impl_->triangles);
}

InputSurface::InputSurface(std::span<const std::array<Vec3, 2>> segments) : impl_(new Impl) {
  impl_->segments.assign(segments.begin(), segments.end());
  impl_->plant(impl_->segments);
}

InputSurface::~InputSurface() = default;
InputSurface::InputSurface(InputSurface&&) noexcept = default;
InputSurface& InputSurface::operator=(InputSurface&&) noexcept = default;

std::size_t InputSurface::size() const { return impl_->triangles.size() + impl_->segments.size(); }
Vec3 InputSurface::normal(std::size_t item) const { return impl_->normals[item]; }

InputSurface::Hit InputSurface::nearest(Vec3 x) const {
  return impl_->nearest(x, nullptr, std::numeric_limits<double>::infinity(), {});
}
InputSurface::Hit InputSurface::nearest(Vec3 x, std::size_t guess) const {
  const auto only = static_cast<std::uint32_t>(guess);
  return impl_->nearest(x, nullptr, std::numeric_limits<double>::infinity(), {&only, 1});
}
InputSurface::Hit InputSurface::nearest_within(Vec3 x, double limit) const {
  return impl_->nearest(x, nullptr, limit, {});
}
InputSurface::Hit InputSurface::nearest_within(Vec3 x, double limit, Vec3 side) const {
  return impl_->nearest(x, &side, limit, {});
}
InputSurface::Hit InputSurface::nearest_within(Vec3 x, double limit, Vec3 side,
                                               std::span<const std::uint32_t> guesses) const {
  return impl_->nearest(x, &side, limit, guesses);
}

bool InputSurface::is_within(Vec3 x, double limit, std::size_t item) const {
  return impl_->segments.empty() ? impl_->near[item].is_within(x, limit)
                                 : impl_->distance2(x, item) <= limit * limit;
}

std::optional<std::size_t> InputSurface::any_within(Vec3 x, double limit) const {
  const double limit2 = limit * limit;
  Impl::Search search{x, nullptr, limit2};
  const auto found = [&] { return search.hit.distance <= limit2; };
  impl_->descend(search, found);
  return found() ? std::optional(search.hit.item) : std::nullopt;
}

double InputSurface::distance(Vec3 x, std::size_t item) const { return std::sqrt(impl_->distance2(x, item)); }

}  // namespace hfr
