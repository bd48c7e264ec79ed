// SPDX-License-Identifier: BSD-3-Clause
// Ranking and selection of candidates, and the slots of what they make. A candidate is a key, a seed, and a
// piece of the arena: its cells first, then what the commit needs. Candidates are appended in any order; the
// order that counts is that of rank_sort, which is total.
#include "common.cl"

// Vertices that name the seed of a candidate, ascending, and INVALID for those that it has not: two of an
// edge, three of a face, one of a vertex.
typedef struct {
  uint v[3];
} identity_t;

static identity_t edge_identity(__global const cell_t* cells, uint seed) {
  const uint a = cells[seed / 6].v[kEdgeCorners[seed % 6][0]];
  const uint b = cells[seed / 6].v[kEdgeCorners[seed % 6][1]];
  identity_t id;
  id.v[0] = min(a, b);
  id.v[1] = max(a, b);
  id.v[2] = INVALID;
  return id;
}

static identity_t face_identity(__global const cell_t* cells, uint seed) {
  const uint a = cells[seed / 4].v[kFaceCorners[seed % 4][0]];
  const uint b = cells[seed / 4].v[kFaceCorners[seed % 4][1]];
  const uint c = cells[seed / 4].v[kFaceCorners[seed % 4][2]];
  identity_t id;
  id.v[0] = min(a, min(b, c));
  id.v[2] = max(a, max(b, c));
  id.v[1] = max(min(a, b), min(max(a, b), c));
  return id;
}

static identity_t vertex_identity(uint seed) {
  identity_t id;
  id.v[0] = seed;
  id.v[1] = INVALID;
  id.v[2] = INVALID;
  return id;
}

static identity_t identity_of(__global const cell_t* cells, uint seed, uint kind) {
  return kind == HFR_OF_EDGE   ? edge_identity(cells, seed)
         : kind == HFR_OF_FACE ? face_identity(cells, seed)
                               : vertex_identity(seed);
}

static ulong key_of(identity_t id, double old_worst, ulong salt) {
  return hfr_priority(as_ulong(old_worst), id.v[0], id.v[1], id.v[2], INVALID, salt);
}

// Counts keys by their first bits: bins[key >> shift].
KERNEL void rank_count(__global const ulong* keys, __global const uint* counters, uint capacity, uint shift,
                       __global uint* bins) {
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  FOR_EACH(i, n) { atomic_inc(&bins[keys[i] >> shift]); }
}

// Puts candidates into their bins, in any order within one. Afterwards bins[b] is where bin b ends.
KERNEL void rank_scatter(__global const ulong* keys, __global const uint* counters, uint capacity, uint shift,
                         __global uint* bins, __global uint* order) {
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  FOR_EACH(i, n) { order[atomic_inc(&bins[keys[i] >> shift])] = i; }
}

static int ranks_before(__global const cell_t* cells, __global const ulong* keys, __global const uint* seeds,
                        uint kind, uint i, uint j) {
  if (keys[i] != keys[j]) return keys[i] < keys[j];
  const identity_t a = identity_of(cells, seeds[i], kind);
  const identity_t b = identity_of(cells, seeds[j], kind);
  if (a.v[0] != b.v[0]) return a.v[0] < b.v[0];
  if (a.v[1] != b.v[1]) return a.v[1] < b.v[1];
  return a.v[2] < b.v[2];
}

// Sorts every bin by key, equal keys by identity: rank r belongs to candidate order[r].
KERNEL void rank_sort(__global const cell_t* cells, __global const ulong* keys, __global const uint* seeds,
                      uint kind, uint n_bins, __global const uint* bins, __global uint* order) {
  FOR_EACH(b, n_bins) {
    const uint begin = b == 0 ? 0 : bins[b - 1];
    const uint end = bins[b];
    for (uint i = begin + 1; i < end; ++i) {
      const uint moving = order[i];
      uint at = i;
      for (; at > begin && ranks_before(cells, keys, seeds, kind, moving, order[at - 1]); --at)
        order[at] = order[at - 1];
      order[at] = moving;
    }
  }
}

