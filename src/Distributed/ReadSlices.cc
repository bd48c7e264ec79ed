// SPDX-License-Identifier: BSD-3-Clause
// One file by ranges. Numbers say nothing of where a cell lies, so what a rank has read goes to others:
// points are shared out along a curve that fills their box, cells to the owners of their vertices.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/AttachedArrays.hh"
#include "Distributed/CurveOwners.hh"
#include "Distributed/InParts.hh"
#include "Distributed/Incoming.hh"
#include "Distributed/Slices.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshShare.hh"
#include "IO/Words.hh"

namespace hfr::mpi {
namespace {

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

  /// To the owner of the smallest vertex, by the rank that has read this.
  void send_labels(const std::vector<LabelRecord>& labels, Incoming& incoming) {
    std::vector<std::vector<LabelRecord>> to(comm_.n_ranks());
    for (const LabelRecord& r : labels) to[slices_.rank_of(r.smallest_vertex())].push_back(r);
    std::vector<std::vector<LabelRecord>> on(comm_.n_ranks());
    const std::uint64_t first = slices_.begin(comm_.rank());
    exchange_labels(to, [&](const LabelRecord& r) {
      on[static_cast<std::size_t>(points_[r.smallest_vertex() - first].owner)].push_back(r);
    });
    exchange_labels(on, [&](const LabelRecord& r) { incoming.add(r); });
  }

  void send_cells(std::vector<CornerRecord> cells, Incoming& incoming) {
    std::vector<std::vector<std::uint64_t>> wanted(comm_.n_ranks());
    // Numbers asked for last: most corners are among those of other cells.
    std::vector<std::uint64_t> latest(std::bit_ceil(cells.size() / 2 + 1), kNoNumber);
    for (const CornerRecord& c : cells)
      for (std::uint64_t number : c.v)
        if (std::exchange(latest[number & (latest.size() - 1)], number) != number)
          wanted[slices_.rank_of(number)].push_back(number);
    std::vector<Packer> questions(comm_.n_ranks());
    for (std::size_t r = 0; r < wanted.size(); ++r) {
      std::vector<std::uint64_t>& numbers = wanted[r];
      std::sort(numbers.begin(), numbers.end());
      numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
      if (!numbers.empty()) questions[r].put_all(std::exchange(numbers, {}));
    }
    std::vector<std::vector<PointRecord>> answers(comm_.n_ranks());
    const std::uint64_t first = slices_.begin(comm_.rank());
    for (const Comm::Message& message : comm_.exchange(questions))
      for (std::uint64_t number : Unpacker(message.bytes).get_all<std::uint64_t>())
        answers[static_cast<std::size_t>(message.from)].push_back(points_[number - first]);
    Incoming some(comm_);
    exchange_points(answers, some);
    some.set_cells(std::move(cells));
    some.hand_to_owners(incoming);
  }

 private:
  template <class Use>
  void exchange_labels(std::vector<std::vector<LabelRecord>>& to, Use&& use) {
    std::vector<Packer> packed(comm_.n_ranks());
    for (std::size_t r = 0; r < to.size(); ++r)
      if (!to[r].empty()) packed[r].put_all(std::exchange(to[r], {}));
    for (const Comm::Message& message : comm_.exchange(packed))
      for (const LabelRecord& r : Unpacker(message.bytes).get_all<LabelRecord>()) use(r);
  }
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

io::Processes processes(Comm& comm) {
  return {static_cast<std::size_t>(comm.rank()), comm.n_ranks(),
          [&comm](std::span<const std::byte> mine) { return comm.all_gather(mine); }};
}

/// What this rank reads of a file, as records.
class ShareReader {
 public:
  ShareReader(Comm& comm, io::MeshShare& share) : comm_(comm), share_(share) {}

  std::vector<PointRecord> points() {
    io::SharePoints read = share_.points();
    const CurveOwners owner(comm_, read.points.size(), [&](std::size_t i) { return read.points[i]; });
    std::vector<PointRecord> records;
    records.reserve(read.points.size());
    std::uint64_t number = read.first;
    for (const Vec3& p : read.points) records.push_back({number++, p, owner(p)});
    for (std::size_t i = 0; i < read.labels.size(); ++i)
      if (read.labels[i] != 0) label_vertex(read.first + i, read.labels[i]);
    for (std::size_t i = 0; i < read.fixed.size(); ++i)
      if (read.fixed[i] != 0) fix(read.first + i);
    point_rows_ = std::move(read.rows);
    if (!share_.point_fields().empty())
      for (const Vec3& p : read.points) places_.insert(places_.end(), {p.x, p.y, p.z});
    return records;
  }

