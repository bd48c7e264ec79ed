// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/AttachedArrays.hh"

#include <algorithm>
#include <cmath>

#include "Distributed/AskOwners.hh"
#include "Distributed/Buffer.hh"
#include "Distributed/InParts.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/PartLabels.hh"
#include "HalfFace/Errors.hh"
#include "IO/FieldLayout.hh"
#include "IO/Words.hh"

namespace hfr::mpi {
namespace {

std::size_t width_of(const std::vector<io::ShareField>& fields) {
  std::size_t width = 0;
  for (const io::ShareField& field : fields) width += static_cast<std::size_t>(field.components);
  return width;
}

/// As a mesh in shared memory would keep them.
bool can_be_integers(const io::ShareField& field) {
  return field.integer &&
         io::with_field_type(field.components, true, []<class T>() { return io::Layout<T>::kInteger; });
}

}  // namespace

KeptRows::KeptRows(Comm& comm, std::vector<io::ShareField> fields, Slices slices, std::vector<double> rows)
    : fields_(std::move(fields)),
      width_(width_of(fields_)),
      slices_(std::move(slices)),
      rows_(std::move(rows)) {
  std::vector<std::uint64_t> n_others(fields_.size(), 0);  // values that are no integers
  std::size_t first = 0;
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    const auto n = static_cast<std::size_t>(fields_[f].components);
    for (std::size_t at = first; fields_[f].integer && at < rows_.size(); at += width_)
      for (std::size_t k = 0; k < n; ++k) {
        const double value = rows_[at + k];
        if (!(std::abs(value) <= 0x1p53) || value != std::trunc(value)) ++n_others[f];
      }
    first += n;
  }
  comm.sum(n_others);
  for (std::size_t f = 0; f < fields_.size(); ++f)
    fields_[f].integer = can_be_integers(fields_[f]) && n_others[f] == 0;
}

std::vector<io::Field> KeptRows::fields_of(Comm& comm, std::span<const std::uint64_t> sources) const {
  std::vector<io::Field> fields;
  if (fields_.empty()) return fields;
  struct Row {
    std::uint64_t number = 0;
    std::size_t owner = 0;
  };
  std::vector<Row> wanted;
  wanted.reserve(sources.size());
  for (std::uint64_t number : sources) wanted.push_back({number, slices_.rank_of(number)});
  const std::uint64_t begin = slices_.begin(comm.rank());
  const std::vector<double> rows =
      ask_owners<double>(comm, wanted, width_, [&](std::uint64_t number, std::vector<double>& values) {
        const auto row = rows_.begin() + static_cast<std::ptrdiff_t>((number - begin) * width_);
        values.insert(values.end(), row, row + static_cast<std::ptrdiff_t>(width_));
      });
  std::size_t first = 0;
  for (const io::ShareField& shape : fields_) {
    const auto n = static_cast<std::size_t>(shape.components);
    io::Field& field = fields.emplace_back(io::Field{shape.name, shape.components, shape.integer, {}});
    field.values.reserve(n * sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const auto value = rows.begin() + static_cast<std::ptrdiff_t>(i * width_ + first);
      field.values.insert(field.values.end(), value, value + static_cast<std::ptrdiff_t>(n));
    }
    first += n;
  }
  return fields;
}

AttachedToPoints attached_to_points(DistributedMesh& mesh) {
  AttachedToPoints attached;
  if (!mesh.arrays()) return attached;
  for (const io::ShareField& field : mesh.arrays()->points.fields()) attached.names.push_back(field.name);
  const std::vector<VertexHandle> vertices = own_vertices(mesh);
  std::vector<std::uint64_t> sources;
  sources.reserve(vertices.size());
  for (VertexHandle v : vertices) sources.push_back(mesh.source(v));
  const std::vector<io::Field> places = mesh.arrays()->places.fields_of(mesh.comm(), sources);
  std::uint64_t n = 0;
  for (std::size_t i = 0; i < vertices.size() && !places.empty(); ++i) {
    const double* const was = places.front().values.data() + 3 * i;
    if (mesh.part().point(vertices[i]) != Vec3{was[0], was[1], was[2]}) ++n;
  }
  attached.n_elsewhere = mesh.comm().sum(n);
  return attached;
}

std::vector<std::string> AttachedArrays::notes_on_leaving_out() const {
  std::vector<std::string> notes;
  const auto add = [&](const KeptRows& rows, const char* of) {
    for (const io::ShareField& field : rows.fields())
      notes.push_back("array '" + io::shown(field.name) + "' of " + of +
                      " left out: meshes in parts write arrays as .vtu and .pvtu");
  };
  add(points, "points");
  add(cells, "cells");
  return notes;
}

KeptRows rows_in_ranges(Comm& comm, std::vector<io::ShareField> fields, std::uint64_t n,
                        const NumberedRows& mine) {
  const std::size_t width = width_of(fields), n_ranks = comm.n_ranks();
  Slices slices = Slices::even(n_ranks, n);
  std::vector<NumberedRows> to(n_ranks);
  for (std::size_t i = 0; i < mine.numbers.size(); ++i) {
    NumberedRows& some = to[slices.rank_of(mine.numbers[i])];
    some.numbers.push_back(mine.numbers[i]);
    some.precedence.push_back(mine.precedence[i]);
    const auto row = mine.rows.begin() + static_cast<std::ptrdiff_t>(i * width);
    some.rows.insert(some.rows.end(), row, row + static_cast<std::ptrdiff_t>(width));
  }
  std::vector<Packer> packed(n_ranks);
  for (std::size_t r = 0; r < n_ranks; ++r) {
    if (to[r].numbers.empty()) continue;
    packed[r].put_all(to[r].numbers);
    packed[r].put_all(to[r].precedence);
    packed[r].put_all(std::exchange(to[r].rows, {}));
  }
  const std::uint64_t begin = slices.begin(comm.rank());
  const std::size_t size = slices.size(comm.rank());
  std::vector<double> rows(width * size, 0.0);
  std::vector<std::uint64_t> from(size, kNoNumber);
  for (const Comm::Message& message : comm.exchange(packed)) {
    Unpacker in(message.bytes);
    const auto numbers = in.get_all<std::uint64_t>(), precedence = in.get_all<std::uint64_t>();
    const auto came = in.get_all<double>();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto at = static_cast<std::size_t>(numbers[i] - begin);
      if (precedence[i] >= from[at]) continue;
      from[at] = precedence[i];
      std::copy_n(came.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                  rows.begin() + static_cast<std::ptrdiff_t>(at * width));
    }
  }
  return KeptRows(comm, std::move(fields), std::move(slices), std::move(rows));
}

}  // namespace hfr::mpi
