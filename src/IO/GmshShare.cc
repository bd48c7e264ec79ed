// SPDX-License-Identifier: BSD-3-Clause
// .msh of version 2.2 and 4.1 in text, in ranges: of nodes and elements, every process reads some lines, and
// all read the entities and names. What is a label the whole file decides, as Collector has it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>

#include "HalfFace/Errors.hh"
#include "IO/GmshElements.hh"
#include "IO/MeshShare.hh"
#include "IO/ReadGmsh.hh"
#include "IO/TextChunks.hh"
#include "IO/Words.hh"

namespace hfr::io {
namespace gmsh {
namespace {

constexpr std::string_view kWhatIsNeeded =
    "in ranges, .msh is read as text of version 2.2 or 4.1; hfremesh convert writes that";
constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

/// Nodes that follow on one another.
struct NodeBlock {
  std::uint64_t first = 0, n = 0;      ///< numbers
  std::uint64_t tags = 0, points = 0;  ///< their first lines; the same where a line has both
};

/// Elements that follow on one another: of one type and entity, or in version 2.2 all.
struct ElementBlock {
  ElementType type;
  Membership group;
  std::uint64_t n = 0, line = 0;
  std::uint64_t first = 0;  ///< number of the first among its kind
};

/// An element while it is read.
struct Element {
  int dimension = 0;
  Membership group;
  std::array<std::int64_t, 4> v{};
};

class GmshShare : public MeshShare {
 public:
  GmshShare(const std::filesystem::path& path, const Processes& processes, std::uint64_t at_once)
      : text_(path, {0, [](std::string_view line) { return line[0] == '$'; }}, processes),
        processes_(processes),
        rank_(processes.rank) {
    read_version();
    for (std::size_t i = 0; i < text_.marks().size(); ++i) read_section(i);
    if (node_blocks_.empty()) text_.fail("the file ends without a $Nodes section");
    if (!has_elements_) text_.fail("the file ends without an $Elements section");
    const std::uint64_t n_points = node_blocks_.back().first + node_blocks_.back().n;
    for (std::uint64_t r = 0; r <= processes.n; ++r)
      begins_.push_back((r * n_points + processes.n - 1) / processes.n);
    read_points();
    cut(at_once);
    if (version_ == Version::k2) look_at_groups();
    decide_labels();
    count();
  }

  SharePoints points() override { return std::move(points_); }
  std::size_t n_portions() const override { return portions_.size(); }
  /// In turn, from the first.
  ShareItems portion(std::size_t i) override;

 private:
  struct Portion {
    ElementBlock block;
    std::uint64_t begin = 0, end = 0;  // of its lines
  };

  void read_version();
  void read_section(std::size_t mark);
  void read_names(std::size_t mark);
  void read_entities(std::size_t mark, bool partitioned);
  void read_nodes(std::uint64_t line);
  void read_elements(std::uint64_t line);
  NodeBlock next_nodes(std::uint64_t line, std::uint64_t first);
  ElementBlock next_elements(std::uint64_t line);
  void require_lines(std::uint64_t begin, std::uint64_t n, const char* what) const {
    if (begin > text_.n_lines() || n > text_.n_lines() - begin)
      text_.fail(std::to_string(n) + " " + what + " are announced, but the file ends before");
  }
  void read_points();
  void cut(std::uint64_t at_once);
  void look_at_groups();
  void decide_labels();
  void count();
  ElementType supported(TextLine& in, std::int64_t type) const;
  std::optional<Element> element(const Portion& portion, TextLine& in) const;
  template <class Use>
  void for_elements(const Portion& portion, Use&& use);
  std::int32_t label(const Element& element) const;
  std::uint64_t node(std::int64_t tag) const;
  template <std::size_t N>
  void take(ShareElements<N>& elements, const Element& element) const;

