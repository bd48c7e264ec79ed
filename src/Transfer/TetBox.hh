// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_TET_BOX_HH
#define HFR_TRANSFER_TET_BOX_HH

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "Transfer/SharedVolume.hh"

namespace hfr {

/// A box round a tetrahedron, or several.
struct TetBox {
  Vec3 low, high;

  TetBox() = default;
  TetBox(Vec3 l, Vec3 h) : low(l), high(h) {}
  explicit TetBox(const TetPoints& t) : low(t[0]), high(t[0]) {
    for (const Vec3& p : t) add({p, p});
  }
  void add(const TetBox& o) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], o.low[k]);
      high[k] = std::max(high[k], o.high[k]);
    }
  }
  bool meets(const TetBox& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
           low.z <= o.high.z && o.low.z <= high.z;
  }
};

/// Which of some boxes meet another one: a tree of boxes round them.
class BoxTree {
 public:
  BoxTree() = default;
  /// `boxes` have to stay; `numbers`: of those that are looked among.
  BoxTree(std::span<const TetBox> boxes, std::vector<Index> numbers)
      : boxes_(boxes), numbers_(std::move(numbers)) {
    nodes_.reserve(4 * numbers_.size() / kLeaf + 1);
    if (!numbers_.empty()) build(0, numbers_.size());
  }
  /// visit(number) for those that meet the box, until it returns true; whether it did.
  template <class Visit>
  bool find_near(const TetBox& box, Visit&& visit) const {
    return !nodes_.empty() && find_below(0, box, visit);
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    TetBox box;
    std::size_t begin = 0, end = 0;
    std::size_t right = 0;  ///< its left one comes next; 0: there are none below
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t at = nodes_.size();
    Node node{boxes_[numbers_[begin]], begin, end, 0};
    for (std::size_t i = begin + 1; i < end; ++i) node.box.add(boxes_[numbers_[i]]);
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return at;
    int axis = 0;
    for (const int d : {1, 2})
      if (node.box.high[d] - node.box.low[d] > node.box.high[axis] - node.box.low[axis]) axis = d;
    const auto begin_at = [&](std::size_t i) { return numbers_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t middle = begin + (end - begin) / 2;
    const auto centre = [&](Index i) { return boxes_[i].low[axis] + boxes_[i].high[axis]; };
    std::nth_element(begin_at(begin), begin_at(middle), begin_at(end),
                     [&](Index a, Index b) { return centre(a) < centre(b); });
    build(begin, middle);
    nodes_[at].right = build(middle, end);
    return at;
  }
  template <class Visit>
  bool find_below(std::size_t at, const TetBox& box, Visit& visit) const {
    const Node& node = nodes_[at];
    if (!node.box.meets(box)) return false;
    if (node.right != 0) return find_below(at + 1, box, visit) || find_below(node.right, box, visit);
    for (std::size_t i = node.begin; i < node.end; ++i)
      if (boxes_[numbers_[i]].meets(box) && visit(numbers_[i])) return true;
    return false;
  }

  std::span<const TetBox> boxes_;
  std::vector<Index> numbers_;
  std::vector<Node> nodes_;
};

}  // namespace hfr

#endif
