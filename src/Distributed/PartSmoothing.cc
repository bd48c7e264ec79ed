// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSmoothing.hh"

#include <bit>
#include <utility>

#include "Distributed/WholeStars.hh"

namespace hfr::mpi {
namespace {

constexpr std::uint8_t kNone = 63;      // as colour_vertices() has it: not in the pass, or alone
constexpr std::uint8_t kWaiting = 255;  // not coloured yet
// Vertices that a rank colours in a round of the colouring, about; those apart that others may wait for.
constexpr std::size_t kLeast = 1024, kRounds = 256;

/// The smallest colour that is not in the set; kNone where that would be the 64th.
std::uint8_t first_without(std::uint64_t used) {
  return static_cast<std::uint8_t>(std::countr_one(used & ~(std::uint64_t{1} << kNone)));
}

struct Colour {
  std::uint64_t number = 0;
  std::uint64_t colour = 0;
};

}  // namespace

PartSmoothing::PartSmoothing(DistributedMesh& mesh, std::span<const VertexHandle> vertices,
                             par::Policy policy)
    : mesh_(mesh), colour_(mesh.part().n_vertices(), kNone) {
  place_.resize(colour_.size());
  for (VertexHandle v : vertices) {
    colour_[v.idx()] = kWaiting;
    if (!mesh.is_own(v)) continue;
    place_[v.idx()] = static_cast<Index>(own_.size());
    own_.push_back(v);
  }
  const StarTable stars(mesh.part(), own_, mesh.work().star_size, policy);
  begin_.push_back(0);
  for (std::size_t i = 0; i < own_.size(); ++i) {
    const auto link = stars.link(i);
    if (link.empty()) colour_[own_[i].idx()] = kNone;
    links_.insert(links_.end(), link.begin(), link.end());
    const auto first = links_.begin() + static_cast<std::ptrdiff_t>(begin_.back());
    const auto order = [&](HalfFaceHandle a, HalfFaceHandle b) {
      return mesh_.is_before(cell_of(a), cell_of(b));
    };
    if (!std::is_sorted(first, links_.end(), order)) std::sort(first, links_.end(), order);
    begin_.push_back(links_.size());
  }
}

/// Half-faces opposite each vertex of another rank, in the cells that are held here: each such cell is in the
/// zone.
void PartSmoothing::find_links_of_others() {
  const TetMesh& part = mesh_.part();
  const auto for_corners = [&](auto&& body) {
    for (Index i : mesh_.zone()) {
      const CellHandle c(i);
      if (part.is_deleted(c)) continue;
      const auto& v = part.cell(c).v;
      for (std::size_t k = 0; k < 4; ++k)
        if (!mesh_.is_own(v[k])) body(v[k], halfface_of(c, static_cast<int>(k)));
    }
  };
  begin_of_other_.assign(part.n_vertices() + 2, 0);
  for_corners([&](VertexHandle v, HalfFaceHandle) { ++begin_of_other_[v.idx() + 2]; });
  for (std::size_t v = 2; v < begin_of_other_.size(); ++v) begin_of_other_[v] += begin_of_other_[v - 1];
  links_of_others_.resize(begin_of_other_.back());
  for_corners(
      [&](VertexHandle v, HalfFaceHandle h) { links_of_others_[begin_of_other_[v.idx() + 1]++] = h; });
}

std::span<const HalfFaceHandle> PartSmoothing::link(VertexHandle own) const {
  const std::size_t i = place_[own.idx()];
  return {links_.data() + begin_[i], links_.data() + begin_[i + 1]};
}

/// Own vertices that wait for some of other ranks, or for such that do: each can be coloured once all its
/// smaller neighbours are.
class PartSmoothing::Ready {
 public:
  Ready(const PartSmoothing& pass)
      : pass_(pass),
        stars_(pass.mesh_.part(), pass.mesh_.work()),
        waits_(pass.colour_.size()),
        seen_(pass.colour_.size(), 0) {
    begin_.reserve(pass_.own_.size() + 1);
    for (VertexHandle v : pass_.own_) {
      begin_.push_back(larger_.size());
      if (pass_.colour_[v.idx()] != kWaiting) continue;
      ++n_left_;
      Wait& wait = waits_[v.idx()];
      see(v);
      for (HalfFaceHandle h : pass_.link(v))
        for (VertexHandle u : pass_.mesh_.part().cell(cell_of(h)).v) {
          if (!is_first_look(u)) continue;
          if (v < u)
            larger_.push_back(u);
          else if (pass_.colour_[u.idx()] == kWaiting)
            ++wait.n;
          else
            wait.used |= std::uint64_t{1} << pass_.colour_[u.idx()];
        }
    }
    begin_.push_back(larger_.size());
  }

