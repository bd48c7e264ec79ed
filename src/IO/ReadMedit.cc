// SPDX-License-Identifier: BSD-3-Clause
// Medit's mesh format as its authors describe it: P. Frey, "MEDIT: an interactive mesh visualization
// software", INRIA RT-0253 (2001), and the binary layout of libMeshb (versions 1 to 4).
#include <algorithm>
#include <limits>
#include <utility>

#include "HalfFace/Errors.hh"
#include "IO/Formats.hh"
#include "IO/Linearise.hh"
#include "IO/MeditPart.hh"
#include "IO/MeditSource.hh"
#include "IO/ReadMeditSolution.hh"
#include "IO/ReserveMore.hh"
#include "IO/Validate.hh"

namespace hfr::io {
namespace {

using medit::Heading;
using medit::Keyword;

template <class Source>
class MeditReader {
 public:
  /// `part`: takes what the file says of a part of a distributed mesh; such sections are passed over where
  /// there is none.
  explicit MeditReader(const InputFile& file, MeditPart* part = nullptr) : in_(file), part_(part) {}

  MeshData read() {
    while (const auto heading = in_.next()) read_section(*heading);
    if (!in_.saw_end() && part_) in_.fail("the file has no End: it has been cut short");
    if (!in_.saw_end()) mesh_.notes.emplace_back("the file has no End; it may have been cut short");
    if (part_) finish_part();
    fix_required();
    // References are not optional in the format; all zero means that there are none.
    const auto is_zero = [](int label) { return label == 0; };
    if (std::all_of(mesh_.regions.begin(), mesh_.regions.end(), is_zero)) mesh_.regions.clear();
    if (std::all_of(mesh_.vertex_labels.begin(), mesh_.vertex_labels.end(), is_zero)) {
      mesh_.vertex_labels.clear();
    }
    return std::move(mesh_);
  }

  const std::vector<Index>& midside() const { return midside_; }

 private:
  void read_section(const Heading& heading) {
    switch (heading.keyword) {
      case Keyword::kVertices:
        return read_vertices(heading);
      case Keyword::kEdges:
        return read_elements<0>(mesh_.edges, mesh_.edge_labels, heading);
      case Keyword::kTriangles:
        return read_elements<0>(mesh_.triangles, mesh_.triangle_labels, heading);
      case Keyword::kTetrahedra:
        return read_elements<0>(mesh_.cells, mesh_.regions, heading);
      case Keyword::kEdgesP2:
        return read_elements<1>(mesh_.edges, mesh_.edge_labels, heading);
      case Keyword::kTrianglesP2:
        return read_elements<3>(mesh_.triangles, mesh_.triangle_labels, heading);
      case Keyword::kTetrahedraP2:
        return read_elements<6>(mesh_.cells, mesh_.regions, heading);
      case Keyword::kRequiredVertices:
        return read_numbers(mesh_.fixed_vertices, heading);
      case Keyword::kCorners:
        return read_numbers(corners_, heading);
      case Keyword::kRequiredEdges:
        return read_numbers(required_edges_, heading);
      case Keyword::kRequiredTriangles:
        return read_numbers(required_triangles_, heading);
      default:
        if (!part_ || !read_of_part(heading.name)) skip(heading);
    }
  }

  /// Fails where the section breaks off before its entry number i.
  void expect_entry(const Heading& heading, std::size_t n, std::size_t i) {
    if (in_.at_section_end()) [[unlikely]]
      in_.fail(medit::too_few_entries(heading.name, static_cast<std::int64_t>(n), i));
  }

  void read_vertices(const Heading& heading) {
    const std::size_t n = in_.count(heading.name, 1, 3);
    reserve_more(mesh_.points, n);
    reserve_more(mesh_.vertex_labels, n);
    for (std::size_t i = 0; i < n; ++i) {
      expect_entry(heading, n, i);
      Vec3 p;
      p.x = in_.coordinate();
      p.y = in_.coordinate();
      p.z = in_.coordinate();
      mesh_.points.push_back(p);
      mesh_.vertex_labels.push_back(label());
    }
  }

  int label() {
    using Limits = std::numeric_limits<int>;
    return static_cast<int>(in_.integer_in(Limits::min(), Limits::max(), "reference"));
  }

  /// Numbers of vertices are checked where they stand when the vertices came first, as they always do in
  /// practice, and by validate() otherwise.
  Index vertex() {
    const std::size_t known = mesh_.points.size();
    const auto highest = static_cast<std::int64_t>(known > 0 ? known : VertexHandle::kInvalid >> 1);
    return static_cast<Index>(in_.integer_in(1, highest, "vertex") - 1);
  }

