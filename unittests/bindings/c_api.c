/* SPDX-License-Identifier: BSD-3-Clause */
/* hfremesh.h as a C99 program meets it: what it gives, and what it refuses, with the mesh as it was. */
#include <hfremesh.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int n_failed = 0, n_checks = 0;

static void check(int holds, const char* what, int line, const char* message) {
  ++n_checks;
  if (holds) return;
  ++n_failed;
  printf("line %d: %s%s%s\n", line, what, message[0] ? "; the message is: " : "", message);
}
#define CHECK(condition) check((condition) != 0, #condition, __LINE__, "")
/* The call fails with the status, and the handle's line says `text`. */
#define REFUSED(call, status, text)                                                                        \
  do {                                                                                                     \
    const hfr_status got = (call);                                                                         \
    check(got == (status) && strstr(hfr_mesh_message(mesh), text) != NULL, #call " is refused with " text, \
          __LINE__, hfr_mesh_message(mesh));                                                               \
  } while (0)

static hfr_array array(void* data, int64_t rows, int32_t columns, hfr_type type) {
  const hfr_array a = {data, rows, columns, type, 0};
  return a;
}

/* Two cells on a common face. */
static double two_points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
static int32_t two_cells[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}};

static hfr_mesh* two(int base) {
  hfr_mesh* mesh = hfr_mesh_new(base);
  int64_t cells[2][4];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 4; ++j) cells[i][j] = two_cells[i][j] + base;
  const hfr_array p = array(two_points, 5, 3, HFR_FLOAT64), c = array(cells, 2, 4, HFR_INT64);
  check(hfr_mesh_build(mesh, &p, &c) == HFR_OK, "two cells are a mesh", __LINE__, hfr_mesh_message(mesh));
  return mesh;
}

static void arrays_of_every_type_and_stride(void) {
  struct {
    float x, y, z, temperature;
  } records[5];
  for (int i = 0; i < 5; ++i) {
    records[i].x = (float)two_points[i][0];
    records[i].y = (float)two_points[i][1];
    records[i].z = (float)two_points[i][2];
    records[i].temperature = 1e30f;
  }
  hfr_mesh* mesh = hfr_mesh_new(0);
  hfr_array p = array(records, 5, 3, HFR_FLOAT32), c = array(two_cells, 2, 4, HFR_INT32);
  double points[5][4];
  hfr_array out = array(points, 5, 3, HFR_FLOAT64);
  p.row_stride = sizeof records[0];
  out.row_stride = sizeof points[0];
  for (int i = 0; i < 5; ++i) points[i][3] = 7;
  CHECK(hfr_mesh_build(mesh, &p, &c) == HFR_OK);
  CHECK(hfr_mesh_get(mesh, "points", &out) == HFR_OK);
  for (int i = 0; i < 5; ++i)
    CHECK(memcmp(points[i], two_points[i], sizeof two_points[i]) == 0 && points[i][3] == 7);
  hfr_mesh_free(mesh);
}

static void the_base_counts_everywhere(void) {
  for (int base = 0; base <= 1; ++base) {
    hfr_mesh* mesh = two(base);
    int64_t cells[2][4], near[2][4], faces[6][3], around[8];
    const hfr_array c = array(cells, 2, 4, HFR_INT64), f = array(faces, 6, 3, HFR_INT64),
                    b = array(near, 2, 4, HFR_INT64);
    size_t n = 0;
    int64_t least = 99, n_beside = 0;
    CHECK(hfr_mesh_get(mesh, "cells", &c) == HFR_OK && hfr_mesh_get(mesh, "boundary_faces", &f) == HFR_OK);
    CHECK(hfr_mesh_get(mesh, "neighbours", &b) == HFR_OK);
    for (int i = 0; i < 8; ++i) {
      const int64_t v = cells[i / 4][i % 4], beside = near[i / 4][i % 4];
      if (v < least) least = v;
      CHECK(beside == base - 1 || beside == base + 1 - i / 4);
      n_beside += beside >= base;
    }
    CHECK(least == base && n_beside == 2);
    CHECK(hfr_vertex_cells(mesh, base + 1, around, 8, &n) == HFR_OK && n == 2);
    CHECK(around[0] + around[1] == 2 * base + 1);
    CHECK(hfr_vertex_cells(mesh, base + 1, NULL, 0, &n) == HFR_OK && n == 2);
    CHECK(hfr_vertex_vertices(mesh, base, around, 8, &n) == HFR_OK && n == 3);
    CHECK(hfr_edge_cells(mesh, base + 1, base + 2, around, 1, &n) == HFR_OK && n == 2);
    CHECK(hfr_cell_cells(mesh, base, around, 8, &n) == HFR_OK && n == 1 && around[0] == base + 1);
    REFUSED(hfr_edge_cells(mesh, base, base + 4, around, 8, &n), HFR_INVALID_INPUT, "no edge joins vertices");
    REFUSED(hfr_vertex_cells(mesh, base - 1, around, 8, &n), HFR_INVALID_INPUT,
            "is out of range: there are 5");
    REFUSED(hfr_cell_cells(mesh, base + 2, around, 8, &n), HFR_INVALID_INPUT, "is out of range: there are 2");
    REFUSED(hfr_cell_cells(mesh, base, NULL, 8, &n), HFR_INVALID_INPUT, "NULL");
    hfr_mesh_free(mesh);
  }
}

