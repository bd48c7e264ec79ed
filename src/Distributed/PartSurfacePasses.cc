// SPDX-License-Identifier: BSD-3-Clause
// The passes of SurfacePasses over a mesh in parts: the same seeds and operators. What the winners of all
// ranks have done to the surface goes to all of them, which tell it to theirs in rank order.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "Distributed/CutoutRound.hh"
#include "Distributed/LookOptions.hh"
#include "Distributed/PartRound.hh"
#include "Distributed/PartSmoothing.hh"
#include "Distributed/PartSurfaceImpl.hh"
#include "Remesh/SurfaceSeeds.hh"
#include "Surface/InterfaceSwap.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceSmooth.hh"
#include "Surface/SurfaceSplit.hh"
#include "Surface/SurfaceSwap.hh"

namespace hfr::mpi {
namespace {

/// Layers round the edges that are split which are tried first: see round_on_cutout().
constexpr std::uint8_t kSplitDepth = 2;
/// Layers that a collapse has to know: each vertex of what goes has all its cells there.
constexpr std::uint8_t kCollapseDepth = 2;

/// Two vertices of a winner, by number.
struct Told {
  PartRound::Place place;
  std::array<std::uint64_t, 2> v{};
};

struct Moved {
  std::uint64_t number = 0;
  Vec3 point;
};

/// What a winner on a cutout has done: vertices by number, and where the new one is.
struct Changed {
  std::uint64_t order = 0;
  std::array<std::uint64_t, 3> v{};
  Vec3 place;
};

/// A seed on a cutout: its cell, and the edge there or the number of a vertex of it.
struct SeedPlace {
  std::uint64_t cell = 0, which = 0;
  auto operator<=>(const SeedPlace&) const = default;
};

}  // namespace

template <class Metric>
class PartSurface::Passes {
 public:
  Passes(Impl& impl, const Ranks::SurfaceLook& look, const Worklist& list, const Metric& metric)
      : impl_(impl),
        parts_(impl.parts),
        comm_(impl.parts.comm()),
        mesh_(impl.parts.part()),
        work_(impl.parts.work()),
        surface_(impl.seen->get()),
        look_(look),
        list_(list),
        metric_(metric) {}

  template <class Op>
  RoundCounts swaps(bool inside);
  RoundCounts collapses();
  RoundCounts moves();
  RoundCounts offsets();
  RoundCounts splits();

 private:
  par::Policy policy() const { return par::Policy{look_.look.threads}; }
  /// Links are checked, and no bound on cells counts, but for what is split.
  Ranks::Look of_round() const {
    Ranks::Look look = look_.look;
    look.check_links = true;
    look.may_lose = std::numeric_limits<std::uint64_t>::max();
    if (look_.pass != SurfacePass::kSplit) look.may_gain = look.may_lose;
    return look;
  }
  /// Ascending, each once.
  static std::vector<std::uint64_t> cells_of(std::span<const SeedPlace> places) {
    std::vector<std::uint64_t> cells;
    for (const SeedPlace& p : places) cells.push_back(p.cell);
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }
  std::vector<Changed> in_order(const std::vector<Changed>& mine) {
    std::vector<Changed> all = comm_.all_gather(std::span<const Changed>(mine));
    std::ranges::sort(all, {}, &Changed::order);
    return all;
  }
  std::uint64_t sum(std::size_t mine) { return comm_.sum(static_cast<std::uint64_t>(mine)); }
  template <class Allow>
  std::vector<EdgeHandle> edges(bool inside, Allow&& allow) const;
  /// Of all listed cells of the part.
  std::vector<VertexHandle> free_vertices() const {
    return free_surface_vertices(mesh_, surface_, work_, list_);
  }
  template <class Search>
  RoundCounts smooth(const Search& search, std::span<const VertexHandle> vertices);
  /// The round's winners of all ranks, in rank order. `ends(plan)`: the two vertices that matter.
  template <class Op, class Ends>
  RoundCounts run(const Op& op, std::span<const typename Op::Seed> seeds, Ends&& ends,
                  std::vector<Told>& told);

