// SPDX-License-Identifier: BSD-3-Clause
// Arrays of files on points and cells, over runs of meshes in parts: values stand where shared memory has
// them.
#include "Distributed/AttachedArrays.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "Distributed/CellOrder.hh"
#include "Distributed/Labelled.hh"
#include "Distributed/Sources.hh"

namespace hfr::test {
namespace {

/// With reals, vectors, integers of 32 and 64 bits, and some that a mesh keeps as reals for their number of
/// components, or for one value.
io::MeshData with_arrays(io::MeshData data, std::uint64_t seed) {
  const auto field = [&](const char* name, int components, bool integer, std::size_t n, double unit) {
    io::Field made{name, components, integer, {}};
    for (std::size_t i = 0; i < n * static_cast<std::size_t>(components); ++i) {
      const double value = generate::random_unit(seed + made.name.size(), i) * unit;
      made.values.push_back(integer ? std::floor(value) : value);
    }
    return made;
  };
  const std::size_t n = data.points.size(), m = data.cells.size();
  data.point_fields = {field("heat", 1, false, n, 1),  field("velocity", 3, false, n, 9),
                       field("id", 1, true, n, 1e12),  field("count", 5, true, n, 100),
                       field("mark", 1, true, n, 100), field("huge", 1, true, n, 100)};
  data.point_fields[4].values.back() = 1e10;    // one that needs 64 bits
  data.point_fields[5].values.back() = 0x1p60;  // and one that no double of its size is sure to hold
  data.cell_fields = {field("stress", 6, false, m, 1e-3), field("layer", 1, true, m, 7)};
  return data;
}

ImproveOptions options_of(int which) {
  ImproveOptions options;
  options.policy = {};
  if (which != 1) options.passes_only = true;
  if (which == 1) options.min_dihedral = 14;
  if (which == 2) options = polish_towards(22);
  if (which == 3) options.surface.mode = SurfaceMode::kFlat;
  if (which == 4) options.surface.mode = SurfaceMode::kFree;
  return options;
}

std::vector<std::string> names_of(const std::vector<io::ShareField>& fields) {
  std::vector<std::string> names;
  for (const io::ShareField& field : fields) names.push_back(field.name);
  return names;
}

/// Meshes with labels, a torn one among them, by default, with goals, and with a surface that may change;
/// parts are cut anew before the run, and after it.
TEST(AttachedArrays, RunsHaveTheBytesOfSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  std::uint64_t n_changed = 0, n_elsewhere = 0;
  for (int which = 0; which < 5; ++which)
    for (const std::uint64_t seed : {1U, 2U}) {
      const bool is_torn = which == 1 && seed == 2;
      if (comm.rank() == 0)
        io::write_mesh(
            path,
            with_arrays(labelled(is_torn ? torn(4, 0.45, 0.8, 3) : valid_box(4, 0.4, seed), seed, {}), seed));
      comm.sum(0);
      bool has_run = false;
      const Result shared =
          expect_same_run(comm, folder, path, options_of(which), [&](mpi::DistributedMesh& parts) {
            const mpi::AttachedToPoints attached = mpi::attached_to_points(parts);
            EXPECT_THAT(attached.names,
                        testing::ElementsAre("heat", "velocity", "id", "count", "mark", "huge"));
            EXPECT_TRUE(has_run || attached.n_elsewhere == 0);
            n_elsewhere += attached.n_elsewhere;
            has_run = true;
            std::vector<int> to(parts.part().n_vertices());
            for (std::size_t v = 0; v < to.size(); ++v)
              to[v] = static_cast<int>(mix64(seed ^ parts.number(V(v)) / 10) %
                                       static_cast<std::uint64_t>(comm.size()));
            parts.change_owners(to);
          });
      n_changed += shared.changed ? 1 : 0;
    }
  EXPECT_GE(comm.from_first(n_changed), 8U);
  EXPECT_GT(n_elsewhere, 0U);
}

/// A run that numbers cells anew first, and a part that comes back to its copy.
TEST(AttachedArrays, StayWithCellsThatGetOtherNumbers) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, with_arrays(io::disassemble(scattered_box(17)), 3));
  comm.sum(0);
  const ImproveOptions options = one_iteration();
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, path);
  EXPECT_TRUE(mpi::is_scattered(parts)) << "the test shows nothing";
  expect_same_run(comm, folder, path, options);
  const auto copy = parts.copy();
  mpi::improve(parts, options);
  EXPECT_GT(mpi::attached_to_points(parts).n_elsewhere, 0U);
  parts.put_back(*copy);
  EXPECT_EQ(mpi::attached_to_points(parts).n_elsewhere, 0U);
}