static void what_does_not_fit_is_named(void) {
  hfr_mesh* mesh = two(0);
  double points[5][3];
  int32_t cells[2][4];
  hfr_array p = array(points, 5, 3, HFR_FLOAT64), c = array(cells, 2, 4, HFR_INT32);
  memcpy(points, two_points, sizeof points);
  memcpy(cells, two_cells, sizeof cells);
  points[3][1] = NAN;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "points[3][1] is not finite");
  REFUSED(hfr_mesh_set(mesh, "points", &p), HFR_INVALID_INPUT, "points[3][1] is not finite");
  points[3][1] = 0;
  cells[1][2] = 5;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT,
          "cells[1][2] is 5, out of range: there are 5 vertices");
  cells[1][2] = -1;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cells[1][2] is -1");
  cells[1][2] = 1;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cell 1: a vertex appears twice");
  c.type = HFR_FLOAT32;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cells: integers are wanted");
  c.type = 9;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cells: 9 is no hfr_type");
  c = array(cells, 2, 3, HFR_INT32);
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT,
          "cells: an array of any number x 4 is wanted, not of 2 x 3");
  c = array(NULL, 2, 4, HFR_INT32);
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cells: the array's data is NULL");
  REFUSED(hfr_mesh_build(mesh, &p, NULL), HFR_INVALID_INPUT, "cells: the array is NULL");
  p.row_stride = 20;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "points: a row_stride of 20 bytes");
  p = array(points, 4, 3, HFR_FLOAT64);
  REFUSED(hfr_mesh_get(mesh, "points", &p), HFR_INVALID_INPUT,
          "points: an array of 5 x 3 is wanted, not of 4 x 3");
  REFUSED(hfr_mesh_get(mesh, "colours", &p), HFR_INVALID_INPUT, "no 'colours' to get");
  REFUSED(hfr_mesh_set(mesh, "cells", &p), HFR_INVALID_INPUT, "no 'cells' to set");
  REFUSED(hfr_mesh_get(mesh, NULL, &p), HFR_INVALID_INPUT, "what is NULL");
  CHECK(hfr_mesh_count(mesh, "colours") == -1 && hfr_mesh_count(mesh, "cells") == 2);
  CHECK(hfr_mesh_check(mesh) == HFR_OK && hfr_mesh_message(mesh)[0] == 0);
  hfr_mesh_free(mesh);
}

static void null_is_no_handle(void) {
  hfr_statistics s;
  size_t n;
  CHECK(hfr_mesh_new(2) == NULL && hfr_mesh_new(-1) == NULL);
  CHECK(hfr_mesh_build(NULL, NULL, NULL) == HFR_INVALID_INPUT &&
        hfr_improve(NULL, NULL, NULL) == HFR_INVALID_INPUT);
  CHECK(hfr_mesh_statistics(NULL, 0, &s) == HFR_INVALID_INPUT &&
        hfr_cell_cells(NULL, 0, NULL, 0, &n) == HFR_INVALID_INPUT);
  CHECK(hfr_options_set(NULL, "seed", "1") == HFR_INVALID_INPUT && hfr_mesh_count(NULL, "cells") == -1);
  CHECK(strstr(hfr_mesh_message(NULL), "NULL") && strstr(hfr_options_message(NULL), "NULL"));
  hfr_mesh_free(NULL);
  hfr_options_free(NULL);
}

static void options_go_by_name(void) {
  hfr_options* options = hfr_options_new();
  const char *name, *value, *about;
  size_t n = 0;
  while (hfr_options_name(n, &name, &value, &about)) {
    CHECK(name[0] && value[0] && about[0]);
    /* a field may be called anything but nothing */
    const char* wrong = strcmp(name, "trigger_field") == 0 ? "" : "no such thing";
    CHECK(hfr_options_set(options, name, wrong) == HFR_INVALID_INPUT);
    CHECK(strncmp(hfr_options_message(options), name, strlen(name)) == 0);
    ++n;
  }
  CHECK(n > 20 && !hfr_options_name(n, NULL, NULL, NULL) && hfr_options_name(0, NULL, NULL, NULL));
  CHECK(hfr_options_set(options, "min_dihedral", "20") == HFR_OK && hfr_options_message(options)[0] == 0);
  CHECK(hfr_options_set(options, "min_angle", "20") == HFR_INVALID_INPUT);
  CHECK(strstr(hfr_options_message(options), "there are min_dihedral") != NULL);
  CHECK(hfr_options_set(options, "seed", NULL) == HFR_INVALID_INPUT &&
        hfr_options_set(options, NULL, "1") != HFR_OK);
  hfr_options_free(options);
}

