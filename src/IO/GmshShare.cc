// SPDX-License-Identifier: BSD-3-Clause
// .msh in ranges: of nodes and elements, every process reads some, and all read the entities and names. What
// is a label the whole file decides, as Collector has it.
#include <algorithm>
#include <compare>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>

#include "IO/ByteRanges.hh"
#include "IO/GmshRanges.hh"
#include "IO/MeshShare.hh"

namespace hfr::io {
namespace gmsh {
namespace {

/// Nodes whose tags ascend by one. Their numbers do so anyway, since those are their places in the file.
struct TagRun {
  std::int64_t tag = 0;
  std::uint64_t first = 0, n = 0;  ///< numbers

  bool has(std::int64_t t) const { return t >= tag && offset(t) < n; }
  std::uint64_t number(std::int64_t t) const { return first + offset(t); }

 private:
  std::uint64_t offset(std::int64_t t) const {
    return static_cast<std::uint64_t>(t) - static_cast<std::uint64_t>(tag);
  }
};
constexpr std::uint64_t kMostRuns = std::uint64_t{1} << 20;  // 25 MB on each process

/// What some elements belong to.
struct SeenGroup {
  int dimension = 0, elementary = 0, physical = 0, in_several = 0;
  auto operator<=>(const SeenGroup&) const = default;
};

class GmshShare : public MeshShare {
 public:
  GmshShare(std::unique_ptr<Ranges> file, Version version, const Processes& processes, std::uint64_t at_once)
      : file_(std::move(file)), processes_(processes), rank_(processes.rank), at_once_(at_once) {
    names_ = file_->names();
    notes_ = file_->notes();
    for (std::uint64_t r = 0; r <= processes.n; ++r)
      begins_.push_back((r * file_->n_nodes() + processes.n - 1) / processes.n);
    read_points();
    const std::uint64_t n = file_->n_elements();
    begin_ = rank_ * n / processes.n;
    end_ = (rank_ + 1) * n / processes.n;
    survey();
    if (version == Version::k2) refuse_several_groups();
    note_several_groups();
    decide_labels();
  }

  SharePoints points() override { return std::move(points_); }
  std::size_t n_portions() const override {
    return static_cast<std::size_t>((end_ - begin_ + at_once_ - 1) / at_once_);
  }
  /// In turn, from the first.
  ShareItems portion(std::size_t i) override;

 private:
  void read_points();
  void survey();
  void refuse_several_groups() const;
  void note_several_groups();
  void decide_labels();
  std::int32_t label(const Element& element) const;
  std::uint64_t node(std::int64_t tag) const;
  template <std::size_t N>
  void take(ShareElements<N>& elements, const Element& element) const;

