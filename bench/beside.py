#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What becomes of cells that may be mended beside others that nothing mends.

Boxes with jittered vertices, pressed flat along z, beside thin plates of six cells each, or beside single cells that
their own faces hold at a degree: worst angle and 5th percentile of the box alone, and beside so many of either.

usage: bench/beside.py TOOL [TOOL ...] [--kind plates|slivers] [--numbers LIST] [--options "OPTION ..."]
"""
import argparse
import itertools
import json
import math
import pathlib
import random
import subprocess
import tempfile

BOXES = ((4, 0.2, 0.1), (4, 0.3, 0.15), (5, 0.2, 0.1), (5, 0.3, 0.2), (6, 0.3, 0.15), (6, 0.2, 0.1), (6, 0.1, 0.1))
BESIDE = 100.0  # x of what stands beside the box


def cube(first, index):
    """The six cells of a cube, by the numbers of its corners."""
    for order in itertools.permutations(range(3)):
        corner, cell = list(first), [index(*first)]
        for axis in order:
            corner[axis] += 1
            cell.append(index(*corner))
        yield cell


def box(n, jitter, height, seed):
    draw = random.Random(seed)
    points = []
    for place in itertools.product(range(n + 1), repeat=3):
        inside = all(0 < k < n for k in place)
        x, y, z = ((k + (jitter * draw.uniform(-1, 1) if inside else 0)) / n for k in place)
        points.append((x, y, z * height))
    cells = [cell for first in itertools.product(range(n), repeat=3)
             for cell in cube(first, lambda i, j, k: (i * (n + 1) + j) * (n + 1) + k)]
    return points, cells


def put_beside(points, cells, kind, number):
    for i in range(number):
        at, first = BESIDE + 3 * i, len(points)
        if kind == "plates":
            points += [(at + x, y, 0.02 * z) for x, y, z in itertools.product((0, 1), repeat=3)]
            cells += [[first + c for c in cell] for cell in cube((0, 0, 0), lambda i, j, k: 4 * i + 2 * j + k)]
        else:
            half = math.radians(0.5)
            points += [(at - 1, 0, 0), (at + 1, 0, 0), (at, math.sin(half), math.cos(half)),
                       (at, -math.sin(half), math.cos(half))]
            cells.append([first, first + 1, first + 2, first + 3])


def volume(points, cell):
    a, b, c, d = (points[i] for i in cell)
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))


def write(path, points, cells):
    with path.open("w") as out:
        out.write(f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(points)}\n")
        for p in points:
            out.write("{!r} {!r} {!r} 0\n".format(*map(float, p)))
        out.write(f"Tetrahedra\n{len(cells)}\n")
        for cell in cells:
            if volume(points, cell) < 0:
                cell = [cell[1], cell[0], cell[2], cell[3]]
            out.write("{} {} {} {} 0\n".format(*(c + 1 for c in cell)))
        out.write("End\n")


def box_of(path):
    """What the file has of the box, as a file of its own."""
    words = path.read_text().split()
    at = words.index("Vertices") + 1
    points = [tuple(map(float, words[i:i + 3])) for i in range(at + 1, at + 1 + 4 * int(words[at]), 4)]
    at = words.index("Tetrahedra") + 1
    cells = [[int(c) - 1 for c in words[i:i + 4]] for i in range(at + 1, at + 1 + 5 * int(words[at]), 5)]
    kept = [cell for cell in cells if points[cell[0]][0] < BESIDE / 2]
    names = {v: i for i, v in enumerate(sorted({v for cell in kept for v in cell}))}
    write(path, [points[v] for v in names], [[names[v] for v in cell] for cell in kept])


def outcome(tool, mesh, options):
    """Worst angle and 5th percentile of the box."""
    out, report = mesh.with_suffix(".out.mesh"), mesh.with_suffix(".json")
    done = subprocess.run([tool, mesh, "-o", out, "-q", "-j", "1", *options], stderr=subprocess.DEVNULL)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{mesh}: exit code {done.returncode}")
    box_of(out)
    subprocess.run([tool, "stats", out, "-q", "--json", report], check=True)
    found = json.loads(report.read_text())["meshes"][0]["statistics"]["min_dihedral"]
    return found["min"], found["percentiles"]["p5"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tools", nargs="+", type=pathlib.Path)
    parser.add_argument("--kind", choices=("plates", "slivers"), default="plates")
    parser.add_argument("--numbers", default="10,60,400")
    parser.add_argument("--options", default="", help="of improve")
    args = parser.parse_args()
    numbers = [int(n) for n in args.numbers.split(",")]
    sums = {}
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "box.mesh"
        print(f"| box | {args.kind} | " + " | ".join(str(tool) for tool in args.tools) + " |")
        print("|---" * (2 + len(args.tools)) + "|")
        for seed, (n, jitter, height) in enumerate(BOXES, 1):
            for number in [0, *(n for n in numbers if n > 0)]:
                points, cells = box(n, jitter, height, seed)
                put_beside(points, cells, args.kind, number)
                write(mesh, points, cells)
                found = [outcome(tool.resolve(), mesh, args.options.split()) for tool in args.tools]
                print(f"| {n} {jitter} {height} | {number} | "
                      + " | ".join(f"{worst:.2f} / {low:.2f}" for worst, low in found) + " |", flush=True)
                if number > 0:
                    for tool, (worst, low) in zip(args.tools, found):
                        sums.setdefault(tool, []).append((math.log(max(worst, 1e-3)), math.log(max(low, 1e-3))))
    print("| mean | | " + " | ".join(" / ".join(f"{math.exp(sum(v) / len(v)):.2f}" for v in zip(*sums[tool]))
                                  for tool in args.tools) + " |")


if __name__ == "__main__":
    main()
