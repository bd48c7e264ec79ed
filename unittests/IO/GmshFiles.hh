// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_IO_GMSH_FILES_HH
#define HFR_UNITTESTS_IO_GMSH_FILES_HH

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/MeshDataSamples.hh"

namespace hfr::io::gmsh_files {

struct Variant {
  std::string version;
  bool binary;
};

inline const std::vector<Variant> kVariants = {{"2.2", false}, {"2.2", true},  {"4.0", false},
                                               {"4.0", true},  {"4.1", false}, {"4.1", true}};

inline std::string variant_name(const testing::TestParamInfo<Variant>& info) {
  std::string name = "V" + info.param.version + (info.param.binary ? "Binary" : "Ascii");
  std::erase(name, '.');
  return name;
}

inline MeshData read_bytes_at(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::remove(path);  // truncating a file makes some file systems wait for the disk
  samples::write_bytes(path, bytes);
  return read_gmsh(InputFile(path));
}

inline MeshData read_file(const std::string& bytes) {
  const samples::TemporaryFolder folder;
  return read_bytes_at(folder / "mesh.msh", bytes);
}

/// What reading `bytes`, once written to folder/mesh.msh, throws as InvalidInput, from the file's name on;
/// empty when it throws nothing.
inline std::string failure_at(const samples::TemporaryFolder& folder, const std::string& bytes) {
  try {
    read_bytes_at(folder / "mesh.msh", bytes);
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    return what.substr(std::min(what.find("mesh.msh"), what.size()));
  }
  return "";
}

inline std::string failure(const std::string& bytes) {
  const samples::TemporaryFolder folder;
  return failure_at(folder, bytes);
}

struct Written {
  std::string bytes;
  Notes notes;
};

inline Written written(const MeshData& mesh, const Variant& variant) {
  const samples::TemporaryFolder folder;
  Written result;
  result.notes =
      write_gmsh(folder / "mesh.msh", mesh, {.binary = variant.binary, .variant = variant.version});
  result.bytes = samples::read_bytes(folder / "mesh.msh");
  return result;
}

inline bool has_note(const Notes& notes, const std::string& part) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the text no longer has " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Bytes of a binary file, in the byte order of this machine or the other one.
class Bytes {
 public:
  explicit Bytes(bool swapped = false) : swapped_(swapped) {}

  Bytes& text(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  template <class T>
  Bytes& put(const std::vector<T>& values) {
    for (const T value : values) {
      char raw[sizeof(T)];
      std::memcpy(raw, &value, sizeof(T));
      if (swapped_) std::reverse(raw, raw + sizeof(T));
      bytes_.append(raw, sizeof(T));
    }
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
  bool swapped_;
};

}  // namespace hfr::io::gmsh_files

#endif
