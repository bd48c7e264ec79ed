#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Share of a run's time in which only one thread works (Linux, GNU's OpenMP).

usage: bench/one_thread.py TOOL LIBRARY MESH... [--threads 2] [--runs 3] [-- OPTIONS OF THE TOOL]
LIBRARY is bench/libone_thread.so of a build with -DHFR_BENCH=ON. It notes when each thread of each parallel region
begins and ends its work. One thread works alone between regions, until the second one has come to work, and after
the last but one is done. The table tells these apart: "serial" is code outside of regions, "waking" and "waiting"
are what threads lose at both ends of a region. The window is what the tool reports as `improve`; reading, building
and writing are left out. On a busy machine threads come late, so "waking" says more of the machine than of the tool.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time


def shares(log, begin, end):
    """Seconds in [begin, end] that are serial, waking, waiting."""
    serial, waking, waiting, at = 0.0, 0.0, 0.0, begin
    for line in log.read_text().splitlines():
        numbers = list(map(float, line.split()))
        starts, ends = sorted(numbers[0::2]), sorted(numbers[1::2])
        if not starts or ends[-1] < begin or starts[0] > end:
            continue
        serial += max(0.0, starts[0] - at)
        at = ends[-1]
        if len(starts) == 1:
            serial += ends[0] - starts[0]
            continue
        waking += starts[1] - starts[0]
        # Who is done before another has begun leaves that one alone.
        waiting += max(0.0, ends[-1] - max(ends[-2], starts[1]))
    return serial + max(0.0, end - at), waking, waiting


def sample(options, mesh, extra, folder):
    """(seconds of the run, serial, waking, waiting) of the part of a run that improves the mesh."""
    report, log = folder / "report.json", folder / "log"
    command = [options.tool, mesh, "-o", folder / "out.meshb", "-q", "-j", str(options.threads), "--json", report, *extra]
    start = time.monotonic()
    done = subprocess.run(list(map(str, command)), stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "LD_PRELOAD": str(options.library), "ONE_THREAD_LOG": str(log)})
    if done.returncode not in (0, 3, 4):
        sys.exit(f"one_thread: {mesh}: {done.stderr.strip()}")
    if not log.exists():
        sys.exit("one_thread: no parallel region was seen: the tool has another thread library, or too few threads")
    seconds = json.loads(report.read_text())["seconds"]
    begin = start + seconds["read"] + seconds["build"]
    return seconds["improve"], *shares(log, begin, begin + seconds["improve"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("library", type=pathlib.Path)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    arguments, extra = sys.argv[1:], []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, extra = arguments[:cut], arguments[cut + 1:]
    options = parser.parse_args(arguments)
    options.library = options.library.resolve()
    print(f"| mesh | one thread of {options.threads}, % of the time | serial | waking | waiting | improve, s |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="hfremesh-one-thread-") as name:
        for mesh in options.meshes:
            runs = [sample(options, mesh, extra, pathlib.Path(name)) for _ in range(options.runs)]
            middle = statistics.median(sum(run[1:]) / run[0] for run in runs)
            parts = [statistics.median(run[i] / run[0] for run in runs) for i in (1, 2, 3)]
            print(f"| {pathlib.Path(mesh).name.partition('.')[0]} | {100 * middle:.1f} | "
                  + " | ".join(f"{100 * part:.1f}" for part in parts)
                  + f" | {min(run[0] for run in runs):.2f} |", flush=True)


if __name__ == "__main__":
    main()
