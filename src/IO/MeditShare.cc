// SPDX-License-Identifier: BSD-3-Clause
// .mesh and .meshb in ranges: of each section, every process reads some entries.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <tuple>

#include "HalfFace/Errors.hh"
#include "IO/ByteRanges.hh"
#include "IO/MeditSource.hh"
#include "IO/MeshShare.hh"
#include "IO/TextChunks.hh"

namespace hfr::io {
namespace {

using medit::Keyword;

/// Entries of a section: lines of a text, or bytes.
struct Section {
  medit::Heading heading;
  std::string name;
  std::uint64_t n = 0;
  std::uint64_t begin = 0;    ///< first line, or byte
  std::uint64_t n_lines = 0;  ///< of a text; 0 of bytes
  std::uint64_t end = 0;      ///< of bytes: where the next one begins; 0 of a text
};

class TextSections {
 public:
  TextSections(const std::filesystem::path& path, const Processes& processes)
      : text_(path, {'#', [](std::string_view line) { return 'A' <= line[0] && line[0] <= 'Z'; }}, processes),
        rank_(processes.rank),
        n_processes_(processes.n) {
    const auto& marks = text_.marks();
    const bool has_first = !marks.empty() && marks[0].line == 0;
    if (!has_first || marks[0].word != "MeshVersionFormatted")
      text_.fail(medit::no_medit_file(has_first ? marks[0].word : ""));
    read_alone(0, 1, 4);
    for (std::size_t i = 1; i < marks.size() && !has_end_; ++i) {
      const medit::Heading heading = medit::heading_of(marks[i].word);
      if (heading.keyword == Keyword::kEnd)
        has_end_ = true;
      else if (heading.keyword == Keyword::kDimension)
        read_alone(i, 3, 3);
      else
        add(i, heading);
    }
  }

  const std::vector<Section>& sections() const { return sections_; }
  bool has_end() const { return has_end_; }
  /// use(entry, number of the entry) for some entries, each with so many integers behind so many reals.
  template <class Use>
  void read(const Section& section, std::uint64_t begin, std::uint64_t end, std::size_t, std::size_t,
            Use&& use) {
    text_.for_lines(section.begin + begin, section.begin + end, [&](std::uint64_t line, TextLine& in) {
      use(in, line - section.begin);
      in.finish();
    });
  }
  /// Expects no keyword in a section that is left out: one that does not begin a line has not been seen. Each
  /// process looks at its part.
  void leave_out(const Section& section) {
    const auto first_of = [&](std::size_t rank) {
      return section.begin + section.n_lines * rank / n_processes_;
    };
    text_.for_lines(first_of(rank_), first_of(rank_ + 1), [](std::uint64_t, TextLine& in) {
      in.word();
      while (in.has_more())
        if (const std::string_view word = in.word(); medit::is_keyword(word))
          in.fail(std::string(word) +
                  " stands inside a line; in ranges, files are read whose keywords begin one");
    });
  }
  [[noreturn]] void fail(const std::string& message) const { text_.fail(message); }

 private:
  /// The number behind a keyword, and the line after it.
  std::pair<std::uint64_t, std::uint64_t> count(std::size_t mark, std::int64_t low, std::int64_t high) {
    const std::uint64_t line = text_.marks()[mark].line;
    const auto read = [&](TextLine& in) {
      const std::int64_t found = in.integer_in(low, high, "number of entries");
      in.finish();
      return found;
    };
    const std::int64_t here = text_.at_line(line, [&](TextLine& in) {
      in.word();
      return in.has_more() ? read(in) : std::int64_t{-1};
    });
    if (here >= 0) return {static_cast<std::uint64_t>(here), line + 1};
    return {static_cast<std::uint64_t>(text_.at_line(line + 1, read)), line + 2};
  }
  std::uint64_t end_of(std::size_t mark) const {
    return mark + 1 < text_.marks().size() ? text_.marks()[mark + 1].line : text_.n_lines();
  }
  /// A keyword with a number and no entries.
  void read_alone(std::size_t mark, std::int64_t low, std::int64_t high) {
    if (count(mark, low, high).second != end_of(mark))
      fail(text_.marks()[mark].word + ": a keyword has to follow");
  }
  void add(std::size_t mark, const medit::Heading& heading) {
    Section section{heading, text_.marks()[mark].word, 0, text_.marks()[mark].line, 0, 0};
    const std::uint64_t end = end_of(mark);
    if (heading.keyword != Keyword::kUnknown) {
      std::tie(section.n, section.begin) = count(mark, 0, std::numeric_limits<std::int64_t>::max());
      const std::uint64_t found = end - std::min(end, section.begin);
      if (found < section.n)
        fail(medit::too_few_entries(section.name, static_cast<std::int64_t>(section.n), found) +
             " lines; in ranges, files are read that have each entry on a line of its own");
      if (found > section.n) fail(section.name + ": there are more entries than it says");
    }
    section.n_lines = end - std::min(end, section.begin);
    sections_.push_back(std::move(section));
  }

