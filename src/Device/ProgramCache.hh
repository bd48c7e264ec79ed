// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_PROGRAM_CACHE_HH
#define HFR_DEVICE_PROGRAM_CACHE_HH

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Compiled programs on disk, internal to this folder.
namespace hfr::detail {

/// Makes the folder where it is missing; true when a file can be made in it.
bool is_writable_folder(const std::filesystem::path& folder);

/// Makes the folder, for this user alone, where it is missing. True when nobody else can put anything into
/// it: it is a folder and no link, belongs to the user, and others may not write to it; in a folder that
/// others may write to, such as /tmp, only its owner may rename it.
bool is_private_folder(const std::filesystem::path& folder);

/// Where compiled kernels, which the driver runs as they are, are kept: $HFR_CACHE_DIR, which is trusted, or
/// $XDG_CACHE_HOME/hfremesh, ~/.cache/hfremesh or a folder of the user's below the temporary one if it is
/// private: the first that can be written; empty when none can.
std::filesystem::path cache_folder();

/// What was stored under the key, or nothing. `key` may be any text: it is stored too, and compared in full,
/// so that two keys of one hash are told apart.
std::optional<std::vector<unsigned char>> load_binary(const std::string& key);
/// Stores it for the next run. A failure to do so is no error: the next run compiles again.
void save_binary(const std::string& key, const std::vector<unsigned char>& binary);

}  // namespace hfr::detail

#endif
