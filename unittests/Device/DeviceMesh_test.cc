// SPDX-License-Identifier: BSD-3-Clause
// Rounds and passes on the device against those on the processor, bit for bit.
#include "Device/DeviceMesh.hh"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "Device/HasDevice.hh"
#include "Device/Scratch.hh"
#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/LimitMeshes.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/VertexCollapse.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/SmoothPass.hh"

namespace hfr::test {
namespace {

constexpr par::Policy kSerial{};

/// A mesh with its workspace.
struct Stand {
  TetMesh mesh;
  Workspace work;

  explicit Stand(TetMesh m) : mesh(std::move(m)) {
    work.attach(mesh, kSerial);
    work.set_qualities(mesh, VolumeLength{}, kSerial);
  }
};

TetMesh jittered_box(Index n, double jitter, std::uint64_t seed) {
  return built(generate::jittered_box({n, n, n}, jitter, seed));
}

/// How device code is launched: as on a CPU, and as on a GPU.
class OnDevice : public testing::TestWithParam<DeviceTuning> {
 protected:
  void SetUp() override {
    try {
      device_ = std::make_unique<DeviceMesh>(DeviceChoice{DeviceChoice::Kind::kOpenCl}, GetParam());
    } catch (const DeviceError& error) {
      expect_no_device();
      GTEST_SKIP() << error.what();
    }
  }

  static RoundCounts round_on_host(Stand& stand, DeviceMesh::Kind kind, double below,
                                   std::size_t may_lose = RoundOptions{}.may_lose) {
    const Worklist list(stand.mesh, kSerial,
                        [&](CellHandle c) { return stand.work.quality[c.idx()] < below; });
    if (list.cells().empty()) return {};
    RoundOptions options{kSerial, /*check_links=*/false, /*seed=*/5};
    options.may_lose = may_lose;
    if (kind == DeviceMesh::Kind::kVertex) {
      std::vector<VertexHandle> vertices = vertex_seeds(stand.mesh, list, stand.work.frozen, kSerial);
      drop_pinched(stand.mesh, stand.work, vertices);
      Round<VertexCollapse<VolumeLength>> round(stand.mesh, stand.work, options);
      return round.run({{}, stand.work.quality, stand.work.frozen}, vertices);
    }
    if (kind == DeviceMesh::Kind::kEdge) {
      Round<EdgeRemoval<VolumeLength>> round(stand.mesh, stand.work, options);
      return round.run({{}, stand.work.quality}, edge_seeds(stand.mesh, list, kSerial));
    }
    Round<FaceSwap<VolumeLength>> round(stand.mesh, stand.work, options);
    return round.run({{}, stand.work.quality}, face_seeds(stand.mesh, list, kSerial));
  }

  static void expect_same(const Stand& host, const Stand& device) {
    ASSERT_EQ(host.mesh.n_cells(), device.mesh.n_cells());
    for (std::size_t c = 0; c < host.mesh.n_cells(); ++c) {
      ASSERT_EQ(host.mesh.cell(CellHandle(c)).v, device.mesh.cell(CellHandle(c)).v) << c;
      ASSERT_EQ(host.mesh.cell(CellHandle(c)).mate, device.mesh.cell(CellHandle(c)).mate) << c;
    }
    for (std::size_t v = 0; v < host.mesh.n_vertices(); ++v) {
      ASSERT_EQ(host.mesh.incident_cell(VertexHandle(v)), device.mesh.incident_cell(VertexHandle(v))) << v;
      ASSERT_EQ(host.mesh.is_deleted(VertexHandle(v)), device.mesh.is_deleted(VertexHandle(v))) << v;
      ASSERT_EQ(host.mesh.point(VertexHandle(v)), device.mesh.point(VertexHandle(v))) << v;
    }
    EXPECT_EQ(host.mesh.n_logical_vertices(), device.mesh.n_logical_vertices());
    EXPECT_EQ(host.mesh.free_cells(), device.mesh.free_cells());
    EXPECT_EQ(host.work.quality, device.work.quality);
    EXPECT_EQ(host.work.star_size, device.work.star_size);
    EXPECT_EQ(host.work.changed, device.work.changed);
    EXPECT_EQ(host.work.pending, device.work.pending);
    EXPECT_EQ(host.work.claim, device.work.claim);
  }