  TextChunks text_;
  std::size_t rank_, n_processes_;
  std::vector<Section> sections_;
  bool has_end_ = false;
};

/// An entry of a binary file while it is read.
class BinaryEntry {
 public:
  BinaryEntry(std::string_view bytes, int version, bool swap)
      : left_(bytes), version_(version), swap_(swap) {}

  double real() { return version_ == 1 ? take<float>() : take<double>(); }
  std::int64_t integer() { return version_ < 4 ? take<std::int32_t>() : take<std::int64_t>(); }
  std::int64_t integer_in(std::int64_t low, std::int64_t high, std::string_view what) {
    const std::int64_t found = integer();
    if (found < low || found > high)
      throw InvalidInput(std::string(what) + " " + std::to_string(found) + " is out of range (" +
                         std::to_string(low) + " to " + std::to_string(high) + ")");
    return found;
  }
  int label() {
    using Limits = std::numeric_limits<int>;
    return static_cast<int>(integer_in(Limits::min(), Limits::max(), "label"));
  }
  template <class T>
  T take() {
    std::array<char, sizeof(T)> raw{};
    if (left_.size() < raw.size()) throw InvalidInput("the file ends too early");
    std::copy_n(left_.begin(), raw.size(), raw.begin());
    left_.remove_prefix(raw.size());
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

 private:
  std::string_view left_;
  int version_;
  bool swap_;
};

class BinarySections {
 public:
  BinarySections(const std::filesystem::path& path, const Processes&) : in_(path) {
    const std::string head = bytes(0, 8);
    swap_ = head[0] == 0;
    BinaryEntry in(head, 1, swap_);
    in.take<std::int32_t>();
    version_ = in.take<std::int32_t>();
    if (version_ < 1 || version_ > 4) fail("this version is not known (1 to 4 are)");
    for (std::uint64_t at = 8; at != 0 && at < in_.size() && !has_end_;) at = add(at);
  }

  const std::vector<Section>& sections() const { return sections_; }
  bool has_end() const { return has_end_; }
  template <class Use>
  void read(const Section& section, std::uint64_t begin, std::uint64_t end, std::size_t reals,
            std::size_t integers, Use&& use) {
    const std::uint64_t size = entry_size(reals, integers);
    constexpr std::uint64_t kAtOnce = std::uint64_t{1} << 16;
    if (end > 0 && (section.end - section.begin) / size < end)
      fail(medit::too_few_entries(section.name, static_cast<std::int64_t>(section.n),
                                  (section.end - section.begin) / size));
    for (std::uint64_t i = begin; i < end; i += kAtOnce) {
      const std::uint64_t n = std::min(kAtOnce, end - i);
      const std::string text = bytes(section.begin + i * size, n * size);
      for (std::uint64_t k = 0; k < n; ++k) {
        BinaryEntry entry(std::string_view(text).substr(k * size, size), version_, swap_);
        try {
          use(entry, i + k);
        } catch (const InvalidInput& error) {
          fail(section.name + " " + std::to_string(i + k + 1) + ": " + error.what());
        }
      }
    }
  }
  /// Where a section ends is said by its beginning.
  void leave_out(const Section&) {}
  [[noreturn]] void fail(const std::string& message) const { in_.fail(message); }

 private:
  std::uint64_t entry_size(std::size_t reals, std::size_t integers) const {
    return reals * (version_ == 1 ? 4 : 8) + integers * (version_ < 4 ? 4 : 8);
  }
  std::string bytes(std::uint64_t begin, std::uint64_t n) {
    if (begin > in_.size() || n > in_.size() - begin) fail("the file ends too early");
    return in_.bytes(begin, n);
  }
  /// The section that begins here. Returns where the next one does; 0: there is none.
  std::uint64_t add(std::uint64_t at) {
    const std::uint64_t n_head = 4 + (version_ < 3 ? 4 : 8);
    const std::string head = bytes(at, n_head);
    BinaryEntry in(head, version_, swap_);
    const medit::Heading heading = medit::heading_of(in.take<std::int32_t>());
    const std::uint64_t next = version_ < 3 ? in.take<std::uint32_t>() : in.take<std::uint64_t>();
    if (heading.keyword == Keyword::kEnd) {
      has_end_ = true;
      return 0;
    }
    if (next != 0 && (next < at + n_head || next > in_.size()))
      fail("the position of the next section, " + std::to_string(next) + ", is outside the file");
    if (heading.keyword == Keyword::kDimension) {
      const std::string text = bytes(at + n_head, 4);
      if (BinaryEntry(text, version_, swap_).take<std::int32_t>() != 3) fail("only dimension 3 is read");
      return next;
    }
    Section section{
        heading, heading.name.empty() ? "section " + std::to_string(heading.code) : std::string(heading.name),
        0,       0,
        0,       next != 0 ? next : in_.size()};
    const std::uint64_t n_count = version_ < 4 ? 4 : 8;
    if (!heading.name.empty()) {
      const std::string text = bytes(at + n_head, n_count);
      section.n =
          static_cast<std::uint64_t>(std::max<std::int64_t>(BinaryEntry(text, version_, swap_).integer(), 0));
      section.begin = at + n_head + n_count;
      if (section.begin > section.end) fail("section " + section.name + " ends before its entries begin");
      if (section.n > in_.size())
        fail(medit::too_few_entries(section.name, static_cast<std::int64_t>(section.n), 0));
    }
    sections_.push_back(std::move(section));
    return next;
  }

