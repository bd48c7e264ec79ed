#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A calculation, no measurement: a goal run's shared passes on many ranks, from the figures of docs/distributed.md.

Usage: bench/distributed_model.py [--latency S] [--bandwidth B] [--imbalance X] [--cells N ...] [--ranks P ...]
Each constant below is a figure of bench/distributed_traffic.sh on c80 (PHASES=1) unless its line says otherwise. Parts are
taken for cubes in a mesh of six cells a cube. Prints a Markdown table, seconds a run, and what takes longest.
"""
import argparse
import math

MEASURED = {
    "rounds": 59,  # shared rounds and smoothing passes of a run
    "calls": 6.4,  # a round: reductions of all ranks
    "evaluate": 0.09e-6,  # seconds an own cell and run: lists, evaluation, commits
    "border": 0.8e-6,  # seconds a border cell and run
    "border_face": 36,  # border cells for each cube of the interface of a part
    "halo_face": 18,  # of them other ranks'
    "message": 700,  # bytes that a rank sends for a winner in its border
    "winner": 0.0053,  # winners for each cell, over a run
    "slot": 56 + 8 * 1.5,  # bytes a winner to all ranks
    "slot_seconds": 0.3e-6,  # to sort and walk through a winner, on each rank: a guess
    "cell_bytes": 107,  # bytes a held cell in the two hand-overs of a run, its vertices included
    "hand_out": 0.3e-6,  # seconds a cell on rank 0 in both: cutting, messages, putting together
    "whole": 200,  # bytes a cell on rank 0, at its peak with two ranks
    "part": 132,  # bytes a held cell on another rank
}
LARGEST = 2**32 // 12  # cells that the 32-bit handles of half-edges in the mesh of rank 0 can name


def model(cells, ranks, o):
    m = MEASURED
    side = (cells / ranks / 6) ** (1 / 3)  # cubes
    face = 6 * side * side
    border, halo = m["border_face"] * face, m["halo_face"] * face
    winners = m["winner"] * cells
    hops = max(1.0, math.log2(ranks))
    seconds = {
        "evaluate": o.imbalance * m["evaluate"] * cells / ranks,
        "border": o.imbalance * m["border"] * border + m["winner"] * border * m["message"] / o.bandwidth,
        "calls": m["rounds"] * m["calls"] * 2 * hops * o.latency,
        "slots": winners * (m["slot"] / o.bandwidth + m["slot_seconds"]),
        "hand over": cells * (m["hand_out"] + m["cell_bytes"] * (1 + halo * ranks / cells) / o.bandwidth),
    }
    return seconds, m["whole"] * cells, m["part"] * (cells / ranks + halo), halo * ranks / cells


def main():
    parser = argparse.ArgumentParser(description="Shared passes on many ranks: a calculation.")
    parser.add_argument("--latency", type=float, default=2e-6, help="seconds a message between machines")
    parser.add_argument("--bandwidth", type=float, default=1e10, help="bytes a second into or out of a rank")
    parser.add_argument("--imbalance", type=float, default=1.2, help="slowest rank to mean")
    parser.add_argument("--cells", type=float, nargs="+", default=[1e8, 1e9, 1e10])
    parser.add_argument("--ranks", type=int, nargs="+", default=[16, 256, 4096])
    o = parser.parse_args()
    print("| cells | ranks | evaluate | border | calls | slots | hand over | halo | rank 0, GB | others, GB | longest |")
    print("|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|")
    for cells in o.cells:
        for ranks in o.ranks:
            seconds, whole, part, halo = model(cells, ranks, o)
            longest = max(seconds, key=seconds.get)
            note = longest if cells <= LARGEST else f"{longest}; handles of rank 0 end at {LARGEST:.1e} cells"
            figures = " | ".join(f"{seconds[key]:.3g}" for key in seconds)
            print(f"| {cells:.0e} | {ranks:,} | {figures} | {100 * halo:.0f} % | {whole / 1e9:,.0f} | {part / 1e9:.2f} "
                  f"| {note} |")


if __name__ == "__main__":
    main()