/// From pieces as well, whoever has written them.
TEST(AttachedArrays, GoThroughPieces) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu", pieces = folder.path() / "pieces.pvtu";
  if (comm.rank() == 0) io::write_mesh(path, with_arrays(labelled(valid_box(6, 0.3, 4), 4, {}), 4));
  comm.sum(0);
  mpi::DistributedMesh first(comm), second(comm);
  mpi::read_ranges(first, path);
  mpi::write_vtu(first, folder.path() / "first.vtu");
  mpi::write_pvtu(first, pieces);
  EXPECT_THAT(mpi::read_pvtu(second, pieces), testing::IsEmpty());
  mpi::write_vtu(second, folder.path() / "second.vtu");
  if (comm.rank() == 0) {
    io::write(folder.path() / "whole.vtu", io::read(path));
    const std::string whole = bytes_of(folder.path() / "whole.vtu");
    EXPECT_TRUE(bytes_of(folder.path() / "first.vtu") == whole);
    EXPECT_TRUE(bytes_of(folder.path() / "second.vtu") == whole);
    const std::string index = bytes_of(pieces);
    EXPECT_THAT(index, testing::HasSubstr("type=\"Float64\" Name=\"velocity\" NumberOfComponents=\"3\""));
    EXPECT_THAT(index, testing::HasSubstr("type=\"Int32\" Name=\"layer\" NumberOfComponents=\"1\""));
    // The piece with that value is one of several.
    EXPECT_THAT(index, testing::HasSubstr("type=\"Int64\" Name=\"mark\" NumberOfComponents=\"1\""));
    for (int r = 0; r < comm.size(); ++r)
      EXPECT_THAT(bytes_of(mpi::part_path(pieces, r)), testing::HasSubstr("type=\"Int64\" Name=\"mark\""));
  }
  comm.sum(0);
}

/// Two pieces with a different array each, and one that both have.
TEST(AttachedArrays, OnlyWhatAllPiecesHaveIsRead) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  if (comm.rank() == 0) {
    for (const double k : {0.0, 1.0}) {
      io::MeshData data;
      data.points = {{0, 0, k}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1 + 2 * k}};
      data.points[0] = {0.2, 0.2, 0.1};
      data.cells = {{0, 1, 2, 3}};
      const double far = 3 + k;
      data.point_fields = {{"number", 1, false, {0, 1, 2, far}},
                           {"heat", 1, false, {10 + k, 11 + k, 12 + k, 13 + k}},
                           {k == 0 ? "one" : "two", 1, false, {0, 0, 0, 0}}};
      data.cell_fields = {{"number", 1, false, {k}}};
      io::write_mesh(folder.path() / (k == 0 ? "a.vtu" : "b.vtu"), data);
    }
    std::ofstream(folder.path() / "in.pvtu")
        << "<PUnstructuredGrid><Piece Source=\"a.vtu\"/><Piece Source=\"b.vtu\"/></PUnstructuredGrid>";
  }
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  const std::vector<std::string> notes = mpi::read_pvtu(parts, folder.path() / "in.pvtu");
  EXPECT_THAT(notes, testing::IsSupersetOf({"array 'one' of points left out: not all pieces have it",
                                            "array 'two' of points left out: not all pieces have it"}));
  ASSERT_TRUE(parts.arrays());
  EXPECT_THAT(names_of(parts.arrays()->points.fields()), testing::ElementsAre("heat"));
  const std::vector<std::uint64_t> all = {0, 1, 2, 3, 4};
  const std::vector<io::Field> fields = parts.arrays()->points.fields_of(comm, all);
  ASSERT_EQ(fields.size(), 1U);
  EXPECT_THAT(fields[0].values, testing::ElementsAre(10, 11, 12, 13, 14))
      << "of the first piece that has them";
}

