// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <system_error>

#include "IO/Formats.hh"
#include "IO/MeditPart.hh"
#include "IO/MeditSource.hh"
#include "IO/MeshStretch.hh"
#include "IO/OutputFile.hh"
#include "IO/ReadMeditSolution.hh"

namespace hfr::io {
namespace {

using medit::Keyword;

/// What both files are written through. A line ends at last() or end_line(); binary files have no lines.
/// `is_first`: this process writes headings and what else is there once.
class AsciiSink {
 public:
  AsciiSink(ByteSink& file, bool is_first, int /*version*/) : file_(file), is_first_(is_first) {
    if (is_first_) file_.text("MeshVersionFormatted 2\nDimension 3\n");
  }

  /// A section of so many entries of all processes.
  void begin(Keyword keyword, std::uint64_t entries, std::size_t /*integers*/, std::size_t /*reals*/,
             const std::vector<int>& types = {}) {
    if (!is_first_) return;
    file_.text(medit::heading_of(static_cast<int>(keyword)).name).text("\n");
    last(static_cast<std::int64_t>(entries));
    if (types.empty()) return;
    file_.number(static_cast<std::int64_t>(types.size()));
    for (const int type : types) file_.text(" ").number(static_cast<std::int64_t>(type));
    file_.text("\n");
  }
  void real(double value) { file_.number(value).text(" "); }
  void integer(std::int64_t value) { file_.number(value).text(" "); }
  void last(std::int64_t value) { file_.number(value).text("\n"); }
  void end_line() { file_.text("\n"); }
  void end_section() { file_.next_stretch(); }
  void finish() {
    if (is_first_) file_.text("End\n");
  }

 private:
  ByteSink& file_;
  bool is_first_;
};

class BinarySink {
 public:
  BinarySink(ByteSink& file, bool is_first, int version)
      : file_(file), is_first_(is_first), version_(version) {
    next_ = 3 * sizeof(std::int32_t) + position_size() + sizeof(std::int32_t);
    if (!is_first_) return;
    put<std::int32_t>(1);
    put<std::int32_t>(version_);
    put(static_cast<std::int32_t>(Keyword::kDimension));
    put_position(next_);
    put<std::int32_t>(3);
  }

  void begin(Keyword keyword, std::uint64_t entries, std::size_t integers, std::size_t reals,
             const std::vector<int>& types = {}) {
    const std::size_t type_bytes = types.empty() ? 0 : (types.size() + 1) * sizeof(std::int32_t);
    next_ += sizeof(std::int32_t) + position_size() + integer_size() + type_bytes +
             entries * (integers * integer_size() + reals * sizeof(double));
    if (!is_first_) return;
    put(static_cast<std::int32_t>(keyword));
    put_position(next_);
    integer(static_cast<std::int64_t>(entries));
    if (types.empty()) return;
    put(static_cast<std::int32_t>(types.size()));
    for (const int type : types) put<std::int32_t>(type);
  }
  void real(double value) { put(value); }
  void integer(std::int64_t value) { version_ < 4 ? put(static_cast<std::int32_t>(value)) : put(value); }
  void last(std::int64_t value) { integer(value); }
  void end_line() {}
  void end_section() { file_.next_stretch(); }
  void finish() {
    if (!is_first_) return;
    put(static_cast<std::int32_t>(Keyword::kEnd));
    put_position(0);
  }

 private:
  template <class T>
  void put(T value) {
    file_.raw(value);
  }
  void put_position(std::uint64_t value) {
    version_ < 3 ? put(static_cast<std::int32_t>(value)) : put(static_cast<std::int64_t>(value));
  }
  std::size_t position_size() const { return version_ < 3 ? 4 : 8; }
  std::size_t integer_size() const { return version_ < 4 ? 4 : 8; }

