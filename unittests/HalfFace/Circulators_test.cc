// SPDX-License-Identifier: BSD-3-Clause
// Every neighbourhood query against the oracle, on every mesh of the suite.
#include "HalfFace/Circulators.hh"

#include <gtest/gtest.h>
#include "HalfFace/EdgeList.hh"

#include <ranges>

#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

using test::NamedMesh;
using test::Oracle;
using test::Set;
using test::vector_of;

template <class Range>
concept View =
    std::ranges::forward_range<Range> && std::ranges::view<Range> && std::ranges::common_range<Range>;
static_assert(View<AllRange<VertexHandle>> && View<AllRange<EdgeHandle>> && View<BoundaryRange<FaceHandle>>);
static_assert(View<StarRange<policy::StarCells>> && View<StarRange<policy::StarHalfEdges<true>>>);
static_assert(View<StarRange<policy::StarEdges>> && View<StarRange<policy::StarFaces>> &&
              View<VertexVertices>);
static_assert(View<RingRange<policy::RingCells>> && View<RingRange<policy::RingFaces>>);
static_assert(View<RingRange<policy::RingHalfFaces>> && View<RingRange<policy::RingBothHalfFaces>>);
static_assert(std::ranges::forward_range<FixedList<CellHandle, 4>>);

// Iterators point into the range object: a temporary one gives none. Those over the whole mesh stand alone.
template <class Range>
concept BeginsAsTemporary = requires(Range&& range) {
  std::forward<Range>(range).begin();
  *std::forward<Range>(range).begin();
};
template <class Range>
concept DanglesNever = BeginsAsTemporary<Range> && std::ranges::borrowed_range<Range>;
template <class Range>
concept RefusesTemporaries =
    !BeginsAsTemporary<Range> && BeginsAsTemporary<Range&> && !std::ranges::borrowed_range<Range>;
static_assert(RefusesTemporaries<StarRange<policy::StarCells>> && RefusesTemporaries<VertexVertices>);
static_assert(RefusesTemporaries<RingRange<policy::RingCells>>);
static_assert(RefusesTemporaries<FixedList<CellHandle, 4>>);
static_assert(DanglesNever<AllRange<CellHandle>> && DanglesNever<BoundaryRange<EdgeHandle>>);

template <class Range>
auto unique_set(Range&& range) {
  bool repeated = false;
  auto items = test::set_of(range, repeated);
  EXPECT_FALSE(repeated);
  return items;
}

template <std::same_as<VertexHandle>... V>
std::array<VertexHandle, sizeof...(V)> sorted(V... vertices) {
  return AnyOrder::key(std::array{vertices...});
}
template <std::size_t N>
std::array<VertexHandle, N> sorted(const std::array<VertexHandle, N>& vertices) {
  return AnyOrder::key(vertices);
}

class Circulators : public testing::TestWithParam<NamedMesh> {
 protected:
  const TetMesh& mesh() const { return GetParam().mesh; }
  const Oracle oracle{GetParam().mesh};

  /// Cells of v that connect to its incident cell.
  Set<CellHandle> star(VertexHandle v) const {
    const Set<CellHandle> all = oracle.cells_of(v);
    return all.empty() ? all : oracle.component<1>(all, mesh().incident_cell(v), {v});
  }
};
INSTANTIATE_TEST_SUITE_P(Suite, Circulators, testing::ValuesIn(test::suite()),
                         [](const auto& which) { return which.param.name; });

