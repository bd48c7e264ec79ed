// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_IO_VTK_SAMPLES_HH
#define HFR_UNITTESTS_IO_VTK_SAMPLES_HH

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "HalfFace/Errors.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/MeshFile.hh"

namespace hfr::io::samples {

/// Points, elements, labels, names, fixed vertices and fields are the same, doubles to the last bit.
inline void expect_same(const MeshData& a, const MeshData& b) {
  EXPECT_TRUE(same_bits(a.points, b.points));
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.regions, b.regions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.triangle_labels, b.triangle_labels);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.edge_labels, b.edge_labels);
  EXPECT_EQ(a.vertex_labels, b.vertex_labels);
  EXPECT_EQ(a.fixed_vertices, b.fixed_vertices);
  EXPECT_EQ(a.names, b.names);
  const auto expect_same_fields = [](const std::vector<Field>& x, const std::vector<Field>& y) {
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(x[i].name, y[i].name);
      EXPECT_EQ(x[i].components, y[i].components);
      EXPECT_EQ(x[i].integer, y[i].integer) << x[i].name;
      EXPECT_TRUE(same_bits(x[i].values, y[i].values)) << x[i].name;
    }
  };
  expect_same_fields(a.point_fields, b.point_fields);
  expect_same_fields(a.cell_fields, b.cell_fields);
}

/// What is said when `bytes` are read as a file of this name; "" when they can be read.
inline std::string message_for(const std::filesystem::path& path, const std::string& bytes) {
  write_bytes(path, bytes);
  try {
    read_mesh(path);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// Message without the path, which differs from run to run.
inline std::string short_message_for(const std::filesystem::path& path, const std::string& bytes) {
  const std::string message = message_for(path, bytes);
  return message.starts_with(path.string()) ? message.substr(path.string().size()) : message;
}

/// `text` with the first `from` replaced by `to`; fails when there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

inline bool has_note(const MeshData& mesh, const std::string& part) {
  return std::any_of(mesh.notes.begin(), mesh.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace hfr::io::samples

#endif
