// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>

#include "IO/VtkSamples.hh"

namespace hfr::io {
namespace {

using samples::expect_same;
using samples::has_note;
using samples::replaced;
using samples::TemporaryFolder;

class VtuVariants : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(All, VtuVariants, testing::Values("ascii", "base64", "appended", "zlib"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(VtuVariants, EverythingAMeshHoldsComesBackBitForBit) {
  const TemporaryFolder folder;
  MeshData mesh = samples::full();
  mesh.point_fields[0].name = "a <b> & \"c\"";
  mesh.cell_fields[1].values[0] = 5e9;  // more than 32 bits
  EXPECT_EQ(write_mesh(folder / "a.vtu", mesh, {false, GetParam()}), std::vector<std::string>{});
  const MeshData read = read_mesh(folder / "a.vtu");
  expect_same(read, mesh);
  EXPECT_TRUE(read.notes.empty()) << read.notes[0];
}

TEST_P(VtuVariants, RandomBitPatternsComeBack) {
  const TemporaryFolder folder;
  const MeshData mesh = samples::random_bits(20000, 2);  // several zlib blocks
  write_mesh(folder / "a.vtu", mesh, {false, GetParam()});
  expect_same(read_mesh(folder / "a.vtu"), mesh);
}

TEST_P(VtuVariants, FieldsWithNamesOfLabelsStayFields) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"Material", 1, false, {3, 4}}};
  mesh.point_fields = {{"labels", 1, false, {1, 2, 3, 4, 5}}, {"Fixed", 1, false, {0, 1, 0, 1, 1}}};
  EXPECT_EQ(write_mesh(folder / "a.vtu", mesh, {false, GetParam()}), std::vector<std::string>{});
  expect_same(read_mesh(folder / "a.vtu"), mesh);
}

TEST_P(VtuVariants, AMeshOfNothingButCellsComesBack) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  std::swap(mesh.cells[1][0], mesh.cells[1][1]);  // of the other orientation: it must stay so
  write_mesh(folder / "a.vtu", mesh, {false, GetParam()});
  expect_same(read_mesh(folder / "a.vtu"), mesh);
}

TEST_P(VtuVariants, AFileCutAnywhereIsRefused) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.vtu", samples::full(), {false, GetParam()});
  const std::string bytes = samples::read_bytes(folder / "a.vtu");
  const std::size_t end = bytes.rfind("</VTKFile>") + 10;
  for (std::size_t length = 1; length < end; ++length) {
    const std::string message = samples::message_for(folder / "cut.vtu", bytes.substr(0, length));
    EXPECT_TRUE(message.starts_with((folder / "cut.vtu").string() + ":")) << length << ": " << message;
  }
  EXPECT_EQ(samples::message_for(folder / "cut.vtu", bytes.substr(0, end)), "");
}

TEST_P(VtuVariants, AByteChangedNeverDoesMoreThanThrow) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.vtu", samples::full(), {false, GetParam()});
  const std::string bytes = samples::read_bytes(folder / "a.vtu");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char value : {'9', '\xff'}) {
      std::string broken = bytes;
      broken[at] = value;
      static_cast<void>(samples::message_for(folder / "b.vtu", broken));
    }
  }
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

/// Builds .vtu files the way other programs write them.
struct Foreign {
  bool big = false;   ///< byte order
  bool wide = false;  ///< header words of 64 bits
  bool appended = false;
  bool coded = true;          ///< base64
  bool header_apart = false;  ///< header and bytes are two base64 texts
  bool zlib = false;
  std::size_t line = 0;  ///< base64 is broken into lines of so many characters

  std::string data = {};  ///< of the <AppendedData>

