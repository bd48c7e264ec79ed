// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RANKS_HH
#define HFR_REMESH_RANKS_HH

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Operators/Metrics.hh"
#include "Parallel/Parallel.hh"
#include "Quality/Metric.hh"
#include "Remesh/Options.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

enum class PassKind : std::uint8_t;
class MeshInParts;
class SurfaceMesh;

/// What passes on ranks measure cells by: kMinSine, kMinDihedral, kVolumeLength, or Untangling, whose
/// volume-length is of positive cells and which says how the others are measured.
struct RankMetric {
  Metric metric;
  bool untangles = false;   ///< with kVolumeLength
  Untangling untangling{};  ///< where it does

  RankMetric(Metric of = Metric::kMinSine) : metric(of) {}
  explicit RankMetric(const Untangling& of)
      : metric(Metric::kVolumeLength), untangles(true), untangling(of) {}
};
inline RankMetric rank_metric(const Untangling& metric) { return RankMetric(metric); }
inline RankMetric rank_metric(VolumeLength) { return Metric::kVolumeLength; }
inline RankMetric rank_metric(MinSine2) { return Metric::kMinSine; }
inline RankMetric rank_metric(MinDihedral) { return Metric::kMinDihedral; }

/// Passes over the surface; see SurfacePasses.
enum class SurfacePass : std::uint8_t {
  kSwap,
  kInterfaceSwap,  ///< over what kSwap has looked at
  kCollapse,
  kMove,
  kSplit,
  kOffset,  ///< over all vertices
};

/// Other processes that can do some of the passes of a run, with the same bits: what Distributed/ has for
/// whoever runs stages. While they have the mesh, that of the run is an older one.
class Ranks {
 public:
  /// One round, or one smoothing pass, over the cells below `below` of which a vertex has changed after the
  /// clock stood at `since`.
  struct Look {
    PassKind kind{};
    RankMetric metric;
    double below = 0;
    std::uint32_t since = 0;
    std::uint64_t seed = 1;
    std::uint64_t may_lose = 0, may_gain = 0;
    int threads = 1;
    /// Where more cells are listed over all, the first edge of each does that leaves it at `below`; see
    /// PassEffort::first_edge_does.
    std::uint64_t first_edge_beyond = std::numeric_limits<std::uint64_t>::max();
    /// Of a mixed pass: the kinds that compete.
    Ops ops = Ops::kNone;
    /// See RoundOptions::check_links.
    bool check_links = false;
    /// See Focus::is_marked.
    bool is_marked = false;
  };
  /// One round of insertion over such cells and those that wait from the round before.
  struct Dig {
    Look look;
    double gain = 1;  ///< VertexInsertion::gain
    /// Whether its poor_below is not look.below; see Run::may_add_poor_cells.
    bool may_add_poor_cells = false;
    /// With more cells than `many`, these hold in place of VertexInsertion's own.
    std::uint64_t many = 0, sites_of_many = 0;
    double promise_of_many = 0;
    bool leaves_early = false;  ///< VertexInsertion::leaves_early
  };
  /// One round of cluster search over such cells.
  struct Search {
    Look look;
    double gain = 1;  ///< this and the others: of ClusterSearch
    std::uint64_t max_points = 0, max_nodes = 0;
  };
  /// One pass over the surface of the run; of the look its kind, how many cells may go, whether links are
  /// checked and whether cells are marked have no meaning.
  struct SurfaceLook {
    SurfacePass pass{};
    Look look;
    /// Of moves: SurfaceSearch::gain where more vertices are looked at than `many`, or than one in
    /// `many_share` of the mesh.
    double gain_of_many = 1;
    std::uint64_t many = 0, many_share = 1;
    double worst = 0;  ///< SurfaceOffset::worst
  };
  struct Tally {
    std::size_t n_invalid = 0, n_below = 0;
    double worst = 0;
  };

  virtual ~Ranks() = default;
  /// Whether the mesh is theirs from the beginning of the run to its end, and that of the run the part of one
  /// of them: then each of them runs the same stages at the same time, which have only passes that they can
  /// do.
  virtual bool keep_mesh() const { return false; }
  /// Where they keep it.
  virtual MeshInParts* parts() { return nullptr; }
  /// Whether they can do passes of this kind in this metric, over a mesh like this one.
  virtual bool can_do(PassKind kind, const RankMetric& metric) const = 0;
  virtual bool can_take(const TetMesh& mesh, const Workspace& work) const = 0;
  /// From how many cells in focus on it is worth their while, with so many cells in all.
  virtual std::size_t least_cells(std::size_t n_cells) const = 0;
  virtual void take(const TetMesh& mesh, const Workspace& work) = 0;
  /// counts.rounds is 0 where there is nothing to look at.
  virtual RoundCounts pass(const Look& look) = 0;
  /// Where keep_mesh(). `waiting`: numbers of cells that are near chosen ones, for the round after; the same
  /// on all ranks. counts.rounds is 0 where there is nothing to look at.
  virtual RoundCounts dig(const Dig&, std::vector<std::uint64_t>& waiting) {
    waiting.clear();
    return {};
  }
  /// The same for cluster search.
  virtual RoundCounts search(const Search&) { return {}; }
  /// Where keep_mesh(), and the run has a surface. Nothing where no cell is looked at.
  virtual std::optional<RoundCounts> surface_pass(SurfaceMesh&, const SurfaceLook&) { return std::nullopt; }
  /// Whether a surface that has changed lies on or goes through itself at a vertex that has since the clock
  /// stood there; where all cells are positive, also whether these lie over one another there.
  virtual bool is_folded_since(std::uint32_t, bool) { return false; }
  /// Whether the cells round some vertex cover a direction twice; see Coverage.hh.
  virtual bool covers_twice() { return false; }
  /// Of all cells.
  virtual Tally tally(double below) = 0;
  virtual std::size_t n_cells() const = 0;
  /// What they have made of it, the workspace included.
  virtual void bring_back(TetMesh& mesh, Workspace& work) = 0;
};

}  // namespace hfr

#endif