  /// Elements of N corners, each followed by the points of its edges if it is of second order.
  template <std::size_t kMidside, std::size_t N>
  void read_elements(std::vector<std::array<Index, N>>& elements, std::vector<int>& labels,
                     const Heading& heading) {
    const std::size_t n = in_.count(heading.name, N + kMidside + 1, 0);
    reserve_more(elements, n);
    reserve_more(labels, n);
    for (std::size_t i = 0; i < n; ++i) {
      expect_entry(heading, n, i);
      std::array<Index, N> element;
      for (Index& corner : element) corner = vertex();
      for (std::size_t k = 0; k < kMidside; ++k) midside_.push_back(vertex());
      elements.push_back(element);
      labels.push_back(label());
    }
    if (kMidside > 0 && n > 0) {
      mesh_.notes.push_back(std::to_string(n) + " " + std::string(heading.name) +
                            " were made linear: the points of their edges are left out");
    }
  }

  void read_numbers(std::vector<Index>& numbers, const Heading& heading) {
    const std::size_t n = in_.count(heading.name, 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      expect_entry(heading, n, i);
      numbers.push_back(static_cast<Index>(in_.integer_in(1, VertexHandle::kInvalid >> 1, "number") - 1));
    }
  }

  /// Whether this is a section of a part.
  bool read_of_part(std::string_view name) {
    const Heading heading{Keyword::kUnknown, 0, name};
    if (name == "NumberOfPartitions") {
      part_->n_parts = in_.integer_in(1, std::numeric_limits<std::int32_t>::max(), "number of partitions");
    } else if (name == "ParallelVertices") {
      read_numbers(parallel_vertices_, heading);
    } else if (name == "ParallelTriangles") {
      read_numbers(part_->parallel_triangles, heading);
    } else if (name == "ParallelEdges") {
      read_numbers(part_->parallel_edges, heading);
    } else if (name == "ParallelVertexCommunicators") {
      read_communicators(of_vertices_, heading);
    } else if (name == "ParallelTriangleCommunicators") {
      read_communicators(of_triangles_, heading);
    } else if (name == "ParallelCommunicatorVertices") {
      read_items(of_vertices_, heading);
    } else if (name == "ParallelCommunicatorTriangles") {
      read_items(of_triangles_, heading);
    } else {
      return false;
    }
    return true;
  }

  /// Interfaces of one kind while they are read.
  struct Communicators {
    std::vector<MeditInterface> interfaces;
    std::vector<std::size_t> n_items;  ///< as announced, of each
    bool has_items = false;
  };

  void read_communicators(Communicators& all, const Heading& heading) {
    if (!all.interfaces.empty()) in_.fail(std::string(heading.name) + " comes twice");
    const std::size_t n = in_.count(heading.name, 2, 0);
    for (std::size_t i = 0; i < n; ++i) {
      expect_entry(heading, n, i);
      constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
      all.interfaces.emplace_back().part = static_cast<int>(in_.integer_in(0, kMost, "part"));
      all.n_items.push_back(static_cast<std::size_t>(in_.integer_in(1, kMost, "number of items")));
    }
  }

  /// As many as all communicators have announced: the section has no count of its own.
  void read_items(Communicators& all, const Heading& heading) {
    if (all.has_items) in_.fail(std::string(heading.name) + " comes twice");
    all.has_items = true;
    std::size_t n = 0;
    for (const std::size_t items : all.n_items) n += items;
    for (std::size_t i = 0; i < n; ++i) {
      expect_entry(heading, n, i);
      const auto item = static_cast<Index>(in_.integer_in(1, VertexHandle::kInvalid >> 1, "number") - 1);
      const std::int64_t number =
          in_.integer_in(1, std::numeric_limits<std::int64_t>::max(), "global number");
      const auto at = static_cast<std::size_t>(
          in_.integer_in(0, static_cast<std::int64_t>(all.interfaces.size()) - 1, "communicator"));
      all.interfaces[at].items.push_back(item);
      all.interfaces[at].number.push_back(number);
    }
    for (std::size_t k = 0; k < all.interfaces.size(); ++k)
      if (all.interfaces[k].items.size() != all.n_items[k])
        in_.fail(std::string(heading.name) + ": communicator " + std::to_string(k) + " announces " +
                 std::to_string(all.n_items[k]) + " items and has " +
                 std::to_string(all.interfaces[k].items.size()));
  }

