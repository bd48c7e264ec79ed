// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_DISTRIBUTED_SHARED_FOLDER_HH
#define HFR_UNITTESTS_DISTRIBUTED_SHARED_FOLDER_HH

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>

#include "Distributed/Comm.hh"
#include "ScratchFolder.hh"

namespace hfr::test {

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder that all ranks know; it goes with the object of rank 0.
class SharedFolder {
 public:
  explicit SharedFolder(mpi::Comm& comm) : comm_(comm) {
    std::string name;
    if (comm.rank() == 0) name = mine_.emplace().path().string();
    const auto all = comm.all_gather(std::span<const char>(name.data(), name.size()));
    path_ = std::string(all.begin(), all.end());
  }
  ~SharedFolder() { comm_.sum(0); }  // others still look at it
  const std::filesystem::path& path() const { return path_; }

 private:
  mpi::Comm& comm_;
  std::optional<ScratchFolder> mine_;
  std::filesystem::path path_;
};

}  // namespace hfr::test

#endif