TEST_P(Circulators, GlobalRangesHaveEachThingOnce) {
  EXPECT_EQ(unique_set(mesh().vertices()).size(), mesh().n_vertices());
  EXPECT_EQ(unique_set(mesh().cells()).size(), mesh().n_cells());
  EXPECT_EQ(unique_set(mesh().halffaces()).size(), 4 * mesh().n_cells());
  Set<std::array<VertexHandle, 3>> faces;
  for (FaceHandle f : mesh().faces()) EXPECT_TRUE(faces.insert(sorted(mesh().face_vertices(f))).second);
  EXPECT_EQ(faces.size(), oracle.faces().size());
  EXPECT_EQ(mesh().n_faces(), oracle.faces().size());
  std::size_t n_rings = 0;
  std::map<std::array<VertexHandle, 2>, std::size_t> found;
  for (EdgeHandle e : mesh().edges()) ++found[sorted(mesh().edge_vertices(e))];
  for (const auto& [edge, cells] : oracle.edges()) {
    const std::size_t n = oracle.rings(edge).size();
    EXPECT_EQ(found[edge], n);
    n_rings += n;
  }
  EXPECT_EQ(mesh().n_edges(), n_rings);
  EXPECT_EQ(mesh().halfedges().count(), 2 * n_rings);
  EXPECT_EQ(mesh().n_halfedges(), 2 * n_rings);
}

TEST_P(Circulators, EdgeHandleIsTheSmallestCellOfItsRing) {
  for (CellHandle c : mesh().cells()) {
    const auto edges = mesh().cell_edges(c);
    for (int k = 0; k < 6; ++k) {
      const EdgeHandle e = edges[static_cast<std::size_t>(k)];
      const auto& corners = kEdgeCorners[static_cast<std::size_t>(k)];
      const auto ends = sorted(mesh().cell(c).v[corners[0]], mesh().cell(c).v[corners[1]]);
      EXPECT_EQ(sorted(mesh().edge_vertices(e)), ends);
      EXPECT_EQ(CellHandle(e.idx() / 6), *oracle.component(oracle.edges().at(ends), c, ends).begin());
      EXPECT_TRUE(mesh().exists(e));
      EXPECT_EQ(mesh().exists(EdgeHandle(6 * c.idx() + static_cast<Index>(k))), CellHandle(e.idx() / 6) == c);
    }
  }
}

TEST_P(Circulators, RoundAVertex) {
  for (VertexHandle v : mesh().vertices()) {
    const Set<CellHandle> cells = star(v);
    EXPECT_EQ(unique_set(mesh().vertex_cells(v)), cells);
    Set<VertexHandle> neighbours;
    Set<HalfFaceHandle> halffaces;
    Set<FaceHandle> faces;
    Set<EdgeHandle> edges;
    bool boundary = false;
    for (CellHandle c : cells) {
      for (VertexHandle w : mesh().cell(c).v)
        if (w != v) neighbours.insert(w);
      for (HalfFaceHandle h : mesh().cell_halffaces(c)) {
        if (mesh().halfface_opposite_vertex(h) == v) continue;
        halffaces.insert(h);
        faces.insert(mesh().face_handle(h));
        boundary = boundary || oracle.is_boundary_face(mesh().halfface_vertices(h));
      }
      for (EdgeHandle e : mesh().cell_edges(c))
        if (mesh().edge_vertices(e)[0] == v || mesh().edge_vertices(e)[1] == v) edges.insert(e);
    }
    EXPECT_EQ(unique_set(mesh().vertex_vertices(v)), neighbours);
    EXPECT_EQ(unique_set(mesh().vertex_halffaces(v)), halffaces);
    EXPECT_EQ(unique_set(mesh().vertex_faces(v)), faces);
    EXPECT_EQ(unique_set(mesh().vertex_edges(v)), edges);
    EXPECT_EQ(mesh().valence(v), neighbours.size());
    EXPECT_EQ(mesh().is_boundary(v), boundary);
    const auto out = unique_set(mesh().outgoing_halfedges(v));
    const auto in = unique_set(mesh().incoming_halfedges(v));
    EXPECT_EQ(out.size(), edges.size());
    EXPECT_EQ(in.size(), edges.size());
    for (HalfEdgeHandle e : out) {
      EXPECT_EQ(mesh().from_vertex(e), v);
      EXPECT_TRUE(edges.contains(mesh().edge_handle(e)));
      EXPECT_TRUE(in.contains(mesh().opposite_halfedge(e)));
    }
  }
}