  std::size_t n_left() const { return n_left_; }
  /// One that another rank may wait for.
  bool has_near() const { return !near_.empty(); }
  bool is_empty() const { return near_.empty() && n_taken_ == inner_.size(); }
  /// It and its colour; those first that others may wait for, then in the order in which they were ready.
  std::pair<VertexHandle, std::uint8_t> take() {
    VertexHandle v;
    if (has_near()) {
      v = near_.back();
      near_.pop_back();
    } else {
      v = inner_[n_taken_++];
    }
    --n_left_;
    return {v, first_without(waits_[v.idx()].used)};
  }
  /// A vertex within one edge of own ones has its colour: one of this object, or of another rank. All its
  /// cells are here.
  void note_coloured(VertexHandle v) {
    const std::uint64_t bit = std::uint64_t{1} << pass_.colour_[v.idx()];
    if (pass_.mesh_.is_own(v)) {
      const std::size_t i = pass_.place_[v.idx()];
      for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) tell(larger_[k], bit);
      return;
    }
    see(v);
    stars_.for_cells(v, [&](CellHandle c) {
      for (VertexHandle w : pass_.mesh_.part().cell(c).v)
        if (v < w && is_first_look(w)) tell(w, bit);
    });
  }

 private:
  struct Wait {
    std::uint64_t used = 0;  // colours of the smaller neighbours that have one
    std::uint32_t n = 0;     // smaller neighbours without; 0 for what does not wait
  };

  void tell(VertexHandle w, std::uint64_t bit) {
    Wait& wait = waits_[w.idx()];
    if (wait.n == 0) return;
    wait.used |= bit;
    if (--wait.n == 0) (pass_.mesh_.is_among_own(w) ? inner_ : near_).push_back(w);
  }
  /// The neighbours of this vertex are looked at from now on.
  void see(VertexHandle v) { seen_[v.idx()] = ++n_seen_; }
  bool is_first_look(VertexHandle u) { return std::exchange(seen_[u.idx()], n_seen_) != n_seen_; }

  const PartSmoothing& pass_;
  WholeStars stars_;
  std::vector<Wait> waits_;          // by vertex
  std::vector<std::uint32_t> seen_;  // by vertex: of whose neighbours it was the last time
  std::uint32_t n_seen_ = 0;
  std::vector<std::size_t> begin_;          // in larger_, by own_
  std::vector<VertexHandle> larger_;        // neighbours of those that wait
  std::vector<VertexHandle> near_, inner_;  // that are ready
  std::size_t n_taken_ = 0;                 // of the inner ones
  std::size_t n_left_ = 0;
};

/// kWaiting while a smaller neighbour is.
std::uint8_t PartSmoothing::first_fit(VertexHandle v) const {
  std::uint64_t used = 0;
  for (HalfFaceHandle h : link(v))
    for (VertexHandle u : mesh_.part().cell(cell_of(h)).v) {
      if (!(u < v)) continue;
      if (colour_[u.idx()] == kWaiting) return kWaiting;
      used |= std::uint64_t{1} << colour_[u.idx()];
    }
  return first_without(used);
}

