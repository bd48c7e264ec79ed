// SPDX-License-Identifier: BSD-3-Clause
// Binary .msh in ranges. All processes go from section to section, and step over records that have one size.
#include <algorithm>
#include <optional>

#include "IO/GmshBlocks.hh"
#include "IO/GmshRanges.hh"
#include "IO/GmshRecords.hh"

namespace hfr::io::gmsh {
namespace {

constexpr std::uint64_t kHead = 4096;  // bytes that hold what a section begins with

class BinaryRanges : public Ranges {
 public:
  BinaryRanges(const std::filesystem::path& path, Version version, std::uint64_t begin,
               const Processes& processes)
      : file_(path), processes_(processes), version_(version) {
    BinarySource& in = file_.at(begin, sizeof(std::int32_t));
    file_.set_swapped(is_swapped(in));
    std::uint64_t at = close("MeshFormat", begin + sizeof(std::int32_t));
    while ((at = skip_space(at)) < file_.size()) {
      BinarySource& section = file_.at(at, kHead);
      const std::string word(section.word());
      if (!word.starts_with('$'))
        section.fail("expected the name of a section, such as $Nodes, and found '" + shown(word) + "'");
      const std::string name = word.substr(1);
      at = close(name, read_section(name, file_.position()));
    }
    if (!has_nodes_) fail("the file ends without a $Nodes section");
    if (!elements_) fail("the file ends without an $Elements section");
  }

  Nodes nodes(std::uint64_t begin, std::uint64_t end) override;
  void survey(std::uint64_t begin, std::uint64_t end, const UseKind& use) override;
  void elements(std::uint64_t begin, std::uint64_t end, const UseElement& use) override;
  [[noreturn]] void fail(const std::string& message) const override { file_.file().fail(message); }

 private:
  std::uint64_t skip_space(std::uint64_t at);
  std::uint64_t close(const std::string& name, std::uint64_t at);
  std::uint64_t closing_of(const std::string& name, std::uint64_t from);
  // Each begins behind the name of the section, and returns where what it holds ends.
  std::uint64_t read_section(const std::string& name, std::uint64_t at);
  template <class Read>
  std::uint64_t read_whole(const std::string& name, std::uint64_t at, Read&& read);
  std::uint64_t skip_data(std::uint64_t at);
  std::uint64_t read_nodes(std::uint64_t at);
  std::uint64_t read_elements(std::uint64_t at);

  Heading node_heading(BinarySource& in, std::uint64_t left) const;
  Heading element_heading(BinarySource& in, std::uint64_t left) const;
  ElementKind kind_of_block(const Heading& heading) const {
    return kind_of(*known_entities_, heading.type, heading.dimension, heading.entity);
  }
  template <class Use>
  void for_records(std::uint64_t at, std::uint64_t n, std::uint64_t size, Use&& use);