TEST_P(Circulators, RoundAnEdgeInRingOrder) {
  for (HalfEdgeHandle e : mesh().halfedges()) {
    const auto [a, b] = mesh().halfedge_vertices(e);
    const auto ends = sorted(a, b);
    const CellHandle seed(e.idx() / 12);
    const Set<CellHandle> ring = oracle.component(oracle.edges().at(ends), seed, ends);
    const auto cells = vector_of(mesh().halfedge_cells(e));
    EXPECT_EQ(unique_set(cells), ring);
    std::size_t n_boundary = 0;
    const auto halffaces = vector_of(mesh().halfedge_halffaces(e));
    ASSERT_EQ(halffaces.size(), cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      // The half-face that has a→b comes before the cell, counter-clockwise; the one that has b→a after it.
      EXPECT_EQ(mesh().incident_cell(halffaces[i]), cells[i]);
      const auto v = mesh().halfface_vertices(halffaces[i]);
      bool directed = false;
      for (std::size_t r = 0; r < 3; ++r) directed = directed || (v[r] == a && v[(r + 1) % 3] == b);
      EXPECT_TRUE(directed);
      const HalfFaceHandle behind = mesh().adjacent_halfface_in_cell(halffaces[i], e);
      const HalfFaceHandle across = mesh().opposite_halfface(behind);
      n_boundary += across.is_valid() ? 0 : 1;
      n_boundary += mesh().is_boundary(halffaces[i]) ? 1 : 0;
      if (across.is_valid()) {
        EXPECT_EQ(across, halffaces[(i + 1) % cells.size()]);
      } else {
        EXPECT_EQ(i + 1, cells.size()) << "a fan must start at the boundary";
      }
    }
    EXPECT_EQ(n_boundary, mesh().is_boundary(e) ? 2U : 0U);
    EXPECT_EQ(mesh().halfedge_cells(e).is_closed(), n_boundary == 0);
    if (!mesh().is_boundary(e)) {
      EXPECT_EQ(cells.front(), *ring.begin());
    }

    const auto faces = vector_of(mesh().halfedge_faces(e));
    EXPECT_EQ(unique_set(faces).size(), cells.size() + n_boundary / 2);
    for (FaceHandle f : faces) EXPECT_TRUE(mesh().is_incident(f, mesh().edge_handle(e)));
    if (n_boundary > 0) {
      EXPECT_TRUE(mesh().is_boundary(faces.front()));
      EXPECT_TRUE(mesh().is_boundary(faces.back()));
    }
  }
}

TEST_P(Circulators, EdgeQueriesAgreeWithThoseOfItsHalfEdge) {
  for (EdgeHandle e : mesh().edges()) {
    const HalfEdgeHandle he = mesh().halfedge_handle(e, 0);
    EXPECT_EQ(mesh().edge_handle(he), e);
    EXPECT_EQ(mesh().edge_handle(mesh().halfedge_handle(e, 1)), e);
    EXPECT_EQ(mesh().opposite_halfedge(he), mesh().halfedge_handle(e, 1));
    EXPECT_EQ(mesh().edge_vertices(e), mesh().halfedge_vertices(he));
    EXPECT_EQ(vector_of(mesh().edge_cells(e)), vector_of(mesh().halfedge_cells(he)));
    EXPECT_EQ(vector_of(mesh().edge_faces(e)), vector_of(mesh().halfedge_faces(he)));
    EXPECT_EQ(mesh().valence(e), mesh().edge_faces(e).count());
    Set<HalfFaceHandle> both = unique_set(mesh().halfedge_halffaces(he));
    both.merge(unique_set(mesh().halfedge_halffaces(mesh().opposite_halfedge(he))));
    EXPECT_EQ(unique_set(mesh().edge_halffaces(e)), both);
    EXPECT_EQ(both.size(), 2 * mesh().edge_cells(e).count());
    EXPECT_EQ(mesh().is_boundary(e), mesh().is_boundary(he));
  }
}

