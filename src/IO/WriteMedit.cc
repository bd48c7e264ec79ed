// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <system_error>

#include "IO/Formats.hh"
#include "IO/MeditSource.hh"
#include "IO/OutputFile.hh"
#include "IO/ReadMeditSolution.hh"

namespace hfr::io {
namespace {

using medit::Keyword;

/// What both files are written through. A line ends at last() or end_line(); binary files have no lines.
class AsciiSink {
 public:
  AsciiSink(const std::filesystem::path& path, const MeshData& /*mesh*/) : file_(path) {
    file_.text("MeshVersionFormatted 2\nDimension 3\n");
  }

  void begin(Keyword keyword, std::size_t entries, std::size_t /*integers*/, std::size_t /*reals*/,
             const std::vector<int>& types = {}) {
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
  void finish() { file_.text("End\n"); }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
};

class BinarySink {
 public:
  BinarySink(const std::filesystem::path& path, const MeshData& mesh)
      : file_(path), version_(version_for(mesh)) {
    put<std::int32_t>(1);
    put<std::int32_t>(version_);
    put(static_cast<std::int32_t>(Keyword::kDimension));
    put_position(position_ + position_size() + sizeof(std::int32_t));
    put<std::int32_t>(3);
  }

  void begin(Keyword keyword, std::size_t entries, std::size_t integers, std::size_t reals,
             const std::vector<int>& types = {}) {
    put(static_cast<std::int32_t>(keyword));
    const std::size_t type_bytes = types.empty() ? 0 : (types.size() + 1) * sizeof(std::int32_t);
    put_position(position_ + position_size() + integer_size() + type_bytes +
                 entries * (integers * integer_size() + reals * sizeof(double)));
    integer(static_cast<std::int64_t>(entries));
    if (types.empty()) return;
    put(static_cast<std::int32_t>(types.size()));
    for (const int type : types) put<std::int32_t>(type);
  }
  void real(double value) { put(value); }
  void integer(std::int64_t value) { version_ < 4 ? put(static_cast<std::int32_t>(value)) : put(value); }
  void last(std::int64_t value) { integer(value); }
  void end_line() {}
  void finish() {
    put(static_cast<std::int32_t>(Keyword::kEnd));
    put_position(0);
  }
  void commit() { file_.commit(); }

 private:
  /// The oldest version that can hold the mesh is the one that most programs read.
  static int version_for(const MeshData& mesh) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
    std::size_t bytes = 1000 + mesh.points.size() * 28 + mesh.cells.size() * 20 + mesh.triangles.size() * 16 +
                        mesh.edges.size() * 12 + mesh.fixed_vertices.size() * 4;
    for (const Field& field : mesh.point_fields) bytes += 8 * field.values.size();
    for (const Field& field : mesh.cell_fields) bytes += 8 * field.values.size();
    const bool many = std::max({mesh.points.size(), mesh.cells.size(), mesh.triangles.size()}) > kMost;
    return many ? 4 : bytes > kMost ? 3 : 2;
  }

  template <class T>
  void put(T value) {
    file_.raw(value);
    position_ += sizeof value;
  }
  void put_position(std::size_t value) {
    version_ < 3 ? put(static_cast<std::int32_t>(value)) : put(static_cast<std::int64_t>(value));
  }
  std::size_t position_size() const { return version_ < 3 ? 4 : 8; }
  std::size_t integer_size() const { return version_ < 4 ? 4 : 8; }

  OutputFile file_;
  int version_;
  std::size_t position_ = 0;
};

template <class Sink, class Elements>
void write_elements(Sink& out, Keyword keyword, const Elements& elements, const std::vector<int>& labels) {
  if (elements.empty()) return;
  out.begin(keyword, elements.size(), elements[0].size() + 1, 0);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (const Index corner : elements[i]) out.integer(static_cast<std::int64_t>(corner) + 1);
    out.last(labels.empty() ? 0 : labels[i]);
  }
}

template <class Sink>
void write_all(Sink& out, const MeshData& mesh) {
  out.begin(Keyword::kVertices, mesh.points.size(), 1, 3);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    out.real(p.x);
    out.real(p.y);
    out.real(p.z);
    out.last(mesh.vertex_labels.empty() ? 0 : mesh.vertex_labels[i]);
  }
  if (!mesh.fixed_vertices.empty()) {
    out.begin(Keyword::kRequiredVertices, mesh.fixed_vertices.size(), 1, 0);
    for (const Index vertex : mesh.fixed_vertices) out.last(static_cast<std::int64_t>(vertex) + 1);
  }
  write_elements(out, Keyword::kEdges, mesh.edges, mesh.edge_labels);
  write_elements(out, Keyword::kTriangles, mesh.triangles, mesh.triangle_labels);
  write_elements(out, Keyword::kTetrahedra, mesh.cells, mesh.regions);
  out.finish();
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

/// `solution_name` is empty where there is no place beside the mesh for its fields.
void note_losses(const MeshData& mesh, std::string_view solution_name, Notes& notes) {
  if (!mesh.names.empty()) {
    notes.push_back("Medit files hold no names: " + std::to_string(mesh.names.size()) +
                    " names of regions and patches are left out");
  }
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
  const std::filesystem::path solution_path =
      std::filesystem::path(path).replace_extension(solution_extension);
  const bool alone = path == kStandardOutput;
  const std::string solution_name = alone ? "" : solution_path.filename().string();
  Notes notes;
  note_losses(mesh, solution_name, notes);

  Sink out(path, mesh);
  write_all(out, mesh);
  const std::vector<const Field*> point_fields = storable(mesh.point_fields);
  const std::vector<const Field*> cell_fields = storable(mesh.cell_fields);
  std::error_code ignored;
  if (alone) {
    out.commit();
    return notes;
  }
  if (!point_fields.empty() || !cell_fields.empty()) {
    Sink solution(solution_path, mesh);
    write_fields(solution, Keyword::kSolAtVertices, point_fields, mesh.points.size());
    write_fields(solution, Keyword::kSolAtTetrahedra, cell_fields, mesh.cells.size());
    solution.finish();
    solution.commit();
  } else if (std::filesystem::exists(solution_path, ignored)) {
    notes.push_back(solution_name +
                    " stands beside the file and is not of this mesh, but will be read with it");
  }
  out.commit();
  return notes;
}

}  // namespace

Notes write_medit(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  return write<AsciiSink>(path, mesh, ".sol");
}

Notes write_meditb(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& /*options*/) {
  return write<BinarySink>(path, mesh, ".solb");
}

}  // namespace hfr::io
