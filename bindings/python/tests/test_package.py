# SPDX-License-Identifier: BSD-3-Clause
import ast
import os
import pathlib
import re
import subprocess
import sys

import hfremesh as hf

FOLDER = pathlib.Path(hf.__file__).parent


def test_types_are_there():
    assert (FOLDER / "py.typed").exists()
    stub = (FOLDER / "_core.pyi").read_text()
    ast.parse(stub)
    for name in ("class Mesh", "class Statistics", "class StuckCell", "def vertex_cells"):
        assert name in stub, name


def test_everything_public_has_a_docstring():
    for name in hf.__all__:
        thing = getattr(hf, name)
        if not isinstance(thing, tuple):
            assert (thing.__doc__ or "").strip(), name


def test_the_module_is_stable_from_python_3_12_on():
    module = pathlib.Path(sys.modules["hfremesh._core"].__file__)
    # Built with an older one it is for that version alone.
    assert module.name == "_core.abi3.so" or re.fullmatch(r"_core\.cpython-3(10|11)-.*\.so", module.name)


def test_importing_leaves_the_environment_alone():
    env = {k: v for k, v in os.environ.items() if k not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME")}
    code = "import os; a = dict(os.environ); import hfremesh; assert dict(os.environ) == a"
    subprocess.run([sys.executable, "-c", code], check=True, env=env)


def test_importing_needs_neither_meshio_nor_pyvista():
    code = "import sys, hfremesh; assert not {'meshio', 'pyvista', 'vtk', 'vtkmodules'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_it_is_what_was_installed():
    assert "site-packages" in str(FOLDER), "the tests are to see the installed package"
