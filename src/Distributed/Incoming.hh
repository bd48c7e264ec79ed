// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_INCOMING_HH
#define HFR_DISTRIBUTED_INCOMING_HH

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Distributed/Comm.hh"
#include "Distributed/DistributedMesh.hh"
#include "HalfFace/Vec3.hh"

namespace hfr::mpi {

/// A vertex and a cell by their numbers in the whole.
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

/// What this rank knows of a mesh that comes in from files: from cells that any rank may have read to parts
/// with their layers. A cell goes to the owners of its vertices first: then each rank has all cells of its
/// own vertices, and knows whose vertices are one edge away. To these go the cells of its vertices, and with
/// what comes each knows who is two edges away, to whom they go, too.
class Incoming {
 public:
  explicit Incoming(Comm& comm) : comm_(comm) {}

  /// Any order; the same thing may come twice. The points of a cell have to be there on its rank.
  void add(const PointRecord& point) { points_.push_back(point); }
  void add(const CornerRecord& cell) { given_.push_back(cell); }
  /// The same for all at once.
  void set_cells(std::vector<CornerRecord> cells) { given_ = std::move(cells); }
  /// On the rank that owns its smallest vertex, or on one that has this point when hand_to_owners() is
  /// called.
  void add(const LabelRecord& label) { labels_.push_back(label); }
  /// Of those that other ranks will hand over.
  void reserve_cells(std::size_t n) { cells_.reserve(n); }

  /// The rank that has most cells of a point owns it, the first of several. Each rank answers for a range of
  /// numbers; that it has seen all of them says that there are no gaps. All take part.
  void find_owners();
  /// After that: where a rank owns half as many points again as all do on average, points get other owners,
  /// by where they lie: about as many each. All take part.
  void even_out();
  /// For whoever has given points their owners: what the whole has.
  void set_size(std::uint64_t n_points, std::uint64_t n_cells) {
    n_points_ = n_points;
    n_cells_ = n_cells;
  }
  /// Each cell to the owners of its vertices, with its points, into `to` of these ranks, and each label to
  /// the owner of its smallest vertex; where that is this object itself, only what belongs here stays. All
  /// take part.
  void hand_to_owners(Incoming& to);
  /// From what owners have to the parts. Returns notes on labels. All take part. Throws InvalidInput, which
  /// names `file`, for what a mesh in parts cannot have.
  std::vector<std::string> make_parts(DistributedMesh& mesh, const std::filesystem::path& file,
                                      Inverted inverted = Inverted::kTurn);

 private:
  /// A cell by the places of its corners in points_, or in those of a message.
  struct PlacedCell {
    std::uint64_t number = 0;
    std::array<Index, 4> at{};
    std::int32_t region = 0;
  };
  struct Sets;

  void unite();
  void unite_points();
  void move_places(const std::vector<Index>& to);
  void make_index();
  std::size_t place(std::uint64_t number);
  std::vector<std::int32_t> owners() const;
  std::uint64_t end_of(std::uint64_t mine) const;
  template <class Item, class Counts>
  void require_each_once(std::uint64_t n, const char* what, const std::vector<Item>& items,
                         Counts&& counts) const;
  template <class Receivers>
  void send(Receivers&& receivers, Incoming& into);
  void pack(std::span<const Index> cells, std::vector<Index>& place_in_message, Packer& to) const;
  void take(const Comm::Message& message);
  Sets near_own(int edges);
  /// Leaves cells with a vertex within so many edges of own ones, and the points of these and own ones.
  void keep_near(std::uint8_t most);
  void send_labels(Incoming& to);
  DistributedMesh::Piece piece();

  Comm& comm_;
  std::vector<PointRecord> points_;
  std::vector<CornerRecord> given_;  // cells whose corners have no places yet
  std::vector<PlacedCell> cells_;
  std::vector<Index> block_begin_;  // of the index of points_, or none yet; in points_
  int block_bits_ = 0;
  std::vector<LabelRecord> labels_;
  std::uint64_t n_points_ = 0, n_cells_ = 0;
};

}  // namespace hfr::mpi

#endif
