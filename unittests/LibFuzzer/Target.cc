// SPDX-License-Identifier: BSD-3-Clause
#include "LibFuzzer/Target.hh"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

namespace hfr::fuzz {
namespace {

class Folder {
 public:
  Folder() {
    const char* const wanted = std::getenv("TMPDIR");
    std::filesystem::path in = wanted ? wanted : "/dev/shm";
    std::error_code error;
    if (!std::filesystem::is_directory(in, error)) in = std::filesystem::temp_directory_path();
    std::string name = in / "hfr_libfuzzer.XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

const std::filesystem::path& scratch() {
  static const Folder folder;
  return folder.path();
}

void broken(const std::string& promise, const std::string& detail) {
  fmt::print(stderr, "broken: {}: {}\n", promise, detail);
  std::error_code ignored;
  std::filesystem::remove_all(scratch(), ignored);
  std::abort();
}

}  // namespace hfr::fuzz
