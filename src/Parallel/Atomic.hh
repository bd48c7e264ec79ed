// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_ATOMIC_HH
#define HFR_PARALLEL_ATOMIC_HH

#include <atomic>

namespace hfr::par {

#ifdef __cpp_lib_atomic_ref
template <class T>
using AtomicRef = std::atomic_ref<T>;
#else
/// What of std::atomic_ref the library uses, for standard libraries without it (libc++ before 19).
template <class T>
class AtomicRef {
 public:
  explicit AtomicRef(T& object) : object_(&object) {}
  T load(std::memory_order order = std::memory_order_seq_cst) const {
    T value;
    __atomic_load(object_, &value, static_cast<int>(order));
    return value;
  }
  void store(T value, std::memory_order order = std::memory_order_seq_cst) const {
    __atomic_store(object_, &value, static_cast<int>(order));
  }
  T fetch_add(T value, std::memory_order order = std::memory_order_seq_cst) const {
    return __atomic_fetch_add(object_, value, static_cast<int>(order));
  }
  T fetch_or(T value, std::memory_order order = std::memory_order_seq_cst) const {
    return __atomic_fetch_or(object_, value, static_cast<int>(order));
  }
  bool compare_exchange_strong(T& expected, T desired,
                               std::memory_order order = std::memory_order_seq_cst) const {
    return __atomic_compare_exchange(object_, &expected, &desired, false, static_cast<int>(order),
                                     static_cast<int>(on_failure(order)));
  }
  bool compare_exchange_weak(T& expected, T desired,
                             std::memory_order order = std::memory_order_seq_cst) const {
    return __atomic_compare_exchange(object_, &expected, &desired, true, static_cast<int>(order),
                                     static_cast<int>(on_failure(order)));
  }

 private:
  static constexpr std::memory_order on_failure(std::memory_order order) {
    return order == std::memory_order_acq_rel   ? std::memory_order_acquire
           : order == std::memory_order_release ? std::memory_order_relaxed
                                                : order;
  }
  T* object_;
};
#endif

/// An ordinary object as an atomic one, while several threads use it. The one place that knows how.
template <class T>
AtomicRef<T> atomic(T& object) {
  return AtomicRef<T>(object);
}

}  // namespace hfr::par

#endif
