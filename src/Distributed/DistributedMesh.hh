// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_DISTRIBUTED_MESH_HH
#define HFR_DISTRIBUTED_DISTRIBUTED_MESH_HH

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/Distributed/LabelOrder.hh"
#include "hfremesh/Distributed/Marks.hh"
#include "hfremesh/Distributed/PartLabels.hh"
#include "hfremesh/Distributed/Partition.hh"
#include "hfremesh/Distributed/RankSets.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Scheduler/Workspace.hh"

namespace hfr::mpi {

struct AttachedArrays;

namespace detail {

/// What a rank has of a mesh that is cut among the ranks, and comes back to.
struct PartState {
  TetMesh mesh_;
  PartLabels labels_;
  std::vector<std::uint64_t> vertex_number_;  // ascending
  std::vector<int> owner_;
  std::vector<std::uint64_t> cell_number_;  // by slot; the first n_sorted_ ascend
  std::size_t n_sorted_ = 0;
  std::unordered_map<std::uint64_t, Index> later_;  // slots from n_sorted_ on
  std::uint64_t n_slots_ = 0, n_vertices_ = 0;
  std::vector<std::uint64_t> free_;
  LabelOrder face_order_;  // while the labels of faces are followed
  std::shared_ptr<const AttachedArrays> arrays_;
};

}  // namespace detail

/// What of a mesh was written the other way round.
struct Turned {
  bool whole = false;         ///< first all of it was turned
  std::uint64_t n_alone = 0;  ///< cells that were turned and not with the whole, or the other way round
};

/// Whether a mesh, or what of it hangs together, with more negative cells than positive ones is turned, as
/// build() does, or stays inverted.
enum class Inverted : std::uint8_t { kTurn, kLeave };

/// A mesh that is cut among the ranks. Each vertex has an owner, the same in all passes; a cell belongs to
/// the owner of its vertex with the smallest number. A rank holds the cells with a vertex of its own and two
/// layers of cells round them: all that have a vertex within two edges of its own ones. That is what it takes
/// to evaluate any seed of its own cells, and to commit what others have decided next to them.
///
/// Numbers, of 64 bits, are those of the whole mesh: its vertices, and its cell slots. In a part, vertices
/// stand in the order of their numbers; cells in any order, each slot for one number as long as the part
/// lives. Nothing of it depends on who owns what but who does the work.
///
/// What has to be equal on all parts that hold it is: cells, their qualities and pending bits, points, what
/// hangs on the vertices, edges and faces of cells (labels, and what is fixed), and within two edges of own
/// vertices change stamps, star sizes, incident cells, and whether a vertex is pinched.
class DistributedMesh : private detail::PartState {
 public:
  explicit DistributedMesh(Comm& comm) : comm_(comm) {}
  DistributedMesh(const DistributedMesh&) = delete;
  DistributedMesh& operator=(const DistributedMesh&) = delete;

  /// Why a mesh cannot be cut yet; empty where it can. Cell properties and bits, pinched vertices.
  static std::string reason_against(const TetMesh& mesh, const Workspace& work);

  /// Hands out the mesh and the workspace of rank 0, attached to it and with its qualities; `owner`: of each
  /// vertex, see partition(). What other ranks pass is not looked at. All take part.
  void scatter(const TetMesh* mesh, const Workspace* work, std::span<const int> owner,
               par::Policy policy = {});

