// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_SCRATCH_FOLDER_HH
#define HFR_UNITTESTS_SCRATCH_FOLDER_HH

#include <stdlib.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace hfr::test {

/// A folder of its own in another one, removed with it: for processes that run at the same time, and end as
/// they like.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::filesystem::path& in = std::filesystem::temp_directory_path()) {
    std::string name = in / "hfremesh-test.XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace hfr::test

#endif
