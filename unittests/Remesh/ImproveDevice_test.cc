// SPDX-License-Identifier: BSD-3-Clause
// The contract of DESIGN §5 and §6: the bits of a run on a device are those of any number of threads.
#include <gtest/gtest.h>

#include <stdlib.h>

#include <algorithm>
#include <set>

#include "Device/HasDevice.hh"
#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Operators/LimitMeshes.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

#ifdef HFR_FAILING_LOADER
// Before the first test: the loader is opened once. It does what the real one does until it is told to fail.
[[maybe_unused]] const int kWithFailingLoader = setenv("HFR_OPENCL_LIBRARY", HFR_FAILING_LOADER, 0);
#endif

/// 1 and 3 threads, and the device, as on a CPU and as on a GPU.
template <class Make>
void expect_same_bits_on_device(const Make& make, ImproveOptions options, bool reconnects) {
  TetMesh one = make();
  const Result expected = improve(one, options);
  TetMesh three = make();
  options.policy = {3, /*serial_below=*/1};
  improve(three, options);
  EXPECT_EQ(io::mesh_hash(one), io::mesh_hash(three));
  options.policy = {};
  options.device.kind = DeviceChoice::Kind::kOpenCl;
  for (const unsigned work_group : {0U, 32U}) {
    options.device_tuning.work_group = work_group;
    options.device_tuning.groups = work_group == 0 ? 0 : 3;
    TetMesh there = make();
    Result result;
    try {
      result = improve(there, options);
    } catch (const DeviceError& error) {
      expect_no_device();
      GTEST_SKIP() << error.what();
    }
    EXPECT_FALSE(result.device.empty());
    EXPECT_EQ(check(there), Ok);
    EXPECT_EQ(io::mesh_hash(one), io::mesh_hash(there)) << "work-groups of " << work_group;
    ASSERT_EQ(result.passes.size(), expected.passes.size());
    bool reconnected = false, smoothed = false;
    for (std::size_t i = 0; i < result.passes.size(); ++i) {
      const PassReport& pass = result.passes[i];
      EXPECT_EQ(pass.winners, expected.passes[i].winners) << pass.stage << " " << pass.op;
      EXPECT_EQ(pass.seeds, expected.passes[i].seeds) << pass.stage << " " << pass.op;
      EXPECT_EQ(pass.worst, expected.passes[i].worst) << pass.stage << " " << pass.op;
      EXPECT_EQ(pass.n_inverted, expected.passes[i].n_inverted) << pass.stage << " " << pass.op;
      if (pass.on_device) (pass.op == "smooth" ? smoothed : reconnected) = true;
    }
    EXPECT_TRUE(smoothed);
    EXPECT_EQ(reconnected, reconnects);
  }
}

TEST(ImproveDevice, CavityHasTheBitsOfTheProcessor) {
  expect_same_bits_on_device([] { return small_cavity(7); }, serial(), true);
}

TEST(ImproveDevice, VerticesOfMoreThan256CellsHaveTheBitsOfTheProcessor) {
  const auto make = [] {
    TetMesh mesh = built(hub(150));
    shake_inner(mesh, 0.02, 4);
    return mesh;
  };
  TetMesh here = make();
  ImproveOptions options = serial();
  EXPECT_TRUE(improve(here, options).changed);
  options.device.kind = DeviceChoice::Kind::kOpenCl;
  TetMesh there = make();
  try {
    improve(there, options);
  } catch (const DeviceError& error) {
    expect_no_device();
    GTEST_SKIP() << error.what();
  }
  EXPECT_TRUE(identical(here, there));
}

TEST(ImproveDevice, RegionsHaveTheBitsOfTheProcessor) {
  expect_same_bits_on_device(
      [] {
        generate::Arrays arrays = generate::jittered_box({6, 6, 6}, 0.25, 3);
        arrays.regions = generate::two_region_box({6, 6, 6}).regions;
        return built(arrays);
      },
      serial(), true);
}

TEST(ImproveDevice, LabelledMeshIsReconnectedOnTheProcessor) {
  expect_same_bits_on_device([] { return labelled_box(4, 0.3, 5); }, serial(), false);
}

