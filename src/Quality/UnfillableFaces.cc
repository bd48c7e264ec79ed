// SPDX-License-Identifier: BSD-3-Clause
// Positive cells inside of a closed surface cover each point as often as the surface winds round it. So where
// a point just inside of a face has winding number w, and s faces lie there that look the same way, each of
// which has its own cell behind it, w < s leaves no mesh with positive cells only.
#include "Quality/UnfillableFaces.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "Quality/Metrics.hh"

namespace hfr {
namespace {

struct Point2 {
  double x, y;
};

/// Sign of the turn a→b→c; 0 where rounding hides it.
int turn_sign(Point2 a, Point2 b, Point2 c) {
  constexpr double kBound = 1e-15;
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  const double bound = kBound * (std::abs(left) + std::abs(right));
  return det > bound ? 1 : det < -bound ? -1 : 0;
}

struct Face {
  std::array<Vec3, 3> p;  // counter-clockwise seen from inside
  Vec3 normal;            // inwards
};

/// The boundary, looked at along one axis; faces sorted into a grid across it.
class Shadow {
 public:
  Shadow(const std::vector<Face>& faces, int axis) : axis_(axis) {
    if (faces.empty()) return;
    low_ = high_ = flat(faces[0].p[0]);
    for (const Face& f : faces)
      for (Vec3 p : f.p) {
        const Point2 q = flat(p);
        low_ = {std::min(low_.x, q.x), std::min(low_.y, q.y)};
        high_ = {std::max(high_.x, q.x), std::max(high_.y, q.y)};
      }
    constexpr double kMost = 1024;
    n_ = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(faces.size())), 1.0, kMost));
    begin_.assign(n_ * n_ + 1, 0);
    for (const Face& f : faces) visit(f, [&](std::size_t i) { ++begin_[i + 1]; });
    for (std::size_t i = 0; i < n_ * n_; ++i) begin_[i + 1] += begin_[i];
    entries_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t k = 0; k < faces.size(); ++k)
      visit(faces[k], [&](std::size_t i) { entries_[next[i]++] = static_cast<Index>(k); });
  }

  Point2 flat(Vec3 p) const { return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]}; }

  /// The faces that may lie over or under q.
  std::span<const Index> at(Point2 q) const {
    const std::size_t i = n_ * row(q.y, low_.y, high_.y) + row(q.x, low_.x, high_.x);
    return std::span(entries_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  std::size_t row(double x, double low, double high) const {
    const double share = high > low ? (x - low) / (high - low) : 0.0;
    return std::min(n_ - 1, static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(n_)));
  }
  template <class Visit>
  void visit(const Face& f, Visit&& visit) const {
    const Point2 a = flat(f.p[0]), b = flat(f.p[1]), c = flat(f.p[2]);
    const std::size_t y0 = row(std::min({a.y, b.y, c.y}), low_.y, high_.y);
    const std::size_t y1 = row(std::max({a.y, b.y, c.y}), low_.y, high_.y);
    for (std::size_t y = y0; y <= y1; ++y) {
      const auto [least, most] = within_row({a, b, c}, y);
      const std::size_t x0 = row(least, low_.x, high_.x), x1 = row(most, low_.x, high_.x);
      for (std::size_t x = x0; x <= x1; ++x) visit(n_ * y + x);
    }
  }
  /// From where to where the triangle lies in one row of the grid, and a little more: a long one that leans
  /// has few squares of those that its box has.
  std::pair<double, double> within_row(const std::array<Point2, 3>& p, std::size_t y) const {
    constexpr double kMargin = 1e-9;  // of the whole
    const double height = high_.y - low_.y, width = high_.x - low_.x;
    const double bottom = low_.y + height * (static_cast<double>(y) / static_cast<double>(n_) - kMargin);
    const double top = low_.y + height * (static_cast<double>(y + 1) / static_cast<double>(n_) + kMargin);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const auto add = [&](double x) {
      least = std::min(least, x);
      most = std::max(most, x);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 s = p[i], e = p[(i + 1) % 3];
      if (bottom <= s.y && s.y <= top) add(s.x);
      for (const double level : {bottom, top})
        if ((s.y < level) != (e.y < level)) add(s.x + (level - s.y) / (e.y - s.y) * (e.x - s.x));
    }
    // Rounding may hide a row that is only touched: then the box counts.
    if (!(least <= most)) {
      least = std::min({p[0].x, p[1].x, p[2].x});
      most = std::max({p[0].x, p[1].x, p[2].x});
    }
    return {least - kMargin * width, most + kMargin * width};
  }

  int axis_;
  std::size_t n_ = 1;
  Point2 low_{0, 0}, high_{0, 0};
  std::vector<std::size_t> begin_;
  std::vector<Index> entries_;
};

class Prover {
 public:
  explicit Prover(const std::vector<Face>& faces)
      : faces_(faces), shadows_{Shadow(faces, 0), Shadow(faces, 1), Shadow(faces, 2)} {
    for (const Face& f : faces)
      for (Vec3 p : f.p)
        for (int d = 0; d < 3; ++d) scale_ = std::max(scale_, std::abs(p[d]));
  }