TEST_P(Circulators, FacesAndTheirSides) {
  for (HalfFaceHandle h : mesh().halffaces()) {
    const CellHandle c = mesh().incident_cell(h);
    const auto v = mesh().halfface_vertices(h);
    const auto& cells = oracle.faces().at(sorted(v));
    EXPECT_TRUE(cells.contains(c));
    const FaceHandle f = mesh().face_handle(h);
    EXPECT_TRUE(mesh().exists(f));
    EXPECT_EQ(unique_set(mesh().face_cells(f)), cells);
    EXPECT_EQ(mesh().is_boundary(h), cells.size() == 1);
    EXPECT_EQ(mesh().is_boundary(f), cells.size() == 1);
    EXPECT_TRUE(mesh().halfface_handle(f, 0) == h || mesh().halfface_handle(f, 1) == h);
    EXPECT_EQ(mesh().face_halffaces(f).size(), cells.size());
    EXPECT_EQ(sorted(mesh().face_vertices(f)), sorted(v));
    const auto edges = mesh().halfface_halfedges(h);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(mesh().halfedge_vertices(edges[i]), (std::array{v[i], v[(i + 1) % 3]}));
      EXPECT_EQ(mesh().next_halfedge_in_halfface(edges[i], h), edges[(i + 1) % 3]);
      EXPECT_EQ(mesh().prev_halfedge_in_halfface(edges[i], h), edges[(i + 2) % 3]);
      EXPECT_EQ(mesh().halfface_edges(h)[i], mesh().edge_handle(edges[i]));
      const HalfFaceHandle other = mesh().adjacent_halfface_in_cell(h, mesh().edge_handle(edges[i]));
      EXPECT_EQ(mesh().incident_cell(other), c);
      EXPECT_NE(other, h);
      EXPECT_TRUE(mesh().is_incident(mesh().face_handle(other), mesh().edge_handle(edges[i])));
      EXPECT_FALSE(mesh().next_halfedge_in_halfface(mesh().opposite_halfedge(edges[i]), h).is_valid());
    }
    EXPECT_EQ(mesh().vertex_opposite_halfface(c, mesh().halfface_opposite_vertex(h)), h);
    EXPECT_EQ(mesh().face_edges(f).size() + mesh().face_halfedges(f).size(), 6U);
  }
}

TEST_P(Circulators, CellsAndWhatTheyConsistOf) {
  for (CellHandle c : mesh().cells()) {
    Set<CellHandle> neighbours;
    for (HalfFaceHandle h : mesh().cell_halffaces(c))
      for (CellHandle d : oracle.faces().at(sorted(mesh().halfface_vertices(h))))
        if (d != c) neighbours.insert(d);
    EXPECT_EQ(unique_set(mesh().cell_cells(c)), neighbours);
    EXPECT_EQ(mesh().is_boundary(c), neighbours.size() < 4);
    EXPECT_EQ(unique_set(mesh().cell_faces(c)).size(), 4U);
    EXPECT_EQ(unique_set(mesh().cell_edges(c)).size(), 6U);
    EXPECT_EQ(unique_set(mesh().cell_halfedges(c)).size(), 12U);
    EXPECT_EQ(mesh().cell_vertices(c), oracle.cells().at(c));
    const auto six_volume = [&](const std::array<VertexHandle, 4>& v) {
      const Vec3 o = mesh().point(v[0]);
      return dot(mesh().point(v[1]) - o, cross(mesh().point(v[2]) - o, mesh().point(v[3]) - o));
    };
    for (std::size_t k = 0; k < 4; ++k) {
      const auto order = mesh().cell_vertices(c, mesh().cell(c).v[k]);
      EXPECT_EQ(order[0], mesh().cell(c).v[k]);
      EXPECT_GT(six_volume(order), 0);
      EXPECT_GT(six_volume(mesh().cell_vertices(halfface_of(c, static_cast<int>(k)))), 0);
    }
  }
}

