// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ReadMeditSolution.hh"

#include <system_error>

#include "IO/Formats.hh"
#include "IO/MeditSource.hh"
#include "IO/Words.hh"

namespace hfr::io::medit {
namespace {

constexpr std::int64_t kMostFields = 10000;

/// One section: a count, the number of fields, their types, and then all fields of the first item, of the
/// second …
template <class Source>
std::vector<Field> read_fields(Source& in, std::string_view section) {
  const std::size_t items = in.count(section, 0, 1);
  const std::int64_t n_fields = in.short_integer();
  if (n_fields < 0 || n_fields > kMostFields) in.fail("an impossible number of fields");
  std::vector<Field> fields;
  for (std::int64_t i = 0; i < n_fields; ++i) {
    Field field;
    field.name = "solution_" + std::to_string(i + 1);
    field.components = components_of_type(in.short_integer());
    if (field.components == 0) in.fail("a solution's type must be 1, 2, 3 or 4");
    fields.push_back(std::move(field));
  }
  for (std::size_t item = 0; item < items; ++item) {
    for (Field& field : fields) {
      const std::size_t first = field.values.size();
      field.values.resize(first + static_cast<std::size_t>(field.components));
      for (int k = 0; k < field.components; ++k) {
        const int component = field.components == 6 ? kTensorOrder[k] : k;
        field.values[first + static_cast<std::size_t>(component)] = in.value();
      }
    }
  }
  return fields;
}

void keep(std::vector<Field> fields, std::size_t n_items, std::string_view kind, const std::string& name,
          std::vector<Field>& into, std::vector<std::string>& notes) {
  for (Field& field : fields) {
    if (field.values.size() == n_items * static_cast<std::size_t>(field.components)) {
      into.push_back(std::move(field));
      continue;
    }
    notes.push_back(name + " is left out: it has values for " +
                    std::to_string(field.values.size() / static_cast<std::size_t>(field.components)) + " " +
                    std::string(kind) + ", the mesh has " + std::to_string(n_items));
    return;
  }
}

template <class Source>
void read_solution(const InputFile& file, MeshData& mesh) {
  Source in(file);
  const std::string name = file.path().filename().string();
  while (const auto heading = in.next()) {
    if (heading->keyword == Keyword::kSolAtVertices) {
      keep(read_fields(in, heading->name), mesh.points.size(), "points", name, mesh.point_fields, mesh.notes);
    } else if (heading->keyword == Keyword::kSolAtTetrahedra) {
      keep(read_fields(in, heading->name), mesh.cells.size(), "cells", name, mesh.cell_fields, mesh.notes);
    } else {
      in.announced();
      in.skip();
      mesh.notes.push_back(name + ": " + std::string(heading->name) + " is not kept");
    }
  }
  if (!in.saw_end()) mesh.notes.push_back(name + ": the file has no End; it may have been cut short");
}

}  // namespace

void read_solution_beside(const InputFile& mesh_file, MeshData& mesh) {
  const bool binary = lower(mesh_file.path().extension().string()) == ".meshb";
  for (const char* const extension : {binary ? ".solb" : ".sol", binary ? ".sol" : ".solb"}) {
    const std::filesystem::path path = file_beside(mesh_file.path(), extension);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) continue;
    const InputFile file(path);
    is_binary(file) ? read_solution<BinarySource>(file, mesh) : read_solution<AsciiSource>(file, mesh);
    return;
  }
}

}  // namespace hfr::io::medit
