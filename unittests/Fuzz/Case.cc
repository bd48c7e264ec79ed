// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/Case.hh"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <optional>

#include "Fuzz/Measure.hh"
#include "HalfFace/Errors.hh"
#include "IO/Assemble.hh"
#include "IO/Hash.hh"
#include "IO/MeshFile.hh"
#include "IO/WritableFormats.hh"

namespace hfr::fuzz {
namespace {

template <class... Args>
void find(Outcome& outcome, const std::string& promise, fmt::format_string<Args...> text, Args&&... args) {
  outcome.findings.push_back({promise, fmt::format(text, std::forward<Args>(args)...)});
}

/// One run; nothing where it was refused. The mesh must be as it was then.
std::optional<Result> improved(TetMesh& mesh, const Case& wanted, int threads, Outcome& outcome) {
  ImproveOptions options = wanted.options.improve;
  options.policy = {threads, 1};
  int n_questions = 0;
  if (wanted.options.cancel_at > 0)
    options.cancel = [&] { return ++n_questions == wanted.options.cancel_at; };
  const std::uint64_t before = io::mesh_hash(mesh);
  std::string error;
  try {
    return improve(mesh, options);
  } catch (const InvalidInput& refusal) {
    error = refusal.what();
  } catch (const ResourceLimit& refusal) {
    error = refusal.what();
  } catch (const std::exception& other) {
    find(outcome, "error", "improve() throws: {}", other.what());
  }
  outcome.refused = true;
  outcome.refusal = error;
  if (io::mesh_hash(mesh) != before) find(outcome, "refused", "but the mesh has changed: {}", error);
  return std::nullopt;
}

/// What the format holds of a mesh; see docs/file-formats.md.
io::MeshData held_by(const std::string& extension, io::MeshData data) {
  const bool fixes =
      extension != ".msh" && extension != ".node" && extension != ".ele" && extension != ".face";
  if (!fixes) data.fixed_vertices.clear();
  return data;
}

/// What is written and read again is the same mesh, and can be built.
void write_and_read(const TetMesh& mesh, std::uint64_t number, const std::string& folder, Outcome& outcome) {
  static const auto formats = io::samples::cell_formats();
  const io::MeshData data = io::disassemble(mesh);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& format = formats[(2 * number + i) % formats.size()];
    const std::filesystem::path path = std::filesystem::path(folder) / ("fuzz" + format.extension);
    try {
      io::write_mesh(path, data, format.options);
      const io::MeshData again = io::read_mesh(path);
      if (io::mesh_hash(again) != io::mesh_hash(held_by(format.extension, data)))
        find(outcome, "file", "{}: another mesh after reading", format.name());
      const TetMesh built = io::assemble(again);
      const CheckResult rule = check(built, {.last = Rule::kDuplicateEdge});
      if (rule) continue;
      find(outcome, "file", "{}: {}", format.name(), rule.message);
    } catch (const std::exception& error) {
      find(outcome, "file", "{}: {}", format.name(), error.what());
    }
  }
}

/// Fields that a run has to carry along: the region of each cell once more, and the number of each vertex.
void attach_fields(TetMesh& mesh) {
  auto region = mesh.request_cell_property<int>("region again", 0);
  for (CellHandle c : mesh.cells()) region[c] = mesh.region(c);
  auto number = mesh.request_vertex_property<int>("number", -1);
  for (VertexHandle v : mesh.vertices()) number[v] = static_cast<int>(v.idx());
}

/// Cells have the fields of their region, and fixed vertices their own.
void compare_fields(TetMesh& mesh, const Complex& complex, Outcome& outcome) {
  const auto region = mesh.request_cell_property<int>("region again", 0);
  std::size_t n_others = 0;
  for (CellHandle c : mesh.cells()) n_others += region[c] != mesh.region(c) ? 1 : 0;
  if (n_others > 0) find(outcome, "fields", "{} cells have those of another region", n_others);
  const auto number = mesh.request_vertex_property<int>("number", -1);
  for (VertexHandle v : mesh.vertices()) {
    if (!mesh.is_fixed(v)) continue;
    const auto was = static_cast<std::size_t>(number[v]);
    if (was >= complex.points.size() || complex.points[was] != mesh.point(v))
      find(outcome, "fields", "fixed vertex {} has those of vertex {}", v.idx(), was);
  }
}

std::optional<TetMesh> built(const Case& wanted, Outcome& outcome) {
  try {
    TetMesh mesh = mesh_of(wanted.complex);
    attach_fields(mesh);
    return mesh;
  } catch (const InvalidInput&) {
  } catch (const ResourceLimit&) {
  } catch (const std::exception& error) {
    find(outcome, "error", "build() throws: {}", error.what());
  }
  outcome.refused = true;
  return std::nullopt;
}

}  // namespace

Case make_case(std::uint64_t number) {
  Case made;
  made.number = number;
  made.complex = random_complex(number);
  made.options = random_options(number, made.complex);
  return made;
}

Outcome run_case(const Case& wanted, const std::string& folder) {
  Outcome outcome;
  std::optional<TetMesh> mesh = built(wanted, outcome);
  if (!mesh) return outcome;
  const Measure before = measure(*mesh);
  outcome.was_invalid = before.inverted + before.flat > 0;
  outcome.was_pinched = before.extra_fans + before.extra_stars > 0;
  outcome.cells_before = before.cells;
  if (before.rule != Ok) {
    find(outcome, "accepted", "{}: {}", rule_name(before.rule), before.rule_message);
    return outcome;
  }
  const std::uint64_t hash = io::mesh_hash(*mesh);
  const std::clock_t start = std::clock();
  const std::optional<Result> result = improved(*mesh, wanted, 1, outcome);
  outcome.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (!result) return outcome;
  outcome.changed = result->changed;
  const Measure after = measure(*mesh);
  outcome.cells_after = after.cells;
  compare_meshes(before, after, wanted.options, result->surface, outcome.findings);
  const std::uint64_t hash_after = io::mesh_hash(*mesh);
  compare_result(*mesh, *result, hash == hash_after, wanted.options, outcome.findings);
  compare_fields(*mesh, wanted.complex, outcome);
  if (wanted.number % 2 == 0 && !std::isfinite(wanted.options.improve.time_limit)) {
    TetMesh other = mesh_of(wanted.complex);
    if (!improved(other, wanted, wanted.options.threads, outcome) || io::mesh_hash(other) != hash_after)
      find(outcome, "same bits", "one thread and {} give other meshes", wanted.options.threads);
  }
  if (after.rule == Ok) write_and_read(*mesh, wanted.number, folder, outcome);
  return outcome;
}

}  // namespace hfr::fuzz
