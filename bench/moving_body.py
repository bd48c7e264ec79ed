#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A body that turns once in a box, step by step, through three programs, as a Markdown table.

usage: bench/moving_body.py [--n N] [--steps S] [--goal DEG] [--trigger DEG] [--transfer HOW] [--only NAME ...]

Wants the Python packages hfremesh, mmgpy, gmsh, numpy and scipy. An ellipsoid turns about an inclined axis; all that
lies within its reach turns with it, the box rests, and what is between is sheared, so that no mesh lasts. Every
program is given the same motion of whatever vertices it has:
  hfremesh   Remesher.step(): repairs where an angle falls below the trigger
  mmg        mmgpy, optim and nosurf, in a step in which an angle has fallen below the same trigger
  gmsh       meshes the volume anew in every step, between the surfaces as they are; Delaunay, Optimize
A field is carried along: in each step it changes by what the exact function changes by at the vertex, so that what it
is off by in the end was made by carrying it over, and by that alone. For Mmg and Gmsh, which do not carry fields, this
script interpolates in the mesh as it was, by the same formula; the time of that is left out. Times are CPU time of
one thread, of the step, or of the meshing with what copies arrays in and out.
"""
import argparse
import os
import time

os.environ.setdefault("OMP_WAIT_POLICY", "passive")
import numpy as np
import scipy.spatial

import hfremesh as hf

HALF_AXES = np.array([0.45, 0.3, 0.3])
AXIS = np.array([0.0, 0.5, 1.0]) / np.sqrt(1.25)
REACH, REST = 0.47, 0.95  # radii: what turns with the body, and what stays


def box_round_ellipsoid(n):
    """The cube from -1 to 1 with the ellipsoid left out; as examples/Meshes.hh."""
    grid = hf.generate.box((n, n, n), low=(-1, -1, -1), high=(1, 1, 1))
    points, cells = np.array(grid.points), np.array(grid.cells)
    half = max(1.0, round(0.25 * (n % 2) + n * 0.15))
    cube = 2.0 * half / n + (1.0 / n if n % 2 else 0.0)
    cells = cells[np.abs(points[cells].mean(axis=1)).max(axis=1) >= cube]
    used, cells = np.unique(cells, return_inverse=True)
    points = points[used]
    t = np.maximum(0.0, (np.abs(points).max(axis=1) - cube) / (1 - cube))[:, None]
    ray = points / np.linalg.norm(points, axis=1)[:, None]
    return (1 - t) * HALF_AXES * ray + t * points, cells.reshape(-1, 4)


def motion(points, angle):
    """Displacement of each point: a turn by the angle within reach, smoothly less beyond, none at the box."""
    r = np.linalg.norm(points, axis=1)
    s = np.clip((REST - r) / (REST - REACH), 0, 1)
    turn = angle * s * s * (3 - 2 * s)
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    turned = c * points + s * np.cross(AXIS, points) + (1 - c) * (points @ AXIS)[:, None] * AXIS
    return turned - points


def exact(points):
    return np.sin(3 * points[:, 0]) * np.cos(2 * points[:, 1]) + points[:, 2] ** 2


def gradients(points, cells, values):
    """At each point: least squares over its edges, with the weight 1/length⁴, as Transfer::kQuadratic has them."""
    edges = np.sort(cells[:, [0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3]].reshape(-1, 2), axis=1)
    edges = np.unique(edges, axis=0)
    matrix, right = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    for a, b in (edges.T, edges.T[::-1]):
        d = points[b] - points[a]
        weighted = d / np.sum(d * d, axis=1)[:, None] ** 2
        np.add.at(matrix, a, weighted[:, :, None] * d[:, None, :])
        np.add.at(right, a, (values[b] - values[a])[:, None] * weighted)
    return np.linalg.solve(matrix, right[:, :, None])[:, :, 0]


def interpolate(points, cells, values, at, how, near=48):
    """In the cell that has each place, or comes nearest to having it, among those with the nearest middles."""
    slopes = gradients(points, cells, values) if how == "quadratic" else None
    tree = scipy.spatial.cKDTree(points[cells].mean(axis=1))
    best, out = np.full(len(at), -np.inf), np.zeros(len(at))
    inverse = np.linalg.inv(np.swapaxes(points[cells][:, 1:] - points[cells][:, :1], 1, 2))
    _, candidates = tree.query(at, near)
    for column in candidates.T:
        w = np.einsum("nij,nj->ni", inverse[column], at - points[cells[column, 0]])
        w = np.concatenate([1 - w.sum(axis=1, keepdims=True), w], axis=1)
        corners = cells[column]
        found = (w * values[corners]).sum(axis=1)
        if slopes is not None:
            bend = np.einsum("nk,nkj,nkj->n", w, slopes[corners], at[:, None] - points[corners]) / 2
            bent = np.clip(found + bend, values[corners].min(axis=1), values[corners].max(axis=1))
            found = np.where(w.min(axis=1) >= -1e-10, bent, found)
        better = w.min(axis=1) > best
        best[better] = w.min(axis=1)[better]
        out[better] = found[better]
    return out


class Hfremesh:
    name = "hfremesh"

    def __init__(self, points, cells, field, options):
        mesh = hf.Mesh(points, cells, point_fields={"T": field})
        self.rm = hf.Remesher(mesh, goal=options.goal, trigger=options.trigger, transfer={"T": options.transfer},
                              parents=False, threads=1)

    def step(self, angle):
        points = self.rm.points
        d = motion(points, angle)
        self.rm.set_field("T", self.rm.field("T") + exact(points + d) - exact(points))
        begin = time.process_time()
        step = self.rm.step(d)
        return time.process_time() - begin, step.changed

    def state(self):
        return self.rm.points, self.rm.cells, self.rm.field("T")


class Peer:
    def __init__(self, points, cells, field, options):
        self.points, self.cells, self.field, self.options = points, cells, field, options

    def step(self, angle):
        d = motion(self.points, angle)
        self.field = self.field + exact(self.points + d) - exact(self.points)
        self.points = self.points + d
        begin = time.process_time()
        made = self.remesh()
        took = time.process_time() - begin
        if made is None:
            return took, False
        points, cells = made
        self.field = interpolate(self.points, self.cells, self.field, points, self.options.transfer)
        self.points, self.cells = points, cells
        return took, True

    def state(self):
        return self.points, self.cells, self.field


class Mmg(Peer):
    name = "mmg"

    def remesh(self):
        import mmgpy
        if hf.min_dihedral(self.points, self.cells, threads=1).min() >= self.options.trigger:
            return None
        mesh = mmgpy.MmgMesh3D(self.points, self.cells.astype(np.int32))
        mesh.remesh(optim=1, nosurf=1, verbose=-1)
        return mesh.get_vertices(), mesh.get_tetrahedra()


class Gmsh(Peer):
    name = "gmsh"

    def remesh(self):
        import gmsh
        gmsh.initialize(interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)
            faces = np.asarray(hf.Mesh(self.points, self.cells).boundary_faces)
            used, corners = np.unique(faces, return_inverse=True)
            gmsh.model.addDiscreteEntity(2, 1)
            gmsh.model.mesh.addNodes(2, 1, np.arange(1, len(used) + 1), self.points[used].ravel())
            gmsh.model.mesh.addElementsByType(1, 2, [], corners.ravel() + 1)
            gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([1])], 1)
            gmsh.model.geo.synchronize()
            gmsh.model.mesh.generate(3)
            tags, coordinates, _ = gmsh.model.mesh.getNodes()
            _, nodes = gmsh.model.mesh.getElementsByType(4)
            number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
            number[tags] = np.arange(len(tags))
            used, cells = np.unique(number[nodes], return_inverse=True)
            return coordinates.reshape(-1, 3)[used], cells.reshape(-1, 4)
        finally:
            gmsh.finalize()


def run(program, start, options):
    points, cells = start
    body = program(points.copy(), cells.copy(), exact(points), options)
    times, worst, inverted, n_cells = [], [], 0, []
    for _ in range(options.steps):
        took, changed = body.step(2 * np.pi / options.steps)
        points, cells, field = body.state()
        found = hf.stats(points, cells)
        times.append((took, changed))
        worst.append(found.min_dihedral)
        inverted += found.inverted
        n_cells.append(found.cells)
    off = np.abs(field - exact(points))
    done = [took for took, changed in times if changed]
    return (f"| {body.name} | {len(done)} | {1e3 * np.median(done) if done else 0:.0f} "
            f"| {1e3 * sum(took for took, _ in times) / options.steps:.0f} | {min(worst):.2f} | {np.mean(worst):.2f} "
            f"| {inverted} | {min(n_cells):,} … {max(n_cells):,} | {off.max():.4f} "
            f"| {np.sqrt(np.mean(off ** 2)):.4f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--n", type=int, default=16, help="5.8 n³ cells about")
    parser.add_argument("--steps", type=int, default=40, help="of the whole turn")
    parser.add_argument("--goal", type=float, default=30, help="degrees")
    parser.add_argument("--trigger", type=float, default=15.5, help="degrees")
    parser.add_argument("--transfer", choices=["linear", "quadratic"], default="linear", help="of the field")
    parser.add_argument("--only", nargs="*", default=["hfremesh", "mmg", "gmsh"])
    options = parser.parse_args()
    first = hf.improve(*box_round_ellipsoid(options.n), threads=1)
    start = np.array(first.points), np.array(first.cells)
    print(f"{len(start[1]):,} cells, smallest angle {first.after.min_dihedral:.2f}, {options.steps} steps\n")
    print("| | steps in which it worked | ms, the median of them | ms a step, the mean of all "
          "| smallest angle of any step | the same, mean | inverted, of all steps | cells | field off by at most "
          "| root mean square |\n|---|---|---|---|---|---|---|---|---|---|")
    for program in (Hfremesh, Mmg, Gmsh):
        if program.name in options.only:
            try:
                print(run(program, start, options), flush=True)
            except Exception as error:  # a peer that gives up ends its own row
                print(f"| {program.name} | {type(error).__name__}: {str(error).splitlines()[0]} |" + " |" * 8, flush=True)


if __name__ == "__main__":
    main()
