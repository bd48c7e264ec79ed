// SPDX-License-Identifier: BSD-3-Clause
// The shape that must be kept: distances from the input and of it, normals, volumes.
#include <limits>
#include <numbers>

#include "Surface/SurfaceMeshImpl.hh"

namespace hfr {
namespace {

using namespace surface;  // what SurfaceMesh is made of

constexpr double kDegree = std::numbers::pi / 180.0;
/// Share of the distance allowed by which samples are judged, for the sake of what lies between them.
constexpr double kBetween = 0.7;
/// Share of the distance allowed by which the further points between samples are judged, which are nearer to
/// one another.
constexpr double kCloseBetween = 0.85;
/// A length below this share of a distance is smaller whatever rounding did.
constexpr double kSurely = 1 - 1e-9;
/// Cosine of the largest angle that the normal of a triangle as small as noise may have with the input's.
constexpr double kNotBack = 0.1;
/// Share by which the whole volume may have changed before a change in the same direction is refused.
constexpr double kVolume = 5e-4;
/// The same share for the volume of one region; no single change may be larger, either.
constexpr double kRegionVolume = 9e-4;
/// Regions whose volume one change may touch; one that would touch more is refused.
constexpr std::size_t kMostRegions = 16;

bool have_area(std::span<const Triangle> triangles) {
  return std::none_of(triangles.begin(), triangles.end(),
                      [](const Triangle& t) { return unit(scaled_normal(t)) == Vec3{}; });
}

/// True when each created triangle looks about the same way as some removed one.
bool look_the_same_way(std::span<const Triangle> created, std::span<const Triangle> removed) {
  constexpr double kSameSide = 0.5;
  return std::all_of(created.begin(), created.end(), [&](const Triangle& t) {
    const Vec3 n = unit(scaled_normal(t));
    return std::any_of(removed.begin(), removed.end(),
                       [&](const Triangle& d) { return dot(n, unit(scaled_normal(d))) > kSameSide; });
  });
}

/// The square of the distance from the nearest of the triangles.
double distance2_of(Vec3 x, std::span<const Triangle> triangles) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles) least = std::min(least, norm2(nearest_point(t, x) - x));
  return least;
}

}  // namespace

Vec3 SurfaceMesh::project(VertexHandle v, Vec3 x) const {
  const MotionConstraint& f = motion_constraint(v);
  const bool on_curve = f.kind == SurfaceKind::kCurve;
  if (f.kind == SurfaceKind::kInside) return x;
  if (f.kind == SurfaceKind::kFixed) return f.anchor;
  if (!impl_->flat()) return on_curve ? impl_->curves->nearest(x).point : x;
  const Vec3 r = x - f.anchor;
  return on_curve ? f.anchor + dot(r, f.axis) * f.axis : x - dot(r, f.axis) * f.axis;
}

/// Are points spread over the new triangles no further than `distance` from the input? What the new triangles
/// have in common with the old ones has been looked at before.
bool SurfaceMesh::Impl::are_near(std::span<const Triangle> created, std::span<const Triangle> removed,
                                 Guesses& beneath, double distance) const {
  Guesses found;  // beneath these triangles, too
  const auto is_near = [&](Vec3 x) {
    for (std::size_t i = 0; i < beneath.size(); ++i) {
      if (!shape->is_within(x, distance, beneath[i])) continue;
      std::swap(beneath[i], beneath[i / 2]);  // the next point is likely to be there, too
      return true;
    }
    if (std::any_of(found.begin(), found.end(),
                    [&](std::uint32_t item) { return shape->is_within(x, distance, item); }))
      return true;
    const auto item = shape->any_within(x, distance);
    if (item && !found.full()) found.push_back(static_cast<std::uint32_t>(*item));
    return item.has_value();
  };
  const auto has_edge = [](const Triangle& t, Vec3 p, Vec3 q) {
    return (t[0] == p && t[1] == q) || (t[1] == p && t[2] == q) || (t[2] == p && t[0] == q);
  };
  const auto is_old = [&](Vec3 x) {
    return std::any_of(removed.begin(), removed.end(),
                       [&](const Triangle& d) { return d[0] == x || d[1] == x || d[2] == x; });
  };
  for (std::size_t i = 0; i < created.size(); ++i) {
    const Triangle& t = created[i];
    const int cuts = cuts_of(t);
    if (!surface::all_inner_points(t, cuts, is_near)) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = t[k];
      const Vec3 q = t[(k + 1) % 3];
      if (!is_old(p) && !is_near(p)) return false;
      const bool seen = std::any_of(created.begin(), created.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&](const Triangle& other) { return has_edge(other, q, p); }) ||
                        std::any_of(removed.begin(), removed.end(),
                                    [&](const Triangle& old) { return has_edge(old, p, q); });
      for (int j = 1; j < cuts && !seen; ++j)
        if (!is_near(p + (1.0 * j / cuts) * (q - p))) return false;
    }
  }
  return true;
}

