// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_BYTE_SINK_HH
#define HFR_IO_BYTE_SINK_HH

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hfr::io {

/// Text, numbers and bytes, gathered to blocks of a megabyte on their way to where put() takes them.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;

  ByteSink& text(std::string_view text);  ///< as it is; also for raw bytes
  ByteSink& number(double value);         ///< shortest text that reads back to the same bits
  ByteSink& number(std::int64_t value);
  template <class T>
  ByteSink& raw(const T& value) {
    return text({reinterpret_cast<const char*>(&value), sizeof value});
  }
  /// Of a file that several processes write: what follows stands behind all that any of them has put so far,
  /// in the order of the processes. All call it equally often.
  virtual void next_stretch() {}

 protected:
  ByteSink();
  void flush();
  virtual void put(std::string_view bytes) = 0;

 private:
  std::string buffer_;
};

}  // namespace hfr::io

#endif
