// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartRound.hh"

#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <utility>

#include "Distributed/PartSeeds.hh"
#include "Distributed/PartSmoothing.hh"
#include "Distributed/Parts.hh"
#include "Operators/AnyOf.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/FanMerge.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/VertexCollapse.hh"

namespace hfr::test {
namespace {

/// Cells that wait for an operator; they count as looked at.
Worklist pending(const TetMesh& mesh, Workspace& work, std::uint8_t bit) {
  return Worklist(mesh, {}, [&](CellHandle c) {
    const bool is_pending = (work.pending[c.idx()] & bit) != 0;
    work.pending[c.idx()] = static_cast<std::uint8_t>(work.pending[c.idx()] & ~bit);
    return is_pending;
  });
}

template <class Op, class Make>
RoundCounts edge_round(Whole& w, std::uint8_t bit, Make&& make, RoundOptions options) {
  const Worklist list = pending(w.mesh, w.work, bit);
  Round<Op> round(w.mesh, w.work, options);
  return round.run(make(w.work), list.cells().size(), [&](std::size_t i, auto&& visit) {
    if constexpr (IsCellAndEdge<typename Op::Seed>)
      for (std::uint8_t e = 0; e < 6; ++e) visit(typename Op::Seed{C(list.cells()[i]), e, 0, 0});
    else if constexpr (std::is_same_v<typename Op::Seed, EdgeHandle>)
      visit_edge_seeds(w.mesh, list, C(list.cells()[i]), visit);
    else
      visit_face_seeds(w.mesh, list, C(list.cells()[i]),
                       [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
  });
}

template <class Op, class Make>
RoundCounts edge_round(mpi::DistributedMesh& m, std::uint8_t bit, Make&& make, RoundOptions options) {
  const Worklist list = pending(m.part(), m.work(), bit);
  mpi::PartRound place(m);
  Round<Op> round(m.part(), m.work(), place.options(options));
  return round.run(make(m.work()), list.cells().size(), [&](std::size_t i, auto&& visit) {
    if constexpr (IsCellAndEdge<typename Op::Seed>) {
      if (const CellHandle c = C(list.cells()[i]); m.is_own(c))
        for (std::uint8_t e = 0; e < 6; ++e) visit(typename Op::Seed{c, e, 0, 0});
    } else if constexpr (std::is_same_v<typename Op::Seed, EdgeHandle>)
      mpi::visit_edge_seeds(m, list, C(list.cells()[i]), visit);
    else
      mpi::visit_face_seeds(m, list, C(list.cells()[i]),
                            [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
  });
}

template <class Op, class Make>
RoundCounts vertex_round(Whole& w, std::uint8_t bit, Make&& make, RoundOptions options) {
  const Worklist list = pending(w.mesh, w.work, bit);
  std::vector<VertexHandle> vertices = vertex_seeds(w.mesh, list, w.work.frozen, {});
  drop_pinched(w.mesh, w.work, vertices);
  return Round<Op>(w.mesh, w.work, options).run(make(w.work), vertices);
}

template <class Op, class Make>
RoundCounts vertex_round(mpi::DistributedMesh& m, std::uint8_t bit, Make&& make, RoundOptions options) {
  const Worklist list = pending(m.part(), m.work(), bit);
  const auto vertices = mpi::removable_seeds(m, list, {});
  mpi::PartRound place(m);
  return Round<Op>(m.part(), m.work(), place.options(options)).run(make(m.work()), vertices);
}

using AnyKind = AnyOf<EdgeRemoval<MinSine2>, MultiFaceRemoval<MinSine2>, VertexCollapse<MinSine2>>;

AnyKind any_kind(const Workspace& w) {
  return {{EdgeRemoval<MinSine2>{{}, w.quality}, MultiFaceRemoval<MinSine2>{{}, w.quality},
           VertexCollapse<MinSine2>{{}, w.quality, w.frozen}}};
}

/// Calls visit(seed) with the seeds of all kinds, as visit_edges and visit_faces name them.
template <class VisitEdges, class VisitFaces>
auto seeds_of_any_kind(const Worklist& list, std::span<const VertexHandle> vertices, VisitEdges visit_edges,
                       VisitFaces visit_faces) {
  using Seed = AnyKind::Seed;
  return [=, &list](std::size_t i, auto&& visit) {
    const std::size_t n_cells = list.cells().size();
    if (i >= n_cells) {
      visit(Seed(std::in_place_index<2>, vertices[i - n_cells]));
      return;
    }
    visit_edges(C(list.cells()[i]), [&](EdgeHandle e) { visit(Seed(std::in_place_index<0>, e)); });
    visit_faces(C(list.cells()[i]), [&](HalfFaceHandle h) { visit(Seed(std::in_place_index<1>, h)); });
  };
}

RoundCounts mixed_round(Whole& w, std::uint8_t bit, RoundOptions options) {
  const Worklist list = pending(w.mesh, w.work, bit);
  const auto vertices = vertex_seeds(w.mesh, list, w.work.frozen, {});
  Round<AnyKind> round(w.mesh, w.work, options);
  return round.run(
      any_kind(w.work), list.cells().size() + vertices.size(),
      seeds_of_any_kind(
          list, vertices, [&](CellHandle c, auto&& visit) { visit_edge_seeds(w.mesh, list, c, visit); },
          [&](CellHandle c, auto&& visit) { visit_face_seeds(w.mesh, list, c, visit); }));
}

RoundCounts mixed_round(mpi::DistributedMesh& m, std::uint8_t bit, RoundOptions options) {
  const Worklist list = pending(m.part(), m.work(), bit);
  const auto vertices = mpi::removable_seeds(m, list, {});
  mpi::PartRound place(m);
  Round<AnyKind> round(m.part(), m.work(), place.options(options));
  return round.run(
      any_kind(m.work()), list.cells().size() + vertices.size(),
      seeds_of_any_kind(
          list, vertices, [&](CellHandle c, auto&& visit) { mpi::visit_edge_seeds(m, list, c, visit); },
          [&](CellHandle c, auto&& visit) { mpi::visit_face_seeds(m, list, c, visit); }));
}

template <class Search, class Metric>
RoundCounts smooth(Whole& w, std::uint8_t bit, const Search& search, const Metric& metric) {
  const Worklist list = pending(w.mesh, w.work, bit);
  return smooth_pass(w.mesh, w.work, search, metric, vertex_seeds(w.mesh, list, w.work.frozen, {}), {});
}

template <class Search, class Metric>
RoundCounts smooth(mpi::DistributedMesh& m, std::uint8_t bit, const Search& search, const Metric& metric) {
  const Worklist list = pending(m.part(), m.work(), bit);
  return mpi::smooth_parts(m, search, metric, vertex_seeds(m.part(), list, m.work().frozen, {}), {});
}

RoundOptions options(std::uint64_t seed = 1) {
  RoundOptions o;
  o.check_links = false;
  o.seed = seed;
  return o;
}

TEST(PartRound, EdgeRemovalIsThatOfSharedMemory) {
  using Op = EdgeRemoval<VolumeLength>;
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(7, 0.45, seed), VolumeLength{}, 6, 100, [&](auto& mesh) {
      return edge_round<Op>(
          mesh, 1,
          [](const Workspace& w) {
            return Op{{}, w.quality};
          },
          options(seed));
    });
}

TEST(PartRound, FaceSwapIsThatOfSharedMemory) {
  using Op = FaceSwap<VolumeLength>;
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(9, 0.48, seed), VolumeLength{}, 6, 40, [&](auto& mesh) {
      return edge_round<Op>(
          mesh, 2,
          [](const Workspace& w) {
            return Op{{}, w.quality};
          },
          options(seed));
    });
}

TEST(PartRound, MultiFaceRemovalIsThatOfSharedMemory) {
  using Op = MultiFaceRemoval<MinSine2>;
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(7, 0.45, seed), MinSine2{}, 6, 100, [&](auto& mesh) {
      return edge_round<Op>(
          mesh, 2,
          [](const Workspace& w) {
            return Op{{}, w.quality};
          },
          options(seed));
    });
}

/// Two cells of a row name the same merger, so that candidates of two ranks may have one name.
TEST(PartRound, FanMergeIsThatOfSharedMemory) {
  using Op = FanMerge<MinSine2>;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U})
    expect_same_for_parts(valid_box(10, 0.6, seed), MinSine2{}, 3, 12, [&](auto& mesh) {
      return edge_round<Op>(
          mesh, 4,
          [](const Workspace& w) {
            return Op{{}, w.quality};
          },
          options(seed));
    });
}

TEST(PartRound, VertexCollapseIsThatOfSharedMemory) {
  using Op = VertexCollapse<VolumeLength>;
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(7, 0.45, seed), VolumeLength{}, 6, 20, [&](auto& mesh) {
      return vertex_round<Op>(
          mesh, 4,
          [](const Workspace& w) {
            return Op{{}, w.quality, w.frozen};
          },
          options(seed));
    });
}

