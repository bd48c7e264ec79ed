#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of docs/gallery and the page that shows them: stand-ins of the paper's six meshes (paper_tables.py) and
six real ones, each before and after a run without options.

usage: bench/gallery.py TOOL MESHES [--threads N] [--only NAME,...] [--folder docs/gallery]
MESHES is the folder of the test meshes. With --only, the other rows of the page stay as they are.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

from paper_tables import ROWS as PAPER

# name, file below MESHES, where it is from
REAL = [
    ("armadillo", "ipc_armadillo13k/Armadillo13K.msh", "[IPC](https://github.com/ipc-sim/IPC), MIT"),
    ("alligator", "gaia_alligator/alligator.vtk", "[Gaia](https://github.com/AnkaChan/Gaia), Apache-2.0"),
    ("octopus", "gaia_octopus30k/octopus_30K.1.node", "[Gaia](https://github.com/AnkaChan/Gaia), Apache-2.0"),
    ("hollow cat", "ipc_hollowcat/hollowCat7.5K.msh", "[IPC](https://github.com/ipc-sim/IPC), MIT"),
    ("microstructure", "polyfem_microstructure/P1.msh",
     "[PolyFEM](https://github.com/polyfem/polyfem-data), MIT"),
    ("house", "stellar_house2/house2.node",
     "Stellar of Klingner & Shewchuk, by way of [Dynearth3D](https://github.com/dongliangchu/Stellar_Dynearth3D)"),
]
LARGEST = 150 * 1024  # bytes of a picture


def run(command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode not in (0, 3, 4):
        sys.exit(f"gallery: {' '.join(map(str, command))}: {done.stderr.strip()}")


def row(name, source, picture, report):
    def side(when):
        s = report[when]
        angles = f"{s['min_dihedral']['min']:.2f} … {s['max_dihedral']:.2f}"
        return f"{s['cells']:,} cells, {s['inverted']} inverted, {s['cells_below']['15']:,} below 15°, {angles}°"

    return (f"## {name}\n{source}. Before: {side('before')}. After: {side('after')}.\n\n"
            f"![{name} before and after]({picture.name})\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("tool")
    parser.add_argument("meshes", type=pathlib.Path)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--folder", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parent.parent / "docs" / "gallery")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    page = options.folder / "README.md"
    old = page.read_text().split("\n## ")[1:] if page.exists() else []
    rows = {text.split("\n")[0]: "## " + text for text in old}
    only = [name for name in options.only.split(",") if name]
    todo = [(name, ["generate", *generator.split()],
             f"Stand-in for the paper's mesh of {cells:,} cells: `hfremesh generate {generator}`")
            for name, cells, generator, _ in PAPER] + REAL
    for name, what, source in todo:
        if only and name not in only:
            continue
        picture = options.folder / f"{name.lower().replace(' ', '-')}.png"
        with tempfile.TemporaryDirectory() as folder:
            before = pathlib.Path(folder) / f"{name}.meshb"
            if isinstance(what, list):
                run([options.tool, *what, "-o", before, "-q"])
            else:
                before = options.meshes / what
            after, report = pathlib.Path(folder) / f"{name}.vtu", pathlib.Path(folder) / "report.json"
            run([options.tool, before, "-o", after, "-q", "-j", options.threads, "--png", picture, "--png-width", 1200, "--json",
                 report])
            rows[name] = row(name, source, picture, json.loads(report.read_text()))
        size = picture.stat().st_size
        print(f"{name}: {size:,} bytes{' (too large)' if size > LARGEST else ''}", flush=True)
    page.write_text("# Gallery\n\nMeshes before and after `hfremesh IN -o OUT`, without options: the surface is frozen. What the "
                    "pictures show: [reports.md](../reports.md). `bench/gallery.py TOOL MESHES` makes this page.\n\n"
                    + "\n".join(rows[name].rstrip("\n") + "\n" for name, _, _ in todo if name in rows))


if __name__ == "__main__":
    main()
