// SPDX-License-Identifier: BSD-3-Clause
#include "IO/MeshFile.hh"

#include <algorithm>
#include <array>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/OutputFile.hh"
#include "IO/Validate.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace {

struct FileFormat {
  std::string_view extension;
  MeshData (*read)(const InputFile&);
  Notes (*write)(const std::filesystem::path&, const MeshData&, const WriteOptions&);
  std::string_view variants;               ///< that WriteOptions::variant may name, with blanks between
  std::array<std::string_view, 3> beside;  ///< extensions of the other files of the mesh
  bool is_one_file = true;                 ///< nothing is lost without those beside it but fields
  bool has_fields = true;                  ///< on vertices and cells
};

constexpr std::array<std::string_view, 3> kSolutions = {".sol", ".solb"};

/// The formats that are built in. A new one is a row here, two declarations in Formats.hh, and its sources.
constexpr FileFormat kFormats[] = {
    {".mesh", read_medit, write_medit, "", kSolutions},
    {".meshb", read_meditb, write_meditb, "", kSolutions},
    {".node", read_tetgen, write_tetgen, "", {".ele", ".face", ".edge"}, false},
    {".ele", read_tetgen, write_tetgen, "", {".node", ".face", ".edge"}, false},
    {".face", read_tetgen, write_tetgen, "", {".node", ".ele", ".edge"}, false},
    {".ovm", read_ovm, write_ovm, "", {}},
    {".msh", read_gmsh, write_gmsh, "2.2 4.0 4.1", {}},
    {".vtk", read_vtk, write_vtk, "4.2 5.1", {}},
    {".vtu", read_vtu, write_vtu, "ascii base64 appended zlib", {}},
    {".stl", read_surface, write_surface, "", {}, true, false},
    {".obj", read_surface, write_surface, "", {}, true, false},
    {".off", read_surface, write_surface, "", {}, true, false},
    {".ply", read_surface, write_surface, "", {}, true, false},
};

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// Nothing where the format is not known.
const FileFormat* find_format(const std::filesystem::path& path, const std::string& format) {
  std::string extension = lower(format.empty() ? path.extension().string() : format);
  if (!extension.empty() && extension[0] != '.') extension.insert(0, 1, '.');
  const auto* const found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                         [&](const FileFormat& f) { return f.extension == extension; });
  return found == std::end(kFormats) ? nullptr : found;
}

const FileFormat& format_of(const std::filesystem::path& path, const std::string& format,
                            const std::vector<std::string>& known) {
  const FileFormat* const found = find_format(path, format);
  HFR_REQUIRE(found, path.string() + ": unknown file type '" +
                         (format.empty() ? path.extension().string() : format) + "'; known are " +
                         joined(known));
  HFR_REQUIRE(found->is_one_file || (path != kStandardInput && path != kStandardOutput),
              path.string() + ": a mesh in " + std::string(found->extension) +
                  " is several files, which one stream cannot hold");
  return *found;
}

/// `name` is one of the words of `variants`.
bool has_variant(std::string_view variants, std::string_view name) {
  while (!variants.empty()) {
    const std::size_t length = std::min(variants.find(' '), variants.size());
    if (variants.substr(0, length) == name) return true;
    variants.remove_prefix(std::min(length + 1, variants.size()));
  }
  return false;
}

std::vector<std::string> all_extensions() {
  std::vector<std::string> extensions;
  for (const FileFormat& format : kFormats) extensions.emplace_back(format.extension);
  return extensions;
}

/// Messages quote the file, which may have anything in it; they are lines all the same.
std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return message;
}

}  // namespace

MeshData read_mesh(const std::filesystem::path& path, const std::string& format) {
  const FileFormat& chosen = format_of(path, format, readable_extensions());
  const InputFile file(path, std::string(chosen.extension));
  HFR_REQUIRE(!file.bytes().empty(), path.string() + ": the file is empty");
  MeshData mesh;
  try {
    mesh = chosen.read(file);
  } catch (const InvalidInput& error) {
    throw InvalidInput(one_line(error.what()));
  }
  validate(mesh, path.string());
  return mesh;
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshData& mesh,
                                    const WriteOptions& options) {
  require_writable_format(path, options);
  validate(mesh, path.string());
  const FileFormat& format = *find_format(path, options.format);
  WriteOptions chosen = options;
  chosen.format = format.extension;
  return format.write(path, mesh, chosen);
}

void require_readable_format(const std::filesystem::path& path, const std::string& format) {
  format_of(path, format, readable_extensions());
}

void require_writable_format(const std::filesystem::path& path, const WriteOptions& options) {
  const FileFormat& format = format_of(path, options.format, writable_extensions());
  if (options.variant.empty() || has_variant(format.variants, options.variant)) return;
  const std::string extension(format.extension);
  throw InvalidInput(one_line(
      path.string() + ": unknown variant '" + options.variant + "' of " + extension +
      (format.variants.empty() ? ", which has none" : "; known are " + std::string(format.variants))));
}

bool holds_fields(const std::filesystem::path& path, const WriteOptions& options) {
  const FileFormat& format = format_of(path, options.format, writable_extensions());
  const bool loses_solutions = path == kStandardOutput && format.beside == kSolutions;
  return format.has_fields && !loses_solutions;
}

std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files = {path};
  const FileFormat* const format = find_format(path, {});
  if (!format || path == kStandardInput || path == kStandardOutput) return files;
  for (const std::string_view extension : format->beside)
    if (!extension.empty()) files.push_back(file_beside(path, extension));
  return files;
}

std::filesystem::path file_beside(const std::filesystem::path& path, std::string_view extension) {
  const std::string own = path.extension().string();
  if (lower(own) == extension) return path;
  std::string other(extension);
  const auto is_small = [](unsigned char c) { return std::islower(c) != 0; };
  if (own.size() > 1 && std::none_of(own.begin(), own.end(), is_small))
    for (char& c : other) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return std::filesystem::path(path).replace_extension(other);
}

std::vector<std::string> readable_extensions() { return all_extensions(); }

std::vector<std::string> writable_extensions() { return all_extensions(); }

}  // namespace hfr::io
