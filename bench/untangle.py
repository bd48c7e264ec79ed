#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many tangled meshes are repaired, and how fast.

Random boxes: every inner vertex, and those of the sides in their planes, moved at random until up to a third of the
cells are inverted. Where a triangle of a side is turned over, its cell is inverted in every mesh with this boundary:
such a box must end with exit code 4, the folded faces listed, and no invalid cell but at these. Random balls: the same
with the surface left as it is, so that all must be repaired. Then some test meshes, the cavity and the bulk-shear
field at rising amplitudes: cells a second of the untangling passes, the whole mesh counted.

usage: bench/untangle.py TOOL [MESHES] [--seeds N] [--jitters LIST] [--threads N] [--output FILE]
MESHES is the folder of the test meshes.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

JITTERS = "0.3,0.35,0.4,0.5,0.6,0.8,1.0"
FILES = ("tangled/bad2.mesh", "tangled/j0.6.mesh", "tangled/j1.0.mesh", "cleaver_short/output.node",
         "cleaver_segmentation/output.node", "polyfem_microstructure/P1.msh", "cavity/cavity20k.mesh")
FIELDS = [("cavity", a, f"--sigma 0.08 --amplitude {a}") for a in (0.30, 0.35, 0.45)] + [
    ("bulk shear", a, f"--field bulk-shear --amplitude {a}") for a in (0.16, 0.18, 0.2)]


class Runner:
    def __init__(self, tool, threads):
        self.tool, self.threads = tool, threads
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-bench-"))

    def repair(self, *generate):
        """The report of a run that only repairs, and its exit code."""
        self.mesh = self.folder / "in.mesh"
        subprocess.run([self.tool, "generate", *generate, "-q", "-o", self.mesh], check=True)
        return self.repair_file(self.mesh)

    def repair_file(self, mesh):
        report = self.folder / "report.json"
        done = subprocess.run([self.tool, mesh, "-o", self.folder / "out.mesh", "-q", "-j", str(self.threads),
                               "--min-dihedral", "0.001", "--json", report], stderr=subprocess.DEVNULL)
        return json.loads(report.read_text()), done.returncode


def invalid(statistics):
    return statistics["inverted"] + statistics["flat"]


