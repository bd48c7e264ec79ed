// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_FUZZ_WALK_HH
#define HFR_UNITTESTS_FUZZ_WALK_HH

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "Fuzz/Random.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::fuzz {

/// What a walk does to a mesh.
enum class Operation : std::uint8_t {
  kAddVertex,
  kAddCell,
  kDeleteCell,
  kDeleteVertex,
  kSplitEdge,
  kSplitFace,
  kSplitCell,
  kCollapseEdge,
  kFaceSwap,
  kEdgeRemoval,
  kMultiFaceRemoval,
  kVertexCollapse,
  kSwapVertices,
  kSwapCells,
  kMoveVertex,
  kCollectGarbage,
  kReorder,
  kLabels,
  kProperties,
  kRestore,
  kCount
};
inline constexpr std::size_t kOperations = static_cast<std::size_t>(Operation::kCount);
std::string_view operation_name(Operation operation);

/// How often each operation changed a mesh, and how often it was refused, as it may be.
struct WalkCounts {
  std::array<std::uint64_t, kOperations> done{}, refused{};
  std::uint64_t compared = 0;  ///< meshes that were compared with all of their neighbourhoods found anew
};

/// Operations at random on one mesh, with what they have to keep: after each one the rules of check(), what
/// the walk itself knows of every vertex and cell, and volumes where the operation keeps them; now and then
/// numbers of edges and faces, labels and locks against cells compared with each other.
class Walk {
 public:
  /// The complex of that number, made smaller where it has more than some hundred cells.
  explicit Walk(std::uint64_t number);
  /// False: build() has refused the complex.
  bool has_mesh() const { return mesh_.n_cells() > 0; }
  /// One operation. Returns what is wrong afterwards, empty where nothing is.
  std::string step(WalkCounts& counts);
  /// Compares with neighbourhoods found from the cells alone. Returns what differs.
  std::string compare() const;

 private:
  struct Known {
    Vec3 point;
    bool fixed = false;
    int label = 0;
  };

  bool apply(Operation operation);
  bool add_cell();
  bool collapse();
  bool swap_or_remove(Operation operation);
  bool change_labels();
  bool change_properties();
  bool renumber(Operation operation);
  void learn(VertexHandle v);
  void forget_deleted();
  bool touches_pinched(CellHandle c, const std::vector<std::uint8_t>& pinched) const;
  std::string wrong_data() const;
  std::string wrong_volume(long double before) const;
  long double volume() const;
  VertexHandle a_vertex();
  CellHandle a_cell();

  TetMesh mesh_;
  Random random_;
  std::map<int, Known> known_;  ///< by the vertex property "id"
  int next_id_ = 0;
  bool keeps_volume_ = false;  ///< said by the last operation
  std::string complaint_;      ///< of the operation itself
};

}  // namespace hfr::fuzz

#endif
