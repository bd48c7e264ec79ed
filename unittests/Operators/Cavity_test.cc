// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Cavity.hh"

#include <gtest/gtest.h>

#include <map>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/PinchedStars.hh"
#include "Operators/VertexCollapse.hh"

namespace hfr::test {
namespace {

HalfFaceHandle halfface_between(const TetMesh& mesh, CellHandle c, CellHandle d) {
  for (int k = 0; k < 4; ++k) {
    const HalfFaceHandle m = mesh.opposite_halfface(halfface_of(c, k));
    if (m.is_valid() && cell_of(m) == d) return halfface_of(c, k);
  }
  return {};
}

Cavity swap_of(const TetMesh& mesh, HalfFaceHandle h) {
  FaceSwap<VolumeLength>::Plan plan;
  plan.seed = h;
  Cavity cavity;
  FaceSwap<VolumeLength>{}.cavity(mesh, plan, cavity);
  return cavity;
}

Cavity collapse_of(const TetMesh& mesh, VertexHandle v, VertexHandle onto) {
  VertexCollapse<VolumeLength>::Plan plan;
  plan.seed = v;
  plan.apex = onto;
  Cavity cavity;
  VertexCollapse<VolumeLength>{}.cavity(mesh, plan, cavity);
  return cavity;
}

bool is_admissible(const TetMesh& mesh, const Cavity& cavity, bool check_links = true) {
  Star scratch;
  return admissible(mesh, cavity, check_links, scratch);
}

/// Two cells on triangle (0, 1, 2), and a third one that closes the ring of edge (0, 1): it has both apexes
/// 3 and 4 already. Vertex 4 has come over to the side of 3, so the pair is folded.
TetMesh folded_ring() {
  return build({{-1, 0, 0}, {1, 0, 0}, {0, 1, 0.1}, {0, 0.3, 1}, {0, -0.8, 0.1}},
               std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 3, 4}});
}

TEST(Admissible, SwapThatWouldMakeAnEdgeTwiceIsRefused) {
  TetMesh mesh = folded_ring();
  ASSERT_EQ(check(mesh), Ok);
  ASSERT_EQ(ring_size(mesh, V(3), V(4)), 1U);
  const Cavity cavity = swap_of(mesh, halfface_between(mesh, C(0), C(1)));
  EXPECT_FALSE(is_admissible(mesh, cavity));
  EXPECT_TRUE(is_admissible(mesh, cavity, false)) << "nothing but the link condition forbids it";
  replace(mesh, cavity);
  EXPECT_NE(check(mesh).rule, Ok) << "without the link condition the mesh falls apart";
}

/// Two cells on triangle (0, 1, 2) with apexes 3 and 4, and others that no face connects to them: one with
/// both apexes if `joined`, else one with each.
TetMesh pair_with_parts_at_its_apexes(bool joined) {
  std::vector<Vec3> points = {{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}, {0, 0, 0.2}, {0, 0, -0.2}};
  points.insert(points.end(), {{5, 0, 0}, {5, 1, 0}, {6, 0, 1}, {-5, 0, 0}, {-5, 1, 0}, {-6, 0, 1}});
  std::vector<Corners> cells = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  if (joined)
    cells.push_back({3, 4, 5, 6});
  else
    cells.insert(cells.end(), {{3, 5, 6, 7}, {4, 8, 9, 10}});
  return build(points, cells);
}

TEST(Admissible, EdgeThatOnlyAPartBehindItsEndsHasIsFound) {
  for (const bool joined : {true, false}) {
    const TetMesh mesh = pair_with_parts_at_its_apexes(joined);
    ASSERT_EQ(check(mesh), Rule::kNonManifoldVertex);
    const Cavity swap = swap_of(mesh, halfface_between(mesh, C(0), C(1)));
    Star scratch;
    EXPECT_EQ(admissible(mesh, swap, true, scratch), !joined) << "looked for in the whole mesh";
    const auto star_size = star_sizes(mesh);
    EXPECT_FALSE(admissible(mesh, swap, true, scratch, {star_size})) << "neither end is known in full";
    const auto pinched = pinched_vertices(mesh, star_size);
    ASSERT_EQ(std::count(pinched.begin(), pinched.end(), 1), 2);
    const PinchedStars stars(mesh, pinched, {});
    EXPECT_EQ(stars.cells(V(3)).size(), 2U);
    EXPECT_TRUE(stars.cells(V(0)).empty());
    EXPECT_EQ(admissible(mesh, swap, true, scratch, {star_size, &stars}), !joined);
  }
}