/// Where the points of are_near() are far apart: are further points between them no further than `distance`
/// from the input? A piece whose corners are all so near to the same triangle of the input is so as a whole.
bool SurfaceMesh::Impl::are_near_between(std::span<const Triangle> created, Guesses& beneath,
                                         double distance) const {
  bool near = true;
  const auto item_near = [&](Vec3 x) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < beneath.size(); ++i) {
      if (!shape->is_within(x, distance, beneath[i])) continue;
      std::swap(beneath[i], beneath[i / 2]);  // the next point is likely to be there, too
      return beneath[i / 2];
    }
    const auto item = shape->any_within(x, distance);
    if (item && !beneath.full()) beneath.push_back(static_cast<std::uint32_t>(*item));
    return item;
  };
  const auto look = [&](const Triangle& piece, Vec3 middle) {
    if (!near) return true;
    const auto item = item_near(middle);
    near = item.has_value();
    return !near || std::all_of(piece.begin(), piece.end(),
                                [&](Vec3 x) { return shape->is_within(x, distance, *item); });
  };
  for (const Triangle& t : created)
    if (near && has_between(t)) surface::bisect(t, between, look);
  return near;
}

/// Are the normals of the new triangles near those of the input no further than `distance` beneath them? The
/// normals of triangles no larger than noise say little, but they must not turn back. What is worse already
/// must not get worse still: a surface that folds over has to be mended somehow.
bool SurfaceMesh::Impl::turn_little(std::span<const Triangle> created, std::span<const Triangle> removed,
                                    const Guesses& beneath, double distance) const {
  const auto turned = [&](const Triangle& t) {  // cosine of the angle with the input beneath
    const Vec3 n = unit(scaled_normal(t));
    const Vec3 middle = t[0] + (1.0 / 3) * (t[1] - t[0]) + (1.0 / 3) * (t[2] - t[0]);
    const InputSurface::Hit hit = shape->nearest_within(middle, distance, n, beneath);
    return hit.distance <= distance ? dot(n, shape->normal(hit.item)) : -1.0;
  };
  const double bound = std::cos(options.normal_angle * kDegree);
  double worst_removed = 2;  // not known yet
  for (const Triangle& t : created) {
    const bool small = surface::longest_edge2(t) < 4 * detail * detail;
    const double now = turned(t);
    if (now >= (small ? kNotBack : bound)) continue;
    if (worst_removed == 2)
      for (const Triangle& d : removed) worst_removed = std::min(worst_removed, turned(d));
    if (now < worst_removed) return false;
  }
  return true;
}

bool SurfaceMesh::keeps_shape(std::span<const std::array<VertexHandle, 3>> faces_removed,
                              std::span<const Triangle> removed, std::span<const Triangle> created) const {
  if (!have_area(created)) return false;
  if (impl_->flat()) return look_the_same_way(created, removed);
  if (!numbers_) return impl_->keeps_shape(faces_removed, removed, created);
  thread_local std::vector<std::array<VertexHandle, 3>>
      faces;  // of this thread, so that it is allocated once
  faces.clear();
  for (const auto& f : faces_removed) faces.push_back({inner(f[0]), inner(f[1]), inner(f[2])});
  return impl_->keeps_shape(faces, removed, created);
}

