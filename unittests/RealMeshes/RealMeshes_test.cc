// SPDX-License-Identifier: BSD-3-Clause
// Every real mesh through the whole library: read, improve, check, write in every format, read back.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "Device/HasDevice.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/Hash.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Quality/Statistics.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr {
namespace {

namespace fs = std::filesystem;

struct RealMesh {
  const char* path;     ///< below the folder of meshes
  double min_dihedral;  ///< degrees that the default run must reach: what peers reach where they are honest
};

std::ostream& operator<<(std::ostream& out, const RealMesh& mesh) { return out << mesh.path; }

class RealMeshes : public testing::TestWithParam<RealMesh> {
 protected:
  void SetUp() override {
    path_ = fs::path(HFR_TEST_MESHES) / GetParam().path;
    if (!fs::exists(path_))
      GTEST_SKIP() << "there is no " << path_.string() << "; real meshes are not shipped";
    folder_ = fs::temp_directory_path() / ("hfremesh-real-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  fs::path path_, folder_;
};

using Bits = std::array<std::uint64_t, 3>;
Bits bits(Vec3 p) {
  return {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y),
          std::bit_cast<std::uint64_t>(p.z)};
}

/// Boundary and interface triangles by their coordinates' bits, with the regions on both sides.
using Frozen = std::vector<std::pair<std::array<Bits, 3>, std::array<int, 2>>>;
Frozen frozen_faces(const TetMesh& mesh) {
  Frozen faces;
  for (std::size_t i = 0; i < 4 * mesh.n_cells(); ++i) {
    const HalfFaceHandle h(i);
    if (mesh.is_deleted(cell_of(h))) continue;
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    const int inside = mesh.region(cell_of(h));
    const int outside = m.is_valid() ? mesh.region(cell_of(m)) : inside - 1;
    if (inside == outside) continue;
    const auto v = mesh.halfface_vertices(h);
    std::array<Bits, 3> corners = {bits(mesh.point(v[0])), bits(mesh.point(v[1])), bits(mesh.point(v[2]))};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    faces.emplace_back(corners, std::array<int, 2>{inside, m.is_valid() ? outside : -1});
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::map<int, double> region_volumes(const Statistics& statistics) {
  std::map<int, double> volumes;
  for (const RegionStatistics& region : statistics.regions) volumes[region.region] = region.volume;
  return volumes;
}

TEST_P(RealMeshes, ImproveKeepsShapeAndRaisesTheWorstWithTheSameBitsEverywhere) {
  const io::MeshData data = io::read_mesh(path_);
  TetMesh mesh = io::assemble(data);
  const CheckResult broken_before = check(mesh);
  const Frozen frozen_before = frozen_faces(mesh);
  const auto labels_before = mesh.labels().faces.size();
  ImproveOptions options;
  options.policy.threads = 1;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), broken_before.rule) << check(mesh);
  EXPECT_EQ(frozen_faces(mesh), frozen_before) << "boundary or interfaces have changed";
  EXPECT_EQ(mesh.labels().faces.size(), labels_before);
  EXPECT_LE(result.invalid_cells.size(), result.before.inverted.size() + result.before.flat.size());
  EXPECT_GE(result.after.min_dihedral.min, result.before.min_dihedral.min);
  EXPECT_GE(result.after.min_dihedral.min, GetParam().min_dihedral);
  if (result.invalid_cells.empty()) {
    EXPECT_LT(std::abs(result.after.overlap), 1e-12);
  }
  const auto before = region_volumes(result.before);
  const auto after = region_volumes(result.after);
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [region, volume] : before)
    EXPECT_NEAR(after.at(region), volume, 1e-12 * std::abs(result.before.enclosed_volume))
        << "region " << region;

  const auto one = io::mesh_hash(mesh);
  const auto hash = [&](const ImproveOptions& others) {
    TetMesh again = io::assemble(data);
    improve(again, others);
    return io::mesh_hash(again);
  };
  options.statistics = false;
  options.policy.threads = 3;
  const ImproveOptions on_processor = options;
  options.device.kind = DeviceChoice::Kind::kOpenCl;
  // Both at once; one by one only to say which of them differs.
  try {
    if (hash(options) == one) return;
    EXPECT_EQ(hash(on_processor), one) << "with three threads";
    ADD_FAILURE() << "with three threads and on the device";
  } catch (const DeviceError& error) {
    EXPECT_EQ(hash(on_processor), one) << "with three threads";
    test::expect_no_device();
    GTEST_SKIP() << error.what();
  }
}

/// Meshes of several regions.
bool has_regions(const std::string& path) {
  return path.starts_with("polyfem_cubes_mm") || path.starts_with("cleaver");
}

TEST_P(RealMeshes, RegionsKeepTheirVolumesWhenTheSurfaceMayChange) {
  if (!has_regions(GetParam().path)) GTEST_SKIP() << "one region only";
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = io::assemble(io::read_mesh(path_));
    const CheckResult broken_before = check(mesh);
    ImproveOptions options;
    options.surface.mode = mode;
    Result result;
    try {
      result = improve(mesh, options);
    } catch (const InvalidInput& error) {
      GTEST_SKIP() << error.what();  // a build without OpenMesh
    }
    EXPECT_EQ(check(mesh), broken_before.rule) << check(mesh);
    const auto before = region_volumes(result.before);
    const auto after = region_volumes(result.after);
    ASSERT_EQ(after.size(), before.size());
    const double bound = mode == SurfaceMode::kFlat ? 1e-12 : 1e-3;
    for (const auto& [region, volume] : before)
      EXPECT_NEAR(after.at(region), volume, bound * std::abs(result.before.enclosed_volume))
          << "region " << region << (mode == SurfaceMode::kFlat ? ", flat" : ", free");
    EXPECT_GE(result.after.min_dihedral.min, result.before.min_dihedral.min);
  }
}

