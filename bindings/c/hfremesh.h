/* SPDX-License-Identifier: BSD-3-Clause */
/* HFRemesh for C99 and whatever calls C: repairs and improves tetrahedral meshes. docs/c-api.md tells the
 * story.
 *
 * Handles are opaque and belong to whoever made them. A function that can fail returns HFR_OK or what went
 * wrong, and the handle that it was called with keeps a line that says where and what to do:
 * hfr_mesh_message(), hfr_options_message(). What fails leaves the handle as it was, but for two functions
 * that say so. No exception comes out, nothing is printed, and the program is never ended. Two threads may
 * use two handles at once, but not one. */
#ifndef HFREMESH_H
#define HFREMESH_H

#include <stddef.h>
#include <stdint.h>

/* Raised when a program that was compiled with an older header would no longer run; see hfr_abi_version(). */
#define HFR_ABI_VERSION 1

#if defined(__GNUC__)
#define HFR_C_EXPORT __attribute__((visibility("default")))
#else
#define HFR_C_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hfr_status {
  HFR_OK = 0,
  HFR_INVALID_INPUT = 1,  /* an array, a file or an option breaks a rule; also a handle that is NULL */
  HFR_IO_ERROR = 2,       /* a file cannot be opened or written */
  HFR_DEVICE_ERROR = 3,   /* the device that was named is missing or failed */
  HFR_RESOURCE_LIMIT = 4, /* out of memory, or more than an index counts */
  HFR_INTERNAL_ERROR = 5  /* a fault of the library */
} hfr_status;

typedef enum hfr_type { HFR_INT32 = 1, HFR_INT64 = 2, HFR_FLOAT32 = 3, HFR_FLOAT64 = 4 } hfr_type;

/* Somebody's array of rows x columns. It is read or written during the call and never kept. */
typedef struct hfr_array {
  void* data;
  int64_t rows;
  int32_t columns;
  int32_t type;       /* hfr_type */
  int64_t row_stride; /* bytes from row to row; 0: rows follow one another */
} hfr_array;

typedef struct hfr_mesh hfr_mesh;
typedef struct hfr_options hfr_options;
typedef struct hfr_remesher hfr_remesher;

/* --- the library --- */

/* HFR_ABI_VERSION of the library. A program compares it with the one of its header. */
HFR_C_EXPORT int hfr_abi_version(void);
/* "0.1.0". */
HFR_C_EXPORT const char* hfr_version(void);

/* --- options: those of the tool and of a remesher, by name and text --- */

/* NULL when there is no memory. */
HFR_C_EXPORT hfr_options* hfr_options_new(void);
HFR_C_EXPORT void hfr_options_free(hfr_options* options);
/* hfr_options_set(o, "min_dihedral", "20"). The message lists the names where one is not known. */
HFR_C_EXPORT hfr_status hfr_options_set(hfr_options* options, const char* name, const char* value);
/* Option number i: its name, what its text may be, and a sentence. 0 when there are fewer. Pointers may be
 * NULL. */
HFR_C_EXPORT int hfr_options_name(size_t i, const char** name, const char** value, const char** about);

typedef struct hfr_progress {
  const char* stage; /* "untangle", "bulk", ...; valid during the call */
  int32_t iteration; /* from 1, within the stage */
  double fraction;   /* 0 to 1 of the whole run, an estimate */
  int64_t inverted;
  double min_dihedral; /* degrees */
} hfr_progress;
/* Called between passes, from the thread that called hfr_improve(); NULL: nobody. They may not throw. */
typedef void (*hfr_progress_callback)(const hfr_progress* now, void* user);
/* Anything but 0 ends the run with the best mesh so far. */
typedef int (*hfr_cancel_callback)(void* user);
HFR_C_EXPORT hfr_status hfr_options_on_progress(hfr_options* options, hfr_progress_callback call, void* user);
HFR_C_EXPORT hfr_status hfr_options_on_cancel(hfr_options* options, hfr_cancel_callback ask, void* user);

