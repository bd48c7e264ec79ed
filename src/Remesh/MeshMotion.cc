// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MeshMotion.hh"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <array>
#include <cstddef>

#include "Transfer/SharedVolume.hh"

namespace hfr {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Eigen::Index>;  // 144 entries a cell
using Vector = Eigen::VectorXd;
constexpr double kTolerance = 1e-8;

/// Gradients of the four linear functions of a cell, times six times its volume.
std::array<Vec3, 4> gradients(const TetPoints& t) {
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  const Vec3 ga = cross(b, c), gb = cross(c, a), gc = cross(a, b);
  return {-(ga + gb + gc), ga, gb, gc};
}

/// A matrix in the unknown vertices, and what it makes of the known ones as a right-hand side. With `n`
/// components at each vertex.
class System {
 public:
  System(const TetMesh& mesh, std::span<const std::uint8_t> known, std::size_t n) : n_(n) {
    row_.assign(mesh.n_vertices(), -1);
    for (VertexHandle v : mesh.vertices())
      if (!known[v.idx()] && mesh.incident_cell(v).is_valid())
        row_[v.idx()] = static_cast<Eigen::Index>(vertices_.size()), vertices_.push_back(v);
    rhs_ = Vector::Zero(size());
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(vertices_.size() * n_); }

  /// Component i at vertex v and component j at w.
  void add(VertexHandle v, std::size_t i, VertexHandle w, std::size_t j, double value, double known_at_w) {
    if (row_[v.idx()] < 0) return;
    const Eigen::Index r = row_[v.idx()] * static_cast<Eigen::Index>(n_) + static_cast<Eigen::Index>(i);
    if (row_[w.idx()] < 0)
      rhs_[r] -= value * known_at_w;
    else
      entries_.emplace_back(r, row_[w.idx()] * static_cast<Eigen::Index>(n_) + static_cast<Eigen::Index>(j),
                            value);
  }
  void reserve(std::size_t n) { entries_.reserve(n); }

  /// Empty where nothing is unknown. A row without entries, of a vertex of flat cells only, has 0.
  Vector solve() const {
    if (vertices_.empty()) return {};
    Matrix matrix(size(), size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;
    solver.setTolerance(kTolerance);
    solver.compute(matrix);
    return solver.solve(rhs_);
  }
  const std::vector<VertexHandle>& vertices() const { return vertices_; }

 private:
  std::size_t n_;
  std::vector<Eigen::Index> row_;  // of the first component; -1: known
  std::vector<VertexHandle> vertices_;
  std::vector<Eigen::Triplet<double, Eigen::Index>> entries_;
  Vector rhs_;
};

/// Calls add(vertices, gradients times 6 volumes, stiffness) for each cell of positive volume.
template <class Add>
void for_stiff_cells(const TetMesh& mesh, Add&& add) {
  for (CellHandle c : mesh.cells()) {
    const TetPoints t = points_of(mesh, c);
    const double v6 = volume6(t);
    if (v6 > 0) add(mesh.cell_vertices(c), gradients(t), 1 / (v6 * v6));
  }
}

void follow_laplace(const TetMesh& mesh, std::span<const std::uint8_t> known, int axis,
                    std::vector<Vec3>& displacement) {
  System system(mesh, known, 1);
  system.reserve(16 * mesh.n_logical_cells());
  for_stiff_cells(mesh, [&](const auto& v, const auto& g, double stiffness) {
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        system.add(v[i], 0, v[j], 0, dot(g[i], g[j]) * stiffness, displacement[v[j].idx()][axis]);
  });
  const Vector x = system.solve();
  for (std::size_t i = 0; i < system.vertices().size(); ++i)
    displacement[system.vertices()[i].idx()][axis] = x[static_cast<Eigen::Index>(i)];
}

void follow_elastic(const TetMesh& mesh, std::span<const std::uint8_t> known,
                    std::vector<Vec3>& displacement) {
  constexpr double kLambda = 1.5;  // of mu, at a Poisson's ratio of 0.3
  System system(mesh, known, 3);
  system.reserve(144 * mesh.n_logical_cells());
  for_stiff_cells(mesh, [&](const auto& v, const auto& g, double stiffness) {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        const double both = dot(g[a], g[b]);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            system.add(v[a], static_cast<std::size_t>(i), v[b], static_cast<std::size_t>(j),
                       stiffness * (kLambda * g[a][i] * g[b][j] + g[a][j] * g[b][i] + (i == j ? both : 0.0)),
                       displacement[v[b].idx()][j]);
      }
  });
  const Vector x = system.solve();
  for (std::size_t i = 0; i < system.vertices().size(); ++i)
    for (int k = 0; k < 3; ++k)
      displacement[system.vertices()[i].idx()][k] = x[3 * static_cast<Eigen::Index>(i) + k];
}

}  // namespace

void follow(const TetMesh& mesh, std::span<const std::uint8_t> known, bool elastic,
            std::vector<Vec3>& displacement) {
  for (VertexHandle v : mesh.vertices())
    if (!known[v.idx()]) displacement[v.idx()] = {};
  if (elastic) return follow_elastic(mesh, known, displacement);
  for (int axis = 0; axis < 3; ++axis) follow_laplace(mesh, known, axis, displacement);
}

}  // namespace hfr
