// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/SharedVolume.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace hfr {
namespace {

/// The corners of a tetrahedron by how far they lie on the inner side of each of N planes.
template <std::size_t N>
using Piece = std::array<std::array<double, N>, 4>;

/// The corners of a piece on each side of its first plane.
struct Sides {
  std::array<std::size_t, 4> inside{}, outside{};
  std::size_t n_in = 0;

  template <std::size_t N>
  explicit Sides(const Piece<N>& piece) {
    std::size_t n_out = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (piece[i][0] >= 0)
        inside[n_in++] = i;
      else
        outside[n_out++] = i;
    }
  }
};

/// The share of a piece's volume that lies inside of all N planes. The first plane cuts it into at most three
/// pieces, whose shares are products of the shares of edges; the others cut these. No term is negative.
template <std::size_t N>
double share_inside(const Piece<N>& piece) {
  const Sides s(piece);
  if (s.n_in == 0) return 0;
  /// The share of the way from an inner corner to an outer one at which the plane is met.
  const auto way = [&](std::size_t i, std::size_t o) {
    const double p = piece[s.inside[i]][0], q = piece[s.outside[o]][0];
    return p / (p - q);
  };
  if constexpr (N == 1) {
    if (s.n_in == 4) return 1;
    if (s.n_in == 1) return way(0, 0) * way(0, 1) * way(0, 2);
    if (s.n_in == 3) return 1 - (1 - way(0, 0)) * (1 - way(1, 0)) * (1 - way(2, 0));
    const double a0 = way(0, 0), a1 = way(0, 1), b0 = way(1, 0), b1 = way(1, 1);
    return a0 * a1 * (1 - b1) + a0 * (1 - b0) * b1 + b0 * b1;
  } else {
    using Corner = std::array<double, N - 1>;  // what lies ahead
    const auto in = [&](std::size_t i) {
      Corner c;
      for (std::size_t k = 1; k < N; ++k) c[k - 1] = piece[s.inside[i]][k];
      return c;
    };
    const auto at = [&](std::size_t i, std::size_t o, double t) {
      const auto &p = piece[s.inside[i]], &q = piece[s.outside[o]];
      Corner c;
      for (std::size_t k = 1; k < N; ++k) c[k - 1] = p[k] + t * (q[k] - p[k]);
      return c;
    };
    const auto part = [](double share, const Piece<N - 1>& p) {
      return share == 0 ? 0 : share * share_inside<N - 1>(p);
    };
    if (s.n_in == 4) return share_inside<N - 1>({in(0), in(1), in(2), in(3)});
    if (s.n_in == 1) {
      const double t0 = way(0, 0), t1 = way(0, 1), t2 = way(0, 2);
      return part(t0 * t1 * t2, {in(0), at(0, 0, t0), at(0, 1, t1), at(0, 2, t2)});
    }
    if (s.n_in == 3) {  // a prism between the inner face and the plane
      const double t0 = way(0, 0), t1 = way(1, 0), t2 = way(2, 0);
      const Corner c1 = at(1, 0, t1), c2 = at(2, 0, t2), first = in(0);
      return part(t2, {first, in(1), in(2), c2}) + part(t1 * (1 - t2), {first, in(1), c1, c2}) +
             part(t0 * (1 - t1) * (1 - t2), {first, at(0, 0, t0), c1, c2});
    }
    // A prism between the two inner corners.
    const double a0 = way(0, 0), a1 = way(0, 1), b0 = way(1, 0), b1 = way(1, 1);
    const Corner first = in(0), c0 = at(0, 0, a0), d0 = at(1, 0, b0), d1 = at(1, 1, b1);
    return part(a0 * a1 * (1 - b1), {first, c0, at(0, 1, a1), d1}) +
           part(a0 * (1 - b0) * b1, {first, c0, d0, d1}) + part(b0 * b1, {first, in(1), d0, d1});
  }
}