/* One repair of a step, whose fields are being carried over. All of it is valid during the call alone. */
typedef struct hfr_transfer {
  const char* name;       /* of the field */
  hfr_mesh* before;       /* a copy of the mesh as it was, with the field's values */
  hfr_mesh* after;        /* the remesher's own mesh, to be given the values by hfr_mesh_set_field() */
  hfr_remesher* remesher; /* hfr_remesher_count() and hfr_remesher_get() say of repair 0 what this one did */
} hfr_transfer;
/* 0, or a number of one's own: the step fails then, with mesh and fields as they were before it. */
typedef int (*hfr_transfer_callback)(const hfr_transfer* now, void* user);
/* For a remesher: `call` carries the field of this name over repairs, when those of the option "transfer"
 * have been. NULL: nobody does. The calls come from the thread that called hfr_remesher_step() or
 * _transfer(), and may only read the mesh, the remesher's count and get, and set fields. */
HFR_C_EXPORT hfr_status hfr_options_on_transfer(hfr_options* options, const char* name,
                                                hfr_transfer_callback call, void* user);
/* The line about the last call that failed; "" after one that did not. Valid until the next call. */
HFR_C_EXPORT const char* hfr_options_message(const hfr_options* options);

/* --- a mesh --- */

/* An empty mesh. index_base, 0 or 1: the number of the first vertex and of the first cell in every array and
 * argument of this mesh. Messages that name a cell or vertex of the library's count from 0 and then say so.
 * NULL for another base, or when there is no memory. */
HFR_C_EXPORT hfr_mesh* hfr_mesh_new(int index_base);
HFR_C_EXPORT void hfr_mesh_free(hfr_mesh* mesh);
/* The line about the last call that failed; "" after one that did not. Valid until the next call. */
HFR_C_EXPORT const char* hfr_mesh_message(const hfr_mesh* mesh);

/* n x 3 coordinates, m x 4 vertices in either orientation. Cells that contradict their neighbours are turned,
 * which may make them inverted. What the mesh had before goes. */
HFR_C_EXPORT hfr_status hfr_mesh_build(hfr_mesh* mesh, const hfr_array* points, const hfr_array* cells);
/* Any known format, by extension, with regions, labels, names and fields. */
HFR_C_EXPORT hfr_status hfr_mesh_read(hfr_mesh* mesh, const char* path);
/* By extension, whole or not at all. variant: a version or encoding as 'hfremesh convert --variant';
 * "binary": the binary one; NULL or "": the format's own. */
HFR_C_EXPORT hfr_status hfr_mesh_write(hfr_mesh* mesh, const char* path, const char* variant);

/* How many there are of "vertices", "cells", "edges", "faces", "boundary_faces"; of "invalid_cells", the
 * inverted or flat ones that the last hfr_improve() has left; and of "map_vertices" and "map_cells", the
 * vertices and cells that the mesh had before it. -1 for any other word. */
HFR_C_EXPORT int64_t hfr_mesh_count(const hfr_mesh* mesh, const char* what);
/* "points" (n x 3: moves the vertices), "regions" (m x 1), "fixed_vertices" (k x 1: these, and no others,
 * stay where they are), "labelled_faces" (k x 4: three vertices and a label; these faces stay). */
HFR_C_EXPORT hfr_status hfr_mesh_set(hfr_mesh* mesh, const char* what, const hfr_array* values);
/* Into the caller's array, whose size must be right: "points" (n x 3), "cells" (m x 4), "regions" (m x 1),
 * "neighbours" (m x 4: the cell behind the face opposite each vertex; base - 1: none), "boundary_faces" (k x
 * 3, seen from outside counter-clockwise), "invalid_cells" (k x 1); and of the last hfr_improve()
 * "map_vertices" (for each vertex before: the one after; base - 1: removed), "map_cells", and
 * "source_vertices" (for each vertex after: the one before whose field values it has). */
HFR_C_EXPORT hfr_status hfr_mesh_get(hfr_mesh* mesh, const char* what, const hfr_array* values);
/* A field of "vertices" or "cells" of one row each, kept as double or 64-bit integers by the type of the
 * array; with other than 1, 2, 3, 4, 6 or 9 columns as double, and integers that double does not have are
 * refused. Who sets it again gives as many columns. It follows its vertices and cells through every run:
 * values are attached, not interpolated. */
HFR_C_EXPORT hfr_status hfr_mesh_set_field(hfr_mesh* mesh, const char* of, const char* name,
                                           const hfr_array* values);
