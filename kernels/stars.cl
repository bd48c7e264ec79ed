// SPDX-License-Identifier: BSD-3-Clause
// The stars of the vertices that a pass moves (Scheduler/StarTable.cc), and their colours (VertexColours.cc):
// first-fit in the order of the vertices, level by level. A vertex gets its colour as soon as all its
// neighbours of smaller number have theirs, so the colours are those of the serial loop.
#include "common.cl"

#define NO_COLOUR HFR_MAX_COLOURS

// Vertices of the listed cells that may move.
KERNEL void mark_vertices(__global const cell_t* cells, __global const uint* cell_list,
                          __global const uint* counters, __global const uchar* frozen,
                          __global uchar* marked) {
  FOR_EACH(i, counters[HFR_LISTED]) {
    for (int k = 0; k < 4; ++k) {
      const uint v = cells[cell_list[i]].v[k];
      if (!frozen[v]) marked[v] = 1;
    }
  }
}

// number[v]: place of v among the vertices. begin[i]: size of its star; the next step makes offsets of it.
KERNEL void number_vertices(__global const uint* vertices, __global const uint* star_size,
                            __global uint* counters, __global uint* number, __global uint* begin,
                            __global uint* cursor) {
  uint n_big = 0;
  FOR_EACH(i, counters[HFR_VERTICES]) {
    const uint v = vertices[i];
    number[v] = i;
    begin[i] = star_size[v];
    cursor[i] = 0;
    n_big += star_size[v] > HFR_MAX_STAR;
  }
  if (n_big) atomic_add(&counters[HFR_BIG_STARS], n_big);
}

