// SPDX-License-Identifier: BSD-3-Clause
// .msh of text in ranges: nodes and elements are lines, which TextChunks counts.
#include <algorithm>
#include <optional>

#include "IO/GmshRanges.hh"
#include "IO/TextChunks.hh"

namespace hfr::io::gmsh {
namespace {

/// Nodes that follow on one another.
struct NodeBlock {
  std::uint64_t first = 0, n = 0;      ///< numbers
  std::uint64_t tags = 0, points = 0;  ///< their first lines; the same where a line has both
};

/// Elements that follow on one another: of one type and entity, or in version 2 all.
struct ElementBlock {
  ElementKind kind;
  std::uint64_t first = 0, n = 0;  ///< numbers
  std::uint64_t line = 0;
};

class TextRanges : public Ranges {
 public:
  TextRanges(const std::filesystem::path& path, Version version, const Processes& processes)
      : text_(path, {0, [](std::string_view line) { return line[0] == '$'; }}, processes), version_(version) {
    const auto& marks = text_.marks();
    if (marks.empty() || marks[0].word != "$MeshFormat" || marks[0].line != 0)
      text_.fail("expected $MeshFormat in the first line");
    for (std::size_t i = 0; i < marks.size(); ++i) read_section(i);
    if (node_blocks_.empty()) text_.fail("the file ends without a $Nodes section");
    if (!has_elements_) text_.fail("the file ends without an $Elements section");
  }

  Nodes nodes(std::uint64_t begin, std::uint64_t end) override;
  void survey(std::uint64_t begin, std::uint64_t end, const UseKind& use) override;
  void elements(std::uint64_t begin, std::uint64_t end, const UseElement& use) override;
  [[noreturn]] void fail(const std::string& message) const override { text_.fail(message); }

 private:
  void read_section(std::size_t mark);
  template <class Read>
  void read_text(std::size_t mark, Read&& read);
  /// These return the first line behind what they have read.
  std::uint64_t read_nodes(std::uint64_t line);
  std::uint64_t read_elements(std::uint64_t line);
  NodeBlock next_nodes(std::uint64_t line);
  ElementBlock next_elements(std::uint64_t line, const Entities& entities);
  void require_lines(std::uint64_t begin, std::uint64_t n, const char* what) const {
    if (begin > text_.n_lines() || n > text_.n_lines() - begin)
      text_.fail(std::to_string(n) + " " + what + " are announced, but the file ends before");
  }
  /// The count with which a section of version 2 begins, whose lines follow.
  std::uint64_t count(std::uint64_t line, const char* what) {
    const auto n = static_cast<std::uint64_t>(text_.at_line(
        line, [&](TextLine& in) { return in.integer_in(0, kLargest, "number of " + std::string(what)); }));
    require_lines(line + 1, n, what);
    return n;
  }
  /// How many blocks and items a section of version 4 has.
  std::pair<std::int64_t, std::uint64_t> totals(std::uint64_t line) {
    return text_.at_line(line, [](TextLine& in) {
      const auto blocks = in.integer_in(0, kLargest, "number of blocks");
      return std::pair(blocks, static_cast<std::uint64_t>(in.integer_in(0, kLargest, "number of items")));
    });
  }
  void require_all(std::uint64_t found, std::uint64_t announced, const char* what) const {
    if (found != announced)
      text_.fail(std::to_string(announced) + " " + what + " are announced, but the blocks hold " +
                 std::to_string(found));
  }
  /// use(block, begin, end) for parts of blocks, by their own numbers.
  template <class Block, class Use>
  static void for_parts(const std::vector<Block>& blocks, std::uint64_t begin, std::uint64_t end, Use&& use);
  ElementKind kind_of_line(TextLine& in) const;