HFR_C_EXPORT hfr_status hfr_mesh_get_field(hfr_mesh* mesh, const char* of, const char* name,
                                           const hfr_array* values);

/* --- walks: up to `capacity` numbers into `out`; *n is how many there are. out may be NULL with capacity 0
 * --- */

HFR_C_EXPORT hfr_status hfr_vertex_cells(hfr_mesh* mesh, int64_t vertex, int64_t* out, size_t capacity,
                                         size_t* n);
HFR_C_EXPORT hfr_status hfr_vertex_vertices(hfr_mesh* mesh, int64_t vertex, int64_t* out, size_t capacity,
                                            size_t* n);
/* In ring order; a fan starts at the boundary. */
HFR_C_EXPORT hfr_status hfr_edge_cells(hfr_mesh* mesh, int64_t a, int64_t b, int64_t* out, size_t capacity,
                                       size_t* n);
HFR_C_EXPORT hfr_status hfr_cell_cells(hfr_mesh* mesh, int64_t cell, int64_t* out, size_t capacity,
                                       size_t* n);

/* --- measuring --- */

typedef struct hfr_statistics {
  int64_t vertices, cells, boundary_faces, components, inverted, flat;
  int64_t worst_cell;                               /* base - 1: there is no cell */
  double min_dihedral, mean_dihedral, max_dihedral; /* degrees; negative in an inverted cell */
  double min_quality, mean_quality;                 /* volume-length: 1 regular, 0 flat */
  double volume, absolute_volume, overlap;          /* overlap: a share of the enclosed volume */
  double min_edge, mean_edge, max_edge;
  double surface_ceiling; /* degrees: no cell there can have more; 360: no limit */
  double reserved[8];
} hfr_statistics;

/* threads: 0 is every core. */
HFR_C_EXPORT hfr_status hfr_mesh_statistics(hfr_mesh* mesh, int threads, hfr_statistics* out);
/* metric: "volume-length", "min-dihedral", ... of each cell, into m x 1 floats. */
HFR_C_EXPORT hfr_status hfr_mesh_quality(hfr_mesh* mesh, const char* metric, const hfr_array* values);
/* HFR_OK when no rule of connectivity is broken; else HFR_INVALID_INPUT, and the message names rule and
 * place. */
HFR_C_EXPORT hfr_status hfr_mesh_check(hfr_mesh* mesh);

/* --- a run --- */

typedef enum hfr_stop {
  HFR_STOP_GOAL = 0,
  HFR_STOP_NO_PROGRESS = 1,
  HFR_STOP_ITERATIONS = 2,
  HFR_STOP_TIME_LIMIT = 3,
  HFR_STOP_CANCELLED = 4,
  HFR_STOP_DEVICE_LOST = 5
} hfr_stop;

typedef struct hfr_result {
  int32_t changed;
  int32_t goal_reached; /* nothing inverted or flat, and min_dihedral met where given */
  int32_t stop;         /* hfr_stop */
  int32_t padding;
  int64_t invalid_cells; /* that remain */
  double seconds;
  hfr_statistics before, after;
} hfr_result;

/* Improves the mesh in place. However it ends, the mesh is no worse than it was: no more inverted cells, no
 * more overlap, no smaller worst angle. options may be NULL (all as they are by default), result, too. With
 * HFR_RESOURCE_LIMIT or HFR_INTERNAL_ERROR the mesh may be one that the run had come to, with other cells and
 * vertices, and "map_vertices" and "map_cells" are empty. */
HFR_C_EXPORT hfr_status hfr_improve(hfr_mesh* mesh, const hfr_options* options, hfr_result* result);

/* --- a mesh inside of a simulation --- */

/* Why a mesh is repaired, the strongest that holds. */
typedef enum hfr_cause {
  HFR_CAUSE_NONE = 0,
  HFR_CAUSE_INVERTED = 1,
  HFR_CAUSE_ANGLE = 2,
  HFR_CAUSE_METRIC = 3,
  HFR_CAUSE_JACOBIAN = 4,
  HFR_CAUSE_INDICATOR = 5,
  HFR_CAUSE_MOTION = 6,
  HFR_CAUSE_STEPS = 7,
  HFR_CAUSE_ASKED = 8
} hfr_cause;