  template <class T>
  std::string packed(const std::vector<T>& values) const {
    std::string bytes;
    for (const T value : values) {
      auto one = std::bit_cast<std::array<char, sizeof(T)>>(value);
      if (big != (std::endian::native == std::endian::big)) std::reverse(one.begin(), one.end());
      bytes.append(one.data(), one.size());
    }
    return bytes;
  }
  std::string header(const std::vector<std::uint32_t>& words) const {
    return wide ? packed(std::vector<std::uint64_t>(words.begin(), words.end())) : packed(words);
  }
  std::string block(const std::string& bytes) const {
    if (!zlib) {
      const std::string size = header({static_cast<std::uint32_t>(bytes.size())});
      if (!coded) return size + bytes;
      return header_apart ? base64(size) + base64(bytes) : base64(size + bytes);
    }
    constexpr std::size_t kBlock = 16;
    std::vector<std::uint32_t> words = {static_cast<std::uint32_t>((bytes.size() + kBlock - 1) / kBlock),
                                        kBlock, static_cast<std::uint32_t>(bytes.size() % kBlock)};
    std::string all;
    for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
      const std::string part = bytes.substr(at, kBlock);
      std::string out(compressBound(part.size()), '\0');
      uLongf n = out.size();
      EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &n,
                         reinterpret_cast<const Bytef*>(part.data()), part.size()),
                Z_OK);
      all += out.substr(0, n);
      words.push_back(static_cast<std::uint32_t>(n));
    }
    return coded ? base64(header(words)) + base64(all) : header(words) + all;
  }
  template <class T>
  std::string array(const std::string& attributes, const std::vector<T>& values) {
    std::string text = block(packed(values));
    if (appended) {
      const std::string offset = std::to_string(data.size());
      data += text;
      return "<DataArray " + attributes + " format=\"appended\" offset=\"" + offset + "\"/>\n";
    }
    if (line > 0)
      for (std::size_t at = line; at < text.size(); at += line + 1) text.insert(at, 1, '\n');
    return "<DataArray " + attributes + " format=\"binary\">" + text +
           "<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\"/></DataArray>\n";
  }
  /// samples::two_cells() with regions 5 and 6 and a field.
  std::string file() {
    // One after the other: appended data lie in this order.
    std::string cells = array<std::int64_t>("type=\"Int64\" Name=\"connectivity\"", {0, 1, 2, 3, 1, 2, 3, 4});
    cells += array<std::uint16_t>("type=\"UInt16\" Name=\"offsets\"", {4, 8});
    cells += array<std::uint8_t>("type=\"UInt8\" Name=\"types\"", {10, 10});
    const std::string points = array<float>("type=\"Float32\" NumberOfComponents=\"3\"",
                                            {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
    std::string of_cells = array<std::int16_t>("type=\"Int16\" Name=\"Material\"", {5, 6});
    of_cells += array<double>("type=\"Float64\" Name=\"t\" NumberOfComponents=\"\"", {0.1, 0.2});
    std::string text = "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"";
    text += big ? "BigEndian\"" : "LittleEndian\"";
    if (wide) text += " header_type=\"UInt64\"";
    if (zlib) text += " compressor=\"vtkZLibDataCompressor\"";
    text += ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Cells>\n" + cells +
            "</Cells>\n<Points>\n" + points + "</Points>\n<CellData Scalars=\"t\">\n" + of_cells +
            "</CellData>\n</Piece>\n</UnstructuredGrid>\n";
    if (appended)
      text += std::string("<AppendedData encoding=\"") + (coded ? "base64" : "raw") + "\">\n  _" + data +
              "\n</AppendedData>\n";
    return text + "</VTKFile>\n";
  }
};

void expect_readable(Foreign foreign) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.vtu", foreign.file());
  const MeshData mesh = read_mesh(folder / "a.vtu");
  EXPECT_EQ(mesh.points, samples::two_cells().points);
  EXPECT_EQ(mesh.cells, samples::two_cells().cells);
  EXPECT_EQ(mesh.regions, (std::vector<int>{5, 6}));
  ASSERT_EQ(mesh.cell_fields.size(), 1u);
  EXPECT_EQ(mesh.cell_fields[0].values, (std::vector<double>{0.1, 0.2}));
}

TEST(Vtu, FilesOfOtherProgramsAreReadInEveryCoding) {
  for (const bool big : {false, true}) {
    for (const bool wide : {false, true}) {
      for (const bool zlib : {false, true}) {
        expect_readable({.big = big, .wide = wide, .zlib = zlib});
        expect_readable({.big = big, .wide = wide, .appended = true, .zlib = zlib});
        expect_readable({.big = big, .wide = wide, .appended = true, .coded = false, .zlib = zlib});
        expect_readable({.big = big, .wide = wide, .zlib = zlib, .line = 5});
      }
      expect_readable({.big = big, .wide = wide, .header_apart = true});
      expect_readable({.big = big, .wide = wide, .appended = true, .header_apart = true});
    }
  }
}

