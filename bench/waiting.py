#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What it costs how long an idle OpenMP thread looks for work before it sleeps (GNU's run-time library).

usage: bench/waiting.py TOOL MESH [--threads 2] [--runs 5] [--counts 0,300,1000,3000,10000,300000]
For each GOMP_SPINCOUNT seconds of the whole program, the median of the runs: alone; as one of two that run at the
same time; beside as many loops that do nothing as there are threads. 0: sleeps at once.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time


def start(tool, mesh, threads, count, folder, name):
    environment = {**os.environ, "OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": str(count)}
    return subprocess.Popen([tool, mesh, "-o", folder / f"{name}.meshb", "-q", "-j", str(threads)], env=environment,
                            stderr=subprocess.DEVNULL)


def seconds(processes):
    """Until each of them has ended, the mean."""
    begin, ends = time.monotonic(), []
    for process in processes:
        process.wait()
        ends.append(time.monotonic() - begin)
    return statistics.mean(ends)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("mesh")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--counts", default="0,300,1000,3000,10000,300000")
    options = parser.parse_args()
    print("| looks | alone, s | two at once, s | beside busy loops, s |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="hfremesh-waiting-") as name:
        def run(count, copies):
            return seconds([start(options.tool, options.mesh, options.threads, count, pathlib.Path(name), i)
                            for i in range(copies)])

        for count in options.counts.split(","):
            alone = statistics.median(run(count, 1) for _ in range(options.runs))
            both = statistics.median(run(count, 2) for _ in range(options.runs))
            loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(options.threads)]
            try:
                beside = statistics.median(run(count, 1) for _ in range(options.runs))
            finally:
                for loop in loops:
                    loop.kill()
                    loop.wait()
            print(f"| {count} | {alone:.2f} | {both:.2f} | {beside:.2f} |", flush=True)


if __name__ == "__main__":
    main()