  TextChunks text_;
  Processes processes_;
  std::size_t rank_;
  Version version_ = Version::k2;
  std::vector<Entity> entities_;
  std::vector<NodeBlock> node_blocks_;
  std::vector<ElementBlock> blocks_;
  bool has_elements_ = false;
  SharePoints points_;
  std::int64_t first_tag_ = 0;  // of node 0; the others ascend by one
  std::vector<Portion> portions_;
  std::set<std::tuple<int, int, int>> groups_;  // dimension, elementary, physical
  bool by_physical_ = false;
  std::array<bool, 4> is_labelled_{};    // by dimension
  std::array<std::uint64_t, 4> next_{};  // number of the next element of this process, by dimension
};

void GmshShare::read_version() {
  const auto& marks = text_.marks();
  if (marks.empty() || marks[0].word != "$MeshFormat" || marks[0].line != 0)
    text_.fail("expected $MeshFormat in the first line");
  const auto [number, binary] = text_.at_line(1, [](TextLine& in) {
    const double version = in.real();
    return std::pair(version, in.integer());
  });
  const auto tenths = std::lround(10 * std::min(std::max(number, 0.0), 1000.0));
  if (binary != 0 || (tenths != 22 && tenths != 41)) text_.fail(std::string(kWhatIsNeeded));
  version_ = tenths == 41 ? Version::k41 : Version::k2;
}

void GmshShare::read_section(std::size_t mark) {
  const TextChunks::Mark& found = text_.marks()[mark];
  const std::string& name = found.word;
  if (name.starts_with("$End")) return;
  if (mark + 1 == text_.marks().size() || text_.marks()[mark + 1].word != "$End" + name.substr(1))
    text_.fail("section " + shown(name) + " is not closed");
  if (name == "$PhysicalNames") read_names(mark);
  if (version_ == Version::k41 && (name == "$Entities" || name == "$PartitionedEntities"))
    read_entities(mark, name != "$Entities");
  if (name == "$Nodes") {
    if (!node_blocks_.empty()) text_.fail("a second section of nodes");
    read_nodes(found.line + 1);
  }
  if (name == "$Elements") {
    if (has_elements_) text_.fail("a second $Elements section");
    has_elements_ = true;
    read_elements(found.line + 1);
  }
  if (name == "$ParametricNodes") text_.fail("$ParametricNodes: " + std::string(kWhatIsNeeded));
  const auto leave_out = [&](const std::string& what) {
    const std::string note = what + " (" + name + ") left out";
    if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
  };
  if (name == "$NodeData") leave_out("fields on points");
  if (name == "$ElementData") leave_out("fields on cells");
  if (name == "$ElementNodeData") leave_out("fields on the corners of elements");
  if (name == "$Periodic") leave_out("links between periodic entities");
}

void GmshShare::read_names(std::size_t mark) {
  const std::uint64_t begin = text_.marks()[mark].line + 1;
  const auto n = static_cast<std::uint64_t>(
      text_.at_line(begin, [](TextLine& in) { return in.integer_in(0, kMost, "number of names"); }));
  require_lines(begin + 1, n, "names");
  text_.for_lines(begin + 1, begin + 1 + n, [&](std::uint64_t, TextLine& in) {
    const auto dimension = static_cast<int>(in.integer_in(0, 3, "dimension"));
    const int label = in.label();
    std::string_view name = in.rest();
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    names_[{dimension, label}] = std::string(name);
  });
}

void GmshShare::read_entities(std::size_t mark, bool partitioned) {
  const std::string section = text_.between(text_.marks()[mark], text_.marks()[mark + 1]);
  TextSource in(section, text_.name() + ": section $Entities");
  read_entities4(in, version_, partitioned, entities_);
}

/// The block whose heading is this line.
NodeBlock GmshShare::next_nodes(std::uint64_t line, std::uint64_t first) {
  const auto n = static_cast<std::uint64_t>(text_.at_line(line, [](TextLine& in) {
    for (int k = 0; k < 3; ++k) in.integer();  // dimension, entity, whether points have parameters
    return in.integer_in(0, kMost, "number of nodes");
  }));
  require_lines(line + 1, n, "nodes");
  require_lines(line + 1 + n, n, "nodes");
  return {first, n, line + 1, line + 1 + n};
}

void GmshShare::read_nodes(std::uint64_t line) {
  if (version_ == Version::k2) {
    const auto n = static_cast<std::uint64_t>(
        text_.at_line(line, [](TextLine& in) { return in.integer_in(0, kMost, "number of nodes"); }));
    require_lines(line + 1, n, "nodes");
    node_blocks_.push_back({0, n, line + 1, line + 1});
    return;
  }
  const auto [n_blocks, n] = text_.at_line(line, [](TextLine& in) {
    const auto blocks = in.integer_in(0, kMost, "number of blocks");
    return std::pair(blocks, static_cast<std::uint64_t>(in.integer_in(0, kMost, "number of nodes")));
  });
  std::uint64_t first = 0, at = line + 1;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    node_blocks_.push_back(next_nodes(at, first));
    first += node_blocks_.back().n;
    at = node_blocks_.back().points + node_blocks_.back().n;
  }
  if (first != n)
    text_.fail(std::to_string(n) + " nodes are announced, but the blocks hold " + std::to_string(first));
}

ElementType GmshShare::supported(TextLine& in, std::int64_t type) const {
  const ElementType found = element_type(static_cast<int>(std::clamp<std::int64_t>(type, -1, 1 << 20)));
  if (found.name == nullptr) in.fail("unknown Gmsh element type " + std::to_string(type));
  const bool is_skipped = found.dimension == 2 && !is_simplex(found) && found.nodes > 0;
  if (!is_skipped && (!is_simplex(found) || found.nodes != found.corners))
    in.fail(std::string(found.name) + " (Gmsh element type " + std::to_string(type) +
            "): in ranges, only points, lines, triangles and tetrahedra of first order are read");
  return found;
}

ElementBlock GmshShare::next_elements(std::uint64_t line) {
  ElementBlock block = text_.at_line(line, [&](TextLine& in) {
    ElementBlock found;
    Entity key;
    key.dimension = static_cast<int>(in.integer_in(0, 3, "dimension of an entity"));
    key.tag = in.label();
    found.type = supported(in, in.integer());
    found.n = static_cast<std::uint64_t>(in.integer_in(0, kMost, "number of elements"));
    const auto is_key = [&](const Entity& e) { return e.dimension == key.dimension && e.tag == key.tag; };
    const auto entity = std::find_if(entities_.begin(), entities_.end(), is_key);
    found.group = entity == entities_.end() ? Membership{0, key.tag} : entity->group;
    if (entity != entities_.end() && std::exchange(entity->in_several_groups, false))
      notes_.push_back("entity " + std::to_string(key.tag) + " of dimension " +
                       std::to_string(key.dimension) + " is in several physical groups; the first is taken");
    return found;
  });
  block.line = line + 1;
  require_lines(block.line, block.n, "elements");
  return block;
}

void GmshShare::read_elements(std::uint64_t line) {
  if (version_ == Version::k2) {
    ElementBlock all;
    all.n = static_cast<std::uint64_t>(
        text_.at_line(line, [](TextLine& in) { return in.integer_in(0, kMost, "number of elements"); }));
    all.line = line + 1;
    require_lines(all.line, all.n, "elements");
    blocks_.push_back(all);
    return;
  }
  const auto n_blocks =
      text_.at_line(line, [](TextLine& in) { return in.integer_in(0, kMost, "number of blocks"); });
  std::uint64_t at = line + 1, n_skipped = 0;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const ElementBlock block = next_elements(at);
    at = block.line + block.n;
    if (block.n == 0) continue;
    if (!is_simplex(block.type)) {
      n_skipped += block.n;
      continue;
    }
    blocks_.push_back(block);
    groups_.insert({block.type.dimension, block.group.elementary, block.group.physical});
  }
  if (n_skipped > 0)
    notes_.push_back(std::to_string(n_skipped) +
                     " quadrangles left out: only triangles are surface elements");
}

/// Those of this process. Their tags have to ascend by one, as Gmsh numbers them.
void GmshShare::read_points() {
  points_.first = begins_[rank_];
  const std::uint64_t end = begins_[rank_ + 1];
  std::vector<std::int64_t> tags;
  for (const NodeBlock& block : node_blocks_) {
    const std::uint64_t from = std::max(points_.first, block.first),
                        to = std::min(end, block.first + block.n);
    if (from >= to) continue;
    const auto point = [](TextLine& in) {
      const double x = in.real(), y = in.real();
      return Vec3{x, y, in.real()};
    };
    if (block.tags == block.points) {
      text_.for_lines(block.tags + (from - block.first), block.tags + (to - block.first),
                      [&](std::uint64_t, TextLine& in) {
                        tags.push_back(in.integer());
                        points_.points.push_back(point(in));
                      });
      continue;
    }
    text_.for_lines(block.tags + (from - block.first), block.tags + (to - block.first),
                    [&](std::uint64_t, TextLine& in) {
                      tags.push_back(in.integer());
                      in.finish();
                    });
    text_.for_lines(block.points + (from - block.first), block.points + (to - block.first),
                    [&](std::uint64_t, TextLine& in) { points_.points.push_back(point(in)); });
  }
  // Of each process that has nodes: the tag that the first of all would have by its first one, or -kMost.
  std::vector<std::int64_t> first;
  const auto before = static_cast<std::int64_t>(points_.first);
  const auto breaks = [](std::int64_t tag, std::int64_t next) { return tag == kMost || next != tag + 1; };
  const bool ascends = std::adjacent_find(tags.begin(), tags.end(), breaks) == tags.end();
  if (!tags.empty()) first.push_back(ascends && tags[0] > before - kMost ? tags[0] - before : -kMost);
  first = processes_.gather(std::span<const std::int64_t>(first));
  if (first.empty()) return;
  if (std::count(first.begin(), first.end(), first[0]) != static_cast<std::ptrdiff_t>(first.size()) ||
      first[0] == -kMost)
    text_.fail(
        "in ranges, .msh is read whose nodes are numbered one after the other in the order in which they "
        "stand; hfremesh convert and Gmsh write them so");
  first_tag_ = first[0];
}

/// What of the elements this process reads.
void GmshShare::cut(std::uint64_t at_once) {
  std::uint64_t n = 0, begin = 0;
  for (const ElementBlock& block : blocks_) n += block.n;
  const std::uint64_t from = rank_ * n / processes_.n, to = (rank_ + 1) * n / processes_.n;
  for (const ElementBlock& block : blocks_) {
    const std::uint64_t low = std::max(from, begin), high = std::min(to, begin + block.n);
    for (std::uint64_t i = low; i < high; i += at_once)
      portions_.push_back(
          {block, block.line + (i - begin), block.line + (std::min(i + at_once, high) - begin)});
    begin += block.n;
  }
}

/// Nothing where it is none that is taken.
std::optional<Element> GmshShare::element(const Portion& portion, TextLine& in) const {
  in.integer();  // its tag
  Element found;
  ElementType type = portion.block.type;
  found.group = portion.block.group;
  if (version_ == Version::k2) {
    type = supported(in, in.integer());
    const auto n_tags = in.integer_in(0, 1 << 16, "number of tags");
    found.group = {};
    for (std::int64_t k = 0; k < n_tags; ++k) {
      const int tag = in.label();
      if (k == 0) found.group.physical = tag;
      if (k == 1) found.group.elementary = tag;
    }
    if (!is_simplex(type)) return std::nullopt;
  }
  found.dimension = type.dimension;
  for (int k = 0; k < type.corners; ++k) found.v[static_cast<std::size_t>(k)] = in.integer();
  in.finish();
  return found;
}

template <class Use>
void GmshShare::for_elements(const Portion& portion, Use&& use) {
  text_.for_lines(portion.begin, portion.end, [&](std::uint64_t, TextLine& in) {
    if (const std::optional<Element> found = element(portion, in)) use(*found);
  });
}

/// Of version 2.2, where each element says by itself what it belongs to; counts them, too.
void GmshShare::look_at_groups() {
  struct Group {
    int dimension = 0, elementary = 0, physical = 0;
  };
  for (const Portion& portion : portions_)
    for_elements(portion, [&](const Element& e) {
      groups_.insert({e.dimension, e.group.elementary, e.group.physical});
    });
  std::vector<Group> mine;
  for (const auto& [dimension, elementary, physical] : groups_)
    mine.push_back({dimension, elementary, physical});
  groups_.clear();
  for (const Group& group : processes_.gather(std::span<const Group>(mine)))
    groups_.insert({group.dimension, group.elementary, group.physical});
  for (auto at = groups_.begin(); at != groups_.end() && std::next(at) != groups_.end(); ++at)
    if (std::get<0>(*at) == std::get<0>(*std::next(at)) && std::get<1>(*at) == std::get<1>(*std::next(at)))
      text_.fail("entity " + std::to_string(std::get<1>(*at)) + " of dimension " +
                 std::to_string(std::get<0>(*at)) +
                 " is in several physical groups, so its elements may stand there more than once; in ranges "
                 "that is not read");
}

/// Physical groups, or entities where the whole file has no group; one entity with the tag that writers give
/// by default is no label.
void GmshShare::decide_labels() {
  by_physical_ =
      std::any_of(groups_.begin(), groups_.end(), [](const auto& g) { return std::get<2>(g) != 0; });
  for (int dimension = 0; dimension < 4; ++dimension) {
    std::set<int> labels;
    for (const auto& [d, elementary, physical] : groups_)
      if (d == dimension) labels.insert(by_physical_ ? physical : elementary);
    is_labelled_[static_cast<std::size_t>(dimension)] = by_physical_ || labels != std::set<int>{1};
  }
}

std::int32_t GmshShare::label(const Element& e) const {
  if (!is_labelled_[static_cast<std::size_t>(e.dimension)]) return 0;
  return by_physical_ ? e.group.physical : e.group.elementary;
}

/// Which numbers the elements of this process have among their kind.
void GmshShare::count() {
  using Counts = std::array<std::uint64_t, 4>;
  Counts mine{};
  for (const Portion& portion : portions_) {
    if (version_ == Version::k2)
      for_elements(portion, [&](const Element& e) { ++mine[static_cast<std::size_t>(e.dimension)]; });
    else
      mine[static_cast<std::size_t>(portion.block.type.dimension)] += portion.end - portion.begin;
  }
  const std::vector<Counts> all = processes_.gather(std::span<const Counts>(&mine, 1));
  for (std::size_t r = 0; r < all.size(); ++r) {
    n_cells_ += all[r][3];
    for (std::size_t d = 0; d < 4 && r < rank_; ++d) next_[d] += all[r][d];
  }
}

std::uint64_t GmshShare::node(std::int64_t tag) const {
  const auto number = static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(first_tag_);
  if (number >= n_points()) text_.fail("there is no node " + std::to_string(tag));
  return number;
}

template <std::size_t N>
void GmshShare::take(ShareElements<N>& elements, const Element& e) const {
  auto& v = elements.corners.emplace_back();
  for (std::size_t k = 0; k < N; ++k) {
    v[k] = node(e.v[k]);
    for (std::size_t j = 0; j < k; ++j)
      if (v[j] == v[k]) text_.fail("an element has node " + std::to_string(e.v[k]) + " twice");
  }
  elements.labels.push_back(label(e));
}

ShareItems GmshShare::portion(std::size_t i) {
  ShareItems items;
  items.cells.first = next_[3];
  items.triangles.first = next_[2];
  items.edges.first = next_[1];
  for_elements(portions_[i], [&](const Element& e) {
    ++next_[static_cast<std::size_t>(e.dimension)];
    if (e.dimension == 3) take(items.cells, e);
    if (e.dimension == 2) take(items.triangles, e);
    if (e.dimension == 1) take(items.edges, e);
    if (e.dimension == 0 && label(e) != 0) items.vertex_labels.emplace_back(node(e.v[0]), label(e));
  });
  return items;
}

}  // namespace
}  // namespace gmsh

std::unique_ptr<MeshShare> gmsh_share(const std::filesystem::path& path, const Processes& processes,
                                      std::uint64_t at_once) {
  return std::make_unique<gmsh::GmshShare>(path, processes, at_once);
}

}  // namespace hfr::io
