// SPDX-License-Identifier: BSD-3-Clause
// The grid of generate::jittered_box(), of which each rank makes the cubes round its own vertices.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "Distributed/InParts.hh"
#include "HalfFace/Errors.hh"

namespace hfr::mpi {
namespace {

using Place = std::array<std::int64_t, 3>;

/// Cells are those with a vertex within two edges of an own one, and an edge goes one step along each axis at
/// most: so three layers of cubes round own vertices hold them. One more has the vertices right behind.
constexpr std::int64_t kLayers = 4;
/// Edges between own vertices and the nearest vertex of a held cell.
constexpr int kEdges = 2;

struct Box {
  Place low{}, high{};  // vertices low … high-1

  std::int64_t size(std::size_t d) const { return high[d] - low[d]; }
  std::uint64_t n_places() const {
    return static_cast<std::uint64_t>(size(0)) * static_cast<std::uint64_t>(size(1)) *
           static_cast<std::uint64_t>(size(2));
  }
};

/// Calls body(place) for the places of a box, x first.
template <class Body>
void for_places(const Box& box, Body&& body) {
  for (std::int64_t k = box.low[2]; k < box.high[2]; ++k)
    for (std::int64_t j = box.low[1]; j < box.high[1]; ++j)
      for (std::int64_t i = box.low[0]; i < box.high[0]; ++i) body(Place{i, j, k});
}

std::uint64_t number_in(const Place& size, const Place& at) {
  return (static_cast<std::uint64_t>(at[2]) * static_cast<std::uint64_t>(size[1]) +
          static_cast<std::uint64_t>(at[1])) *
             static_cast<std::uint64_t>(size[0]) +
         static_cast<std::uint64_t>(at[0]);
}

/// Who owns which vertices: blocks by halves of the longest side, or slices by number.
class GridOwners {
 public:
  GridOwners(Box whole, int n_ranks, Partition how) : whole_(whole), n_ranks_(n_ranks), how_(how) {}

  int owner(const Place& at) const {
    if (how_ == Partition::kNumbers) return slice_of(number_in(whole_.high, at));
    Box box = whole_;
    int first = 0;
    for (int n = n_ranks_; n > 1;)
      n = halve(box, first, n, [&](std::size_t d, auto cut) { return at[d] >= cut; });
    return first;
  }
  /// Holds the own vertices of a rank.
  Box around(int rank) const {
    Box box = whole_;
    int first = 0;
    if (how_ == Partition::kNumbers) {
      const auto layer = static_cast<std::uint64_t>(box.size(0) * box.size(1));
      const auto begin = [&](int r) {  // the first number whose slice is r
        const auto n = static_cast<std::uint64_t>(n_ranks_);
        return (static_cast<std::uint64_t>(r) * box.n_places() + n - 1) / n;
      };
      const std::uint64_t from = begin(rank), to = begin(rank + 1);
      box.low[2] = static_cast<std::int64_t>(from / layer);
      box.high[2] = static_cast<std::int64_t>((to + layer - 1) / layer);
      return box;
    }
    for (int n = n_ranks_; n > 1;)
      n = halve(box, first, n, [&](std::size_t, auto) { return rank >= first + n / 2; });
    return box;
  }

 private:
  int slice_of(std::uint64_t number) const {
    return static_cast<int>(number * static_cast<std::uint64_t>(n_ranks_) / whole_.n_places());
  }
  /// Goes on to the half that is asked for; returns how many ranks it is of.
  template <class IsHigher>
  static int halve(Box& box, int& first, int n, IsHigher&& is_higher) {
    std::size_t d = 0;
    for (std::size_t e = 1; e < 3; ++e)
      if (box.size(e) > box.size(d)) d = e;
    const std::int64_t cut = box.low[d] + box.size(d) * (n / 2) / n;
    if (is_higher(d, cut)) {
      box.low[d] = cut;
      first += n / 2;
      return n - n / 2;
    }
    box.high[d] = cut;
    return n / 2;
  }

  Box whole_;
  int n_ranks_;
  Partition how_;
};

/// What one rank makes.
class GridPart {
 public:
  GridPart(generate::Counts counts, const GridOwners& owners, int rank) : owners_(owners), rank_(rank) {
    Box here = owners.around(rank);
    for (std::size_t d = 0; d < 3; ++d) {
      n_cubes_[d] = counts[d];
      n_vertices_[d] = n_cubes_[d] + 1;
      here.low[d] = std::max<std::int64_t>(here.low[d] - kLayers, 0);
      here.high[d] = std::min(here.high[d] + kLayers, n_vertices_[d]);
    }
    here_ = cubes_ = here;
    for (std::size_t d = 0; d < 3; ++d) --cubes_.high[d];
  }

