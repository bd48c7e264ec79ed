# SPDX-License-Identifier: BSD-3-Clause
"""Ten meshes, three modes: the tool and the package write the same file."""

import subprocess
import sys

import numpy as np
import pytest

import hfremesh as hf

MESHES = {
    "cavity": (hf.generate.cavity, {"n": (8, 9, 10)}, ["cavity", "--n", "8", "9", "10"]),
    "shear": (hf.generate.cavity, {"n": (8, 8, 8), "field": "bulk-shear", "amplitude": 0.15},
              ["cavity", "--n", "8", "8", "8", "--field", "bulk-shear", "--amplitude", "0.15"]),
    "jittered": (hf.generate.box, {"n": (9, 8, 7), "jitter": 0.3, "seed": 5},
                 ["box", "--n", "9", "8", "7", "--jitter", "0.3", "--seed", "5"]),
    "regions": (hf.generate.box, {"n": (8, 8, 8), "jitter": 0.25, "regions": 2},
                ["box", "--n", "8", "8", "8", "--jitter", "0.25", "--regions", "2"]),
    "slab": (hf.generate.box, {"n": (20, 20, 2), "low": (0, 0, 0), "high": (1, 1, 0.05), "jitter": 0.2},
             ["box", "--n", "20", "20", "2", "--low", "0", "0", "0", "--high", "1", "1", "0.05", "--jitter", "0.2"]),
    "ball": (hf.generate.ball, {"n": 6, "jitter": 0.4}, ["ball", "--n", "6", "--jitter", "0.4"]),
    "cylinder": (hf.generate.cylinder, {"n": (4, 12), "twist": 60.0, "jitter": 0.3},
                 ["cylinder", "--n", "4", "12", "--twist", "60", "--jitter", "0.3"]),
    "wrung": (hf.generate.cylinder, {"n": (4, 10), "wring": 62.0}, ["cylinder", "--n", "4", "10", "--wring", "62"]),
    "fandisk": (hf.generate.fandisk, {"n": (5, 5, 3), "jitter": 0.3, "seed": 3},
                ["fandisk", "--n", "5", "5", "3", "--jitter", "0.3", "--seed", "3"]),
    "seeded": (hf.generate.cavity, {"n": (9, 9, 9), "seed": 77}, ["cavity", "--n", "9", "9", "9", "--seed", "77"]),
}
MODES = {
    "default": ({}, []),
    "goal": ({"min_dihedral": 18}, ["--min-dihedral", "18"]),
    "free": ({"surface": "free", "iterations": 2}, ["--surface", "free", "--iterations", "2"]),
}


def tool(*arguments):
    done = subprocess.run([sys.executable, "-m", "hfremesh", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (0, 3, 4), done.stderr
    return done.stdout


@pytest.mark.parametrize("name", MESHES)
def test_the_package_has_the_bits_of_the_tool(tmp_path, name):
    make, values, words = MESHES[name]
    tool("generate", *words, "-o", tmp_path / "in.mesh", "-q")
    made = make(**values)
    from_file = hf.read(tmp_path / "in.mesh")
    assert made.hash == from_file.hash
    for mode, (options, words) in MODES.items():
        tool(tmp_path / "in.mesh", "-o", tmp_path / f"{mode}.mesh", *words, "-j", "1", "-q")
        theirs = (tmp_path / f"{mode}.mesh").read_bytes()
        regions = made.regions if made.regions.any() else None
        from_arrays = hf.improve(np.array(made.points), np.array(made.cells, np.int64), regions=regions, **options)
        for ours in (from_arrays, hf.improve(from_file, threads=2, **options)):
            hf.write(tmp_path / "ours.mesh", ours)
            assert (tmp_path / "ours.mesh").read_bytes() == theirs, mode
        assert ours.changed


def test_ten_meshes_and_three_modes():
    assert (len(MESHES), len(MODES)) == (10, 3)
