// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_DECISIONS_HH
#define HFR_QUALITY_DECISIONS_HH

#include <array>
#include <cstddef>
#include <limits>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Quality/Metrics.hh"

namespace hfr {

/// Decision value of MinDihedral below which nothing lies: for whoever has no run whose input's worst angle
/// it could be.
inline constexpr double kNoFloor = -std::numeric_limits<double>::infinity();

/// Coordinates of a few cells, gathered so that the compiler makes vector instructions of a kernel's formula.
struct CornerBlock {
  static constexpr std::size_t kSize = 32;
  using Lane = std::array<double, kSize>;
  std::array<Lane, 4> x{}, y{}, z{};  // by corner

  void set(std::size_t i, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const std::array<Vec3, 4> p = {a, b, c, d};
    for (std::size_t k = 0; k < 4; ++k) {
      x[k][i] = p[k].x;
      y[k][i] = p[k].y;
      z[k][i] = p[k].z;
    }
  }
};

/// Decision values of all cells of a block: the bits that the metric gives cell by cell, with
/// widest_vectors().
void block_decisions(const VolumeLength&, const CornerBlock& block, CornerBlock::Lane& out);
void block_decisions(const MinSine2&, const CornerBlock& block, CornerBlock::Lane& out);
void block_decisions(const MinDihedral&, const CornerBlock& block, CornerBlock::Lane& out);

template <class Metric>
concept HasBlockForm = requires(const Metric& metric, const CornerBlock& block, CornerBlock::Lane& out) {
  block_decisions(metric, block, out);
};

/// visit(first, values, n) for the cell slots in [begin, end), at most CornerBlock::kSize of them at a time,
/// ascending: those from `first` on, of which the first n values are; +infinity for deleted ones, and behind
/// the last.
template <class Metric, class Visit>
requires HasBlockForm<Metric>
void for_decision_blocks(const TetMesh& mesh, const Metric& metric, std::size_t begin, std::size_t end,
                         Visit&& visit) {
  constexpr double kNoCell = std::numeric_limits<double>::infinity();
  CornerBlock block;
  CornerBlock::Lane values{};
  for (std::size_t first = begin; first < end; first += CornerBlock::kSize) {
    const std::size_t n = end - first < CornerBlock::kSize ? end - first : CornerBlock::kSize;
    bool some_deleted = false;
    for (std::size_t i = 0; i < n; ++i) {
      const auto& v = mesh.cell(CellHandle(first + i)).v;
      if (v[0].is_valid())
        block.set(i, mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
      else
        some_deleted = true;
    }
    block_decisions(metric, block, values);
    if (some_deleted)
      for (std::size_t i = 0; i < n; ++i)
        if (mesh.is_deleted(CellHandle(first + i))) values[i] = kNoCell;
    for (std::size_t i = n; i < CornerBlock::kSize; ++i) values[i] = kNoCell;
    visit(first, values, n);
  }
}

/// visit(i, decision value) for the cell slots i in [begin, end), ascending; +infinity for deleted ones.
template <class Metric, class Visit>
void for_decisions(const TetMesh& mesh, const Metric& metric, std::size_t begin, std::size_t end,
                   Visit&& visit) {
  if constexpr (HasBlockForm<Metric>) {
    for_decision_blocks(mesh, metric, begin, end,
                        [&](std::size_t first, const CornerBlock::Lane& values, std::size_t n) {
                          for (std::size_t i = 0; i < n; ++i) visit(first + i, values[i]);
                        });
  } else {
    constexpr double kDeleted = std::numeric_limits<double>::infinity();
    for (std::size_t i = begin; i < end; ++i) {
      const auto& v = mesh.cell(CellHandle(i)).v;
      visit(i, mesh.is_deleted(CellHandle(i))
                   ? kDeleted
                   : metric(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])));
    }
  }
}

}  // namespace hfr

#endif
