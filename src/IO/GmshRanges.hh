// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_RANGES_HH
#define HFR_IO_GMSH_RANGES_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "HalfFace/Vec3.hh"
#include "IO/MeshShare.hh"
#include "IO/ReadGmsh.hh"

namespace hfr::io::gmsh {

constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();  ///< tag or number of items

/// What elements have in common.
struct ElementKind {
  ElementType type;
  Membership group;
  bool in_several_groups = false;  ///< physical ones; `group` has the first
};

/// An element of a kind that is taken.
struct Element {
  int dimension = 0;
  Membership group;
  std::array<std::int64_t, 4> nodes{};  ///< tags
};

struct Nodes {
  std::vector<std::int64_t> tags;
  std::vector<Vec3> points;
};

/// A .msh file of which any nodes and elements can be read, by their places in the file. All processes make
/// one at the same time. All functions throw InvalidInput for what such a file may not have.
class Ranges {
 public:
  virtual ~Ranges() = default;

  std::uint64_t n_nodes() const { return n_nodes_; }
  /// Of all types, those that are left out included.
  std::uint64_t n_elements() const { return n_elements_; }
  const std::map<std::pair<int, int>, std::string>& names() const { return names_; }
  /// Sections that are left out, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

  virtual Nodes nodes(std::uint64_t begin, std::uint64_t end) = 0;
  /// use(kind, n) for n elements that follow on one another. Reads no more of them than that takes.
  using UseKind = std::function<void(const ElementKind&, std::uint64_t n)>;
  virtual void survey(std::uint64_t begin, std::uint64_t end, const UseKind& use) = 0;
  /// use(element) for points, lines, triangles and tetrahedra.
  using UseElement = std::function<void(const Element&)>;
  virtual void elements(std::uint64_t begin, std::uint64_t end, const UseElement& use) = 0;
  [[noreturn]] virtual void fail(const std::string& message) const = 0;

 protected:
  /// Adds a note where the section is one that the reader of whole files would take, or says that it does
  /// not.
  void leave_out(const std::string& section);

  std::uint64_t n_nodes_ = 0, n_elements_ = 0;
  std::map<std::pair<int, int>, std::string> names_;
  std::vector<std::string> notes_;
};

inline constexpr const char* kNoParametricNodes =
    "$ParametricNodes are not read in ranges; hfremesh convert writes none";

std::unique_ptr<Ranges> text_ranges(const std::filesystem::path& path, Version version,
                                    const Processes& processes);
/// `begin`: of the data of $MeshFormat.
std::unique_ptr<Ranges> binary_ranges(const std::filesystem::path& path, Version version, std::uint64_t begin,
                                      const Processes& processes);

/// Of elements in a block of version 4.
ElementKind kind_of(const Entities& entities, const ElementType& type, int dimension, int tag);

/// Of Gmsh's number; fails where such elements are not read in ranges. Quadrangles are left out.
template <class Source>
ElementType first_order_type(const Source& in, std::int64_t number) {
  const auto known = static_cast<int>(std::clamp<std::int64_t>(number, -1, 1 << 20));
  const ElementType found = element_type(known);
  if (found.name == nullptr) in.fail("unknown Gmsh element type " + std::to_string(number));
  const bool is_skipped = found.dimension == 2 && !is_simplex(found) && found.nodes > 0;
  if (!is_skipped && (!is_simplex(found) || found.nodes != found.corners))
    in.fail(std::string(found.name) + " (Gmsh element type " + std::to_string(number) +
            "): in ranges, only points, lines, triangles and tetrahedra of first order are read");
  return found;
}

}  // namespace hfr::io::gmsh

#endif
