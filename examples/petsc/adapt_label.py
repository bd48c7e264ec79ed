#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A mesh from a file, cells near a point refined, all of it improved: DMPlex.adaptLabel() with HFRemesh.

    hfremesh generate cavity -o cavity.msh
    mpirun -n 2 python3 adapt_label.py -dm_plex_filename cavity.msh -dm_adaptor hfremesh \\
        -dll_prepend /usr/lib/libhfremesh_petsc.so
"""

import sys

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402  after init(), which takes the options

REFINE = 1  # DM_ADAPT_REFINE


def label_sides(plex):
    """Gives the faces of the boundary the label "sides": 1 to 6, by the side of the unit cube they look to."""
    plex.getCoordinatesLocal()  # of all ranks together, before any of them asks for one point's
    plex.createLabel("sides")
    for face in range(*plex.getHeightStratum(1)):
        _, centre, _ = plex.computeCellGeometryFVM(face)
        for d in range(3):
            if abs(centre[d]) < 1e-9:
                plex.setLabelValue("sides", face, 1 + 2 * d)
            if abs(centre[d] - 1) < 1e-9:
                plex.setLabelValue("sides", face, 2 + 2 * d)


def total(comm, number):
    """The sum over all ranks."""
    vector = PETSc.Vec().createMPI((1, PETSc.DECIDE), comm=comm)
    vector.array[:] = number
    return vector.sum()


def determinants(plex):
    """Six times the volume of each cell of this rank, negative where it is inverted."""
    begin, end = plex.getDepthStratum(0)
    section, x = plex.getCoordinateSection(), plex.getCoordinatesLocal().array
    cells = []
    for cell in range(*plex.getHeightStratum(0)):
        closure = plex.getTransitiveClosure(cell)[0]
        cells.append([x[section.getOffset(v) :][:3] for v in closure if begin <= v < end])
    corners = np.array(cells)
    edges = corners[:, [2, 1, 3]] - corners[:, [0]]  # PETSc counts the first two corners the other way round
    return np.linalg.det(edges)


def show(plex, when):
    """Cells of all ranks, how many of them are inverted, and the area of the side x = 0 by its label."""
    volumes = determinants(plex)
    side = plex.getStratumIS("sides", 1)
    faces = side.indices if side else []
    area = total(plex.comm, sum(plex.computeCellGeometryFVM(f)[0] for f in faces))
    n, n_inverted = total(plex.comm, len(volumes)), total(plex.comm, np.count_nonzero(volumes <= 0))
    PETSc.Sys.Print(f"{when}: {n:.0f} cells, {n_inverted:.0f} inverted; side 1 has area {area:g}.")


def main():
    plex = PETSc.DMPlex().create()
    plex.setFromOptions()  # reads and distributes the mesh
    label_sides(plex)
    show(plex, "before")
    plex.createLabel("adapt")
    for cell in range(*plex.getHeightStratum(0)):
        _, centre, _ = plex.computeCellGeometryFVM(cell)
        if max(centre) < 0.2:
            plex.setLabelValue("adapt", cell, REFINE)
    show(plex.adaptLabel("adapt"), "after")


main()
