// SPDX-License-Identifier: BSD-3-Clause
// What every target of libFuzzer has: two functions that it calls, a folder for files, and a way to end.
#ifndef HFR_UNITTESTS_LIB_FUZZER_TARGET_HH
#define HFR_UNITTESTS_LIB_FUZZER_TARGET_HH

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

/// Reads the target's own arguments, which begin with "--"; libFuzzer passes over these.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
/// Runs one input. Returns 0, or -1 for one that is not worth keeping; ends the process where a promise is
/// broken.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace hfr::fuzz {

/// A folder of this process, in memory where there is one to be had; removed when the process ends.
const std::filesystem::path& scratch();

/// Says on standard error which promise was broken and how, then aborts, as libFuzzer wants it.
[[noreturn]] void broken(const std::string& promise, const std::string& detail);

}  // namespace hfr::fuzz

#endif
