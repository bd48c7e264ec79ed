// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_LABEL_ORDER_HH
#define HFR_DISTRIBUTED_LABEL_ORDER_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr::mpi {

/// In what order the whole has its labelled faces, while a surface that changes takes labels away and gives
/// others, as the TupleMap of a mesh in shared memory would have them.
class LabelOrder {
 public:
  using Face = std::array<std::uint64_t, 3>;  ///< numbers of its vertices, in any order

  void assign(std::span<const Face> faces) {
    clear();
    for (const Face& f : faces) set(f);
  }
  void clear() { *this = {}; }
  std::size_t size() const { return faces_.size(); }
  /// size() where it has none.
  std::uint64_t number(const Face& face) const {
    const auto at = at_.find(key(face));
    return at == at_.end() ? faces_.size() : at->second;
  }
  void set(const Face& face) {
    if (at_.try_emplace(key(face), faces_.size()).second) faces_.push_back(key(face));
  }
  /// The last one takes its place.
  void erase(const Face& face) {
    const auto found = at_.find(key(face));
    if (found == at_.end()) return;
    const std::size_t gone = found->second;
    at_.erase(found);
    if (gone + 1 < faces_.size()) {
      faces_[gone] = faces_.back();
      at_[faces_[gone]] = gone;
    }
    faces_.pop_back();
  }

 private:
  struct Hash {
    std::size_t operator()(const Face& face) const {
      std::uint64_t h = 0;
      for (std::uint64_t v : face) h = mix64(h ^ v);
      return static_cast<std::size_t>(h);
    }
  };
  static Face key(Face face) {
    std::sort(face.begin(), face.end());
    return face;
  }

  std::vector<Face> faces_;
  std::unordered_map<Face, std::size_t, Hash> at_;
};

}  // namespace hfr::mpi

#endif