  ByteSink& file_;
  bool is_first_;
  int version_;
  std::uint64_t next_ = 0;  ///< where the next section begins
};

/// The oldest version of binary files that can hold the mesh is the one that most programs read.
int version_for(const MeshStretch& mesh, std::size_t n_values_of_fields) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::uint64_t bytes = 1000 + mesh.n_points * 28 + mesh.cells.total * 20 + mesh.triangles.total * 16 +
                              mesh.edges.total * 12 + mesh.fixed.total * 4 + 8 * n_values_of_fields;
  const bool many = std::max({mesh.n_points, mesh.cells.total, mesh.triangles.total}) > kMost;
  return many ? 4 : bytes > kMost ? 3 : 2;
}

template <class Sink>
void write_elements(Sink& out, Keyword keyword, const ElementStretch& elements) {
  if (elements.total == 0) return;
  const std::size_t width = elements.corners.width();
  out.begin(keyword, elements.total, width + 1, 0);
  for (std::size_t i = 0; i < elements.corners.size(); ++i) {
    for (std::size_t k = 0; k < width; ++k)
      out.integer(static_cast<std::int64_t>(elements.corners(i, k)) + 1);
    out.last(elements.label(i));
  }
  out.end_section();
}

template <class Sink>
void write_all(Sink& out, const MeshStretch& mesh) {
  out.begin(Keyword::kVertices, mesh.n_points, 1, 3);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    out.real(p.x);
    out.real(p.y);
    out.real(p.z);
    out.last(mesh.vertex_labels.empty() ? 0 : mesh.vertex_labels[i]);
  }
  out.end_section();
  if (mesh.fixed.total > 0) {
    out.begin(Keyword::kRequiredVertices, mesh.fixed.total, 1, 0);
    for (std::size_t i = 0; i < mesh.fixed.corners.size(); ++i)
      out.last(static_cast<std::int64_t>(mesh.fixed.corners(i, 0)) + 1);
    out.end_section();
  }
  write_elements(out, Keyword::kEdges, mesh.edges);
  write_elements(out, Keyword::kTriangles, mesh.triangles);
  write_elements(out, Keyword::kTetrahedra, mesh.cells);
}

/// The fields that Medit has a type for.
std::vector<const Field*> storable(const std::vector<Field>& fields) {
  std::vector<const Field*> found;
  for (const Field& field : fields) {
    if (medit::type_of_components(field.components) != 0) found.push_back(&field);
  }
  return found;
}

template <class Sink>
void write_fields(Sink& out, Keyword keyword, const std::vector<const Field*>& fields, std::size_t n_items) {
  if (fields.empty()) return;
  std::vector<int> types;
  std::size_t width = 0;
  for (const Field* field : fields) {
    types.push_back(medit::type_of_components(field->components));
    width += static_cast<std::size_t>(field->components);
  }
  out.begin(keyword, n_items, 0, width, types);
  for (std::size_t i = 0; i < n_items; ++i) {
    for (const Field* field : fields) {
      const double* const values = field->values.data() + i * static_cast<std::size_t>(field->components);
      for (int k = 0; k < field->components; ++k) {
        out.real(values[field->components == 6 ? medit::kTensorOrder[k] : k]);
      }
    }
    out.end_line();
  }
}

void note_names(std::size_t n_names, Notes& notes) {
  if (n_names > 0)
    notes.push_back("Medit files hold no names: " + std::to_string(n_names) +
                    " names of regions and patches are left out");
}

void note_solution_beside(const std::filesystem::path& mesh, Notes& notes) {
  for (const char* const extension : {".sol", ".solb"}) {  // a reader takes either
    const std::filesystem::path solution = file_beside(mesh, extension);
    std::error_code ignored;
    if (std::filesystem::exists(solution, ignored))
      notes.push_back(solution.filename().string() +
                      " stands beside the file and is not of this mesh, but will be read with it");
  }
}

/// `solution_name` is empty where there is no place beside the mesh for its fields.
void note_losses(const MeshData& mesh, std::string_view solution_name, Notes& notes) {
  note_names(mesh.names.size(), notes);
  std::string kept;
  for (const auto* fields : {&mesh.point_fields, &mesh.cell_fields}) {
    for (const Field& field : *fields) {
      if (medit::type_of_components(field.components) == 0) {
        notes.push_back("field '" + field.name + "' is left out: Medit has no type with " +
                        std::to_string(field.components) + " components");
      } else {
        kept += (kept.empty() ? "'" : ", '") + field.name + "'";
      }
    }
  }
  if (kept.empty()) return;
  if (solution_name.empty()) {
    notes.push_back("fields are left out, as Medit keeps them in a file of their own: " + kept);
    return;
  }
  notes.push_back("fields go into " + std::string(solution_name) +
                  ", as reals and without their names: " + kept);
}

