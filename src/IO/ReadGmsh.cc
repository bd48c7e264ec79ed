// SPDX-License-Identifier: BSD-3-Clause
// What all versions of the format share: header, order of sections, names and fields.
#include "IO/ReadGmsh.hh"

#include <cmath>
#include <cstring>

#include "IO/Formats.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace gmsh {
namespace {

/// Goes to the line that closes the section.
template <class Source>
void skip_section(Source& in, const std::string& name) {
  const std::string closing = "$End" + name;
  const std::size_t at = find_closing(in.text(), closing, in.offset());
  if (at == std::string_view::npos)
    in.fail("section $" + shown(name) + " is not closed by " + shown(closing));
  in.seek(at);
}

template <class Source>
std::size_t data_tags(Source& in, const char* what) {
  return bounded(in, in.ascii_count(), 2, what);
}

/// $NodeData and $ElementData. Their tags are 32-bit in all versions.
template <class Source>
void read_data(Source& in, bool on_points, Collector& mesh) {
  if (!mesh.has_elements()) in.fail("values stand before $Nodes and $Elements");
  const DataHeader header = read_data_header(in);
  mesh.begin_field(on_points, header.name, header.components, header.step);
  for (std::size_t k = 0; k < header.count; ++k) {
    const int tag = in.int32("the tag of a value");
    const Index item = mesh.find_item(tag);
    if (item == TagIndex::kNone) {
      if (on_points) in.fail("there is no node " + std::to_string(tag));
      mesh.skip_value();
      for (int c = 0; c < header.components; ++c) in.any_real();
      continue;
    }
    for (int c = 0; c < header.components; ++c) mesh.set_value(item, c, in.any_real());
  }
}

template <class Source>
class Reader {
 public:
  Reader(Source in, Version version) : in_(std::move(in)), version_(version) {}

  MeshData read() {
    while (!in_.at_end()) {
      const std::string_view word = in_.word();
      if (!word.starts_with('$')) {
        in_.fail("expected the name of a section, such as $Nodes, and found '" + shown(word) + "'");
      }
      const std::string name(word.substr(1));
      if (!read_section(name)) skip_section(in_, name);
      close_section(in_, name);
    }
    if (!mesh_.has_nodes()) in_.fail("the file ends without a $Nodes section");
    if (!mesh_.has_elements()) in_.fail("the file ends without an $Elements section");
    return mesh_.finish();
  }

 private:
  /// False when the section is one to skip.
  bool read_section(const std::string& name) {
    if (name == "PhysicalNames") {
      read_names(in_, [&](int dimension, int label, std::string text) {
        mesh_.add_name(dimension, label, std::move(text));
      });
    } else if (name == "Nodes" || (name == "ParametricNodes" && version_ == Version::k2)) {
      read_nodes(name);
    } else if (name == "Elements") {
      read_elements();
    } else if (name == "NodeData" || name == "ElementData") {
      read_data(in_, name == "NodeData", mesh_);
    } else if ((name == "Entities" || name == "PartitionedEntities") && version_ != Version::k2) {
      in_.begin_data();
      read_entities4(in_, version_, name == "PartitionedEntities", entities_);
    } else {
      if (name == "ElementNodeData")
        mesh_.note("fields on the corners of elements ($ElementNodeData) left out");
      if (name == "Periodic") mesh_.note("links between periodic entities ($Periodic) left out");
      return false;
    }
    return true;
  }

  void read_nodes(const std::string& name) {
    if (mesh_.has_nodes()) in_.fail("a second section of nodes");
    if (version_ == Version::k2) {
      read_nodes2(in_, mesh_, name == "ParametricNodes");
    } else {
      in_.begin_data();
      read_nodes4(in_, version_, mesh_);
    }
  }

  void read_elements() {
    if (!mesh_.has_nodes()) in_.fail("$Elements stands before $Nodes");
    if (mesh_.has_elements()) in_.fail("a second $Elements section");
    if (version_ == Version::k2) {
      read_elements2(in_, mesh_);
    } else {
      in_.begin_data();
      read_elements4(in_, version_, std::move(entities_), mesh_);
    }
  }

