// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/TetBox.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "HalfFace/Generate.hh"

namespace hfr::test {
namespace {

std::vector<TetBox> random_boxes(std::size_t n, double size, std::uint64_t seed) {
  std::vector<TetBox> boxes;
  for (std::size_t i = 0; i < n; ++i) {
    const auto random = [&](std::uint64_t k) { return generate::random_unit(seed, 8 * i + k); };
    const Vec3 low = {random(0), random(1), random(2)};
    const Vec3 extent = {std::abs(random(3)), std::abs(random(4)), std::abs(random(5))};
    boxes.emplace_back(low, low + size * extent);
  }
  return boxes;
}

std::vector<Index> found_near(const BoxTree& tree, const TetBox& box) {
  std::vector<Index> found;
  tree.find_near(box, [&](Index i) {
    found.push_back(i);
    return false;
  });
  std::ranges::sort(found);
  return found;
}

TEST(BoxTree, FindsThoseThatMeetABoxAndNoOthers) {
  for (const std::size_t n : {0U, 1U, 8U, 9U, 500U}) {
    const std::vector<TetBox> boxes = random_boxes(n, 0.3, n);
    std::vector<Index> numbers;
    for (std::size_t i = 0; i < n; i += i % 5 == 2 ? 2 : 1) numbers.push_back(static_cast<Index>(i));
    const BoxTree tree(boxes, numbers);
    for (const TetBox& box : random_boxes(100, 0.5, 77)) {
      std::vector<Index> expected;
      for (const Index i : numbers)
        if (boxes[i].meets(box)) expected.push_back(i);
      EXPECT_EQ(found_near(tree, box), expected);
      EXPECT_EQ(tree.find_near(box, [](Index) { return true; }), !expected.empty());
    }
  }
}

TEST(BoxTree, BoxesOfOnePlaceAreAllFound) {
  const std::vector<TetBox> boxes(100, TetBox({0, 0, 0}, {0, 0, 0}));
  std::vector<Index> numbers(100);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<Index>(i);
  const BoxTree tree(boxes, numbers);
  EXPECT_EQ(found_near(tree, {{0, 0, 0}, {1, 1, 1}}).size(), 100U) << "what touches meets";
  EXPECT_TRUE(found_near(tree, {{0.1, 0, 0}, {1, 1, 1}}).empty());
}

TEST(TetBox, LiesRoundAllCorners) {
  const TetBox box(TetPoints{Vec3{0, 2, 1}, Vec3{-1, 0, 3}, Vec3{4, 1, 1}, Vec3{0, 0, -2}});
  EXPECT_EQ(box.low, (Vec3{-1, 0, -2}));
  EXPECT_EQ(box.high, (Vec3{4, 2, 3}));
}

}  // namespace
}  // namespace hfr::test