  /// Portion i, or nothing where there are no more; its labels are kept.
  std::vector<CornerRecord> cells(std::size_t i) {
    std::vector<CornerRecord> records;
    if (i >= share_.n_portions()) return records;
    const io::ShareItems items = share_.portion(i);
    records.reserve(items.cells.corners.size());
    std::uint64_t number = items.cells.first;
    for (std::size_t c = 0; c < items.cells.corners.size(); ++c)
      records.push_back({number++, items.cells.corners[c], items.cells.labels[c]});
    label(items.triangles, LabelRecord::Kind::kFace);
    label(items.edges, LabelRecord::Kind::kEdge);
    for (const auto& [v, value] : items.vertex_labels) label_vertex(v, value);
    for (std::uint64_t v : items.fixed) fix(v);
    n_cells_ += records.size();
    cell_rows_.insert(cell_rows_.end(), items.cell_rows.begin(), items.cell_rows.end());
    has_other_values_.resize(share_.cell_fields().size(), 0);
    for (std::size_t f = 0; f < items.has_other_values.size(); ++f)
      has_other_values_[f] |= items.has_other_values[f];
    return records;
  }

  /// Once all cells have been read; `points`: which this rank and others have read. Nothing where the file
  /// has no arrays. Adds what is lost of them.
  std::shared_ptr<const AttachedArrays> arrays(const Slices& points, std::vector<std::string>& notes) {
    if (share_.point_fields().empty() && share_.cell_fields().empty()) return nullptr;
    has_other_values_.resize(share_.cell_fields().size(), 0);
    comm_.sum(has_other_values_);
    for (std::size_t f = 0; f < has_other_values_.size(); ++f)
      if (has_other_values_[f] > 0)
        notes.push_back("cell field '" + io::shown(share_.cell_fields()[f].name) +
                        "': only its values on tetrahedra are kept, those on other cells are dropped");
    std::vector<std::uint64_t> begins_of_cells = {0};
    for (std::uint64_t n : comm_.all_gather(std::span<const std::uint64_t>(&n_cells_, 1)))
      begins_of_cells.push_back(begins_of_cells.back() + n);
    auto arrays = std::make_shared<AttachedArrays>();
    arrays->points = KeptRows(comm_, share_.point_fields(), points, std::move(point_rows_));
    arrays->cells =
        KeptRows(comm_, share_.cell_fields(), Slices(std::move(begins_of_cells)), std::move(cell_rows_));
    if (!share_.point_fields().empty())
      arrays->places = KeptRows(comm_, {{"", 3, false}}, points, std::move(places_));
    return arrays;
  }

  const std::vector<LabelRecord>& labels() const { return labels_; }

 private:
  template <std::size_t N>
  void label(const io::ShareElements<N>& elements, LabelRecord::Kind kind) {
    LabelRecord r;
    r.kind = kind;
    r.number = elements.first;
    for (std::size_t i = 0; i < elements.corners.size(); ++i, ++r.number) {
      std::copy(elements.corners[i].begin(), elements.corners[i].end(), r.v.begin());
      r.value = elements.labels[i];
      labels_.push_back(r);
    }
  }
  void label_vertex(std::uint64_t v, std::int32_t value) {
    // Shares of ranks follow on one another in the file.
    const std::uint64_t number = (static_cast<std::uint64_t>(comm_.rank()) << 40) + labels_.size();
    labels_.push_back({{v, kNoNumber, kNoNumber}, number, value, LabelRecord::Kind::kVertex});
  }
  void fix(std::uint64_t v) {
    labels_.push_back({{v, kNoNumber, kNoNumber}, 0, 0, LabelRecord::Kind::kFixedVertex});
  }

  Comm& comm_;
  io::MeshShare& share_;
  std::vector<LabelRecord> labels_;
  std::vector<double> point_rows_, cell_rows_, places_;
  std::vector<std::uint64_t> has_other_values_;
  std::uint64_t n_cells_ = 0;
};

}  // namespace

std::vector<std::string> read_ranges(DistributedMesh& mesh, const std::filesystem::path& path,
                                     std::uint64_t at_once) {
  Comm& comm = mesh.comm();
  const Comm::InPhase phase(comm, Phase::kHandOut);
  const std::unique_ptr<io::MeshShare> share = io::open_share(path, processes(comm), at_once);
  const std::span<const std::uint64_t> begins = share->point_begins();
  const Slices slices({begins.begin(), begins.end()});
  Incoming incoming(comm);
  incoming.set_size(share->n_points(), share->n_cells());
  std::vector<std::string> notes = share->notes();
  std::shared_ptr<const AttachedArrays> arrays;
  {
    ShareReader reader(comm, *share);
    Passage passage(comm, slices, reader.points());
    passage.send_points(incoming);
    // All ranks take part in as many turns as the longest share has.
    const auto n_turns = static_cast<std::size_t>(-comm.min(-static_cast<double>(share->n_portions())));
    const std::uint64_t even = share->n_cells() / comm.n_ranks();
    incoming.reserve_cells(even + even / 4);
    for (std::size_t i = 0; i < n_turns; ++i) passage.send_cells(reader.cells(i), incoming);
    passage.send_labels(reader.labels(), incoming);
    arrays = reader.arrays(slices, notes);
  }
  for (std::string& note : incoming.make_parts(mesh, path)) notes.push_back(std::move(note));
  if (arrays) mesh.attach_arrays(std::move(arrays));
  mesh.part().labels().names = share->names();
  return notes;
}

}  // namespace hfr::mpi
