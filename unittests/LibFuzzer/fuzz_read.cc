// SPDX-License-Identifier: BSD-3-Clause
// A reader gets bytes: `fuzz_read --format=vtu …`. It refuses them in one line, or gives a mesh that keeps
// the rules, that build() takes or refuses by name, and that is the same after it was written and read again.
// In ranges by one to three processes it is the same mesh, or refused in one line.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <optional>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "IO/Shares.hh"
#include "IO/Validate.hh"
#include "IO/WritableFormats.hh"
#include "LibFuzzer/Formats.hh"
#include "LibFuzzer/Target.hh"

namespace hfr::fuzz {
namespace {

std::string extension;  // set once, before the first input

/// The ways to write that extension.
const std::vector<io::samples::FormatVariant>& variants() {
  static const auto all = [] {
    auto formats = io::samples::cell_formats();
    std::erase_if(formats, [](const auto& format) { return format.extension != extension; });
    if (formats.empty()) formats = {{extension, {}}, {extension, {true, ""}}};
    return formats;
  }();
  return all;
}

void write_files(const std::filesystem::path& path, const std::vector<Part>& parts) {
  for (const auto& old : std::filesystem::directory_iterator(scratch())) std::filesystem::remove(old);
  for (const Part& part : parts) {
    std::ofstream file(std::filesystem::path(path).replace_extension(part.extension), std::ios::binary);
    file.write(part.bytes.data(), static_cast<std::streamsize>(part.bytes.size()));
    if (!file.flush()) throw std::runtime_error("the scratch folder is full");
  }
}

void look_at_refusal(const std::string& message) {
  constexpr std::size_t kLongest = 600;  // bytes, the folder's name among them
  if (message.find('\n') != std::string::npos) broken("one line", message);
  if (message.size() > kLongest) broken("short line", message);
  if (!message.starts_with((scratch() / "mesh").string())) broken("path first", message);
}

std::optional<io::MeshData> read_or_refused(const std::filesystem::path& path) {
  try {
    io::MeshData mesh = io::read_mesh(path);
    io::validate(mesh, "again");
    return mesh;
  } catch (const InvalidInput& error) {
    look_at_refusal(error.what());
  } catch (const IoError& error) {
    look_at_refusal(error.what());
  } catch (const ResourceLimit& error) {
    look_at_refusal(error.what());
  } catch (const std::exception& error) {
    broken("error", error.what());
  }
  return std::nullopt;
}

void build_it(const io::MeshData& mesh) {
  try {
    const TetMesh built = io::assemble(mesh);
    const CheckResult rule = check(built, {.last = Rule::kDuplicateEdge});
    if (!rule) broken("build", rule.message);
  } catch (const InvalidInput&) {
  } catch (const ResourceLimit&) {
  }
}

/// A surface keeps its triangles alone, and a mesh with cells its boundary; so those are only read again.
void write_and_read(const io::MeshData& mesh, const io::samples::FormatVariant& format) {
  const std::filesystem::path path = scratch() / ("mesh_again" + extension);
  try {
    const auto notes = io::write_mesh(path, mesh, format.options);
    const io::MeshData again = io::read_mesh(path);
    if (is_surface_format(extension)) return;
    const std::string differs = difference(mesh, again);
    if (notes.empty() && !differs.empty()) broken("round trip", format.name() + ": " + differs);
    if (!same_points(mesh.points, again.points) || mesh.cells != again.cells)
      broken("round trip", format.name() + ": " + differs + ", in spite of " + notes.front());
  } catch (const InvalidInput& error) {
    if (!is_surface_format(extension)) broken("round trip", format.name() + ": " + error.what());
  }
}

/// Ranges may be refused where a whole file is not, and leave out what a whole reader refuses.
void read_in_ranges(const std::filesystem::path& path, const std::optional<io::MeshData>& whole,
                    std::size_t n_processes) {
  constexpr std::uint64_t kAtOnce = 8;
  if (!io::has_shares(path)) return;
  try {
    const io::MeshData shares =
        io::samples::put_together(io::samples::read_shares(path, n_processes, kAtOnce));
    if (!whole) return;
    const std::string differs = difference(shares, io::samples::comparable(*whole));
    if (!differs.empty()) broken("ranges", std::to_string(n_processes) + " processes: " + differs);
  } catch (const InvalidInput& error) {
    look_at_refusal(error.what());
  } catch (const IoError& error) {
    look_at_refusal(error.what());
  } catch (const std::exception& error) {
    broken("error in ranges", error.what());
  }
}

}  // namespace
}  // namespace hfr::fuzz

int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace hfr;
  for (int i = 1; i < *argc; ++i) {
    const std::string argument = (*argv)[i];
    if (argument.starts_with("--format=")) fuzz::extension = "." + argument.substr(9);
  }
  const auto known = io::readable_extensions();
  if (std::find(known.begin(), known.end(), fuzz::extension) == known.end()) {
    fmt::print(stderr, "fuzz_read: --format=EXTENSION is missing, or not one of the readers'\n");
    std::exit(2);
  }
  return 0;
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hfr;
  using namespace hfr::fuzz;
  const std::filesystem::path path = scratch() / ("mesh" + extension);
  write_files(path, parts_of({reinterpret_cast<const char*>(data), size}, extension));
  const std::optional<io::MeshData> mesh = read_or_refused(path);
  read_in_ranges(path, mesh, 1 + size % 3);
  if (!mesh) return 0;
  build_it(*mesh);
  write_and_read(*mesh, variants()[size % variants().size()]);
  return 0;
}
