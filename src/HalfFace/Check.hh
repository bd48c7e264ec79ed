// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_CHECK_HH
#define HFR_HALFFACE_CHECK_HH

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr {

/// The rules of a mesh in the order in which they are tested: a rule relies on those before it. Up to
/// kDuplicateEdge they are the kernel's own; a mesh that breaks the manifold rules can still be walked and
/// written, but operators leave the places alone.
enum class Rule {
  kNone,            ///< no rule is broken
  kIndexRange,      ///< vertices and mates of cells exist and are not deleted; arrays have their lengths
  kRepeatedVertex,  ///< a cell has four different vertices
  kFreeList,        ///< the free list holds each deleted cell once and nothing else
  kMateSymmetry,    ///< the mate of a half-face's mate is the half-face, and is of another cell
  kSharedVertices,  ///< mates have the same three vertices
  kOrientation,     ///< mates see them in opposite order
  kIncidentCell,   ///< the incident cell of a vertex is a cell of it; a vertex without an incident cell is in
                   ///< no cell
  kDuplicateFace,  ///< two half-faces of the same three vertices are mates
  kDuplicateEdge,  ///< where two vertices have a closed ring of cells, it is their only one
  kNonManifoldEdge,    ///< two vertices have one fan of cells
  kNonManifoldVertex,  ///< the cells of a vertex connect through faces
  kLabel               ///< labelled faces and edges are faces and edges of cells
};

/// "kOrientation" and so on.
std::string_view rule_name(Rule rule);

/// What a check found; the handles are those of the first offence, the smallest that there is.
struct CheckResult {
  Rule rule = Rule::kNone;
  std::vector<VertexHandle> vertices;
  std::vector<CellHandle> cells;
  std::vector<HalfFaceHandle> halffaces;
  std::string message;  ///< one line; empty when no rule is broken

  explicit operator bool() const { return rule == Rule::kNone; }
  friend bool operator==(const CheckResult& result, Rule wanted) { return result.rule == wanted; }
};
std::ostream& operator<<(std::ostream& out, const CheckResult& result);

/// So that a test may say EXPECT_EQ(check(mesh), Ok).
inline constexpr Rule Ok = Rule::kNone;

struct CheckOptions {
  Rule last = Rule::kLabel;  ///< rules after this one are not tested
  par::Policy policy = {};
};

/// Names the first broken rule. Linear in the mesh up to the sorting of a vertex's faces and edges; allocates
/// about 100 bytes a cell.
CheckResult check(const TetMesh& mesh, CheckOptions options = {});

/// Vertices that are not deleted and in no cell: no rule forbids them.
std::vector<VertexHandle> unused_vertices(const TetMesh& mesh);

/// Looks for what operators have broken since `mesh` was `before`, only where cells are others than they
/// were: a pass over the cells, and about half a microsecond for each vertex of a changed cell. Tests the
/// rules up to kNonManifoldVertex. Of edges that exist twice and of edges and vertices that are not manifold
/// only those count that were less so before; faces with three cells always count. Handles must not have been
/// renumbered in between. Vertices may have been moved, which no rule asks about.
CheckResult check_changes(const TetMesh& mesh, const TetMesh& before, par::Policy policy = {});

}  // namespace hfr

#endif