bool SurfaceMesh::Impl::keeps_shape(std::span<const std::array<VertexHandle, 3>> faces_removed,
                                    std::span<const Triangle> removed,
                                    std::span<const Triangle> created) const {
  if (!keeps_regions(faces_removed, removed, created)) return false;

  // What was beneath the old triangles is likely to be beneath the new ones.
  Guesses beneath;
  const double h = kBetween * hausdorff;
  std::size_t last = 0;                        // the created triangle that the sample before was near to
  thread_local std::vector<NearTriangle> now;  // of this thread, so that it is allocated once
  now.clear();
  for (const Triangle& t : created) now.emplace_back(t);
  const auto keep_their_distance = [&](const Samples& samples, std::size_t i, double distance,
                                       bool unless_as_far) {
    if (created.size() == faces_removed.size()) {
      // Each point of the face as it was told last, which a move that has not been told yet may have changed,
      // has one of the new triangle as near as the furthest that a corner goes.
      double step2 = 0;
      for (std::size_t k = 0; k < 3; ++k)
        step2 = std::max(step2, norm2(created[i][k] - point(faces_removed[i][k])));
      if (samples.reach + std::sqrt(step2) <= kSurely * distance) return true;
      last = i;
    }
    for (Vec3 s : samples.points) {
      const auto is_near = [&](const NearTriangle& t) { return t.is_within(s, distance); };
      if (is_near(now[last])) continue;
      const auto at = std::find_if(now.begin(), now.end(), is_near);
      if (at == now.end()) {
        // Moves that have not been told yet may have taken it out of these triangles.
        if (unless_as_far && kSurely * distance2_of(s, created) <= distance2_of(s, removed)) continue;
        return false;
      }
      last = static_cast<std::size_t>(at - now.begin());
    }
    return true;
  };
  for (std::size_t i = 0; i < faces_removed.size(); ++i) {
    const OmFace face = find(faces_removed[i]);
    if (!face.is_valid()) return false;
    const FaceRecord& of_face = record(face);
    if (!beneath.full() && std::find(beneath.begin(), beneath.end(), of_face.beneath) == beneath.end())
      beneath.push_back(of_face.beneath);
    if (!keep_their_distance(of_face.samples[0], i, h, /*unless_as_far=*/false)) return false;
  }
  if (!are_near(created, removed, beneath, h) || !turn_little(created, removed, beneath, 2 * h)) return false;
  const double close = kCloseBetween * hausdorff;
  for (std::size_t i = 0; i < faces_removed.size() && samples_between; ++i)
    if (!keep_their_distance(record(find(faces_removed[i])).samples[1], i, close,
                             /*unless_as_far=*/true))
      return false;
  return are_near_between(created, beneath, close);
}

bool SurfaceMesh::Impl::is_too_much(const Region& region, double six_more, double share) {
  const double enough = share * std::abs(region.six_volume);
  return std::abs(region.six_gain) > enough && region.six_gain * six_more > 0 &&
         std::abs(six_more) > 1e-6 * enough;
}

/// Removed and created triangles correspond one to one where they bound different regions.
bool SurfaceMesh::Impl::keeps_regions(std::span<const std::array<VertexHandle, 3>> faces_removed,
                                      std::span<const Triangle> removed,
                                      std::span<const Triangle> created) const {
  if (is_open || removed.empty()) return true;
  if (regions.size() == 1) {
    double change = 0;
    for (const Triangle& t : created) change += surface::six_volume(t, removed[0][0]);
    for (const Triangle& t : removed) change -= surface::six_volume(t, removed[0][0]);
    return !is_too_much({six_volume, six_gain}, change, kVolume);
  }
  double outer = 0;
  struct Change {
    std::uint32_t region;
    double six_volume;
  };
  FixedVector<Change, kMostRegions> changes;
  bool fits = true;
  const auto note = [&](std::uint32_t region, double volume) {
    const auto at =
        std::find_if(changes.begin(), changes.end(), [&](const Change& c) { return c.region == region; });
    if (at != changes.end())
      at->six_volume += volume;
    else if (changes.full())
      fits = false;
    else
      changes.push_back({region, volume});
  };
  const auto add = [&](const Triangle& t, const std::array<VertexHandle, 3>& like, double sign) {
    const OmFace f = find(like);
    if (!f.is_valid()) return;
    const FaceRecord& of_f = record(f);
    const double volume = sign * surface::six_volume(t, removed[0][0]);
    note(of_f.sides[0], volume);
    if (of_f.interface)
      note(of_f.sides[1], -volume);
    else
      outer += volume;
  };
  for (std::size_t i = 0; i < removed.size(); ++i) add(removed[i], faces_removed[i], -1);
  for (std::size_t i = 0; i < created.size(); ++i)
    add(created[i], faces_removed[created.size() == removed.size() ? i : 0], 1);
  if (!fits || is_too_much({six_volume, six_gain}, outer, kVolume)) return false;
  for (const Change& change : changes) {
    // Of a small region a single change may be a large share.
    const Region& now = regions[change.region];
    const Region after{now.six_volume, now.six_gain + change.six_volume};
    if (is_too_much(now, change.six_volume, kVolume) || is_too_much(after, change.six_volume, kRegionVolume))
      return false;
  }
  return true;
}

double SurfaceMesh::volume_gain() const {
  return impl_->six_volume != 0 && !impl_->is_open ? impl_->six_gain / impl_->six_volume : 0.0;
}

double SurfaceMesh::outward() const {
  if (!(impl_->area > 0) || impl_->is_open) return 0;
  const double limit = 0.1 * impl_->hausdorff;
  return std::clamp(-impl_->six_gain / (6.0 * impl_->area), -limit, limit);
}

}  // namespace hfr
