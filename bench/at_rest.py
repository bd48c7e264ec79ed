#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Meshes whose boundary has moved away from an interior that stayed: how many inverted cells are left, and how soon.

A motion of all vertices, boundary and interior, by which each cell stays positive, so that a mesh without inverted cells
exists that is connected as the old one; of it only the boundary has moved. Boxes of cubes, and the files that are given:
bent, twisted and pressed along their longest side. Of bent and twisted files some cells may be inverted by the motion
itself, which is said.

usage: bench/at_rest.py TOOL [MESH ...] [--against TOOL] [--limit SECONDS] [--options OPTIONS]
With --against each run is made with both tools, one after the other. Runs take one thread.
"""
import argparse
import json
import math
import pathlib
import resource
import shlex
import subprocess
import tempfile


def read_medit(path):
    words = path.read_text().split()

    def section(name, width):
        at, n = words.index(name) + 2, int(words[words.index(name) + 1])
        return [words[at + width * i:at + width * (i + 1)] for i in range(n)]
    points = [tuple(map(float, row[:3])) for row in section("Vertices", 4)]
    return points, [tuple(int(w) - 1 for w in row[:4]) for row in section("Tetrahedra", 5)]


def write_medit(path, points, cells):
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += [f"{x!r} {y!r} {z!r} 0" for x, y, z in points]
    lines += ["Tetrahedra", str(len(cells))] + [" ".join(str(i + 1) for i in cell) + " 0" for cell in cells]
    path.write_text("\n".join(lines + ["End", ""]))


def boundary(cells):
    """Vertices of the faces that have one cell."""
    count = {}
    for a, b, c, d in cells:
        for face in ((b, c, d), (a, c, d), (a, b, d), (a, b, c)):
            key = tuple(sorted(face))
            count[key] = count.get(key, 0) + 1
    return {v for face, n in count.items() if n == 1 for v in face}


def n_not_positive(points, cells):
    n = 0
    for a, b, c, d in cells:
        u, v, w = ([points[k][i] - points[a][i] for i in range(3)] for k in (b, c, d))
        n += (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2] <= 0
    return n


class Frame:
    """A box round points: coordinates along its longest side first, from its middle, in lengths of that side."""

    def __init__(self, points):
        low, high = ([f(p[i] for p in points) for i in range(3)] for f in (min, max))
        self.middle = [(a + b) / 2 for a, b in zip(low, high)]
        self.axis = max(range(3), key=lambda i: high[i] - low[i])
        self.length = high[self.axis] - low[self.axis]

    def move(self, motion, p):
        order = [(self.axis + i) % 3 for i in range(3)]
        q = motion(*((p[i] - self.middle[i]) / self.length for i in order))
        moved = [0.0] * 3
        for i, value in zip(order, q):
            moved[i] = self.middle[i] + self.length * value
        return tuple(moved)


def bent(angle):
    def motion(x, y, z):
        radius = 1.3 / angle + y
        return radius * math.sin(angle * x), radius * math.cos(angle * x) - 1.3 / angle, z
    return motion


def twisted(angle):
    return lambda x, y, z: (x, y * math.cos(angle * x) - z * math.sin(angle * x),
                            y * math.sin(angle * x) + z * math.cos(angle * x))


BOXES = [  # cubes along the sides, and the motion
    ("shifted", (16, 16, 16), lambda x, y, z: (x + 0.56, y, z)),
    ("sheared", (16, 16, 16), lambda x, y, z: (x + 1.2 * y, y, z)),
    ("pressed to a fifth", (16, 16, 16), lambda x, y, z: (x, y, 0.2 * z)),
    ("pressed to two fifths", (40, 40, 40), lambda x, y, z: (x, y, 0.4 * z)),
    ("shrunk to a third", (16, 16, 16), lambda x, y, z: (0.3 * x, 0.3 * y, 0.3 * z)),
    ("turned by 90 degrees", (16, 16, 16), lambda x, y, z: (x, -z, y)),
    ("turned over", (16, 16, 16), lambda x, y, z: (x, -y, -z)),
    ("bent", (30, 6, 6), bent(2.0)),
    ("bent", (50, 10, 10), bent(2.0)),
    ("twisted", (50, 10, 10), twisted(5.0)),
    ("bowed", (24, 24, 24), lambda x, y, z: (x + 0.58 * math.cos(math.pi * y), y, z)),
]
MOTIONS = [("bent", bent(1.2)), ("twisted", twisted(1.5)), ("pressed", lambda x, y, z: (x, 0.5 * y, z))]


class Bench:
    def __init__(self, tools, limit, options):
        self.tools, self.limit, self.options = tools, limit, options
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-bench-"))
        self.mesh = self.folder / "in.mesh"

    def load(self, *command):
        subprocess.run([self.tools[0], *command, "-q", "-o", self.mesh], check=True)
        return read_medit(self.mesh)

    def run(self, tool):
        report = self.folder / "report.json"
        report.unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        try:
            subprocess.run([tool, self.mesh, "-o", self.folder / "out.mesh", "-q", "-j", "1", "--json", report, *self.options],
                           stderr=subprocess.DEVNULL, timeout=self.limit)
        except subprocess.TimeoutExpired:
            return f"over {self.limit:.0f} s"
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        after = json.loads(report.read_text())["after"]
        return f"{after['inverted'] + after['flat']}, {seconds:.2f} s"

    def row(self, name, points, cells, motion):
        frame = Frame(points)
        all_moved = [frame.move(motion, p) for p in points]
        rim = boundary(cells)
        moved = [all_moved[i] if i in rim else p for i, p in enumerate(points)]
        write_medit(self.mesh, moved, cells)
        by_motion = n_not_positive(all_moved, cells)
        print("|", " | ".join([name + (f" ({by_motion} by the motion)" if by_motion else ""), f"{len(cells):,}",
                               f"{n_not_positive(moved, cells):,}", *map(self.run, self.tools)]), "|", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--against")
    parser.add_argument("--limit", type=float, default=120)
    parser.add_argument("--options", default="--min-dihedral 0.001", help="of each run")
    given = parser.parse_args()
    bench = Bench([given.against, given.tool] if given.against else [given.tool], given.limit, shlex.split(given.options))
    print("| mesh | cells | inverted |", "before: left | now: left |" if given.against else "left |")
    print("|---|---|---|---|" + ("---|" if given.against else ""))
    for name, counts, motion in BOXES:
        points, cells = bench.load("generate", "box", "--n", *map(str, counts), "--high", *(str(c / max(counts)) for c in counts))
        bench.row(f"{' × '.join(map(str, counts))} cubes, {name}", points, cells, motion)
    for mesh in given.meshes:
        points, cells = bench.load("convert", mesh)
        for name, motion in MOTIONS:
            bench.row(f"{pathlib.Path(mesh).parent.name}, {name}", points, cells, motion)


if __name__ == "__main__":
    main()