TEST_P(Circulators, BoundaryRanges) {
  const auto agree = [&](auto&& all, auto&& boundary) {
    auto wanted = vector_of(all);
    std::erase_if(wanted, [&](auto h) { return !mesh().is_boundary(h); });
    EXPECT_EQ(vector_of(boundary), wanted);
  };
  agree(mesh().vertices(), mesh().boundary_vertices());
  agree(mesh().edges(), mesh().boundary_edges());
  agree(mesh().halfedges(), mesh().boundary_halfedges());
  agree(mesh().faces(), mesh().boundary_faces());
  agree(mesh().halffaces(), mesh().boundary_halffaces());
  agree(mesh().cells(), mesh().boundary_cells());
  for (HalfFaceHandle h : mesh().boundary_halffaces()) {
    const auto neighbours = mesh().boundary_halfface_halffaces(h);
    const auto edges = mesh().halfface_halfedges(h);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(mesh().is_boundary(neighbours[i]));
      EXPECT_TRUE(
          mesh().next_halfedge_in_halfface(mesh().opposite_halfedge(edges[i]), neighbours[i]).is_valid())
          << "surface neighbours see their edge in opposite directions";
      EXPECT_EQ(mesh().adjacent_halfface_on_surface(neighbours[i], edges[i]), h);
    }
  }
}

TEST_P(Circulators, EdgesOfACellThatAreItsToName) {
  for (CellHandle c : mesh().cells())
    for (unsigned k = 0; k < 6; ++k)
      EXPECT_EQ((mesh().first_edges(c) >> k & 1U) != 0, mesh().exists(EdgeHandle(6 * c.idx() + k)));
  const EdgeList list(mesh());
  EXPECT_EQ(vector_of(list), vector_of(mesh().edges()));
  EXPECT_EQ(list.size(), mesh().n_edges());
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list.vertices(i), mesh().edge_vertices(list[i]));
    EXPECT_EQ(list.index(list[i]), i);
  }
  EXPECT_EQ(list.index(EdgeHandle()), list.size());
  EXPECT_EQ(vector_of(EdgeList(mesh(), {3, 1})), vector_of(list));
}

TEST_P(Circulators, DeletedAndLogicalNumbers) {
  TetMesh torn = mesh();
  torn.delete_cell(*torn.cells().begin());
  std::size_t edges = 0, faces = 0;
  for (std::size_t i = 0; i < 6 * torn.n_cells(); ++i) edges += torn.is_deleted(EdgeHandle(i)) ? 0 : 1;
  for (std::size_t i = 0; i < 4 * torn.n_cells(); ++i) faces += torn.is_deleted(FaceHandle(i)) ? 0 : 1;
  EXPECT_EQ(edges, torn.n_logical_edges());
  EXPECT_EQ(faces, torn.n_logical_faces());
  EXPECT_EQ(torn.n_logical_halfedges(), 2 * edges);
  EXPECT_EQ(torn.n_logical_halffaces(), 4 * torn.n_logical_cells());
  EXPECT_TRUE(torn.is_deleted(HalfFaceHandle(0)) && torn.is_deleted(HalfEdgeHandle(0)));
}

