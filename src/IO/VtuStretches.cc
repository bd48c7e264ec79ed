// SPDX-License-Identifier: BSD-3-Clause
// One .vtu of raw appended data, as WriteVtu.cc lays it out, of which each of several processes writes a
// stretch of every array: few long ones, wherever their cells stand.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "IO/MeshStretch.hh"
#include "IO/OutputFile.hh"
#include "IO/VtkGrid.hh"

namespace hfr::io {
namespace {

class VtuStretches {
 public:
  /// The mesh stretch has to outlive it.
  explicit VtuStretches(const MeshStretch& mesh) : mesh_(mesh) {
    MeshData named;
    named.names = *mesh.names;
    names_ = names_text(named);
    look_at(mesh.point_fields, point_facts_);
    look_at(mesh.cell_fields, cell_facts_);
    list_arrays();
    lay_out();
  }
  VtuStretches(const VtuStretches&) = delete;
  VtuStretches& operator=(const VtuStretches&) = delete;

  void write(ByteSink& out) const {
    if (mesh_.is_first()) out.text(head_);
    for (const Array& array : arrays_) {
      out.next_stretch();
      if (mesh_.is_first()) out.raw(std::uint64_t{array.n * array.size});
      array.put(out);
    }
    out.next_stretch();
    if (mesh_.is_first()) out.text("\n</AppendedData>\n</VTKFile>\n");
  }

 private:
  struct Array {
    const char* section;
    std::string_view name;
    const char* type;
    std::uint64_t components, n, size;   // numbers of all processes, and bytes of each
    std::function<void(ByteSink&)> put;  // this process's
  };
  struct Kind {
    const ElementStretch& elements;
    std::uint64_t n_corners;
    std::uint8_t type;
  };

  std::array<Kind, 3> kinds() const {
    return {{{mesh_.cells, 4, kVtkTetra}, {mesh_.triangles, 3, kVtkTriangle}, {mesh_.edges, 2, kVtkLine}}};
  }
  /// body(kind, number of corners before it) for each, in the order of the file.
  template <class Body>
  void for_kinds(ByteSink& out, Body&& body) const {
    std::uint64_t before = 0;
    for (const Kind& kind : kinds()) {
      if (before > 0) out.next_stretch();
      body(kind, before);
      before += kind.n_corners * kind.elements.total;
    }
  }

  void list_arrays() {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    std::uint64_t n_items = 0, n_corners = 0;
    for (const Kind& kind : kinds()) {
      n_items += kind.elements.total;
      n_corners += kind.n_corners * kind.elements.total;
    }
    if (!names_.empty())
      arrays_.push_back({"FieldData", kVtkNamesArray, "UInt8", 1, names_.size(), 1, [this](ByteSink& out) {
                           if (mesh_.is_first()) out.text(names_);
                         }});
    arrays_.push_back({"Points", "Points", "Float64", 3, 3 * mesh_.n_points, 8, [this](ByteSink& out) {
                         for (const Vec3& p : mesh_.points) out.raw(p);
                       }});
    if (sizeof(Index) == 4 && mesh_.n_points <= kMost)
      add_corners<std::int32_t>("Int32", n_corners);
    else
      add_corners<std::int64_t>("Int64", n_corners);
    if (n_items <= kMost / 4)
      add_ends<std::int32_t>("Int32", n_items);
    else
      add_ends<std::int64_t>("Int64", n_items);
    arrays_.push_back({"Cells", "types", "UInt8", 1, n_items, 1, [this](ByteSink& out) {
                         for_kinds(out, [&](const Kind& kind, std::uint64_t) {
                           for (std::size_t i = 0; i < kind.elements.corners.size(); ++i) out.raw(kind.type);
                         });
                       }});
    if (mesh_.with_vertex_labels ||
        is_read_as_labels(mesh_.point_fields, point_facts_, kVtkLabelArray, kVtkPointLabelNames))
      arrays_.push_back({"PointData", kVtkLabelArray, "Int32", 1, mesh_.n_points, 4, [this](ByteSink& out) {
                           const auto& labels = mesh_.vertex_labels;
                           for (std::size_t i = 0; i < mesh_.points.size(); ++i)
                             out.raw(std::int32_t{labels.empty() ? 0 : labels[i]});
                         }});
    if (mesh_.fixed.total > 0 ||
        is_read_as_labels(mesh_.point_fields, point_facts_, kVtkFixedArray, {{kVtkFixedArray}}))
      arrays_.push_back({"PointData", kVtkFixedArray, "Int32", 1, mesh_.n_points, 4,
                         [this](ByteSink& out) { put_fixed(out); }});
    for (std::size_t i = 0; i < mesh_.point_fields.size(); ++i)
      add_field("PointData", mesh_.point_fields[i], point_facts_[i].width, mesh_.n_points);
    if (mesh_.with_labels ||
        is_read_as_labels(mesh_.cell_fields, cell_facts_, kVtkRegionArray, kVtkCellLabelNames))
      arrays_.push_back({"CellData", kVtkRegionArray, "Int32", 1, n_items, 4, [this](ByteSink& out) {
                           for_kinds(out, [&](const Kind& kind, std::uint64_t) {
                             for (std::size_t i = 0; i < kind.elements.corners.size(); ++i)
                               out.raw(std::int32_t{kind.elements.label(i)});
                           });
                         }});
    for (std::size_t i = 0; i < mesh_.cell_fields.size(); ++i)
      add_field("CellData", mesh_.cell_fields[i], cell_facts_[i].width, n_items);
  }