/// All ranks together colour in the order of numbers, as far as neighbours go.
std::vector<std::vector<VertexHandle>> PartSmoothing::colour_groups() {
  Comm& comm = mesh_.comm();
  std::vector<std::uint64_t> alone;  // what would need a 64th colour has a group each, after the others
  std::vector<Packer> to(comm.n_ranks());
  const auto set_colour = [&](VertexHandle v, std::uint8_t colour) {
    if (colour == kNone) alone.push_back(mesh_.number(v));
    colour_[v.idx()] = colour;
    for_ranks(mesh_.near(v), [&](int r) {
      if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(Colour{mesh_.number(v), colour});
    });
  };
  for (VertexHandle v : own_)  // ascending, so most come after all that they wait for
    if (colour_[v.idx()] == kWaiting)
      if (const std::uint8_t colour = first_fit(v); colour != kWaiting) set_colour(v, colour);
  Ready ready(*this);
  // A chain of vertices that wait for each other goes to and fro between ranks. Who did all that is ready
  // before it tells of it would keep the other waiting; so each does about as much in a round.
  const std::size_t most = std::max(kLeast, ready.n_left() / kRounds);
  for (bool is_done = false; !is_done;) {
    for (std::size_t n = 0; ready.has_near() || (n < most && !ready.is_empty()); ++n) {
      const auto [v, colour] = ready.take();
      set_colour(v, colour);
      ready.note_coloured(v);
    }
    const Comm::Exchanged came = comm.exchange(to, ready.n_left());
    to.assign(comm.n_ranks(), {});
    for (const Comm::Message& message : came.messages)
      for (Unpacker in(message.bytes); !in.at_end();) {
        const auto news = in.get<Colour>();
        const VertexHandle v = mesh_.vertex_at(news.number);
        if (!v.is_valid()) continue;
        colour_[v.idx()] = static_cast<std::uint8_t>(news.colour);
        ready.note_coloured(v);
      }
    is_done = came.sum == 0;
  }
  std::vector<std::vector<VertexHandle>> groups;
  for (VertexHandle v : own_) {
    const std::uint8_t colour = colour_[v.idx()];
    if (colour == kNone) continue;
    if (colour >= groups.size()) groups.resize(colour + 1U);
    groups[colour].push_back(v);
  }
  groups.resize(static_cast<std::size_t>(-comm.min(-static_cast<double>(groups.size()))));
  alone = comm.all_gather(std::span<const std::uint64_t>(alone));
  std::sort(alone.begin(), alone.end());
  for (std::uint64_t number : alone) {
    const VertexHandle v = mesh_.vertex_at(number);
    groups.emplace_back();
    if (v.is_valid() && mesh_.is_own(v)) groups.back().push_back(v);
  }
  return groups;
}

auto PartSmoothing::tell_points(std::span<const VertexHandle> moved) -> std::vector<Come> {
  Comm& comm = mesh_.comm();
  std::vector<Packer> to(comm.n_ranks());
  RankSet set(mesh_.within_two().words());
  for (VertexHandle v : moved) {
    const auto cells = link(v);
    if (std::none_of(cells.begin(), cells.end(),
                     [&](HalfFaceHandle h) { return mesh_.is_in_zone(cell_of(h)); }))
      continue;
    set.clear();  // ranks within three edges: those that hold a cell of v
    for (HalfFaceHandle h : cells)
      for (VertexHandle u : mesh_.part().cell(cell_of(h)).v)
        if (!mesh_.is_inside(u)) set.add(mesh_.within_two(u));
    set.remove(comm.rank());
    for_ranks(set.bits(), [&](int r) {
      to[static_cast<std::size_t>(r)].put(MovedVertex{mesh_.number(v), mesh_.part().point(v)});
    });
  }
  std::vector<Come> came;
  for (const Comm::Message& message : comm.exchange(to)) {
    Unpacker in(message.bytes);
    while (!in.at_end()) {
      const auto news = in.get<MovedVertex>();
      const VertexHandle v = mesh_.vertex_at(news.number);
      if (v.is_valid()) came.push_back({v, news.point, {}});
    }
  }
  return came;
}

auto PartSmoothing::tell(std::span<const VertexHandle> moved) -> std::vector<Come> {
  std::vector<Come> came = tell_points(moved);
  if (!came.empty() && begin_of_other_.empty()) find_links_of_others();
  for (Come& one : came)
    one.link = {links_of_others_.data() + begin_of_other_[one.vertex.idx()],
                links_of_others_.data() + begin_of_other_[one.vertex.idx() + 1]};
  return came;
}

}  // namespace hfr::mpi
