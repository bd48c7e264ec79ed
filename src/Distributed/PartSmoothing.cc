// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartSmoothing.hh"

#include <bit>

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
  for (VertexHandle v : vertices) {
    colour_[v.idx()] = kWaiting;
    if (mesh.is_own(v)) own_.push_back(v);
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
  const auto i = static_cast<std::size_t>(std::lower_bound(own_.begin(), own_.end(), own) - own_.begin());
  return {links_.data() + begin_[i], links_.data() + begin_[i + 1]};
}

/// A vertex is coloured once all its smaller neighbours are; so all ranks together colour in the order of
/// numbers, as far as neighbours go.
std::vector<std::vector<VertexHandle>> PartSmoothing::colour_groups() {
  const TetMesh& part = mesh_.part();
  Comm& comm = mesh_.comm();
  std::vector<VertexHandle> left;
  std::vector<std::uint64_t> alone;  // what would need a 64th colour has a group each, after the others
  for (VertexHandle v : own_)
    if (colour_[v.idx()] == kWaiting) left.push_back(v);
  std::uint64_t n_left = 0;
  do {
    std::vector<Packer> to(comm.n_ranks());
    std::erase_if(left, [&](VertexHandle v) {
      std::uint64_t used = 0;
      for (HalfFaceHandle h : link(v))
        for (VertexHandle u : part.cell(cell_of(h)).v) {
          if (!(u < v)) continue;
          if (colour_[u.idx()] == kWaiting) return false;
          used |= std::uint64_t{1} << colour_[u.idx()];
        }
      const auto colour = static_cast<std::uint8_t>(std::countr_one(used & ~(std::uint64_t{1} << kNone)));
      if (colour == kNone) alone.push_back(mesh_.number(v));
      colour_[v.idx()] = colour;
      for_ranks(mesh_.near(v), [&](int r) {
        if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(Colour{mesh_.number(v), colour});
      });
      return true;
    });
    n_left = comm.sum(left.size());
    for (const Comm::Message& message : comm.exchange(to)) {
      Unpacker in(message.bytes);
      while (!in.at_end()) {
        const auto news = in.get<Colour>();
        const VertexHandle v = mesh_.vertex_at(news.number);
        if (v.is_valid()) colour_[v.idx()] = static_cast<std::uint8_t>(news.colour);
      }
    }
  } while (n_left > 0);
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
      for (VertexHandle u : mesh_.part().cell(cell_of(h)).v) set.add(mesh_.within_two(u));
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