  /// What the values of all processes say of a field.
  struct Facts {
    IntegerWidth width = IntegerWidth::k32;
    bool is_whole = true;
  };
  void look_at(std::span<const Field> fields, std::vector<Facts>& facts) const {
    for (const Field& field : fields) facts.push_back({integer_width(field), has_whole_values(field)});
    if (facts.empty()) return;
    const std::vector<Facts> all = mesh_.processes.gather(std::span<const Facts>(facts));
    for (std::size_t i = 0; i < all.size(); ++i) {
      Facts& one = facts[i % facts.size()];
      one.width = std::max(one.width, all[i].width);
      one.is_whole = one.is_whole && all[i].is_whole;
    }
  }
  static bool is_read_as_labels(std::span<const Field> fields, const std::vector<Facts>& facts,
                                std::string_view array, std::span<const std::string_view> names) {
    return would_be_labels(fields, array, names, [&](std::size_t k) { return facts[k].is_whole; });
  }
  void add_field(const char* section, const Field& field, IntegerWidth width, std::uint64_t n) {
    if (width == IntegerWidth::k32) return add_values<std::int32_t>(section, "Int32", field, n);
    if (width == IntegerWidth::k64) return add_values<std::int64_t>(section, "Int64", field, n);
    add_values<double>(section, "Float64", field, n);
  }
  /// Elements that are no cells have zeros.
  template <class T>
  void add_values(const char* section, const char* type, const Field& field, std::uint64_t n) {
    const auto put_values = [&field](ByteSink& out) {
      for (double value : field.values) out.raw(static_cast<T>(value));
    };
    const auto components = static_cast<std::uint64_t>(field.components);
    std::function<void(ByteSink&)> put = put_values;
    if (section == std::string_view("CellData"))
      put = [this, put_values, components](ByteSink& out) {
        for_kinds(out, [&](const Kind& kind, std::uint64_t) {
          if (kind.type == kVtkTetra) return put_values(out);
          for (std::uint64_t i = 0; i < components * kind.elements.corners.size(); ++i) out.raw(T{0});
        });
      };
    arrays_.push_back(
        {section, names_of_fields_.emplace_back(field.name.empty() ? "unnamed" : xml_escaped(field.name)),
         type, components, components * n, sizeof(T), std::move(put)});
  }
  template <class T>
  void add_corners(const char* type, std::uint64_t n) {
    arrays_.push_back({"Cells", "connectivity", type, 1, n, sizeof(T), [this](ByteSink& out) {
                         for_kinds(out, [&](const Kind& kind, std::uint64_t) {
                           const NumberRows& rows = kind.elements.corners;
                           for (std::size_t i = 0; i < rows.size(); ++i)
                             for (std::size_t k = 0; k < kind.n_corners; ++k)
                               out.raw(static_cast<T>(rows(i, k)));
                         });
                       }});
  }
  template <class T>
  void add_ends(const char* type, std::uint64_t n) {
    arrays_.push_back({"Cells", "offsets", type, 1, n, sizeof(T), [this](ByteSink& out) {
                         for_kinds(out, [&](const Kind& kind, std::uint64_t before) {
                           std::uint64_t end = before + kind.n_corners * kind.elements.first;
                           for (std::size_t i = 0; i < kind.elements.corners.size(); ++i)
                             out.raw(static_cast<T>(end += kind.n_corners));
                         });
                       }});
  }
  void put_fixed(ByteSink& out) const {
    std::vector<std::int32_t> fixed(mesh_.points.size(), 0);
    for (std::size_t k = 0; k < mesh_.fixed.corners.size(); ++k)
      fixed[static_cast<std::size_t>(mesh_.fixed.corners(k, 0) - mesh_.first_point)] = 1;
    for (std::int32_t one : fixed) out.raw(one);
  }

  void lay_out() {
    head_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
    head_ += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    head_ += "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
    std::uint64_t offset = 0;
    if (!names_.empty()) put_section("FieldData", offset);
    std::uint64_t n_items = 0;
    for (const Kind& kind : kinds()) n_items += kind.elements.total;
    head_ += "<Piece NumberOfPoints=\"" + std::to_string(mesh_.n_points) + "\" NumberOfCells=\"" +
             std::to_string(n_items) + "\">\n";
    for (const char* section : {"Points", "Cells", "PointData", "CellData"}) put_section(section, offset);
    head_ += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  }
  void put_section(std::string_view section, std::uint64_t& offset) {
    head_ += "<" + std::string(section) + ">\n";
    for (const Array& array : arrays_) {
      if (array.section != section) continue;
      head_ += std::string("<DataArray type=\"") + array.type + "\" Name=\"" + std::string(array.name) +
               "\" NumberOfComponents=\"" + std::to_string(array.components);
      if (section == "FieldData") head_ += "\" NumberOfTuples=\"" + std::to_string(array.n);
      head_ += "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
      offset += sizeof(std::uint64_t) + array.n * array.size;
    }
    head_ += "</" + std::string(section) + ">\n";
  }

  const MeshStretch& mesh_;
  std::string names_, head_;
  std::vector<Facts> point_facts_, cell_facts_;
  std::deque<std::string> names_of_fields_;  // which views are of
  std::vector<Array> arrays_;                // in the order of the file
};

std::vector<Field> without_values(std::span<const Field> fields) {
  std::vector<Field> shapes;
  for (const Field& field : fields) shapes.push_back({field.name, field.components, field.integer, {}});
  return shapes;
}

}  // namespace

StretchedFile vtu_stretches(const MeshStretch& mesh) {
  const auto file = std::make_shared<VtuStretches>(mesh);
  MeshData named;
  named.point_fields = without_values(mesh.point_fields);
  named.cell_fields = without_values(mesh.cell_fields);
  return {[file](ByteSink& out) { file->write(out); }, notes_on_vtu_names(named)};
}

}  // namespace hfr::io