  Source in_;
  Version version_;
  Collector mesh_;
  std::vector<Entity> entities_;
};

Version read_version(TextSource& in) {
  const double number = in.real();
  switch (static_cast<int>(std::lround(10 * std::min(std::max(number, 0.0), 1000.0)))) {
    case 20:
    case 21:
    case 22:
      return Version::k2;
    case 40:
      return Version::k40;
    case 41:
      return Version::k41;
    default:
      in.fail("this version of Gmsh's format cannot be read: save the mesh as version 2.2 or 4.1");
  }
}

}  // namespace

Format read_format(TextSource& in) {
  Format format;
  format.version = read_version(in);
  const int binary = in.ascii_integer("0 (ASCII) or 1 (binary)");
  if (binary != 0 && binary != 1) in.fail("the type of a file is 0 (ASCII) or 1 (binary)");
  format.is_binary = binary == 1;
  const int size = in.ascii_integer("the size of a number");
  if (!format.is_binary) return format;
  if (size != 8) in.fail("binary files with numbers of " + std::to_string(size) + " bytes cannot be read");
  if (!in.line().empty()) in.fail("expected the end of the line before binary data");
  return format;
}

bool is_swapped(const BinarySource& in) {
  constexpr std::string_view kLittle("\1\0\0\0", 4);
  constexpr std::string_view kBig("\0\0\0\1", 4);
  const std::string_view bytes = in.text().substr(in.offset(), 4);
  if (bytes != kLittle && bytes != kBig)
    in.fail("expected the 32-bit number 1, which tells the byte order of the file");
  std::int32_t one = 0;
  std::memcpy(&one, bytes.data(), sizeof one);
  return one != 1;
}

std::size_t find_closing(std::string_view text, std::string_view closing, std::size_t from) {
  for (std::size_t at = from;; ++at) {
    at = text.find(closing, at);
    if (at == std::string_view::npos) return at;
    const std::size_t after = at + closing.size();
    const bool whole = after == text.size() || std::strchr(" \t\r\n", text[after]) != nullptr;
    if (whole && at > 0 && text[at - 1] == '\n') return at;
  }
}

std::string unquoted(std::string_view line) {
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  return std::string(line);
}

template <class Source>
DataHeader read_data_header(Source& in) {
  DataHeader header;
  std::uint64_t count = 0;
  const std::size_t strings = data_tags(in, "string tags");
  in.line();
  for (std::size_t k = 0; k < strings; ++k) {
    const std::string_view line = in.line();
    if (k == 0) header.name = unquoted(line);
  }
  const std::size_t reals = data_tags(in, "real tags");
  for (std::size_t k = 0; k < reals; ++k) in.ascii_real();
  const std::size_t integers = data_tags(in, "integer tags");
  if (integers < 3) in.fail("expected at least 3 integer tags: time step, components and how many values");
  for (std::size_t k = 0; k < integers; ++k) {
    if (k == 2) {
      count = in.ascii_count();
      continue;
    }
    const int value = in.ascii_integer("an integer tag");
    if (k == 0) header.step = value;
    if (k == 1) header.components = value;
  }
  in.begin_data();
  constexpr int kMostComponents = 9;
  if (header.components < 1 || header.components > kMostComponents) {
    in.fail("field '" + shown(header.name) + "' has " + std::to_string(header.components) +
            " components; 1 to 9 can be read");
  }
  const auto components = static_cast<std::size_t>(header.components);
  header.count = bounded(in, count, Source::least(1, 0, components), "values");
  return header;
}

template DataHeader read_data_header(TextSource&);
template DataHeader read_data_header(BinarySource&);

}  // namespace gmsh

MeshData read_gmsh(const InputFile& file) {
  using namespace gmsh;
  const std::string name = file.path().string();
  TextSource header(file.bytes(), name);
  for (std::string_view word = header.word(); word != "$MeshFormat"; word = header.word()) {
    if (word == "$NOD")
      header.fail("version 1 of Gmsh's format cannot be read: save the mesh as version 4.1");
    if (!word.starts_with('$')) header.fail("expected $MeshFormat and found '" + shown(word) + "'");
    skip_section(header, std::string(word.substr(1)));
    header.word();
  }
  const Format format = read_format(header);
  if (!format.is_binary) {
    close_section(header, "MeshFormat");
    return Reader(std::move(header), format.version).read();
  }
  BinarySource in(file.bytes(), name, header.offset(),
                  is_swapped({file.bytes(), name, header.offset(), false}));
  in.int32("1");
  close_section(in, "MeshFormat");
  return Reader(std::move(in), format.version).read();
}

}  // namespace hfr::io
