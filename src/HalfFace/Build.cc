// SPDX-License-Identifier: BSD-3-Clause
// Connectivity from arrays. A face is matched in the bucket of its smallest vertex; since three faces of a
// cell share the cell's smallest vertex and the fourth has its second smallest, a cell is entered in two
// buckets and both sides of a face are met while one bucket is worked on. Buckets are matched through a small
// table in cache. The result depends on the input alone, not on threads.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "HalfFace/NonManifold.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr {
namespace {

using Corners = std::array<Index, 4>;

/// A cell's vertices in ascending order.
struct Sorted {
  std::array<Index, 4> vertex;
  std::array<std::uint8_t, 4> corner;  ///< where in the cell
  bool odd;                            ///< the order is an odd permutation of the cell's
};

Sorted sort_corners(const Cell& cell) {
  std::array<std::uint64_t, 4> key;  // vertex and corner in one, so that no branch depends on the data
  for (std::size_t k = 0; k < 4; ++k) key[k] = std::uint64_t{cell.v[k].idx()} << 2 | k;
  bool odd = false;
  const auto order = [&](std::size_t i, std::size_t j) {
    const std::uint64_t low = std::min(key[i], key[j]);
    odd ^= low != key[i];
    key[j] = std::max(key[i], key[j]);
    key[i] = low;
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);
  Sorted sorted;
  for (std::size_t k = 0; k < 4; ++k) {
    sorted.vertex[k] = static_cast<Index>(key[k] >> 2);
    sorted.corner[k] = static_cast<std::uint8_t>(key[k] & 3);
  }
  sorted.odd = odd;
  return sorted;
}

std::array<Index, 2> two_smallest(const Corners& c) {
  const Index low = std::min(c[0], c[1]);
  const Index low2 = std::min(c[2], c[3]);
  const Index high = std::max(c[0], c[1]);
  const Index high2 = std::max(c[2], c[3]);
  return {std::min(low, low2), std::min(std::max(low, low2), std::min(high, high2))};
}

/// Half-faces of one bucket that wait for their mate, by the two larger vertices. Emptied in no time.
class FaceTable {
 public:
  struct Slot {
    Index stamp = 0;
    Index middle = 0;
    Index largest = 0;
    Index waiting = 0;  ///< 2·half-face + (sees the sorted vertices in odd order); kTaken once mated
  };
  static constexpr Index kTaken = HalfFaceHandle::kInvalid;

  void start(std::size_t n_faces) {
    std::size_t size = 64;
    while (size < 2 * n_faces) size *= 2;
    if (size > slots_.size()) slots_.assign(size, Slot{});
    mask_ = size - 1;
    if (++stamp_ == 0) {
      std::fill(slots_.begin(), slots_.end(), Slot{});
      stamp_ = 1;
    }
  }

  /// The slot of a face; a new one if is_new.
  Slot& find(Index middle, Index largest, bool& is_new) {
    const auto hash =
        static_cast<std::uint32_t>(middle) * 0x9e3779b1U ^ static_cast<std::uint32_t>(largest) * 0x85ebca6bU;
    std::size_t at = (hash >> 15 ^ hash >> 3) & mask_;
    for (; slots_[at].stamp == stamp_; at = (at + 1) & mask_) {
      if (slots_[at].middle != middle || slots_[at].largest != largest) continue;
      is_new = false;
      return slots_[at];
    }
    slots_[at] = {stamp_, middle, largest, 0};
    is_new = true;
    return slots_[at];
  }

 private:
  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  Index stamp_ = 0;
};

}  // namespace

class MeshBuilder {
 public:
  MeshBuilder(std::vector<Vec3> points, std::span<const Corners> input, par::Policy policy)
      : input_(input), policy_(policy) {
    mesh_.points_ = std::move(points);
  }

