# SPDX-License-Identifier: BSD-3-Clause
"""A mesh from a file, refined to a size and improved: DMPlex.adaptMetric() with HFRemesh.

    hfremesh generate cavity -o cavity.msh
    mpirun -n 2 python3 adapt_metric.py -dm_plex_filename cavity.msh -dm_adaptor hfremesh \\
        -dll_prepend /usr/lib/libhfremesh_petsc.so
"""

import sys

import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402  after init(), which takes the options

SIZE = 0.07


def total(comm, number):
    """The sum over all ranks."""
    vector = PETSc.Vec().createMPI((1, PETSc.DECIDE), comm=comm)
    vector.array[:] = number
    return vector.sum()


def label_surface(plex):
    """Gives the faces of the boundary of the unit cube the label "surface"."""
    plex.getCoordinatesLocal()  # of all ranks together, before any of them asks for one point's
    plex.createLabel("surface")
    for face in range(*plex.getHeightStratum(1)):
        _, centre, _ = plex.computeCellGeometryFVM(face)
        if any(abs(x) < 1e-9 or abs(x - 1) < 1e-9 for x in centre):
            plex.setLabelValue("surface", face, 1)


def show(plex, when):
    """Cells of all ranks, and the area of the faces that are labelled."""
    plex.getCoordinatesLocal()
    begin, end = plex.getHeightStratum(0)
    faces = plex.getStratumIS("surface", 1)
    area = sum(plex.computeCellGeometryFVM(f)[0] for f in (faces.indices if faces else []))
    n, surface = total(plex.comm, end - begin), total(plex.comm, area)
    PETSc.Sys.Print(f"{when}: {n:.0f} cells; the surface has area {surface:g}.")


def main():
    plex = PETSc.DMPlex().create()
    plex.setFromOptions()  # reads and distributes the mesh
    label_surface(plex)
    show(plex, "before")
    show(plex.adaptMetric(plex.metricCreateUniform(1 / SIZE**2)), "after")


main()
