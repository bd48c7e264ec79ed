// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MovedVertices.hh"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hfr {
namespace {

// Where fewer vertices than 1 in so many have moved, their cells are gathered; else all are looked at.
constexpr std::size_t kManyMoved = 4;

constexpr double kNanosecondsAWord = 100;  // 64 vertices, about

struct Word {
  std::uint64_t moved = 0;  ///< a bit each
  bool is_finite = true;
};

/// Without branches but one, so that it costs little more than reading.
Word read(std::span<const Vec3> displacement) {
  constexpr std::uint64_t kExponent = 0x7FF0'0000'0000'0000, kOne = 0x0010'0000'0000'0000;
  std::uint64_t any = 0, carried = 0;
  for (const Vec3 d : displacement)
    for (const double coordinate : {d.x, d.y, d.z}) {
      const auto bits = std::bit_cast<std::uint64_t>(coordinate);
      any |= bits << 1;
      // An exponent of ones alone, which infinities and what is no number have, carries into the sign.
      carried |= (bits & kExponent) + kOne;
    }
  std::uint64_t moved = 0;
  if (any != 0)
    for (std::size_t i = 0; i < displacement.size(); ++i)
      moved |= static_cast<std::uint64_t>(!(displacement[i] == Vec3{})) << i;
  return {moved, carried >> 63 == 0};
}

bool is_finite(Vec3 d) { return std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z); }

}  // namespace

std::size_t MovedVertices::lowest_bit(std::uint64_t word) {
  return static_cast<std::size_t>(std::countr_zero(word));
}

void MovedVertices::clear() {
  std::fill(bits_.begin(), bits_.end(), 0U);
  parts_.clear();
  n_moved_ = 0;
  are_many_ = false;
  list_.clear();
}

std::size_t MovedVertices::find(std::span<const Vec3> displacement, par::Policy policy) {
  const std::size_t n = displacement.size(), n_words = (n + 63) / 64;
  const int n_parts = par::thread_count(policy.for_items_of(kNanosecondsAWord), n_words);
  clear();
  bits_.resize(n_words);
  parts_.assign(static_cast<std::size_t>(n_parts), {});
  par::parts(n_parts, [&](int part) {
    Part mine;
    const std::size_t end = par::part_begin(n_words, n_parts, part + 1);
    for (std::size_t w = par::part_begin(n_words, n_parts, part); w < end; ++w) {
      const Word word = read(displacement.subspan(64 * w, std::min<std::size_t>(64, n - 64 * w)));
      bits_[w] = word.moved;
      mine.n_moved += static_cast<std::size_t>(std::popcount(word.moved));
      mine.is_finite = mine.is_finite && word.is_finite;
    }
    parts_[static_cast<std::size_t>(part)] = mine;
  });
  bool all_finite = true;
  for (const Part& part : parts_) {
    n_moved_ += part.n_moved;
    all_finite = all_finite && part.is_finite;
  }
  are_many_ = n_moved_ * kManyMoved >= n;
  if (all_finite) return n;
  const auto first = std::find_if_not(displacement.begin(), displacement.end(), is_finite);
  return static_cast<std::size_t>(first - displacement.begin());
}

void MovedVertices::move(TetMesh& mesh, std::span<const Vec3> displacement, par::Policy policy) {
  if (are_many_) {
    was_.resize(mesh.n_vertices());
    par::for_each(policy, mesh.n_vertices(), [&](std::size_t i) {
      const VertexHandle v(i);
      was_[i] = mesh.point(v);
      if (has(v)) mesh.set_point(v, was_[i] + displacement[i]);
    });
    return;
  }
  list_.resize(n_moved_);
  was_.resize(n_moved_);
  const int n_parts = static_cast<int>(parts_.size());
  par::parts(n_parts, [&](int part) {
    std::size_t at = 0;
    for (int i = 0; i < part; ++i) at += parts_[static_cast<std::size_t>(i)].n_moved;
    const std::size_t end = par::part_begin(bits_.size(), n_parts, part + 1);
    for (std::size_t w = par::part_begin(bits_.size(), n_parts, part); w < end; ++w)
      for (std::uint64_t rest = bits_[w]; rest != 0; rest &= rest - 1) {
        const VertexHandle v(64 * w + lowest_bit(rest));
        list_[at] = v;
        was_[at] = mesh.point(v);
        mesh.set_point(v, was_[at] + displacement[v.idx()]);
        ++at;
      }
  });
}

/// place(v, where it was) for each.
template <class Place>
void MovedVertices::set_points(TetMesh& mesh, par::Policy policy, Place&& place) const {
  par::for_each(policy, was_.size(), [&](std::size_t i) {
    const VertexHandle v = are_many_ ? VertexHandle(i) : list_[i];
    if (has(v)) mesh.set_point(v, place(v, was_[i]));
  });
}

void MovedVertices::put(TetMesh& mesh, std::span<const Vec3> displacement, double fraction,
                        par::Policy policy) const {
  set_points(mesh, policy, [&](VertexHandle v, Vec3 was) { return was + fraction * displacement[v.idx()]; });
}

void MovedVertices::put_back(TetMesh& mesh, par::Policy policy) const {
  set_points(mesh, policy, [](VertexHandle, Vec3 was) { return was; });
}

}  // namespace hfr