TEST(Vtu, AnyCodingCutOrChangedNeverDoesMoreThanThrow) {
  const TemporaryFolder folder;
  for (Foreign foreign : {Foreign{.zlib = true}, Foreign{.appended = true},
                          Foreign{.appended = true, .coded = false, .zlib = true}}) {
    const std::string good = foreign.file();
    const std::size_t end = good.rfind("</VTKFile>") + 10;
    for (std::size_t i = 1; i < end; ++i) {
      EXPECT_NE(samples::message_for(folder / "a.vtu", good.substr(0, i)), "") << i;
      std::string broken = good;
      broken[i] = static_cast<char>(broken[i] ^ 0x41);
      static_cast<void>(samples::message_for(folder / "a.vtu", broken));
    }
  }
}

TEST(Vtu, CorruptCompressedDataAreRefused) {
  const TemporaryFolder folder;
  Foreign foreign{.appended = true, .coded = false, .zlib = true};
  std::string bytes = foreign.file();
  const std::size_t begin = bytes.find("_", bytes.find("<AppendedData")) + 1;
  const auto message = [&](std::size_t at, char value) {
    std::string broken = bytes;
    broken[begin + at] = value;
    return samples::short_message_for(folder / "a.vtu", broken);
  };
  // Connectivity: 64 bytes in 4 blocks of 16: words 4, 16, 0, then four sizes, then the blocks.
  const std::string place = ": at byte " + std::to_string(begin) + ": array 'connectivity': ";
  EXPECT_EQ(message(28 + 4, '\x55'), place + "block 0 is not the zlib data it should be");
  EXPECT_EQ(message(4, '\x0f'), place + "block 0 is not the zlib data it should be");
  EXPECT_EQ(message(3, '\x7f'), place + "the header announces more blocks than there are");
  EXPECT_EQ(message(6, '\x7f'), place + "a block is too short for what it should hold");
  EXPECT_EQ(message(15, '\x7f'), place + "the header announces more bytes than there are");
}

TEST(Vtu, BadBase64IsRefused) {
  const TemporaryFolder folder;
  const std::string good = Foreign{}.file();
  const std::size_t data = good.find("format=\"binary\">") + 16;
  const auto message = [&](std::size_t at, char value) {
    std::string broken = good;
    broken[data + at] = value;
    return samples::short_message_for(folder / "a.vtu", broken);
  };
  const std::string place = ":5: <DataArray Name=\"connectivity\">: ";
  EXPECT_EQ(message(20, '*'), place + "this is not base64 text");
  EXPECT_EQ(message(20, '='), place + "this is not base64 text");
  EXPECT_EQ(message(4, '/'), place + "the header announces more bytes than there are");
}

constexpr const char* kText = R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0">
<!-- a comment -->
<UnstructuredGrid>
<FieldData><Array type="String" Name="x" NumberOfTuples="1" format="ascii">65 0</Array></FieldData>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0
1 0 0
0 1 0
0 0 1
</DataArray></Points>
<Cells>
<DataArray type="Int32" Name="connectivity" format="ascii">0 1
2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray>
</Cells>
<PointData>
<DataArray type="Float64" Name="f" format="ascii">nan -1e-320 +3 1.5D2</DataArray>
</PointData>
</Piece>
</UnstructuredGrid>
</VTKFile>
)";

TEST(Vtu, TextIsReadWithWhatNumbersMayLookLike) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.vtu", kText);
  const MeshData mesh = read_mesh(folder / "a.vtu");
  ASSERT_EQ(mesh.point_fields.size(), 1u);
  const std::vector<double>& f = mesh.point_fields[0].values;
  EXPECT_NE(f[0], f[0]);
  EXPECT_EQ(f[1], -1e-320);
  EXPECT_EQ(f[2], 3);
  EXPECT_EQ(f[3], 150);
}

TEST(Vtu, LineEndsOfWindowsAreTolerated) {
  const TemporaryFolder folder;
  std::string text;
  for (const char c : std::string(kText)) text += c == '\n' ? "\r\n" : std::string(1, c);
  samples::write_bytes(folder / "a.vtu", text);
  EXPECT_EQ(read_mesh(folder / "a.vtu").cells.size(), 1u);
}

