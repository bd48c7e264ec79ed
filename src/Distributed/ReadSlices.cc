// SPDX-License-Identifier: BSD-3-Clause
// One file by ranges. Numbers say nothing of where a cell lies, so what a rank has read goes to others:
// points are shared out along a curve that fills their box, cells to the owners of their vertices.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/InParts.hh"
#include "Distributed/Incoming.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Reorder.hh"
#include "IO/VtuSlices.hh"

namespace hfr::mpi {
namespace {

/// Even ranges of numbers, one a rank.
class Slices {
 public:
  Slices(const Comm& comm, std::uint64_t n) : n_ranks_(comm.n_ranks()), n_(n) {}
  std::uint64_t begin(std::uint64_t rank) const { return (rank * n_ + n_ranks_ - 1) / n_ranks_; }
  std::size_t rank_of(std::uint64_t number) const { return number * n_ranks_ / n_; }

 private:
  std::uint64_t n_ranks_, n_;
};

/// Of the points of all ranks.
CurveGrid common_grid(Comm& comm, const std::vector<Vec3>& mine) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low = {kInfinity, kInfinity, kInfinity}, high = {-kInfinity, -kInfinity, -kInfinity};
  for (int d = 0; d < 3; ++d) {
    for (const Vec3& p : mine) low[d] = std::min(low[d], p[d]), high[d] = std::max(high[d], p[d]);
    low[d] = comm.min(low[d]);
    high[d] = -comm.min(-high[d]);
  }
  return {SpaceCurve::kHilbert, low, high};
}

/// Who owns what: stretches of Hilbert's curve through the box of all points, about as many points on each.
class CurveOwners {
 public:
  /// `mine`: the points that this rank has read. All take part.
  CurveOwners(Comm& comm, const std::vector<Vec3>& mine) : grid_(common_grid(comm, mine)) {
    constexpr std::size_t kSamples = 1024;  // of each rank
    std::vector<std::uint64_t> sample;
    const std::size_t step = std::max<std::size_t>(mine.size() / kSamples, 1);
    for (std::size_t i = 0; i < mine.size(); i += step) sample.push_back(grid_.place(mine[i]));
    sample = comm.all_gather(std::span<const std::uint64_t>(sample));
    std::sort(sample.begin(), sample.end());
    for (std::size_t r = 1; r < comm.n_ranks(); ++r)
      splitters_.push_back(sample[r * sample.size() / comm.n_ranks()]);
  }

  std::int32_t operator()(Vec3 p) const {
    const auto at = std::upper_bound(splitters_.begin(), splitters_.end(), grid_.place(p));
    return static_cast<std::int32_t>(at - splitters_.begin());
  }

 private:
  CurveGrid grid_;
  std::vector<std::uint64_t> splitters_;
};

/// Cells on their way: a range of them at a time goes to the owners of its vertices, whose points and owners
/// this rank learns from those that have read them.
class Passage {
 public:
  Passage(Comm& comm, const Slices& slices, std::vector<PointRecord> read)
      : comm_(comm), slices_(slices), points_(std::move(read)) {}

  /// The points that this rank has read, to their owners.
  void send_points(Incoming& incoming) {
    std::vector<std::vector<PointRecord>> to(comm_.n_ranks());
    for (const PointRecord& p : points_) to[static_cast<std::size_t>(p.owner)].push_back(p);
    exchange_points(to, incoming);
  }

  void send_cells(const std::vector<CornerRecord>& cells, Incoming& incoming) {
    std::vector<std::vector<std::uint64_t>> wanted(comm_.n_ranks());
    for (const CornerRecord& c : cells)
      for (std::uint64_t number : c.v) wanted[slices_.rank_of(number)].push_back(number);
    std::vector<Packer> questions(comm_.n_ranks());
    for (std::size_t r = 0; r < wanted.size(); ++r) {
      std::vector<std::uint64_t>& numbers = wanted[r];
      std::sort(numbers.begin(), numbers.end());
      numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
      if (!numbers.empty()) questions[r].put_all(std::exchange(numbers, {}));
    }
    std::vector<std::vector<PointRecord>> answers(comm_.n_ranks());
    const std::uint64_t first = slices_.begin(static_cast<std::uint64_t>(comm_.rank()));
    for (const Comm::Message& message : comm_.exchange(questions))
      for (std::uint64_t number : Unpacker(message.bytes).get_all<std::uint64_t>())
        answers[static_cast<std::size_t>(message.from)].push_back(points_[number - first]);
    Incoming some(comm_);
    exchange_points(answers, some);
    some.reserve_cells(cells.size());
    for (const CornerRecord& c : cells) some.add(c);
    some.hand_to_owners(incoming);
  }

 private:
  void exchange_points(std::vector<std::vector<PointRecord>>& to, Incoming& incoming) {
    std::vector<Packer> packed(comm_.n_ranks());
    for (std::size_t r = 0; r < to.size(); ++r)
      if (!to[r].empty()) packed[r].put_all(std::exchange(to[r], {}));
    for (const Comm::Message& message : comm_.exchange(packed))
      for (const PointRecord& p : Unpacker(message.bytes).get_all<PointRecord>()) incoming.add(p);
  }

  Comm& comm_;
  const Slices& slices_;
  std::vector<PointRecord> points_;  // of this rank's slice
};

std::vector<PointRecord> read_points(Comm& comm, const Slices& slices, io::VtuSlices& file) {
  const auto rank = static_cast<std::uint64_t>(comm.rank());
  std::uint64_t number = slices.begin(rank);
  const std::vector<Vec3> points = file.points(number, slices.begin(rank + 1));
  const CurveOwners owner(comm, points);
  std::vector<PointRecord> records;
  records.reserve(points.size());
  for (const Vec3& p : points) records.push_back({number++, p, owner(p)});
  return records;
}

std::vector<CornerRecord> read_cells(io::VtuSlices& file, std::uint64_t begin, std::uint64_t end) {
  const auto corners = file.cells(begin, end);
  std::vector<std::int32_t> regions;
  if (file.has_regions()) regions = file.regions(begin, end);
  std::vector<CornerRecord> records;
  records.reserve(corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c)
    records.push_back({begin + c, corners[c], regions.empty() ? 0 : regions[c]});
  return records;
}

}  // namespace

std::vector<std::string> read_vtu(DistributedMesh& mesh, const std::filesystem::path& path,
                                  std::uint64_t at_once) {
  Comm& comm = mesh.comm();
  const Comm::InPhase phase(comm, Phase::kHandOut);
  io::VtuSlices file(path);
  HFR_REQUIRE(file.n_points() > 0 && file.n_cells() > 0, path.string() + ": it has no cells");
  const Slices points(comm, file.n_points()), cells(comm, file.n_cells());
  Incoming incoming(comm);
  incoming.set_size(file.n_points(), file.n_cells());
  {
    Passage passage(comm, points, read_points(comm, points, file));
    passage.send_points(incoming);
    // All ranks take part in as many turns as the longest slice has.
    const auto rank = static_cast<std::uint64_t>(comm.rank());
    const std::uint64_t longest = (file.n_cells() + comm.n_ranks() - 1) / comm.n_ranks();
    const std::uint64_t end = cells.begin(rank + 1);
    incoming.reserve_cells(longest + longest / 4);
    for (std::uint64_t done = 0; done < longest; done += at_once) {
      const std::uint64_t from = std::min(cells.begin(rank) + done, end);
      passage.send_cells(read_cells(file, from, std::min(from + at_once, end)), incoming);
    }
  }
  incoming.make_parts(mesh);
  return file.notes();
}

}  // namespace hfr::mpi
