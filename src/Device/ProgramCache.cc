// SPDX-License-Identifier: BSD-3-Clause
#include "Device/ProgramCache.hh"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace hfr::detail {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMagic = 0x31424c4352464800ULL;  // file format 1

template <class Bytes>
std::uint64_t fnv1a(const Bytes& bytes) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const auto c : bytes) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return h;
}

fs::path file_of(const std::string& key) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return {};
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string name;
  for (std::uint64_t h = fnv1a(key), i = 0; i < 16; ++i, h <<= 4) name += kDigits[h >> 60];
  return folder / (name + ".bin");
}

}  // namespace

bool is_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::string name = (folder / "try-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) return false;
  close(file);
  fs::remove(name, error);
  return true;
}

bool is_private_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  mkdir(folder.c_str(), S_IRWXU);  // where it is there already, what follows says whose it is
  struct stat above {
  }, info{};
  if (stat(folder.parent_path().c_str(), &above) != 0 || lstat(folder.c_str(), &info) != 0) return false;
  constexpr mode_t kOthersWrite = S_IWGRP | S_IWOTH;
  const bool may_be_moved = (above.st_mode & kOthersWrite) != 0 && (above.st_mode & S_ISVTX) == 0;
  const bool above_is_safe = !may_be_moved && (above.st_uid == geteuid() || above.st_uid == 0);
  return above_is_safe && S_ISDIR(info.st_mode) && info.st_uid == geteuid() &&
         (info.st_mode & kOthersWrite) == 0;
}

fs::path cache_folder() {
  const auto value_of = [](const char* variable) {
    const char* value = std::getenv(variable);
    return fs::path(value ? value : "");
  };
  const fs::path named = value_of("HFR_CACHE_DIR");
  if (!named.empty() && is_writable_folder(named)) return named;
  std::vector<fs::path> places;
  if (const fs::path cache = value_of("XDG_CACHE_HOME"); !cache.empty()) places.push_back(cache / "hfremesh");
  if (const fs::path home = value_of("HOME"); !home.empty()) places.push_back(home / ".cache/hfremesh");
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (!error) places.push_back(temporary / ("hfremesh-" + std::to_string(geteuid())));
  for (const fs::path& place : places)
    if (is_private_folder(place) && is_writable_folder(place)) return place;
  return {};
}

std::optional<std::vector<unsigned char>> load_binary(const std::string& key) {
  std::ifstream in(file_of(key), std::ios::binary);
  std::uint64_t head[4] = {0, 0, 0, 0};  // magic, size of the key, size and hash of the binary
  if (!in.read(reinterpret_cast<char*>(head), sizeof head) || head[0] != kMagic || head[1] != key.size())
    return std::nullopt;
  std::string stored(key.size(), '\0');
  if (!in.read(stored.data(), static_cast<std::streamsize>(stored.size())) || stored != key)
    return std::nullopt;
  std::vector<unsigned char> binary{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  // Drivers may end the program over a binary that is damaged.
  if (binary.size() != head[2] || fnv1a(binary) != head[3]) return std::nullopt;
  return binary;
}

void save_binary(const std::string& key, const std::vector<unsigned char>& binary) {
  const fs::path file = file_of(key);
  if (file.empty()) return;
  const fs::path temporary = file.string() + "." + std::to_string(getpid());
  std::error_code error;
  {
    std::ofstream out(temporary, std::ios::binary);
    const std::uint64_t head[4] = {kMagic, key.size(), binary.size(), fnv1a(binary)};
    out.write(reinterpret_cast<const char*>(head), sizeof head);
    out.write(key.data(), static_cast<std::streamsize>(key.size()));
    out.write(reinterpret_cast<const char*>(binary.data()), static_cast<std::streamsize>(binary.size()));
    out.flush();
    if (!out) {
      fs::remove(temporary, error);
      return;
    }
  }
  fs::rename(temporary, file, error);  // whole or not at all, also where two runs store the same
  if (error) fs::remove(temporary, error);
}

}  // namespace hfr::detail
