// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Distributed/AttachedArrays.hh"
#include "Distributed/InParts.hh"
#include "Distributed/Incoming.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"
#include "IO/VtkGrid.hh"
#include "IO/Words.hh"

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

/// The arrays of a piece, until all ranks know which ones all pieces have.
struct PieceArrays {
  std::size_t number = 0;
  bool is_empty = false;
  std::vector<std::uint64_t> points, cells;  // numbers, where there are fields
  std::vector<Vec3> places;
  std::vector<io::Field> point_fields, cell_fields;
};

std::vector<io::Field> without_numbers(std::vector<io::Field> fields) {
  std::erase_if(fields, [](const io::Field& field) { return field.name == io::kVtkNumberArray; });
  return fields;
}

/// Reads a piece. Returns what is left out of it; `names` takes those of its labels, `arrays` its fields.
std::vector<std::string> read_piece(const std::filesystem::path& path, int rank, Incoming& incoming,
                                    std::string& names, PieceArrays& arrays) {
  io::MeshData data = io::read_mesh(path);
  names += io::names_text(data);
  arrays.is_empty = data.points.empty() && data.cells.empty();
  if (arrays.is_empty) return {};  // of a rank that had nothing: it names no arrays
  auto points = numbers_of(path, data.point_fields), cells = numbers_of(path, data.cell_fields);
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
  arrays.point_fields = without_numbers(std::move(data.point_fields));
  arrays.cell_fields = without_numbers(std::move(data.cell_fields));
  if (!arrays.point_fields.empty()) {
    arrays.points = std::move(points);
    arrays.places = std::move(data.points);
  }
  if (!arrays.cell_fields.empty()) arrays.cells = std::move(cells);
  return std::move(data.notes);
}

/// The arrays that each piece has with the same number of components, in the order of the first piece, and a
/// note on each other. `fields`: of those of this rank.
class CommonFields {
 public:
  using Fields = std::vector<io::Field> PieceArrays::*;
  /// All take part.
  CommonFields(Comm& comm, const std::vector<PieceArrays>& mine, Fields fields, const char* of,
               std::vector<std::string>& notes)
      : fields_(fields) {
    std::string text;
    for (const PieceArrays& piece : mine) {
      text += std::to_string(piece.number) + " 0 0 \n";
      for (const io::Field& field : piece.*fields)
        text += std::to_string(piece.number) + " " + std::to_string(field.components) +
                (field.integer ? " 1 " : " 0 ") + one_line(field.name) + "\n";
    }
    const std::vector<char> said = comm.all_gather(std::span<const char>(text));
    std::istringstream in(std::string(said.begin(), said.end()));
    std::map<std::size_t, std::vector<io::ShareField>> by_piece;
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::size_t piece = 0;
      io::ShareField field;
      words >> piece >> field.components >> field.integer;
      words.get();
      std::getline(words, field.name);
      std::vector<io::ShareField>& list = by_piece[piece];
      const bool is_second =
          std::ranges::any_of(list, [&](const io::ShareField& other) { return other.name == field.name; });
      if (field.components > 0 && !is_second) list.push_back(std::move(field));
    }
    if (by_piece.empty()) return;
    for (io::ShareField field : by_piece.begin()->second) {
      const bool have_all = std::ranges::all_of(by_piece, [&](const auto& piece) {
        return std::ranges::any_of(piece.second, [&](const io::ShareField& other) {
          const bool is_same = other.name == field.name && other.components == field.components;
          if (is_same) field.integer = field.integer && other.integer;
          return is_same;
        });
      });
      if (have_all) shapes_.push_back(std::move(field));
    }
    std::set<std::string> lost;
    for (const auto& [piece, list] : by_piece)
      for (const io::ShareField& field : list)
        if (std::ranges::none_of(shapes_, [&](const auto& kept) { return kept.name == field.name; }))
          lost.insert(field.name);
    for (const std::string& name : lost)
      notes.push_back("array '" + io::shown(name) + "' of " + of + " left out: not all pieces have it");
  }

  /// Of the pieces of this rank, with their numbers.
  KeptRows rows(Comm& comm, const std::vector<PieceArrays>& mine,
                std::vector<std::uint64_t> PieceArrays::*numbers, std::uint64_t n) const {
    NumberedRows some;
    for (const PieceArrays& piece : mine) {
      std::vector<const io::Field*> columns;
      for (const io::ShareField& shape : shapes_)
        columns.push_back(&*std::ranges::find_if(
            piece.*fields_, [&](const io::Field& field) { return one_line(field.name) == shape.name; }));
      for (std::size_t i = 0; i < (piece.*numbers).size(); ++i) {
        some.numbers.push_back((piece.*numbers)[i]);
        some.precedence.push_back(piece.number);
        for (const io::Field* column : columns) {
          const auto k = static_cast<std::size_t>(column->components);
          const auto first = column->values.begin() + static_cast<std::ptrdiff_t>(i * k);
          some.rows.insert(some.rows.end(), first, first + static_cast<std::ptrdiff_t>(k));
        }
      }
    }
    return rows_in_ranges(comm, shapes_, n, some);
  }
  bool empty() const { return shapes_.empty(); }

 private:
  static std::string one_line(std::string name) {
    std::ranges::replace(name, '\n', ' ');
    return name.empty() ? "unnamed" : name;
  }

  Fields fields_;
  std::vector<io::ShareField> shapes_;
};