TEST_P(Circulators, FindingByVertices) {
  const VertexHandle last(mesh().n_vertices() - 1);
  for (const auto& [edge, cells] : oracle.edges()) {
    const HalfEdgeHandle e = mesh().find_halfedge(edge[1], edge[0]);
    const auto seen_from = [&, cells = &cells](VertexHandle v) {
      const Set<CellHandle> reached = star(v);
      return std::ranges::any_of(*cells, [&](CellHandle c) { return reached.contains(c); });
    };
    ASSERT_EQ(e.is_valid(), seen_from(edge[0]) || seen_from(edge[1]));
    if (!e.is_valid()) continue;
    EXPECT_TRUE(mesh().exists(e));
    EXPECT_EQ(mesh().halfedge_vertices(e), (std::array{edge[1], edge[0]}));
    EXPECT_TRUE(mesh().find_edge(edge[0], edge[1]).is_valid());
    if (!oracle.edges().contains(sorted(edge[0], last))) {
      EXPECT_FALSE(mesh().find_edge(edge[0], last).is_valid());
    }
  }
  for (HalfFaceHandle h : mesh().halffaces()) {
    const auto v = mesh().halfface_vertices(h);
    const CellHandle c = mesh().incident_cell(h);
    if (!star(v[0]).contains(c) && !star(v[1]).contains(c) && !star(v[2]).contains(c)) continue;
    EXPECT_EQ(mesh().find_halfface({v[1], v[2], v[0]}), h);
    EXPECT_EQ(mesh().find_halfface({v[1], v[0], v[2]}), mesh().opposite_halfface(h));
    EXPECT_EQ(mesh().find_face({v[1], v[0], v[2]}), mesh().face_handle(h));
    if (!oracle.faces().contains(sorted(v[0], v[1], last))) {
      EXPECT_FALSE(mesh().find_face({v[0], v[1], last}).is_valid());
    }
    const auto all = mesh().cell_vertices(h);
    EXPECT_EQ(mesh().find_cell({all[3], all[1], all[0], all[2]}), c);
  }
  EXPECT_FALSE(mesh().find_halfedge(last, last).is_valid());
  EXPECT_FALSE(mesh().find_halfedge(last, VertexHandle(mesh().n_vertices())).is_valid());
  EXPECT_FALSE(mesh().find_cell({last, last, last, last}).is_valid());
}

/// n cells round one edge, closed.
TetMesh spindle(Index n) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  for (Index i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * i / n;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  return build(points, cells);
}

TEST(LargeStar, VertexWithMoreCellsThanAStarHolds) {
  for (const Index n : {Index{256}, Index{257}, Index{400}}) {
    const TetMesh mesh = spindle(n);
    const VertexHandle pole(0);
    EXPECT_EQ(unique_set(mesh.vertex_cells(pole)).size(), n);
    EXPECT_EQ(unique_set(mesh.vertex_vertices(pole)).size(), n + 1);
    EXPECT_EQ(unique_set(mesh.vertex_edges(pole)).size(), n + 1);
    EXPECT_EQ(unique_set(mesh.vertex_faces(pole)).size(), 2 * n);
    EXPECT_EQ(unique_set(mesh.vertex_halffaces(pole)).size(), 3 * n);
    EXPECT_EQ(unique_set(mesh.outgoing_halfedges(pole)).size(), n + 1);
    EXPECT_EQ(mesh.edge_cells(mesh.find_edge(pole, VertexHandle(1))).count(), n);
    EXPECT_TRUE(mesh.is_boundary(pole));
    EXPECT_FALSE(mesh.is_boundary(mesh.find_edge(pole, VertexHandle(1))));
    EXPECT_EQ(mesh.genus(), 0);
  }
}

TEST(LargeRing, OpenFanStartsAtTheBoundaryAtAnySize) {
  for (const Index n : {Index{62}, Index{63}, Index{64}, Index{65}, Index{200}}) {
    std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
    std::vector<test::Corners> cells;
    for (Index i = 0; i <= n; ++i) points.push_back({std::cos(i * 0.03), std::sin(i * 0.03), 0});
    for (Index i = 0; i < n; ++i) cells.push_back({0, 1, 2 + i, 3 + i});
    std::rotate(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(n / 3), cells.end());
    const TetMesh mesh = build(points, cells);
    const HalfEdgeHandle e = mesh.find_halfedge(VertexHandle(0), VertexHandle(1));
    const auto in_order = vector_of(mesh.halfedge_cells(e));
    ASSERT_EQ(in_order.size(), n);
    for (Index i = 0; i < n; ++i) EXPECT_TRUE(mesh.cell(in_order[i]).has(VertexHandle(2 + i)));
    EXPECT_EQ(mesh.halfedge_faces(e).count(), n + 1);
    EXPECT_EQ(vector_of(mesh.halfedge_cells(mesh.opposite_halfedge(e))).front(), in_order.back());
    EXPECT_FALSE(mesh.halfedge_cells(e).is_closed());
    EXPECT_TRUE(mesh.is_boundary(e));
  }
}

