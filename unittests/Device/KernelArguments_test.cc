// SPDX-License-Identifier: BSD-3-Clause
#include "Device/KernelArguments.hh"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <concepts>
#include <regex>
#include <string>
#include <vector>

#include "Device/Discovery.hh"
#include "Device/KernelFiles.hh"

namespace hfr::detail {
namespace {

using Names = std::vector<std::string>;

template <class Kernel>
Names names_of() {
  return {Kernel::kArguments.begin(), Kernel::kArguments.end()};
}

// A kernel's plain argument takes a value of its own type and nothing else, and cannot be left out.
static_assert(std::convertible_to<cl_uint, KernelValue<cl_uint>>);
static_assert(!std::convertible_to<cl_ulong, KernelValue<cl_uint>>);
static_assert(!std::convertible_to<int, KernelValue<cl_uint>>);
static_assert(!std::default_initializable<KernelValue<cl_uint>>);
// Arrays are those of the kernel, const where it does not write; sum_parts reads `values` and writes `sums`.
template <class Values, class Sums>
concept SumsParts = requires(Values& values, Sums& sums) {
  kernel::sum_parts::Arrays{values, sums};
};
static_assert(SumsParts<const DeviceArray<cl_uint>, DeviceArray<cl_uint>>);
static_assert(!SumsParts<DeviceArray<cl_uint>, const DeviceArray<cl_uint>>);
static_assert(!SumsParts<DeviceArray<cl_ulong>, DeviceArray<cl_uint>>);

TEST(KernelArguments, AreKnownOfEveryKernelInTheFiles) {
  Names wanted, known;
  for (const KernelFile& file : kernel_files()) {
    const std::string text(file.text, file.size);
    for (const char* pattern : {"\nKERNEL void ([a-z_]+)\\(", "\n[A-Z_]+_KERNEL\\(([a-z_]+),"}) {
      const std::regex kernels(pattern);
      for (std::sregex_iterator at(text.begin(), text.end(), kernels), end; at != end; ++at)
        wanted.push_back((*at)[1]);
    }
  }
  kernel::All::for_each([&]<class Kernel>() { known.emplace_back(Kernel::kName); });
  std::sort(wanted.begin(), wanted.end());
  EXPECT_EQ(known, wanted);
  EXPECT_GT(known.size(), 40U);
}

TEST(KernelArguments, StandInTheKernelsOrder) {
  EXPECT_EQ(names_of<kernel::rank_count>(), (Names{"keys", "counters", "capacity", "shift", "bins"}));
  EXPECT_EQ(names_of<kernel::commit_mates>(),
            (Names{"counters", "n",          "order",   "offsets", "sizes",   "arena",         "won",
                   "extra_at", "free_cells", "n_free",  "n_cells", "claim",   "moved",         "points",
                   "clock",    "cells",      "quality", "pending", "changed", "incident_cells"}));
}

TEST(KernelArguments, OfKernelsThatMacrosMakeAreKnown) {
  EXPECT_EQ(
      names_of<kernel::search_faces>(),
      (Names{"cells", "points", "quality", "listed", "cell_list", "origin", "regions", "has_regions", "salt",
             "counters", "capacity", "arena_capacity", "keys", "seeds", "offsets", "sizes", "arena"}));
  EXPECT_EQ(names_of<kernel::smooth_small_stars>(), names_of<kernel::smooth_all_stars>());
  EXPECT_EQ(names_of<kernel::smooth_all_stars>().size(), 17U);
}

/// PoCL's headers redefine the names of built-in functions, so that `step` becomes `_cl_step`.
std::string without_prefix(const std::string& name) {
  return name.starts_with("_cl_") ? name.substr(4) : name;
}

TEST(KernelArguments, AreThoseThatACompilerOfOpenClFinds) {
  cl::Device device;
  try {
    const DeviceInfo wanted = find_device({DeviceChoice::Kind::kOpenCl});
    for (auto& [info, found] : discover())
      if (info.id() == wanted.id()) device = found;
  } catch (const DeviceError& error) {
    GTEST_SKIP() << error.what();
  }
  void* loader = dlopen("libOpenCL.so.1", RTLD_NOW);
  const auto info = reinterpret_cast<decltype(&::clGetKernelArgInfo)>(
      loader != nullptr ? dlsym(loader, "clGetKernelArgInfo") : nullptr);
  if (info == nullptr) GTEST_SKIP() << "the loader cannot tell";
  const cl::Context context(device);
  Names found;
  std::size_t n_arguments = 0;
  for (const char* local : {"1", "64"}) {
    cl::Program program(context, kernel_source());
    program.build(device, (std::string("-cl-kernel-arg-info -DHFR_LOCAL=") + local).c_str());
    kernel::All::for_each([&]<class Kernel>() {
      cl::Kernel kernel;
      try {
        kernel = cl::Kernel(program, Kernel::kName);
      } catch (const cl::Error&) {
        return;  // for groups of another size
      }
      found.emplace_back(Kernel::kName);
      Names names;
      std::string name(100, '\0');
      for (std::size_t size = 0; info(kernel(), static_cast<cl_uint>(names.size()), CL_KERNEL_ARG_NAME,
                                      name.size(), name.data(), &size) == CL_SUCCESS;)
        names.push_back(without_prefix(name.substr(0, size - 1)));
      EXPECT_EQ(names_of<Kernel>(), names) << Kernel::kName;
      n_arguments += names.size();
    });
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  EXPECT_EQ(found.size(), kernel::All::kSize);
  EXPECT_GT(n_arguments, 300U);
}

}  // namespace
}  // namespace hfr::detail
