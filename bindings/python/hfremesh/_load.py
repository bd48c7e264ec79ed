# SPDX-License-Identifier: BSD-3-Clause
"""Loads the extension module.

Idle OpenMP threads that spin make short parallel loops many times slower on a busy machine; to sleep and be woken costs
a tenth of the time on an idle one. So they look for work some 50 microseconds, and sleep then. The run-time library
reads how to wait when it is loaded, so it is told at that moment and the environment left as it was. Whoever sets one
of the variables has decided; a program that has loaded the same run-time library before keeps its way.
"""

import os

_DECIDED = ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME")
_WAY = {} if any(name in os.environ for name in _DECIDED) else {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "1000"}
os.environ.update(_WAY)
try:
    from . import _core as core
finally:
    for _name in _WAY:
        del os.environ[_name]

__all__ = ["core"]
