# SPDX-License-Identifier: BSD-3-Clause
"""Mesh files."""

from __future__ import annotations

import os
from typing import List, Union

from . import _core


def read(path: Union[str, os.PathLike[str]], *, threads: int = 0) -> _core.Mesh:
    """Reads a mesh: Medit, Gmsh, TetGen, VTK, VTU or OpenVolumeMesh, by extension (docs/file-formats.md), with its
    regions, labels, names and fields. mesh.notes says what was skipped. OSError when the file cannot be opened,
    ValueError with the place when what it says is broken or it has no tetrahedra."""
    return _core.read(os.fspath(path), threads)


def write(path: Union[str, os.PathLike[str]], mesh: _core.Mesh, *, binary: bool = False, variant: str = "",
          threads: int = 0) -> List[str]:
    """Writes a mesh with all that hangs on it, whole or not at all, and returns a line for each thing that the format
    cannot hold. binary: the binary variant of .msh, .vtk, .vtu; variant: '2.2', '4.1', 'zlib', …, as 'hfremesh convert
    --variant'. OSError when the file cannot be written, ValueError for an unknown extension."""
    return _core.write(os.fspath(path), getattr(mesh, "mesh", mesh), binary=binary, variant=variant, threads=threads)