  /// What one rank has of a mesh that comes into being in parts: all cells with a vertex within two edges of
  /// an own one, and no others. Vertices and cells ascend by number; vertices may be more than the cells
  /// have.
  struct Piece {
    TetMesh mesh;
    std::vector<std::uint64_t> vertex_number, cell_number;
    std::vector<int> owner;            ///< of each vertex
    std::vector<std::uint8_t> turned;  ///< cells that build() has turned here; empty where none was
  };
  /// The parts of a mesh of so many vertices and cells, numbered without gaps, with a workspace that has no
  /// qualities yet. Cells are turned as build() and `inverted` say; throws InvalidInput for a mesh that
  /// cannot be oriented.
  Turned assemble(Piece piece, std::uint64_t n_vertices, std::uint64_t n_cells,
                  Inverted inverted = Inverted::kTurn);
  /// After assemble(), for what a file says of vertices, edges and faces: each on the rank that owns its
  /// smallest vertex, with its place in the file as its number, maybe several times. Of several labels of a
  /// vertex the first one counts, of an edge or a face the last one, which has the place and the order of the
  /// first. Returns notes, the same on all ranks. Throws InvalidInput where no cell has such an edge or face.
  /// All take part.
  std::vector<std::string> attach_labels(std::vector<LabelRecord> records);
  /// After assemble(): arrays of a file, whose rows are those of the vertices and cells by their numbers now.
  /// From here on operators hand on whose row each has, as they hand on properties: a vertex keeps its row, a
  /// new one has that of the nearest, and a new cell that of one in whose place it came. For
  /// readers of files: Distributed/AttachedArrays.hh is no public header.
  void attach_arrays(std::shared_ptr<const AttachedArrays> arrays);
  /// None where nothing is attached.
  const AttachedArrays* arrays() const { return arrays_.get(); }
  /// The number of the row; 0 where nothing is attached.
  std::uint64_t source(VertexHandle v) const;
  std::uint64_t source(CellHandle c) const;

  /// To all ranks that hold a cell with these vertices, and into this part. Each on the rank that owns its
  /// smallest vertex. All take part.
  void hand_out_labels(std::span<const LabelRecord> records);

  /// From here to leave_face_labels(), labels of faces may change: each rank holds the order of all labelled
  /// faces. All take part.
  void follow_face_labels();
  struct LabelledFace {
    LabelOrder::Face v{};  ///< in the order of the label
    std::int32_t label = 0;
  };
  /// These faces of the whole are no more, and these have a label now: the same on all ranks.
  void change_face_labels(std::span<const LabelOrder::Face> gone, std::span<const LabelledFace> set);
  void leave_face_labels();

  /// Of this part, to come back to: some 50 bytes a cell. It answers no questions on what lies near.
  std::shared_ptr<const DistributedMesh> copy() const;
  /// Makes it what the copy is, all cells pending, without qualities, and all vertices changed now. What the
  /// workspace has of the run goes on: clock, floor, and whether damage is held. The copy may be one of
  /// another mesh of the same ranks. All take part.
  void put_back(const DistributedMesh& copy);

  /// Gives cells other numbers, to[slot] for each slot, and the slots the order of these; see is_dense().
  /// What the workspace has of vertices stays. Returns the old numbers, by new slot.
  std::vector<std::uint64_t> renumber(std::span<const std::uint64_t> to);

  /// Which vertices are pinched now, as Workspace::attach() looks for them. All take part.
  void find_pinched();

  /// What gather() brings.
  enum class Gather : std::uint8_t {
    kChanged,    ///< what has changed since scatter(), into the mesh that was handed out
    kEverything  ///< all cells and points, whatever stands there
  };
  /// Brings the parts together in the mesh and workspace of rank 0, which have the vertices, labels and
  /// properties that were handed out; vertices that have come since are added. The mesh is then what the same
  /// passes make of it in shared memory: points, slots, mates, incident cells, free list. All take part; the
  /// parts stay as they are.
  void gather(TetMesh* mesh, Workspace* work, Gather what, par::Policy policy = {});

  Comm& comm() const { return comm_; }
  TetMesh& part() { return mesh_; }
  const TetMesh& part() const { return mesh_; }
  Workspace& work() { return work_; }
  const Workspace& work() const { return work_; }