  TetMesh run(BuildReport* report, NonManifold non_manifold, Turning turning) {
    if (input_.size() > TetMesh::kMostCells)
      throw ResourceLimit(std::to_string(input_.size()) +
                          " cells are too many for 32-bit indices; build with HFR_INDEX64=ON");
    check_points();
    copy_cells();
    fill_buckets();
    const std::int64_t n_conflicts = match_buckets();
    refuse_double_cells();
    if (n_conflicts > 0) agree();
    BuildReport mended;
    const Signs signs = turning == Turning::kMost ? count_signs() : Signs();
    if (signs.negative > signs.positive) {
      turn([](std::size_t) { return true; });
      mended.flipped = true;
    }
    const bool lone = signs.negative > 0 && signs.positive > 0 && turn_negative_components();
    if (n_conflicts > 0 || lone) mended.reoriented = turned_by_themselves(mended.flipped);
    set_incident_cells();
    mesh_.vertex_status_.assign(mesh_.points_.size(), 0);
    if (non_manifold == NonManifold::kSplit) mended.copied = split_pinched(mesh_);
    refuse_double_edges(non_manifold);
    if (report) *report = std::move(mended);
    return std::move(mesh_);
  }

 private:
  struct Signs {
    std::int64_t negative = 0;
    std::int64_t positive = 0;
  };

  std::size_t n_cells() const { return input_.size(); }
  std::size_t n_points() const { return mesh_.points_.size(); }

