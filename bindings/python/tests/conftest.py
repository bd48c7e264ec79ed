# SPDX-License-Identifier: BSD-3-Clause
import signal

import numpy as np
import pytest

import hfremesh as hf


@pytest.fixture(autouse=True, scope="session")
def interrupts_arrive():
    """A shell that starts the tests in the background has interrupts ignored, and so would Python."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def cavity():
    """4,320 cells, some of them inverted. Nobody writes into it."""
    mesh = hf.generate.cavity((8, 9, 10))
    assert hf.stats(mesh).inverted > 5
    return mesh


@pytest.fixture
def tet():
    """One cell as plain lists."""
    return [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]


@pytest.fixture
def bytes_of():
    """All bits of a mesh's arrays."""
    return lambda mesh: (mesh.points.tobytes(), np.ascontiguousarray(mesh.cells).tobytes(), mesh.hash)
