// SPDX-License-Identifier: BSD-3-Clause
#include "Device/KernelFiles.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>

namespace hfr::detail {
namespace {

TEST(KernelFiles, SourceIncludesNothingAndHasEachFileOnce) {
  const std::string source = kernel_source();
  EXPECT_EQ(source.find("#include \""), std::string::npos);
  std::size_t n_code_files = 0;
  for (const KernelFile& file : kernel_files()) {
    const std::string place = "#line 1 \"kernels/" + std::string(file.name) + "\"";
    const std::size_t first = source.find(place);
    if (std::string_view(file.name).ends_with(".cl")) {
      ++n_code_files;
      ASSERT_NE(first, std::string::npos) << file.name;
    }
    if (first == std::string::npos) continue;
    EXPECT_EQ(source.find(place, first + 1), std::string::npos) << file.name;
  }
  EXPECT_GE(n_code_files, 6U);
}

TEST(KernelFiles, LinesKeepTheNumberThatTheyHaveInTheirFile) {
  constexpr std::string_view kMark = "#define SMOOTH_KERNEL(";
  const std::string source = kernel_source();
  ASSERT_NE(source.find(kMark), std::string::npos);
  for (const KernelFile& file : kernel_files()) {
    if (std::string_view(file.name) != "smooth.cl") continue;
    // The last piece of a file begins after its last include.
    const std::size_t at = source.rfind("#line ", source.find(kMark));
    const std::size_t end = source.find('\n', at);
    const int line = std::stoi(source.substr(at + 6));
    const std::string_view text(file.text, file.size);
    const auto in_file =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(kMark)), '\n') + 1;
    const auto after = std::count(source.begin() + static_cast<std::ptrdiff_t>(end),
                                  source.begin() + static_cast<std::ptrdiff_t>(source.find(kMark)), '\n');
    EXPECT_EQ(line + after - 1, in_file);
    return;
  }
  FAIL() << "there is no smooth.cl";
}

}  // namespace
}  // namespace hfr::detail
