// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Handles.hh"

#include <gtest/gtest.h>

#include <concepts>
#include <tuple>
#include <type_traits>
#include <unordered_set>

namespace hfr {
namespace {

template <class A, class B>
concept Comparable = requires(A a, B b) {
  a == b;
}
|| requires(A a, B b) { a < b; };

/// A converts into no other kind, compares with none, and comes from an integer only when asked to.
template <class A, class... Others>
constexpr bool stands_alone() {
  return std::equality_comparable<A> && std::totally_ordered<A> && (!Comparable<A, Others> && ...) &&
         (!std::is_constructible_v<A, Others> && ...) && (!std::is_convertible_v<A, Others> && ...) &&
         !std::is_convertible_v<Index, A> && !std::is_convertible_v<A, Index> && !Comparable<A, Index> &&
         !Comparable<A, int> && std::is_trivially_copyable_v<A> && sizeof(A) == sizeof(Index);
}
static_assert(
    stands_alone<VertexHandle, CellHandle, HalfFaceHandle, FaceHandle, HalfEdgeHandle, EdgeHandle>());
static_assert(
    stands_alone<CellHandle, VertexHandle, HalfFaceHandle, FaceHandle, HalfEdgeHandle, EdgeHandle>());
static_assert(
    stands_alone<HalfFaceHandle, VertexHandle, CellHandle, FaceHandle, HalfEdgeHandle, EdgeHandle>());
static_assert(
    stands_alone<FaceHandle, VertexHandle, CellHandle, HalfFaceHandle, HalfEdgeHandle, EdgeHandle>());
static_assert(
    stands_alone<HalfEdgeHandle, VertexHandle, CellHandle, HalfFaceHandle, FaceHandle, EdgeHandle>());
static_assert(
    stands_alone<EdgeHandle, VertexHandle, CellHandle, HalfFaceHandle, FaceHandle, HalfEdgeHandle>());

TEST(Handle, DefaultIsInvalidAndLargerThanAny) {
  EXPECT_FALSE(CellHandle().is_valid());
  EXPECT_LT(CellHandle(0), CellHandle());
  CellHandle c(3);
  EXPECT_TRUE(c.is_valid());
  c.reset();
  EXPECT_EQ(c, CellHandle());
}

TEST(Handle, Hashes) {
  const std::unordered_set<EdgeHandle> set = {EdgeHandle(1), EdgeHandle(2), EdgeHandle(1)};
  EXPECT_EQ(set.size(), 2U);
}

bool is_even(std::array<std::uint8_t, 4> p) {
  int inversions = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) inversions += p[i] > p[j] ? 1 : 0;
  return inversions % 2 == 0;
}

TEST(CornerTables, RowsAreEvenPermutations) {
  for (std::uint8_t k = 0; k < 4; ++k) {
    const auto& f = kFaceCorners[k];
    EXPECT_TRUE(is_even({f[0], f[1], f[2], k}));
  }
  for (std::uint8_t e = 0; e < 6; ++e) {
    const auto& ab = kEdgeCorners[e];
    const auto& pq = kEdgeOpposite[e];
    EXPECT_TRUE(is_even({ab[0], ab[1], pq[0], pq[1]}));
    EXPECT_EQ(kEdgeOfCorners[ab[0]][ab[1]], e);
    EXPECT_EQ(kEdgeOfCorners[ab[1]][ab[0]], e);
  }
}

}  // namespace
}  // namespace hfr
