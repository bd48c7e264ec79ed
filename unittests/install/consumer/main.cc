// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>
#include <hfremesh/HalfFace/TetMesh.hh>
#include <hfremesh/IO/MeshFile.hh>
#include <vector>

#if __has_include(<IO/MeshFile.hh>) || __has_include(<HalfFace/TetMesh.hh>) || __has_include(<kernels/base.h>)
#error "folders of hfremesh lie in the include path of its users"
#endif

/// Two cells that share a face: a first look at the half-faces, and one call into what links the most
/// libraries.
int main() {
  const std::vector<hfr::Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const std::vector<std::array<hfr::Index, 4>> cells = {{0, 1, 2, 3}, {4, 1, 3, 2}};
  const hfr::TetMesh mesh = hfr::build(points, cells);

  int shared = 0;
  for (int h = 0; h < 8; ++h)
    if (mesh.opposite_halfface(hfr::HalfFaceHandle(h)).is_valid()) ++shared;
  const std::size_t n_formats = hfr::io::writable_extensions().size();

  std::printf("hfremesh %s: %zu cells, %d half-faces with a mate, %zu formats\n", HFR_VERSION,
              static_cast<std::size_t>(mesh.n_cells()), shared, n_formats);
  return mesh.n_cells() == 2 && shared == 2 && n_formats > 0 ? 0 : 1;
}
