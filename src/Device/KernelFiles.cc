// SPDX-License-Identifier: BSD-3-Clause
#include "Device/KernelFiles.hh"

#include <set>
#include <string_view>

#include "HalfFace/Errors.hh"

namespace hfr::detail {
namespace {

std::string_view text_of(std::string_view name) {
  for (const KernelFile& file : kernel_files())
    if (file.name == name) return {file.text, file.size};
  throw DeviceError("device code includes " + std::string(name) + ", which is not part of this build");
}

/// Appends a file with what it includes; a file that was appended before is left out.
void append(std::string_view name, std::set<std::string_view>& seen, std::string& out) {
  if (!seen.insert(name).second) return;
  const std::string_view text = text_of(name);
  const auto place = [&](int line) {
    out += "#line " + std::to_string(line) + " \"kernels/" + std::string(name) + "\"\n";
  };
  place(1);
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    constexpr std::string_view kInclude = "#include \"";
    if (line.starts_with(kInclude)) {
      append(line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size()), seen, out);
      place(number + 1);
    } else {
      out.append(line).push_back('\n');
    }
  }
}

}  // namespace

std::string kernel_source() {
  std::set<std::string_view> seen;
  std::string source;
  for (const KernelFile& file : kernel_files())
    if (std::string_view(file.name).ends_with(".cl")) append(file.name, seen, source);
  return source;
}

}  // namespace hfr::detail
