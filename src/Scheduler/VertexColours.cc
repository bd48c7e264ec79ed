// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/VertexColours.hh"

#include <algorithm>
#include <bit>

#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"

namespace hfr {
namespace {

/// No colour: not listed, not reached yet, or what would need a 64th.
constexpr std::uint8_t kNone = 63;
constexpr double kVertexNanoseconds = 400;
/// The parallel way looks at three times as many colours: it pays from this many threads on.
constexpr int kTogetherThreads = 4;

class FirstFit {
 public:
  FirstFit(const TetMesh& mesh, std::span<const VertexHandle> vertices, const StarTable& stars)
      : mesh_(mesh), vertices_(vertices), stars_(stars), colour_(mesh.n_vertices(), kNone) {}

  std::uint8_t colour(std::size_t i) const { return colour_[vertices_[i].idx()]; }

  void serially() {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (stars_.link(i).empty()) continue;
      std::uint64_t used = 0;
      for (HalfFaceHandle h : stars_.link(i))
        for (VertexHandle u : mesh_.cell(cell_of(h)).v) used |= std::uint64_t{1} << colour_[u.idx()];
      colour_[vertices_[i].idx()] = first_free(used);
    }
  }

  /// The first fit is the one colouring where each vertex has the smallest colour that its predecessors
  /// leave. Threads colour a range each from what they see of the others', and mark for another look each
  /// successor elsewhere whose ground they changed, until nothing is marked. Whoever sees a colour too early
  /// is marked after it was set, so the end does not depend on who was first; within a range, corrections run
  /// along in order, so there are few repetitions.
  void together(int n_parts) {
    marked_.assign(mesh_.n_vertices(), 0);
    const auto part_of = [&](int part) { return par::part_begin(vertices_.size(), n_parts, part); };
    par::parts(n_parts, [&](int part) {
      const std::size_t end = part_of(part + 1);
      const std::size_t beyond = end < vertices_.size() ? vertices_[end].idx() : mesh_.n_vertices();
      for (std::size_t i = part_of(part); i < end; ++i) look<std::memory_order_relaxed>(i, beyond);
    });
    std::vector<std::uint8_t> busy(static_cast<std::size_t>(n_parts));
    do {
      par::parts(n_parts, [&](int part) {
        std::uint8_t found = 0;
        for (std::size_t i = part_of(part); i < part_of(part + 1); ++i) {
          const auto mark = par::atomic(marked_[vertices_[i].idx()]);
          par::before_shared_access();
          if (!mark.load()) continue;
          par::before_shared_access();
          mark.store(0);
          look<std::memory_order_seq_cst>(i, vertices_[i].idx() + 1);
          found = 1;
        }
        busy[static_cast<std::size_t>(part)] = found;
      });
    } while (std::any_of(busy.begin(), busy.end(), [](std::uint8_t found) { return found != 0; }));
  }

 private:
  static std::uint8_t first_free(std::uint64_t used) {
    return static_cast<std::uint8_t>(std::countr_one(used & ~(std::uint64_t{1} << kNone)));
  }

  /// Colours vertex number i by its predecessors; when that is news, marks its successors from `beyond` on.
  /// Once marks are taken away, too, reads and writes have to be in one order (seq_cst): who takes its mark
  /// and still sees an old colour is marked again.
  template <std::memory_order kOrder>
  void look(std::size_t i, std::size_t beyond) {
    if (stars_.link(i).empty()) return;
    const VertexHandle v = vertices_[i];
    std::uint8_t* const colours = colour_.data();
    std::uint64_t used = 0;
    VertexHandle last = v;
    for (HalfFaceHandle h : stars_.link(i)) {
      par::before_shared_access();
      for (VertexHandle u : mesh_.cell(cell_of(h)).v) {
        const std::uint8_t theirs = par::atomic(colours[u.idx()]).load(kOrder);
        used |= std::uint64_t{1} << (u < v ? theirs : kNone);  // no jump: half would go either way
        last = std::max(last, u);
      }
    }
    const auto mine = par::atomic(colours[v.idx()]);
    const std::uint8_t colour = first_free(used);
    if (mine.load(kOrder) == colour) return;
    par::before_shared_access();
    mine.store(colour, kOrder);
    if (last.idx() < beyond) return;
    for (HalfFaceHandle h : stars_.link(i)) {
      par::before_shared_access();
      for (VertexHandle u : mesh_.cell(cell_of(h)).v)
        if (u.idx() >= beyond) par::atomic(marked_[u.idx()]).store(1, kOrder);
    }
  }

  const TetMesh& mesh_;
  std::span<const VertexHandle> vertices_;
  const StarTable& stars_;
  std::vector<std::uint8_t> colour_;  // by vertex of the mesh; a byte each stays in the cache
  std::vector<std::uint8_t> marked_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> colour_vertices(const TetMesh& mesh,
                                                        std::span<const VertexHandle> vertices,
                                                        const StarTable& stars, par::Policy policy) {
  FirstFit fit(mesh, vertices, stars);
  const int n_parts = par::thread_count(policy.for_items_of(kVertexNanoseconds), vertices.size());
  if (n_parts < kTogetherThreads)
    fit.serially();
  else
    fit.together(n_parts);
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint32_t> alone;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::uint8_t colour = fit.colour(i);
    const auto number = static_cast<std::uint32_t>(i);
    if (stars.link(i).empty()) continue;
    if (colour == kNone) {
      alone.push_back(number);
      continue;
    }
    if (colour == groups.size()) groups.emplace_back();
    groups[colour].push_back(number);
  }
  for (std::uint32_t i : alone) groups.push_back({i});
  return groups;
}

}  // namespace hfr
