// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_GENERATE_HH
#define HFR_HALFFACE_GENERATE_HH

#include <array>
#include <cstdint>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"

/// Meshes of simple shapes as plain arrays, ready for build(): for tests, benchmarks and first steps. Every
/// call with the same arguments gives the same bits on one system; exp and sin of the C library take part in
/// some, so another C library may differ in the last one. Cells are positive unless a jitter, twist or
/// deformation is too large. Throws InvalidInput for arguments out of range, ResourceLimit for more cells
/// than an index can count.
namespace hfr::generate {

struct Arrays {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;
  std::vector<int> regions;  ///< per cell, or empty when all are of one region
};

/// Number of grid cubes along x, y and z; each is at least 1.
using Counts = std::array<Index, 3>;

/// Number `index` of the splitmix64 sequence of `seed`, as a double in [0, 1) with 53 random bits.
double random_unit(std::uint64_t seed, std::uint64_t index);

/// Corners of the six cells of a cube as bits (x = 1, y = 2, z = 4).
inline constexpr std::array<std::array<unsigned, 4>, 6> kCubeCells = {
    {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 1, 7, 5}, {0, 4, 7, 6}, {0, 2, 7, 3}}};
/// Vertex `at` of jittered_box(), of which there may be more than an index can count.
Vec3 jittered_point(Counts counts, Counts at, double jitter, std::uint64_t seed, Vec3 low, Vec3 high);

/// A box of counts[0]×counts[1]×counts[2] cubes, each cut into 6 cells round its main diagonal (Kuhn's cut).
/// Vertex (i, j, k) has index (k(counts[1]+1) + j)(counts[0]+1) + i.
Arrays box(Counts counts, Vec3 low = {0, 0, 0}, Vec3 high = {1, 1, 1});

/// The box with every inner coordinate moved by jitter·h·(2r-1), h being the width of a cube in that
/// direction and r = random_unit(seed, 3·vertex + direction). Coordinates on the surface of the box stay on
/// it. Cells may invert from a jitter of about 0.25 on.
Arrays jittered_box(Counts counts, double jitter, std::uint64_t seed, Vec3 low = {0, 0, 0},
                    Vec3 high = {1, 1, 1});

/// The box with region 1 in the half of smaller x and region 2 in the other; at least two cubes along x.
Arrays two_region_box(Counts counts, Vec3 low = {0, 0, 0}, Vec3 high = {1, 1, 1});

/// How the unit cube of cavity() is deformed. Both fields vanish on its surface.
enum class CavityField {
  kGaussians,  ///< eight Gaussian pushes of alternating sign along the axes
  kBulkShear,  ///< the swirl (2 s²x·s2y·s2z, -s2x·s²y·s2z, -s2x·s2y·s²z) with s²x = sin²(πx), s2x = sin(2πx)
};

struct CavityOptions {
  Counts counts = {14, 15, 16};
  double jitter = 0.2385;
  double sigma = 0.12;         ///< width of the Gaussians
  double amplitude = 0.39529;  ///< 0 leaves the cube undeformed
  std::uint64_t seed = 2013;
  CavityField field = CavityField::kGaussians;
};

/// A jittered box of the unit cube, deformed inside until cells invert. The defaults give 20,160 cells of
/// which 48 are inverted.
Arrays cavity(const CavityOptions& options = {});

/// Moves a point of the unit cube as cavity() does; for meshes of other making.
Vec3 deform(Vec3 p, const CavityOptions& options);

/// A ball round the origin of 20·n³ cells: n geodesic shells of a cut icosahedron.
Arrays ball(Index n, double radius = 1);

/// An upright cylinder of 18·n_radial²·n_axial cells from z = 0 to height, with n_radial rings round the
/// axis. Cross sections are turned about the axis in proportion to z, the top by `twist` degrees. With
/// `wring` a point at distance r from the axis is also turned by wring·(r/radius)²·sin(its
/// angle)·sin(πz/height) degrees: from about 58 on the side folds over, near half the height, while top and
/// bottom stay.
Arrays cylinder(Index n_radial, Index n_axial, double radius = 1, double height = 2, double twist = 0,
                double wring = 0);

/// A part with what mechanical parts have: a quarter of a ring about the z axis, of radius 1 to 2, with a
/// step halfway round. Its eight faces are six planes (bottom z = 0, the two ends y = 0 and x = 0, the step x
/// = y, the low top z = 0.5 and the high top z = 1.3 - 0.15x, which is inclined) and two cylinders; they meet
/// in sharp edges, 12 of them straight and 6 curved, and in 12 corners. The counts are the grid cubes along
/// the radius, along each half of the arc and to each level; every cube of the three blocks is cut into 6
/// cells. Jitter moves the coordinates along these directions, in cube widths, but none out of a face, an
/// edge or a corner; numbers are drawn as for jittered_box(), grid vertex by grid vertex.
Arrays fandisk(Counts counts, double jitter = 0, std::uint64_t seed = 1);

/// Moves every vertex inside, each coordinate by jitter·l·(2r-1), l being the vertex's shortest edge and r
/// random_unit(seed, 3·vertex + axis). Vertices of the boundary stay.
void jitter_inner(Arrays& mesh, double jitter, std::uint64_t seed);

}  // namespace hfr::generate

#endif