TEST_P(RealMeshes, EveryFormatGivesTheSameMeshBack) {
  const io::MeshData data = io::disassemble(io::assemble(io::read_mesh(path_)));
  for (const std::string& extension : io::writable_extensions()) {
    if (extension == ".stl" || extension == ".obj" || extension == ".off" || extension == ".ply") continue;
    for (bool binary : {false, true}) {
      SCOPED_TRACE(extension + (binary ? " binary" : ""));
      io::WriteOptions options;
      options.binary = binary;
      const fs::path file = folder_ / ("mesh" + extension);
      io::write_mesh(file, data, options);
      const io::MeshData back = io::disassemble(io::assemble(io::read_mesh(file)));
      ASSERT_EQ(back.points.size(), data.points.size());
      EXPECT_TRUE(std::equal(data.points.begin(), data.points.end(), back.points.begin(),
                             [](Vec3 a, Vec3 b) { return bits(a) == bits(b); }));
      EXPECT_EQ(back.cells, data.cells);
      EXPECT_EQ(back.regions, data.regions);
      EXPECT_EQ(back.triangles.size(), data.triangles.size());
      EXPECT_EQ(back.triangle_labels, data.triangle_labels);
    }
  }
}

/// The last pass, which brings the volume back, must not lower an angle for the sake of an obtuse one.
TEST(RealMeshesGoal, ThatIsSaidToBeReachedOnACurvedSurfaceIs) {
  const fs::path path = fs::path(HFR_TEST_MESHES) / "gaia_frog_reg" / "frog_reg.mesh";
  if (!fs::exists(path)) GTEST_SKIP() << "there is no " << path.string() << "; real meshes are not shipped";
  TetMesh mesh = io::assemble(io::read_mesh(path));
  ImproveOptions options;
  options.surface.mode = SurfaceMode::kFree;
  options.min_dihedral = 15;
  Result result;
  try {
    result = improve(mesh, options);
  } catch (const InvalidInput& error) {
    GTEST_SKIP() << error.what();  // a build without OpenMesh
  }
  EXPECT_TRUE(result.goal_reached);
  EXPECT_GE(result.after.min_dihedral.min, 15 - 1e-9);
  EXPECT_LT(std::abs(result.surface.volume_change), 1e-3);
}

/// A surface that may move comes to go through itself there, after which cells may have a face twice.
TEST(RealMeshesSurface, ThatComesToGoThroughItselfIsNoFault) {
  const fs::path path = fs::path(HFR_TEST_MESHES) / "gaia_frog_reg" / "frog_reg.mesh";
  if (!fs::exists(path)) GTEST_SKIP() << "there is no " << path.string() << "; real meshes are not shipped";
  TetMesh mesh = io::assemble(io::read_mesh(path));
  ImproveOptions options;
  options.surface.mode = SurfaceMode::kFree;
  options.surface.hausdorff = 0.006261749224338197;
  try {
    improve(mesh, options);  // throws InternalError where a rule was broken
  } catch (const InvalidInput& error) {
    GTEST_SKIP() << error.what();  // a build without OpenMesh
  }
  const CheckResult found = check(mesh, {.last = Rule::kDuplicateEdge});
  EXPECT_TRUE(found) << found.message;
}

// A little less than what the default run reaches with the surface frozen: it must not fall back.
constexpr RealMesh kMeshes[] = {{"cavity/cavity20k.mesh", 18.5},
                                {"cavity/cavity607k_tetgen.mesh", 20},
                                {"cleaver_segmentation/output.node", 11},
                                {"cleaver_short/output.node", 0.5},
                                {"gaia_alligator/alligator.vtk", 0.05},
                                {"gaia_dog/dog.mesh", 0.7},
                                {"gaia_frog_reg/frog_reg.mesh", 0.2},
                                {"gaia_octopus30k/octopus_30K.1.node", 1.3},
                                {"ipc_armadillo13k/Armadillo13K.msh", 4.4},
                                {"ipc_dolphin5k/dolphin5K.msh", 0.8},
                                {"ipc_hollowcat/hollowCat7.5K.msh", 2.0},
                                {"ipc_rod300x33/rod300x33.msh", 23},
                                {"polyfem_cubes_mm/cubes_v22.msh", 10.7},
                                {"polyfem_large_angle7/large_angle_7.msh", 0.44},
                                {"polyfem_microstructure/P1.msh", 9},
                                {"polyfem_screw/screw.msh", 0.01},
                                {"random50k/random50k.mesh", 24},
                                {"stellar_house2/house2.node", 17},
                                {"tangled/bad2.mesh", 30},
                                {"tangled/j0.6.mesh", 25},
                                {"tangled/j1.0.mesh", 23}};

std::string test_name(const testing::TestParamInfo<RealMesh>& mesh) {
  std::string name = mesh.param.path;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, RealMeshes, testing::ValuesIn(kMeshes), test_name);

}  // namespace
}  // namespace hfr