/* --- a cube with vertices moved too far --- */

enum { N = 5, POINTS = (N + 1) * (N + 1) * (N + 1), CELLS = 6 * N * N * N };

static int32_t number(int i, int j, int k) { return (k * (N + 1) + j) * (N + 1) + i; }

static hfr_mesh* cube(void) {
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  static double points[POINTS][3];
  static int32_t cells[CELLS][4];
  int n = 0;
  for (int k = 0; k <= N; ++k)
    for (int j = 0; j <= N; ++j)
      for (int i = 0; i <= N; ++i) {
        double* p = points[number(i, j, k)];
        const int inside = i > 0 && i < N && j > 0 && j < N && k > 0 && k < N;
        p[0] = (double)i / N + (inside ? 0.25 * sin(9.0 * j + 5.0 * k) : 0.0);
        p[1] = (double)j / N;
        p[2] = (double)k / N;
      }
  for (int k = 0; k < N; ++k)
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i)
        for (int c = 0; c < 6; ++c, ++n) {
          int at[3] = {i, j, k};
          cells[n][0] = number(i, j, k);
          for (int s = 0; s < 3; ++s) {
            ++at[path[c][s]];
            cells[n][s + 1] = number(at[0], at[1], at[2]);
          }
        }
  hfr_mesh* mesh = hfr_mesh_new(0);
  const hfr_array p = array(points, POINTS, 3, HFR_FLOAT64), c = array(cells, CELLS, 4, HFR_INT32);
  check(hfr_mesh_build(mesh, &p, &c) == HFR_OK, "the cube is a mesh", __LINE__, hfr_mesh_message(mesh));
  return mesh;
}

static void integers_of_any_number_are_kept_as_files_have_them(void) {
  hfr_mesh* mesh = cube();
  static int32_t five[CELLS][5];
  static double found[CELLS][5];
  for (int i = 0; i < CELLS; ++i)
    for (int j = 0; j < 5; ++j) five[i][j] = 5 * i + j;
  const hfr_array in = array(five, CELLS, 5, HFR_INT32), out = array(found, CELLS, 5, HFR_FLOAT64);
  CHECK(hfr_mesh_set_field(mesh, "cells", "counts", &in) == HFR_OK);
  CHECK(hfr_mesh_get_field(mesh, "cells", "counts", &out) == HFR_OK);
  CHECK(found[CELLS - 1][4] == five[CELLS - 1][4] && found[1][2] == 7);
  hfr_mesh_free(mesh);
}

static void what_a_field_or_an_array_cannot_hold_is_refused(void) {
  hfr_mesh* mesh = two(1);
  double seven[2][7] = {{1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14}}, found[2][7];
  const hfr_array wide = array(seven, 2, 7, HFR_FLOAT64), narrow = array(seven, 2, 5, HFR_FLOAT64);
  const hfr_array out = array(found, 2, 7, HFR_FLOAT64);
  CHECK(hfr_mesh_set_field(mesh, "cells", "a", &wide) == HFR_OK);
  REFUSED(hfr_mesh_set_field(mesh, "cells", "a", &narrow), HFR_INVALID_INPUT, "a has 7 components");
  CHECK(hfr_mesh_get_field(mesh, "cells", "a", &out) == HFR_OK && found[1][6] == 14);

  int64_t odd[2][5] = {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 0}};
  const hfr_array five = array(odd, 2, 5, HFR_INT64);
  odd[1][4] = (INT64_C(1) << 53) + 1;
  REFUSED(hfr_mesh_set_field(mesh, "cells", "b", &five), HFR_INVALID_INPUT, "of this width do not have");
  odd[1][4] = INT64_MAX;
  REFUSED(hfr_mesh_set_field(mesh, "cells", "b", &five), HFR_INVALID_INPUT, "of this width do not have");
  odd[1][4] = INT64_C(1) << 60;
  CHECK(hfr_mesh_set_field(mesh, "cells", "b", &five) == HFR_OK);

  int64_t regions[2] = {(1 << 24) + 1, 0};
  const hfr_array r = array(regions, 2, 1, HFR_INT64);
  float f[2];
  const hfr_array as_floats = array(f, 2, 1, HFR_FLOAT32);
  CHECK(hfr_mesh_set(mesh, "regions", &r) == HFR_OK);
  REFUSED(hfr_mesh_get(mesh, "regions", &as_floats), HFR_INVALID_INPUT, "of this width do not have");
  hfr_mesh_free(mesh);
}

