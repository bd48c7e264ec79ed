// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_KERNEL_FILES_HH
#define HFR_DEVICE_KERNEL_FILES_HH

#include <cstddef>
#include <span>
#include <string>

namespace hfr::detail {

/// A file of the folder kernels/, embedded at build time by cmake/EmbedFiles.cmake.
struct KernelFile {
  const char* name;
  const char* text;
  std::size_t size;
};

std::span<const KernelFile> kernel_files();

/// All device code as one text that includes nothing, with #line directives that name the files.
std::string kernel_source();

}  // namespace hfr::detail

#endif
