// SPDX-License-Identifier: BSD-3-Clause
#include "IO/MeshFile.hh"

#include <algorithm>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/Validate.hh"

namespace hfr::io {
namespace {

struct Format {
  std::string_view extension;
  MeshData (*read)(const InputFile&);
  Notes (*write)(const std::filesystem::path&, const MeshData&, const WriteOptions&);
};

/// The formats that are built in. A new one is a row here, two declarations in Formats.hh, and its sources.
constexpr Format kFormats[] = {
    {".mesh", read_medit, write_medit},    {".meshb", read_meditb, write_meditb},
    {".node", read_tetgen, write_tetgen},  {".ele", read_tetgen, write_tetgen},
    {".face", read_tetgen, write_tetgen},  {".ovm", read_ovm, write_ovm},
    {".msh", read_gmsh, write_gmsh},       {".vtk", read_vtk, write_vtk},
    {".vtu", read_vtu, write_vtu},         {".stl", read_surface, write_surface},
    {".obj", read_surface, write_surface}, {".off", read_surface, write_surface},
    {".ply", read_surface, write_surface},
};

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

const Format& format_of(const std::filesystem::path& path, const std::vector<std::string>& known) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto* const found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                         [&](const Format& format) { return format.extension == extension; });
  HFR_REQUIRE(found != std::end(kFormats),
              path.string() + ": unknown file type '" + extension + "'; known are " + joined(known));
  return *found;
}

std::vector<std::string> all_extensions() {
  std::vector<std::string> extensions;
  for (const Format& format : kFormats) extensions.emplace_back(format.extension);
  return extensions;
}

/// Messages quote the file, which may have anything in it; they are lines all the same.
std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return message;
}

}  // namespace

MeshData read_mesh(const std::filesystem::path& path) {
  const Format& format = format_of(path, readable_extensions());
  const InputFile file(path);
  HFR_REQUIRE(!file.bytes().empty(), path.string() + ": the file is empty");
  MeshData mesh;
  try {
    mesh = format.read(file);
  } catch (const InvalidInput& error) {
    throw InvalidInput(one_line(error.what()));
  }
  validate(mesh, path.string());
  return mesh;
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshData& mesh,
                                    const WriteOptions& options) {
  const Format& format = format_of(path, writable_extensions());
  validate(mesh, path.string());
  return format.write(path, mesh, options);
}

std::vector<std::string> readable_extensions() { return all_extensions(); }

std::vector<std::string> writable_extensions() { return all_extensions(); }

}  // namespace hfr::io