  TextChunks text_;
  Version version_;
  std::vector<Entity> entities_;
  std::vector<NodeBlock> node_blocks_;
  std::vector<ElementBlock> element_blocks_;
  bool has_elements_ = false;
};

void TextRanges::read_section(std::size_t mark) {
  const TextChunks::Mark& found = text_.marks()[mark];
  const std::string& name = found.word;
  if (name.starts_with("$End")) return;
  if (mark + 1 == text_.marks().size() || text_.marks()[mark + 1].word != "$End" + name.substr(1))
    text_.fail("section " + shown(name) + " is not closed");
  const auto read_lines = [&](auto&& read) {
    text_.at_line(found.line, [](TextLine& in) {
      in.word();
      in.finish();
      return true;
    });
    if (read(found.line + 1) != text_.marks()[mark + 1].line)
      text_.fail("section " + name + " has another number of lines than it announces");
  };
  if (name == "$PhysicalNames")
    read_text(mark, [&](TextSource& in) {
      gmsh::read_names(in, [&](int dimension, int label, std::string text) {
        names_[{dimension, label}] = std::move(text);
      });
    });
  if (version_ != Version::k2 && (name == "$Entities" || name == "$PartitionedEntities"))
    read_text(mark, [&](TextSource& in) { read_entities4(in, version_, name != "$Entities", entities_); });
  if (name == "$Nodes") {
    if (!node_blocks_.empty()) text_.fail("a second section of nodes");
    read_lines([&](std::uint64_t line) { return read_nodes(line); });
  }
  if (name == "$Elements") {
    if (has_elements_) text_.fail("a second $Elements section");
    has_elements_ = true;
    read_lines([&](std::uint64_t line) { return read_elements(line); });
  }
  if (name == "$ParametricNodes") text_.fail(kNoParametricNodes);
  leave_out(name);
}

/// What stands in the section, for all processes.
template <class Read>
void TextRanges::read_text(std::size_t mark, Read&& read) {
  const auto& marks = text_.marks();
  const std::string section = text_.between(marks[mark], marks[mark + 1]);
  TextSource in(section, text_.name() + ": section " + marks[mark].word);
  read(in);
}

/// The block whose heading is this line.
NodeBlock TextRanges::next_nodes(std::uint64_t line) {
  const auto n = static_cast<std::uint64_t>(text_.at_line(line, [](TextLine& in) {
    for (int k = 0; k < 3; ++k) in.integer();  // dimension, entity, whether points have parameters
    return in.integer_in(0, kLargest, "number of nodes");
  }));
  require_lines(line + 1, n, "nodes");
  if (version_ == Version::k40) return {n_nodes_, n, line + 1, line + 1};
  require_lines(line + 1 + n, n, "nodes");
  return {n_nodes_, n, line + 1, line + 1 + n};
}

std::uint64_t TextRanges::read_nodes(std::uint64_t line) {
  if (version_ == Version::k2) {
    n_nodes_ = count(line, "nodes");
    node_blocks_.push_back({0, n_nodes_, line + 1, line + 1});
    return line + 1 + n_nodes_;
  }
  const auto [n_blocks, n] = totals(line);
  std::uint64_t at = line + 1;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    node_blocks_.push_back(next_nodes(at));
    n_nodes_ += node_blocks_.back().n;
    at = node_blocks_.back().points + node_blocks_.back().n;
  }
  require_all(n_nodes_, n, "nodes");
  return at;
}

ElementBlock TextRanges::next_elements(std::uint64_t line, const Entities& entities) {
  ElementBlock block = text_.at_line(line, [&](TextLine& in) {
    ElementBlock found;
    int dimension = in.label(), entity = in.label();
    if (version_ == Version::k40) std::swap(dimension, entity);
    found.kind = kind_of(entities, first_order_type(in, in.integer()), dimension, entity);
    found.n = static_cast<std::uint64_t>(in.integer_in(0, kLargest, "number of elements"));
    return found;
  });
  block.first = n_elements_;
  block.line = line + 1;
  require_lines(block.line, block.n, "elements");
  return block;
}

std::uint64_t TextRanges::read_elements(std::uint64_t line) {
  if (version_ == Version::k2) {
    n_elements_ = count(line, "elements");
    element_blocks_.push_back({{}, 0, n_elements_, line + 1});
    return line + 1 + n_elements_;
  }
  const Entities entities(entities_);
  const auto [n_blocks, n] = totals(line);
  std::uint64_t at = line + 1;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const ElementBlock block = next_elements(at, entities);
    at = block.line + block.n;
    n_elements_ += block.n;
    if (block.n > 0) element_blocks_.push_back(block);
  }
  require_all(n_elements_, n, "elements");
  return at;
}