typedef struct hfr_step {
  int32_t changed;     /* by a repair: connectivity, or points beyond the displacement */
  int32_t cause;       /* hfr_cause of the first repair */
  int32_t stop;        /* hfr_stop of the last repair */
  int32_t undone;      /* cut short while cells were inverted that were not before: all is as it was */
  int64_t repairs;     /* one, but for sub-steps */
  int64_t looked_at;   /* cells */
  int64_t refused;     /* with on_inversion refuse: cells that would be inverted or flat */
  int64_t inverted;    /* inverted or flat cells after it */
  double fraction;     /* of the displacement that was taken */
  double min_dihedral; /* after it, degrees */
} hfr_step;

/* Of a mesh that outlives it, with those options that hfr_options_set() takes for improve (of each repair;
 * here min_dihedral, the goal, is 15 unless it was set) and for a remesher: "trigger", "transfer", "motion",
 * ... Fields are those of hfr_mesh_set_field(). On failure *out is NULL and the mesh has the message. Between
 * calls the mesh may be read and its fields set; whoever changes it otherwise calls hfr_remesher_reset()
 * after that. */
HFR_C_EXPORT hfr_status hfr_remesher_new(hfr_mesh* mesh, const hfr_options* options, hfr_remesher** out);
HFR_C_EXPORT void hfr_remesher_free(hfr_remesher* remesher);
HFR_C_EXPORT const char* hfr_remesher_message(const hfr_remesher* remesher);
/* Moves the vertices by displacement (n x 3), looks at their cells, and where a trigger calls for it repairs
 * the mesh and carries the fields over. A step that fails leaves mesh and fields as they were. step may be
 * NULL. */
HFR_C_EXPORT hfr_status hfr_remesher_step(hfr_remesher* remesher, const hfr_array* displacement,
                                          hfr_step* step);
/* The parts of a step alone. */
HFR_C_EXPORT hfr_status hfr_remesher_move(hfr_remesher* remesher, const hfr_array* displacement,
                                          hfr_step* step);
HFR_C_EXPORT hfr_status hfr_remesher_repair(hfr_remesher* remesher, hfr_step* step);
/* Where that fails, fields that were carried over before stay so; it may be called again, and the next step
 * does. */
HFR_C_EXPORT hfr_status hfr_remesher_transfer(hfr_remesher* remesher);
/* hfr_cause: why the mesh is to be repaired now. */
HFR_C_EXPORT int hfr_remesher_needs_repair(const hfr_remesher* remesher);
HFR_C_EXPORT hfr_status hfr_remesher_reset(hfr_remesher* remesher);
/* Rows of what the last step, move or repair did; of repair number `repair` (0 for the first), except for
 * "refused". "removed_cells", "created_cells", "parents", "moved_cells", "removed_vertices",
 * "created_vertices", "moved_vertices", "map_vertices", "map_cells", "old_vertices", "old_cells"; -1 for
 * another word or repair, and for parents that the option "parents" has left out. Parents are found when they
 * are first counted or got, which may take as long as the repair. */
HFR_C_EXPORT int64_t hfr_remesher_count(const hfr_remesher* remesher, int64_t repair, const char* what);
/* The same into the caller's array. "Old" is before that repair, "new" after it; base - 1: none.
 *   removed_cells k x 1 old; created_cells k x 5: the new cell, its four new vertices; moved_cells k x 1 new
 *   parents p x 2: the created cell, an old one with which it shares volume; parent_shares p x 1: how much of
 * its own removed_vertices k x 1 old created_vertices, moved_vertices k x 2: the new vertex, the old cell in
 * which it lies; created_weights, moved_weights k x 4: where in that cell; created_points, moved_points k x 3
 *   map_vertices, map_cells: by old one, the new one; old_vertices, old_cells: by new one, the old one
 *   refused k x 1; with the option ids, vertex_ids n x 1 and cell_ids m x 1, which are of now */
HFR_C_EXPORT hfr_status hfr_remesher_get(hfr_remesher* remesher, int64_t repair, const char* what,
                                         const hfr_array* values);

#ifdef __cplusplus
}
#endif

#endif
