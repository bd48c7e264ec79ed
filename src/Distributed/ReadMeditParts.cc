// SPDX-License-Identifier: BSD-3-Clause
// A mesh in the files of ParMmg: one for each part, which has vertices of its own numbers and says, for each
// part that it meets, which of its vertices or triangles are there as well. Of the copies of a vertex, that
// of the smallest part counts. Sides of an interface tell each other what copy they know of, until that is
// the same everywhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "Distributed/Incoming.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeditPart.hh"

namespace hfr::mpi {
namespace {

/// The copy of a vertex that counts.
struct Copy {
  std::uint64_t part = 0, vertex = 0;
  Vec3 point;

  bool operator<(const Copy& other) const {
    return std::tie(part, vertex) < std::tie(other.part, other.vertex);
  }
  bool operator==(const Copy& other) const { return part == other.part && vertex == other.vertex; }
};

/// What a part shares with another one, in the order of the numbers that both know.
struct Interface {
  int other = 0;
  std::vector<std::int64_t> number;
  std::vector<Index> vertices;  ///< of each: itself, or three of a triangle
  bool is_heard = false;        ///< the other side has it as well
};

struct Part {
  int number = 0;
  std::string name;  ///< of its file
  io::MeditPart file;
  std::vector<Interface> interfaces;
  std::vector<Copy> copy;                ///< of each vertex
  std::vector<std::uint8_t> is_between;  ///< triangles that are there since parts meet, not for their label
  double tolerance = 0;                  ///< how far copies of a vertex may be apart

  std::size_t width() const { return file.by_triangles ? 3 : 1; }
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput(name + ": " + message); }
};

/// Counts of what each part has of its own: all ranks know those of all parts.
struct Counts {
  std::uint64_t part = 0, points = 0, cells = 0, triangles = 0, edges = 0;
};

/// How many files there are, numbered without gaps.
int count_files(const std::filesystem::path& path) {
  std::error_code error;
  int n = 0;
  while (std::filesystem::exists(io::medit_part_path(path, n), error)) ++n;
  return n;
}

class MeditParts {
 public:
  MeditParts(Comm& comm, const std::filesystem::path& path) : comm_(comm) {
    n_parts_ = comm.from_first(comm.rank() == 0 ? count_files(path) : 0);
    const std::filesystem::path first = io::medit_part_path(path, 0);
    HFR_REQUIRE(n_parts_ > 0, first.string() + ": there is no such file");
    for (int i = comm.rank(); i < n_parts_; i += comm.size()) read(path, i);
  }

  /// All take part from here on.
  void identify_vertices() {
    meet();
    for (Part& part : parts_) start_copies(part);
    std::uint64_t n_changed = 1;
    while (n_changed > 0) {
      n_changed = 0;
      across<Copy>([](const Part& part, const Interface& side) { return copies(part, side); },
                   [&](Part& part, Interface& side, const std::vector<Copy>& theirs) {
                     for (std::size_t k = 0; k < theirs.size(); ++k)
                       if (Copy& mine = part.copy[side.vertices[k]]; theirs[k] < mine) {
                         mine = theirs[k];
                         ++n_changed;
                       }
                   });
      n_changed = comm_.sum(n_changed);
    }
    for (const Part& part : parts_) require_apart(part);
  }

  void hand_to(Incoming& incoming) {
    for (Part& part : parts_) mark_between(part);
    const std::vector<Counts> before = counts_before();
    const std::vector<std::vector<std::uint64_t>> numbers = number_vertices(before);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      hand(parts_[i], before[static_cast<std::size_t>(parts_[i].number)], numbers[i], incoming);
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> all;
    for (const Part& part : parts_)
      for (const std::string& note : part.file.mesh.notes) all.push_back(part.name + ": " + note);
    return all;
  }

 private:
  std::size_t rank_of(std::uint64_t part) const { return static_cast<std::size_t>(part) % comm_.n_ranks(); }
  Part& part_at(int number) { return parts_[static_cast<std::size_t>(number) / comm_.n_ranks()]; }