TEST(PinchedVertices, AreThoseThatAWalkMisses) {
  for (const int threads : {1, 3}) {
    const TetMesh box = jittered(5, 0.3, 3);
    EXPECT_TRUE(pinched_vertices(box, star_sizes(box), {threads, 1}).empty());
    const TetMesh mesh = pair_with_parts_at_its_apexes(true);
    const auto star_size = star_sizes(mesh);
    const auto pinched = pinched_vertices(mesh, star_size, {threads, 1});
    ASSERT_EQ(pinched.size(), mesh.n_vertices());
    Star star;
    for (std::size_t i = 0; i < pinched.size(); ++i)
      EXPECT_EQ(pinched[i] != 0, star_size[i] > 0 && is_pinched(mesh, V(i), star_size[i], star)) << i;
  }
}

TEST(Admissible, VertexOfTooManyCellsIsJudgedByTheOtherEnd) {
  // 0 and 1 have 300 cells round their edge; a pair of cells on 0 wants the edge from 0 to a far vertex.
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<Corners> cells;
  constexpr Index kCells = 300;
  for (Index i = 0; i < kCells; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCells;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % kCells});
  }
  const auto far = static_cast<Index>(points.size());
  points.push_back({1.3, 0.02, 0.3});
  cells.push_back({1, 3, 2, far});
  const TetMesh mesh = build(points, cells);
  const auto star_size = star_sizes(mesh);
  ASSERT_GT(star_size[0], static_cast<std::uint32_t>(Star::kCapacity));
  const Cavity swap = swap_of(mesh, halfface_between(mesh, C(0), C(kCells)));
  Star scratch;
  EXPECT_TRUE(admissible(mesh, swap, true, scratch, {star_size})) << "the far vertex knows all its cells";
}

TEST(Admissible, SwapOfAnInvertedPairIsBetterByItsCellsAndYetRefused) {
  // Found by search: evaluate() alone would take it.
  Engine engine(10);
  int taken = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    TetMesh mesh = folded_ring();
    for (std::size_t i = 0; i < 5; ++i) mesh.set_point(V(i), random_point(engine, -1, 1));
    const auto quality = qualities(mesh, VolumeLength{});
    const FaceSwap<VolumeLength> op{{}, quality};
    const HalfFaceHandle h = halfface_between(mesh, C(0), C(1));
    if (!op.evaluate(mesh, h)) continue;
    ++taken;
    const auto before = tets_of(mesh);
    EXPECT_FALSE(apply(op, mesh, h));
    EXPECT_EQ(tets_of(mesh), before);
  }
  EXPECT_GT(taken, 50) << "no folded pair is better swapped any more";
}

/// Vertex 0 with the link of a triangular bipyramid: equator 1, 2, 3, poles 4 and 5. One more cell (1, 2, 4,
/// 3) closes over pole 4, so that the face (1, 2, 3) exists outside of the star of 0.
TetMesh star_below_a_face() {
  const double s = std::sqrt(0.75);
  TetMesh mesh = build(
      {{0, 0, 0.2}, {1, 0, 0}, {-0.5, s, 0}, {-0.5, -s, 0}, {0, 0, 1}, {0, 0, -1}},
      std::vector<Corners>{
          {1, 2, 4, 0}, {2, 3, 4, 0}, {3, 1, 4, 0}, {2, 1, 5, 0}, {3, 2, 5, 0}, {1, 3, 5, 0}, {2, 1, 4, 3}});
  return mesh;
}

TEST(Admissible, CollapseThatWouldMakeAFaceTwiceIsRefused) {
  TetMesh mesh = star_below_a_face();
  ASSERT_EQ(check(mesh), Ok);
  const Cavity onto_equator = collapse_of(mesh, V(0), V(3));
  ASSERT_EQ(onto_equator.created.size(), 2U);
  EXPECT_FALSE(is_admissible(mesh, onto_equator));
  EXPECT_TRUE(is_admissible(mesh, onto_equator, false));
  // Onto the far pole the created cells need an edge between the poles, which is new: allowed.
  const Cavity onto_pole = collapse_of(mesh, V(0), V(5));
  EXPECT_TRUE(is_admissible(mesh, onto_pole));
  replace(mesh, onto_equator);
  EXPECT_NE(check(mesh).rule, Ok);
}