static void messages_say_from_where_they_count(void) {
  hfr_mesh* mesh = hfr_mesh_new(1);
  int32_t cells[2][4] = {{1, 2, 3, 4}, {2, 3, 4, 4}};
  const hfr_array p = array(two_points, 5, 3, HFR_FLOAT64), c = array(cells, 2, 4, HFR_INT32);
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "cell 1: ");
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "(cells and vertices counted from 0)");
  cells[1][3] = 6;
  REFUSED(hfr_mesh_build(mesh, &p, &c), HFR_INVALID_INPUT, "counted from 1");
  CHECK(strstr(hfr_mesh_message(mesh), "counted from 0") == NULL);
  hfr_mesh_free(mesh);
}

static void a_run_repairs_and_keeps_what_hangs_on_the_mesh(void) {
  hfr_mesh* mesh = cube();
  hfr_options* options = hfr_options_new();
  hfr_result result;
  static double old_ids[POINTS], tensors[CELLS][6];
  static int32_t regions[CELLS];
  for (int i = 0; i < POINTS; ++i) old_ids[i] = i;
  for (int i = 0; i < CELLS; ++i) {
    regions[i] = 3;
    for (int j = 0; j < 6; ++j) tensors[i][j] = j;
  }
  hfr_array ids = array(old_ids, POINTS, 1, HFR_FLOAT64), r = array(regions, CELLS, 1, HFR_INT32),
            t = array(tensors, CELLS, 6, HFR_FLOAT64);
  CHECK(hfr_mesh_set_field(mesh, "vertices", "id", &ids) == HFR_OK);
  CHECK(hfr_mesh_set_field(mesh, "cells", "stress", &t) == HFR_OK &&
        hfr_mesh_set(mesh, "regions", &r) == HFR_OK);
  CHECK(hfr_options_set(options, "min_dihedral", "12") == HFR_OK);
  CHECK(hfr_improve(mesh, options, &result) == HFR_OK);
  CHECK(result.before.inverted > 3 && result.after.inverted == 0 && result.invalid_cells == 0);
  CHECK(result.changed && result.goal_reached && result.stop == HFR_STOP_GOAL);
  CHECK(result.after.min_dihedral >= 12 && fabs(result.after.volume - 1) < 1e-12);
  CHECK(hfr_mesh_check(mesh) == HFR_OK);

  const int64_t n = hfr_mesh_count(mesh, "vertices"), m = hfr_mesh_count(mesh, "cells");
  double* found = malloc((size_t)m * 6 * sizeof(double));
  int64_t* sources = malloc((size_t)n * sizeof(int64_t));
  int64_t* map = malloc(POINTS * sizeof(int64_t));
  hfr_array f = array(found, n, 1, HFR_FLOAT64), s = array(sources, n, 1, HFR_INT64),
            w = array(map, POINTS, 1, HFR_INT64);
  CHECK(hfr_mesh_get_field(mesh, "vertices", "id", &f) == HFR_OK);
  CHECK(hfr_mesh_get(mesh, "source_vertices", &s) == HFR_OK &&
        hfr_mesh_get(mesh, "map_vertices", &w) == HFR_OK);
  CHECK(hfr_mesh_count(mesh, "map_vertices") == POINTS && hfr_mesh_count(mesh, "map_cells") == CELLS);
  int wrong = 0, kept = 0;
  for (int64_t v = 0; v < n; ++v) wrong += found[v] != (double)sources[v];
  for (int64_t v = 0; v < POINTS; ++v) kept += map[v] >= 0 && sources[map[v]] == v;
  CHECK(wrong == 0 && kept > POINTS / 2);
  f = array(found, m, 6, HFR_FLOAT64);
  CHECK(hfr_mesh_get_field(mesh, "cells", "stress", &f) == HFR_OK && found[6 * m - 1] == 5);
  f = array(found, m, 1, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "regions", &f) == HFR_OK && found[0] == 3 && found[m - 1] == 3);
  CHECK(hfr_mesh_quality(mesh, "min-dihedral", &f) == HFR_OK);
  for (int64_t c = 0; c < m; ++c) wrong += found[c] < 12;
  CHECK(wrong == 0);
  REFUSED(hfr_mesh_quality(mesh, "beauty", &f), HFR_INVALID_INPUT, "no metric is called 'beauty'");
  REFUSED(hfr_mesh_get_field(mesh, "cells", "heat", &f), HFR_INVALID_INPUT,
          "no field of cells is called 'heat'");
  REFUSED(hfr_mesh_get_field(mesh, "cells", "stress", &f), HFR_INVALID_INPUT, "stress");
  REFUSED(hfr_mesh_get_field(mesh, "faces", "stress", &f), HFR_INVALID_INPUT, "not of 'faces'");
  free(found);
  free(sources);
  free(map);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
}

