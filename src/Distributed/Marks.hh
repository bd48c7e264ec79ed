// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_MARKS_HH
#define HFR_DISTRIBUTED_MARKS_HH

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"

namespace hfr::mpi {

/// A byte for each of many things, of which few are other than 0, and are 0 again when that is over: whoever
/// looks at a small part of a mesh, and often, does not pay for all of it.
class Marks {
 public:
  /// So many things there are now.
  Marks& for_all_of(std::size_t n) {
    if (bytes_.size() < n) bytes_.resize(n, 0);
    return *this;
  }
  std::uint8_t operator[](Index i) const { return bytes_[i]; }
  /// `value`: not 0.
  void set(Index i, std::uint8_t value) {
    if (bytes_[i] == 0) set_.push_back(i);
    bytes_[i] = value;
  }
  /// False where it was set before.
  bool add(Index i) {
    if (bytes_[i] != 0) return false;
    set(i, 1);
    return true;
  }
  bool is_empty() const { return set_.empty(); }
  void clear() {
    for (Index i : set_) bytes_[i] = 0;
    set_.clear();
  }
  /// What is set, ascending; nothing is, from then on.
  template <class Handle>
  std::vector<Handle> take() {
    std::sort(set_.begin(), set_.end());
    std::vector<Handle> handles;
    handles.reserve(set_.size());
    for (Index i : set_) handles.push_back(Handle(i));
    clear();
    return handles;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<Index> set_;
};

}  // namespace hfr::mpi

#endif