TEST(Admissible, EdgeIsFoundFromItsOtherEndWhereOneEndIsPinched) {
  // Cells 0 and 1 on triangle (0, 1, 2); round vertex 4 a chain leads to cell 4, which has the edge 3-4. At
  // vertex 3 cell 4 and cell 0 do not connect.
  const TetMesh mesh = build(
      {{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}, {0, 0, 0.2}, {0, 0, -0.2}, {1, -1, -0.5}, {0, -1.5, 0.2}},
      std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 4, 2, 5}, {2, 4, 6, 5}, {4, 6, 5, 3}});
  ASSERT_EQ(mesh.incident_cell(V(3)), C(0));
  ASSERT_EQ(ring_size(mesh, V(3), V(4)), 1U);
  ASSERT_FALSE(check(mesh)) << "vertex 3 is meant to be pinched";
  EXPECT_FALSE(is_admissible(mesh, swap_of(mesh, halfface_between(mesh, C(0), C(1)))));
}

TEST(Admissible, CavitiesDoNotCrossRegions) {
  TetMesh mesh = bipyramid(0.2);
  const Cavity cavity = swap_of(mesh, halfface_between(mesh, C(0), C(1)));
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.set_region(C(0), 1);
  EXPECT_FALSE(is_admissible(mesh, cavity));
  EXPECT_FALSE(is_admissible(mesh, cavity, false));
  mesh.set_region(C(1), 1);
  EXPECT_TRUE(is_admissible(mesh, cavity));
}

TEST(Admissible, LabelledInnerFaceStays) {
  TetMesh mesh = bipyramid(0.2);
  const Cavity cavity = swap_of(mesh, halfface_between(mesh, C(0), C(1)));
  mesh.labels().faces.set({V(0), V(1), V(3)}, 5);  // outside: no hindrance
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.labels().faces.set({V(2), V(0), V(1)}, 5);
  EXPECT_FALSE(is_admissible(mesh, cavity));
  EXPECT_FALSE(is_admissible(mesh, cavity, false));
}

TEST(Admissible, LabelledEdgeStays) {
  Engine engine(11);
  TetMesh mesh = random_spindle(5, engine);
  EdgeRemoval<VolumeLength>::Plan plan;
  plan.seed = edge_between(mesh, V(0), V(1));
  plan.ring = 5;
  plan.apex = {1, 2, 3};  // the fan of ring vertices 0 and 4
  Cavity cavity;
  EdgeRemoval<VolumeLength>{}.cavity(mesh, plan, cavity);
  ASSERT_EQ(cavity.created.size(), 6U);
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.labels().edges.set({V(2), V(3)}, 1);  // of the ring: kept
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.labels().edges.set({V(1), V(0)}, 1);
  EXPECT_FALSE(is_admissible(mesh, cavity));
}

TEST(Admissible, LabelledVertexIsNotRemoved) {
  TetMesh mesh = octahedron();
  const Cavity cavity = collapse_of(mesh, V(0), V(1));
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  mesh.labels().vertices[1] = 3;  // only a neighbour
  EXPECT_TRUE(is_admissible(mesh, cavity));
  mesh.labels().vertices[0] = 3;
  EXPECT_FALSE(is_admissible(mesh, cavity));
}

TEST(Admissible, MovesAreAlwaysAdmissible) {
  TetMesh mesh = octahedron();
  mesh.labels().vertices.assign(mesh.n_vertices(), 1);
  Cavity cavity;
  cavity.moved = V(0);
  EXPECT_TRUE(is_admissible(mesh, cavity));
}

using Key = std::vector<VertexHandle>;

/// Edges and faces of some cells, each as sorted vertices.
template <class Tets>
std::set<Key> simplices_of(const Tets& tets) {
  std::set<Key> all;
  for (Tet t : tets) {
    std::sort(t.begin(), t.end());
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) all.insert({t[i], t[j]});
      Key face(t.begin(), t.end());
      face.erase(face.begin() + static_cast<std::ptrdiff_t>(i));
      all.insert(face);
    }
  }
  return all;
}

/// What the cavity makes that its removed cells do not have.
std::set<Key> new_simplices(const TetMesh& mesh, const Cavity& cavity) {
  std::vector<Tet> gone;
  for (CellHandle c : cavity.removed) gone.push_back(mesh.cell(c).v);
  std::set<Key> made = simplices_of(cavity.created);
  for (const Key& old : simplices_of(gone)) made.erase(old);
  return made;
}