template <class Sink>
Notes write(const std::filesystem::path& path, const MeshData& mesh, const char* solution_extension) {
  const std::filesystem::path solution_path = file_beside(path, solution_extension);
  const bool alone = path == kStandardOutput;
  Notes notes;
  note_losses(mesh, alone ? "" : solution_path.filename().string(), notes);

  const MeshStretch stretch = stretch_of(mesh);
  std::size_t n_values = 0;
  for (const auto* fields : {&mesh.point_fields, &mesh.cell_fields})
    for (const Field& field : *fields) n_values += field.values.size();
  const int version = version_for(stretch, n_values);
  OutputFile file(path);
  Sink out(file, true, version);
  write_all(out, stretch);
  out.finish();
  if (alone) {
    file.commit();
    return notes;
  }
  const std::vector<const Field*> point_fields = storable(mesh.point_fields);
  const std::vector<const Field*> cell_fields = storable(mesh.cell_fields);
  std::optional<OutputFile> solution_file;
  if (!point_fields.empty() || !cell_fields.empty()) {
    solution_file.emplace(solution_path);
    Sink solution(*solution_file, true, version);
    write_fields(solution, Keyword::kSolAtVertices, point_fields, mesh.points.size());
    write_fields(solution, Keyword::kSolAtTetrahedra, cell_fields, mesh.cells.size());
    solution.finish();
  } else {
    note_solution_beside(path, notes);
  }
  commit_together({solution_file ? &*solution_file : nullptr, &file});
  return notes;
}

template <class Sink>
StretchedFile stretches(const MeshStretch& mesh, const std::filesystem::path& path) {
  StretchedFile file;
  file.write = [&mesh, version = version_for(mesh, 0)](ByteSink& out) {
    Sink sink(out, mesh.is_first(), version);
    write_all(sink, mesh);
    sink.finish();
  };
  note_names(mesh.names->size(), file.notes);
  note_solution_beside(path, file.notes);
  return file;
}

}  // namespace

Notes write_medit(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  return write<AsciiSink>(path, mesh, ".sol");
}

Notes write_meditb(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  return write<BinarySink>(path, mesh, ".solb");
}

/// As ParMmg reads it: it looks for keywords, in this order.
Notes write_medit_part(ByteSink& file, const MeditPart& part) {
  const MeshStretch stretch = stretch_of(part.mesh);
  AsciiSink out(file, true, 2);
  write_all(out, stretch);
  const auto integer = [&](std::size_t value) { return static_cast<std::int64_t>(value); };
  file.text("NumberOfPartitions\n").number(part.n_parts);
  file.text(part.by_triangles ? "\nParallelTriangleCommunicators\n" : "\nParallelVertexCommunicators\n");
  file.number(integer(part.interfaces.size())).text("\n");
  for (const MeditInterface& interface : part.interfaces)
    file.number(std::int64_t{interface.part}).text(" ").number(integer(interface.items.size())).text("\n");
  file.text(part.by_triangles ? "ParallelCommunicatorTriangles\n" : "ParallelCommunicatorVertices\n");
  for (std::size_t k = 0; k < part.interfaces.size(); ++k) {
    const MeditInterface& interface = part.interfaces[k];
    for (std::size_t i = 0; i < interface.items.size(); ++i) {
      out.integer(integer(interface.items[i]) + 1);
      out.integer(interface.number[i]);
      out.last(integer(k));
    }
  }
  out.finish();
  Notes notes;
  note_names(part.mesh.names.size(), notes);
  return notes;
}

StretchedFile medit_stretches(const std::filesystem::path& path, const MeshStretch& mesh, bool is_binary) {
  return is_binary ? stretches<BinarySink>(mesh, path) : stretches<AsciiSink>(mesh, path);
}

}  // namespace hfr::io
