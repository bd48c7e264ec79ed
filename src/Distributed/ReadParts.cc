// SPDX-License-Identifier: BSD-3-Clause
// From the cells of pieces to parts with their layers. A cell goes to the owners of its vertices first: then
// each rank has all cells of its own vertices, and knows whose vertices are one edge away. To these go the
// cells of its vertices, and with what comes each knows who is two edges away, to whom they go, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"

namespace hfr::mpi {
namespace {

struct PointRecord {
  std::uint64_t number = 0;
  Vec3 point;
  std::int32_t owner = 0;
};
struct CornerRecord {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 4> v{};
  std::int32_t region = 0;
};

std::string unescaped(std::string text) {
  for (const auto& [code, c] :
       {std::pair{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}})
    for (std::size_t at = 0; (at = text.find(code, at)) != std::string::npos; ++at)
      text.replace(at, std::string_view(code).size(), 1, c);
  return text;
}

/// The files that an index names. It is small, so each rank reads it.
std::vector<std::filesystem::path> pieces_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(path.string() + ": cannot be opened");
  std::ostringstream all;
  all << in.rdbuf();
  const std::string text = all.str();
  if (text.find("<PUnstructuredGrid") == std::string::npos)
    throw InvalidInput(path.string() + ": no index of pieces of an unstructured grid");
  std::vector<std::filesystem::path> pieces;
  for (std::size_t at = 0; (at = text.find("<Piece", at)) != std::string::npos;) {
    const std::size_t end = text.find('>', at);
    constexpr std::string_view kSource = "Source=\"";
    const std::size_t from = text.find(kSource, at);
    if (end == std::string::npos || from == std::string::npos || from > end)
      throw InvalidInput(path.string() + ": a piece without a source");
    const std::size_t begin = from + kSource.size();
    pieces.push_back(path.parent_path() / unescaped(text.substr(begin, text.find('"', begin) - begin)));
    at = end;
  }
  if (pieces.empty()) throw InvalidInput(path.string() + ": it names no pieces");
  return pieces;
}

std::vector<std::uint64_t> numbers_of(const std::filesystem::path& path,
                                      const std::vector<io::Field>& fields) {
  constexpr double kMost = 9007199254740992.0;  // whole numbers up to here are exact
  for (const io::Field& field : fields) {
    if (field.name != "number" || field.components != 1) continue;
    std::vector<std::uint64_t> numbers;
    numbers.reserve(field.values.size());
    for (const double value : field.values) {
      if (!(value >= 0 && value < kMost) || value != std::floor(value))
        throw InvalidInput(path.string() + ": a \"number\" is no whole number");
      numbers.push_back(static_cast<std::uint64_t>(value));
    }
    return numbers;
  }
  throw InvalidInput(path.string() +
                     ": points and cells need a \"number\" in the whole each, as write_pvtu() gives "
                     "them");
}

/// What this rank knows of the mesh while it comes in.
class Incoming {
 public:
  explicit Incoming(Comm& comm) : comm_(comm) {}

  void read(const std::filesystem::path& path) {
    io::MeshData data = io::read_mesh(path);
    if (!data.triangles.empty() || !data.edges.empty() || !data.vertex_labels.empty() ||
        !data.fixed_vertices.empty())
      throw InvalidInput(path.string() +
                         ": meshes in parts do not have labelled or fixed faces, edges and vertices yet");
    const auto points = numbers_of(path, data.point_fields), cells = numbers_of(path, data.cell_fields);
    for (std::size_t i = 0; i < points.size(); ++i)
      points_.push_back({points[i], data.points[i], comm_.rank()});
    for (std::size_t i = 0; i < cells.size(); ++i) {
      CornerRecord one{cells[i], {}, data.regions.empty() ? 0 : data.regions[i]};
      for (std::size_t k = 0; k < 4; ++k) {
        HFR_REQUIRE(data.cells[i][k] < points.size(),
                    path.string() + ": a cell has a point that is not there");
        one.v[k] = points[data.cells[i][k]];
      }
      cells_.push_back(one);
    }
  }

