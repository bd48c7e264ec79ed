# SPDX-License-Identifier: BSD-3-Clause
"""python -m hfremesh: the tool, as it is."""

import os
import sys
from pathlib import Path


def main() -> None:
    """Becomes the tool that the package carries."""
    tool = Path(__file__).parent / "bin" / "hfremesh"
    os.execv(tool, [str(tool), *sys.argv[1:]])


if __name__ == "__main__":
    main()