  std::uint64_t number(VertexHandle v) const { return vertex_number_[v.idx()]; }
  std::uint64_t number(CellHandle c) const { return cell_number_[c.idx()]; }
  /// In the order of numbers, which is that of most slots.
  bool is_before(CellHandle a, CellHandle b) const {
    return a.idx() < n_sorted_ && b.idx() < n_sorted_ ? a < b : number(a) < number(b);
  }
  int owner(VertexHandle v) const { return owner_[v.idx()]; }
  bool is_own(VertexHandle v) const { return owner_[v.idx()] == comm_.rank(); }
  bool is_own(CellHandle c) const {
    const auto& v = mesh_.cell(c).v;
    return is_own(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])));
  }
  /// Invalid where this rank holds none of that number; a cell may be a deleted one.
  VertexHandle vertex_at(std::uint64_t number) const;
  CellHandle cell_at(std::uint64_t number) const;
  /// Slots and cells of the whole mesh.
  std::uint64_t n_slots() const { return n_slots_; }
  /// Vertices of the whole, also those that are deleted.
  std::uint64_t n_vertices() const { return n_vertices_; }
  std::uint64_t n_cells() const { return n_slots_ - free_.size(); }

  // --- for rounds and passes ---
  /// Owners within one edge of v: exact for vertices within two edges of own ones.
  std::span<const std::uint64_t> near(VertexHandle v) const { return near1_[v.idx()]; }
  /// Within two edges: exact within one edge.
  std::span<const std::uint64_t> within_two(VertexHandle v) const { return near2_[v.idx()]; }
  const RankSets& within_two() const { return near2_; }
  /// within_two() as it was when other ranks were last told of all cells round v.
  std::span<const std::uint64_t> told(VertexHandle v) const { return told_[v.idx()]; }
  void note_told();
  /// Own vertices whose within_two() may be another than told().
  std::span<const VertexHandle> renewed() const { return renewed_; }
  /// True where no neighbour is another rank's.
  bool is_among_own(VertexHandle v) const { return near1_.is_only(v.idx(), comm_.rank()); }
  /// True where no vertex within two edges is another rank's.
  bool is_inside(VertexHandle v) const { return near2_.is_only(v.idx(), comm_.rank()); }
  /// Slots of all cells with a vertex that is not inside, and of some others: which were such, or are gone.
  std::span<const Index> zone() const { return zone_; }
  bool is_in_zone(CellHandle c) const { return c.idx() < in_zone_.size() && in_zone_[c.idx()] != 0; }
  /// A cell has come that may be in the zone.
  void note_created(CellHandle c);
  /// Cells with these vertices have come or gone.
  void note_changed(std::span<const VertexHandle> vertices) {
    dirty_.insert(dirty_.end(), vertices.begin(), vertices.end());
  }
  /// Free slots of the whole, in the order of TetMesh::free_cells(): the same on all ranks.
  std::vector<std::uint64_t>& free_slots() { return free_; }
  const std::vector<std::uint64_t>& free_slots() const { return free_; }
  std::uint64_t& n_slots() { return n_slots_; }
  /// Vertices have been added to the whole; their numbers are the next ones.
  void add_numbers(std::uint64_t n) { n_vertices_ += n; }
  /// The slot of that number, a new deleted one if need be.
  CellHandle slot_of(std::uint64_t number);
  /// near() and within_two() after what was noted, and zone() without what is not in it. O(zone), with the
  /// work on sets where cells have come or gone.
  void update_zone();
  /// Takes out the cells without a vertex within two edges of own ones.
  void prune();
  /// Takes a cell out of this part; what was behind its faces has nothing there.
  void detach(CellHandle c);
  /// Own vertices that other ranks hold, by rank: those of which it has a cell.
  std::vector<std::vector<VertexHandle>> held_by_others() const;
  /// Gives own vertices other owners: `to`, by vertex, of which those of own ones count. Those that are
  /// deleted or have no cell keep theirs. What ranks hold follows. The mesh stays what it is; handles may be
  /// others. Between passes, and not while labels of faces are followed. All take part.
  void change_owners(std::span<const int> to);
  /// Slots of cells that this part does not hold any more go, and the others come to stand in the order of
  /// numbers. Between passes. No other rank is asked.
  void drop_dead_slots();

  /// What one rank tells another of a vertex, and of a cell.
  struct VertexRecord {
    std::uint64_t number = 0, incident = kNoNumber;
    std::uint64_t source = 0;  ///< Sources.hh
    Vec3 point;
    std::int32_t owner = 0;
    std::uint32_t star_size = 0, changed = 0;
    std::uint8_t frozen = 0, of_owner = 0, deleted = 0, pinched = 0;
  };
  struct CellRecord {
    std::uint64_t number = 0;
    std::array<std::uint64_t, 4> v{}, mate{};  ///< mates as 4·cell + corner
    std::uint64_t source = 0;                  ///< Sources.hh
    double quality = 0;
    std::int32_t region = 0;
    std::uint8_t pending = 0;
  };
  VertexRecord record(VertexHandle v) const;
  CellRecord record(CellHandle c) const;
  /// What one rank tells another of some of either, and of what hangs on them.
  struct Records {
    std::vector<VertexRecord> vertices;
    std::vector<CellRecord> cells;
    std::vector<LabelRecord> labels;

    /// What pack() has put there, up to the end.
    void append(Unpacker& in);
  };
  /// At the end of a message. `as_owner`: of the vertices this rank is, or was until now, the owner.
  void pack(std::span<const CellHandle> cells, std::span<const VertexHandle> vertices, Packer& to,
            bool as_owner = false) const;
  /// Of these vertices, and of the edges and faces of these cells.
  std::vector<LabelRecord> labels_of(std::span<const CellHandle> cells,
                                     std::span<const VertexHandle> vertices) const {
    return labels_.of(mesh_, work_.frozen, cells, vertices, [this](VertexHandle v) { return number(v); });
  }
  const PartLabels& label_numbers() const { return labels_; }
  /// For whoever looks at a few vertices or cells of the part, one at a time.
  Marks& vertex_marks() const { return vertex_marks_.for_all_of(mesh_.n_vertices()); }
  Marks& cell_marks() const { return cell_marks_.for_all_of(mesh_.n_cells()); }
  /// Of each edge and face, whose vertices are all here: whether a cell of this part has it.
  std::vector<std::uint8_t> has_cell(std::span<const LabelRecord> records) const;
  /// Writes what came. Records of owners count where there are several of a vertex; of a cell all are equal,
  /// but for mates, which a rank may have as they were before. So what they do not tell is found by vertices:
  /// faces of the cells that are written, and those that detach() has opened since the last call. `labels`:
  /// of these vertices and cells.
  void apply(const Records& records);

 private:
  void build_part(Block& block, par::Policy policy);
  void scatter_labels(const TetMesh* mesh, std::span<const int> owner);
  void add_vertices(std::vector<VertexRecord> fresh);
  void insert_vertices(std::span<const VertexRecord> fresh);
  void add_labels(std::span<const LabelRecord> records) {
    labels_.add(mesh_, records, [this](std::uint64_t n) { return vertex_at(n); });
    for (const LabelRecord& r : records)
      if (r.kind != LabelRecord::Kind::kVertex)
        for (std::uint64_t n : r.v)
          if (n != kNoNumber) work_.frozen[vertex_at(n).idx()] = 1;
  }
  void refuse_loose(std::span<const LabelRecord> records) const;
  void write_cells(std::span<const CellRecord> cells);
  void link(std::span<const CellRecord> cells);
  void match_open_faces();
  bool see_each_other(HalfFaceHandle h, HalfFaceHandle g) const;
  void start_zone();
  void complete_rim();
  void tell_owners(std::span<const int> to);
  struct Push {
    std::vector<CellHandle> cells;
    std::vector<VertexHandle> vertices;
  };
  std::vector<Push> fresh_near(std::span<const int> before, const RankSets& held) const;
  void put_into_zone(CellHandle c);
  template <class Fill>
  std::vector<VertexHandle> renew(RankSets& sets, std::span<const VertexHandle> vertices,
                                  std::span<const Index> cells, Fill&& fill);
  std::vector<Index> zone_round(std::span<const VertexHandle> vertices);
  void write_slots(TetMesh& mesh, Workspace& work) const;
  void write_whole(TetMesh& mesh, Workspace& work, std::span<const VertexRecord> vertices,
                   std::span<const CellRecord> cells, par::Policy policy) const;

  using State = detail::PartState;

  Comm& comm_;
  Workspace work_;
  RankSets near1_, near2_, told_;
  std::vector<HalfFaceHandle> open_;  // faces behind which something may come
  std::vector<Index> zone_, rim_;     // rim: of the cells without an own vertex, all, and some that have gone
  std::vector<std::uint8_t> in_zone_, marks_;  // by slot; by vertex, all 0 between calls
  mutable Marks vertex_marks_, cell_marks_;
  std::vector<VertexHandle> dirty_, renewed_;  // of noted cells; own ones with another within_two()
  std::size_t n_changed_in_zone_ = 0;          // vertices, since zone_ was looked through
  std::uint32_t clock_at_scatter_ = 0;
};

}  // namespace hfr::mpi

#endif