  std::unique_ptr<DeviceMesh> device_;
};

TEST_P(OnDevice, QualitiesAndTallyHaveTheBitsOfTheHost) {
  Stand stand(jittered_box(6, 0.5, 3));
  device_->upload(stand.mesh, stand.work);
  const DeviceMesh::Tally tally = device_->tally();
  EXPECT_EQ(device_->qualities(), stand.work.quality);
  std::size_t n_invalid = 0;
  double smallest = 8.0 / 9.0;
  for (CellHandle c : stand.mesh.cells()) {
    n_invalid += !(stand.work.quality[c.idx()] > 0);
    const auto& v = stand.mesh.cell(c).v;
    smallest = std::min(smallest, MinDihedral{}(stand.mesh.point(v[0]), stand.mesh.point(v[1]),
                                                stand.mesh.point(v[2]), stand.mesh.point(v[3])));
  }
  EXPECT_GT(n_invalid, 10U);
  EXPECT_EQ(tally.n_invalid, n_invalid);
  EXPECT_EQ(tally.worst, *std::min_element(stand.work.quality.begin(), stand.work.quality.end()));
  EXPECT_EQ(device_->smallest_dihedral(), smallest);
}

TEST_P(OnDevice, RoundsAreThoseOfTheHost) {
  Stand host(jittered_box(9, 0.27, 4));
  Stand there = host;
  ASSERT_GT(*std::min_element(host.work.quality.begin(), host.work.quality.end()), 0);
  device_->upload(there.mesh, there.work);
  std::size_t n_winners = 0;
  std::size_t n_fresh = host.mesh.n_cells();
  for (int r = 0; r < 8; ++r) {
    const auto kind = r % 4 < 2 ? DeviceMesh::Kind::kFace : DeviceMesh::Kind::kEdge;
    const double below = r < 4 ? 0.6 : 0.9;
    const RoundCounts expected = round_on_host(host, kind, below);
    const RoundCounts counts = device_->round(kind, {below, 0, 0}, 5, there.work.clock);
    there.work.clock += static_cast<std::uint32_t>(counts.rounds);
    EXPECT_EQ(counts.rounds, expected.rounds);
    EXPECT_EQ(counts.seeds, expected.seeds);
    EXPECT_EQ(counts.candidates, expected.candidates);
    EXPECT_EQ(counts.winners, expected.winners);
    n_winners += counts.winners;
    device_->download(there.mesh, there.work, {.threads = 1 + r % 3, .serial_below = 1});
    expect_same(host, there);
    ASSERT_FALSE(HasFatalFailure()) << "round " << r;
    EXPECT_EQ(check(there.mesh), Ok);
  }
  n_fresh = host.mesh.n_cells() - n_fresh;
  EXPECT_GT(n_winners, 300U);
  EXPECT_GT(n_fresh, 10U) << "no slot beyond the first ones was used";
  EXPECT_FALSE(host.mesh.free_cells().empty()) << "no slot was freed";
}

TEST_P(OnDevice, EdgeInALargeRingIsRemovedAsOnTheHost) {
  // Close to one side of its ring of twelve, so that removing it pays.
  constexpr Index kRing = 12;
  constexpr double kTurn = 2 * std::numbers::pi / kRing;
  generate::Arrays arrays;
  for (Index i = 0; i < kRing; ++i) arrays.points.push_back({std::cos(kTurn * i), std::sin(kTurn * i), 0});
  const double x = 0.955 * std::cos(kTurn / 2);
  const double y = 0.955 * std::sin(kTurn / 2);
  arrays.points.push_back({x, y, -1});
  arrays.points.push_back({x, y, 1});
  for (Index i = 0; i < kRing; ++i) arrays.cells.push_back({kRing, kRing + 1, i, (i + 1) % kRing});
  Stand host(built(arrays));
  Stand there = host;
  device_->upload(there.mesh, there.work);
  ASSERT_EQ(round_on_host(host, DeviceMesh::Kind::kEdge, 1).winners, 1U);
  EXPECT_EQ(device_->round(DeviceMesh::Kind::kEdge, {1, 0, 0}, 5, there.work.clock).winners, 1U);
  device_->download(there.mesh, there.work);
  expect_same(host, there);
}

TEST_P(OnDevice, VerticesAreRemovedAsOnTheHost) {
  Stand host(jittered_box(10, 0.27, 21));
  Stand there = host;
  ASSERT_GT(*std::min_element(host.work.quality.begin(), host.work.quality.end()), 0);
  device_->upload(there.mesh, there.work);
  constexpr std::array kKinds = {DeviceMesh::Kind::kVertex, DeviceMesh::Kind::kVertex,
                                 DeviceMesh::Kind::kEdge, DeviceMesh::Kind::kFace};
  std::size_t n_removed = 0;
  for (std::size_t r = 0; r < 8; ++r) {
    const auto kind = kKinds[r % kKinds.size()];
    const double below = r < 4 ? 0.3 : 0.9;
    const RoundCounts expected = round_on_host(host, kind, below);
    const RoundCounts counts = device_->round(kind, {below, 0, 0}, 5, there.work.clock);
    ++there.work.clock;
    EXPECT_EQ(counts.rounds, expected.rounds);
    EXPECT_EQ(counts.seeds, expected.seeds);
    EXPECT_EQ(counts.candidates, expected.candidates);
    EXPECT_EQ(counts.winners, expected.winners);
    EXPECT_EQ(counts.held_back, 0U);
    EXPECT_EQ(device_->n_logical_cells(), host.mesh.n_logical_cells());
    if (kind == DeviceMesh::Kind::kVertex) n_removed += counts.winners;
    // From round to round on the device, and by way of the host, too.
    if (r % 3 == 0) continue;
    device_->download(there.mesh, there.work, {.threads = 3, .serial_below = 1});
    expect_same(host, there);
    ASSERT_FALSE(HasFatalFailure()) << "round " << r;
    EXPECT_EQ(check(there.mesh), Ok);
    if (r % 3 == 2) device_->upload(there.mesh, there.work);
  }
  EXPECT_GT(n_removed, 50U);
  EXPECT_EQ(there.mesh.n_logical_vertices(), there.mesh.n_vertices() - n_removed);
}

TEST_P(OnDevice, SmoothingAfterARemovalIsThatOfTheHost) {
  Stand host(jittered_box(8, 0.27, 22));
  Stand there = host;
  device_->upload(there.mesh, there.work);
  ASSERT_GT(round_on_host(host, DeviceMesh::Kind::kVertex, 0.3).winners, 10U);
  device_->round(DeviceMesh::Kind::kVertex, {0.3, 0, 0}, 5, there.work.clock++);
  const Worklist list(host.mesh, kSerial, [](CellHandle) { return true; });
  const auto vertices = vertex_seeds(host.mesh, list, host.work.frozen, kSerial);
  smooth_pass(host.mesh, host.work, NewtonSearch{}, VolumeLength{}, vertices, kSerial);
  ASSERT_TRUE(device_->smooth({2, 0, 0}, true, there.work.clock++));
  device_->download(there.mesh, there.work);
  expect_same(host, there);
}

TEST_P(OnDevice, VertexIsRemovedFromAStarOfUpTo256CellsAsOnTheHost) {
  // Below the upper end of a double cone of 2n cells, so that going up there pays.
  for (const Index n : {3, 16, 17, 128, 129}) {
    generate::Arrays arrays;
    const double turn = 2 * std::numbers::pi / n;
    for (Index i = 0; i < n; ++i) arrays.points.push_back({std::cos(turn * i), std::sin(turn * i), 0});
    arrays.points.push_back({0, 0, -1});
    arrays.points.push_back({0, 0, 1});
    arrays.points.push_back({0, 0, 0.99});
    for (Index i = 0; i < n; ++i) {
      arrays.cells.push_back({n + 2, (i + 1) % n, i, n});
      arrays.cells.push_back({n + 2, i, (i + 1) % n, n + 1});
    }
    Stand host(built(arrays));
    Stand there = host;
    ASSERT_GT(*std::min_element(host.work.quality.begin(), host.work.quality.end()), 0);
    device_->upload(there.mesh, there.work);
    const RoundCounts expected = round_on_host(host, DeviceMesh::Kind::kVertex, 1);
    const RoundCounts counts = device_->round(DeviceMesh::Kind::kVertex, {1, 0, 0}, 5, there.work.clock);
    EXPECT_EQ(expected.winners, n <= 128 ? 1U : 0U) << n;
    EXPECT_EQ(counts.seeds, expected.seeds) << n;
    EXPECT_EQ(counts.winners, expected.winners) << n;
    device_->download(there.mesh, there.work);
    expect_same(host, there);
    EXPECT_EQ(check(there.mesh), Ok);
  }
}

TEST_P(OnDevice, StarsOfUpTo256CellsAreSmoothedAndLargerOnesLeftToTheHost) {
  for (const Index n :
       {Index{86}, Index{128}, Index{129}, Index{2000}}) {  // 2n cells at the ends of the edge
    TetMesh mesh = built(hub(n));
    mesh.set_point(VertexHandle(0), {0.3, 0.2, 0.6});
    Stand host(std::move(mesh));
    Stand there = host;
    device_->upload(there.mesh, there.work);
    const auto counts = device_->smooth({2, 0, 0}, true, there.work.clock);
    ASSERT_EQ(counts.has_value(), n <= 128);
    if (counts) {
      const Worklist list(host.mesh, kSerial, [](CellHandle) { return true; });
      const auto vertices = vertex_seeds(host.mesh, list, host.work.frozen, kSerial);
      EXPECT_EQ(counts->winners,
                smooth_pass(host.mesh, host.work, NewtonSearch{}, VolumeLength{}, vertices, kSerial).winners);
      EXPECT_GT(counts->winners, 0U);
    }
    device_->download(there.mesh, there.work);
    expect_same(host, there);
  }
}

TEST_P(OnDevice, SixtyThreeColoursAreSmoothedAndMoreLeftToTheHost) {
  for (const Index n : {Index{63}, Index{64}, Index{70}}) {
    Stand host(built(neighbourly(n)));
    std::fill(host.work.frozen.begin(), host.work.frozen.end(), 0);  // as if none were on the boundary
    Stand there = host;
    device_->upload(there.mesh, there.work);
    const auto counts = device_->smooth({2, 0, 0}, false, there.work.clock);
    ASSERT_EQ(counts.has_value(), n <= 63) << n;
    if (counts) {
      const auto all = all_vertices(host.mesh);
      EXPECT_EQ(counts->winners,
                smooth_pass(host.mesh, host.work, CandidateSearch{}, VolumeLength{}, all, kSerial).winners);
      EXPECT_GT(counts->winners, 0U);
    }
    device_->download(there.mesh, there.work);
    expect_same(host, there);
  }
}

TEST_P(OnDevice, OfEquallyGoodPlacesTheVertexGoesToThatOfTheHost) {
  // Inside an octahedron, close to its surface: each corner as the apex makes four cells of the same shape.
  const std::array<Vec3, 7> points = {Vec3{0, 0, 1},  Vec3{1, 0, 0}, Vec3{0.5, 0.25, 0.125}, Vec3{0, -1, 0},
                                      Vec3{0, 0, -1}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}};
  constexpr std::array<std::array<Index, 3>, 8> kFaces = {
      {{1, 5, 0}, {5, 6, 0}, {6, 3, 0}, {3, 1, 0}, {5, 1, 4}, {6, 5, 4}, {3, 6, 4}, {1, 3, 4}}};
  for (std::size_t first = 0; first < kFaces.size(); ++first) {  // stars that begin with different cells
    generate::Arrays arrays;
    arrays.points.assign(points.begin(), points.end());
    for (std::size_t i = 0; i < kFaces.size(); ++i) {
      const auto& f = kFaces[(first + i) % kFaces.size()];
      arrays.cells.push_back({f[0], f[2], f[1], 2});
    }
    Stand host(built(arrays));
    Stand there = host;
    ASSERT_GT(*std::min_element(host.work.quality.begin(), host.work.quality.end()), 0);
    device_->upload(there.mesh, there.work);
    ASSERT_EQ(round_on_host(host, DeviceMesh::Kind::kVertex, 1).winners, 1U);
    device_->round(DeviceMesh::Kind::kVertex, {1, 0, 0}, 5, there.work.clock);
    device_->download(there.mesh, there.work);
    expect_same(host, there);
    ASSERT_FALSE(HasFatalFailure()) << first;
    EXPECT_EQ(host.mesh.cell(host.mesh.incident_cell(VertexHandle(0))).v[3], VertexHandle(0));
  }
}

TEST_P(OnDevice, RemovalsBeyondTheBoundOnCellsAreGivenUpAsOnTheHost) {
  Stand host(jittered_box(10, 0.27, 23));
  Stand there = host;
  for (const std::size_t may_lose : {std::size_t{0}, std::size_t{9}, std::size_t{100}}) {
    device_->upload(there.mesh, there.work);
    const std::size_t n_before = host.mesh.n_logical_cells();
    const RoundCounts expected = round_on_host(host, DeviceMesh::Kind::kVertex, 0.5, may_lose);
    const RoundCounts counts =
        device_->round(DeviceMesh::Kind::kVertex, {0.5, 0, 0}, 5, there.work.clock++, may_lose);
    EXPECT_EQ(counts.winners, expected.winners);
    EXPECT_EQ(counts.held_back, expected.held_back);
    EXPECT_GT(counts.held_back, 10U);
    EXPECT_EQ(counts.winners > 0, may_lose > 0);
    EXPECT_GE(device_->n_logical_cells() + may_lose, n_before);
    device_->download(there.mesh, there.work);
    expect_same(host, there);
    ASSERT_FALSE(HasFatalFailure()) << may_lose;
  }
}

TEST_P(OnDevice, VerticesOfOneRegionGoAndThoseOfTwoStay) {
  generate::Arrays arrays = generate::jittered_box({8, 8, 8}, 0.27, 24);
  arrays.regions = generate::two_region_box({8, 8, 8}).regions;
  const auto regions = std::exchange(arrays.regions, {});
  Stand undivided(built(arrays));
  arrays.regions = regions;
  Stand host(built(arrays));
  // As if vertices of the interface were free: only the regions hold them.
  std::fill(host.work.frozen.begin(), host.work.frozen.end(), 0);
  for (HalfFaceHandle h : host.mesh.halffaces())
    if (host.mesh.is_boundary(h))
      for (VertexHandle v : host.mesh.halfface_vertices(h)) host.work.frozen[v.idx()] = 1;
  Stand there = host;
  device_->upload(there.mesh, there.work);
  const RoundCounts expected = round_on_host(host, DeviceMesh::Kind::kVertex, 0.5);
  const RoundCounts counts = device_->round(DeviceMesh::Kind::kVertex, {0.5, 0, 0}, 5, there.work.clock);
  EXPECT_EQ(counts.candidates, expected.candidates);
  EXPECT_LT(counts.candidates, round_on_host(undivided, DeviceMesh::Kind::kVertex, 0.5).candidates);
  EXPECT_GT(counts.winners, 10U);
  device_->download(there.mesh, there.work);
  expect_same(host, there);
}

TEST_P(OnDevice, CellsCreatedInFreshSlotsInheritRegionAndFields) {
  generate::Arrays arrays = generate::jittered_box({8, 8, 8}, 0.25, 6);
  arrays.regions = generate::two_region_box({8, 8, 8}).regions;
  Stand host(built(arrays));
  auto field = host.mesh.request_cell_property<int>("field");
  for (CellHandle c : host.mesh.cells()) field[c] = static_cast<int>(7 * c.idx());
  Stand there = host;
  const std::size_t n_cells = host.mesh.n_cells();
  device_->upload(there.mesh, there.work);
  for (int r = 0; r < 6; ++r) {
    const auto kind = r % 2 == 0 ? DeviceMesh::Kind::kFace : DeviceMesh::Kind::kEdge;
    round_on_host(host, kind, 0.9);
    there.work.clock +=
        static_cast<std::uint32_t>(device_->round(kind, {0.9, 0, 0}, 5, there.work.clock).rounds);
  }
  device_->download(there.mesh, there.work);
  expect_same(host, there);
  ASSERT_FALSE(HasFatalFailure());
  ASSERT_GT(host.mesh.n_cells(), n_cells);
  const auto expected = host.mesh.request_cell_property<int>("field");
  const auto found = there.mesh.request_cell_property<int>("field");
  for (CellHandle c : host.mesh.cells()) {
    ASSERT_EQ(found[c], expected[c]) << c.idx();
    ASSERT_EQ(there.mesh.region(c), host.mesh.region(c)) << c.idx();
  }
}

TEST_P(OnDevice, SmoothingIsThatOfTheHost) {
  for (const bool newton : {true, false}) {
    Stand host(jittered_box(7, 0.5, 8));  // some cells are inverted
    Stand there = host;
    device_->upload(there.mesh, there.work);
    for (int pass = 0; pass < 2; ++pass) {
      const Worklist list(host.mesh, kSerial, [&](CellHandle c) { return host.work.quality[c.idx()] < 0.5; });
      const auto vertices = vertex_seeds(host.mesh, list, host.work.frozen, kSerial);
      const RoundCounts expected =
          newton ? smooth_pass(host.mesh, host.work, NewtonSearch{}, VolumeLength{}, vertices, kSerial)
                 : smooth_pass(host.mesh, host.work, CandidateSearch{}, VolumeLength{}, vertices, kSerial);
      const auto counts = device_->smooth({0.5, 0, 0}, newton, there.work.clock);
      ASSERT_TRUE(counts);
      ++there.work.clock;
      EXPECT_EQ(counts->seeds, expected.seeds);
      EXPECT_EQ(counts->winners, expected.winners);
      EXPECT_GT(counts->winners, 50U);
    }
    device_->download(there.mesh, there.work);
    expect_same(host, there);
    ASSERT_FALSE(HasFatalFailure()) << newton;
  }
}

TEST_P(OnDevice, PendingBitsChooseTheCellsAndAreCleared) {
  Stand host(jittered_box(5, 0.3, 9));
  for (std::size_t c = 0; c < host.mesh.n_cells(); ++c) host.work.pending[c] = c % 3 == 0 ? 0x10 : 0x0f;
  Stand there = host;
  device_->upload(there.mesh, there.work);
  const Worklist list(host.mesh, kSerial, [&](CellHandle c) {
    auto& pending = host.work.pending[c.idx()];
    const bool listed = (pending & 0x10) != 0;
    pending = static_cast<std::uint8_t>(pending & ~0x10);
    return listed;
  });
  const auto vertices = vertex_seeds(host.mesh, list, host.work.frozen, kSerial);
  smooth_pass(host.mesh, host.work, CandidateSearch{}, VolumeLength{}, vertices, kSerial);
  ASSERT_TRUE(device_->smooth({0, 0, 0x10}, false, there.work.clock));
  device_->download(there.mesh, there.work);
  expect_same(host, there);
}

TEST_P(OnDevice, NothingHappensWhereThereIsNothingToLookAt) {
  Stand stand(jittered_box(3, 0.2, 1));
  device_->upload(stand.mesh, stand.work);
  EXPECT_EQ(device_->round(DeviceMesh::Kind::kEdge, {-1, 0, 0}, 1, 1).rounds, 0U);
  EXPECT_EQ(device_->smooth({-1, 0, 0}, true, 1).value().seeds, 0U);
}

TEST_P(OnDevice, MeshBeyondTheMemoryIsRefusedWithFigures) {
  try {
    device_->require_room(std::size_t{1} << 40, std::size_t{1} << 40);
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("MiB"), std::string::npos);
  }
  EXPECT_NO_THROW(device_->require_room(1000, 5000));
}

INSTANTIATE_TEST_SUITE_P(Tunings, OnDevice,
                         testing::Values(DeviceTuning{}, DeviceTuning{1, 3, false}, DeviceTuning{32, 5, true},
                                         DeviceTuning{16, 3, false, /*spare=*/1}),
                         [](const auto& tuning) {
                           return "Group" + std::to_string(tuning.param.work_group) +
                                  (tuning.param.spare > 0 ? "Growing" : "");
                         });

}  // namespace
}  // namespace hfr::test