/// All take part.
void attach_arrays(DistributedMesh& mesh, const std::vector<PieceArrays>& mine,
                   std::vector<std::string>& notes) {
  Comm& comm = mesh.comm();
  const CommonFields of_points(comm, mine, &PieceArrays::point_fields, "points", notes);
  const CommonFields of_cells(comm, mine, &PieceArrays::cell_fields, "cells", notes);
  if (of_points.empty() && of_cells.empty()) return;
  auto arrays = std::make_shared<AttachedArrays>();
  arrays->points = of_points.rows(comm, mine, &PieceArrays::points, mesh.n_vertices());
  arrays->cells = of_cells.rows(comm, mine, &PieceArrays::cells, mesh.n_cells());
  if (!of_points.empty()) {
    NumberedRows places;
    for (const PieceArrays& piece : mine) {
      places.numbers.insert(places.numbers.end(), piece.points.begin(), piece.points.end());
      places.precedence.resize(places.numbers.size(), piece.number);
      for (const Vec3& p : piece.places) places.rows.insert(places.rows.end(), {p.x, p.y, p.z});
    }
    arrays->places = rows_in_ranges(comm, {{"", 3, false}}, mesh.n_vertices(), places);
  }
  mesh.attach_arrays(std::move(arrays));
}

}  // namespace

std::vector<std::string> read_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Comm::InPhase phase(mesh.comm(), Phase::kHandOut);
  const std::vector<std::filesystem::path> pieces = pieces_of(path);
  Incoming incoming(mesh.comm());
  std::vector<std::string> notes;
  std::string names;
  std::vector<PieceArrays> arrays;  // of the pieces of this rank
  const std::size_t n_ranks = mesh.comm().n_ranks();
  for (auto i = static_cast<std::size_t>(mesh.comm().rank()); i < pieces.size(); i += n_ranks) {
    PieceArrays& piece = arrays.emplace_back();
    piece.number = i;
    for (std::string& note : read_piece(pieces[i], mesh.comm().rank(), incoming, names, piece))
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
    if (piece.is_empty) arrays.pop_back();
  }
  incoming.find_owners();
  incoming.even_out();
  incoming.hand_to_owners(incoming);
  for (std::string& note : incoming.make_parts(mesh, path)) notes.push_back(std::move(note));
  attach_arrays(mesh, arrays, notes);
  const auto all = mesh.comm().all_gather(std::span<const char>(names.data(), names.size()));
  io::MeshData named;
  io::read_names({all.data(), all.size()}, named);
  mesh.part().labels().names = std::move(named.names);
  return notes;
}

}  // namespace hfr::mpi