  /// `point(place)`: of a vertex.
  template <class Point>
  DistributedMesh::Piece make(Point&& point) const {
    DistributedMesh::Piece piece;
    const auto n = static_cast<std::size_t>(here_.n_places());
    piece.vertex_number.reserve(n);
    piece.owner.reserve(n);
    std::vector<Vec3> points;
    points.reserve(n);
    std::vector<std::uint8_t> edges(n, kEdges + 1);  // to an own vertex, as far as that counts
    for_places(here_, [&](const Place& at) {
      const int owner = owners_.owner(at);
      if (owner == rank_) edges[points.size()] = 0;
      piece.owner.push_back(owner);
      piece.vertex_number.push_back(number_in(n_vertices_, at));
      points.push_back(point(at));
    });
    for (std::uint8_t step = 1; step <= kEdges; ++step)
      for_cells([&](std::uint64_t, const auto& v) {
        if (nearest(edges, v) != step - 1) return;
        for (Index u : v) edges[u] = std::min(edges[u], step);
      });
    std::vector<std::array<Index, 4>> cells;
    std::size_t n_cells = 0;
    for_cells([&](std::uint64_t, const auto& v) { n_cells += nearest(edges, v) <= kEdges ? 1 : 0; });
    cells.reserve(n_cells);
    piece.cell_number.reserve(n_cells);
    for_cells([&](std::uint64_t number, const auto& v) {
      if (nearest(edges, v) > kEdges) return;
      cells.push_back(v);
      piece.cell_number.push_back(number);
    });
    piece.mesh = build(std::move(points), cells, {}, nullptr, NonManifold::kKeep, Turning::kConflicts);
    return piece;
  }

 private:
  static std::uint8_t nearest(const std::vector<std::uint8_t>& edges, const std::array<Index, 4>& v) {
    return std::min(std::min(edges[v[0]], edges[v[1]]), std::min(edges[v[2]], edges[v[3]]));
  }
  /// body(number, corners): of the cells of the cubes here, ascending.
  template <class Body>
  void for_cells(Body&& body) const {
    const Place size = {here_.size(0), here_.size(1), here_.size(2)};
    for_places(cubes_, [&](const Place& cube) {
      std::uint64_t number = 6 * number_in(n_cubes_, cube);
      const Place at = {cube[0] - here_.low[0], cube[1] - here_.low[1], cube[2] - here_.low[2]};
      for (const auto& corners : generate::kCubeCells) {
        std::array<Index, 4> v{};
        for (std::size_t c = 0; c < 4; ++c)
          v[c] = static_cast<Index>(number_in(
              size, {at[0] + (corners[c] & 1), at[1] + (corners[c] >> 1 & 1), at[2] + (corners[c] >> 2)}));
        body(number++, v);
      }
    });
  }

  const GridOwners& owners_;
  int rank_;
  Place n_cubes_{}, n_vertices_{};
  Box here_, cubes_;
};

}  // namespace

void generate_in_parts(DistributedMesh& mesh, const GridOptions& options, Partition how) {
  using generate::Counts;
  const generate::CavityOptions& cavity = options.cavity;
  Box whole;
  std::uint64_t n_cells = 6;
  for (std::size_t d = 0; d < 3; ++d) {
    const int axis = static_cast<int>(d);
    HFR_REQUIRE(cavity.counts[d] >= 1, "a box needs at least one cube in each direction");
    HFR_REQUIRE(std::isfinite(options.low[axis]) && std::isfinite(options.high[axis]) &&
                    options.low[axis] < options.high[axis],
                "a box needs a lower corner that lies below its upper one");
    whole.high[d] = std::int64_t{cavity.counts[d]} + 1;
    n_cells *= cavity.counts[d];
  }
  HFR_REQUIRE(std::isfinite(cavity.jitter) && std::isfinite(cavity.amplitude),
              "jitter and amplitude must be finite numbers");
  HFR_REQUIRE(std::isfinite(cavity.sigma) && cavity.sigma > 0, "sigma must be above 0");
  double n_places = 6;  // and cells of each
  for (std::size_t d = 0; d < 3; ++d) n_places *= static_cast<double>(whole.size(d));
  HFR_REQUIRE(n_places < 0x1p53, "a grid of so many cells cannot be numbered: ask for fewer");
  HFR_REQUIRE(whole.n_places() >= mesh.comm().n_ranks(),
              "there are more ranks than vertices: a rank would have none");
  const GridOwners owners(whole, mesh.comm().size(), how);
  const Comm::InPhase phase(mesh.comm(), Phase::kHandOut);
  mesh.assemble(GridPart(cavity.counts, owners, mesh.comm().rank()).make([&](const Place& at) {
    const Counts place = {static_cast<Index>(at[0]), static_cast<Index>(at[1]), static_cast<Index>(at[2])};
    const Vec3 p =
        generate::jittered_point(cavity.counts, place, cavity.jitter, cavity.seed, options.low, options.high);
    return cavity.amplitude == 0 ? p : generate::deform(p, cavity);
  }),
                whole.n_places(), n_cells);
}

}  // namespace hfr::mpi