TEST(Genus, SolidTorusAndBall) {
  EXPECT_EQ(test::kuhn_box(2).genus(), 0);
  generate::Arrays arrays = generate::box({3, 3, 1});
  std::vector<test::Corners> kept;
  for (std::size_t i = 0; i < arrays.cells.size(); ++i)
    if (i / 6 != 4) kept.push_back(arrays.cells[i]);  // without the cube in the middle
  ASSERT_EQ(kept.size() + 6, arrays.cells.size());
  EXPECT_EQ(build(arrays.points, kept).genus(), 1);
}

TEST(UnusedVertex, HasNoNeighbours) {
  TetMesh mesh = test::single_cell();
  const VertexHandle v = mesh.add_vertex({1, 1, 1});
  EXPECT_TRUE(mesh.vertex_cells(v).empty());
  EXPECT_TRUE(mesh.vertex_vertices(v).empty());
  EXPECT_TRUE(mesh.vertex_edges(v).empty());
  EXPECT_FALSE(mesh.is_boundary(v));
  EXPECT_FALSE(mesh.find_edge(v, VertexHandle(0)).is_valid());
}

TEST(EmptyMesh, AllRangesAreEmpty) {
  const TetMesh mesh;
  EXPECT_TRUE(mesh.vertices().empty() && mesh.edges().empty() && mesh.faces().empty() &&
              mesh.cells().empty());
  EXPECT_EQ(mesh.n_edges() + mesh.n_faces(), 0U);
}

TEST(Ranges, OfNeighboursServeAsTemporariesInLoopsAndAlgorithms) {
  const TetMesh mesh = test::kuhn_box(2);
  const VertexHandle centre(13);
  std::size_t n = 0;
  for (CellHandle c : mesh.vertex_cells(centre)) n += mesh.cell(c).has(centre) ? 1 : 0;
  EXPECT_EQ(n, 24U);
  for ([[maybe_unused]] CellHandle c : mesh.cell_cells(CellHandle(0))) ++n;
  EXPECT_GT(n, 24U);
  EXPECT_EQ(std::ranges::count_if(mesh.vertex_cells(centre), [](CellHandle) { return true; }), 24);
  const auto first = std::ranges::find_if(mesh.boundary_edges(),
                                          [&](EdgeHandle e) { return mesh.edge_vertices(e)[0] != centre; });
  EXPECT_TRUE(mesh.is_boundary(*first));
}

#if !defined(__clang__) || __clang_major__ >= 16  // older ones reject the standard views of libstdc++
TEST(Ranges, ComposeWithStandardViews) {
  const TetMesh mesh = test::kuhn_box(2);
  const VertexHandle centre(13);
  std::size_t n = 0;
  for (CellHandle c : mesh.vertex_cells(centre) | std::views::filter([](CellHandle d) {
                        return d.idx() % 2 == 0;
                      }) | std::views::take(3))
    n += mesh.cell(c).has(centre) ? 1 : 0;
  EXPECT_EQ(n, 3U);
  EXPECT_EQ(std::ranges::distance(mesh.edge_cells(mesh.find_edge(centre, VertexHandle(0)))), 6);
}
#endif

TEST(AdjacentHalfFace, RefusesAnEdgeThatIsNotItsOwn) {
  const TetMesh mesh = test::single_cell();
  const HalfEdgeHandle e = mesh.find_halfedge(VertexHandle(0), VertexHandle(1));
  EXPECT_THROW(mesh.adjacent_halfface_in_cell(HalfFaceHandle(0), e), InvalidInput);
  EXPECT_THROW(mesh.cell_vertices(CellHandle(0), VertexHandle(7)), InvalidInput);
}

}  // namespace
}  // namespace hfr