  ByteRanges in_;
  int version_ = 0;
  bool swap_ = false, has_end_ = false;
  std::vector<Section> sections_;
};

template <class Sections>
class MeditShare : public MeshShare {
 public:
  MeditShare(const std::filesystem::path& path, const Processes& processes, std::uint64_t at_once)
      : file_(path, processes), rank_(processes.rank) {
    for (const Section& section : file_.sections()) sort(section);
    if (!file_.has_end()) notes_.emplace_back("the file has no End; it may have been cut short");
    if (!vertices_) file_.fail("there are no Vertices");
    for (std::uint64_t r = 0; r <= processes.n; ++r)
      begins_.push_back((r * vertices_->n + processes.n - 1) / processes.n);
    for (const auto& [section, kind] : elements_) {
      if (kind == Kind::kCells) n_cells_ = section.n;
      const std::uint64_t end = (rank_ + 1) * section.n / processes.n;
      for (std::uint64_t i = rank_ * section.n / processes.n; i < end; i += at_once)
        portions_.push_back({section, kind, i, std::min(i + at_once, end)});
    }
    note_required(path);
  }

  SharePoints points() override {
    SharePoints points;
    points.first = begins_[rank_];
    file_.read(*vertices_, points.first, begins_[rank_ + 1], 3, 1, [&](auto& in, std::uint64_t) {
      Vec3 p;
      p.x = coordinate(in);
      p.y = coordinate(in);
      p.z = coordinate(in);
      points.points.push_back(p);
      points.labels.push_back(in.label());
    });
    return points;
  }
  std::size_t n_portions() const override { return portions_.size(); }
  ShareItems portion(std::size_t i) override {
    ShareItems items;
    const Portion& portion = portions_[i];
    switch (portion.kind) {
      case Kind::kCells:
        read(portion, items.cells);
        break;
      case Kind::kTriangles:
        read(portion, items.triangles);
        fix_corners(items.triangles, required_triangles_, items.fixed);
        break;
      case Kind::kEdges:
        read(portion, items.edges);
        fix_corners(items.edges, required_edges_, items.fixed);
        break;
      case Kind::kFixed:
        file_.read(portion.section, portion.begin, portion.end, 0, 1,
                   [&](auto& in, std::uint64_t) { items.fixed.push_back(vertex(in)); });
        break;
    }
    return items;
  }

 private:
  enum class Kind { kCells, kTriangles, kEdges, kFixed };
  struct Portion {
    Section section;
    Kind kind;
    std::uint64_t begin, end;
  };