TEST(PartRound, SmoothingIsThatOfSharedMemory) {
  expect_same_for_parts(valid_box(7, 0.45, 4), VolumeLength{}, 3, 100,
                        [&](auto& mesh) { return smooth(mesh, 16, NewtonSearch{}, VolumeLength{}); });
  expect_same_for_parts(valid_box(7, 0.45, 5), MinSine2{}, 3, 100,
                        [&](auto& mesh) { return smooth(mesh, 16, MaxMinSearch{}, MinSine2{}); });
}

TEST(PartRound, AllKindsInTurnAreThoseOfSharedMemory) {
  using Edge = EdgeRemoval<MinSine2>;
  using Face = MultiFaceRemoval<MinSine2>;
  using Node = VertexCollapse<MinSine2>;
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(8, 0.48, seed), MinSine2{}, 3, 300, [&](auto& mesh) {
      RoundCounts counts;
      for (int r = 0; r < 3; ++r)
        counts += edge_round<Edge>(
            mesh, 1,
            [](const Workspace& w) {
              return Edge{{}, w.quality};
            },
            options(seed));
      for (int r = 0; r < 2; ++r)
        counts += edge_round<Face>(
            mesh, 2,
            [](const Workspace& w) {
              return Face{{}, w.quality};
            },
            options(seed));
      counts += vertex_round<Node>(
          mesh, 4,
          [](const Workspace& w) {
            return Node{{}, w.quality, w.frozen};
          },
          options(seed));
      counts += smooth(mesh, 16, MaxMinSearch{}, MinSine2{});
      return counts;
    });
}

