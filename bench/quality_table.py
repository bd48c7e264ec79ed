#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the tool makes of each test mesh, with a frozen surface unless told otherwise, beside the best figures of other programs.

For each mesh a row before, a row after the default run and one after --min-dihedral max, or after other goals: cells, smallest and
largest dihedral, 0.1, 1 and 5 % percentile of each cell's smallest one, user seconds of the whole program, the exit
code of `hfremesh check`, and what keeps the cells below the first angle that was missed. Angles in degrees.

usage: bench/quality_table.py TOOL MESHES [--threads N] [--only NAME,...] [--runs default,passes,max,DEGREES]
                              [--surface frozen,flat,free] [--time-limit S] [--output FILE]
MESHES is the folder of the test meshes; those that are not there are left out.
"""
import argparse
import itertools
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

# name, file below MESHES or options of `generate`, best other program (frozen surface unless it says otherwise):
# worst angle, percentiles p1 / p5, seconds
ROWS = [
    ("cavity20k", "cavity/cavity20k.mesh", "Mmg 8.94, p1 24.1, p5 29.8, 0.9 s; Stellar, surface free 38.67, 43.5 s"),
    ("cavity607k", "cavity/cavity607k_tetgen.mesh", "paper 25.10, 382 s; Mmg 10.27, p1 28.7, p5 33.8, 9.8 s; HXT 9.52, 1.5 s"),
    ("its Kuhn twin", "--n 44 46 50 --jitter 0.201 --sigma 0.08 --amplitude 0.27877 --seed 2013",
     "Mmg 9.17, p1 28.3, p5 32.8, 12.6 s; HXT 6.74, 5.2 s"),
    ("stellar_house2", "stellar_house2", "Stellar 27.64, p1 30.2, p5 35.1, 3.1 s"),
    ("random50k", "random50k", "Stellar 29.48, p1 34.9, p5 37.2, 197 s"),
    ("ipc_rod300x33", "ipc_rod300x33", "HXT 15.94, p1 19.2, p5 22.7, 0.08 s; Stellar, surface free 24.88, p1 32.3, p5 34.4, 252 s"),
    ("polyfem_cubes_mm", "polyfem_cubes_mm", ""),
    ("ipc_armadillo13k", "ipc_armadillo13k", ""),
    ("ipc_dolphin5k", "ipc_dolphin5k", "Stellar 12.51, p1 19.6, p5 24.6, 172 s"),
    ("ipc_hollowcat", "ipc_hollowcat", "HXT 2.81, p1 16.6, p5 22.5, 3.1 s; Mmg 2.42, p1 18.5, p5 26.6, 2.4 s"),
    ("gaia_octopus30k", "gaia_octopus30k", "HXT 1.32, p1 14.2, p5 18.7, 19.1 s; Mmg 1.03, p1 19.2, p5 25.7, 6.9 s"),
    ("tangled bad2", "tangled/bad2", "Gmsh 21.97"),
    ("tangled j0.6", "tangled/j0.6", "Gmsh 6.65"),
    ("tangled j1.0", "tangled/j1.0", "Gmsh 6.04"),
    ("cleaver_short", "cleaver_short", ""),
    ("cleaver_segmentation", "cleaver_segmentation", ""),
    ("polyfem_microstructure", "polyfem_microstructure", ""),
    ("polyfem_screw", "polyfem_screw", ""),
    ("polyfem_large_angle7", "polyfem_large_angle7", ""),
    ("gaia_dog", "gaia_dog", ""),
    ("gaia_frog_reg", "gaia_frog_reg", ""),
    ("gaia_alligator", "gaia_alligator", ""),
]
TYPES = (".mesh", ".msh", ".vtk", ".vtu", ".node")


def find(folder, place):
    """The first mesh file at, in or beginning with the place."""
    path = folder / place
    if path.is_file():
        return path
    found = sorted(path.glob("*")) if path.is_dir() else sorted(path.parent.glob(path.name + "*"))
    return next((f for f in found if f.suffix in TYPES), None)


def figures(statistics, cells_before):
    angles = statistics["min_dihedral"]
    p = angles["percentiles"]
    invalid = statistics["inverted"] + statistics["flat"]
    edge = statistics["edge_length"]["percentiles"]
    change = 100 * (statistics["cells"] / cells_before - 1)
    cells = f"{statistics['cells']:,}" + (f" ({change:+.0f} %)" if statistics["cells"] != cells_before else "")
    return (f"{cells} | {invalid} | {angles['min']:.2f} | {statistics['max_dihedral']:.1f} | "
            f"{p['p0.1']:.2f} | {p['p1']:.2f} | {p['p5']:.2f} | {edge['p5']:.3g} / {edge['p50']:.3g} / {edge['p95']:.3g}")


def limits_of(report):
    limits = report["limits"]
    if limits["n_cells"] == 0:
        return ""
    parts = ", ".join(f"{n} {name}" for name, n in limits["counts"].items() if n > 0)
    return f"below {limits['below']:g}: {parts}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the hfremesh program")
    parser.add_argument("meshes", type=pathlib.Path, help="folder of the test meshes")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--only", help="names of rows, comma-separated")
    parser.add_argument("--runs", default="default,max", help="which runs, comma-separated: default, passes (--passes-only), max, or degrees of a goal")
    parser.add_argument("--surface", default="frozen", help="modes, comma-separated; every run is done in each")
    parser.add_argument("--time-limit", type=float, default=600, help="seconds that max may take for a mesh")
    parser.add_argument("--output", help="Markdown file to write (default: standard output)")
    options = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-bench-"))
    lines = ["| mesh | run | cells | invalid | min | max | p0.1 | p1 | p5 | edges p5 / p50 / p95 | s | check | stuck cells |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for name, place, peer in ROWS:
        if options.only and name not in options.only.split(","):
            continue
        if place.startswith("--"):
            mesh = folder / "generated.mesh"
            subprocess.run([options.tool, "generate", "cavity", *place.split(), "-q", "-o", mesh], check=True)
        else:
            mesh = find(options.meshes, place)
        if mesh is None:
            print(f"quality_table: {name} is not there", file=sys.stderr)
            continue
        before_is_out = False
        for mode, run in itertools.product(options.surface.split(","), options.runs.split(",")):
            arguments = {"default": [], "passes": ["--passes-only"], "max": ["--min-dihedral", "max", "--time-limit", str(options.time_limit)]
                         }.get(run, ["--min-dihedral", run])
            report_file, out = folder / "report.json", folder / "out.mesh"
            report_file.unlink(missing_ok=True)
            start = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run([options.tool, mesh, "-o", out, "-q", "-j", str(options.threads), "--json", report_file,
                            "--surface", mode, *arguments], stderr=subprocess.DEVNULL)
            seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - start
            report = json.loads(report_file.read_text())
            checked = subprocess.run([options.tool, "check", out, "-q"], stderr=subprocess.DEVNULL).returncode
            if not before_is_out:
                lines.append(f"| {name} | before | {figures(report['before'], report['before']['cells'])} | | | |")
                before_is_out = True
            label = run if mode == "frozen" else f"{mode}, {run}"
            lines.append(f"| | {label} | {figures(report['after'], report['before']['cells'])} | {seconds:.2f} | {checked} | "
                         f"{limits_of(report)} |")
            print(lines[-1], file=sys.stderr)
        if peer:
            lines.append(f"| | others: {peer} | | | | | | | | | | | |")
    text = "\n".join(lines) + "\n"
    if options.output:
        pathlib.Path(options.output).write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