// The lock-free selection of Scheduler/Select.cc, in four steps: every undecided candidate lowers the claim
// of its cells to its rank; who holds all its cells has won; who meets a winner has lost, and gives its
// claims back. A step of repetition s has nothing to do unless counters[HFR_UNDECIDED + s] says so.
KERNEL void select_begin(__global uint* counters, uint capacity, __global uchar* won, __global uchar* lost) {
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  FOR_EACH(r, n) {
    won[r] = 0;
    lost[r] = 0;
  }
  if (get_global_id(0) == 0) counters[HFR_UNDECIDED] = n;
}

KERNEL void select_claim(__global const uint* counters, uint repetition, uint n, __global const uint* order,
                         __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                         __global const uchar* won, __global const uchar* lost, __global uint* claim) {
  if (counters[HFR_UNDECIDED + repetition] == 0) return;
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (won[r] || lost[r]) continue;
    const uint i = order[r];
    for (uint k = 0; k < (sizes[i] & 0xffff); ++k) atomic_min(&claim[arena[offsets[i] + k]], r);
  }
}

KERNEL void select_decide(__global const uint* counters, uint repetition, uint n, __global const uint* order,
                          __global const uint* offsets, __global const uint* sizes,
                          __global const uint* arena, __global uchar* won, __global const uchar* lost,
                          __global const uint* claim) {
  if (counters[HFR_UNDECIDED + repetition] == 0) return;
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (won[r] || lost[r]) continue;
    const uint i = order[r];
    uint holds = 1;
    for (uint k = 0; k < (sizes[i] & 0xffff) && holds; ++k) holds = claim[arena[offsets[i] + k]] == r;
    won[r] = (uchar)holds;
  }
}

// lost[r] becomes repetition + 1, so that the next step knows who has just lost.
KERNEL void select_lose(__global uint* counters, uint repetition, uint n, __global const uint* order,
                        __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                        __global const uchar* won, __global uchar* lost, __global const uint* claim) {
  if (counters[HFR_UNDECIDED + repetition] == 0) return;
  uint left = 0;
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (won[r] || lost[r]) continue;
    const uint i = order[r];
    uint meets = 0;
    for (uint k = 0; k < (sizes[i] & 0xffff) && !meets; ++k) {
      const uint holder = claim[arena[offsets[i] + k]];
      meets = holder != UNCLAIMED && won[holder];
    }
    if (meets)
      lost[r] = (uchar)(repetition + 1);
    else
      ++left;
  }
  if (left) atomic_add(&counters[HFR_UNDECIDED + repetition + 1], left);
}

KERNEL void select_release(__global const uint* counters, uint repetition, uint n, __global const uint* order,
                           __global const uint* offsets, __global const uint* sizes,
                           __global const uint* arena, __global const uchar* lost, __global uint* claim) {
  if (counters[HFR_UNDECIDED + repetition] == 0) return;
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (lost[r] != repetition + 1) continue;
    const uint i = order[r];
    for (uint k = 0; k < (sizes[i] & 0xffff); ++k)
      atomic_cmpxchg(&claim[arena[offsets[i] + k]], r, UNCLAIMED);
  }
}

// What the searches write to; more than fits is counted all the same, so that the host makes room and starts
// again.
#define SEARCH_ARGUMENTS                                                                                   \
  __global uint *counters, uint capacity, uint arena_capacity, __global ulong *keys, __global uint *seeds, \
      __global uint *offsets, __global uint *sizes, __global uint *arena
#define SEARCH_VALUES counters, capacity, arena_capacity, keys, seeds, offsets, sizes, arena

