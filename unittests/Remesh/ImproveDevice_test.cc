// SPDX-License-Identifier: BSD-3-Clause
// The contract of DESIGN §5 and §6: the bits of a run on a device are those of any number of threads.
#include <gtest/gtest.h>

#include <algorithm>

#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

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
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(angles, expected);
}

}  // namespace
}  // namespace hfr::test
