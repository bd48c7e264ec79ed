#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whole runs in parts on N ranks beside hfremesh on N threads, in turn: seconds, memory, and whether the bytes are
the same.

Usage: bench/parts_beside_threads.py BUILD [--cubes 70 120] [--corners 50:0.45:0.3] [--ranks 2] [--runs 3]
                                     [--args ARGS] [MESH ...]
  BUILD   has hfremesh and hfremesh-mpi
  --cubes grids of so many cubes a side, jitter 0.2 (70: 2,058,000 cells; 120: 10,368,000)
  --corners  grids of so many cubes a side that are regular but for one corner: its jitter, and its share of each side
  --args  of both programs; in parts also --all-stages
  MESH    files to take, too; what is not .vtu is converted first
Prints a Markdown table of medians: seconds of the whole process (of mpirun in parts) and of improve, statistics
included; memory of hfremesh, and of all ranks together."""
import argparse
import filecmp
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import tempfile
import time


def run(command):
    """Seconds, and MB of that process at its largest."""
    environment = dict(os.environ)
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3, 4):  # a goal missed, inverted cells left
        raise SystemExit(f"{shlex.join(map(str, command))}: exit code {process.returncode}")
    return time.monotonic() - start, usage.ru_maxrss / 1e3


def both(build, mesh, ranks, args, folder):
    """(seconds, seconds of improve, MB) of each, and whether the bytes are the same."""
    tool, mpi = build / "apps/hfremesh/hfremesh", build / "apps/hfremesh/hfremesh-mpi"
    shared, parts, report = folder / "shared.vtu", folder / "parts.vtu", folder / "report.json"
    seconds, memory = run([tool, mesh, "-o", shared, "--threads", str(ranks), "-q", "--json", report, *args])
    said = json.loads(report.read_text())["seconds"]
    rows = [(seconds, said["improve"] + said["statistics"], memory)]
    seconds, _ = run(["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), mpi, "parts", mesh,
                      "-o", parts, "-q", "--json", report, "--all-stages", *args])
    said = json.loads(report.read_text())
    rows.append((seconds, said["seconds"]["improve"], said["memory"]["all"] / 1e6))
    return rows, filecmp.cmp(shared, parts, shallow=False)


def poor_corner(tool, n, jitter, share, path, folder):
    """The vertices of a jittered grid in one corner, and those of the regular grid elsewhere."""
    lines = []
    for amount in ("0", jitter):
        file = folder / "grid.mesh"
        run([tool, "generate", "cavity", "--n", n, n, n, "--amplitude", "0", "--jitter", amount, "-q", "-o", file])
        lines.append(file.read_text().split("\n"))
    regular, poor = lines
    first = regular.index("Vertices") + 2
    for i in range(first, first + int(regular[first - 1])):
        if all(float(x) < share for x in regular[i].split()[:3]):
            regular[i] = poor[i]
    file.write_text("\n".join(regular))
    run([tool, "convert", file, "-q", "-o", path])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("mesh", nargs="*", type=pathlib.Path)
    parser.add_argument("--cubes", type=int, nargs="*", default=[])
    parser.add_argument("--corners", nargs="*", default=[])
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--args", type=shlex.split, default=[])
    line = parser.parse_intermixed_args()
    print(f"| mesh | hfremesh, {line.ranks} threads, s | improve, s | MB | parts, {line.ranks} ranks, s | improve, s "
          "| MB, all | seconds | improve | memory | bytes |\n|---|" + 9 * "---:|" + "---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tool = line.build / "apps/hfremesh/hfremesh"

        def with_command(*command):
            return lambda path: run([*command, path])

        def with_corner(n, jitter, share):
            return lambda path: poor_corner(tool, n, jitter, float(share), path, folder)

        jobs = [(f"grid of {n}³ cubes", with_command(tool, "generate", "cavity", "--n", *3 * [str(n)], "--amplitude", "0",
                                                     "--jitter", "0.2", "-q", "-o")) for n in sorted(line.cubes)]
        jobs += [(f"poor corner {corner}", with_corner(*corner.split(":"))) for corner in line.corners]
        jobs += [(path.stem, with_command(tool, "convert", path, "-q", "-o")) for path in line.mesh]
        for title, make in jobs:
            mesh = folder / "in.vtu"
            make(mesh)
            rounds = [both(line.build, mesh, line.ranks, line.args, folder) for _ in range(line.runs)]
            median = [[statistics.median(r[0][side][k] for r in rounds) for k in range(3)] for side in (0, 1)]
            ratios = [median[1][k] / median[0][k] for k in range(3)]
            print(f"| {title} | {median[0][0]:.1f} | {median[0][1]:.1f} | {median[0][2]:.0f} | {median[1][0]:.1f} | "
                  f"{median[1][1]:.1f} | {median[1][2]:.0f} | {ratios[0]:.2f} | {ratios[1]:.2f} | {ratios[2]:.2f} | "
                  f"{'same' if all(r[1] for r in rounds) else 'DIFFER'} |", flush=True)


if __name__ == "__main__":
    main()
