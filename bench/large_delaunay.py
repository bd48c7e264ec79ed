#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A large raw Delaunay mesh: the time of repairs towards goals beside that of HXT's own optimiser, on one core.

usage: bench/large_delaunay.py TOOL... [--size 0.0135] [--goals 15,22] [--runs 3]
The mesh is the unit box less a sphere, a cylinder and a torus, by Gmsh (`pip install gmsh`), Mesh.Algorithm3D 10,
without optimisation. HXT's figures are those of the same mesh generated with Mesh.Optimize 1, and its time is
"tOptimize" in Gmsh's log. Angles are worst / 1st / 5th percentile of the smallest dihedral, in degrees;
seconds are those of `improve`, without reading and statistics, the least of the runs.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile


def generate(size, optimize, path):
    """Writes the mesh; returns the lines of Gmsh's log."""
    import gmsh

    gmsh.initialize(["gmsh", "-nt", "1"])
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.Verbosity", 99)
    gmsh.logger.start()
    occ = gmsh.model.occ
    box = occ.addBox(0, 0, 0, 1, 1, 1)
    holes = [occ.addSphere(0.3, 0.3, 0.3, 0.18), occ.addCylinder(0.7, 0.7, -0.1, 0, 0, 1.2, 0.12),
             occ.addTorus(0.65, 0.35, 0.6, 0.15, 0.05)]
    occ.cut([(3, box)], [(3, hole) for hole in holes])
    occ.synchronize()
    for name in ("MeshSizeMin", "MeshSizeMax"):
        gmsh.option.setNumber("Mesh." + name, size)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.option.setNumber("Mesh.Optimize", int(optimize))
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    log = gmsh.logger.get()
    gmsh.finalize()
    return log


def angles(statistics):
    smallest = statistics["min_dihedral"]
    return f"{smallest['min']:.1f} / {smallest['percentiles']['p1']:.1f} / {smallest['percentiles']['p5']:.1f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", nargs="+")
    parser.add_argument("--size", type=float, default=0.0135)
    parser.add_argument("--goals", default="15,22")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hfremesh-delaunay-") as name:
        folder = pathlib.Path(name)
        report = folder / "report.json"
        raw, optimized = folder / "raw.msh", folder / "optimized.msh"
        generate(options.size, False, raw)
        log = generate(options.size, True, optimized)
        times = [float(found[1]) for found in (re.search(r"tOptimize\s*=\s*([\d.]+)", line) for line in log) if found]
        subprocess.run([options.tools[0], "stats", optimized, "--json", report, "-q"], check=True)
        statistics = json.loads(report.read_text())["meshes"][0]["statistics"]
        print(f"{statistics['cells']:,} cells after HXT")
        print("| by | angles | s |")
        print("|---|---|---|")
        print(f"| HXT | {angles(statistics)} | {max(times):.2f} |" if times else f"| HXT | {angles(statistics)} | |")
        for tool in options.tools:
            for goal in options.goals.split(","):
                best = None
                for _ in range(options.runs):
                    done = subprocess.run([tool, raw, "-o", folder / "out.meshb", "-q", "-j", "1", "--json", report,
                                           "--min-dihedral", goal], capture_output=True, text=True)
                    if done.returncode not in (0, 3, 4):
                        sys.exit(f"large_delaunay: {done.stderr.strip()}")
                    data = json.loads(report.read_text())
                    best = min(best or (1e9, ""), (data["seconds"]["improve"], angles(data["after"])))
                print(f"| {pathlib.Path(tool).name}, goal {goal} | {best[1]} | {best[0]:.2f} |", flush=True)


if __name__ == "__main__":
    main()
