// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PASS_RUNNER_HH
#define HFR_REMESH_PASS_RUNNER_HH

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "Operators/Metrics.hh"
#include "Remesh/DevicePasses.hh"
#include "Remesh/PassState.hh"
#include "Remesh/RankPasses.hh"
#include "Remesh/SurfacePasses.hh"

namespace hfr {

/// The passes of a stage in one metric: an operator over the cells in focus once, in rounds until these bring
/// little. The mesh may be on a device between passes; to_host(), at the end of a stage at the latest, brings
/// it back. Instantiated in PassRunner.cc for the metrics that stages use.
template <class Metric>
class PassRunner : public PassState {
 public:
  /// Sets the decision values of all cells. `selection`: whether kinds compete in the passes of iterate();
  /// as the strategy says unless given.
  PassRunner(const Run& run, Metric metric, std::string stage, std::optional<Selection> selection = {});

  void look_again();

  /// One iteration of the operators that the strategy allows, in the paper's order: edge, face, node,
  /// surface, smooth. Returns the number of committed changes.
  std::size_t iterate(const Turn& turn);
  /// One kind of pass; 0 where the strategy does not allow its operator.
  std::size_t pass(PassKind kind, const Turn& turn);
  /// PassKind::kInsert, each vertex of which has to raise the worst decision value of its cavity by the
  /// factor `gain`; in other passes that is PassEffort::least_gain.
  std::size_t insert(const Turn& turn, double gain);
  /// The star form of the paper over all cells that are pending: PassKind::kEdge, kFace or kNode. For
  /// VolumeLength only.
  std::size_t star_pass(PassKind kind, int iteration);
  /// Moves the surface as a whole until the volume is what it was, where no cell suffers.
  void restore_volume(const VolumeEffort& effort) { surface_.restore_volume(effort); }

 private:
  /// A row of the table in PassRunner.cc.
  struct Row {
    const char* name;          // in reports; variants of an operator have one
    Ops ops;                   // any of which allows it
    std::uint8_t pending_bit;  // of Workspace::pending; 0: always has a focus
    std::size_t (PassRunner::*run)(const Turn&);
  };
  static const Row& row(PassKind kind);

  std::size_t edge_pass(const Turn& turn);
  std::size_t face_pass(const Turn& turn);
  std::size_t node_pass(const Turn& turn);
  std::size_t insert_pass(const Turn& turn);
  std::size_t smooth_pass(const Turn& turn);
  /// Face swap and its extension to several faces; more than face_pass finds, at three times its cost.
  std::size_t multi_face_pass(const Turn& turn);
  /// Edge removal, face swap and vertex collapse in one selection: a cluster goes to the kind that gains
  /// most.
  std::size_t mixed_pass(const Turn& turn);
  /// All ways to connect the points round a poor cell: milliseconds a cell.
  std::size_t cluster_pass(const Turn& turn);
  /// Cells in a row round an edge that stays, such as one of the surface, into one there.
  std::size_t fan_pass(const Turn& turn);

  /// A round of Op over the cells of a list: `run_round(round, list)`.
  template <class Op, class RunRound>
  RoundCounts round(const RunRound& run_round, const Worklist& list);
  /// Rounds of one operator until they bring little, then a line in the report.
  template <class Op, class RunRound>
  std::size_t rounds(PassKind kind, const Turn& turn, const RunRound& run_round);

  static Run with_qualities(const Run& run, const Metric& metric);
  bool is_mixed() const;
  /// Whether the smallest dihedral of the mesh may come to be below that of the run's input: operators raise
  /// the worst cell of a cluster in the metric, and only in this.
  bool may_lower_angles() const;
  /// Vertices of the listed cells that an operator may take out.
  std::vector<VertexHandle> removable(const Worklist& list) const;
  /// Of the listed cells and those that wait, the worst first, those that share no vertex with one before;
  /// the others wait for the next round. Neighbours would dig the same cavity, and most of them lose.
  std::vector<CellHandle> worst_apart(const Worklist& list, const Focus& focus);
  const PassEffort& effort() const { return run().strategy.pass; }

  Metric metric_;
  Selection selection_;
  std::vector<Index> waiting_;        // for their turn in insert_pass(), the worst first
  std::vector<std::uint32_t> taken_;  // by vertex: the last choice of worst_apart() that took it
  std::uint32_t choice_ = 0;
  double insert_gain_ = 0;  // of the last insert_pass()
  SurfacePasses<Metric> surface_;
  std::optional<DevicePasses> device_;  // in volume-length
  std::optional<RankPasses> ranks_;     // in the polish
};

}  // namespace hfr

#endif
