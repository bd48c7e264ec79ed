/* SPDX-License-Identifier: BSD-3-Clause */
/* A loop of time steps: a cube whose inside is turned a little more at every step, with a field that is
 * carried over whatever repairs the mesh, and arrays of the solver that are brought up to date only when
 * something has changed. cc -std=c99 steps.c $(pkg-config --cflags --libs hfremesh_c) -lm -o steps && ./steps
 */
#include <hfremesh.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 6, STEPS = 25 };

static int failed(const char* what, const char* message) {
  fprintf(stderr, "%s: %s\n", what, message);
  return 1;
}

static hfr_mesh* make_cube(void) {
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  static double points[(N + 1) * (N + 1) * (N + 1)][3];
  static int32_t cells[6 * N * N * N][4];
  int n = 0;
  for (int v = 0; v < (N + 1) * (N + 1) * (N + 1); ++v) {
    points[v][0] = (double)(v % (N + 1)) / N;
    points[v][1] = (double)(v / (N + 1) % (N + 1)) / N;
    points[v][2] = (double)(v / (N + 1) / (N + 1)) / N;
  }
  for (int cube = 0; cube < N * N * N; ++cube)
    for (int c = 0; c < 6; ++c, ++n) { /* along the edges of the cube from corner to corner */
      int at[3] = {cube % N, cube / N % N, cube / N / N};
      for (int s = 0; s < 4; ++s) {
        cells[n][s] = (at[2] * (N + 1) + at[1]) * (N + 1) + at[0];
        if (s < 3) ++at[path[c][s]];
      }
    }
  hfr_mesh* mesh = hfr_mesh_new(0);
  const hfr_array p = {points, (N + 1) * (N + 1) * (N + 1), 3, HFR_FLOAT64, 0};
  const hfr_array c = {cells, 6 * N * N * N, 4, HFR_INT32, 0};
  if (hfr_mesh_build(mesh, &p, &c) != HFR_OK) {
    failed("build", hfr_mesh_message(mesh));
    hfr_mesh_free(mesh);
    return NULL;
  }
  return mesh;
}

/* Turns what lies near the axis; the surface stays. */
static void motion(const double* points, int64_t n, double angle, double* displacement) {
  for (int64_t v = 0; v < n; ++v) {
    const double x = points[3 * v] - 0.5, y = points[3 * v + 1] - 0.5, z = points[3 * v + 2] - 0.5;
    const double far = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    const double a = angle * fmax(0.0, 1 - 2 * far);
    displacement[3 * v] = cos(a) * x - sin(a) * y - x;
    displacement[3 * v + 1] = sin(a) * x + cos(a) * y - y;
    displacement[3 * v + 2] = 0;
  }
}

int main(void) {
  hfr_mesh* mesh = make_cube();
  hfr_options* options = hfr_options_new();
  hfr_remesher* remesher = NULL;
  if (!mesh) return 1;
  int64_t n = hfr_mesh_count(mesh, "vertices");
  double* points = malloc((size_t)n * 3 * sizeof *points);
  double* displacement = malloc((size_t)n * 3 * sizeof *displacement);
  double* heat = malloc((size_t)n * sizeof *heat);
  hfr_array p = {points, n, 3, HFR_FLOAT64, 0}, d = {displacement, n, 3, HFR_FLOAT64, 0},
            h = {heat, n, 1, HFR_FLOAT64, 0};
  hfr_mesh_get(mesh, "points", &p);
  for (int64_t v = 0; v < n; ++v) heat[v] = 300 + 10 * points[3 * v + 2]; /* linear: it stays so */
  hfr_mesh_set_field(mesh, "vertices", "heat", &h);
  hfr_options_set(options, "min_dihedral", "15");
  hfr_options_set(options, "trigger", "10");
  if (hfr_options_set(options, "transfer", "heat:linear") != HFR_OK)
    return failed("option", hfr_options_message(options));
  if (hfr_remesher_new(mesh, options, &remesher) != HFR_OK) return failed("remesher", hfr_mesh_message(mesh));

  int n_changed = 0, n_bad = 0;
  double least = 180;
  for (int i = 0; i < STEPS; ++i) {
    hfr_step step;
    motion(points, n, 0.15, displacement);
    if (hfr_remesher_step(remesher, &d, &step) != HFR_OK)
      return failed("step", hfr_remesher_message(remesher));
    if (step.changed) { /* else the solver keeps its matrix, its preconditioner, everything */
      ++n_changed;
      printf("step %d: %d cells removed, %d created\n", i,
             (int)hfr_remesher_count(remesher, 0, "removed_cells"),
             (int)hfr_remesher_count(remesher, 0, "created_cells"));
      n = hfr_mesh_count(mesh, "vertices");
      points = realloc(points, (size_t)n * 3 * sizeof *points);
      displacement = realloc(displacement, (size_t)n * 3 * sizeof *displacement);
      heat = realloc(heat, (size_t)n * sizeof *heat);
      p.data = points, d.data = displacement, h.data = heat;
      p.rows = d.rows = h.rows = n;
    }
    hfr_mesh_get(mesh, "points", &p);
    hfr_mesh_get_field(mesh, "vertices", "heat", &h);
    for (int64_t v = 0; v < n; ++v) n_bad += fabs(heat[v] - 300 - 10 * points[3 * v + 2]) > 1e-9;
    n_bad += step.inverted > 0;
    if (step.min_dihedral < least) least = step.min_dihedral;
  }
  printf("%d of %d steps changed the mesh; smallest angle %.2f\n", n_changed, STEPS, least);
  hfr_remesher_free(remesher);
  hfr_options_free(options);
  hfr_mesh_free(mesh);
  free(points);
  free(displacement);
  free(heat);
  return n_bad == 0 && n_changed > 1 && n_changed < STEPS ? 0 : 1;
}
