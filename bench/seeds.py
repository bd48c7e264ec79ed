#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs of one or more tools with several seeds each: what a change does in the mean, and what is chance.

usage: bench/seeds.py MESHES TOOL... [--seeds 4] [--only NAME,... | --any] [--options "--min-dihedral 20"]
With --any the meshes are all files below the folder that the first tool reads: others than those by which numbers
were chosen show what a number is worth.
The worst angle of a hard mesh differs by 5 to 30 % between seeds, which only order ties, so one run beside
another shows little. For each mesh: the geometric mean and the range of the worst angle over the seeds, and
the means of the 1st and 5th percentile (degrees) and of the user seconds on one thread; for each tool after
the first the ratios of these to the first tool's, and their geometric mean over the meshes. Runs of the
tools take turns.
"""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile

from quality_table import ROWS, find

HARD = ["polyfem_screw", "polyfem_microstructure", "gaia_frog_reg", "ipc_dolphin5k", "polyfem_cubes_mm",
        "ipc_armadillo13k", "ipc_hollowcat", "gaia_octopus30k", "gaia_dog"]
SUFFIXES = {".mesh", ".meshb", ".msh", ".vtk", ".vtu", ".ele"}
LEAST = 1e-3  # degrees; worst angles below count as this


def run(tool, mesh, seed, options, folder):
    report = folder / "report.json"
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([tool, mesh, "-o", folder / "out.meshb", "--threads", "1", "--quiet", "--seed", str(seed),
                           "--json", report, *options], check=False)
    if done.returncode not in (0, 3, 4):
        raise SystemExit(f"seeds: {tool} ended with {done.returncode} on {mesh}")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    angles = json.loads(report.read_text())["after"]["min_dihedral"]
    return [max(angles["min"], LEAST), angles["percentiles"]["p1"], angles["percentiles"]["p5"], seconds]


def chosen(asked):
    """Name and file of each mesh."""
    if not asked.any:
        found = ((name, find(asked.meshes, place)) for name, place, _ in ROWS if name in asked.only.split(","))
        return [(name, mesh) for name, mesh in found if mesh is not None]
    meshes = []
    for mesh in sorted(asked.meshes.rglob("*")):
        if mesh.suffix.lower() not in SUFFIXES or not mesh.is_file():
            continue
        read = subprocess.run([asked.tools[0], "stats", mesh], capture_output=True, check=False)
        if read.returncode == 0:
            meshes.append((mesh.name[-24:], mesh))
    return meshes


def mean(values):
    return math.exp(sum(math.log(max(v, LEAST)) for v in values) / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=pathlib.Path, help="folder of the test meshes")
    parser.add_argument("tools", nargs="+")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--any", action="store_true", help="all meshes below the folder")
    parser.add_argument("--only", default=",".join(HARD), help="names of rows of quality_table.py, comma-separated")
    parser.add_argument("--options", default="", help="of the tool, in one word")
    asked = parser.parse_args()
    ratios = [[] for _ in asked.tools]
    seconds = [0.0 for _ in asked.tools]
    with tempfile.TemporaryDirectory(prefix="hfremesh-seeds-") as name:
        for mesh_name, mesh in chosen(asked):
            found = [[] for _ in asked.tools]
            for seed in range(1, asked.seeds + 1):
                for tool, runs in zip(asked.tools, found):
                    runs.append(run(tool, mesh, seed, asked.options.split(), pathlib.Path(name)))
            first = None
            for k, (tool, runs, of_tool) in enumerate(zip(asked.tools, found, ratios)):
                seconds[k] += sum(r[3] for r in runs)
                worst = [r[0] for r in runs]
                means = [mean(column) for column in zip(*runs)]
                first = first or means
                of_tool.append([m / f for m, f in zip(means, first)])
                beside = "" if first is means else "  x " + " / ".join(f"{r:.3f}" for r in of_tool[-1])
                print(f"{mesh_name:24} {tool}: {means[0]:.2f} ({min(worst):.2f} to {max(worst):.2f}) / {means[1]:.1f} / "
                      f"{means[2]:.1f}, {means[3]:.2f} s{beside}", flush=True)
    for tool, of_tool, taken in zip(asked.tools[1:], ratios[1:], seconds[1:]):
        overall = " / ".join(f"{mean(column):.3f}" for column in zip(*of_tool))
        print(f"{tool} beside {asked.tools[0]}, {len(of_tool)} meshes: worst / p1 / p5 / seconds x {overall}; "
              f"all runs {taken:.1f} s, {taken / max(seconds[0], LEAST):.2f} of {seconds[0]:.1f} s")


if __name__ == "__main__":
    main()
