#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times of improve() by phase for 1, 2, 4, ... threads, as Markdown; checks that all outputs are the same bytes.

usage: bench/scaling.py TOOL MESH [--threads 1,2,4,8,16] [--repeat 3] [-- OPTIONS OF THE TOOL]
Each figure is the median of the repeats. Run it on an idle machine that has the cores.
"""
import argparse
import hashlib
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

PHASES = ("evaluate", "select", "commit")


def one_run(tool, mesh, threads, extra, folder):
    report, out = folder / "report.json", folder / "out.meshb"
    command = [tool, mesh, "-o", out, "-q", "-j", str(threads), "--json", report, *extra]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3, 4):
        sys.exit(f"scaling: {' '.join(map(str, command))}: {done.stderr.strip()}")
    data = json.loads(report.read_text())
    times = {phase: sum(p["seconds"][phase] for p in data["passes"]) for phase in PHASES}
    times["total"] = data["seconds"]["improve"]
    times["other"] = times["total"] - sum(times[phase] for phase in PHASES)
    return times, hashlib.sha256(out.read_bytes()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("mesh")
    parser.add_argument("--threads", default="1,2,4,8,16")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("extra", nargs="*", help="options of the tool, after --")
    options = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-scaling-"))
    print(f"{pathlib.Path(options.mesh).name}, {os.cpu_count()} cores, median of {options.repeat}, seconds; ratio to one thread")
    print()
    columns = (*PHASES, "other", "total")
    print("| threads | " + " | ".join(columns) + " | total, times faster | evaluate, times faster |")
    print("|---" * (len(columns) + 3) + "|")
    first, digests = None, set()
    for threads in map(int, options.threads.split(",")):
        runs = []
        for _ in range(options.repeat):
            times, digest = one_run(options.tool, options.mesh, threads, options.extra, folder)
            runs.append(times)
            digests.add(digest)
        median = {c: statistics.median(r[c] for r in runs) for c in columns}
        first = first or median
        print(f"| {threads} | " + " | ".join(f"{median[c]:.3f}" for c in columns) +
              f" | {first['total'] / median['total']:.2f} | {first['evaluate'] / median['evaluate']:.2f} |")
    print()
    if len(digests) != 1:
        sys.exit(f"scaling: {len(digests)} different outputs: this is a fault")
    print(f"All outputs are the same bytes (sha256 {digests.pop()[:16]}…).")


if __name__ == "__main__":
    main()
