// SPDX-License-Identifier: BSD-3-Clause
#include "Memory.hh"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "ExitCode.hh"

namespace hfr::app {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// The first number of a file; unknown when it has none, such as "max".
double number_in(const char* file) {
  std::ifstream in(file);
  double number = 0;
  return in >> number ? number : kUnknown;
}

/// The number behind a word in a file; unknown when it is not there.
double number_after(const char* file, std::string_view wanted) {
  std::ifstream in(file);
  for (std::string word; in >> word;) {
    double number = 0;
    if (word == wanted && in >> number) return number;
  }
  return kUnknown;
}

/// What Linux could give without swapping.
double free_memory() {
  constexpr double kKibibyte = 1024;
  return kKibibyte * number_after("/proc/meminfo", "MemAvailable:");
}

double left_in_container() {
  const double limit = number_in("/sys/fs/cgroup/memory.max");
  double used = number_in("/sys/fs/cgroup/memory.current");
  // Files that were read count as used, and give way.
  const double files = number_after("/sys/fs/cgroup/memory.stat", "inactive_file");
  if (files < kUnknown) used -= files;
  return limit < kUnknown && used < kUnknown ? std::clamp(limit - used, 0.0, limit) : kUnknown;
}

double left_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  const double used = number_in("/proc/self/statm") * static_cast<double>(sysconf(_SC_PAGESIZE));
  return used < kUnknown ? std::max(0.0, static_cast<double>(limit.rlim_cur) - used) : kUnknown;
}

}  // namespace

double available_memory() { return std::min({free_memory(), left_in_container(), left_of_address_space()}); }

void require_memory(double bytes, const std::string& what) {
  constexpr double kGibibyte = 1 << 30;
  const double there = available_memory();
  if (bytes <= there) return;
  throw Failure(ExitCode::kLimit,
                fmt::format("not enough memory: {} needs about {:.2g} GiB, and {:.2g} are free", what,
                            bytes / kGibibyte, there / kGibibyte));
}

}  // namespace hfr::app