TEST(Vtu, WhatIsBrokenIsNamedWithItsLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& from, const std::string& to) {
    return samples::short_message_for(folder / "a.vtu", replaced(kText, from, to));
  };
  EXPECT_EQ(
      message("2 3<", "2 4<"),
      ":14: <DataArray Name=\"connectivity\">: entry 3: vertex 4 is out of range (the piece has 4 points)");
  EXPECT_EQ(message("2 3<", "2<"),
            ":14: <DataArray Name=\"connectivity\">: 4 numbers are needed, but the text is too short");
  EXPECT_EQ(message("2 3<", "2 3 0<"),
            ":15: array 'connectivity': expected 4 numbers and no more, found '0'");
  EXPECT_EQ(message("2 3<", "2 x<"), ":15: array 'connectivity': expected 4 numbers and no more, found 'x'");
  EXPECT_EQ(message("2 3<", "234<"), ":15: array 'connectivity': 4 numbers are needed, but there are fewer");
  EXPECT_EQ(message(">10<", ">12<"),
            ":6: cell 0: cells of type VTK_HEXAHEDRON are not supported: only tetrahedra are");
  EXPECT_EQ(message(">10<", ">300<"), ":17: <DataArray Name=\"types\">: unknown VTK cell type 300");
  EXPECT_EQ(message("0 1 0\n", "0 inf 0\n"), ":7: <DataArray>: point 2: a coordinate is not finite");
  EXPECT_EQ(message("type=\"UnstructuredGrid\"", "type=\"PolyData\""),
            ":2: <VTKFile>: type \"PolyData\" is not supported: only UnstructuredGrid is");
  EXPECT_EQ(message("NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\""),
            ":6: <Piece>: attribute NumberOfPoints must be a number, not '-4'");
  EXPECT_EQ(message("NumberOfPoints=\"4\"", "NumberOfPoints=\"6148914691236517206\"").substr(0, 4), ":6: ");
  EXPECT_EQ(message("NumberOfPoints=\"4\"", "NumberOfPoints=\"6148914691236517205\"").substr(0, 4), ":7: ");
  EXPECT_EQ(
      message("version=\"1.0\">", "version=\"1.0\" compressor=\"vtkLZ4DataCompressor\">"),
      ":2: <VTKFile>: compressor \"vtkLZ4DataCompressor\" is not supported: only vtkZLibDataCompressor is");
  EXPECT_EQ(message("Name=\"types\"", "Name=\"tapes\""), ":13: <Cells>: there is no array 'types' in it");
  EXPECT_EQ(message("Int32\" Name=\"offsets\"", "Float32\" Name=\"offsets\""),
            ":16: <DataArray Name=\"offsets\">: this array must hold integers");
  EXPECT_EQ(message("format=\"ascii\">4", "format=\"appended\" offset=\"0\">4"),
            ":16: <DataArray Name=\"offsets\">: there are no appended data");
}

TEST(Vtu, MessagesAreShortWhateverTheFileSays) {
  const TemporaryFolder folder;
  const std::string long_word(3000, 'x');
  const std::string text = kText;
  for (const std::string& broken :
       {replaced(text, "version=\"1.0\">", "version=\"1.0\" compressor=\"" + long_word + "\">"),
        replaced(text, "type=\"Float64\"", "type=\"" + long_word + "\""),
        replaced(text, "NumberOfPoints=\"4\"", "NumberOfPoints=\"" + long_word + "\""),
        replaced(text, "type=\"UnstructuredGrid\"", "type=\"" + long_word + "\"")})
    EXPECT_LT(samples::short_message_for(folder / "a.vtu", broken).size(), 200U);
}

TEST(Vtu, AnOffsetBehindTheAppendedDataIsRefused) {
  const TemporaryFolder folder;
  Foreign foreign{.appended = true, .coded = false};
  const std::string good = foreign.file();
  EXPECT_EQ(samples::short_message_for(folder / "a.vtu", replaced(good, "offset=\"0\"", "offset=\"9999\"")),
            ":5: <DataArray Name=\"connectivity\">: offset 9999 is behind the appended data");
  // A byte off: the length is read from the wrong place.
  EXPECT_NE(samples::short_message_for(folder / "a.vtu", replaced(good, "offset=\"0\"", "offset=\"1\"")), "");
}