static int wants_end(void* user) { return ++*(int*)user > 2; }
static void counts(const hfr_progress* now, void* user) {
  *(int*)user += now->stage[0] != 0 && now->fraction <= 1;
}

static void callbacks_are_called(void) {
  hfr_mesh* mesh = cube();
  hfr_options* options = hfr_options_new();
  hfr_result result;
  int asked = 0, told = 0;
  CHECK(hfr_options_on_cancel(options, wants_end, &asked) == HFR_OK);
  CHECK(hfr_options_on_progress(options, counts, &told) == HFR_OK);
  CHECK(hfr_improve(mesh, options, &result) == HFR_OK);
  CHECK(result.stop == HFR_STOP_CANCELLED && asked == 3 && told > 0);
  CHECK(result.after.inverted <= result.before.inverted);
  CHECK(hfr_options_on_cancel(options, NULL, NULL) == HFR_OK && hfr_improve(mesh, options, NULL) == HFR_OK);
  CHECK(hfr_mesh_count(mesh, "invalid_cells") == 0);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
}

static void files_and_fixed_things(const char* folder) {
  hfr_mesh *mesh = cube(), *other = hfr_mesh_new(1);
  char path[1000];
  int32_t fixed[2] = {POINTS / 2, 77}, faces[1][4] = {{0, 1, N + 2, 4}};
  hfr_array k = array(fixed, 2, 1, HFR_INT32), f = array(faces, 1, 4, HFR_INT32);
  snprintf(path, sizeof path, "%s/c_api.vtu", folder);
  CHECK(hfr_mesh_set(mesh, "fixed_vertices", &k) == HFR_OK);
  CHECK(hfr_mesh_set(mesh, "labelled_faces", &f) == HFR_OK);
  faces[0][2] = POINTS - 1;
  REFUSED(hfr_mesh_set(mesh, "labelled_faces", &f), HFR_INVALID_INPUT,
          "labelled_faces[0]: there is no such face");
  CHECK(hfr_mesh_write(mesh, path, "zlib") == HFR_OK && hfr_mesh_read(other, path) == HFR_OK);
  CHECK(hfr_mesh_count(other, "cells") == CELLS && hfr_mesh_count(other, "vertices") == POINTS);
  REFUSED(hfr_mesh_write(mesh, path, "gold"), HFR_INVALID_INPUT, "gold");
  REFUSED(hfr_mesh_write(mesh, "a.xyz", NULL), HFR_INVALID_INPUT, "unknown file type");
  REFUSED(hfr_mesh_write(mesh, "/no/such/folder/a.mesh", ""), HFR_IO_ERROR, "/no/such/folder");
  REFUSED(hfr_mesh_read(mesh, "/no/such/file.mesh"), HFR_IO_ERROR, "/no/such/file.mesh");
  REFUSED(hfr_mesh_read(mesh, NULL), HFR_INVALID_INPUT, "path is NULL");
  CHECK(hfr_mesh_count(mesh, "cells") == CELLS);
  remove(path);
  hfr_mesh_free(mesh);
  hfr_mesh_free(other);
}

static void a_bad_option_leaves_the_mesh(void) {
  hfr_mesh* mesh = cube();
  hfr_options* options = hfr_options_new();
  static double before[POINTS][3], after[POINTS][3];
  const hfr_array a = array(before, POINTS, 3, HFR_FLOAT64), b = array(after, POINTS, 3, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "points", &a) == HFR_OK);
  CHECK(hfr_options_set(options, "fix", "vertex:9999") == HFR_OK);
  REFUSED(hfr_improve(mesh, options, NULL), HFR_INVALID_INPUT, "vertex:9999");
  CHECK(hfr_options_set(options, "device", "opencl:77.0") == HFR_OK);
  CHECK(hfr_mesh_get(mesh, "points", &b) == HFR_OK && memcmp(before, after, sizeof before) == 0);
  hfr_options_free(options);
  options = hfr_options_new();
  CHECK(hfr_options_set(options, "device", "opencl:77.0") == HFR_OK);
  REFUSED(hfr_improve(mesh, options, NULL), HFR_DEVICE_ERROR, "");
  CHECK(hfr_mesh_get(mesh, "points", &b) == HFR_OK && memcmp(before, after, sizeof before) == 0);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
}