/// 0: nothing comes twice; 2 or 3: an edge, or only a face, exists in a cell that stays.
std::size_t made_twice(const TetMesh& mesh, const Cavity& cavity, const std::set<Key>& made) {
  std::size_t found = 0;
  for (const Key& key : made) {
    for (CellHandle c : mesh.cells()) {
      const bool is_removed =
          std::find(cavity.removed.begin(), cavity.removed.end(), c) != cavity.removed.end();
      if (is_removed ||
          !std::all_of(key.begin(), key.end(), [&](VertexHandle v) { return mesh.cell(c).has(v); }))
        continue;
      if (found == 0 || key.size() < found) found = key.size();
    }
  }
  return found;
}

/// A box in which every third face that can be swapped has been, however bad the cells: the regular rings of
/// four and six are gone.
TetMesh shuffled_box(std::uint64_t seed) {
  TetMesh mesh = jittered(3, 0.3, seed);
  Engine engine(seed);
  for (HalfFaceHandle h : all_faces(mesh)) {
    if (engine() % 3 != 0 || mesh.is_deleted(cell_of(h)) || mesh.is_boundary(h)) continue;
    const Cavity cavity = swap_of(mesh, h);
    if (made_twice(mesh, cavity, new_simplices(mesh, cavity)) == 0) replace(mesh, cavity);
  }
  EXPECT_EQ(check(mesh), Ok);
  return mesh;
}

TEST(AdmissibleProperty, LinkConditionAgreesWithBruteForceInShuffledMeshes) {
  std::map<std::size_t, int> outcomes;
  const auto compare = [&](const TetMesh& mesh, const Cavity& cavity) {
    const std::set<Key> made = new_simplices(mesh, cavity);
    const std::size_t twice = made_twice(mesh, cavity, made);
    ASSERT_EQ(is_admissible(mesh, cavity), twice == 0);
    ++outcomes[twice];
    std::set<Key> listed;
    for (const Simplex& simplex : created_simplices(mesh, cavity)) {
      Key key;
      for (VertexHandle v : simplex)
        if (v.is_valid()) key.push_back(v);
      EXPECT_TRUE(made.contains(key));
      listed.insert(key);
    }
    for (const Key& key : made)
      EXPECT_TRUE(key.size() == 3 || listed.contains(key)) << "an edge is not listed";
  };
  for (std::uint64_t s = 1; s <= 4; ++s) {
    const TetMesh mesh = shuffled_box(s);
    for (HalfFaceHandle h : all_faces(mesh))
      if (!mesh.is_boundary(h)) compare(mesh, swap_of(mesh, h));
    const auto frozen = frozen_vertices(mesh);
    for (VertexHandle v : mesh.vertices()) {
      if (frozen[v.idx()]) continue;
      for (VertexHandle w : mesh.vertex_vertices(v)) compare(mesh, collapse_of(mesh, v, w));
    }
  }
  EXPECT_GT(outcomes[0], 300);
  EXPECT_GT(outcomes[2], 200);
}

TEST(AdmissibleProperty, KnownConstraintsChangeNoAnswer) {
  int refused = 0, allowed = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh mesh = shuffled_box(s);
    Engine engine(s);
    for (HalfFaceHandle h : all_faces(mesh)) {
      const auto face = mesh.halfface_vertices(h);
      if (s <= 2 && mesh.is_boundary(h)) mesh.labels().faces.set(face, 1 + static_cast<int>(engine() % 3));
      if (s == 3 && engine() % 6 == 0) mesh.labels().faces.set(face, 4);
      if (s == 4 && engine() % 6 == 0) mesh.labels().edges.set({face[0], face[1]}, 5);
      if (s == 5 && engine() % 6 == 0) mesh.set_fixed(mesh.face_handle(h));
      if (s == 6 && engine() % 50 == 0) mesh.set_fixed(face[0]);
    }
    const auto constrained = constrained_vertices(mesh);
    const auto frozen = frozen_vertices(mesh);
    const auto star_size = star_sizes(mesh);
    const auto compare = [&](const Cavity& cavity) {
      Star scratch;
      const bool expected = admissible(mesh, cavity, false, scratch, {star_size});
      EXPECT_EQ(admissible(mesh, cavity, false, scratch, {star_size, nullptr, constrained}), expected);
      expected ? ++allowed : ++refused;
    };
    for (HalfFaceHandle h : all_faces(mesh))
      if (!mesh.is_boundary(h)) compare(swap_of(mesh, h));
    for (VertexHandle v : mesh.vertices()) {
      if (frozen[v.idx()]) continue;
      for (VertexHandle w : mesh.vertex_vertices(v)) compare(collapse_of(mesh, v, w));
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(allowed, 500);
}

}  // namespace
}  // namespace hfr::test
