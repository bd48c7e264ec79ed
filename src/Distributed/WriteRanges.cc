// SPDX-License-Identifier: BSD-3-Clause
// One file of which each rank writes a stretch. Own cells and vertices have numbers all over the whole, and a
// file has them in their order, so each rank is sent a range of the numbers first. Then all know how long
// their stretches are, hence where they begin.
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "Distributed/AttachedArrays.hh"
#include "Distributed/InParts.hh"
#include "Distributed/OwnItems.hh"
#include "Distributed/SharedFile.hh"
#include "Distributed/Slices.hh"
#include "HalfFace/Errors.hh"
#include "IO/MeshStretch.hh"
#include "IO/Words.hh"

namespace hfr::mpi {
namespace {

struct PointItem {
  std::uint64_t number = 0, source = 0;
  Vec3 point;
  std::int32_t label = 0, fixed = 0;
};
template <std::size_t N>
struct ElementItem {
  std::uint64_t number = 0;
  std::array<std::uint64_t, N> v{};
  std::int32_t label = 0;
};

/// Each item to the rank of its number, so many at a time. make(i): item i of this rank; take(item, place in
/// the range). All take part.
template <class Make, class Take>
void hand_to_ranges(Comm& comm, const Slices& slices, std::size_t n_mine, Make&& make, Take&& take) {
  using Item = decltype(make(std::size_t{}));
  constexpr std::size_t kAtOnce = 100'000;
  std::uint64_t n_came = 0;
  const auto n_turns =
      static_cast<std::size_t>(-comm.min(-static_cast<double>((n_mine + kAtOnce - 1) / kAtOnce)));
  for (std::size_t turn = 0; turn < n_turns; ++turn) {
    std::vector<std::vector<Item>> to(comm.n_ranks());
    for (std::size_t i = turn * kAtOnce; i < std::min((turn + 1) * kAtOnce, n_mine); ++i) {
      const Item item = make(i);
      to[slices.rank_of(item.number)].push_back(item);
    }
    std::vector<Packer> packed(comm.n_ranks());
    for (std::size_t r = 0; r < to.size(); ++r)
      if (!to[r].empty()) packed[r].put_all(std::exchange(to[r], {}));
    for (const Comm::Message& message : comm.exchange(packed))
      for (const Item& item : Unpacker(message.bytes).get_all<Item>()) {
        take(item, static_cast<std::size_t>(item.number - slices.begin(comm.rank())));
        ++n_came;
      }
  }
  if (n_came != slices.size(comm.rank())) throw InternalError("a range of numbers to write has gaps");
}

template <std::size_t N>
struct Elements {
  std::vector<std::array<std::uint64_t, N>> corners;
  std::vector<int> labels;

  template <class Make>
  io::ElementStretch receive(Comm& comm, std::uint64_t n_whole, std::size_t n_mine, Make&& make) {
    const Slices slices = Slices::even(comm.n_ranks(), n_whole);
    corners.resize(slices.size(comm.rank()));
    labels.resize(slices.size(comm.rank()));
    hand_to_ranges(comm, slices, n_mine, make, [&](const ElementItem<N>& item, std::size_t at) {
      corners[at] = item.v;
      labels[at] = item.label;
    });
    return {n_whole, io::NumberRows(corners), labels, slices.begin(comm.rank())};
  }
};

/// What this rank writes: of everything a range of the numbers.
class RangeOfMesh {
 public:
  /// `arrays`: those that are written, or none.
  RangeOfMesh(DistributedMesh& mesh, const Numbering& numbering, const OwnLabels& labels,
              const AttachedArrays* arrays)
      : mesh_(mesh), comm_(mesh.comm()), numbering_(numbering), arrays_(arrays) {
    stretch_.processes = {static_cast<std::size_t>(comm_.rank()), comm_.n_ranks(),
                          [this](std::span<const std::byte> mine) { return comm_.all_gather(mine); }};
    stretch_.names = &mesh.part().labels().names;
    stretch_.with_vertex_labels = labels.with_vertex_labels;
    stretch_.with_labels = labels.with_regions;
    receive_points(labels);
    stretch_.edges = edges_.receive(comm_, labels.n_edges, labels.edges.size(),
                                    [&](std::size_t i) { return item(labels.edges[i]); });
    stretch_.triangles = triangles_.receive(comm_, labels.n_faces, labels.faces.size(),
                                            [&](std::size_t i) { return item(labels.faces[i]); });
    const std::vector<CellHandle> cells = own_cells(mesh);
    stretch_.cells = cells_.receive(comm_, numbering.n_cells(), cells.size(), [&](std::size_t i) {
      return item(
          Labelled<4>{numbering(cells[i]), mesh.part().cell(cells[i]).v, mesh.part().region(cells[i])});
    });
    receive_cell_fields(cells);
  }
  RangeOfMesh(const RangeOfMesh&) = delete;
  RangeOfMesh& operator=(const RangeOfMesh&) = delete;

  io::MeshStretch& stretch() { return stretch_; }

