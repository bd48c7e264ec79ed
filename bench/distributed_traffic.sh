#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Bytes, messages, calls and memory of each rank beside the run in shared memory: the second table of docs/distributed.md.
# Usage: bench/distributed_traffic.sh BUILD MESH ...     needs HFR_MPI; RANKS="2 4 8", SECONDS_EACH=300,
#        ARGUMENTS="--min-dihedral 15", MPI_ARGUMENTS="--share-from 0"
# A line for each mesh and number of ranks; bytes, messages and calls are those of one round, of the rank that has most.
# Parts: own cells, cells within two edges of another's vertices (border), of the largest part of the last hand-over.
# The output has to be that of shared memory, else the line says so.
set -euo pipefail
build=$1
shift
if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 - "$build" "$work" "$@" << 'PYTHON'
import filecmp, json, os, re, resource, subprocess, sys

build, work, meshes = sys.argv[1], sys.argv[2], sys.argv[3:]
ranks = [int(n) for n in os.environ.get("RANKS", "2 4 8").split()]
seconds = float(os.environ.get("SECONDS_EACH", "300"))
arguments = os.environ.get("ARGUMENTS", "--min-dihedral 15").split()
more = os.environ.get("MPI_ARGUMENTS", "--share-from 0").split()
in_rounds = ("evaluate", "select", "border", "smooth")


def one(mesh):
    """The run in shared memory, on two threads: cells, seconds of improve, peak memory in bytes."""
    report = work + "/one.json"
    program = [build + "/apps/hfremesh/hfremesh", "improve", mesh, "-o", work + "/one.mesh", *arguments]
    child = subprocess.Popen(program + ["--threads", "2", "--quiet", "--json", report])
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in (0, 3, 4):
        raise SystemExit(f"{mesh}: code {child.returncode}")
    run = json.load(open(report))
    return run["before"]["cells"], run["seconds"]["improve"], usage.ru_maxrss * 1024


def many(mesh, n):
    report = work + "/many.json"
    program = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(n), build + "/apps/hfremesh/hfremesh-mpi",
               mesh, "-o", work + "/many.mesh", *arguments, *more, "--quiet", "--traffic", "--json", report]
    done = subprocess.run(program, stderr=subprocess.PIPE, text=True, timeout=seconds)
    if done.returncode not in (0, 3, 4):
        raise SystemExit(f"{mesh}: {n} ranks: code {done.returncode}\n{done.stderr}")
    return json.load(open(report))["seconds"]["improve"], done.stderr


def figures(text):
    per_rank, phases = [], {}
    for line in text.splitlines():
        if m := re.search(r"rank (\d+): sent .*; (\d+) rounds; part: (\d+) own cells, (\d+) held, (\d+) near others; "
                          r"peak memory (\d+)", line):
            per_rank.append([int(x) for x in m.groups()])
        if m := re.search(r"phase ([a-z ]+): ([\d.]+) s on rank 0, ([\d.]+) s on the slowest; of a rank at most (\d+) "
                          r"messages of (\d+) bytes, (\d+) bytes to all, (\d+) calls", line):
            phases[m[1]] = [float(m[2]), float(m[3])] + [int(x) for x in m.groups()[3:]]
    return per_rank, phases


print("| mesh | cells | ranks | own | border | rounds | calls | messages | bytes | bytes a border cell | bytes to all "
      "| handed out, MB | put together, MB | peak MB: shared memory, rank 0, others | improve, s: 2 threads, ranks |")
print("|---|" + "---:|" * 14)
for mesh in meshes:
    name = os.path.splitext(os.path.basename(mesh))[0]
    cells, alone, peak = one(mesh)
    for n in ranks:
        together, text = many(mesh, n)
        per_rank, phases = figures(text)
        rounds = max(1, per_rank[0][1])
        own, border = max(r[2] for r in per_rank), max(r[4] for r in per_rank)
        total = {key: sum(phases[p][k] for p in in_rounds)
                 for k, key in ((2, "messages"), (3, "bytes"), (4, "all"), (5, "calls"))}
        a_round = {key: value / rounds for key, value in total.items()}
        others = max((r[5] for r in per_rank[1:]), default=0)
        same = filecmp.cmp(work + "/one.mesh", work + "/many.mesh", shallow=False)
        print(f"| {name}{'' if same else ' DIFFERS'} | {cells:,} | {n} | {own:,} | {border:,} | {rounds} "
              f"| {a_round['calls']:.1f} | {a_round['messages']:.1f} | {a_round['bytes']:,.0f} "
              f"| {a_round['bytes'] / max(1, border):.2f} | {a_round['all']:,.0f} | {phases['hand out'][3] / 1e6:.1f} "
              f"| {phases['put together'][3] / 1e6:.1f} | {peak / 1e6:.0f}, {per_rank[0][5] / 1e6:.0f}, {others / 1e6:.0f} "
              f"| {alone:.2f}, {together:.2f} |", flush=True)
        if os.environ.get("PHASES"):
            for phase, row in phases.items():
                print(f"    {phase}: {row[0]:.3f} s on rank 0, {row[1]:.3f} s on the slowest", flush=True)
PYTHON