  void sort(const Section& section) {
    const auto add = [&](Kind kind) {
      const auto is_second = [&](const auto& one) { return one.second == kind; };
      if (kind != Kind::kFixed && std::any_of(elements_.begin(), elements_.end(), is_second))
        file_.fail("a second section " + section.name + "; in ranges, files are read that have one");
      elements_.emplace_back(section, kind);
    };
    switch (section.heading.keyword) {
      case Keyword::kVertices:
        if (vertices_) file_.fail("a second section Vertices; in ranges, files are read that have one");
        vertices_ = section;
        return;
      case Keyword::kTetrahedra:
        return add(Kind::kCells);
      case Keyword::kTriangles:
        return add(Kind::kTriangles);
      case Keyword::kEdges:
        return add(Kind::kEdges);
      case Keyword::kCorners:
        if (section.n > 0)
          notes_.push_back("Corners (" + std::to_string(section.n) + "): kept as fixed vertices");
        return add(Kind::kFixed);
      case Keyword::kRequiredVertices:
        return add(Kind::kFixed);
      case Keyword::kRequiredTriangles:
        return read_required(section, required_triangles_);
      case Keyword::kRequiredEdges:
        return read_required(section, required_edges_);
      default:
        return skip(section);
    }
  }
  void skip(const Section& section) {
    const Keyword k = section.heading.keyword;
    const bool is_curved =
        k == Keyword::kTetrahedraP2 || k == Keyword::kTrianglesP2 || k == Keyword::kEdgesP2;
    if (section.n > 0 && (is_curved || medit::is_unsupported_cell(section.name)))
      file_.fail(std::to_string(section.n) + " " + section.name +
                 ": in ranges, only tetrahedra, triangles and edges of first order are read");
    file_.leave_out(section);
    if (section.n > 0 || k == Keyword::kUnknown)
      notes_.push_back(section.name + (section.n > 0 ? " (" + std::to_string(section.n) + ")" : "") +
                       " is not kept");
  }
  /// All of them, on every process: which one has an element nobody knows.
  void read_required(const Section& section, std::vector<std::uint64_t>& numbers) {
    file_.read(section, 0, section.n, 0, 1, [&](auto& in, std::uint64_t) {
      numbers.push_back(static_cast<std::uint64_t>(in.integer_in(1, kMost, "number")) - 1);
    });
    std::sort(numbers.begin(), numbers.end());
  }
  void note_required(const std::filesystem::path& path) {
    const auto note = [&](const std::vector<std::uint64_t>& numbers, Kind kind, const std::string& what) {
      if (numbers.empty()) return;
      std::uint64_t n = 0;
      for (const auto& [section, of] : elements_) n += of == kind ? section.n : 0;
      if (numbers.back() >= n)
        file_.fail(what + " " + std::to_string(numbers.back() + 1) + " is out of range (the file has " +
                   std::to_string(n) + ")");
      notes_.push_back(what + " (" + std::to_string(numbers.size()) + "): kept by fixing their vertices");
    };
    note(required_edges_, Kind::kEdges, "RequiredEdges");
    note(required_triangles_, Kind::kTriangles, "RequiredTriangles");
    for (const char* extension : {".sol", ".solb"}) {
      std::error_code error;
      const auto beside = std::filesystem::path(path).replace_extension(extension);
      if (std::filesystem::exists(beside, error)) notes_.push_back(beside.string() + " left out");
    }
  }

  template <class In>
  double coordinate(In& in) const {
    const double value = in.real();
    if (!std::isfinite(value)) file_.fail("a coordinate is not finite");
    return value;
  }
  template <class In>
  std::uint64_t vertex(In& in) const {
    return static_cast<std::uint64_t>(in.integer_in(1, static_cast<std::int64_t>(vertices_->n), "vertex")) -
           1;
  }
  template <std::size_t N>
  void read(const Portion& portion, ShareElements<N>& elements) {
    elements.first = portion.begin;
    file_.read(portion.section, portion.begin, portion.end, 0, N + 1, [&](auto& in, std::uint64_t i) {
      auto& v = elements.corners.emplace_back();
      for (std::size_t k = 0; k < N; ++k) {
        v[k] = vertex(in);
        if (std::find(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(k), v[k]) !=
            v.begin() + static_cast<std::ptrdiff_t>(k))
          file_.fail(portion.section.name + " " + std::to_string(i + 1) +
                     ": two of its vertices are the same");
      }
      elements.labels.push_back(in.label());
    });
  }
  template <std::size_t N>
  static void fix_corners(const ShareElements<N>& elements, const std::vector<std::uint64_t>& required,
                          std::vector<std::uint64_t>& fixed) {
    for (std::size_t i = 0; i < elements.corners.size(); ++i)
      if (std::binary_search(required.begin(), required.end(), elements.first + i))
        fixed.insert(fixed.end(), elements.corners[i].begin(), elements.corners[i].end());
  }

  static constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  Sections file_;
  std::size_t rank_;
  std::optional<Section> vertices_;
  std::vector<std::pair<Section, Kind>> elements_;
  std::vector<std::uint64_t> required_triangles_, required_edges_;  // ascending
  std::vector<Portion> portions_;
};

}  // namespace

/// Files are called .mesh or .meshb, but the first bytes decide.
std::unique_ptr<MeshShare> medit_share(const std::filesystem::path& path, const Processes& processes,
                                       std::uint64_t at_once) {
  std::string head(4, ' ');
  std::ifstream(path, std::ios::binary).read(head.data(), 4);
  const bool is_binary = head == std::string("\1\0\0\0", 4) || head == std::string("\0\0\0\1", 4);
  if (is_binary) return std::make_unique<MeditShare<BinarySections>>(path, processes, at_once);
  return std::make_unique<MeditShare<TextSections>>(path, processes, at_once);
}

}  // namespace hfr::io