/// Another rank that commits a winner has to know of what kind it is.
TEST(PartRound, KindsInOneSelectionAreThoseOfSharedMemory) {
  for (const std::uint64_t seed : {1U, 2U})
    expect_same_for_parts(valid_box(8, 0.48, seed), MinSine2{}, 5, 300,
                          [&](auto& mesh) { return mixed_round(mesh, 64, options(seed)); });
}

/// Labels and locks all over the mesh keep the rounds from much, and from the same things.
TEST(PartRound, WhatIsLabelledOrFixedStaysAsInSharedMemory) {
  using Edge = EdgeRemoval<MinSine2>;
  using Face = MultiFaceRemoval<MinSine2>;
  using Node = VertexCollapse<MinSine2>;
  TetMesh mesh = valid_box(8, 0.48, 3);
  for (HalfFaceHandle h : mesh.halffaces())
    if (mix64(h.idx()) % 60 == 0) mesh.labels().faces.set(mesh.halfface_vertices(h), 4);
  std::size_t n = 0;
  for (EdgeHandle e : mesh.edges())
    if (const auto at = mix64(++n) % 40; at == 0)
      mesh.labels().edges.set(mesh.edge_vertices(e), 5);
    else if (at == 1)
      mesh.set_fixed(e);
  for (FaceHandle f : mesh.faces())
    if (mix64(f.idx()) % 90 == 1) mesh.set_fixed(f);
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  for (VertexHandle v : mesh.vertices()) {
    if (v.idx() % 5 == 2) mesh.labels().vertices[v.idx()] = 6;
    if (v.idx() % 17 == 3) mesh.set_fixed(v);
  }
  expect_same_for_parts(mesh, MinSine2{}, 4, 200, [&](auto& m) {
    RoundCounts counts;
    for (int r = 0; r < 2; ++r)
      counts += edge_round<Edge>(
          m, 1,
          [](const Workspace& w) {
            return Edge{{}, w.quality};
          },
          options());
    counts += edge_round<Face>(
        m, 2,
        [](const Workspace& w) {
          return Face{{}, w.quality};
        },
        options());
    counts += vertex_round<Node>(
        m, 4,
        [](const Workspace& w) {
          return Node{{}, w.quality, w.frozen};
        },
        options());
    counts += smooth(m, 16, MaxMinSearch{}, MinSine2{});
    return counts;
  });
}

TEST(PartRound, BoundsOnCellsHoldForTheWhole) {
  using Op = VertexCollapse<VolumeLength>;
  RoundOptions bounded = options();
  bounded.may_lose = 30;
  std::size_t n_held_back = 0;
  expect_same_for_parts(valid_box(7, 0.45, 1), VolumeLength{}, 3, 3, [&](auto& mesh) {
    const RoundCounts counts = vertex_round<Op>(
        mesh, 4,
        [](const Workspace& w) {
          return Op{{}, w.quality, w.frozen};
        },
        bounded);
    n_held_back += counts.held_back;
    return counts;
  });
  EXPECT_GT(n_held_back, 0U) << "the bound is never met";
}

}  // namespace
}  // namespace hfr::test
