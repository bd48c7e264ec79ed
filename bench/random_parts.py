#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares hfremesh-mpi parts with hfremesh on random small meshes: exit codes and bytes.

Usage: bench/random_parts.py BUILD [--seconds S] [--seed N] [--keep FOLDER]
The meshes are boxes of 1 to 4 cubes a side: whole, torn (some cells are missing, so that it touches itself in
vertices and edges), or in a row of which each has one vertex in common with the next; inverted, in two regions, with
labelled faces and edges, cells in any order and some ordered against their neighbours. The surface is frozen, flat or
free. Exit 1 where any output differs.
"""

import argparse
import itertools
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KUHN = [(0, *(1 << k for k in p[:1]), sum(1 << k for k in p[:2]), 7) for p in itertools.permutations(range(3))]
SEARCH = "--ops edge,face,node,smooth,insert,cluster --rounds mixed"
RUNS = [  # of hfremesh-mpi parts, and of hfremesh
    ("--all-stages", ""),
    ("--min-dihedral 15", "--min-dihedral 15 --polish-only"),
    ("--all-stages --min-dihedral 25", "--min-dihedral 25"),
    ("--passes-only", "--passes-only"),
    (f"--all-stages {SEARCH}", SEARCH),
]


def box(counts, corner, jitter, rng):
    """Points and cells; all cells are ordered alike."""
    grid = list(itertools.product(*(range(n + 1) for n in counts)))
    number = {place: i for i, place in enumerate(grid)}

    def point(place):
        move = [rng.uniform(-jitter, jitter) if 0 < i < n else 0 for i, n in zip(place, counts)]
        return tuple(c + (i + m) / n for c, i, m, n in zip(corner, place, move, counts))

    cells = []
    for cube in itertools.product(*(range(n) for n in counts)):
        corners = [number[tuple(c + (k >> d & 1) for d, c in enumerate(cube))] for k in range(8)]
        for tet in KUHN:
            first, second = tet[1].bit_length() - 1, (tet[2] ^ tet[1]).bit_length() - 1
            is_even = (second - first) % 3 == 1
            order = tet if is_even else (tet[0], tet[2], tet[1], tet[3])
            cells.append([corners[k] for k in order])
    return [point(place) for place in grid], cells


def mesh(rng):
    counts = [rng.randrange(1, 5) for _ in range(3)]
    jitter = rng.choice([0.1, 0.3, 0.45, 0.6])
    kind = rng.choice(["whole", "row", "torn", "torn"])
    points, cells = box(counts, (0, 0, 0), jitter, rng)
    if kind == "row":
        for i in range(1, rng.randrange(2, 4)):
            more, others = box(counts, (i, i, i), jitter, rng)
            last = len(points) - 1  # which is the first of the next box
            cells += [[last + v for v in cell] for cell in others]
            points += more[1:]
    if kind == "torn":
        share = rng.choice([0.2, 0.4, 0.6, 0.8, 0.95])
        cells = [cell for i, cell in enumerate(cells) if i == 0 or rng.random() < share]
    turned = rng.choice([0, 0, 0, 0.1, 0.5, 0.9])
    cells = [cell[1::-1] + cell[2:] if rng.random() < turned else cell for cell in cells]
    rng.shuffle(cells)
    regions = [1 + (rng.random() < 0.5) for _ in cells] if rng.random() < 0.4 else [1] * len(cells)
    return points, cells, regions


def labelled(cells, regions, rng):
    """Faces of the surface by side at random, some faces inside, and a few edges, each with a label."""
    cells_of = {}
    for i, cell in enumerate(cells):
        for k in range(4):
            cells_of.setdefault(tuple(sorted(cell[:k] + cell[k + 1 :])), []).append(i)
    faces, edges = {}, {}
    share, inside = rng.choice([0, 0.3, 1]), rng.choice([0, 0, 0.05])
    for face, owners in cells_of.items():
        is_surface = len(owners) == 1 or regions[owners[0]] != regions[owners[1]]
        if rng.random() < (share if is_surface else inside):
            faces[face] = rng.randrange(1, 4) if rng.random() < 0.1 else 1
    for _ in range(rng.choice([0, 0, 3])):
        edges[tuple(sorted(rng.sample(rng.choice(cells), 2)))] = rng.randrange(1, 3)
    order = list(faces.items())
    rng.shuffle(order)
    return [(rng.sample(face, 3), label) for face, label in order], list(edges.items())


def write(path, points, cells, regions, faces, edges):
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += [" ".join(map(repr, p)) + " 0" for p in points]
    lines += ["Tetrahedra", str(len(cells))]
    lines += [" ".join(str(v + 1) for v in cell) + f" {region}" for cell, region in zip(cells, regions)]
    for name, items in (("Triangles", faces), ("Edges", edges)):
        if items:
            lines += [name, str(len(items))]
            lines += [" ".join(str(v + 1) for v in vertices) + f" {label}" for vertices, label in items]
    path.write_text("\n".join(lines + ["End", ""]))


def fixed(cells, rng):
    """--fix with four vertices, edges or faces."""
    names = []
    for _ in range(4):
        kind, n = rng.choice([("vertex", 1), ("edge", 2), ("face", 3)])
        names.append(kind + ":" + "-".join(map(str, rng.sample(rng.choice(cells), n))))
    return ["--fix", ",".join(names)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="where meshes go whose outputs differ")
    line = parser.parse_args()
    tools = line.build / "apps" / "hfremesh"
    environment = dict(os.environ)
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    n_runs = n_bad = 0
    codes = {}
    end = time.monotonic() + line.seconds
    with tempfile.TemporaryDirectory() as folder:
        source, whole, parts = (Path(folder) / name for name in ("in.mesh", "whole.vtu", "parts.vtu"))
        for seed in itertools.count(line.seed):
            if time.monotonic() > end:
                break
            rng = random.Random(seed)
            points, cells, regions = mesh(rng)
            faces, edges = labelled(cells, regions, rng)
            write(source, points, cells, regions, faces, edges)
            of_parts, of_whole = (options.split() for options in rng.choice(RUNS))
            more = fixed(cells, rng) if rng.random() < 0.4 else []
            more += ["--surface", rng.choice(["frozen", "flat", "flat", "free", "free"])]
            if more[-1] != "frozen" and rng.random() < 0.2:
                more += ["--fix", "patch:1"]
            if more[-1] == "free" and rng.random() < 0.5:
                more += ["--hausdorff", rng.choice(["0.001", "0.05", "0.3"])]
            ranks, threads = rng.randrange(1, 5), rng.randrange(1, 3)
            for path in (whole, parts):
                path.unlink(missing_ok=True)
            one = subprocess.run([tools / "hfremesh", source, "-o", whole, "-q", *of_whole, *more], capture_output=True)
            many = subprocess.run(
                ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), tools / "hfremesh-mpi", "parts",
                 source, "-o", parts, "-q", "--threads-each", str(threads), *of_parts, *more],
                capture_output=True, env=environment)  # fmt: skip
            outputs = [path.read_bytes() if path.exists() else None for path in (whole, parts)]
            n_runs += 1
            codes[one.returncode] = codes.get(one.returncode, 0) + 1
            if one.returncode == many.returncode and outputs[0] == outputs[1]:
                continue
            n_bad += 1
            print(f"seed {seed}, {ranks} ranks: {' '.join(of_parts + more)}: exit codes {one.returncode}, {many.returncode}")
            if line.keep:
                line.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, line.keep / f"seed{seed}.mesh")
    shown = ", ".join(f"{n} with exit code {code}" for code, n in sorted(codes.items()))
    print(f"{n_runs} runs ({shown}), {n_bad} differ")
    return 1 if n_bad else 0


if __name__ == "__main__":
    sys.exit(main())