 private:
  template <std::size_t N>
  ElementItem<N> item(const Labelled<N>& element) const {
    ElementItem<N> item{element.number, {}, element.label};
    for (std::size_t k = 0; k < N; ++k) item.v[k] = numbering_(element.v[k]);
    return item;
  }
  void receive_points(const OwnLabels& labels) {
    const std::vector<VertexHandle> vertices = own_vertices(mesh_);
    const Slices slices = Slices::even(comm_.n_ranks(), numbering_.n_vertices());
    const std::uint64_t first = slices.begin(comm_.rank());
    const std::size_t n = slices.size(comm_.rank());
    points_.resize(n);
    if (labels.with_vertex_labels) vertex_labels_.resize(n);
    std::vector<std::uint8_t> is_fixed(n, 0);
    std::vector<std::uint64_t> sources(arrays_ ? n : 0);
    const TetMesh& part = mesh_.part();
    hand_to_ranges(
        comm_, slices, vertices.size(),
        [&](std::size_t i) {
          const VertexHandle v = vertices[i];
          return PointItem{numbering_(v), mesh_.source(v), part.point(v), part.labels().vertex(v),
                           part.is_fixed(v) ? 1 : 0};
        },
        [&](const PointItem& p, std::size_t at) {
          points_[at] = p.point;
          if (!sources.empty()) sources[at] = p.source;
          if (labels.with_vertex_labels) vertex_labels_[at] = p.label;
          is_fixed[at] = p.fixed != 0 ? 1 : 0;
        });
    for (std::size_t i = 0; i < is_fixed.size(); ++i)
      if (is_fixed[i] != 0) fixed_.push_back(first + i);
    stretch_.first_point = first;
    stretch_.n_points = numbering_.n_vertices();
    stretch_.points = points_;
    stretch_.vertex_labels = vertex_labels_;
    stretch_.fixed = {labels.n_fixed, io::NumberRows(fixed_), {}};
    if (arrays_) point_fields_ = arrays_->points.fields_of(comm_, sources);
    stretch_.point_fields = point_fields_;
  }
  /// The cells of a range need not be of the parts of its rank.
  void receive_cell_fields(const std::vector<CellHandle>& cells) {
    if (!arrays_) return;
    const Slices slices = Slices::even(comm_.n_ranks(), numbering_.n_cells());
    std::vector<std::uint64_t> sources(slices.size(comm_.rank()));
    struct Sourced {
      std::uint64_t number = 0, source = 0;
    };
    hand_to_ranges(
        comm_, slices, cells.size(),
        [&](std::size_t i) {
          return Sourced{numbering_(cells[i]), mesh_.source(cells[i])};
        },
        [&](const Sourced& one, std::size_t at) { sources[at] = one.source; });
    cell_fields_ = arrays_->cells.fields_of(comm_, sources);
    stretch_.cell_fields = cell_fields_;
  }

  DistributedMesh& mesh_;
  Comm& comm_;
  const Numbering& numbering_;
  const AttachedArrays* arrays_;
  io::MeshStretch stretch_;
  std::vector<Vec3> points_;
  std::vector<int> vertex_labels_;
  std::vector<std::uint64_t> fixed_;
  std::vector<io::Field> point_fields_, cell_fields_;
  Elements<2> edges_;
  Elements<3> triangles_;
  Elements<4> cells_;
};

template <std::size_t N>
void add_box(io::LabelBoxes& boxes, const TetMesh& part, int label, const std::array<VertexHandle, N>& v) {
  std::array<Vec3, N> corners;
  for (std::size_t k = 0; k < N; ++k) corners[k] = part.point(v[k]);
  boxes.add(static_cast<int>(N) - 1, label, corners);
}

/// Of what this rank owns: it has the points of it.
io::LabelBoxes boxes_of_own(const DistributedMesh& mesh, const OwnLabels& labels) {
  const TetMesh& part = mesh.part();
  io::LabelBoxes boxes;
  for (VertexHandle v : own_vertices(mesh))
    if (const int label = part.labels().vertex(v); label != 0) add_box<1>(boxes, part, label, {v});
  for (const auto& edge : labels.edges) add_box(boxes, part, edge.label, edge.v);
  for (const auto& face : labels.faces) add_box(boxes, part, face.label, face.v);
  for (CellHandle c : own_cells(mesh)) add_box(boxes, part, part.region(c), part.cell(c).v);
  return boxes;
}

}  // namespace

std::vector<std::string> write_ranges(DistributedMesh& mesh, const std::filesystem::path& path,
                                      const io::WriteOptions& options) {
  io::require_stretches(path, options);
  const Numbering numbering(mesh);
  const OwnLabels labels(mesh);
  const bool takes_arrays = io::lower(path.extension().string()) == ".vtu";
  RangeOfMesh range(mesh, numbering, labels, takes_arrays ? mesh.arrays() : nullptr);
  if (io::wants_boxes(path, options)) range.stretch().boxes = boxes_of_own(mesh, labels);
  const io::StretchedFile stretched = io::stretched_file(path, range.stretch(), options);
  io::StretchLengths lengths;
  stretched.write(lengths);
  const std::vector<std::uint64_t> begins = begins_of_stretches(mesh.comm(), lengths.finish());
  SharedFile shared(mesh.comm(), path);
  OffsetFile file(shared.temporary());
  StretchSink sink(file, begins);
  stretched.write(sink);
  sink.finish();
  file.finish();
  shared.commit();
  std::vector<std::string> notes = stretched.notes;
  if (mesh.arrays() && !takes_arrays)
    for (std::string& note : mesh.arrays()->notes_on_leaving_out()) notes.push_back(std::move(note));
  return notes;
}

}  // namespace hfr::mpi
