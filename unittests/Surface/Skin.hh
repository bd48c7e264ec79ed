// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_SURFACE_SKIN_HH
#define HFR_UNITTESTS_SURFACE_SKIN_HH

#include "HalfFace/Check.hh"
#include "Operators/Metrics.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {

inline SurfaceOptions mode(SurfaceMode m) {
  SurfaceOptions options;
  options.mode = m;
  return options;
}

/// A box whose vertices are jittered within its facets and along its edges, too.
inline TetMesh jittered_skin(Index n, double jitter, std::uint64_t seed) {
  TetMesh mesh = jittered(n, jitter, seed);
  Engine engine(seed);
  for (VertexHandle v : mesh.vertices()) {
    Vec3 p = mesh.point(v);
    for (int d = 0; d < 3; ++d) {
      const double step = jitter / static_cast<double>(n) * uniform(engine, -1, 1);
      if (mesh.is_boundary(v) && p[d] != 0 && p[d] != 1) p[d] += step;
    }
    mesh.set_point(v, p);
  }
  return mesh;
}

/// Any cell with the edge; a surface edge is named by two vertices, since cells come and go.
inline EdgeHandle seed_of(const TetMesh& mesh, VertexHandle a, VertexHandle b) {
  return mesh.find_edge(a, b);
}

}  // namespace hfr::test

#endif