/* The call fails with the status, and the remesher's line says `text`. */
#define STEP_REFUSED(call, status, text)                                             \
  do {                                                                               \
    const hfr_status got = (call);                                                   \
    check(got == (status) && strstr(hfr_remesher_message(remesher), text) != NULL,   \
          #call " is refused with " text, __LINE__, hfr_remesher_message(remesher)); \
  } while (0)

static void a_remesher_steps_and_says_what_it_did(void) {
  hfr_mesh* mesh = cube();
  hfr_options* options = hfr_options_new();
  hfr_remesher* remesher = NULL;
  hfr_step step;
  static double d[POINTS][3], heat[POINTS], points[POINTS][3];
  hfr_array displacement = array(d, POINTS, 3, HFR_FLOAT64), h = array(heat, POINTS, 1, HFR_FLOAT64),
            p = array(points, POINTS, 3, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "points", &p) == HFR_OK);
  for (int v = 0; v < POINTS; ++v) heat[v] = points[v][0] + 2 * points[v][1];
  CHECK(hfr_mesh_set_field(mesh, "vertices", "heat", &h) == HFR_OK);
  CHECK(hfr_options_set(options, "transfer", "heat:paint") == HFR_INVALID_INPUT);
  CHECK(hfr_options_set(options, "transfer", "cold:linear") == HFR_OK);
  REFUSED(hfr_remesher_new(mesh, options, &remesher), HFR_INVALID_INPUT, "cold");
  CHECK(remesher == NULL && hfr_remesher_new(mesh, options, NULL) == HFR_INVALID_INPUT);
  hfr_options_free(options);
  options = hfr_options_new();
  CHECK(hfr_options_set(options, "transfer", "heat:linear") == HFR_OK &&
        hfr_options_set(options, "ids", "1") == HFR_OK);
  CHECK(hfr_options_set(options, "on_inversion", "repair") == HFR_OK);
  CHECK(hfr_remesher_new(mesh, options, &remesher) == HFR_OK && remesher != NULL);
  CHECK(hfr_remesher_needs_repair(remesher) == HFR_CAUSE_INVERTED);

  d[40][2] = INFINITY;
  STEP_REFUSED(hfr_remesher_step(remesher, &displacement, &step), HFR_INVALID_INPUT,
               "displacement[40][2] is not finite");
  STEP_REFUSED(hfr_remesher_move(remesher, &displacement, &step), HFR_INVALID_INPUT,
               "displacement[40][2] is not finite");
  d[40][2] = 0;
  displacement.rows = POINTS - 1;
  STEP_REFUSED(hfr_remesher_step(remesher, &displacement, &step), HFR_INVALID_INPUT,
               "displacement: an array of 216 x 3");
  STEP_REFUSED(hfr_remesher_step(remesher, NULL, NULL), HFR_INVALID_INPUT, "displacement: the array is NULL");
  displacement.rows = POINTS;
  static double same[POINTS][3];
  hfr_array q = array(same, POINTS, 3, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "points", &q) == HFR_OK && memcmp(points, same, sizeof same) == 0);

  CHECK(hfr_remesher_step(remesher, &displacement, &step) == HFR_OK);
  CHECK(step.changed && step.cause == HFR_CAUSE_INVERTED && step.repairs == 1 && step.inverted == 0 &&
        !step.undone);
  CHECK(step.min_dihedral > 5 && step.fraction == 1 && hfr_remesher_needs_repair(remesher) == HFR_CAUSE_NONE);
  const int64_t n = hfr_mesh_count(mesh, "vertices"), m = hfr_mesh_count(mesh, "cells");
  const int64_t made = hfr_remesher_count(remesher, 0, "created_cells"),
                n_parents = hfr_remesher_count(remesher, 0, "parents");
  CHECK(made > 0 && n_parents >= made && hfr_remesher_count(remesher, 0, "removed_cells") > 0);
  CHECK(hfr_remesher_count(remesher, 0, "old_vertices") == n &&
        hfr_remesher_count(remesher, 0, "old_cells") == m);
  CHECK(hfr_remesher_count(remesher, 0, "map_vertices") == POINTS &&
        hfr_remesher_count(remesher, 0, "map_cells") == CELLS);
  CHECK(hfr_remesher_count(remesher, 1, "parents") == -1 && hfr_remesher_count(remesher, 0, "colours") == -1);

  /* The edits bring a copy of the arrays up to date. */
  int64_t* cells = malloc((size_t)m * 4 * sizeof(int64_t));
  int64_t* created = malloc((size_t)made * 5 * sizeof(int64_t));
  int64_t* parents = malloc((size_t)n_parents * 2 * sizeof(int64_t));
  double* shares = malloc((size_t)n_parents * sizeof(double));
  hfr_array c = array(cells, m, 4, HFR_INT64), k = array(created, made, 5, HFR_INT64),
            r = array(parents, n_parents, 2, HFR_INT64), s = array(shares, n_parents, 1, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "cells", &c) == HFR_OK &&
        hfr_remesher_get(remesher, 0, "created_cells", &k) == HFR_OK);
  CHECK(hfr_remesher_get(remesher, 0, "parents", &r) == HFR_OK &&
        hfr_remesher_get(remesher, 0, "parent_shares", &s) == HFR_OK);
  int wrong = 0;
  for (int64_t i = 0; i < made; ++i)
    for (int j = 0; j < 4; ++j) wrong += cells[4 * created[5 * i] + j] != created[5 * i + 1 + j];
  for (int64_t i = 0; i < n_parents; ++i) wrong += parents[2 * i + 1] >= CELLS || !(fabs(shares[i]) < 1.1);
  CHECK(wrong == 0);
  double* now = malloc((size_t)n * 3 * sizeof(double));
  double* values = malloc((size_t)n * sizeof(double));
  int64_t* ids = malloc((size_t)n * sizeof(int64_t));
  p = array(now, n, 3, HFR_FLOAT64);
  h = array(values, n, 1, HFR_FLOAT64);
  hfr_array w = array(ids, n, 1, HFR_INT64);
  CHECK(hfr_mesh_get(mesh, "points", &p) == HFR_OK &&
        hfr_mesh_get_field(mesh, "vertices", "heat", &h) == HFR_OK);
  CHECK(hfr_remesher_get(remesher, 0, "vertex_ids", &w) == HFR_OK);
  for (int64_t v = 0; v < n; ++v) wrong += fabs(values[v] - now[3 * v] - 2 * now[3 * v + 1]) > 1e-9;
  CHECK(wrong == 0);
  STEP_REFUSED(hfr_remesher_get(remesher, 0, "cell_ids", &w), HFR_INVALID_INPUT, "cell_ids: an array of");
  STEP_REFUSED(hfr_remesher_get(remesher, 3, "parents", &w), HFR_INVALID_INPUT, "repair 3: there were 1");
  STEP_REFUSED(hfr_remesher_get(remesher, 0, "colours", &w), HFR_INVALID_INPUT, "a repair has no 'colours'");

  double* still = calloc((size_t)n * 3, sizeof(double));
  displacement = array(still, n, 3, HFR_FLOAT64);
  CHECK(hfr_remesher_step(remesher, &displacement, &step) == HFR_OK && !step.changed && step.looked_at == 0);
  CHECK(hfr_remesher_move(remesher, &displacement, NULL) == HFR_OK && hfr_remesher_reset(remesher) == HFR_OK);
  CHECK(hfr_remesher_repair(remesher, &step) == HFR_OK && hfr_remesher_transfer(remesher) == HFR_OK);
  CHECK(step.cause == HFR_CAUSE_ASKED && hfr_mesh_check(mesh) == HFR_OK);
  CHECK(hfr_remesher_step(NULL, NULL, NULL) == HFR_INVALID_INPUT &&
        hfr_remesher_count(NULL, 0, "parents") == -1);
  hfr_remesher_free(NULL);
  hfr_remesher_free(remesher);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
  free(cells), free(created), free(parents), free(shares), free(now), free(values), free(ids), free(still);
}