  void read(const std::filesystem::path& path, int number) {
    Part& part = parts_.emplace_back();
    const std::filesystem::path file = io::medit_part_path(path, number);
    part.number = number;
    part.name = file.string();
    part.file = io::read_medit_part(file);
    if (part.file.n_parts != 0 && part.file.n_parts != n_parts_)
      part.fail("it is one of " + std::to_string(part.file.n_parts) + " parts, and there are files of " +
                std::to_string(n_parts_));
    if (part.file.mesh.cells.empty()) part.fail("it has no tetrahedra");
    part.tolerance = tolerance_of(part.file.mesh.points);
    for (const io::MeditInterface& interface : part.file.interfaces)
      part.interfaces.push_back(ordered(part, interface));
    std::error_code error;
    const std::filesystem::path beside = std::filesystem::path(file).replace_extension(".sol");
    if (std::filesystem::exists(beside, error)) part.file.mesh.notes.push_back(beside.string() + " left out");
  }
  /// A millionth of the box.
  static double tolerance_of(const std::vector<Vec3>& points) {
    constexpr double kFar = std::numeric_limits<double>::infinity(), kPortion = 1e-6;
    Vec3 low = {kFar, kFar, kFar}, high = {-kFar, -kFar, -kFar};
    for (const Vec3& p : points)
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    return kPortion * norm(high - low);
  }
  Interface ordered(const Part& part, const io::MeditInterface& given) const {
    const auto with = [&] { return "its communicator with part " + std::to_string(given.part); };
    if (given.part >= n_parts_ || given.part == part.number)
      part.fail(with() + " is one with no other of the " + std::to_string(n_parts_) + " parts");
    for (const Interface& other : part.interfaces)
      if (other.other == given.part) part.fail(with() + " comes twice");
    std::vector<std::pair<std::int64_t, Index>> items;
    for (std::size_t i = 0; i < given.items.size(); ++i) items.emplace_back(given.number[i], given.items[i]);
    std::sort(items.begin(), items.end());
    Interface side;
    side.other = given.part;
    for (const auto& [number, item] : items) {
      if (!side.number.empty() && side.number.back() == number)
        part.fail(with() + " has the global number " + std::to_string(number) + " twice");
      side.number.push_back(number);
      if (part.file.by_triangles)
        for (const Index v : part.file.mesh.triangles[item]) side.vertices.push_back(v);
      else
        side.vertices.push_back(item);
    }
    return side;
  }

  /// What each side of an interface says to the other one: say(part, side) gives a vector of T, and
  /// hear(part, side, values) is told that of the other.
  template <class T, class Say, class Hear>
  void across(Say&& say, Hear&& hear) {
    std::vector<Packer> to(comm_.n_ranks());
    for (const Part& part : parts_)
      for (const Interface& side : part.interfaces) {
        Packer& out = to[rank_of(static_cast<std::uint64_t>(side.other))];
        out.put(std::array<int, 2>{part.number, side.other});
        out.put_all(std::vector<T>(say(part, side)));
      }
    for (const Comm::Message& message : comm_.exchange(to))
      for (Unpacker in(message.bytes); !in.at_end();) {
        const auto [from, number] = in.get<std::array<int, 2>>();
        Part& part = part_at(number);
        const auto side = std::find_if(part.interfaces.begin(), part.interfaces.end(),
                                       [other = from](const Interface& s) { return s.other == other; });
        if (side == part.interfaces.end())
          part.fail("it has no communicator with part " + std::to_string(from) + ", which has one with it");
        hear(part, *side, in.get_all<T>());
      }
  }

  struct Item {
    std::int64_t number = 0;
    std::array<Vec3, 3> points;
    std::uint64_t width = 1;
  };