  template <class IsBad>
  std::size_t first_bad(std::size_t n, IsBad&& is_bad) const {
    return par::reduce(
        policy_, n, n, [&](std::size_t i) { return is_bad(i) ? i : n; },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
  }

  void check_points() const {
    const std::size_t bad = first_bad(n_points(), [&](std::size_t i) {
      const Vec3 p = mesh_.points_[i];
      return !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    });
    if (bad < n_points())
      throw InvalidInput(std::string("vertex ") + std::to_string(bad) +
                         ": a coordinate is not a finite number; mend the input");
  }

  void copy_cells() {
    mesh_.cells_.reserve(n_cells() + n_cells() / TetMesh::kHeadroom);  // not touched until it is used
    mesh_.cells_.resize(n_cells());
    const std::size_t bad = first_bad(n_cells(), [&](std::size_t i) {
      const Corners& c = input_[i];
      for (std::size_t k = 0; k < 4; ++k) mesh_.cells_[i].v[k] = VertexHandle(c[k]);
      const Index largest = std::max(std::max(c[0], c[1]), std::max(c[2], c[3]));
      return largest >= n_points() || c[0] == c[1] || c[0] == c[2] || c[0] == c[3] || c[1] == c[2] ||
             c[1] == c[3] || c[2] == c[3];
    });
    if (bad == n_cells()) return;
    const std::string cell = std::string("cell ") + std::to_string(bad);
    for (Index v : input_[bad])
      HFR_REQUIRE(v < n_points(), cell + ": vertex index " + std::to_string(v) +
                                      " is out of range; there are " + std::to_string(n_points()) +
                                      " vertices");
    throw InvalidInput(cell + ": a vertex appears twice; remove the cell");
  }

  /// bucket_[start_[v]] … bucket_[start_[v + 1] - 1]: cells whose smallest or second smallest vertex is v.
  void fill_buckets() {
    // Histograms a part cost n_points each, so more than a few parts would not pay.
    const int n_parts = std::min(par::thread_count(policy_, n_cells()), 8);
    std::vector<std::vector<Index>> offset(static_cast<std::size_t>(n_parts));
    par::parts(n_parts, [&](int part) {
      auto& count = offset[static_cast<std::size_t>(part)];
      count.assign(n_points(), 0);
      const std::size_t end = par::part_begin(n_cells(), n_parts, part + 1);
      for (std::size_t i = par::part_begin(n_cells(), n_parts, part); i < end; ++i)
        for (Index v : two_smallest(input_[i])) ++count[v];
    });
    start_.resize(n_points() + 1);
    Index sum = 0;
    for (std::size_t v = 0; v < n_points(); ++v) {
      start_[v] = sum;
      for (auto& part : offset) {
        const Index count = part[v];
        part[v] = sum;
        sum += count;
      }
    }
    start_[n_points()] = sum;
    bucket_.resize(sum);
    par::parts(n_parts, [&](int part) {
      auto& at = offset[static_cast<std::size_t>(part)];
      const std::size_t end = par::part_begin(n_cells(), n_parts, part + 1);
      for (std::size_t i = par::part_begin(n_cells(), n_parts, part); i < end; ++i)
        for (Index v : two_smallest(input_[i])) bucket_[at[v]++] = static_cast<Index>(i);
    });
  }

  /// Returns the number of mates that see their face in the same order.
  std::int64_t match_buckets() {
    const int n_parts = par::thread_count(policy_, n_cells());
    std::vector<std::int64_t> conflicts(static_cast<std::size_t>(n_parts), 0);
    par::parts(n_parts, [&](int part) {
      FaceTable table;
      const std::size_t end = par::part_begin(n_points(), n_parts, part + 1);
      for (std::size_t v = par::part_begin(n_points(), n_parts, part); v < end; ++v)
        conflicts[static_cast<std::size_t>(part)] += match_bucket(static_cast<Index>(v), table);
    });
    std::int64_t sum = 0;
    for (std::int64_t c : conflicts) sum += c;
    return sum;
  }

  std::int64_t match_bucket(Index v, FaceTable& table) {
    constexpr std::size_t kAhead = 12;
    table.start(3 * (start_[v + 1] - start_[v]));
    std::int64_t conflicts = 0;
    for (std::size_t j = start_[v]; j < start_[v + 1]; ++j) {
      if (j + kAhead < bucket_.size()) __builtin_prefetch(&mesh_.cells_[bucket_[j + kAhead]], 1);
      const Sorted s = sort_corners(mesh_.cells_[bucket_[j]]);
      const bool smallest = s.vertex[0] == v;
      const std::size_t first = smallest ? 1 : 0;
      const std::size_t last = smallest ? 3 : 0;
      for (std::size_t i = first; i <= last; ++i) {  // the face opposite the i-th vertex
        const Index middle = s.vertex[i == 1 || !smallest ? 2 : 1];
        const Index largest = s.vertex[i == 3 ? 2 : 3];
        const Index odd = (s.odd ? 1U : 0U) ^ ((3 - i) & 1U);
        const Index h = 4 * bucket_[j] + s.corner[i];
        bool is_new = false;
        FaceTable::Slot& slot = table.find(middle, largest, is_new);
        if (is_new) {
          slot.waiting = 2 * h + odd;
          continue;
        }
        if (slot.waiting == FaceTable::kTaken) fail_three_cells({v, middle, largest});
        mesh_.cells_[h / 4].mate[h % 4] = HalfFaceHandle(slot.waiting / 2);
        mesh_.cells_[slot.waiting / 8].mate[slot.waiting / 2 % 4] = HalfFaceHandle(h);
        conflicts += (slot.waiting & 1U) == odd ? 1 : 0;
        slot.waiting = FaceTable::kTaken;
      }
    }
    return conflicts;
  }

  [[noreturn]] void fail_three_cells(const std::array<Index, 3>& face) const {
    std::string message = "face of vertices";
    for (Index v : face) message += " " + std::to_string(v);
    message += " belongs to more than two cells:";
    for (std::size_t i = 0; i < n_cells(); ++i) {
      const Corners& c = input_[i];
      const auto has = [&](Index v) { return std::find(c.begin(), c.end(), v) != c.end(); };
      if (std::all_of(face.begin(), face.end(), has)) message += " " + std::to_string(i);
    }
    throw InvalidInput(message + "; remove all but two");
  }

  /// Cells that are mates across two faces have all four vertices in common.
  void refuse_double_cells() const {
    const auto twin = [&](std::size_t i) {
      const auto& mate = mesh_.cells_[i].mate;
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t j = 0; j < k; ++j)
          if (mate[k].is_valid() && mate[k].idx() / 4 == mate[j].idx() / 4) return cell_of(mate[k]);
      return CellHandle();
    };
    const std::size_t bad = first_bad(n_cells(), [&](std::size_t i) { return twin(i).is_valid(); });
    if (bad == n_cells()) return;
    throw InvalidInput(std::string("cells ") + std::to_string(bad) + " and " +
                       std::to_string(twin(bad).idx()) + " have the same four vertices; remove one");
  }