typedef struct transfers {
  int calls, wrong, fail_with;
} transfers;

/* Linear, by hand: places and weights from the edits, old values from the mesh as it was. */
static int carries_heat(const hfr_transfer* now, void* user) {
  transfers* seen = user;
  ++seen->calls;
  if (seen->fail_with) return seen->fail_with;
  const int64_t n_old = hfr_mesh_count(now->before, "vertices"), m_old = hfr_mesh_count(now->before, "cells"),
                n = hfr_mesh_count(now->after, "vertices");
  double* old = malloc((size_t)n_old * sizeof(double));
  double* values = malloc((size_t)n * sizeof(double));
  int64_t* cells = malloc((size_t)m_old * 4 * sizeof(int64_t));
  int64_t* old_vertices = malloc((size_t)n * sizeof(int64_t));
  const hfr_array a = array(old, n_old, 1, HFR_FLOAT64), b = array(values, n, 1, HFR_FLOAT64),
                  c = array(cells, m_old, 4, HFR_INT64), o = array(old_vertices, n, 1, HFR_INT64);
  seen->wrong += strcmp(now->name, "heat") != 0;
  seen->wrong += hfr_mesh_get_field(now->before, "vertices", now->name, &a) != HFR_OK;
  seen->wrong += hfr_mesh_get(now->before, "cells", &c) != HFR_OK;
  seen->wrong += hfr_remesher_get(now->remesher, 0, "old_vertices", &o) != HFR_OK;
  for (int64_t v = 0; v < n; ++v) values[v] = old_vertices[v] < 0 ? 1e30 : old[old_vertices[v]];
  const char* lists[2][2] = {{"created_vertices", "created_weights"}, {"moved_vertices", "moved_weights"}};
  for (int k = 0; k < 2; ++k) {
    const int64_t placed = hfr_remesher_count(now->remesher, 0, lists[k][0]);
    int64_t* places = malloc((size_t)placed * 2 * sizeof(int64_t) + 1);
    double* weights = malloc((size_t)placed * 4 * sizeof(double) + 1);
    const hfr_array p = array(places, placed, 2, HFR_INT64), w = array(weights, placed, 4, HFR_FLOAT64);
    seen->wrong += hfr_remesher_get(now->remesher, 0, lists[k][0], &p) != HFR_OK;
    seen->wrong += hfr_remesher_get(now->remesher, 0, lists[k][1], &w) != HFR_OK;
    for (int64_t i = 0; i < placed; ++i) {
      double value = 0;
      for (int j = 0; j < 4; ++j) value += weights[4 * i + j] * old[cells[4 * places[2 * i + 1] + j]];
      values[places[2 * i]] = value;
    }
    free(places), free(weights);
  }
  seen->wrong += hfr_mesh_set_field(now->after, "vertices", now->name, &b) != HFR_OK;
  seen->wrong += hfr_remesher_repair(now->remesher, NULL) != HFR_INVALID_INPUT;
  seen->wrong += hfr_remesher_count(now->remesher, 1, "parents") != -1;
  free(old), free(values), free(cells), free(old_vertices);
  return 0;
}

