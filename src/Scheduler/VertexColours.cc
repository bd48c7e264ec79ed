// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/VertexColours.hh"

#include <array>
#include <bit>

#include "Scheduler/ByteTable.hh"

namespace hfr {
namespace {

/// No colour: not listed, not reached yet, or what would need a 64th.
constexpr std::uint8_t kNone = 63;
constexpr double kVertexNanoseconds = 400;

/// The first fit: each vertex in turn has the smallest colour that its neighbours before it leave.
class FirstFit {
 public:
  FirstFit(const TetMesh& mesh, std::span<const VertexHandle> vertices, const StarTable& stars)
      : mesh_(mesh), vertices_(vertices), stars_(stars), colour_(mesh.n_vertices(), vertices.size(), kNone) {}

  std::uint8_t colour(std::size_t i) const { return colour_[vertices_[i].idx()]; }

  void serially() {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (stars_.link(i).empty()) continue;
      std::uint64_t used = 0;
      for (HalfFaceHandle h : stars_.link(i))
        for (VertexHandle u : mesh_.cell(cell_of(h)).v) used |= std::uint64_t{1} << colour_[u.idx()];
      colour_.set(vertices_[i].idx(), first_free(used));
    }
  }

  /// The same: threads list the neighbours before each vertex, which is nearly all of the work; the turn of
  /// the vertices is left for one.
  void from_lists(int n_threads) {
    const int n_pieces = kPiecesAThread * n_threads;
    std::vector<Lists> lists(static_cast<std::size_t>(n_pieces));
    const auto begin_of = [&](int piece) { return par::part_begin(vertices_.size(), n_pieces, piece); };
    par::for_each_dynamic({n_threads, 0}, lists.size(), 1, [&](std::size_t p) {
      const int piece = static_cast<int>(p);
      for (std::size_t i = begin_of(piece); i < begin_of(piece + 1); ++i) list_before(i, lists[p]);
    });
    for (int piece = 0; piece < n_pieces; ++piece) {
      const Lists& mine = lists[static_cast<std::size_t>(piece)];
      auto next = mine.neighbours.begin();
      for (std::size_t i = begin_of(piece), k = 0; i < begin_of(piece + 1); ++i, ++k) {
        std::uint64_t used = 0;
        for (std::uint32_t n = mine.sizes[k]; n > 0; --n) used |= std::uint64_t{1} << colour_[*next++];
        if (!stars_.link(i).empty()) colour_.set(vertices_[i].idx(), first_free(used));
      }
    }
  }

 private:
  static constexpr int kPiecesAThread = 4;
  static constexpr std::size_t kSeen = 64;
  struct Lists {
    std::vector<Index> neighbours;     // of one vertex after the other
    std::vector<std::uint32_t> sizes;  // how many each has
  };

  static std::uint8_t first_free(std::uint64_t used) {
    return static_cast<std::uint8_t>(std::countr_one(used & ~(std::uint64_t{1} << kNone)));
  }

  /// Some may come twice: what a small table of those seen has forgotten.
  void list_before(std::size_t i, Lists& out) const {
    const Index v = vertices_[i].idx();
    std::array<Index, kSeen> seen;
    seen.fill(v);
    const std::size_t before = out.neighbours.size();
    for (HalfFaceHandle h : stars_.link(i))
      for (VertexHandle handle : mesh_.cell(cell_of(h)).v) {
        const Index u = handle.idx();
        if (u >= v || seen[u % kSeen] == u) continue;
        seen[u % kSeen] = u;
        out.neighbours.push_back(u);
      }
    out.sizes.push_back(static_cast<std::uint32_t>(out.neighbours.size() - before));
  }

  const TetMesh& mesh_;
  std::span<const VertexHandle> vertices_;
  const StarTable& stars_;
  ByteTable colour_;  // by vertex of the mesh; a byte each stays in the cache
};

}  // namespace

std::vector<std::vector<std::uint32_t>> colour_vertices(const TetMesh& mesh,
                                                        std::span<const VertexHandle> vertices,
                                                        const StarTable& stars, par::Policy policy) {
  FirstFit fit(mesh, vertices, stars);
  const int n_threads = par::thread_count(policy.for_items_of(kVertexNanoseconds), vertices.size());
  if (n_threads == 1)
    fit.serially();
  else
    fit.from_lists(n_threads);
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