  void refuse_double_edges(NonManifold non_manifold) const {
    const std::optional<DoubleEdge> edge = find_double_edge(mesh_, policy_);
    if (!edge) return;
    throw InvalidInput(
        "the edge of vertices " + std::to_string(edge->vertices[0].idx()) + " and " +
        std::to_string(edge->vertices[1].idx()) + " exists twice, once with cell " +
        std::to_string(edge->cells[0].idx()) + ", once with cell " + std::to_string(edge->cells[1].idx()) +
        ", and cells go all the way round it; remove the cells of one" +
        (non_manifold == NonManifold::kSplit ? ", since those of both its vertices connect through faces"
                                             : ", or split the mesh apart there (--split-nonmanifold)"));
  }

  bool opposite_order(HalfFaceHandle h, HalfFaceHandle m) const {
    const auto a = mesh_.halfface_vertices(h);
    const auto b = mesh_.halfface_vertices(m);
    for (std::size_t r = 0; r < 3; ++r)
      if (a[0] == b[r]) return a[1] == b[(r + 2) % 3];
    return false;
  }

  /// Puts every cell into the orientation that most cells of its component have.
  void agree() {
    constexpr std::uint8_t kUnknown = 2;
    std::vector<std::uint8_t> side(n_cells(), kUnknown);
    std::vector<CellHandle> component;
    for (std::size_t root = 0; root < n_cells(); ++root) {
      if (side[root] != kUnknown) continue;
      component.assign(1, CellHandle(root));
      side[root] = 0;
      std::size_t on_side[2] = {1, 0};
      for (std::size_t i = 0; i < component.size(); ++i) {
        const CellHandle c = component[i];
        for (int k = 0; k < 4; ++k) {
          const HalfFaceHandle h = halfface_of(c, k);
          const HalfFaceHandle m = mesh_.opposite_halfface(h);
          if (!m.is_valid()) continue;
          const auto wanted = static_cast<std::uint8_t>(side[c.idx()] ^ (opposite_order(h, m) ? 0 : 1));
          std::uint8_t& other = side[cell_of(m).idx()];
          if (other == kUnknown) {
            other = wanted;
            ++on_side[wanted];
            component.push_back(cell_of(m));
          } else if (other != wanted) {
            throw InvalidInput(std::string("cells ") + std::to_string(c.idx()) + " and " +
                               std::to_string(cell_of(m).idx()) +
                               ": the mesh cannot be oriented (it closes on itself like a Moebius strip)");
          }
        }
      }
      const std::uint8_t minority = on_side[1] > on_side[0] ? 0 : 1;
      for (CellHandle c : component) side[c.idx()] = side[c.idx()] == minority ? 1 : 0;
    }
    turn([&](std::size_t i) { return side[i] != 0; });
  }

  double six_volume(std::size_t i) const {
    const auto& v = mesh_.cells_[i].v;
    const Vec3 a = mesh_.point(v[0]);
    return dot(mesh_.point(v[1]) - a, cross(mesh_.point(v[2]) - a, mesh_.point(v[3]) - a));
  }