  void finish_part() {
    const auto require = [&](const Communicators& all, std::size_t n_there, const std::string& what) {
      if (!all.interfaces.empty() && !all.has_items)
        in_.fail("communicators of " + what + " are announced, and their items are not there");
      for (const MeditInterface& interface : all.interfaces)
        for (const Index item : interface.items) require_below(item, n_there, what);
    };
    require(of_vertices_, mesh_.points.size(), "vertices");
    require(of_triangles_, mesh_.triangles.size(), "triangles");
    for (const Index i : part_->parallel_triangles) require_below(i, mesh_.triangles.size(), "triangles");
    for (const Index i : part_->parallel_edges) require_below(i, mesh_.edges.size(), "edges");
    part_->by_triangles = !of_triangles_.interfaces.empty();
    part_->interfaces = std::move((part_->by_triangles ? of_triangles_ : of_vertices_).interfaces);
    const std::size_t before =
        mesh_.fixed_vertices.size() + required_triangles_.size() + required_edges_.size();
    leave_out(mesh_.fixed_vertices, parallel_vertices_);
    leave_out(required_triangles_, part_->parallel_triangles);
    leave_out(required_edges_, part_->parallel_edges);
    const std::size_t after =
        mesh_.fixed_vertices.size() + required_triangles_.size() + required_edges_.size();
    if (before > after)
      mesh_.notes.push_back("vertices, edges and triangles that are required and parallel (" +
                            std::to_string(before - after) + ") are not fixed");
  }
  void require_below(Index item, std::size_t n, const std::string& what) {
    if (item >= n)
      in_.fail("item " + std::to_string(item + std::size_t{1}) + " of " + what +
               " between parts is out of range (the file has " + std::to_string(n) + ")");
  }
  static void leave_out(std::vector<Index>& numbers, std::vector<Index> gone) {
    std::sort(gone.begin(), gone.end());
    std::erase_if(numbers, [&](Index i) { return std::binary_search(gone.begin(), gone.end(), i); });
  }

  void skip(const Heading& heading) {
    const std::size_t n = in_.announced();
    if (n > 0 && medit::is_unsupported_cell(heading.name)) {
      in_.fail(std::to_string(n) + " " + std::string(heading.name) +
               ": only tetrahedra of first and second order are read");
    }
    in_.skip();
    const std::string name =
        heading.name.empty() ? "section " + std::to_string(heading.code) : std::string(heading.name);
    if (n > 0 || heading.keyword == Keyword::kUnknown) {
      mesh_.notes.push_back(name + (n > 0 ? " (" + std::to_string(n) + ")" : "") + " is not kept");
    }
  }

  /// Corners and the vertices of required edges and triangles are as fixed as required vertices.
  void fix_required() {
    std::vector<Index>& fixed = mesh_.fixed_vertices;
    const auto fix_corners_of = [&](const auto& elements, const std::vector<Index>& numbers,
                                    std::string what) {
      for (const Index number : numbers) {
        if (number >= elements.size()) {
          in_.fail(what + " " + std::to_string(number + 1) + " is out of range (the file has " +
                   std::to_string(elements.size()) + ")");
        }
        fixed.insert(fixed.end(), elements[number].begin(), elements[number].end());
      }
      if (!numbers.empty()) {
        mesh_.notes.push_back(what + " (" + std::to_string(numbers.size()) +
                              "): kept by fixing their vertices");
      }
    };
    fixed.insert(fixed.end(), corners_.begin(), corners_.end());
    if (!corners_.empty()) {
      mesh_.notes.push_back("Corners (" + std::to_string(corners_.size()) + "): kept as fixed vertices");
    }
    fix_corners_of(mesh_.edges, required_edges_, "RequiredEdges");
    fix_corners_of(mesh_.triangles, required_triangles_, "RequiredTriangles");
    std::sort(fixed.begin(), fixed.end());
    fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  }

  Source in_;
  MeditPart* part_;
  MeshData mesh_;
  Communicators of_vertices_, of_triangles_;
  std::vector<Index> parallel_vertices_;
  std::vector<Index> midside_;
  std::vector<Index> corners_;
  std::vector<Index> required_edges_;
  std::vector<Index> required_triangles_;
};

template <class Source>
MeshData read(const InputFile& file) {
  MeditReader<Source> reader(file);
  MeshData mesh = reader.read();
  medit::read_solution_beside(file, mesh);
  drop_midside_points(mesh, reader.midside());
  return mesh;
}

/// Files are called .mesh or .meshb, but the first bytes decide.
MeshData read_either(const InputFile& file) {
  return medit::is_binary(file) ? read<medit::BinarySource>(file) : read<medit::AsciiSource>(file);
}

}  // namespace

MeshData read_medit(const InputFile& file) { return read_either(file); }

MeshData read_meditb(const InputFile& file) { return read_either(file); }

std::filesystem::path medit_part_path(const std::filesystem::path& path, int part) {
  std::filesystem::path name = path.stem();
  name += "." + std::to_string(part);
  name += path.extension();
  return path.parent_path() / name;
}

MeditPart read_medit_part(const std::filesystem::path& path) {
  const InputFile file(path);
  HFR_REQUIRE(!file.bytes().empty(), path.string() + ": the file is empty");
  HFR_REQUIRE(!medit::is_binary(file),
              path.string() + ": parts of a distributed mesh are text, and this is a binary file");
  MeditPart part;
  MeditReader<medit::AsciiSource> reader(file, &part);
  part.mesh = reader.read();
  HFR_REQUIRE(reader.midside().empty(),
              path.string() + ": parts of a distributed mesh have elements of first order");
  validate(part.mesh, path.string());
  return part;
}

}  // namespace hfr::io