TEST(ImproveDevice, VerticesOfTheBulkStageAreRemovedOnTheDevice) {
  ImproveOptions options = serial();
  options.bulk_nodes = true;
  expect_same_bits_on_device([] { return small_cavity(8); }, options, true);
  options.min_cells = 2900;  // of 3072, so that removals are given up
  expect_same_bits_on_device([] { return small_cavity(8); }, options, true);
  options.device.kind = DeviceChoice::Kind::kOpenCl;
  TetMesh there = small_cavity(8);
  Result result;
  try {
    result = improve(there, options);
  } catch (const DeviceError& error) {
    expect_no_device();
    GTEST_SKIP() << error.what();
  }
  const auto removes_there = [](const PassReport& pass) {
    return pass.stage == "bulk" && pass.op == "node" && pass.on_device && pass.winners > 0;
  };
  EXPECT_TRUE(std::any_of(result.passes.begin(), result.passes.end(), removes_there));
  EXPECT_GE(there.n_cells(), 2850U) << "swaps may take away a few more";
}

#ifdef HFR_FAILING_LOADER
TEST(ImproveDevice, NoMemoryToGrowInTheMiddleKeepsTheRoundsThatWereFinished) {
  ImproveOptions options = serial();
  options.ops = Ops::kFace | Ops::kNode | Ops::kSmooth;
  options.bulk_nodes = true;
  const auto make = [] {
    generate::Arrays arrays = generate::jittered_box({9, 9, 9}, 0.25, 12);
    for (Vec3& p : arrays.points) p.z *= 4;
    return built(arrays);
  };
  const TetMesh before = make();
  TetMesh swapped = make();  // ended after the first pass, which swaps faces
  ImproveOptions one_pass = options;
  bool has_swapped = false;
  one_pass.progress = [&](const Progress&) { has_swapped = true; };
  one_pass.cancel = [&] { return has_swapped; };
  ASSERT_TRUE(improve(swapped, one_pass).changed);

  options.device.kind = DeviceChoice::Kind::kOpenCl;
  options.device_tuning.spare = 1;  // so that the first rounds of each kind have to make room
  const auto improve_with = [&](int growth, Result& result) {
    setenv("HFR_FAIL_GROWTH", std::to_string(growth).c_str(), 1);
    TetMesh mesh = make();
    try {
      result = improve(mesh, options);
    } catch (const DeviceError& error) {
      expect_no_device();
      result.device_note = error.what();
    }
    unsetenv("HFR_FAIL_GROWTH");
    return mesh;
  };
  std::set<std::string> outcomes;
  for (int growth = 1; growth < 100; growth += 3) {
    Result result;
    const TetMesh mesh = improve_with(growth, result);
    if (result.device.empty()) GTEST_SKIP() << result.device_note;
    if (result.stop != Stop::kDeviceLost) break;  // fewer arrays have grown
    EXPECT_NE(result.device_note.find("CL_MEM_OBJECT_ALLOCATION_FAILURE"), std::string::npos);
    EXPECT_EQ(check(mesh), Ok);
    const std::uint64_t hash = io::mesh_hash(mesh);
    outcomes.insert(hash == io::mesh_hash(before)    ? "nothing is done"
                    : hash == io::mesh_hash(swapped) ? "faces are swapped"
                                                     : "something else");
  }
  EXPECT_EQ(outcomes, (std::set<std::string>{"faces are swapped", "nothing is done"}));
}
#endif

TEST(ImproveDevice, HybridSmoothsOnly) {
  ImproveOptions options = serial();
  options.hybrid = true;
  expect_same_bits_on_device([] { return small_cavity(7); }, options, false);
}

TEST(ImproveDevice, PapersPipelineSmoothsOnTheDevice) {
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  expect_same_bits_on_device([] { return small_cavity(6); }, options, false);
}

TEST(ImproveDevice, ProgressSeesTheAnglesOfTheMeshOnTheDevice) {
  std::vector<double> angles;
  ImproveOptions options = serial();
  options.progress = [&](const Progress& progress) { angles.push_back(progress.min_dihedral); };
  TetMesh one = small_cavity(6);
  improve(one, options);
  const std::vector<double> expected = angles;
  angles.clear();
  options.device.kind = DeviceChoice::Kind::kOpenCl;
  TetMesh there = small_cavity(6);
  try {
    improve(there, options);
  } catch (const DeviceError& error) {
    expect_no_device();
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(angles, expected);
}

}  // namespace
}  // namespace hfr::test
