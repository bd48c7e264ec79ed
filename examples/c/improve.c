/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays in, repaired arrays out: a cube of 4^3 grid cubes, six cells each, whose inner vertices a made-up
 * simulation has moved too far. cc -std=c99 improve.c $(pkg-config --cflags --libs hfremesh_c) -lm -o improve
 * && ./improve */
#include <hfremesh.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 4, POINTS = (N + 1) * (N + 1) * (N + 1), CELLS = 6 * N * N * N };

static double points[POINTS][3];
static int32_t cells[CELLS][4];

static int32_t number(int i, int j, int k) { return (k * (N + 1) + j) * (N + 1) + i; }

static void make_cube(void) {
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  int n = 0;
  for (int k = 0; k <= N; ++k)
    for (int j = 0; j <= N; ++j)
      for (int i = 0; i <= N; ++i) {
        double* p = points[number(i, j, k)];
        const int inside = i > 0 && i < N && j > 0 && j < N && k > 0 && k < N;
        p[0] = (double)i / N + (inside ? 0.3 * sin(9.0 * j + 5.0 * k) : 0.0);
        p[1] = (double)j / N;
        p[2] = (double)k / N;
      }
  for (int k = 0; k < N; ++k)
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i)
        for (int c = 0; c < 6; ++c, ++n) { /* along the edges of the cube from corner to corner */
          int at[3] = {i, j, k};
          cells[n][0] = number(i, j, k);
          for (int s = 0; s < 3; ++s) {
            ++at[path[c][s]];
            cells[n][s + 1] = number(at[0], at[1], at[2]);
          }
        }
}

static void show(const hfr_progress* now, void* user) {
  ++*(int*)user;
  if (now->iteration == 1) printf("  %s: %d inverted\n", now->stage, (int)now->inverted);
}

static int failed(const char* what, const char* message) {
  fprintf(stderr, "%s: %s\n", what, message);
  return 1;
}

int main(void) {
  hfr_mesh* mesh = hfr_mesh_new(0);
  hfr_options* options = hfr_options_new();
  const hfr_array p = {points, POINTS, 3, HFR_FLOAT64, 0};
  const hfr_array c = {cells, CELLS, 4, HFR_INT32, 0};
  hfr_result result;
  int calls = 0;
  if (hfr_abi_version() != HFR_ABI_VERSION) return failed("abi", "another library than the header's");
  make_cube();
  if (hfr_mesh_build(mesh, &p, &c) != HFR_OK) return failed("build", hfr_mesh_message(mesh));
  if (hfr_options_set(options, "min_dihedral", "12") != HFR_OK)
    return failed("option", hfr_options_message(options));
  hfr_options_on_progress(options, show, &calls);
  if (hfr_improve(mesh, options, &result) != HFR_OK) return failed("improve", hfr_mesh_message(mesh));
  printf("inverted: %d before, %d after; smallest angle: %.2f before, %.2f after\n",
         (int)result.before.inverted, (int)result.after.inverted, result.before.min_dihedral,
         result.after.min_dihedral);

  const int64_t n = hfr_mesh_count(mesh, "vertices"), m = hfr_mesh_count(mesh, "cells");
  double* new_points = malloc((size_t)n * 3 * sizeof *new_points);
  int64_t* new_cells = malloc((size_t)m * 4 * sizeof *new_cells);
  const hfr_array np = {new_points, n, 3, HFR_FLOAT64, 0};
  const hfr_array nc = {new_cells, m, 4, HFR_INT64, 0};
  if (hfr_mesh_get(mesh, "points", &np) != HFR_OK || hfr_mesh_get(mesh, "cells", &nc) != HFR_OK)
    return failed("get", hfr_mesh_message(mesh));
  printf("%d vertices and %d cells for the solver\n", (int)n, (int)m);
  free(new_points);
  free(new_cells);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
  return result.before.inverted > 0 && result.goal_reached && calls > 0 ? 0 : 1;
}
