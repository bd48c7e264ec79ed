#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What becomes of a mesh whose walls are folded over, because vertices stayed where a lid or a body came.

A box of cubes whose lid is lowered past vertices of its walls and of the straight edges between them, and one with a
square body that moves through resting vertices, over the walls that it ends at: for each depth the inverted cells that
come in, and for each surface mode the inverted and flat ones that are left, the worst angle and the seconds.

usage: bench/folded_walls.py TOOL [TOOL ...] [--cubes N] [--modes frozen,flat,free]
       bench/folded_walls.py --write FOLDER [--cubes N]    only writes the meshes
"""
import argparse
import itertools
import json
import pathlib
import subprocess
import tempfile


def box(n, is_there=lambda middle: True):
    """Points and cells of n[0] · n[1] · n[2] cubes of side 1, of those that are there."""
    number = {}
    cells = []
    for first in itertools.product(*map(range, n)):
        if not is_there([k + 0.5 for k in first]):
            continue
        for order in itertools.permutations(range(3)):
            corner, cell = list(first), [tuple(first)]
            for axis in order:
                corner[axis] += 1
                cell.append(tuple(corner))
            if order not in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
                cell[1], cell[2] = cell[2], cell[1]
            cells.append([number.setdefault(c, len(number)) for c in cell])
    return [list(map(float, p)) for p in number], cells


def lid(n, depth):
    points, cells = box((n, n, n))
    for p in points:
        if p[2] == n:
            p[2] -= depth * n
    return points, cells


def body(n, depth):
    low, high = 0.375 * n, 0.625 * n
    points, cells = box((n // 2, n, n), lambda middle: not all(low < x < high for x in middle[1:]))
    for p in points:
        if all(low <= x <= high for x in p[1:]):
            p[1] += depth * n
    return points, cells


def write(path, points, cells):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(points)}\n")
        file.writelines(f"{x!r} {y!r} {z!r} 0\n" for x, y, z in points)
        file.write(f"Tetrahedra\n{len(cells)}\n")
        file.writelines(" ".join(str(c + 1) for c in cell) + " 0\n" for cell in cells)
        file.write("End\n")


def run(tool, path, mode):
    report = path.with_suffix(".json")
    report.unlink(missing_ok=True)
    subprocess.run([tool, path, "-o", path.with_suffix(".out.mesh"), "--surface", mode, "--threads", "1", "-q",
                    "--json", report], check=False, stderr=subprocess.DEVNULL)
    return json.loads(report.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", nargs="*", metavar="TOOL")
    parser.add_argument("--write", type=pathlib.Path, metavar="FOLDER")
    parser.add_argument("--cubes", type=int, default=8, help="along a side, a multiple of 8 (8)")
    parser.add_argument("--modes", default="frozen,flat,free")
    args = parser.parse_args()
    if args.cubes < 8 or args.cubes % 8 != 0:
        parser.error("--cubes must be a multiple of 8")
    modes = args.modes.split(",")
    cases = [("lid", lid, depth) for depth in (0.2, 0.5, 0.8)] + [("body", body, depth) for depth in (0.2, 0.3)]
    if args.write:
        for name, make, depth in cases:
            write(args.write / f"{name}-{depth}.mesh", *make(args.cubes, depth))
        return
    print("| | cells | inverted | " + " | ".join(f"{m}: left, worst angle, s" for m in modes) + " |")
    print("|---" * (3 + len(modes)) + "|")
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "folded.mesh"
        for name, make, depth in cases:
            write(path, *make(args.cubes, depth))
            for tool in args.tools:
                results = [run(tool, path, mode) for mode in modes]
                before = results[0]["before"]
                cells = [f"{r['after']['inverted'] + r['after']['flat']}, {r['after']['min_dihedral']['min']:.2f}, "
                         f"{r['seconds']['improve']:.2f}" for r in results]
                print(f"| {name}, {depth} | {before['cells']:,} | {before['inverted']} | " + " | ".join(cells) + " |",
                      flush=True)


if __name__ == "__main__":
    main()
