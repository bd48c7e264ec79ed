// SPDX-License-Identifier: BSD-3-Clause
// main() in place of libFuzzer's, for every compiler: runs each file that is named, and each in a folder that
// is. Exit code 1 where there are none; a broken promise aborts.
// Usage: inputs_NAME [--format=EXTENSION] FILE_OR_FOLDER ...
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "LibFuzzer/Target.hh"

namespace {

void add(const std::filesystem::path& path, std::vector<std::filesystem::path>& files) {
  if (!std::filesystem::is_directory(path)) return files.push_back(path);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
}

}  // namespace

int main(int argc, char** argv) {
  LLVMFuzzerInitialize(&argc, &argv);
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i)
    if (const std::string name = argv[i]; !name.starts_with("--")) add(name, files);
  std::sort(files.begin(), files.end());
  for (const auto& path : files) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file) {
      fmt::print(stderr, "{}: cannot be read\n", path.string());
      return 1;
    }
    fmt::print("{}\n", path.string());
    std::fflush(stdout);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  fmt::print("{} inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
