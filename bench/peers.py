#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The same meshes through hfremesh, Gmsh and Mmg, all judged by `hfremesh stats`, as Markdown.

usage: bench/peers.py TOOL MESH [MESH ...] [--time-limit S] [--output FILE]

Wants the Python modules gmsh and mmgpy (pip install gmsh mmgpy); a peer that is missing is left out by name.
Every program runs on one thread with its surface frozen, as far as it can: Mmg with -nosurf, Gmsh on a discrete
volume whose boundary it has been told of (of a run of Netgen in it the cells that were there before are taken out,
since Gmsh leaves them in); all read and write binary files, which keep every bit of a coordinate.
Seconds are user CPU seconds of the whole program, reading and writing included (what else the machine does matters
little then); Gmsh's are without starting Python. "boundary" compares the boundary triangles of the output with those
of the input, coordinate by coordinate, to the last bit.
"turned" counts cells that the program has renumbered into order: `stats` turns them back by their neighbours, and
the overlap that they hide shows.
"""
import argparse
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile

GMSH = '''
import collections, sys, time
import gmsh
begin = time.process_time()
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("General.NumThreads", 1)
gmsh.open(sys.argv[1])
gmsh.model.mesh.createTopology()
def cells(volume):
    tags, nodes = gmsh.model.mesh.getElementsByType(4, volume)
    return list(zip(tags.tolist(), nodes.reshape(-1, 4).tolist()))
def added(volume):
    """The nodes of the cells that are not those of before: by their tags or, where these are taken again, by nodes."""
    old, now = before[volume], cells(volume)
    tags = set(tag for tag, _ in old)
    new = [nodes for tag, nodes in now if tag not in tags]
    if len(new) == len(now) - len(old):
        return new
    left, new = collections.Counter(frozenset(nodes) for _, nodes in old), []
    for _, nodes in now:
        if left[frozenset(nodes)] > 0:
            left[frozenset(nodes)] -= 1
        else:
            new.append(nodes)
    return new if left.total() == 0 else []
volumes = [volume for _, volume in gmsh.model.getEntities(3)]
before = {volume: cells(volume) for volume in volumes}
for method in sys.argv[3].split(","):
    gmsh.model.mesh.optimize(method, force=True)
for volume in volumes if sys.argv[3] == "Netgen" else []:
    new = added(volume)
    if new:
        gmsh.model.mesh.removeElements(3, volume)
        gmsh.model.mesh.addElementsByType(volume, 4, [], [node for nodes in new for node in nodes])
gmsh.option.setNumber("Mesh.SaveAll", 1)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write(sys.argv[2])
print(time.process_time() - begin)
'''


class Failed(Exception):
    pass


def call(command, limit, allowed=(0,)):
    """Runs it and returns (user CPU seconds, what it printed)."""
    begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    # A group of its own: what a peer is started through may be a script, and the program behind it has to end too.
    done = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                            start_new_session=True)
    try:
        output, _ = done.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(done.pid, signal.SIGKILL)
        done.communicate()
        raise Failed(f"> {limit:g} s") from None
    if done.returncode not in allowed:
        raise Failed("crashes" if done.returncode < 0 else f"exit {done.returncode}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin, output


def stats(tool, mesh):
    done = subprocess.run([str(tool), "stats", str(mesh), "--json", "-", "-q"], capture_output=True, text=True)
    if done.returncode != 0:  # as where a program makes overlapping cells of inverted ones
        raise Failed("no mesh: " + done.stderr.strip().split(": ", 2)[-1].split(":")[0])
    report = json.loads(done.stdout)["meshes"][0]
    return report["statistics"], report["reoriented"]


def boundary(tool, mesh, folder):
    """The boundary triangles as a set of corner coordinates, which a surface file keeps to the last bit."""
    surface = folder / "boundary.off"
    call([tool, "convert", mesh, "-o", surface, "-q"], None)
    words = surface.read_text().split()
    n_points, n_faces = int(words[1]), int(words[2])
    points = [tuple(map(float, words[4 + 3 * i : 7 + 3 * i])) for i in range(n_points)]
    first = 4 + 3 * n_points
    return {frozenset(points[int(k)] for k in words[first + 4 * i + 1 : first + 4 * i + 4]) for i in range(n_faces)}


def candidates(options):
    """name, how to run it: command(in, out) -> (seconds)."""
    tool = options.tool

    def ours(*extra):
        def run(source, result):
            return call([tool, source["any"], "-o", result.with_suffix(".meshb"), "-q", "-j", 1, *extra],
                        options.time_limit, (0, 3, 4))[0], result.with_suffix(".meshb")
        return run

    def mmg(*extra):
        def run(source, result):
            return call([options.mmg, "-v", 0, *extra, source["meshb"], result.with_suffix(".meshb")],
                        options.time_limit, (0, 1))[0], result.with_suffix(".meshb")
        return run

    def gmsh(method):
        def run(source, result):
            _, text = call([sys.executable, "-c", GMSH, source["msh"], result.with_suffix(".msh"), method],
                           options.time_limit)
            return float(text.split()[-1]), result.with_suffix(".msh")
        return run

    found = [("hfremesh", ours()), ("hfremesh --min-dihedral 15", ours("--min-dihedral", 15))]
    if subprocess.run([sys.executable, "-c", "import gmsh"], capture_output=True).returncode == 0:
        found += [("Gmsh, default", gmsh("")), ("Gmsh, Netgen", gmsh("Netgen")),
                  ("Gmsh, Relocate3D", gmsh("Relocate3D"))]
    else:
        print("peers: no Python module gmsh, left out", file=sys.stderr)
    if options.mmg:
        found += [("Mmg -nosurf -noinsert", mmg("-nosurf", "-noinsert")), ("Mmg -optim -nosurf", mmg("-optim", "-nosurf"))]
    else:
        print("peers: no program mmg3d (Python module mmgpy), left out", file=sys.stderr)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the hfremesh program")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--mmg", help="the mmg3d program (default: the module's, or on the PATH)")
    parser.add_argument("--time-limit", type=float, default=200, help="seconds by the clock for one run of one program")
    parser.add_argument("--output", help="Markdown file to write (default: standard output)")
    options = parser.parse_args()
    if not options.mmg:  # the program itself: what the module puts on the PATH starts Python first
        of_module = pathlib.Path(sysconfig.get_path("purelib")) / "mmgpy" / "bin" / "mmg3d_O3"
        options.mmg = str(of_module) if of_module.exists() else shutil.which("mmg3d_O3") or shutil.which("mmg3d")
    lines = ["| mesh | program | s | cells | inverted | turned | worst | max | p0.1 | p1 | p5 | volume | overlap | boundary |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"]

    def row(name, program, seconds, mesh, volume, turned, same):
        angles = mesh["min_dihedral"]
        at = angles["percentiles"]
        lines.append(
            f"| {name} | {program} | {seconds} | {mesh['cells']:,} | {mesh['inverted']:,} | {turned} | {angles['min']:.2f} |"
            f" {mesh['max_dihedral']:.1f} | {at['p0.1']:.1f} | {at['p1']:.1f} | {at['p5']:.1f} |"
            f" {mesh['volume'] / volume - 1:+.1e} | {mesh['overlap']:.1e} | {same} |")

    for path in map(pathlib.Path, options.meshes):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-peers-"))
        try:
            source = {"any": path, "meshb": folder / "in.meshb", "msh": folder / "in.msh"}
            call([options.tool, "convert", path, "-o", source["meshb"], "-q"], None)
            call([options.tool, "convert", path, "-o", source["msh"], "--binary", "-q"], None)
            before, _ = stats(options.tool, path)
            surface = boundary(options.tool, path, folder)
            row(path.stem, "(input)", "", before, before["volume"], "", "")
            for name, run in candidates(options):
                try:
                    seconds, result = run(source, folder / "out")
                    after, turned = stats(options.tool, result)
                    now = boundary(options.tool, result, folder)
                    same = "same" if now == surface else f"{len(now ^ surface):,} triangles differ"
                    row(path.stem, name, f"{seconds:.2f}", after, before["volume"], turned, same)
                except Failed as why:
                    lines.append(f"| {path.stem} | {name} | {why} |" + " |" * 11)
        finally:
            shutil.rmtree(folder)
    text = "\n".join(lines) + "\n"
    if options.output:
        pathlib.Path(options.output).write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
