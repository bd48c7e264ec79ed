// SPDX-License-Identifier: BSD-3-Clause
// What PartSurface is made of: for PartSurface.cc (what there is) and PartSurfacePasses.cc (what is done).
#ifndef HFR_DISTRIBUTED_PART_SURFACE_IMPL_HH
#define HFR_DISTRIBUTED_PART_SURFACE_IMPL_HH

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "Distributed/PartSurface.hh"
#include "Surface/Features.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::mpi {

/// The surface of the whole: its vertices alone, in the order of their numbers.
struct WholeSurface {
  WholeSurface() = default;
  WholeSurface(WholeSurface&&) = default;  // and no copy, whose arrays would be of other points
  WholeSurface& operator=(WholeSurface&&) = default;

  std::vector<std::uint64_t> numbers;
  std::vector<Vec3> points;
  surface::Arrays arrays;  // of these points

  VertexHandle handle(std::uint64_t number) const {
    const auto at = std::ranges::lower_bound(numbers, number);
    return at == numbers.end() || *at != number
               ? VertexHandle()
               : VertexHandle(static_cast<std::size_t>(at - numbers.begin()));
  }
  std::vector<Triangle> triangles(bool of_boundary) const {
    std::vector<Triangle> all;
    for (std::size_t i = 0; i < arrays.faces.size(); ++i)
      if (!of_boundary || arrays.interface[i] == 0) all.push_back(surface::corners(points, arrays.faces[i]));
    return all;
  }
};

/// All take part.
WholeSurface gather(DistributedMesh& parts, const SurfaceOptions& options);

/// Of the vertices of a part or of a cutout.
template <class Mesh>
class NumbersOf : public VertexNumbers {
 public:
  explicit NumbersOf(const Mesh& mesh) : mesh_(mesh) {}
  std::uint64_t number(VertexHandle v) const override { return mesh_.number(v); }
  VertexHandle vertex_at(std::uint64_t number) const override { return mesh_.vertex_at(number); }

 private:
  const Mesh& mesh_;
};

/// The surface as a mesh sees it that has some of its vertices.
template <class Mesh>
class SurfaceOf {
 public:
  SurfaceOf(const SurfaceMesh& whole, const Mesh& mesh) : numbers_(mesh), seen_(whole.seen_from(numbers_)) {}
  SurfaceOf(const SurfaceOf&) = delete;
  SurfaceOf& operator=(const SurfaceOf&) = delete;
  SurfaceMesh& get() const { return *seen_; }

 private:
  NumbersOf<Mesh> numbers_;
  std::unique_ptr<SurfaceMesh> seen_;
};

struct PartSurface::Impl {
  DistributedMesh& parts;
  par::Policy policy;
  SurfaceOptions options;
  std::unique_ptr<SurfaceMesh> whole;
  std::optional<SurfaceOf<DistributedMesh>> seen;
  std::vector<std::uint64_t> looked_at;  // by kSwap: numbers of cells of the part, ascending

  explicit Impl(DistributedMesh& mesh) : parts(mesh) {}
  /// Brings the labels of the parts up to date with what the surface has been told.
  void write_labels();
};

}  // namespace hfr::mpi

#endif
