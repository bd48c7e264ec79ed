/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_COUNTERS_H
#define HFR_KERNELS_COUNTERS_H

/* Places in the block of 32-bit counters that a device keeps and the host reads once a round. */
enum hfr_counter {
  HFR_LISTED,     /* cells of the work list */
  HFR_SEEDS,      /* edges, faces or vertices looked at */
  HFR_LARGE,      /* edges whose ring is larger than HFR_SMALL_RING */
  HFR_CANDIDATES, /* that would improve their cluster */
  HFR_ARENA,      /* words that the candidates take */
  HFR_WINNERS,
  HFR_EXTRA,     /* cells that winners make beyond those they free */
  HFR_FREED,     /* and those they free beyond those they make */
  HFR_VERTICES,  /* of a pass that moves or removes vertices */
  HFR_LINKS,     /* cells of their stars */
  HFR_BIG_STARS, /* vertices that no star of this code can hold */
  HFR_COLOURED,  /* vertices that have a colour */
  HFR_MOVED,
  HFR_INVALID_CELLS,
  HFR_LEVEL,                     /* three counters: vertices of a level of the colouring */
  HFR_UNDECIDED = HFR_LEVEL + 3, /* one for each repetition of the selection */
  HFR_COLOUR_SIZE = HFR_UNDECIDED + 32,
  HFR_N_COUNTERS = HFR_COLOUR_SIZE + 64
};

/* What a round works on, and what names its seeds. */
enum hfr_seed_kind {
  HFR_OF_EDGE,  /* 6*cell + edge */
  HFR_OF_FACE,  /* 4*cell + corner */
  HFR_OF_VERTEX /* its number */
};

#define HFR_SMALL_RING 8  /* cells of a ring that is looked at at once */
#define HFR_MAX_STAR 256  /* cells of a vertex */
#define HFR_SMALL_STAR 32 /* those that fit in the registers and near memory of a device */
#define HFR_MAX_COLOURS 63
#define HFR_SUB_ROUNDS 32 /* repetitions of a selection that can be told apart */

#endif
