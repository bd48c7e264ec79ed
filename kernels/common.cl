// SPDX-License-Identifier: BSD-3-Clause
// What all device code shares. OpenCL C 1.2. The host defines HFR_LOCAL, the size of every work-group: 1 on a
// CPU, where a group then goes through one contiguous part of the items, and a multiple of 32 elsewhere,
// where neighbouring work-items take neighbouring items.
#ifndef HFR_COMMON_CL
#define HFR_COMMON_CL

#include "counters.h"
#include "dihedral.h"
#include "klincsek.h"
#include "priority.h"
#include "star_volume_length.h"
#include "volume_length.h"

#ifndef HFR_LOCAL
#define HFR_LOCAL 64
#endif

#define KERNEL __kernel __attribute__((reqd_work_group_size(HFR_LOCAL, 1, 1)))
#define INVALID 0xffffffffu
#define UNCLAIMED 0xffffffffu

// One tetrahedron as HalfFace/TetMesh.hh has it.
typedef struct {
  uint v[4];
  uint mate[4];
} cell_t;

__constant uchar kFaceCorners[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
__constant uchar kEdgeCorners[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
__constant uchar kEdgeOpposite[6][2] = {{2, 3}, {3, 1}, {1, 2}, {0, 3}, {2, 0}, {0, 1}};

// Items of a group when n items are cut into even, contiguous parts.
static uint part_begin(uint n, uint group) {
  const uint groups = (uint)get_num_groups(0);
  return n / groups * group + min(n % groups, group);
}

// FOR_EACH(i, n) { … }: every i in [0, n) once, over all work-items.
#if HFR_LOCAL == 1
#define FOR_EACH(i, n)                                            \
  for (uint i = part_begin((n), (uint)get_group_id(0)),           \
            i##_end = part_begin((n), (uint)get_group_id(0) + 1); \
       i < i##_end; ++i)
#else
#define FOR_EACH(i, n) for (uint i = (uint)get_global_id(0); i < (n); i += (uint)get_global_size(0))
#endif

// FOR_PART(i, n, valid) { … }: the contiguous part of the work-group, tile by tile; every work-item takes
// part in every tile, with valid == 0 where it has no item, so that the body may hold barriers.
#define FOR_PART(i, n, valid)                                                                           \
  for (uint i##_tile = part_begin((n), (uint)get_group_id(0)),                                          \
            i##_end = part_begin((n), (uint)get_group_id(0) + 1), i = i##_tile + (uint)get_local_id(0), \
            valid = i < i##_end;                                                                        \
       i##_tile < i##_end; i##_tile += HFR_LOCAL, i += HFR_LOCAL, valid = i < i##_end)

// Sum of `value` over the work-items before this one; *total gets that of all.
static uint scan_tile(__local uint* tile, uint value, uint* total) {
#if HFR_LOCAL == 1
  *total = value;
  return 0;
#else
  const uint t = (uint)get_local_id(0);
  tile[t] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint d = 1; d < HFR_LOCAL; d <<= 1) {
    const uint add = t >= d ? tile[t - d] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    tile[t] += add;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const uint before = tile[t] - value;
  *total = tile[HFR_LOCAL - 1];
  barrier(CLK_LOCAL_MEM_FENCE);
  return before;
#endif
}

static hfr_real3 point_of(__global const double* points, uint v) {
  return hfr_make3(points[3 * (size_t)v], points[3 * (size_t)v + 1], points[3 * (size_t)v + 2]);
}

static double decision_of(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_volume_length_decision(a, b, c, d);
}

// Corner of a vertex that the cell has.
static uint own_corner(__global const cell_t* cell, uint w) {
  return (uint)(cell->v[1] == w) + 2 * (uint)(cell->v[2] == w) + 3 * (uint)(cell->v[3] == w);
}

#endif