  bool proves(const Face& f) const {
    // Weights of the corners: the middle, and places near the corners and sides, none of them in line.
    static constexpr std::array<std::array<double, 3>, 16> kWeights = {{{0.34, 0.355, 0.305},
                                                                        {0.81, 0.11, 0.08},
                                                                        {0.07, 0.83, 0.10},
                                                                        {0.12, 0.09, 0.79},
                                                                        {0.47, 0.44, 0.09},
                                                                        {0.08, 0.46, 0.46},
                                                                        {0.45, 0.07, 0.48},
                                                                        {0.63, 0.26, 0.11},
                                                                        {0.10, 0.64, 0.26},
                                                                        {0.27, 0.12, 0.61},
                                                                        {0.61, 0.13, 0.26},
                                                                        {0.28, 0.60, 0.12},
                                                                        {0.13, 0.29, 0.58},
                                                                        {0.95, 0.03, 0.02},
                                                                        {0.02, 0.94, 0.04},
                                                                        {0.03, 0.02, 0.95}}};
    const Vec3 n = f.normal;
    int axis = 0;
    for (int d = 1; d < 3; ++d)
      if (std::abs(n[d]) > std::abs(n[axis])) axis = d;
    if (!(std::abs(n[axis]) > 0)) return false;
    return std::any_of(kWeights.begin(), kWeights.end(), [&](const std::array<double, 3>& w) {
      return proves_at(f, axis, w[0] * f.p[0] + w[1] * f.p[1] + w[2] * f.p[2]);
    });
  }

 private:
  static constexpr int kUnsure = 2;

  /// Whether a line along the axis through q goes through g: 0 for no, else the sign of g's normal along the
  /// axis, or kUnsure.
  static int crosses(const Shadow& shadow, const Face& g, Point2 q) {
    const Point2 a = shadow.flat(g.p[0]), b = shadow.flat(g.p[1]), c = shadow.flat(g.p[2]);
    const int ab = turn_sign(a, b, q), bc = turn_sign(b, c, q), ca = turn_sign(c, a, q);
    const int most = std::max({ab, bc, ca}), least = std::min({ab, bc, ca});
    if (most > 0 && least < 0) return 0;
    return most == least && most != 0 ? most : kUnsure;
  }

  /// Where the plane of g is over q, along the axis, and how far off that may be.
  std::array<double, 2> height(const Face& g, int axis, Point2 q) const {
    constexpr double kBound = 1e-14;
    const double up = g.normal[axis];
    const Vec3 a = g.p[0];
    const double spread = norm(g.p[1] - a) * norm(g.p[2] - a);
    const double x = q.x - a[(axis + 1) % 3], y = q.y - a[(axis + 2) % 3];
    const double fall = (g.normal[(axis + 1) % 3] * x + g.normal[(axis + 2) % 3] * y) / up;
    return {a[axis] - fall, kBound * (scale_ * spread + spread * (std::abs(x) + std::abs(y))) / std::abs(up)};
  }

  static bool in_one_plane(const Face& f, const Face& g) {
    return std::all_of(g.p.begin(), g.p.end(),
                       [&](Vec3 p) { return orientation(f.p[0], f.p[1], f.p[2], p) == 0; });
  }

  bool proves_at(const Face& f, int axis, Vec3 place) const {
    const Shadow& shadow = shadows_[static_cast<std::size_t>(axis)];
    const Point2 q = shadow.flat(place);
    const int up = crosses(shadow, f, q);
    if (up == 0 || up == kUnsure) return false;
    const auto [at, off] = height(f, axis, q);
    int winding = 0;  // just inside of f, and of what lies on it
    int n_alike = 0;  // faces there that look the way f does, f included
    for (Index k : shadow.at(q)) {
      const Face& g = faces_[k];
      const int crossing = crosses(shadow, g, q);
      if (crossing == 0) continue;
      if (crossing == kUnsure || !(std::abs(g.normal[axis]) > 0)) return false;
      const bool alike = crossing == up;
      const auto [there, may_be_off] = height(g, axis, q);
      const double above = up > 0 ? there - at : at - there;
      if (!(std::abs(above) > off + may_be_off)) {
        if (!in_one_plane(f, g)) return false;
        n_alike += alike ? 1 : 0;
      } else if (above > 0) {
        winding += alike ? -1 : 1;
      }
    }
    return winding < n_alike;
  }

  const std::vector<Face>& faces_;
  std::array<Shadow, 3> shadows_;
  double scale_ = 0;
};

Face face_of(const TetMesh& mesh, HalfFaceHandle h) {
  const auto v = mesh.halfface_vertices(h);
  Face f{{mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])}, {}};
  f.normal = cross(f.p[1] - f.p[0], f.p[2] - f.p[0]);
  return f;
}

}  // namespace

std::vector<HalfFaceHandle> unfillable_faces(const TetMesh& mesh, std::span<const HalfFaceHandle> faces,
                                             par::Policy policy) {
  std::vector<HalfFaceHandle> proven;
  if (faces.empty()) return proven;
  std::vector<Face> boundary;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) boundary.push_back(face_of(mesh, h));
  const Prover prover(boundary);
  std::vector<std::uint8_t> is_proven(faces.size());
  par::for_each(policy, faces.size(),
                [&](std::size_t i) { is_proven[i] = prover.proves(face_of(mesh, faces[i])) ? 1 : 0; });
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (is_proven[i]) proven.push_back(faces[i]);
  return proven;
}

std::vector<HalfFaceHandle> unfillable_faces(const TetMesh& mesh, std::span<const CellHandle> invalid,
                                             std::span<const HalfFaceHandle> folded, par::Policy policy) {
  std::vector<HalfFaceHandle> suspects(folded.begin(), folded.end());
  for (CellHandle c : invalid)
    for (int k = 0; k < 4; ++k)
      if (mesh.is_boundary(halfface_of(c, k))) suspects.push_back(halfface_of(c, k));
  std::sort(suspects.begin(), suspects.end());
  suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
  return unfillable_faces(mesh, suspects, policy);
}

}  // namespace hfr