  /// The sides compare what they have, and the larger part takes over the order of the smaller one's corners.
  void meet() {
    across<Item>(
        [](const Part& part, const Interface& side) {
          std::vector<Item> items(side.number.size());
          for (std::size_t i = 0; i < items.size(); ++i) {
            items[i].number = side.number[i];
            items[i].width = part.width();
            for (std::size_t k = 0; k < part.width(); ++k)
              items[i].points[k] = part.file.mesh.points[side.vertices[i * part.width() + k]];
          }
          return items;
        },
        [](Part& part, Interface& side, const std::vector<Item>& theirs) { compare(part, side, theirs); });
    for (const Part& part : parts_)
      for (const Interface& side : part.interfaces)
        if (!side.is_heard)
          part.fail("it has a communicator with part " + std::to_string(side.other) +
                    ", which has none with it");
  }
  static void compare(Part& part, Interface& side, const std::vector<Item>& theirs) {
    const std::string with = "its communicator with part " + std::to_string(side.other);
    side.is_heard = true;
    if (theirs.size() != side.number.size())
      part.fail(with + " has " + std::to_string(side.number.size()) + " items, and " +
                std::to_string(theirs.size()) + " on the other side");
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      if (theirs[i].width != part.width())
        part.fail(with + " is of triangles on one side and of vertices on the other");
      if (theirs[i].number != side.number[i])
        part.fail(with + " has the global number " + std::to_string(side.number[i]) +
                  ", where the other side has " + std::to_string(theirs[i].number));
      match(part, side, i, theirs[i]);
    }
  }
  /// Brings the vertices of item i into the order of the other side's points.
  static void match(const Part& part, Interface& side, std::size_t i, const Item& theirs) {
    const std::size_t n = part.width();
    Index* const mine = side.vertices.data() + n * i;
    std::array<Index, 3> in_order{};
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t nearest = n;
      double least = part.tolerance;
      for (std::size_t j = 0; j < n; ++j) {
        const double distance = norm(part.file.mesh.points[mine[j]] - theirs.points[k]);
        if (distance <= least) nearest = j, least = distance;
      }
      const bool is_taken = nearest < n && std::find(in_order.begin(), in_order.begin() + k, mine[nearest]) !=
                                               in_order.begin() + k;
      if (nearest == n || is_taken)
        part.fail("of global number " + std::to_string(side.number[i]) + ", shared with part " +
                  std::to_string(side.other) + ", the points are others there");
      in_order[k] = mine[nearest];
    }
    if (side.other < part.number) std::copy(in_order.begin(), in_order.begin() + n, mine);
  }

  static void start_copies(Part& part) {
    const std::vector<Vec3>& points = part.file.mesh.points;
    for (std::size_t v = 0; v < points.size(); ++v)
      part.copy.push_back({static_cast<std::uint64_t>(part.number), v, points[v]});
  }
  static std::vector<Copy> copies(const Part& part, const Interface& side) {
    std::vector<Copy> all;
    for (const Index v : side.vertices) all.push_back(part.copy[v]);
    return all;
  }
  /// No two vertices of a part are the same.
  static void require_apart(const Part& part) {
    std::vector<Copy> copies = part.copy;
    std::sort(copies.begin(), copies.end());
    const auto same = std::adjacent_find(copies.begin(), copies.end());
    if (same != copies.end())
      part.fail("by the communicators two of its vertices are vertex " + std::to_string(same->vertex + 1) +
                " of part " + std::to_string(same->part));
  }

  /// Triangles without a label that parts have since they meet there.
  static void mark_between(Part& part) {
    const io::MeshData& mesh = part.file.mesh;
    part.is_between.assign(mesh.triangles.size(), 0);
    for (const Index t : part.file.parallel_triangles) part.is_between[t] = 1;
    for (const io::MeditInterface& interface : part.file.interfaces) {
      if (part.file.by_triangles) {
        for (const Index t : interface.items) part.is_between[t] = 1;
        continue;
      }
      std::vector<std::uint8_t> is_shared(mesh.points.size(), 0);
      for (const Index v : interface.items) is_shared[v] = 1;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                        [&](Index v) { return is_shared[v] != 0; }))
          part.is_between[t] = 1;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.triangle_labels[t] != 0) part.is_between[t] = 0;
  }
  /// Edges that are there since parts meet.
  static std::vector<std::uint8_t> edges_between(const Part& part) {
    const io::MeshData& mesh = part.file.mesh;
    std::vector<std::uint8_t> is_between(mesh.edges.size(), 0);
    for (const Index e : part.file.parallel_edges) is_between[e] = mesh.edge_labels[e] == 0 ? 1 : 0;
    return is_between;
  }

  /// Of the parts before each one, summed.
  std::vector<Counts> counts_before() {
    std::vector<Counts> mine;
    for (const Part& part : parts_) {
      Counts c;
      c.part = static_cast<std::uint64_t>(part.number);
      for (const Copy& copy : part.copy) c.points += copy.part == c.part ? 1 : 0;
      c.cells = part.file.mesh.cells.size();
      c.triangles = static_cast<std::uint64_t>(std::count(part.is_between.begin(), part.is_between.end(), 0));
      const std::vector<std::uint8_t> edges = edges_between(part);
      c.edges = static_cast<std::uint64_t>(std::count(edges.begin(), edges.end(), 0));
      mine.push_back(c);
    }
    std::vector<Counts> all = comm_.all_gather(std::span<const Counts>(mine));
    std::sort(all.begin(), all.end(), [](const Counts& a, const Counts& b) { return a.part < b.part; });
    Counts sum;
    for (Counts& c : all) {
      const Counts own = c;
      c = sum;
      sum.points += own.points, sum.cells += own.cells;
      sum.triangles += own.triangles, sum.edges += own.edges;
    }
    return all;
  }

  /// Numbers in the whole: those whose copy counts in the order of parts; for the others their parts are
  /// asked.
  std::vector<std::vector<std::uint64_t>> number_vertices(const std::vector<Counts>& before) {
    using Question = std::array<std::uint64_t, 2>;  // part, vertex
    std::vector<std::vector<std::uint64_t>> numbers(parts_.size());
    std::vector<std::vector<Question>> asked(comm_.n_ranks());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const auto number = static_cast<std::uint64_t>(parts_[i].number);
      std::uint64_t next = before[number].points;
      for (const Copy& copy : parts_[i].copy) {
        const bool is_own = copy.part == number;
        numbers[i].push_back(is_own ? next++ : kNoNumber);
        if (!is_own) asked[rank_of(copy.part)].push_back({copy.part, copy.vertex});
      }
    }
    std::vector<Packer> questions(comm_.n_ranks()), answers(comm_.n_ranks());
    for (std::size_t r = 0; r < asked.size(); ++r)
      if (!asked[r].empty()) questions[r].put_all(std::exchange(asked[r], {}));
    for (const Comm::Message& message : comm_.exchange(questions))
      for (const auto& [part, vertex] : Unpacker(message.bytes).get_all<Question>())
        answers[static_cast<std::size_t>(message.from)].put(numbers[part / comm_.n_ranks()][vertex]);
    std::vector<std::vector<std::byte>> came(comm_.n_ranks());
    for (Comm::Message& message : comm_.exchange(answers))
      came[static_cast<std::size_t>(message.from)] = std::move(message.bytes);
    std::vector<Unpacker> in;
    for (const auto& bytes : came) in.emplace_back(bytes);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      for (std::size_t v = 0; v < numbers[i].size(); ++v)
        if (numbers[i][v] == kNoNumber)
          numbers[i][v] = in[rank_of(parts_[i].copy[v].part)].get<std::uint64_t>();
    return numbers;
  }

  template <std::size_t N>
  static void hand_labelled(const std::vector<std::array<Index, N>>& items, const std::vector<int>& labels,
                            const std::vector<std::uint8_t>& is_between, std::uint64_t first,
                            const std::vector<std::uint64_t>& number, Incoming& incoming) {
    LabelRecord r;
    r.kind = N == 3 ? LabelRecord::Kind::kFace : LabelRecord::Kind::kEdge;
    r.number = first;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (is_between[i] != 0) continue;
      for (std::size_t k = 0; k < N; ++k) r.v[k] = number[items[i][k]];
      r.value = labels[i];
      incoming.add(r);
      ++r.number;
    }
  }
  void hand(const Part& part, const Counts& before, const std::vector<std::uint64_t>& number,
            Incoming& incoming) const {
    const io::MeshData& mesh = part.file.mesh;
    for (std::size_t v = 0; v < number.size(); ++v)
      incoming.add(PointRecord{number[v], part.copy[v].point, comm_.rank()});
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      CornerRecord one{before.cells + c, {}, mesh.regions.empty() ? 0 : mesh.regions[c]};
      for (std::size_t k = 0; k < 4; ++k) one.v[k] = number[mesh.cells[c][k]];
      incoming.add(one);
    }
    hand_labelled(mesh.triangles, mesh.triangle_labels, part.is_between, before.triangles, number, incoming);
    hand_labelled(mesh.edges, mesh.edge_labels, edges_between(part), before.edges, number, incoming);
    LabelRecord r;
    for (std::size_t v = 0; v < mesh.vertex_labels.size(); ++v) {
      r.v[0] = number[v];
      r.value = mesh.vertex_labels[v];
      r.number = static_cast<std::uint64_t>(part.number);
      if (r.value != 0) incoming.add(r);
    }
    r = {};
    r.kind = LabelRecord::Kind::kFixedVertex;
    for (const Index v : mesh.fixed_vertices) {
      r.v[0] = number[v];
      incoming.add(r);
    }
  }

  Comm& comm_;
  int n_parts_ = 0;
  std::vector<Part> parts_;  // of this rank: rank, rank + n_ranks, …
};

}  // namespace

bool has_medit_parts(Comm& comm, const std::filesystem::path& path) {
  std::error_code error;
  const bool has = comm.rank() == 0 && path.extension() == ".mesh" && !std::filesystem::exists(path, error) &&
                   std::filesystem::exists(io::medit_part_path(path, 0), error);
  return comm.from_first(has ? 1 : 0) != 0;
}

std::vector<std::string> read_medit_parts(DistributedMesh& mesh, const std::filesystem::path& path) {
  const Comm::InPhase phase(mesh.comm(), Phase::kHandOut);
  std::vector<std::string> notes;
  Incoming incoming(mesh.comm());
  {
    MeditParts parts(mesh.comm(), path);
    parts.identify_vertices();
    parts.hand_to(incoming);
    notes = parts.notes();
  }
  incoming.find_owners();
  incoming.even_out();
  incoming.hand_to_owners(incoming);
  // What lies between parts is in the files of all of them: that it comes several times is no news.
  incoming.make_parts(mesh, path);
  return notes;
}

}  // namespace hfr::mpi