  void distribute() {
    unite();
    find_owners();
    send([&](const CornerRecord&, const Places& at, std::vector<int>& to) {
      for (Index i : at) to.push_back(owner(i));
    });
    for (int edges = 1; edges <= 2; ++edges) {
      const Sets near = near_own(edges);
      send([&](const CornerRecord&, const Places& at, std::vector<int>& to) {
        for (Index v : at) to.insert(to.end(), near[v].begin(), near[v].end());
      });
    }
  }

  std::uint64_t n_points() const { return n_points_; }
  std::uint64_t n_cells() const { return n_cells_; }

  DistributedMesh::Piece piece() {
    DistributedMesh::Piece piece;
    std::vector<Vec3> points;
    std::vector<std::array<Index, 4>> cells;
    keep_what_is_near();
    for (const PointRecord& p : points_) {
      piece.vertex_number.push_back(p.number);
      piece.owner.push_back(p.owner);
      points.push_back(p.point);
    }
    bool has_regions = false;
    cells.reserve(cells_.size());
    for_cells([&](const CornerRecord& c, const Places& at) {
      piece.cell_number.push_back(c.number);
      cells.push_back(at);
      has_regions = has_regions || c.region != 0;
    });
    points_ = {};
    piece.mesh = build(std::move(points), cells);
    for (std::size_t c = 0; c < cells.size(); ++c)
      HFR_REQUIRE(piece.mesh.cell(CellHandle(c)).v[2].idx() == cells[c][2],
                  "cells of a mesh in parts have to be oriented alike, and most of them positive");
    if (has_regions)
      for (std::size_t c = 0; c < cells.size(); ++c) piece.mesh.set_region(CellHandle(c), cells_[c].region);
    cells_ = {};
    return piece;
  }

 private:
  /// Points and cells by number, each once.
  void unite() {
    const auto by_number = [](auto& items) {
      const auto less = [](const auto& a, const auto& b) { return a.number < b.number; };
      const auto middle =
          std::is_sorted_until(items.begin(), items.end(), less);  // what has come stands behind
      std::sort(middle, items.end(), less);
      std::inplace_merge(items.begin(), middle, items.end(), less);
      items.erase(std::unique(items.begin(), items.end(),
                              [](const auto& a, const auto& b) { return a.number == b.number; }),
                  items.end());
    };
    by_number(points_);
    by_number(cells_);
  }
  /// Of a number among the points. Corners of one cell after the other lie near each other, so the search
  /// begins where the last one has ended.
  std::size_t place(std::uint64_t number, std::size_t hint) const {
    std::size_t low = std::min(hint, points_.size() - 1), high = low, step = 1;
    if (points_[low].number <= number)
      for (; high < points_.size() && points_[high].number <= number; step *= 2) low = high, high += step;
    else
      for (; low > 0 && points_[low].number > number; step *= 2) high = low, low -= std::min(low, step);
    const auto begin = points_.begin() + static_cast<std::ptrdiff_t>(low);
    const auto end = points_.begin() + static_cast<std::ptrdiff_t>(std::min(high + 1, points_.size()));
    const auto at = std::lower_bound(begin, end, number,
                                     [](const PointRecord& p, std::uint64_t n) { return p.number < n; });
    if (at == end || at->number != number) throw InternalError("a point of a cell has not come along");
    return static_cast<std::size_t>(at - points_.begin());
  }
  using Places = std::array<Index, 4>;
  /// body(cell, places of its corners) for all cells.
  template <class Body>
  void for_cells(Body&& body) const {
    std::size_t hint = 0;
    for (const CornerRecord& c : cells_) {
      Places at{};
      for (std::size_t k = 0; k < 4; ++k) at[k] = static_cast<Index>(hint = place(c.v[k], hint));
      body(c, at);
    }
  }
  int owner(Index at) const { return points_[at].owner; }

