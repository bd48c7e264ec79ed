# SPDX-License-Identifier: BSD-3-Clause
"""python -m hfremesh is the tool."""

import pathlib
import subprocess
import sys

import hfremesh as hf


def run(*arguments, **more):
    return subprocess.run([sys.executable, "-m", "hfremesh", *map(str, arguments)], capture_output=True, text=True,
                          **more)


def test_it_says_its_version():
    assert run("--version").stdout.strip() == f"hfremesh {hf.__version__}"


def test_exit_codes_and_messages_come_through(tmp_path):
    assert run().returncode == 1
    missing = run("check", tmp_path / "missing.mesh")
    assert missing.returncode == 2 and "missing.mesh" in missing.stderr
    hf.write(tmp_path / "bad.mesh", hf.generate.cavity((8, 9, 10)))
    assert run("check", tmp_path / "bad.mesh").returncode == 4


def test_standard_streams_are_the_tools(tmp_path):
    hf.write(tmp_path / "in.mesh", hf.generate.ball(3))
    done = run("convert", "-", "-", "--format", "mesh", "--output-format", "mesh",
               input=(tmp_path / "in.mesh").read_text())
    assert done.returncode == 0 and done.stdout == (tmp_path / "in.mesh").read_text()


def test_the_command_is_installed():
    command = pathlib.Path(sys.executable).parent / "hfremesh"
    assert subprocess.run([command, "--version"], capture_output=True, text=True).stdout.startswith("hfremesh ")