/// One cell has one byte of types: header and byte end as a header of its own does, but for a sign.
TEST(Vtu, AnArrayOfOneByteIsReadInEveryCoding) {
  const TemporaryFolder folder;
  for (const bool appended : {false, true})
    for (const bool wide : {false, true})
      for (const bool apart : {false, true}) {
        Foreign f{.wide = wide, .appended = appended, .header_apart = apart};
        std::string cells = f.array<std::int64_t>("type=\"Int64\" Name=\"connectivity\"", {0, 1, 2, 3});
        cells += f.array<std::int8_t>("type=\"Int8\" Name=\"offsets\"", {4});
        cells += f.array<std::uint8_t>("type=\"UInt8\" Name=\"types\"", {10});
        const std::string points =
            f.array<float>("type=\"Float32\" NumberOfComponents=\"3\"", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
        samples::write_bytes(
            folder / "a.vtu",
            std::string("<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"") +
                (wide ? " header_type=\"UInt64\"" : "") +
                "><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Cells>" + cells +
                "</Cells><Points>" + points + "</Points></Piece></UnstructuredGrid>" +
                (appended ? "<AppendedData encoding=\"base64\">_" + f.data + "</AppendedData>" : "") +
                "</VTKFile>");
        EXPECT_EQ(read_mesh(folder / "a.vtu").cells.size(), 1u) << appended << wide << apart;
      }
}

TEST(Vtu, BlocksThatHoldMoreThanIsNeededAreNotUnpacked) {
  const TemporaryFolder folder;
  Foreign foreign{.appended = true, .coded = false, .zlib = true};
  std::string bytes = foreign.file();
  const std::size_t begin = bytes.find("_", bytes.find("<AppendedData")) + 1;
  bytes[begin + 8] = 8;    // the last of the four blocks of the connectivity has 8 bytes, not 16
  bytes[begin + 4] = 100;  // and the others 100
  EXPECT_EQ(samples::short_message_for(folder / "a.vtu", bytes),
            ": at byte " + std::to_string(begin) +
                ": array 'connectivity': its blocks hold 308 bytes, and 64 are needed");
}

TEST(Vtu, PiecesAreJoined) {
  const TemporaryFolder folder;
  std::string text = kText;
  const std::size_t begin = text.find("<Piece");
  const std::size_t end = text.find("</Piece>") + 9;
  const std::string piece = text.substr(begin, end - begin);
  text.insert(
      end, replaced(piece, "</PointData>",
                    "<DataArray type=\"Int8\" Name=\"g\" format=\"ascii\">1 2 3 4</DataArray></PointData>"));
  text.insert(end, "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>\n");
  samples::write_bytes(folder / "a.vtu", text);
  const MeshData mesh = read_mesh(folder / "a.vtu");
  EXPECT_EQ(mesh.points.size(), 8u);
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {4, 5, 6, 7}}));
  ASSERT_EQ(mesh.point_fields.size(), 1u);
  EXPECT_EQ(mesh.point_fields[0].values.size(), 8u);
  EXPECT_TRUE(has_note(mesh, "array 'g' dropped: not all pieces have it"));
}

TEST(Vtu, APieceWithoutCellsNeedNotNameTheirArrays) {
  const TemporaryFolder folder;
  const std::string whole = replaced(
      kText, "</PointData>",
      "</PointData><CellData><DataArray type=\"Int8\" Name=\"g\" format=\"ascii\">7</DataArray></CellData>");
  const std::size_t begin = whole.find("<Piece");
  const std::string bare =
      "<Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points><DataArray type=\"Float64\" "
      "NumberOfComponents=\"3\" format=\"ascii\">5 6 7</DataArray></Points></Piece>\n";
  for (const std::size_t at : {begin, whole.find("</Piece>") + 9}) {
    std::string text = whole;
    samples::write_bytes(folder / "a.vtu", text.insert(at, bare));
    const MeshData mesh = read_mesh(folder / "a.vtu");
    EXPECT_EQ(mesh.points.size(), 5U);
    ASSERT_EQ(mesh.cell_fields.size(), 1U) << at;
    EXPECT_EQ(mesh.cell_fields[0].values, std::vector<double>{7}) << at;
    EXPECT_TRUE(mesh.point_fields.empty()) << "there is no value for the one point";
    EXPECT_TRUE(has_note(mesh, "dropped: not all pieces have it"));
  }
}

TEST(Vtu, FieldsOfNothingKeepTheirNames) {
  const TemporaryFolder folder;
  MeshData mesh;
  mesh.points = {{1, 2, 3}};
  mesh.point_fields = {{"f", 1, false, {4}}};
  mesh.cell_fields = {{"g", 3, false, {}}};
  EXPECT_EQ(write_mesh(folder / "a.vtu", mesh), std::vector<std::string>{});
  expect_same(read_mesh(folder / "a.vtu"), mesh);
}

TEST(Vtu, AnUnknownVariantIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_mesh(folder / "a.vtu", samples::two_cells(), {false, "lzma"}), InvalidInput);
}

}  // namespace
}  // namespace hfr::io
