#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Seconds and memory with which hfremesh-mpi parts reads one file by ranges, for each format and number of ranks.

Usage: bench/read_ranges.py BUILD [--cubes N] [--ranks 1 2 4] [--runs 3] [MESH ...]
  BUILD  has hfremesh and hfremesh-mpi
  MESH   files to take; without any, a grid of N cubes a side (70: 2,058,000 cells)
Each mesh is written in all formats that are read by ranges; '2.2 binary, as Gmsh' has a heading for each element.
Prints a Markdown table: size of the file; for each number of ranks the median seconds until the parts are made and
their cells counted, and the memory of the rank that took most, which holds its part by then."""
import argparse
import os
import pathlib
import re
import statistics
import struct
import subprocess
import tempfile

FORMATS = [(".mesh", "", False), (".meshb", "", False), (".msh", "2.2", False), (".msh", "2.2", True),
           (".msh", "4.1", False), (".msh", "4.1", True), (".vtu", "", False)]
NODES = {15: 1, 1: 2, 2: 3, 4: 4}


def a_heading_each(source, target):
    """A binary file of version 2.2 as Gmsh writes it."""
    data = source.read_bytes()
    begin = data.index(b"\n", data.index(b"\n$Elements\n") + 11) + 1
    left = int(data[data.rindex(b"\n", 0, begin - 1):begin])
    with target.open("wb") as out:
        out.write(data[:begin])
        while left > 0:
            kind, n, tags = struct.unpack_from("<3i", data, begin)
            heading, size = struct.pack("<3i", kind, 1, tags), 4 * (1 + tags + NODES[kind])
            begin += 12
            for at in range(begin, begin + n * size, size):
                out.write(heading + data[at:at + size])
            begin += n * size
            left -= n
        out.write(data[begin:])


def read(build, path, ranks):
    """Seconds of reading, and MB of the rank that took most."""
    environment = dict(os.environ)
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    said = subprocess.run(
        ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks),
         build / "apps/hfremesh/hfremesh-mpi", "parts", path],
        check=True, capture_output=True, text=True, env=environment).stdout
    return (float(re.search(r"^read: .* ([0-9.]+) s$", said, re.M)[1]),
            int(re.search(r"^memory: (\d+) MB", said, re.M)[1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("mesh", nargs="*", type=pathlib.Path)
    parser.add_argument("--cubes", type=int, default=70)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    tool = options.build / "apps/hfremesh/hfremesh"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        meshes = options.mesh
        if not meshes:
            meshes = [folder / "grid.meshb"]
            n = str(options.cubes)
            subprocess.run([tool, "generate", "cavity", "--n", n, n, n, "--amplitude", "0", "--jitter", "0.2",
                            "-o", meshes[0], "--quiet"], check=True)
        for mesh in meshes:
            files = []
            for extension, variant, is_binary in FORMATS:
                label = " ".join(filter(None, [f"`{extension}`", variant, "binary" if is_binary else ""]))
                path = folder / f"file{len(files)}{extension}"
                subprocess.run([tool, "convert", mesh, path, "--quiet"] + (["--variant", variant] if variant else []) +
                               (["--binary"] if is_binary else []), check=True)
                files.append((label, path))
                if variant == "2.2" and is_binary:
                    files.append((label + ", as Gmsh", folder / "gmsh.msh"))
                    a_heading_each(path, files[-1][1])
            print(f"{mesh.name}:\n")
            print("| file | MB |" + "".join(f" {n} rank{'s' * (n > 1)}, s | MB |" for n in options.ranks))
            print("|---|---:|" + "---:|---:|" * len(options.ranks))
            for label, path in files:
                row = f"| {label} | {path.stat().st_size / 1e6:.1f} |"
                for n in options.ranks:
                    runs = [read(options.build, path, n) for _ in range(options.runs)]
                    row += f" {statistics.median(s for s, _ in runs):.2f} | {max(mb for _, mb in runs)} |"
                print(row, flush=True)
            print()


if __name__ == "__main__":
    main()