/// As the reader for shared memory says of them.
TEST(AttachedArrays, ValuesOfOtherElementsThanCellsAreNamed) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  io::MeshData data = io::disassemble(valid_box(2, 0, 1));
  data.triangles = {{data.cells[0][0], data.cells[0][1], data.cells[0][2]}};
  data.triangle_labels = {7};
  data.cell_fields = {{"heat", 1, false, std::vector<double>(data.cells.size(), 1.5)}};
  if (comm.rank() == 0) {
    io::write_mesh(path, data);
    std::string bytes = bytes_of(path);  // a triangle's value is 0, and the last thing before the end
    const double value = 2.5;
    std::memcpy(bytes.data() + bytes.find("\n</AppendedData>") - sizeof(value), &value, sizeof(value));
    std::ofstream(path, std::ios::binary) << bytes;
  }
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  const std::vector<std::string> notes = mpi::read_ranges(parts, path);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], testing::HasSubstr("cell field 'heat': only its values on tetrahedra are kept"));
  EXPECT_EQ(notes, io::read_mesh(path).notes);
}

/// Whose values a cell and a vertex have is the same on all ranks that hold them.
TEST(AttachedArrays, AnotherRowThanTheOwnersIsFound) {
  mpi::Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) GTEST_SKIP() << "one rank holds nothing for others";
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, with_arrays(io::disassemble(valid_box(4, 0.2, 1)), 1));
  comm.sum(0);
  for (const bool of_cell : {true, false}) {
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, path);
    ASSERT_TRUE(mpi::check(parts).is_good);
    TetMesh& part = parts.part();
    if (comm.rank() == 0)
      for (CellHandle c : part.cells()) {
        if (parts.is_own(c)) continue;
        if (of_cell)
          mpi::sources::set(part, c, 1000);
        else
          for (VertexHandle v : part.cell(c).v)
            if (!parts.is_own(v)) mpi::sources::set(part, v, 1000);
        break;
      }
    const mpi::PartsCheck checked = mpi::check(parts);
    EXPECT_FALSE(checked.is_good);
    EXPECT_THAT(checked.message, testing::HasSubstr(of_cell ? "whose values cell" : "vertex"));
  }
}

/// What a format does not take along is named once it is written.
TEST(AttachedArrays, OtherFormatsSayWhatTheyLeaveOut) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.vtu";
  if (comm.rank() == 0) io::write_mesh(path, with_arrays(io::disassemble(valid_box(3, 0.2, 1)), 1));
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  EXPECT_THAT(mpi::read_ranges(parts, path), testing::IsEmpty());
  for (const char* const name : {"out.msh", "out.mesh"})
    EXPECT_THAT(mpi::write_ranges(parts, folder.path() / name),
                testing::IsSupersetOf(
                    {"array 'heat' of points left out: meshes in parts write arrays as .vtu and .pvtu",
                     "array 'layer' of cells left out: meshes in parts write arrays as .vtu and .pvtu"}));
  EXPECT_THAT(
      mpi::write_medit_parts(parts, folder.path() / "out.mesh"),
      testing::Contains("array 'heat' of points left out: meshes in parts write arrays as .vtu and .pvtu"));
}

}  // namespace
}  // namespace hfr::test