  /// One more than the largest number of all.
  std::uint64_t end_of(std::uint64_t mine) const {
    return static_cast<std::uint64_t>(-comm_.min(-static_cast<double>(mine)));
  }

  /// The first rank that has a point owns it. Each rank answers for a range of numbers; that it has seen all
  /// of them says that there are no gaps.
  void find_owners() {
    n_points_ = end_of(points_.empty() ? 0 : points_.back().number + 1);
    n_cells_ = end_of(cells_.empty() ? 0 : cells_.back().number + 1);
    HFR_REQUIRE(n_points_ > 0 && n_cells_ > 0, "the pieces have no cells");
    HFR_REQUIRE(comm_.sum(cells_.size()) == n_cells_, "numbers of cells have gaps, or come twice");
    const std::uint64_t n_ranks = comm_.n_ranks();
    const auto begin = [&](std::uint64_t r) { return (r * n_points_ + n_ranks - 1) / n_ranks; };
    std::vector<Packer> to(comm_.n_ranks());
    for (const PointRecord& p : points_) to[p.number * n_ranks / n_points_].put(p.number);
    const auto me = static_cast<std::uint64_t>(comm_.rank());
    std::vector<std::int32_t> first(begin(me + 1) - begin(me), -1);
    std::vector<std::vector<std::uint64_t>> asked(comm_.n_ranks());
    for (const Comm::Message& message : comm_.exchange(to))
      for (Unpacker in(message.bytes); !in.at_end();) {
        const auto number = in.get<std::uint64_t>();
        asked[static_cast<std::size_t>(message.from)].push_back(number);
        std::int32_t& owner = first[number - begin(me)];
        if (owner < 0) owner = message.from;  // messages come by rank
      }
    HFR_REQUIRE(std::find(first.begin(), first.end(), -1) == first.end(), "numbers of points have gaps");
    std::vector<Packer> answers(comm_.n_ranks());
    for (std::size_t r = 0; r < asked.size(); ++r)
      for (std::uint64_t number : asked[r]) answers[r].put(first[number - begin(me)]);
    std::vector<std::vector<std::byte>> came(comm_.n_ranks());
    for (Comm::Message& message : comm_.exchange(answers))
      came[static_cast<std::size_t>(message.from)] = std::move(message.bytes);
    std::vector<Unpacker> in;
    for (const auto& bytes : came) in.emplace_back(bytes);
    for (PointRecord& p : points_) p.owner = in[p.number * n_ranks / n_points_].get<std::int32_t>();
  }

  /// Each cell to the ranks that `receivers` adds to the list, with its points.
  template <class Receivers>
  void send(Receivers&& receivers) {
    std::vector<std::vector<CornerRecord>> cells(comm_.n_ranks());
    std::vector<int> list;
    for_cells([&](const CornerRecord& c, const Places& at) {
      list.clear();
      receivers(c, at, list);
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      for (int r : list)
        if (r != comm_.rank()) cells[static_cast<std::size_t>(r)].push_back(c);
    });
    std::vector<Packer> to(comm_.n_ranks());
    for (std::size_t r = 0; r < cells.size(); ++r) {
      if (cells[r].empty()) continue;
      std::vector<std::uint64_t> numbers;
      for (const CornerRecord& c : cells[r]) numbers.insert(numbers.end(), c.v.begin(), c.v.end());
      std::sort(numbers.begin(), numbers.end());
      numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
      std::vector<PointRecord> points;
      for (std::size_t at = 0; std::uint64_t number : numbers)
        points.push_back(points_[at = place(number, at)]);
      to[r].put_all(points);
      to[r].put_all(std::exchange(cells[r], {}));
    }
    for (const Comm::Message& message : comm_.exchange(to)) {
      Unpacker in(message.bytes);
      const auto points = in.get_all<PointRecord>();
      points_.insert(points_.end(), points.begin(), points.end());
      const auto came = in.get_all<CornerRecord>();
      cells_.insert(cells_.end(), came.begin(), came.end());
    }
    unite();
  }

