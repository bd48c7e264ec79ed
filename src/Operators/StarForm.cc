// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/StarForm.hh"

#include <algorithm>
#include <numeric>

#include "Quality/Vectors.hh"

namespace hfr {
namespace {

using Block = StarForm::Block;
using Trials = StarForm::Trials;
constexpr std::size_t kBlock = StarForm::kBlock;

HFR_FN hfr_star_cell cell_at(const Block& k, std::size_t i) {
  hfr_star_cell cell;
  cell.normal = {k.normal_x[i], k.normal_y[i], k.normal_z[i]};
  cell.det = k.det[i];
  cell.sum = {k.sum_x[i], k.sum_y[i], k.sum_z[i]};
  cell.sum2 = k.sum2[i];
  return cell;
}

/// Corners of a few link faces, relative to the vertex.
struct Faces {
  alignas(64) double x[3][kBlock];
  double y[3][kBlock];
  double z[3][kBlock];
};

HFR_FN void make_block(const Faces* f, Block* k) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const hfr_star_cell cell =
        hfr_make_star_cell({f->x[0][i], f->y[0][i], f->z[0][i]}, {f->x[1][i], f->y[1][i], f->z[1][i]},
                           {f->x[2][i], f->y[2][i], f->z[2][i]});
    k->normal_x[i] = cell.normal.x;
    k->normal_y[i] = cell.normal.y;
    k->normal_z[i] = cell.normal.z;
    k->det[i] = cell.det;
    k->sum_x[i] = cell.sum.x;
    k->sum_y[i] = cell.sum.y;
    k->sum_z[i] = cell.sum.z;
    k->sum2[i] = cell.sum2;
  }
}

/// The cells in the given order. Returns how many were asked until no place was better than floor, or n + 1.
HFR_FN std::size_t lower_all(const Block* blocks, const std::uint32_t* order, std::size_t n, const Trials* x,
                             const Trials* y, const Trials* z, double floor, Trials* out) {
  const Trials px = *x, py = *y, pz = *z;  // of our own, so that nothing written can alias them
  Trials worst;
  worst.fill(HFR_INFINITY);
  std::size_t asked = 0;
  int better = 1;
  while (asked < n && better > 0) {
    const std::size_t i = order[asked++];
    const hfr_star_cell cell = cell_at(blocks[i / kBlock], i % kBlock);
    Trials q;
    for (std::size_t t = 0; t < StarForm::kTrials; ++t) q[t] = hfr_star_decision(cell, {px[t], py[t], pz[t]});
    better = 0;
    for (std::size_t t = 0; t < StarForm::kTrials; ++t) {
      worst[t] = hfr_min(q[t], worst[t]);
      better += worst[t] > floor ? 1 : 0;
    }
  }
  *out = worst;
  return better > 0 ? n + 1 : asked;
}

HFR_FN double largest(const Block* blocks, std::size_t n, const hfr_real3* x, double ceiling) {
  double top[kBlock] = {};
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t i = 0; i < kBlock; ++i) top[i] = hfr_max(hfr_star_m(cell_at(blocks[b], i), *x), top[i]);
    double all = 0;
    for (std::size_t i = 0; i < kBlock; ++i) all = hfr_max(top[i], all);
    if (!(all < ceiling)) return all;
  }
  double all = 0;
  for (std::size_t i = 0; i < kBlock; ++i) all = hfr_max(top[i], all);
  return all;
}

/// Shares of a block of cells, one row an entry of hfr_newton_share.
HFR_FN void sum_shares(const Block* blocks, std::size_t n, const hfr_real3* x, double m_max,
                       hfr_newton_share* out) {
  hfr_newton_share sum = hfr_newton_zero();
  for (std::size_t first = 0; first < n; first += kBlock) {
    alignas(64) double row[9][kBlock];
    for (std::size_t i = 0; i < kBlock; ++i) {
      const hfr_newton_share share = hfr_star_newton(cell_at(blocks[first / kBlock], i), *x, m_max);
      row[0][i] = share.gradient.x;
      row[1][i] = share.gradient.y;
      row[2][i] = share.gradient.z;
      row[3][i] = share.xx;
      row[4][i] = share.xy;
      row[5][i] = share.xz;
      row[6][i] = share.yy;
      row[7][i] = share.yz;
      row[8][i] = share.zz;
    }
    const std::size_t end = n - first < kBlock ? n - first : kBlock;
    for (std::size_t i = 0; i < end; ++i) {
      const hfr_newton_share share = {{row[0][i], row[1][i], row[2][i]},
                                      row[3][i],
                                      row[4][i],
                                      row[5][i],
                                      row[6][i],
                                      row[7][i],
                                      row[8][i]};
      sum = hfr_newton_sum(sum, share);
    }
  }
  *out = sum;
}

}  // namespace

StarForm::StarForm(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link)
    : size_(link.size()), blocks_(n_blocks()) {
  const Vec3 origin = mesh.point(v);
  Faces faces;
  for (std::size_t i = 0; i < n_blocks() * kBlock; ++i) {
    const auto f = mesh.halfface_vertices(link[i < size_ ? i : size_ - 1]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = mesh.point(f[k]) - origin;
      faces.x[k][i % kBlock] = p.x;
      faces.y[k][i % kBlock] = p.y;
      faces.z[k][i % kBlock] = p.z;
    }
    if (i % kBlock == kBlock - 1) with_widest_vectors<make_block>(&faces, &blocks_[i / kBlock]);
  }
}

hfr_star_cell StarForm::cell(std::size_t i) const { return cell_at(blocks_[i / kBlock], i % kBlock); }

void StarForm::worst(const Trials& x, const Trials& y, const Trials& z, double floor, Trials& worst) {
  if (n_ordered_ != size_) {
    order_.reserve(size_);
    std::iota(order_.data(), order_.data() + size_, 0U);
    n_ordered_ = size_;
  }
  const std::size_t asked =
      with_widest_vectors<lower_all>(blocks_.data(), order_.data(), size_, &x, &y, &z, floor, &worst);
  if (asked <= size_) std::rotate(order_.data(), order_.data() + (asked - 1), order_.data() + asked);
}

double StarForm::largest_m(hfr_real3 x, double ceiling) const {
  return with_widest_vectors<largest>(blocks_.data(), n_blocks(), &x, ceiling);
}

hfr_newton_share StarForm::newton(hfr_real3 x, double m_max) const {
  hfr_newton_share sum;
  with_widest_vectors<sum_shares>(blocks_.data(), size_, &x, m_max, &sum);
  return sum;
}

}  // namespace hfr
