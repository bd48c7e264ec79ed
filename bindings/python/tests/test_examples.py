# SPDX-License-Identifier: BSD-3-Clause
"""Examples end with 0 when all went as they say."""

import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).parents[3] / "examples" / "python"


@pytest.mark.parametrize("name", ["improve.py", "steps.py"])
def test_examples_run(name, tmp_path):
    done = subprocess.run([sys.executable, FOLDER / name], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout, done.stderr
