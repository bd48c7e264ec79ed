#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints what bench/device.sh has measured on one mesh, as Markdown.

Usage: bench/device_table.py FOLDER                 with the tool's reports cpu.json, device.json, hybrid.json
                                                    and profile.json
       bench/device_table.py --microseconds REPORT  of improving alone

Bytes and operations are what the algorithm has to move and to compute for the counts in the report, every
datum once an item: a ring of 5 cells, a star of 23, nothing kept in a cache from one item to the next, and
no word about what the memory adds by moving whole lines. Kernels that have no such figure get a dash.
"""
import json
import sys

RING, STAR = 5, 23          # mean cells of an edge and of a vertex
LINK = STAR // 2 + 2        # vertices of its link
CELL, POINT, QUALITY = 32, 24, 8  # bytes
DECISION = 72               # operations of one volume-length


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def seconds(run):
    """Of improve(), without opening the device and compiling."""
    return run["seconds"]["improve"] - (run["device"]["seconds_open"] if run.get("device") else 0.0)


def bulk(run, there_only=False):
    return sum(p["seconds"]["total"] for p in run["passes"]
               if p["stage"] == "bulk" and (p["on_device"] or not there_only))


def over_few(run):
    """Passes over few seeds, wherever they ran: what is left for the last cells."""
    return sum(p["seconds"]["total"] for p in run["passes"] if p["seeds"] < 2000)


def items(run, op, what):
    return sum(p[what] for p in run["passes"] if p["on_device"] and p["op"] == op)


def work(run):
    """Kernel -> (items over all launches, or None for cells a launch; bytes an item; operations an item)."""
    edges, faces = items(run, "edge", "seeds"), items(run, "face", "seeds")
    removed, swapped = items(run, "edge", "winners"), items(run, "face", "winners")
    vertices = items(run, "smooth", "seeds")
    stars, collapsed = items(run, "node", "seeds"), items(run, "node", "winners")
    triangles = RING * (RING - 1) * (RING - 2) // 6
    created = 2 * (RING - 2)
    newton = 3 * STAR * (60 + 2 * 25) + STAR * (40 + DECISION)
    smooth = (vertices, STAR * (4 + CELL + 3 * POINT + QUALITY) + STAR * (QUALITY + 1 + 4 * 4),
              newton)
    # Most apexes are refused by the second cell.
    star = (stars, STAR * (CELL + QUALITY) + LINK * POINT, 2 * LINK * DECISION)
    return {
        "search_edges": (edges, RING * (CELL + QUALITY) + (RING + 2) * POINT,
                         triangles * 1.5 * DECISION),
        "search_faces": (faces, 2 * (CELL + QUALITY) + 5 * POINT, 1.3 * DECISION),
        "search_all_stars": star,
        "search_small_stars": star,
        "commit_stars": (collapsed, 2 * STAR * CELL + 4 * 4 * STAR + 2 * 4 * STAR, 0),
        "smooth_all_stars": smooth,
        "smooth_small_stars": smooth,
        "list_cells": (None, QUALITY + 1 + 1, 2),
        "write_flagged": (None, 1, 1),
        "gather_links": (None, CELL + 4 * 4, 0),
        "prepare_colours": (vertices, STAR * (2 * 4 + CELL + 4 * 4), 0),
        "colour_level": (vertices, STAR * (4 + CELL + 4 * (1 + 4 + 4)), 0),
        "commit_edges": (removed, (RING + created) * CELL + 4 * 2 * RING * 4 + 12 * RING * 4, 0),
        "commit_faces": (swapped, 5 * CELL + 6 * 4 + 7 * 8, 0),
        "commit_mates": (removed, created * (CELL + 4 * POINT + 4 * 12 + QUALITY + 1), created * DECISION),
        "tally_qualities": (None, QUALITY, 1),
        "tally_dihedrals": (None, CELL + 4 * POINT, 180),
    }


def main():
    if sys.argv[1] == "--microseconds":
        print(round(1e6 * seconds(load(sys.argv[2]))))
        return
    folder = sys.argv[1]
    runs = {label: load(f"{folder}/{label}.json") for label in ("cpu", "device", "hybrid")}
    cpu = seconds(runs["cpu"])
    print("| run | improve, s | of the processor's | bulk stage, s | on the device, s | passes over fewer than 2,000 "
          "seeds, s | opened in, s |")
    print("|---|---|---|---|---|---|---|")
    for label, run in runs.items():
        opened = run["device"]["seconds_open"] if run.get("device") else 0.0
        name = f"cpu, {run['threads']} threads" if label == "cpu" else label
        print(f"| {name} | {seconds(run):.3f} | {seconds(run) / cpu:.2f} | {bulk(run):.3f} | "
              f"{bulk(run, True):.3f} | {over_few(run):.3f} | {opened:.3f} |")
    profile = load(f"{folder}/profile.json")
    n_cells = profile["before"]["cells"]
    known = work(profile)
    print()
    print("| kernel | launches | s | GB | GB/s | Gop | Gop/s |")
    print("|---|---|---|---|---|---|---|")
    kernels = profile["device"]["kernels"]
    for kernel in kernels[:16]:
        name, launches, time = kernel["kernel"], kernel["launches"], kernel["seconds"]
        columns = ["–"] * 4
        if name in known and time > 0:
            n, n_bytes, n_ops = known[name]
            n = n_cells * launches if n is None else n
            columns = [f"{n * n_bytes * 1e-9:.3f}", f"{n * n_bytes * 1e-9 / time:.1f}",
                       f"{n * n_ops * 1e-9:.3f}", f"{n * n_ops * 1e-9 / time:.1f}"]
        print(f"| `{name}` | {launches} | {time:.4f} | " + " | ".join(columns) + " |")
    rest = kernels[16:]
    print(f"| {len(rest)} others | {sum(k['launches'] for k in rest)} | "
          f"{sum(k['seconds'] for k in rest):.4f} | – | – | – | – |")


if __name__ == "__main__":
    main()