// Appends a candidate without its piece of the arena, which begins at the value that is returned; INVALID
// when there is no room.
static uint append_candidate(uint seed, identity_t id, double old_worst, ulong salt, uint n_removed,
                             uint n_created, uint n_words, SEARCH_ARGUMENTS) {
  const uint i = atomic_inc(&counters[HFR_CANDIDATES]);
  const uint at = atomic_add(&counters[HFR_ARENA], n_words);
  if (i >= capacity) return INVALID;
  const uint fits = at + n_words <= arena_capacity;
  keys[i] = key_of(id, old_worst, salt);
  seeds[i] = seed;
  offsets[i] = fits ? at : 0;
  sizes[i] = fits ? n_removed | n_created << 16 : 0;
  return fits ? at : INVALID;
}

// Cells of different regions do not become one cluster.
static uint in_one_region(const uint* scope, uint n, __global const uint* origin,
                          __global const int* regions) {
  uint one = 1;
  for (uint k = 1; k < n; ++k) one &= regions[origin[scope[k]]] == regions[origin[scope[0]]];
  return one;
}

static uint n_removed_of(uint size) { return size & 0xffff; }
static uint n_created_of(uint size) { return size >> 16; }

// By part of the ranks: winners, cells that they make beyond those they free, and the other way round.
KERNEL void slot_sums(__global const uint* counters, uint capacity, __global const uint* order,
                      __global const uint* sizes, __global const uchar* won, __global uint* sums) {
  __local uint tile[HFR_LOCAL];
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  const uint groups = (uint)get_num_groups(0);
  uint winners = 0, extra = 0, freed = 0;
  FOR_PART(r, n, valid) {
    const uint wins = valid ? won[r] : 0;
    const uint size = wins ? sizes[order[r]] : 0;
    uint total;
    scan_tile(tile, wins, &total);
    winners += total;
    scan_tile(tile, n_created_of(size) > n_removed_of(size) ? n_created_of(size) - n_removed_of(size) : 0,
              &total);
    extra += total;
    scan_tile(tile, n_removed_of(size) > n_created_of(size) ? n_removed_of(size) - n_created_of(size) : 0,
              &total);
    freed += total;
  }
  if (get_local_id(0) == 0) {
    sums[get_group_id(0)] = winners;
    sums[groups + get_group_id(0)] = extra;
    sums[2 * groups + get_group_id(0)] = freed;
  }
}

// Number of the first slot that a winner takes beyond its own cells, and of the first that it leaves.
KERNEL void slot_numbers(__global const uint* counters, uint capacity, __global const uint* order,
                         __global const uint* sizes, __global const uchar* won, __global const uint* sums,
                         __global uint* extra_at, __global uint* freed_at) {
  __local uint tile[HFR_LOCAL];
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  const uint groups = (uint)get_num_groups(0);
  uint extra = sums[groups + get_group_id(0)];
  uint freed = sums[2 * groups + get_group_id(0)];
  FOR_PART(r, n, valid) {
    const uint size = valid && won[r] ? sizes[order[r]] : 0;
    const uint more = n_created_of(size) > n_removed_of(size) ? n_created_of(size) - n_removed_of(size) : 0;
    const uint less = n_removed_of(size) > n_created_of(size) ? n_removed_of(size) - n_created_of(size) : 0;
    uint total;
    const uint before_extra = scan_tile(tile, more, &total);
    if (valid) extra_at[r] = extra + before_extra;
    extra += total;
    const uint before_freed = scan_tile(tile, less, &total);
    if (valid) freed_at[r] = freed + before_freed;
    freed += total;
  }
}

// Gives up winners that would free more cells than `may_lose`, the last in rank order first, and their
// claims: whoever does not fit any more. By one work-item: it is seldom that there are too many.
KERNEL void give_up_winners(__global const uint* counters, uint capacity, __global const uint* order,
                            __global const uint* offsets, __global const uint* sizes,
                            __global const uint* arena, uint may_lose, __global uchar* won,
                            __global uint* claim) {
  if (get_global_id(0) != 0) return;
  const uint n = min(counters[HFR_CANDIDATES], capacity);
  uint left = may_lose;
  for (uint r = 0; r < n; ++r) {
    if (!won[r]) continue;
    const uint i = order[r];
    const uint n_removed = n_removed_of(sizes[i]);
    const uint n_created = n_created_of(sizes[i]);
    const uint loss = n_removed > n_created ? n_removed - n_created : 0;
    if (loss <= left) {
      left -= loss;
      continue;
    }
    won[r] = 0;
    for (uint k = 0; k < n_removed; ++k) claim[arena[offsets[i] + k]] = UNCLAIMED;
  }
}

