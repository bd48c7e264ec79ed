# SPDX-License-Identifier: BSD-3-Clause
"""Loads the extension module.

Idle OpenMP threads that spin make short parallel loops many times slower on a busy machine. The run-time library reads
how to wait when it is loaded, so it is told at that moment and the environment left as it was. Whoever sets one of the
variables has decided; a program that has loaded the same run-time library before keeps its way.
"""

import os

_DECIDED = ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME")
_decides = not any(name in os.environ for name in _DECIDED)
if _decides:
    os.environ["OMP_WAIT_POLICY"] = "passive"
try:
    from . import _core as core
finally:
    if _decides:
        del os.environ["OMP_WAIT_POLICY"]

__all__ = ["core"]