  Signs count_signs() const {
    return par::reduce(
        policy_, n_cells(), Signs{},
        [&](std::size_t i) {
          const double d = six_volume(i);
          return Signs{d < 0 ? 1 : 0, d > 0 ? 1 : 0};
        },
        [](Signs a, Signs b) {
          return Signs{a.negative + b.negative, a.positive + b.positive};
        });
  }

  /// Components with more negative cells than positive ones were written the other way round than the rest,
  /// which no neighbour could tell: they are turned, each as a whole. A search from a negative cell ends as
  /// soon as it has met more positive cells than there are negative ones, so a few inverted cells cost next
  /// to nothing.
  bool turn_negative_components() {
    const std::vector<std::uint32_t> negative =
        par::compact<std::uint32_t>(policy_, n_cells(), [&](std::size_t i) { return six_volume(i) < 0; });
    enum : std::uint8_t { kUnseen, kStays, kTurns, kSearched };
    std::vector<std::uint8_t> state(n_cells(), kUnseen);
    std::vector<std::size_t> found;
    bool any = false;
    for (std::size_t root : negative) {
      if (state[root] != kUnseen) continue;
      found.assign(1, root);
      state[root] = kSearched;
      Signs signs;
      bool stays = false;
      for (std::size_t i = 0; i < found.size() && !stays; ++i) {
        const double d = six_volume(found[i]);
        signs.negative += d < 0 ? 1 : 0;
        signs.positive += d > 0 ? 1 : 0;
        stays = signs.positive >= static_cast<std::int64_t>(negative.size());
        for (HalfFaceHandle m : mesh_.cells_[found[i]].mate) {
          if (!m.is_valid()) continue;
          std::uint8_t& other = state[m.idx() / 4];
          stays = stays || other == kStays;
          if (other != kUnseen) continue;
          other = kSearched;
          found.push_back(m.idx() / 4);
        }
      }
      const bool turns = !stays && signs.negative > signs.positive;
      any = any || turns;
      for (std::size_t i : found) state[i] = turns ? kTurns : kStays;
    }
    if (any) turn([&](std::size_t i) { return state[i] == kTurns; });
    return any;
  }

  /// Exchanges the last two vertices of each cell that turns(cell), and everybody's mates accordingly.
  template <class Turns>
  void turn(Turns&& turns) {
    par::for_each(policy_, n_cells(), [&](std::size_t i) {
      Cell& c = mesh_.cells_[i];
      if (turns(i)) {
        std::swap(c.v[2], c.v[3]);
        std::swap(c.mate[2], c.mate[3]);
      }
      for (HalfFaceHandle& m : c.mate)
        if (m.is_valid() && corner_of(m) >= 2 && turns(m.idx() / 4))
          m = halfface_of(cell_of(m), 5 - corner_of(m));
    });
  }

  /// Cells that were turned and not with the whole, or stayed when the whole was turned.
  std::vector<CellHandle> turned_by_themselves(bool flipped) const {
    return par::compact<CellHandle>(policy_, n_cells(), [&](std::size_t i) {
      return (mesh_.cells_[i].v[2].idx() != input_[i][2]) != flipped;
    });
  }

  void set_incident_cells() {
    mesh_.incident_cell_.assign(n_points(), CellHandle());
    for (std::size_t i = n_cells(); i-- > 0;)  // downwards, so that the smallest cell stays
      for (VertexHandle v : mesh_.cells_[i].v) mesh_.incident_cell_[v.idx()] = CellHandle(i);
  }

  TetMesh mesh_;
  std::span<const Corners> input_;
  par::Policy policy_;
  std::vector<Index> start_, bucket_;
};

TetMesh build(std::vector<Vec3> points, std::span<const std::array<Index, 4>> cells, par::Policy policy,
              BuildReport* report, NonManifold non_manifold, Turning turning) {
  return MeshBuilder(std::move(points), cells, policy).run(report, non_manifold, turning);
}

}  // namespace hfr