// Word by word: a copy of the whole is more than tools that watch what is initialised can follow.
static void store_cell(__global cell_t* to, const cell_t* from) {
  for (uint j = 0; j < 4; ++j) {
    to->v[j] = from->v[j];
    to->mate[j] = from->mate[j];
  }
}

// Slot of cell number k that a winner makes: its removed cells' first, then the free list from its back, then
// new ones.
static uint slot_of(uint k, uint n_removed, __global const uint* scope, uint extra_at,
                    __global const uint* free_cells, uint n_free, uint n_cells) {
  if (k < n_removed) return scope[k];
  const uint e = extra_at + (k - n_removed);
  return e < n_free ? free_cells[n_free - 1 - e] : n_cells + (e - n_free);
}

// Commit B and the first half of refresh: mates behind outer faces; qualities, stamps and incident cells of
// what was made. A neighbour that was itself replaced has noted in `moved` where its face is now.
KERNEL void commit_mates(__global const uint* counters, uint n, __global const uint* order,
                         __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                         __global const uchar* won, __global const uint* extra_at,
                         __global const uint* free_cells, uint n_free, uint n_cells,
                         __global const uint* claim, __global const uint* moved,
                         __global const double* points, uint clock, __global cell_t* cells,
                         __global double* quality, __global uchar* pending, __global uint* changed,
                         __global uint* incident_cells) {
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (!won[r]) continue;
    const uint i = order[r];
    __global const uint* scope = arena + offsets[i];
    const uint n_removed = n_removed_of(sizes[i]);
    const uint n_created = n_created_of(sizes[i]);
    for (uint k = 0; k < n_created; ++k) {
      const uint slot = slot_of(k, n_removed, scope, extra_at[r], free_cells, n_free, n_cells);
      hfr_real3 p[4];
      for (uint j = 0; j < 4; ++j) {
        const uint behind = cells[slot].mate[j];
        const uint v = cells[slot].v[j];
        p[j] = point_of(points, v);
        changed[v] = clock;
        atomic_min(&incident_cells[v], slot);
        if (behind == INVALID) continue;
        const uint owner = claim[behind / 4];
        if (owner == r) continue;  // a face between two of its own cells
        if (owner == UNCLAIMED)
          cells[behind / 4].mate[behind % 4] = 4 * slot + j;
        else
          cells[slot].mate[j] = moved[behind];
      }
      quality[slot] = decision_of(p[0], p[1], p[2], p[3]);
      pending[slot] = 0xff;
    }
  }
}

// The rest of refresh: claims are given back, slots that are left go onto the free list, last ones first.
KERNEL void commit_free(__global const uint* counters, uint n, __global const uint* order,
                        __global const uint* offsets, __global const uint* sizes, __global const uint* arena,
                        __global const uchar* won, __global const uint* freed_at, uint n_free,
                        __global uint* claim, __global double* quality, __global uint* free_cells) {
  const uint taken = min(counters[HFR_EXTRA], n_free);
  FOR_EACH(r, min(counters[HFR_CANDIDATES], n)) {
    if (!won[r]) continue;
    const uint i = order[r];
    const uint n_removed = n_removed_of(sizes[i]);
    const uint n_created = n_created_of(sizes[i]);
    for (uint k = 0; k < n_removed; ++k) {
      const uint c = arena[offsets[i] + k];
      claim[c] = UNCLAIMED;
      if (k < n_created) continue;
      quality[c] = HFR_INFINITY;
      free_cells[n_free - taken + (counters[HFR_FREED] - 1 - (freed_at[r] + (k - n_created)))] = c;
    }
  }
}
