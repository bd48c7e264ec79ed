// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "Distributed/Incoming.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"
#include "IO/VtkGrid.hh"

namespace hfr::mpi {
namespace {

std::string unescaped(std::string text) {
  for (const auto& [code, c] :
       {std::pair{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}})
    for (std::size_t at = 0; (at = text.find(code, at)) != std::string::npos; ++at)
      text.replace(at, std::string_view(code).size(), 1, c);
  return text;
}

/// The files that an index names. It is small, so each rank reads it.
std::vector<std::filesystem::path> pieces_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(path.string() + ": cannot be opened");
  std::ostringstream all;
  all << in.rdbuf();
  const std::string text = all.str();
  if (text.find("<PUnstructuredGrid") == std::string::npos)
    throw InvalidInput(path.string() + ": no index of pieces of an unstructured grid");
  std::vector<std::filesystem::path> pieces;
  for (std::size_t at = 0; (at = text.find("<Piece", at)) != std::string::npos;) {
    const std::size_t end = text.find('>', at);
    constexpr std::string_view kSource = "Source=\"";
    const std::size_t from = text.find(kSource, at);
    if (end == std::string::npos || from == std::string::npos || from > end)
      throw InvalidInput(path.string() + ": a piece without a source");
    const std::size_t begin = from + kSource.size();
    pieces.push_back(path.parent_path() / unescaped(text.substr(begin, text.find('"', begin) - begin)));
    at = end;
  }
  if (pieces.empty()) throw InvalidInput(path.string() + ": it names no pieces");
  return pieces;
}

std::vector<std::uint64_t> whole_numbers(const std::filesystem::path& path,
                                         const std::vector<double>& values) {
  constexpr double kMost = 9007199254740992.0;  // whole numbers up to here are exact
  std::vector<std::uint64_t> numbers;
  numbers.reserve(values.size());
  for (const double value : values) {
    if (!(value >= 0 && value < kMost) || value != std::floor(value))
      throw InvalidInput(path.string() + ": a \"number\" is no whole number");
    numbers.push_back(static_cast<std::uint64_t>(value));
  }
  return numbers;
}

std::vector<std::uint64_t> numbers_of(const std::filesystem::path& path,
                                      const std::vector<io::Field>& fields) {
  for (const io::Field& field : fields)
    if (field.name == io::kVtkNumberArray && field.components == 1) return whole_numbers(path, field.values);
  throw InvalidInput(path.string() +
                     ": points and cells need a \"number\" in the whole each, as write_pvtu() gives "
                     "them");
}

/// Labelled triangles (N = 3) or edges; `points`: numbers.
template <std::size_t N>
void add_labelled(const std::filesystem::path& path, const std::vector<std::array<Index, N>>& items,
                  const std::vector<int>& labels, const std::vector<double>& numbers,
                  const std::vector<std::uint64_t>& points, Incoming& incoming) {
  const std::vector<std::uint64_t> number = whole_numbers(path, numbers);
  HFR_REQUIRE(number.size() == items.size(),
              path.string() + ": triangles and edges need a \"number\" in the whole each, too");
  for (std::size_t i = 0; i < items.size(); ++i) {
    LabelRecord r;
    r.kind = N == 3 ? LabelRecord::Kind::kFace : LabelRecord::Kind::kEdge;
    for (std::size_t k = 0; k < N; ++k) r.v[k] = points[items[i][k]];
    r.number = number[i];
    r.value = i < labels.size() ? labels[i] : 0;
    incoming.add(r);
  }
}

void add_labels(const std::filesystem::path& path, const io::MeshData& data,
                const std::vector<std::uint64_t>& points, Incoming& incoming) {
  add_labelled(path, data.triangles, data.triangle_labels, data.triangle_numbers, points, incoming);
  add_labelled(path, data.edges, data.edge_labels, data.edge_numbers, points, incoming);
  LabelRecord r;
  for (std::size_t i = 0; i < data.vertex_labels.size(); ++i) {
    r.v[0] = points[i];
    r.value = data.vertex_labels[i];
    if (r.value != 0) incoming.add(r);
  }
  r.kind = LabelRecord::Kind::kFixedVertex;
  r.value = 0;
  for (Index v : data.fixed_vertices) {
    r.v[0] = points[v];
    incoming.add(r);
  }
}

/// Reads a piece. Returns what is left out of it; `names` takes those of its labels.
std::vector<std::string> read_piece(const std::filesystem::path& path, int rank, Incoming& incoming,
                                    std::string& names) {
  io::MeshData data = io::read_mesh(path);
  names += io::names_text(data);
  if (data.points.empty() && data.cells.empty()) return {};  // of a rank that had nothing: it names no arrays
  const auto points = numbers_of(path, data.point_fields), cells = numbers_of(path, data.cell_fields);
  for (std::size_t i = 0; i < points.size(); ++i) incoming.add(PointRecord{points[i], data.points[i], rank});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CornerRecord one{cells[i], {}, data.regions.empty() ? 0 : data.regions[i]};
    for (std::size_t k = 0; k < 4; ++k) {
      HFR_REQUIRE(data.cells[i][k] < points.size(), path.string() + ": a cell has a point that is not there");
      one.v[k] = points[data.cells[i][k]];
    }
    incoming.add(one);
  }
  add_labels(path, data, points, incoming);
  std::vector<std::string> notes;
  const auto note = [&](const std::vector<io::Field>& fields, const char* of) {
    for (const io::Field& field : fields)
      if (field.name != io::kVtkNumberArray)
        notes.push_back("array '" + field.name + "' of " + of + " left out");
  };
  note(data.point_fields, "points");
  note(data.cell_fields, "cells");
  return notes;
}

}  // namespace

std::vector<std::string> read_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Comm::InPhase phase(mesh.comm(), Phase::kHandOut);
  const std::vector<std::filesystem::path> pieces = pieces_of(path);
  Incoming incoming(mesh.comm());
  std::vector<std::string> notes;
  std::string names;
  const std::size_t n_ranks = mesh.comm().n_ranks();
  for (auto i = static_cast<std::size_t>(mesh.comm().rank()); i < pieces.size(); i += n_ranks)
    for (std::string& note : read_piece(pieces[i], mesh.comm().rank(), incoming, names))
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
  incoming.find_owners();
  incoming.even_out();
  incoming.hand_to_owners(incoming);
  for (std::string& note : incoming.make_parts(mesh, path)) notes.push_back(std::move(note));
  const auto all = mesh.comm().all_gather(std::span<const char>(names.data(), names.size()));
  io::MeshData named;
  io::read_names({all.data(), all.size()}, named);
  mesh.part().labels().names = std::move(named.names);
  return notes;
}

}  // namespace hfr::mpi
