// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSmoothing.hh"

#include <bit>
#include <utility>

namespace hfr::mpi {
namespace {

constexpr std::uint8_t kNone = 63;      // as colour_vertices() has it: not in the pass, or alone
constexpr std::uint8_t kWaiting = 255;  // not coloured yet

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
    std::sort(links_.begin() + static_cast<std::ptrdiff_t>(begin_.back()), links_.end(),
              [&](HalfFaceHandle a, HalfFaceHandle b) {
                return mesh_.number(cell_of(a)) < mesh_.number(cell_of(b));
              });
    begin_.push_back(links_.size());
  }
}

/// Every cell with a vertex of another rank is in the zone.
void PartSmoothing::find_links(std::vector<Come>& came) {
  const TetMesh& part = mesh_.part();
  come_.resize(part.n_vertices(), 0);
  for (std::size_t i = 0; i < came.size(); ++i)
    come_[came[i].vertex.idx()] = static_cast<std::uint32_t>(i + 1);
  for (Index i : mesh_.zone()) {
    const CellHandle c(i);
    if (part.is_deleted(c)) continue;
    const auto& v = part.cell(c).v;
    for (std::size_t k = 0; k < 4; ++k)
      if (const std::uint32_t place = come_[v[k].idx()]; place != 0)
        came[place - 1].link.push_back(halfface_of(c, static_cast<int>(k)));
  }
  for (const Come& one : came) come_[one.vertex.idx()] = 0;
}

std::span<const HalfFaceHandle> PartSmoothing::link(VertexHandle own) const {
  const std::size_t i = place_[own.idx()];
  return {links_.data() + begin_[i], links_.data() + begin_[i + 1]};
}

/// Own vertices that can be coloured: each once all its smaller neighbours are.
class PartSmoothing::Ready {
 public:
  Ready(const PartSmoothing& pass)
      : pass_(pass), n_waits_for_(pass.colour_.size(), 0), seen_(pass.colour_.size(), 0) {
    for (VertexHandle v : pass_.own_) {
      if (!is_waiting(v)) continue;
      ++n_left_;
      for_neighbours(v, [&](VertexHandle u) {
        if (u < v && is_waiting(u)) ++n_waits_for_[v.idx()];
      });
      if (n_waits_for_[v.idx()] == 0) ready_.push_back(v);
    }
  }

  std::size_t n_left() const { return n_left_; }
  bool is_empty() const { return ready_.empty(); }
  VertexHandle take() {
    const VertexHandle v = ready_.back();
    ready_.pop_back();
    --n_left_;
    return v;
  }
  /// A vertex within one edge of own ones has its colour.
  void note_coloured(VertexHandle v) {
    for_neighbours(v, [&](VertexHandle w) {
      if (v < w && pass_.mesh_.is_own(w) && is_waiting(w) && --n_waits_for_[w.idx()] == 0)
        ready_.push_back(w);
    });
  }

 private:
  bool is_waiting(VertexHandle v) const { return pass_.colour_[v.idx()] == kWaiting; }
  /// Each once. All cells of such a vertex are here.
  template <class Visit>
  void for_neighbours(VertexHandle v, Visit&& visit) {
    const TetMesh& part = pass_.mesh_.part();
    ++look_;
    for (CellHandle c : part.vertex_cells(v))
      for (VertexHandle u : part.cell(c).v)
        if (std::exchange(seen_[u.idx()], look_) != look_ && u != v) visit(u);
  }

  const PartSmoothing& pass_;
  std::vector<std::uint32_t> n_waits_for_;  // by vertex: smaller neighbours without a colour
  std::vector<std::uint32_t> seen_;         // by vertex: the last look that came to it
  std::uint32_t look_ = 0;
  std::vector<VertexHandle> ready_;
  std::size_t n_left_ = 0;
};

std::uint8_t PartSmoothing::first_fit(VertexHandle v) const {
  std::uint64_t used = 0;
  for (HalfFaceHandle h : link(v))
    for (VertexHandle u : mesh_.part().cell(cell_of(h)).v)
      if (u < v) used |= std::uint64_t{1} << colour_[u.idx()];
  return static_cast<std::uint8_t>(std::countr_one(used & ~(std::uint64_t{1} << kNone)));
}

/// All ranks together colour in the order of numbers, as far as neighbours go.
std::vector<std::vector<VertexHandle>> PartSmoothing::colour_groups() {
  Comm& comm = mesh_.comm();
  std::vector<std::uint64_t> alone;  // what would need a 64th colour has a group each, after the others
  Ready ready(*this);
  for (bool is_done = false; !is_done;) {
    std::vector<Packer> to(comm.n_ranks());
    while (!ready.is_empty()) {
      const VertexHandle v = ready.take();
      const std::uint8_t colour = first_fit(v);
      if (colour == kNone) alone.push_back(mesh_.number(v));
      colour_[v.idx()] = colour;
      ready.note_coloured(v);
      for_ranks(mesh_.near(v), [&](int r) {
        if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(Colour{mesh_.number(v), colour});
      });
    }
    const Comm::Exchanged came = comm.exchange(to, ready.n_left());
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
    set.clear();  // ranks within three edges: those that hold a cell of v
    for (HalfFaceHandle h : link(v))
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
  if (!came.empty()) find_links(came);
  return came;
}

}  // namespace hfr::mpi