template <class Block, class Use>
void TextRanges::for_parts(const std::vector<Block>& blocks, std::uint64_t begin, std::uint64_t end,
                           Use&& use) {
  const auto is_behind = [&](std::uint64_t number, const Block& block) { return number < block.first; };
  auto block = std::upper_bound(blocks.begin(), blocks.end(), begin, is_behind);
  if (block != blocks.begin()) --block;
  for (; block != blocks.end() && block->first < end; ++block) {
    const std::uint64_t low = std::max(begin, block->first), high = std::min(end, block->first + block->n);
    if (low < high) use(*block, low - block->first, high - block->first);
  }
}

Nodes TextRanges::nodes(std::uint64_t begin, std::uint64_t end) {
  Nodes found;
  const auto take_tag = [&](TextLine& in) { found.tags.push_back(in.integer()); };
  const auto take_point = [&](TextLine& in) {
    const double x = in.real(), y = in.real();
    found.points.push_back({x, y, in.real()});
  };
  for_parts(node_blocks_, begin, end, [&](const NodeBlock& block, std::uint64_t low, std::uint64_t high) {
    if (block.tags == block.points) {
      text_.for_lines(block.tags + low, block.tags + high, [&](std::uint64_t, TextLine& in) {
        take_tag(in);
        take_point(in);
      });
      return;
    }
    text_.for_lines(block.tags + low, block.tags + high, [&](std::uint64_t, TextLine& in) {
      take_tag(in);
      in.finish();
    });
    text_.for_lines(block.points + low, block.points + high,
                    [&](std::uint64_t, TextLine& in) { take_point(in); });
  });
  return found;
}

/// Of version 2, from behind the element's number up to its nodes.
ElementKind TextRanges::kind_of_line(TextLine& in) const {
  ElementKind kind;
  kind.type = first_order_type(in, in.integer());
  const auto n_tags = in.integer_in(0, 1 << 16, "number of tags");
  for (std::int64_t k = 0; k < n_tags; ++k) {
    const int tag = in.label();
    if (k == 0) kind.group.physical = tag;
    if (k == 1) kind.group.elementary = tag;
  }
  return kind;
}

void TextRanges::survey(std::uint64_t begin, std::uint64_t end, const UseKind& use) {
  for_parts(element_blocks_, begin, end,
            [&](const ElementBlock& block, std::uint64_t low, std::uint64_t high) {
              if (version_ != Version::k2) return use(block.kind, high - low);
              text_.for_lines(block.line + low, block.line + high, [&](std::uint64_t, TextLine& in) {
                in.integer();
                use(kind_of_line(in), 1);
              });
            });
}

void TextRanges::elements(std::uint64_t begin, std::uint64_t end, const UseElement& use) {
  for_parts(element_blocks_, begin, end,
            [&](const ElementBlock& block, std::uint64_t low, std::uint64_t high) {
              if (version_ != Version::k2 && !is_simplex(block.kind.type)) return;
              text_.for_lines(block.line + low, block.line + high, [&](std::uint64_t, TextLine& in) {
                in.integer();
                const ElementKind kind = version_ == Version::k2 ? kind_of_line(in) : block.kind;
                if (!is_simplex(kind.type)) return;
                Element element{kind.type.dimension, kind.group, {}};
                for (int k = 0; k < kind.type.corners; ++k)
                  element.nodes[static_cast<std::size_t>(k)] = in.integer();
                in.finish();
                use(element);
              });
            });
}

}  // namespace

std::unique_ptr<Ranges> text_ranges(const std::filesystem::path& path, Version version,
                                    const Processes& processes) {
  return std::make_unique<TextRanges>(path, version, processes);
}

}  // namespace hfr::io::gmsh