static void a_callback_carries_a_field_over(void) {
  hfr_mesh* mesh = cube();
  hfr_options* options = hfr_options_new();
  hfr_remesher* remesher = NULL;
  hfr_step step;
  transfers seen = {0, 0, 7};
  static double d[POINTS][3], heat[POINTS], points[POINTS][3], same[POINTS][3];
  hfr_array displacement = array(d, POINTS, 3, HFR_FLOAT64), h = array(heat, POINTS, 1, HFR_FLOAT64),
            p = array(points, POINTS, 3, HFR_FLOAT64), q = array(same, POINTS, 3, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "points", &p) == HFR_OK);
  for (int v = 0; v < POINTS; ++v) heat[v] = points[v][0] + 2 * points[v][1];
  CHECK(hfr_mesh_set_field(mesh, "vertices", "heat", &h) == HFR_OK);
  CHECK(hfr_options_on_transfer(options, NULL, carries_heat, &seen) == HFR_INVALID_INPUT);
  CHECK(hfr_options_on_transfer(options, "forgotten", carries_heat, NULL) == HFR_OK);
  CHECK(hfr_options_on_transfer(options, "forgotten", NULL, NULL) == HFR_OK);
  CHECK(hfr_options_on_transfer(options, "heat", carries_heat, &seen) == HFR_OK);
  CHECK(hfr_remesher_new(mesh, options, &remesher) == HFR_OK);

  /* One that fails: the mesh stays, and the line has its number. */
  STEP_REFUSED(hfr_remesher_step(remesher, &displacement, &step), HFR_INVALID_INPUT,
               "field 'heat': its callback failed with 7");
  CHECK(seen.calls == 1 && hfr_mesh_count(mesh, "cells") == CELLS);
  CHECK(hfr_mesh_get(mesh, "points", &q) == HFR_OK && memcmp(points, same, sizeof same) == 0);

  seen.fail_with = 0;
  CHECK(hfr_remesher_step(remesher, &displacement, &step) == HFR_OK && step.changed && step.inverted == 0);
  CHECK(seen.calls == 2 && seen.wrong == 0 && hfr_remesher_count(remesher, 0, "created_cells") > 0);
  const int64_t n = hfr_mesh_count(mesh, "vertices");
  double* now = malloc((size_t)n * 3 * sizeof(double));
  double* values = malloc((size_t)n * sizeof(double));
  p = array(now, n, 3, HFR_FLOAT64);
  h = array(values, n, 1, HFR_FLOAT64);
  CHECK(hfr_mesh_get(mesh, "points", &p) == HFR_OK &&
        hfr_mesh_get_field(mesh, "vertices", "heat", &h) == HFR_OK);
  int wrong = 0;
  for (int64_t v = 0; v < n; ++v) wrong += fabs(values[v] - now[3 * v] - 2 * now[3 * v + 1]) > 1e-9;
  CHECK(wrong == 0);
  hfr_remesher_free(remesher);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
  free(now), free(values);
}

int main(int argc, char** argv) {
  CHECK(hfr_abi_version() == HFR_ABI_VERSION && hfr_version()[0] >= '0');
  arrays_of_every_type_and_stride();
  the_base_counts_everywhere();
  what_does_not_fit_is_named();
  null_is_no_handle();
  options_go_by_name();
  integers_of_any_number_are_kept_as_files_have_them();
  what_a_field_or_an_array_cannot_hold_is_refused();
  messages_say_from_where_they_count();
  a_run_repairs_and_keeps_what_hangs_on_the_mesh();
  callbacks_are_called();
  files_and_fixed_things(argc > 1 ? argv[1] : ".");
  a_bad_option_leaves_the_mesh();
  a_remesher_steps_and_says_what_it_did();
  a_callback_carries_a_field_over();
  printf("%d checks, %d failed\n", n_checks, n_failed);
  return n_failed == 0 && n_checks > 100 ? 0 : 1;
}