// sum_parts and scan_parts with the number of items on the device.
KERNEL void sum_begins(__global const uint* begin, __global const uint* counters, __global uint* sums) {
  __local uint tile[HFR_LOCAL];
  const uint n = counters[HFR_VERTICES];
  uint sum = 0;
  FOR_PART(i, n, valid) {
    uint total;
    scan_tile(tile, valid ? begin[i] : 0, &total);
    sum += total;
  }
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

KERNEL void scan_begins(__global uint* begin, __global const uint* counters, __global const uint* sums) {
  __local uint tile[HFR_LOCAL];
  const uint n = counters[HFR_VERTICES];
  uint at = sums[get_group_id(0)];
  FOR_PART(i, n, valid) {
    const uint value = valid ? begin[i] : 0;
    uint total;
    const uint before = scan_tile(tile, value, &total);
    if (valid) begin[i] = at + before;
    at += total;
  }
}

// Half-faces opposite the vertices, in any order within a star.
KERNEL void gather_links(__global const cell_t* cells, uint n_cells, __global const uint* number,
                         __global const uint* begin, __global uint* cursor, __global uint* links) {
  FOR_EACH(c, n_cells) {
    if (cells[c].v[0] == INVALID) continue;
    for (uint k = 0; k < 4; ++k) {
      const uint i = number[cells[c].v[k]];
      if (i != INVALID) links[begin[i] + atomic_inc(&cursor[i])] = 4 * c + k;
    }
  }
}

// Sorts every star, and counts for every vertex the corners of its cells that hold a vertex of smaller
// number. Those with none begin the colouring. Nothing of it where a star is too large to be smoothed here.
KERNEL void prepare_colours(__global const cell_t* cells, __global const uint* vertices,
                            __global const uint* number, __global const uint* begin,
                            __global const uint* star_size, __global uint* counters, __global uint* links,
                            __global uint* waits, __global uint* level) {
  if (counters[HFR_BIG_STARS] > 0) return;
  FOR_EACH(i, counters[HFR_VERTICES]) {
    __global uint* link = links + begin[i];
    const uint v = vertices[i];
    const uint n = star_size[v];
    uint n_before = 0;
    for (uint k = 0; k < n; ++k) {
      const uint moving = link[k];
      uint at = k;
      for (; at > 0 && moving < link[at - 1]; --at) link[at] = link[at - 1];
      link[at] = moving;
      for (uint j = 0; j < 4; ++j) {
        const uint u = cells[moving / 4].v[j];
        n_before += u < v && number[u] != INVALID;
      }
    }
    waits[i] = n_before;
    if (n_before == 0) level[atomic_inc(&counters[HFR_LEVEL])] = i;
  }
}

// Work-items that share a vertex in colour_level(): a level has a few hundred vertices, and what takes time
// is waiting for the cells of a star, so they are read side by side.
#if HFR_LOCAL < 32
#define TEAM 1
#else
#define TEAM 32
#endif
#define TEAMS (HFR_LOCAL / TEAM)

// Colours the vertices of one level and finds those of the next.
KERNEL void colour_level(__global const cell_t* cells, __global const uint* vertices,
                         __global const uint* number, __global const uint* begin,
                         __global const uint* star_size, __global const uint* links, uint step,
                         __global const uint* level, __global uint* next_level, __global uint* counters,
                         __global uint* waits, __global uchar* colours) {
  // Colours that the neighbours of a team's vertex have: a bit each, in two words because OpenCL 1.2 has no
  // atomic_or of 64 bits.
  __local uint low[TEAMS];
  __local uint high[TEAMS];
  const uint team = (uint)get_local_id(0) / TEAM;
  const uint lane = (uint)get_local_id(0) % TEAM;
  const uint n_level = counters[HFR_LEVEL + step % 3];
  if (get_global_id(0) == 0) counters[HFR_LEVEL + (step + 2) % 3] = 0;
  uint n_done = 0;
  for (uint at = (uint)get_group_id(0) * TEAMS; at < n_level; at += (uint)get_num_groups(0) * TEAMS) {
    const uint has_vertex = at + team < n_level;
    const uint i = has_vertex ? level[at + team] : 0;
    const uint v = vertices[i];
    __global const uint* link = links + begin[i];
    const uint n = has_vertex ? star_size[v] : 0;
    if (lane == 0) low[team] = high[team] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    ulong seen = 0;
    for (uint k = lane; k < n; k += TEAM) {
      for (uint j = 0; j < 4; ++j) {
        const uint u = cells[link[k] / 4].v[j];
        if (u != v) seen |= 1UL << colours[u];
      }
    }
    atomic_or(&low[team], (uint)seen);
    atomic_or(&high[team], (uint)(seen >> 32));
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane == 0 && has_vertex) {
      const ulong used = ((ulong)high[team] << 32 | low[team]) & ~(1UL << NO_COLOUR);
      uint first = 0;
      while (used >> first & 1) ++first;
      colours[v] = (uchar)first;
      atomic_inc(&counters[HFR_COLOUR_SIZE + first]);
      ++n_done;
    }
    for (uint k = lane; k < n; k += TEAM) {
      for (uint j = 0; j < 4; ++j) {
        const uint u = cells[link[k] / 4].v[j];
        if (u <= v || number[u] == INVALID) continue;
        if (atomic_dec(&waits[number[u]]) == 1)
          next_level[atomic_inc(&counters[HFR_LEVEL + (step + 1) % 3])] = number[u];
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (n_done) atomic_add(&counters[HFR_COLOURED], n_done);
}

// Where each colour begins among `grouped`, then its vertices in any order.
KERNEL void begin_colours(__global const uint* counters, __global uint* colour_begin,
                          __global uint* colour_cursor) {
  if (get_global_id(0) != 0) return;
  uint sum = 0;
  for (uint c = 0; c <= HFR_MAX_COLOURS; ++c) {
    colour_begin[c] = colour_cursor[c] = sum;
    sum += counters[HFR_COLOUR_SIZE + c];
  }
}

KERNEL void group_colours(__global const uint* vertices, __global const uchar* colours,
                          __global const uint* counters, __global uint* colour_cursor,
                          __global uint* grouped) {
  FOR_EACH(i, counters[HFR_VERTICES]) { grouped[atomic_inc(&colour_cursor[colours[vertices[i]]])] = i; }
}
