#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Share of a run's time in which only one thread could run, sampled from the states of its threads (Linux).

usage: bench/one_thread.py TOOL MESH... [--threads 2] [--interval 0.002] [--runs 1] [-- OPTIONS OF THE TOOL]
A thread that waits for a core counts as one that could run, so a busy machine changes the figures little; one that has
nothing to do sleeps at once here, since one that looks for work would seem to have some.
Reading and writing files, and what has but one thread by choice, are part of the run that is sampled:
`improve` stands for the time between the first and the last pass that the tool reports.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time


def runnable_threads(pid):
    """Number of threads of the process that run or wait for a core; None when it has ended."""
    count = 0
    try:
        for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
            try:
                state = (task / "stat").read_text().rpartition(")")[2].split()[0]
            except OSError:
                continue  # has ended meanwhile
            if state == "Z":
                return None
            count += state in "RD"
    except OSError:
        return None
    return count


def sample(tool, mesh, threads, interval, extra, folder):
    """(samples with one thread, all samples, seconds) of the part of a run that improves the mesh."""
    report = folder / "report.json"
    command = [tool, mesh, "-o", folder / "out.meshb", "-q", "-j", str(threads), "--json", report, *extra]
    start = time.monotonic()
    sleeping = {**os.environ, "OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "0"}
    process = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True, env=sleeping)
    counts = []
    while process.poll() is None:
        count = runnable_threads(process.pid)
        if count is None:
            break
        counts.append((time.monotonic() - start, count))
        time.sleep(interval)
    error = process.communicate()[1]
    if process.returncode not in (0, 3, 4):
        sys.exit(f"one_thread: {mesh}: {error.strip()}")
    seconds = json.loads(report.read_text())["seconds"]
    begin = seconds["read"]
    end = begin + seconds["improve"]
    inside = [count for at, count in counts if begin <= at <= end]
    return sum(count <= 1 for count in inside), len(inside), seconds["improve"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--interval", type=float, default=0.002, help="seconds between samples")
    parser.add_argument("--runs", type=int, default=1)
    arguments = sys.argv[1:]
    extra = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, extra = arguments[:cut], arguments[cut + 1:]
    options = parser.parse_args(arguments)
    print(f"| mesh | one thread of {options.threads}, % of the time | samples | improve, s |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="hfremesh-one-thread-") as name:
        for mesh in options.meshes:
            alone = total = 0
            seconds = []
            for _ in range(options.runs):
                a, n, s = sample(options.tool, mesh, options.threads, options.interval, extra, pathlib.Path(name))
                alone, total = alone + a, total + n
                seconds.append(s)
            print(f"| {pathlib.Path(mesh).name.partition('.')[0]} | {100 * alone / max(total, 1):.0f} | {total} |"
                  f" {min(seconds):.2f} |", flush=True)


if __name__ == "__main__":
    main()