  BinaryCursor file_;
  Processes processes_;
  Version version_;
  std::vector<Entity> entities_;
  bool has_nodes_ = false;
  std::uint64_t first_node_ = 0;           // of version 2: its byte
  std::optional<BlockIndex> node_blocks_;  // of version 4
  std::optional<BlockIndex> elements_;
  std::optional<Entities> known_entities_;  // that are listed before $Elements
};

std::uint64_t BinaryRanges::skip_space(std::uint64_t at) {
  for (;;) {
    const bool is_space = file_.at(at, kHead).at_end();
    at = file_.position();
    if (!is_space || at == file_.size()) return at;
  }
}

std::uint64_t BinaryRanges::close(const std::string& name, std::uint64_t at) {
  close_section(file_.at(skip_space(at), kHead), name);
  return file_.position();
}

/// Where the line that closes a section begins: all processes look for it, each in its part of a stretch.
std::uint64_t BinaryRanges::closing_of(const std::string& name, std::uint64_t from) {
  constexpr std::uint64_t kPart = std::uint64_t{1} << 20, kNowhere = BlockIndex::kAnyNumber;
  const std::string closing = "$End" + name;
  for (; from < file_.size(); from += processes_.n * kPart) {
    const std::uint64_t begin = from + processes_.rank * kPart;
    // With the byte before, which has to end a line, and the one behind, which has to end the word.
    const std::string part = file_.bytes(begin - 1, 1 + kPart + closing.size());
    const std::size_t at = find_closing(part, closing, 1);
    const std::uint64_t mine = at <= kPart ? begin - 1 + at : kNowhere;
    const auto found = processes_.gather(std::span<const std::uint64_t>(&mine, 1));
    const std::uint64_t first = *std::min_element(found.begin(), found.end());
    if (first != kNowhere) return first;
  }
  file_.file().fail("section $" + shown(name) + " is not closed by " + shown(closing));
}

std::uint64_t BinaryRanges::read_section(const std::string& name, std::uint64_t at) {
  if (name == "PhysicalNames")
    return read_whole(name, at, [&](BinarySource& in) {
      gmsh::read_names(in, [&](int dimension, int label, std::string text) {
        names_[{dimension, label}] = std::move(text);
      });
    });
  if ((name == "Entities" || name == "PartitionedEntities") && version_ != Version::k2)
    return read_whole(name, at, [&](BinarySource& in) {
      in.begin_data();
      read_entities4(in, version_, name == "PartitionedEntities", entities_);
    });
  if (name == "Nodes") return read_nodes(at);
  if (name == "Elements") return read_elements(at);
  if (name == "ParametricNodes" && version_ == Version::k2) fail(kNoParametricNodes);
  leave_out("$" + name);
  return name == "NodeData" || name == "ElementData" ? skip_data(at) : closing_of(name, at);
}

/// What every process has to know.
template <class Read>
std::uint64_t BinaryRanges::read_whole(const std::string& name, std::uint64_t at, Read&& read) {
  const std::uint64_t n = closing_of(name, at) - at;
  file_.file().require_short("$" + name, n);
  read(file_.at(at, n));
  return file_.position();
}

std::uint64_t BinaryRanges::skip_data(std::uint64_t at) {
  if (!elements_) fail("values stand before $Nodes and $Elements");
  const DataHeader header = read_data_header(file_.at(at, kHead));
  return file_.position() +
         header.count * BinarySource::least(1, 0, static_cast<std::size_t>(header.components));
}

std::uint64_t BinaryRanges::read_nodes(std::uint64_t at) {
  if (has_nodes_) fail("a second section of nodes");
  has_nodes_ = true;
  const std::size_t bytes = node_bytes<BinarySource>(version_);
  BinarySource& in = file_.at(at, kHead);
  if (version_ == Version::k2) {
    const std::uint64_t n = in.ascii_count();
    in.begin_data();
    n_nodes_ = bounded(in, n, bytes, "nodes");
    first_node_ = file_.position();
    return first_node_ + n_nodes_ * bytes;
  }
  in.begin_data();
  const auto [n_blocks, n_nodes] = read_totals(in, version_, bytes, "nodes");
  n_nodes_ = n_nodes;
  const auto read = [this](BinarySource& from, std::uint64_t left) { return node_heading(from, left); };
  node_blocks_.emplace(file_,
                       BlockIndex::Section{.begin = file_.position(),
                                           .n_blocks = n_blocks,
                                           .n_items = n_nodes,
                                           .heading = BinarySource::least(3, 1, 0),
                                           .what = "nodes",
                                           .read = read},
                       processes_);
  return node_blocks_->end();
}

std::uint64_t BinaryRanges::read_elements(std::uint64_t at) {
  if (!has_nodes_) fail("$Elements stands before $Nodes");
  if (elements_) fail("a second $Elements section");
  known_entities_.emplace(entities_);
  BlockIndex::Section section;
  BinarySource& in = file_.at(at, kHead);
  if (version_ == Version::k2) {
    const std::uint64_t n = in.ascii_count();
    in.begin_data();
    section.n_items = bounded(in, n, BinarySource::least(2, 0, 0), "elements");
    section.heading = BinarySource::least(3, 0, 0);
  } else {
    in.begin_data();
    const Totals totals = read_totals(in, version_, 2 * tag_bytes<BinarySource>(version_), "elements");
    section.n_blocks = totals.blocks;
    section.n_items = totals.items;
    section.heading = BinarySource::least(3, 1, 0);
  }
  n_elements_ = section.n_items;
  section.begin = file_.position();
  section.what = "elements";
  section.read = [this](BinarySource& from, std::uint64_t left) { return element_heading(from, left); };
  elements_.emplace(file_, std::move(section), processes_);
  return elements_->end();
}

Heading BinaryRanges::node_heading(BinarySource& in, std::uint64_t left) const {
  const Block block = read_block(in, version_);
  Heading heading;
  heading.n = block_count(in, block, left, node_bytes<BinarySource>(version_), "nodes");
  heading.parameters = node_parameters(in, block);
  heading.record = node_bytes<BinarySource>(version_) +
                   BinarySource::least(0, 0, static_cast<std::size_t>(heading.parameters));
  bounded(in, heading.n, heading.record, "nodes");
  return heading;
}

Heading BinaryRanges::element_heading(BinarySource& in, std::uint64_t left) const {
  Heading heading;
  const auto type_of = [&](int number) { return first_order_type(in, number); };
  if (version_ == Version::k2) {
    const Following following = read_following(in, left, type_of);
    heading.type = following.type;
    heading.n_tags = following.n_tags;
    heading.record =
        BinarySource::least(static_cast<std::size_t>(1 + heading.n_tags + heading.type.nodes), 0, 0);
    heading.n = bounded(in, static_cast<std::uint64_t>(following.n), heading.record, "elements");
    return heading;
  }
  const Block block = read_block(in, version_);
  heading.type = type_of(block.kind);
  heading.dimension = block.dimension;
  heading.entity = block.entity;
  heading.record = static_cast<std::size_t>(1 + heading.type.nodes) * tag_bytes<BinarySource>(version_);
  heading.n = block_count(in, block, left, heading.record, "elements");
  return heading;
}

/// use(in) for n records of one size, the first of which begins at byte `at`.
template <class Use>
void BinaryRanges::for_records(std::uint64_t at, std::uint64_t n, std::uint64_t size, Use&& use) {
  const std::uint64_t at_once = std::max<std::uint64_t>((std::uint64_t{1} << 20) / size, 1);
  for (std::uint64_t i = 0; i < n; i += at_once) {
    const std::uint64_t here = std::min(at_once, n - i);
    BinarySource& in = file_.at(at + i * size, here * size);
    for (std::uint64_t k = 0; k < here; ++k) use(in);
  }
}

Nodes BinaryRanges::nodes(std::uint64_t begin, std::uint64_t end) {
  Nodes found;
  const std::uint64_t tag = tag_bytes<BinarySource>(version_);
  const auto read = [&](const Heading& heading, std::uint64_t records, std::uint64_t low,
                        std::uint64_t high) {
    const auto take_tag = [&](BinarySource& in) { found.tags.push_back(mesh_tag(in, version_)); };
    const auto take_point = [&](BinarySource& in) {
      found.points.push_back(read_point(in, heading.parameters));
    };
    if (version_ != Version::k41) {
      for_records(records + low * heading.record, high - low, heading.record, [&](BinarySource& in) {
        take_tag(in);
        take_point(in);
      });
      return;
    }
    for_records(records + low * tag, high - low, tag, take_tag);
    const std::uint64_t point = heading.record - tag;
    for_records(records + heading.n * tag + low * point, high - low, point, take_point);
  };
  if (version_ == Version::k2) {
    Heading all;
    all.record = node_bytes<BinarySource>(version_);
    read(all, first_node_, begin, end);
  } else {
    node_blocks_->for_parts(begin, end, read);
  }
  return found;
}

void BinaryRanges::survey(std::uint64_t begin, std::uint64_t end, const UseKind& use) {
  elements_->for_parts(
      begin, end, [&](const Heading& heading, std::uint64_t records, std::uint64_t low, std::uint64_t high) {
        if (version_ != Version::k2) return use(kind_of_block(heading), high - low);
        if (!is_simplex(heading.type)) return use({heading.type, {}, false}, high - low);
        const auto n_nodes = static_cast<std::size_t>(heading.type.nodes);
        for_records(records + low * heading.record, high - low, heading.record, [&](BinarySource& in) {
          in.int32("a number");
          use({heading.type, read_group(in, heading.n_tags), false}, 1);
          in.seek(in.offset() + BinarySource::least(n_nodes, 0, 0));
        });
      });
}

void BinaryRanges::elements(std::uint64_t begin, std::uint64_t end, const UseElement& use) {
  elements_->for_parts(
      begin, end, [&](const Heading& heading, std::uint64_t records, std::uint64_t low, std::uint64_t high) {
        if (!is_simplex(heading.type)) return;
        Element element{heading.type.dimension, {}, {}};
        if (version_ != Version::k2) element.group = kind_of_block(heading).group;
        for_records(records + low * heading.record, high - low, heading.record, [&](BinarySource& in) {
          mesh_tag(in, version_);
          if (version_ == Version::k2) element.group = read_group(in, heading.n_tags);
          for (int k = 0; k < heading.type.corners; ++k)
            element.nodes[static_cast<std::size_t>(k)] = mesh_tag(in, version_);
          use(element);
        });
      });
}

}  // namespace

std::unique_ptr<Ranges> binary_ranges(const std::filesystem::path& path, Version version, std::uint64_t begin,
                                      const Processes& processes) {
  return std::make_unique<BinaryRanges>(path, version, begin, processes);
}

}  // namespace hfr::io::gmsh
