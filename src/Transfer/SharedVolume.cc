// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/SharedVolume.hh"

#include <algorithm>
#include <cmath>

namespace hfr {
namespace {

/// A point by its coordinates in the tetrahedron that cuts.
using Corner = std::array<double, 4>;
using Piece = std::array<Corner, 4>;

/// The share of the way from p to q at which the plane u[k] = 0 is met; p and q lie on different sides.
double share(const Corner& p, const Corner& q, std::size_t k) { return p[k] / (p[k] - q[k]); }

Corner cut(const Corner& p, const Corner& q, std::size_t k) {
  const double t = share(p, q, k);
  Corner r;
  for (std::size_t i = 0; i < 4; ++i) r[i] = p[i] + t * (q[i] - p[i]);
  r[k] = 0;
  return r;
}

/// The corners of a piece on each side of a plane.
struct Sides {
  std::array<const Corner*, 4> inside{}, outside{};
  std::size_t n_in = 0;

  Sides(const Piece& piece, std::size_t k) {
    std::size_t n_out = 0;
    for (const Corner& c : piece) {
      if (c[k] >= 0)
        inside[n_in++] = &c;
      else
        outside[n_out++] = &c;
    }
  }
};

/// Six times the volume of a piece, in units of coordinates.
double volume_of(const Piece& p) {
  const auto edge = [&](std::size_t i) {
    return Vec3{p[i][1] - p[0][1], p[i][2] - p[0][2], p[i][3] - p[0][3]};
  };
  return std::abs(dot(edge(1), cross(edge(2), edge(3))));
}

/// Of the piece, what has u[k] >= 0, as a share of the whole.
double share_inside(const Piece& piece, std::size_t k) {
  const Sides s(piece, k);
  const auto t = [&](std::size_t i, std::size_t o) { return share(*s.inside[i], *s.outside[o], k); };
  if (s.n_in == 4) return 1;
  if (s.n_in == 1) return t(0, 0) * t(0, 1) * t(0, 2);
  if (s.n_in == 3) {
    const auto back = [&](std::size_t i) { return share(*s.outside[0], *s.inside[i], k); };
    return 1 - back(0) * back(1) * back(2);
  }
  if (s.n_in == 0) return 0;
  // A wedge from the edge of the two inner corners, in three pieces.
  const double a0 = t(0, 0), a1 = t(0, 1), b0 = t(1, 0), b1 = t(1, 1);
  return a0 * a1 * (1 - b1) + a0 * (1 - b0) * b1 + b0 * b1;
}

/// A triangular prism with the ends (a0, a1, a2) and (b0, b1, b2), in three pieces.
template <class Out>
void add_prism(const Corner& a0, const Corner& a1, const Corner& a2, const Corner& b0, const Corner& b1,
               const Corner& b2, Out&& out) {
  out({a0, a1, a2, b2});
  out({a0, a1, b1, b2});
  out({a0, b0, b1, b2});
}

/// Six times the volume of what of the piece lies inside, as far as planes k … 3 decide it.
double volume_inside(const Piece& piece, std::size_t k) {
  if (k == 3) {
    const double inside = share_inside(piece, 3);
    return inside == 0 ? 0 : inside * volume_of(piece);
  }
  const Sides s(piece, k);
  const auto at = [&](std::size_t i, std::size_t o) { return cut(*s.inside[i], *s.outside[o], k); };
  double sum = 0;
  const auto add = [&](const Piece& part) { sum += volume_inside(part, k + 1); };
  if (s.n_in == 4) return volume_inside(piece, k + 1);
  if (s.n_in == 1)
    add({*s.inside[0], at(0, 0), at(0, 1), at(0, 2)});
  else if (s.n_in == 2)
    add_prism(*s.inside[0], at(0, 0), at(0, 1), *s.inside[1], at(1, 0), at(1, 1), add);
  else if (s.n_in == 3)
    add_prism(*s.inside[0], *s.inside[1], *s.inside[2], at(0, 0), at(1, 0), at(2, 0), add);
  return sum;
}

bool is_outside_of_a_plane(const Piece& piece) {
  Corner most = piece[0];  // without a branch, since most answers come as a surprise
  for (std::size_t i = 1; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) most[k] = most[k] < piece[i][k] ? piece[i][k] : most[k];
  return static_cast<int>(most[0] <= 0) + static_cast<int>(most[1] <= 0) + static_cast<int>(most[2] <= 0) +
             static_cast<int>(most[3] <= 0) >
         0;
}

Piece in_coordinates(const TetPlanes& planes, const TetPoints& t) {
  return {planes.coordinates(t[0]), planes.coordinates(t[1]), planes.coordinates(t[2]),
          planes.coordinates(t[3])};
}

}  // namespace

TetPlanes::TetPlanes(const TetPoints& t) : origin_(t[0]) {
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  const double whole = dot(a, cross(b, c));
  const double sign = whole < 0 ? -1 : 1;
  normal_ = {sign * cross(b, c), sign * cross(c, a), sign * cross(a, b)};
  constexpr double kFlat = 1e-15;
  if (std::abs(whole) > kFlat * norm(a) * norm(b) * norm(c)) whole_ = std::abs(whole);
}

bool TetPlanes::is_apart_from(const TetPoints& other) const {
  return is_outside_of_a_plane(in_coordinates(*this, other));
}

Shared share(const TetPoints& a, const TetPlanes& b) {
  Shared shared;
  if (b.whole() == 0) {
    shared.reaches_beyond.fill(true);
    return shared;
  }
  const Piece piece = in_coordinates(b, a);
  for (std::size_t k = 0; k < 4; ++k)
    shared.reaches_beyond[k] =
        std::min(std::min(piece[0][k], piece[1][k]), std::min(piece[2][k], piece[3][k])) < 0;
  if (!is_outside_of_a_plane(piece)) shared.volume = volume_inside(piece, 0) / (6 * b.whole() * b.whole());
  return shared;
}

double shared_volume(const TetPoints& a, const TetPlanes& b) {
  if (b.whole() == 0) return 0;
  const Piece piece = in_coordinates(b, a);
  // Most pairs that are asked about do not meet: they share a face, or all of `a` lies beyond one.
  if (is_outside_of_a_plane(piece)) return 0;
  return volume_inside(piece, 0) / (6 * b.whole() * b.whole());
}

}  // namespace hfr
