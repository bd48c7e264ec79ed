// SPDX-License-Identifier: BSD-3-Clause
#include "LibFuzzer/Target.hh"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "ScratchFolder.hh"

namespace hfr::fuzz {
namespace {

/// In memory where there is such a folder: a target writes a file thousands of times a second.
std::filesystem::path folder_for_scratch() {
  const char* const wanted = std::getenv("TMPDIR");
  const std::filesystem::path in = wanted ? wanted : "/dev/shm";
  std::error_code error;
  return std::filesystem::is_directory(in, error) ? in : std::filesystem::temp_directory_path();
}

}  // namespace

const std::filesystem::path& scratch() {
  static const test::ScratchFolder folder(folder_for_scratch());
  return folder.path();
}

void broken(const std::string& promise, const std::string& detail) {
  fmt::print(stderr, "broken: {}: {}\n", promise, detail);
  std::error_code ignored;
  std::filesystem::remove_all(scratch(), ignored);
  std::abort();
}

}  // namespace hfr::fuzz