  /// A set of ranks for some points, by place.
  struct Sets {
    static constexpr Index kNone = VertexHandle::kInvalid;
    std::vector<Index> of;
    std::vector<std::vector<int>> ranks;

    void add(Index at, int r) {
      if (of[at] == kNone) {
        of[at] = static_cast<Index>(ranks.size());
        ranks.emplace_back();
      }
      auto& set = ranks[of[at]];
      if (std::find(set.begin(), set.end(), r) == set.end()) set.push_back(r);
    }
    std::span<const int> operator[](Index at) const {
      return of[at] == kNone ? std::span<const int>() : std::span<const int>(ranks[of[at]]);
    }
  };

  /// Of own vertices that have others' within so many edges: the owners of these. One edge less round own
  /// vertices all cells are here.
  Sets near_own(int edges) const {
    Sets one{std::vector<Index>(points_.size(), Sets::kNone), {}};  // of any vertex: owners of its neighbours
    for_cells([&](const CornerRecord&, const Places& at) {
      if (std::all_of(at.begin(), at.end(), [&](Index i) { return owner(i) == owner(at[0]); })) return;
      for (Index v : at)
        for (Index w : at) one.add(v, owner(w));
    });
    Sets two = one;
    if (edges == 2)
      for_cells([&](const CornerRecord&, const Places& at) {
        for (Index w : at)
          for (int r : one[w])
            for (Index v : at) two.add(v, r);
      });
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (points_[i].owner != comm_.rank()) two.of[i] = Sets::kNone;
    return two;
  }

  /// Cells with a vertex within two edges of own ones, and the points of these and own ones.
  void keep_what_is_near() {
    constexpr std::uint8_t kFar = 3;
    std::vector<std::uint8_t> edges(points_.size(), kFar);
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (points_[i].owner == comm_.rank()) edges[i] = 0;
    const auto nearest = [&](const Places& at) {
      return std::min(std::min(edges[at[0]], edges[at[1]]), std::min(edges[at[2]], edges[at[3]]));
    };
    for (std::uint8_t step = 1; step < kFar; ++step)
      for_cells([&](const CornerRecord&, const Places& at) {
        if (nearest(at) != step - 1) return;
        for (Index i : at) edges[i] = std::min(edges[i], step);
      });
    std::vector<std::uint8_t> stays(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) stays[i] = edges[i] == 0 ? 1 : 0;
    std::size_t n_cells = 0;
    std::vector<std::uint8_t> is_near(cells_.size(), 0);
    for_cells([&](const CornerRecord& c, const Places& at) {
      if (nearest(at) == kFar) return;
      for (Index i : at) stays[i] = 1;
      is_near[static_cast<std::size_t>(&c - cells_.data())] = 1;
    });
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (is_near[c]) cells_[n_cells++] = cells_[c];
    cells_.resize(n_cells);
    std::size_t n = 0;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (stays[i]) points_[n++] = points_[i];
    points_.resize(n);
  }

  Comm& comm_;
  std::vector<PointRecord> points_;
  std::vector<CornerRecord> cells_;
  std::uint64_t n_points_ = 0, n_cells_ = 0;
};

}  // namespace

void read_pvtu(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Comm::InPhase phase(mesh.comm(), Phase::kHandOut);
  const std::vector<std::filesystem::path> pieces = pieces_of(path);
  Incoming incoming(mesh.comm());
  const std::size_t n_ranks = mesh.comm().n_ranks();
  for (auto i = static_cast<std::size_t>(mesh.comm().rank()); i < pieces.size(); i += n_ranks)
    incoming.read(pieces[i]);
  incoming.distribute();
  mesh.assemble(incoming.piece(), incoming.n_points(), incoming.n_cells());
}

}  // namespace hfr::mpi
