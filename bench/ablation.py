#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What each number of the strategy and each stage buys: runs with it multiplied, or left out.

usage: bench/ablation.py MESHES BENCH_ABLATION RESULTS [--only NAME,...] [--rows NAME,...] [--seeds 2]
                         [--options "--goal 20"] [--table]
RESULTS is a file of JSON lines, one a run. Runs that it has are not made again, so an interrupted series goes
on where it stopped; --table makes none. The table has a line for each number and factor: ratios to the runs
with nothing changed, geometric means over meshes and seeds, of the worst angle (below half a degree counts as
half a degree), the 1st and 5th percentile, cells and CPU seconds on one thread; and the mesh that loses most of
its worst angle. "other seeds" is what chance does: the means over half of the seeds beside the other half. A row
that stays within that buys nothing on these meshes.
"""
import argparse
import json
import math
import pathlib
import subprocess

from quality_table import ROWS, find

HARD = ["cavity20k", "stellar_house2", "random50k", "ipc_rod300x33", "polyfem_cubes_mm", "ipc_armadillo13k",
        "ipc_hollowcat", "cleaver_short", "cleaver_segmentation", "polyfem_microstructure", "ipc_dolphin5k",
        "polyfem_screw"]
LEAST = 0.5  # degrees; smaller angles count as this
MEASURES = ["min", "p1", "p5", "cells", "seconds"]


def listed(program):
    lines = subprocess.run([program, "--list"], check=True, text=True, capture_output=True).stdout.splitlines()
    return [(words[0], float(factor)) for words in map(str.split, lines) for factor in words[1:]]


def read(path):
    runs = {}
    if path.exists():
        for line in path.read_text().splitlines():
            run = json.loads(line)
            runs[run["row"], run["factor"], run["mesh"], run["seed"], run["options"]] = run
    return runs


def measure(program, mesh, row, factor, seed, options):
    change = [] if row == "-" else ["--set", row, str(factor)]
    done = subprocess.run([program, mesh, "--seed", str(seed), *options.split(), *change], check=True, text=True,
                          capture_output=True)
    return json.loads(done.stdout)


def value(run, name):
    return max(run[name], LEAST) if name in ("min", "p1", "p5") else max(run[name], 1e-3)


def mean(values):
    return math.exp(sum(map(math.log, values)) / len(values)) if values else math.nan


def ratios(runs, base):
    """Of runs and of those to compare with, both by (mesh, seed): means, and the mesh that loses most."""
    means = [mean([value(runs[k], m) / value(base[k], m) for k in runs]) for m in MEASURES]
    by_mesh = {}
    for mesh, seed in runs:
        by_mesh.setdefault(mesh, []).append(value(runs[mesh, seed], "min") / value(base[mesh, seed], "min"))
    worst = min(by_mesh, key=lambda mesh: mean(by_mesh[mesh]))
    return means, worst, mean(by_mesh[worst])


def line(name, factor, found):
    means, worst, loss = found
    return f"| {name} | {factor} | " + " | ".join(f"{m:.3f}" for m in means) + f" | {worst} {loss:.2f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=pathlib.Path, help="folder of the test meshes")
    parser.add_argument("program", help="bench_ablation")
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--only", default=",".join(HARD), help="names of rows of quality_table.py, or files")
    parser.add_argument("--rows", default="", help="beginnings of names of numbers, comma-separated")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--options", default="", help="of bench_ablation, in one word")
    parser.add_argument("--table", action="store_true", help="only print what RESULTS has")
    asked = parser.parse_args()
    wanted = tuple(asked.rows.split(","))
    rows = [("-", 1.0)] + [r for r in listed(asked.program) if r[0].startswith(wanted)]
    places = {name: find(asked.meshes, place) for name, place, _ in ROWS if name in asked.only.split(",")}
    places |= {pathlib.Path(name).stem: name for name in asked.only.split(",") if pathlib.Path(name).is_file()}
    runs = read(asked.results)
    seeds = range(1, asked.seeds + 1)
    with asked.results.open("a") as results:
        for row, factor in [] if asked.table else rows:
            for name, place in places.items():
                # Of nothing changed, twice the seeds: the other half shows what chance does.
                for seed in range(1, asked.seeds * (2 if row == "-" else 1) + 1):
                    key = (row, factor, name, seed, asked.options)
                    if key in runs or place is None:
                        continue
                    run = measure(asked.program, place, row, factor, seed, asked.options)
                    runs[key] = run | dict(zip(("row", "factor", "mesh", "seed", "options"), key))
                    print(json.dumps(runs[key]), file=results, flush=True)

    def of(row, factor, chosen):
        return {(name, seed): runs[row, factor, name, seed, asked.options] for name in places for seed in chosen
                if (row, factor, name, seed, asked.options) in runs}

    base = of("-", 1.0, seeds)
    print("| number | times | worst | p1 | p5 | cells | seconds | loses most |\n|---|---|---|---|---|---|---|---|")
    others = {(name, seed - asked.seeds): run
              for (name, seed), run in of("-", 1.0, range(asked.seeds + 1, 2 * asked.seeds + 1)).items()}
    if others:
        print(line("other seeds", "", ratios(others, base)))
    for row, factor in rows[1:]:
        found = of(row, factor, seeds)
        if found:
            print(line(row, "off" if factor == 0 else f"{factor:g}", ratios(found, base)))


if __name__ == "__main__":
    main()