def cells_at_turned_triangles(mesh):
    """Cells with a boundary triangle in a side of the unit cube that is turned over: inverted in every mesh."""
    words = mesh.read_text().split()
    at, n = words.index("Vertices") + 2, int(words[words.index("Vertices") + 1])
    points = [tuple(map(float, words[at + 4 * i: at + 4 * i + 3])) for i in range(n)]
    at, n = words.index("Tetrahedra") + 2, int(words[words.index("Tetrahedra") + 1])
    cells = [tuple(int(w) - 1 for w in words[at + 5 * i: at + 5 * i + 4]) for i in range(n)]
    faces = {}
    for a, b, c, d in cells:
        for face in ((a, c, b), (a, b, d), (a, d, c), (b, c, d)):  # seen from outside
            key = tuple(sorted(face))
            faces[key] = None if key in faces else (face, (a, b, c, d))
    turned = set()
    for found in filter(None, faces.values()):
        p, q, r = (points[v] for v in found[0])
        for axis in range(3):
            for side in (0.0, 1.0):
                if not p[axis] == q[axis] == r[axis] == side:
                    continue
                i, j = (axis + 1) % 3, (axis + 2) % 3
                area = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i])
                if (area if side == 1.0 else -area) <= 0:
                    turned.add(found[1])
    return len(turned)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the hfremesh program")
    parser.add_argument("meshes", nargs="?", type=pathlib.Path, help="folder of the test meshes")
    parser.add_argument("--seeds", type=int, default=100, help="boxes, and balls, of each jitter")
    parser.add_argument("--jitters", default=JITTERS, help="comma-separated; of the boxes")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--output", help="Markdown file to write (default: standard output)")
    options = parser.parse_args()
    runner = Runner(options.tool, options.threads)
    lines = ["| jitter | inverted, % | repaired | exit 4, folded surface | cells at triangles turned over | "
             "invalid cells left | of these away from folds | worse | s a box |", "|---|---|---|---|---|---|---|---|---|"]
    for jitter in filter(None, options.jitters.split(",")):
        share = repaired = folded = turned = left = elsewhere = worse = seconds = 0
        for seed in range(1, options.seeds + 1):
            report, code = runner.repair("box", "--n", "9", "9", "10", "--jitter", str(jitter), "--seed", str(seed))
            before, after = report["before"], report["after"]
            share += 100 * invalid(before) / before["cells"] / options.seeds
            seconds += report["seconds"]["improve"] / options.seeds
            repaired += code == 0
            worse += invalid(after) > invalid(before)
            if code == 4 and (report["result"]["n_unfillable_faces"] == 0 or
                              invalid(after) > report["limits"]["counts"]["folded surface"]):
                print(f"untangle: jitter {jitter}, seed {seed}: invalid cells where nothing is folded", file=sys.stderr)
            if code == 4:
                folded += report["result"]["n_unfillable_faces"] > 0
                turned += cells_at_turned_triangles(runner.folder / "out.mesh")
                left += invalid(after)
                elsewhere += invalid(after) - report["limits"]["counts"]["folded surface"]
        lines.append(f"| {jitter} | {share:.1f} | {repaired} | {folded} | {turned} | {left} | {elsewhere} | {worse} | {seconds:.2f} |")
        print(lines[-1], file=sys.stderr)
    lines += ["", "| ball, jitter | cells | inverted, % | repaired | s a ball |", "|---|---|---|---|---|"]
    for jitter in (0.4, 0.6, 0.8, 1.0, 1.2):
        share = repaired = seconds = 0
        for seed in range(1, options.seeds + 1):
            report, code = runner.repair("ball", "--n", "6", "--jitter", str(jitter), "--seed", str(seed))
            share += 100 * invalid(report["before"]) / report["before"]["cells"] / options.seeds
            seconds += report["seconds"]["improve"] / options.seeds
            repaired += code == 0
        lines.append(f"| {jitter} | {report['before']['cells']:,} | {share:.1f} | {repaired} | {seconds:.2f} |")
        print(lines[-1], file=sys.stderr)
    lines += ["", "| mesh | cells | inverted | left | volume error | s |", "|---|---|---|---|---|---|"]
    for name in FILES if options.meshes else ():
        if not (options.meshes / name).is_file():
            continue
        report, _ = runner.repair_file(options.meshes / name)
        before, after = report["before"], report["after"]
        lines.append(f"| {name} | {before['cells']:,} | {invalid(before)} | {invalid(after)} | "
                     f"{abs(after['volume'] / before['enclosed_volume'] - 1):.1e} | {report['seconds']['improve']:.2f} |")
        print(lines[-1], file=sys.stderr)
    lines += ["", "| field | amplitude | cells | inverted | left | volume error | untangling, s | cells a second |",
              "|---|---|---|---|---|---|---|---|"]
    for name, amplitude, arguments in FIELDS:
        report, _ = runner.repair("cavity", "--n", "44", "46", "50", "--jitter", "0.201", *arguments.split())
        before, after = report["before"], report["after"]
        seconds = sum(p["seconds"]["total"] for p in report["passes"] if p["stage"] == "untangle")
        rate = f"{before['cells'] / seconds:,.0f}" if seconds > 0 else ""
        lines.append(f"| {name} | {amplitude} | {before['cells']:,} | {invalid(before):,} | {invalid(after)} | "
                     f"{abs(after['volume'] / before['enclosed_volume'] - 1):.1e} | {seconds:.2f} | {rate} |")
        print(lines[-1], file=sys.stderr)
    text = "\n".join(lines) + "\n"
    if options.output:
        pathlib.Path(options.output).write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
