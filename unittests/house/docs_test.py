# SPDX-License-Identifier: BSD-3-Clause
"""docs_test.py TOOL ROOT: the commands of README.md and docs/*.md do what they say.

Each ```sh block runs in a folder of small meshes with the names that the pages use, line by line; blocks of one page
that begin with a mesh of their own find it. A line has to end with 0 or 3 (a goal that is missed is a result), or with
what its comment says ("# exit code 4"). A block that cannot run has a line above: <!-- not run: why -->.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOOL, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
BLOCK = re.compile(r"^(?:<!-- not run: (?P<why>[^\n]*) -->\n)?```sh\n(?P<text>.*?)^```", re.M | re.S)
SLOW = re.compile(r"--n 44 46 50")  # the paper's cavity takes a minute; any of its blocks is made smaller


def with_fields(vtu, u):
    """Puts fields that the pages name into an ASCII .vtu: u, a motion; T; rho and v of cells."""
    text = vtu.read_text()
    n, m = (int(re.search(name + r'="(\d+)"', text).group(1)) for name in ("NumberOfPoints", "NumberOfCells"))
    points = re.search(r"<Points>.*?<DataArray[^>]*>(.*?)</DataArray>", text, re.S).group(1).split()

    def array(name, components, values):
        kind = f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{components}" format="ascii">'
        return f"{kind}{' '.join(values)}</DataArray>"

    motion = []
    for i in range(n):
        x, y = float(points[3 * i]), float(points[3 * i + 1])
        motion += [str(u * x * y), "0", str(-u * y * y)]
    of_points = array("u", 3, motion) + array("T", 1, ["1"] * n)
    of_cells = array("rho", 1, ["2"] * m) + array("v", 3, ["1", "0", "0"] * m)
    text = re.sub(r"<PointData[^>]*/>|<PointData[^>]*>.*?</PointData>", "", text, flags=re.S)
    text = re.sub(r"<CellData[^>]*/>|<CellData[^>]*>.*?</CellData>", "", text, flags=re.S)
    text = text.replace("</Piece>", f"<PointData>{of_points}</PointData><CellData>{of_cells}</CellData></Piece>")
    vtu.write_text(text)


def fill(folder):
    """The meshes that blocks begin with."""

    def tool(*words):
        subprocess.run([TOOL, *words], cwd=folder, check=True, capture_output=True)

    tool("generate", "cavity", "--n", "6", "6", "6", "-o", "bad.mesh")
    for name in ("in.mesh", "a.mesh", "before.mesh"):
        shutil.copy(folder / "bad.mesh", folder / name)
    tool("bad.mesh", "-o", "after.mesh")
    for name in ("bad.msh", "in.msh", "a.msh", "a.vtk", "after.vtu"):
        tool("convert", "bad.mesh", name)
    tool("generate", "box", "--n", "4", "4", "4", "--jitter", "0.2", "-o", "box.mesh")
    # One face of the first cube, below, as a patch of its own.
    labelled = re.sub(r"\bEnd\b", "Triangles\n1\n1 2 7 3\nEnd", (folder / "box.mesh").read_text())
    (folder / "scan.mesh").write_text(labelled)
    for name in ("surface.stl", "surface.obj"):
        tool("convert", "box.mesh", name)
    subprocess.run("gzip -k in.mesh", shell=True, cwd=folder, check=True)
    tool("generate", "box", "--n", "4", "4", "4", "-o", "in.vtu", "--variant", "ascii")
    with_fields(folder / "in.vtu", 0.1)
    for step in range(3):
        shutil.copy(folder / "in.vtu", folder / f"in_{step:04d}.vtu")


def lines_of(text):
    if re.search(r"^case ", text, re.M):
        return [text]
    return [line for line in text.replace("\\\n", " ").splitlines() if line.split("#")[0].strip()]


def expected(line):
    said = re.search(r"# .*exit code (\d+)", line)
    if said:
        return {int(said.group(1))}
    return {0, 3, 6} if "--device opencl" in line else {0, 3}  # 6: there is no device here


def main():
    ran, left_out, faults = 0, 0, []
    environment = {**os.environ, "PATH": f"{TOOL.parent}:{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as start:
        fill(pathlib.Path(start))
        for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
            with tempfile.TemporaryDirectory() as folder:
                shutil.copytree(start, folder, dirs_exist_ok=True)
                for block in BLOCK.finditer(page.read_text()):
                    if block["why"]:
                        left_out += 1
                        print(f"{page.name}: not run, {block['why']}: {block['text'].splitlines()[0]}")
                        continue
                    for line in lines_of(SLOW.sub("--n 8 8 8", block["text"])):
                        if "jq " in line and not shutil.which("jq"):
                            print(f"{page.name}: without jq, not run: {line}")
                            continue
                        done = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, check=False,
                                              capture_output=True, text=True)
                        ran += 1
                        if done.returncode not in expected(line):
                            faults.append(f"{page.name}: exit code {done.returncode}: {line}\n{done.stderr}")
    print(f"{ran} commands ran, {left_out} blocks are left out, each with its reason")
    if ran < 40:
        faults.append(f"only {ran} commands were found")
    sys.exit("\n".join(faults) or 0)


main()