  Impl& impl_;
  DistributedMesh& parts_;
  Comm& comm_;
  TetMesh& mesh_;
  Workspace& work_;
  SurfaceMesh& surface_;  // as the part sees it
  const Ranks::SurfaceLook& look_;
  const Worklist& list_;
  const Metric& metric_;
};

template <class Metric>
template <class Allow>
std::vector<EdgeHandle> PartSurface::Passes<Metric>::edges(bool inside, Allow&& allow) const {
  return surface_edges(
      mesh_, work_, list_, inside, allow, [&](CellHandle c) { return parts_.is_own(c); },
      [&](CellHandle x, CellHandle y) { return parts_.is_before(x, y); });
}

template <class Metric>
template <class Op, class Ends>
RoundCounts PartSurface::Passes<Metric>::run(const Op& op, std::span<const typename Op::Seed> seeds,
                                             Ends&& ends, std::vector<Told>& told) {
  PartRound place(parts_);
  Round<Op> round(mesh_, work_, options_of(of_round(), place));
  place.when_committed([&](std::span<const PartRound::Place> places) {
    auto at = places.begin();
    round.for_committed([&](const auto& plan, VertexHandle) {
      const std::array<VertexHandle, 2> v = ends(plan);
      if (at->is_own) told.push_back({*at, {parts_.number(v[0]), parts_.number(v[1])}});
      ++at;
    });
  });
  const RoundCounts counts = round.run(op, seeds);
  told = comm_.all_gather(std::span<const Told>(told));
  std::ranges::sort(told, {}, [](const Told& t) { return t.place.order(); });
  return counts;
}

template <class Metric>
template <class Op>
RoundCounts PartSurface::Passes<Metric>::swaps(bool inside) {
  const std::vector<EdgeHandle> seeds =
      edges(inside, [&](VertexHandle a, VertexHandle b) { return surface_.may_swap(a, b); });
  if (sum(seeds.size()) == 0) return {};
  std::vector<Told> told;
  const RoundCounts counts = run(
      Op{metric_, work_.quality, &surface_}, seeds, [](const auto& plan) { return plan.edge; }, told);
  SurfaceMesh& whole = *impl_.whole;
  for (const Told& one : told) whole.on_swap(whole.handle_of(one.v[0]), whole.handle_of(one.v[1]));
  impl_.write_labels();
  return counts;
}

/// On cutouts: what goes with the star of a vertex may lie further away than a part reaches.
template <class Metric>
RoundCounts PartSurface::Passes<Metric>::collapses() {
  using Op = SurfaceCollapse<Metric>;
  std::vector<VertexHandle> all = free_vertices();
  std::erase_if(all, [&](VertexHandle v) { return !parts_.is_own(v); });
  std::vector<VertexHandle> gaining, targets;
  const Op asked{metric_, work_.quality, &surface_, {}};
  for (std::size_t i :
       par::compact<std::size_t>(policy().for_items_of(kMayGainNanoseconds), all.size(),
                                 [&](std::size_t k) { return asked.may_gain(mesh_, all[k]); }))
    gaining.push_back(all[i]);
  const auto keep_with_target = [&](std::vector<VertexHandle>& vertices) {
    drop_pinched(mesh_, work_, vertices);
    std::erase_if(vertices, [&](VertexHandle v) {
      targets.clear();
      surface_.collapse_targets(v, targets);
      return targets.empty();
    });
  };
  keep_with_target(gaining);
  if (sum(gaining.size()) == 0) {
    keep_with_target(all);  // as in shared memory: a round counts in which none of the legal collapses gains
    if (sum(all.size()) == 0) return {};
  }
  // Whose surroundings come to the owner of a cell, which need not be that of the vertex.
  std::vector<SeedPlace> places;
  for (VertexHandle v : gaining) places.push_back({parts_.number(mesh_.incident_cell(v)), parts_.number(v)});
  places = comm_.all_gather(std::span<const SeedPlace>(places));
  const std::vector<std::uint64_t> cells = cells_of(places);
  std::erase_if(places, [&](const SeedPlace& p) {
    const CellHandle c = parts_.cell_at(p.cell);
    return !c.is_valid() || mesh_.is_deleted(c) || !parts_.is_own(c);
  });
  std::vector<typename Op::Seed> seeds;
  std::optional<SurfaceOf<Cutout>> seen;  // by the cutout, for as long as that lives
  std::vector<Changed> changed;
  const RoundCounts counts = round_on_cutout(
      parts_, of_round(), cells, kCollapseDepth,
      [&](Cutout& cutout) {
        seen.emplace(*impl_.whole, cutout);
        seeds.clear();
        targets.clear();
        for (const SeedPlace& p : places) {
          const VertexHandle v = cutout.vertex_at(p.which);
          const auto first = static_cast<std::uint32_t>(targets.size());
          seen->get().collapse_targets(v, targets);
          seeds.push_back({v, first, static_cast<std::uint32_t>(targets.size()) - first});
        }
        return Op{metric_, cutout.work().quality, &seen->get(), targets};
      },
      [&](Cutout&) { return seeds; },
      [&](const Cutout& cutout, const auto& round, std::span<const std::uint64_t> order) {
        round.for_committed([&](const auto& plan, VertexHandle) {
          changed.push_back(
              {order[changed.size()], {cutout.number(plan.seed.vertex), cutout.number(plan.onto)}, {}});
        });
      });
  seen.reset();
  SurfaceMesh& whole = *impl_.whole;
  for (const Changed& one : in_order(changed))
    whole.on_collapse(whole.handle_of(one.v[0]), whole.handle_of(one.v[1]));
  impl_.write_labels();
  return counts;
}

template <class Metric>
template <class Search>
RoundCounts PartSurface::Passes<Metric>::smooth(const Search& search,
                                                std::span<const VertexHandle> vertices) {
  const RoundCounts counts = smooth_parts(parts_, search, metric_, vertices, policy());
  std::vector<Moved> moved;
  for (VertexHandle v : vertices)
    if (parts_.is_own(v) && mesh_.point(v) != surface_.point(v))
      moved.push_back({parts_.number(v), mesh_.point(v)});
  moved = comm_.all_gather(std::span<const Moved>(moved));
  std::ranges::sort(moved, {}, &Moved::number);
  for (const Moved& one : moved) impl_.whole->on_move(impl_.whole->handle_of(one.number), one.point);
  return counts;
}

template <class Metric>
RoundCounts PartSurface::Passes<Metric>::moves() {
  const std::vector<VertexHandle> vertices = free_vertices();
  const std::uint64_t n = sum(static_cast<std::size_t>(
      std::ranges::count_if(vertices, [&](VertexHandle v) { return parts_.is_own(v); })));
  if (n == 0) return {};
  SurfaceSearch search{&surface_};
  const bool many = n > std::min(look_.many, parts_.n_vertices() / look_.many_share);
  if (many && surface_.options().mode == SurfaceMode::kFree) search.gain = look_.gain_of_many;
  return smooth(search, vertices);
}

template <class Metric>
RoundCounts PartSurface::Passes<Metric>::offsets() {
  return smooth(SurfaceOffset{&surface_, look_.worst}, free_vertices());
}

template <class Metric>
RoundCounts PartSurface::Passes<Metric>::splits() {
  using Op = SurfaceSplit<Metric>;
  std::vector<SeedPlace> places;
  for (EdgeHandle e :
       edges(/*inside=*/false, [&](VertexHandle a, VertexHandle b) { return surface_.may_split(a, b); }))
    places.push_back({parts_.number(CellHandle(e.idx() / 6)), e.idx() % 6});
  const std::vector<std::uint64_t> cells = cells_of(comm_.all_gather(std::span<const SeedPlace>(places)));
  if (cells.empty()) return {};
  std::optional<SurfaceOf<Cutout>> seen;               // by the cutout, for as long as that lives
  std::map<Index, std::array<std::uint64_t, 2>> ends;  // asked for before the cells that name them are gone
  std::vector<Changed> changed;
  const RoundCounts counts = round_on_cutout(
      parts_, of_round(), cells, kSplitDepth,
      [&](Cutout& cutout) {
        seen.emplace(*impl_.whole, cutout);
        Op op{metric_, cutout.work().quality, &seen->get()};
        op.rim = &cutout.rim();
        return op;
      },
      [&](Cutout& cutout) {
        std::vector<typename Op::Seed> here;
        ends.clear();
        for (const SeedPlace& p : places) {
          const EdgeHandle e(6 * cutout.cell_at(p.cell).idx() + static_cast<Index>(p.which));
          here.emplace_back(e);
          const auto [a, b] = cutout.mesh().edge_vertices(e);
          ends[e.idx()] = {cutout.number(a), cutout.number(b)};
        }
        return here;
      },
      [&](const Cutout& cutout, const auto& round, std::span<const std::uint64_t> order) {
        round.for_committed([&](const auto& plan, VertexHandle middle) {
          const auto& v = ends.at(plan.seed.edge.idx());
          changed.push_back({order[changed.size()], {v[0], v[1], cutout.number(middle)}, plan.place});
        });
      });
  seen.reset();
  SurfaceMesh& whole = *impl_.whole;
  for (const Changed& one : in_order(changed))
    whole.on_split(whole.handle_of(one.v[0]), whole.handle_of(one.v[1]), whole.announce(one.v[2]), one.place);
  impl_.write_labels();
  return counts;
}

std::optional<RoundCounts> PartSurface::pass(const Ranks::SurfaceLook& look,
                                             const std::function<Worklist()>& listed) {
  DistributedMesh& parts = impl_->parts;
  const TetMesh& part = parts.part();
  const auto use = [&](const Worklist& cells) {
    return with_metric(look.look, [&](const auto& metric) {
      using M = std::remove_cvref_t<decltype(metric)>;
      Passes<M> passes(*impl_, look, cells, metric);
      switch (look.pass) {
        case SurfacePass::kSwap:
          return passes.template swaps<SurfaceSwap<M>>(/*inside=*/false);
        case SurfacePass::kInterfaceSwap:
          return passes.template swaps<InterfaceSwap<M>>(/*inside=*/true);
        case SurfacePass::kCollapse:
          return passes.collapses();
        case SurfacePass::kMove:
          return passes.moves();
        case SurfacePass::kSplit:
          return passes.splits();
        case SurfacePass::kOffset:
          return passes.offsets();
      }
      return RoundCounts{};
    });
  };
  switch (look.pass) {
    case SurfacePass::kInterfaceSwap:  // there are cells now that the list does not know
      return use(Worklist(part, impl_->policy, [&](CellHandle c) {
        return std::ranges::binary_search(impl_->looked_at, parts.number(c));
      }));
    case SurfacePass::kOffset:
      return use(Worklist(part, impl_->policy, [](CellHandle) { return true; }));
    default:
      break;
  }
  const Worklist list = listed();
  if (look.pass == SurfacePass::kSwap) {
    impl_->looked_at.clear();
    if (impl_->whole->has_interfaces())
      for (Index c : list.cells()) impl_->looked_at.push_back(parts.number(CellHandle(c)));
    std::ranges::sort(impl_->looked_at);
  }
  if (parts.comm().sum(static_cast<std::uint64_t>(list.cells().size())) == 0) return std::nullopt;
  return use(list);
}

}  // namespace hfr::mpi
