#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What ranks tell each other in a run over a mesh in parts, measured, and a calculation for more ranks.

Usage: bench/parts_model.py BUILD [--cubes 40 80] [--ranks 2 4 8] [--args ARGS]
                            [--latency S] [--bandwidth B] [--imbalance X] [--cells N ...] [--on P ...]
  BUILD    has hfremesh-mpi
  --cubes  grids of so many cubes a side, jitter 0.2: what is measured
  --args   of the run; all stages without a goal unless given
Prints two Markdown tables. The first is of hfremesh-mpi parts --traffic: figures of the rank that has most. The second is no
measurement: what the largest grid takes a cell, on the smallest number of ranks, of which each has a core, for parts that
are cubes in a mesh of six cells a cube. Nothing of a run on several machines is measured here.
"""
import argparse
import math
import os
import pathlib
import re
import shlex
import subprocess

RANK = re.compile(r"rank \d+: sent (\d+) messages of (\d+) bytes in (\d+) exchanges, (\d+) collectives of (\d+) bytes; "
                  r"(\d+) rounds; part: (\d+) own cells, (\d+) held, (\d+) near others; peak memory (\d+) bytes")
PHASE = re.compile(r"phase ([a-z ]+): [\d.]+ s on rank 0, ([\d.]+) s on the slowest")
COMPUTES = ("alone", "evaluate", "smooth", "tally")


def measure(build, cubes, ranks, args):
    environment = dict(os.environ)
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), build / "apps/hfremesh/hfremesh-mpi",
               "parts", "--generate", *[str(cubes)] * 3, "--jitter", "0.2", *args, "--traffic"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{shlex.join(map(str, command))}: exit code {done.returncode}\n{done.stderr}")
    rows = [[int(x) for x in m.groups()] for m in RANK.finditer(done.stderr)]
    phases = {m[1]: float(m[2]) for m in PHASE.finditer(done.stderr)}
    names = ("messages", "bytes", "exchanges", "collectives", "to_all", "rounds", "own", "held", "border", "memory")
    most = dict(zip(names, map(max, zip(*rows))))
    return most | {"cells": 6 * cubes**3, "ranks": ranks, "total_to_all": sum(row[4] for row in rows),
                   "compute": sum(phases[name] for name in COMPUTES), "border_s": phases["border"] + phases["select"]}


def print_measured(rows):
    print("| cells | ranks | own | held | border | rounds | calls a round | messages a round | bytes a round "
          "| bytes a border cell, run | bytes to all, run | MB |")
    print("|---:" * 12 + "|")
    for r in rows:
        rounds = r["rounds"]
        print(f"| {r['cells']:,} | {r['ranks']} | {r['own']:,} | {r['held']:,} | {r['border']:,} | {rounds} "
              f"| {(r['exchanges'] + r['collectives']) / rounds:.1f} | {r['messages'] / rounds:.1f} "
              f"| {r['bytes'] / rounds:,.0f} | {r['bytes'] / r['border']:.0f} | {r['total_to_all']:,} "
              f"| {r['memory'] / 1e6:.0f} |")


def model(m, growth, cells, ranks, o):
    """Seconds by what they go to, the share of cells held for others, and GB of a rank. `growth`: of the rounds, as a
    power of the number of cells."""
    def near(n, per_rank):  # measured at a grid cut into slabs or blocks: per cube of its interface
        side = (n / 6) ** (1 / 3)
        return per_rank / interface(side, m["ranks"])

    border_face, halo_face = near(m["cells"], m["border"]), near(m["cells"], m["held"] - m["own"])
    face = 6 * (cells / ranks / 6) ** (2 / 3)  # cubes of the surface of a part
    border, halo = border_face * face, halo_face * face
    calls = (m["exchanges"] + m["collectives"]) * (cells / m["cells"]) ** growth
    to_all = m["total_to_all"] / m["cells"] * cells  # what every rank receives
    seconds = {
        "compute": o.imbalance * m["compute"] / m["held"] * (cells / ranks + halo),
        "border": o.imbalance * border * (m["border_s"] + m["bytes"] / o.bandwidth) / m["border"],
        "calls": calls * 2 * max(1.0, math.log2(ranks)) * o.latency,
        "to all": to_all / o.bandwidth,
    }
    return seconds, halo * ranks / cells, m["memory"] / m["held"] * (cells / ranks + halo) / 1e9


def interface(side, ranks):
    """Cubes at which the part with most of a cube that is halved again and again by its longest side meets others."""
    sides, faces = [side] * 3, [0, 0, 0]  # faces: of each axis, how many of its two sides are cut
    while ranks > 1:
        d = sides.index(max(sides))
        sides[d] /= 2
        faces[d] = min(faces[d] + 1, 2)
        ranks //= 2
    area = sides[0] * sides[1] * sides[2]
    return sum(n * area / s for n, s in zip(faces, sides))


def print_model(m, growth, o):
    print("| cells | ranks | compute, s | border, s | calls, s | to all, s | held for others | GB a rank | longest |")
    print("|---:" * 8 + "|---|")
    for cells in o.cells:
        for ranks in o.on:
            seconds, halo, gb = model(m, growth, cells, ranks, o)
            figures = " | ".join(f"{seconds[key]:.3g}" for key in seconds)
            print(f"| {cells:.0e} | {ranks:,} | {figures} | {100 * halo:.0f} % | {gb:.2g} | {max(seconds, key=seconds.get)} |")


def main():
    parser = argparse.ArgumentParser(description="Runs in parts: what ranks say, and more ranks calculated.")
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--cubes", type=int, nargs="+", default=[40, 80])
    parser.add_argument("--ranks", type=int, nargs="+", default=[2, 4, 8])
    parser.add_argument("--args", type=shlex.split, default=["--all-stages"])
    parser.add_argument("--latency", type=float, default=2e-6, help="seconds a message between machines")
    parser.add_argument("--bandwidth", type=float, default=1e10, help="bytes a second into or out of a rank")
    parser.add_argument("--imbalance", type=float, default=1.2, help="slowest rank to mean")
    parser.add_argument("--cells", type=float, nargs="+", default=[1e8, 1e9, 1e10])
    parser.add_argument("--on", type=int, nargs="+", default=[16, 256, 4096])
    o = parser.parse_args()
    rows = [measure(o.build, cubes, ranks, o.args) for cubes in o.cubes for ranks in o.ranks]
    print_measured(rows)
    print()
    of_fewest = [r for r in rows if r["ranks"] == min(o.ranks)]
    small, large = (pick(of_fewest, key=lambda r: r["cells"]) for pick in (min, max))
    growth = 0.0
    if small["cells"] < large["cells"]:
        growth = math.log(large["rounds"] / small["rounds"]) / math.log(large["cells"] / small["cells"])
    print(f"rounds grow with the power {growth:.2f} of the number of cells")
    print_model(large, growth, o)


if __name__ == "__main__":
    main()