bool is_outside_of_a_plane(const Piece<4>& piece) {
  std::array<double, 4> most = piece[0];  // without a branch, since most answers come as a surprise
  for (std::size_t i = 1; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) most[k] = most[k] < piece[i][k] ? piece[i][k] : most[k];
  return static_cast<int>(most[0] <= 0) + static_cast<int>(most[1] <= 0) + static_cast<int>(most[2] <= 0) +
             static_cast<int>(most[3] <= 0) >
         0;
}

Piece<4> in_coordinates(const TetPlanes& planes, const TetPoints& t) {
  return {planes.rounded_coordinates(t[0]), planes.rounded_coordinates(t[1]),
          planes.rounded_coordinates(t[2]), planes.rounded_coordinates(t[3])};
}

/// The planes of `all` that are chosen, in this order.
template <std::size_t N>
double share_inside_of(const Piece<4>& all, std::span<const std::size_t> chosen) {
  Piece<N> piece;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < N; ++k) piece[i][k] = all[i][chosen[k]];
  return share_inside(piece);
}

/// The share of a tetrahedron's volume on the inner side of all planes, none of which has it on its outer
/// side. Planes that do not cut it are left out; those that leave one corner come first, since what they
/// leave is small and one piece, and the last plane needs no pieces at all.
double share_inside_of_planes(const Piece<4>& all) {
  std::array<std::size_t, 4> chosen{};
  std::size_t n = 0;
  std::array<std::size_t, 4> n_in{};
  for (const auto& corner : all)
    for (std::size_t k = 0; k < 4; ++k) n_in[k] += corner[k] >= 0 ? 1 : 0;
  for (std::size_t count = 1; count < 4; ++count)
    for (std::size_t k = 0; k < 4; ++k)
      if (n_in[k] == count) chosen[n++] = k;
  switch (n) {
    case 0:
      return 1;
    case 1:
      return share_inside_of<1>(all, chosen);
    case 2:
      return share_inside_of<2>(all, chosen);
    case 3:
      return share_inside_of<3>(all, chosen);
    default:
      return share_inside_of<4>(all, chosen);
  }
}

}  // namespace

TetPlanes::TetPlanes(const TetPoints& t) : origin_(t[0]) {
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  const double whole = dot(a, cross(b, c));
  const double sign = whole < 0 ? -1 : 1;
  normal_ = {sign * cross(b, c), sign * cross(c, a), sign * cross(a, b)};
  const double na = norm(a), nb = norm(b), nc = norm(c);
  constexpr double kFlat = 1e-15;
  if (std::abs(whole) > kFlat * na * nb * nc) whole_ = std::abs(whole);
  // What two products of three terms each may be off by.
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  slack_ = {kRounding * nb * nc, kRounding * nc * na, kRounding * na * nb};
}

std::array<double, 4> TetPlanes::rounded_coordinates(Vec3 p) const {
  std::array<double, 4> u = coordinates(p);
  const Vec3 x = p - origin_;
  const double reach = std::abs(x.x) + std::abs(x.y) + std::abs(x.z);
  const std::array<double, 4> slack = {reach * (slack_[0] + slack_[1] + slack_[2]), reach * slack_[0],
                                       reach * slack_[1], reach * slack_[2]};
  for (std::size_t k = 0; k < 4; ++k) u[k] = std::abs(u[k]) <= slack[k] ? 0 : u[k];
  return u;
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
  const Piece<4> piece = in_coordinates(b, a);
  for (std::size_t k = 0; k < 4; ++k)
    shared.reaches_beyond[k] =
        std::min(std::min(piece[0][k], piece[1][k]), std::min(piece[2][k], piece[3][k])) < 0;
  if (!is_outside_of_a_plane(piece)) shared.volume = share_inside_of_planes(piece) * std::abs(volume6(a)) / 6;
  return shared;
}

double shared_volume(const TetPoints& a, const TetPlanes& b) { return share(a, b).volume; }

}  // namespace hfr