  std::unique_ptr<Ranges> file_;
  Processes processes_;
  std::size_t rank_;
  std::uint64_t at_once_;
  SharePoints points_;
  std::vector<TagRun> runs_;             // of all nodes, by tag: Gmsh writes one, or one for each entity
  std::uint64_t begin_ = 0, end_ = 0;    // elements of this process
  std::set<SeenGroup> groups_;           // of the whole file
  bool by_physical_ = false;             // what labels are
  std::array<bool, 4> is_labelled_{};    // by dimension
  std::array<std::uint64_t, 4> next_{};  // number of the next element of this process, by dimension
};

/// Those of this process; and of all, which tags they have.
void GmshShare::read_points() {
  points_.first = begins_[rank_];
  auto [tags, points] = file_->nodes(points_.first, begins_[rank_ + 1]);
  points_.points = std::move(points);
  std::vector<TagRun> mine;
  for (std::size_t i = 0; i < tags.size() && mine.size() <= kMostRuns; ++i)
    if (i > 0 && tags[i - 1] != kLargest && tags[i] == tags[i - 1] + 1)
      ++mine.back().n;
    else
      mine.push_back({tags[i], points_.first + i, 1});
  const std::uint64_t n_mine = mine.size();
  const auto n = processes_.gather(std::span<const std::uint64_t>(&n_mine, 1));
  if (std::accumulate(n.begin(), n.end(), std::uint64_t{0}) > kMostRuns)
    file_->fail("nodes are numbered one after the other in more than " + std::to_string(kMostRuns) +
                " pieces, which is more than is read in ranges; hfremesh convert writes them in one");
  runs_ = processes_.gather(std::span<const TagRun>(mine));
  std::sort(runs_.begin(), runs_.end(), [](const TagRun& a, const TagRun& b) { return a.tag < b.tag; });
  for (std::size_t i = 1; i < runs_.size(); ++i)
    if (runs_[i - 1].has(runs_[i].tag))
      file_->fail("node " + std::to_string(runs_[i].tag) + " is given twice");
}

/// Which groups there are, and which numbers the elements of this process have among their kind.
void GmshShare::survey() {
  struct Counts {
    std::array<std::uint64_t, 4> taken{};  // by dimension
    std::uint64_t left_out = 0;
  } mine;
  std::optional<SeenGroup> last;
  file_->survey(begin_, end_, [&](const ElementKind& kind, std::uint64_t n) {
    if (!is_simplex(kind.type)) {
      mine.left_out += n;
      return;
    }
    mine.taken[static_cast<std::size_t>(kind.type.dimension)] += n;
    const SeenGroup group{kind.type.dimension, kind.group.elementary, kind.group.physical,
                          static_cast<int>(kind.in_several_groups)};
    if (last != group) groups_.insert(*(last = group));
  });
  const std::vector<SeenGroup> seen(groups_.begin(), groups_.end());
  for (const SeenGroup& group : processes_.gather(std::span<const SeenGroup>(seen))) groups_.insert(group);
  const std::vector<Counts> all = processes_.gather(std::span<const Counts>(&mine, 1));
  std::uint64_t left_out = 0;
  for (std::size_t r = 0; r < all.size(); ++r) {
    n_cells_ += all[r].taken[3];
    left_out += all[r].left_out;
    for (std::size_t d = 0; d < 4 && r < rank_; ++d) next_[d] += all[r].taken[d];
  }
  if (left_out > 0)
    notes_.push_back(std::to_string(left_out) + " quadrangles left out: only triangles are surface elements");
}

/// Of version 2, where each element says by itself what it belongs to.
void GmshShare::refuse_several_groups() const {
  const auto of_one_entity = [](const SeenGroup& a, const SeenGroup& b) {
    return a.dimension == b.dimension && a.elementary == b.elementary;
  };
  const auto found = std::adjacent_find(groups_.begin(), groups_.end(), of_one_entity);
  if (found != groups_.end())
    file_->fail("entity " + std::to_string(found->elementary) + " of dimension " +
                std::to_string(found->dimension) +
                " is in several physical groups, so its elements may stand there more than once; in ranges "
                "that is not read");
}

void GmshShare::note_several_groups() {
  const auto n =
      std::count_if(groups_.begin(), groups_.end(), [](const SeenGroup& g) { return g.in_several != 0; });
  if (n > 0)
    notes_.push_back(std::to_string(n) + (n == 1 ? " entity is" : " entities are") +
                     " in several physical groups; the first is taken");
}

/// Physical groups, or entities where the whole file has no group; one entity with the tag that writers give
/// by default is no label.
void GmshShare::decide_labels() {
  by_physical_ =
      std::any_of(groups_.begin(), groups_.end(), [](const SeenGroup& g) { return g.physical != 0; });
  for (int dimension = 0; dimension < 4; ++dimension) {
    std::set<int> labels;
    for (const SeenGroup& g : groups_)
      if (g.dimension == dimension) labels.insert(by_physical_ ? g.physical : g.elementary);
    is_labelled_[static_cast<std::size_t>(dimension)] = by_physical_ || labels != std::set<int>{1};
  }
}

std::int32_t GmshShare::label(const Element& e) const {
  if (!is_labelled_[static_cast<std::size_t>(e.dimension)]) return 0;
  return by_physical_ ? e.group.physical : e.group.elementary;
}

std::uint64_t GmshShare::node(std::int64_t tag) const {
  const auto is_below = [](std::int64_t t, const TagRun& run) { return t < run.tag; };
  const auto above = std::upper_bound(runs_.begin(), runs_.end(), tag, is_below);
  if (above == runs_.begin() || !std::prev(above)->has(tag))
    file_->fail("there is no node " + std::to_string(tag));
  return std::prev(above)->number(tag);
}

template <std::size_t N>
void GmshShare::take(ShareElements<N>& elements, const Element& e) const {
  auto& v = elements.corners.emplace_back();
  for (std::size_t k = 0; k < N; ++k) {
    v[k] = node(e.nodes[k]);
    for (std::size_t j = 0; j < k; ++j)
      if (v[j] == v[k]) file_->fail("an element has node " + std::to_string(e.nodes[k]) + " twice");
  }
  elements.labels.push_back(label(e));
}

ShareItems GmshShare::portion(std::size_t i) {
  ShareItems items;
  items.cells.first = next_[3];
  items.triangles.first = next_[2];
  items.edges.first = next_[1];
  const std::uint64_t begin = begin_ + i * at_once_;
  file_->elements(begin, std::min(begin + at_once_, end_), [&](const Element& e) {
    ++next_[static_cast<std::size_t>(e.dimension)];
    if (e.dimension == 3) take(items.cells, e);
    if (e.dimension == 2) take(items.triangles, e);
    if (e.dimension == 1) take(items.edges, e);
    if (e.dimension == 0 && label(e) != 0) items.vertex_labels.emplace_back(node(e.nodes[0]), label(e));
  });
  return items;
}

}  // namespace

void Ranges::leave_out(const std::string& section) {
  const auto add = [&](const char* what) {
    const std::string note = std::string(what) + " (" + section + ") left out";
    if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
  };
  if (section == "$NodeData") add("fields on points");
  if (section == "$ElementData") add("fields on cells");
  if (section == "$ElementNodeData") add("fields on the corners of elements");
  if (section == "$Periodic") add("links between periodic entities");
}

ElementKind kind_of(const Entities& entities, const ElementType& type, int dimension, int tag) {
  if (const Entity* const entity = entities.find(dimension, tag))
    return {type, entity->group, entity->in_several_groups};
  return {type, {.physical = 0, .elementary = tag}, false};
}

}  // namespace gmsh

/// The first line decides whether it is text.
std::unique_ptr<MeshShare> gmsh_share(const std::filesystem::path& path, const Processes& processes,
                                      std::uint64_t at_once) {
  using namespace gmsh;
  constexpr std::uint64_t kLongestHead = 4096;
  ByteRanges file(path);
  if (file.size() == 0) file.fail("the file is empty");
  const std::string head = file.bytes(0, std::min(file.size(), kLongestHead));
  TextSource in(head, file.name() + ": section $MeshFormat");
  if (in.at_end() || in.word() != "$MeshFormat") file.fail("expected $MeshFormat in the first line");
  const auto [version, is_binary] = read_format(in);
  std::unique_ptr<Ranges> ranges = is_binary ? binary_ranges(path, version, in.offset(), processes)
                                             : text_ranges(path, version, processes);
  return std::make_unique<GmshShare>(std::move(ranges), version, processes, at_once);
}

}  // namespace hfr::io
