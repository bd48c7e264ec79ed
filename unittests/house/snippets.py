# SPDX-License-Identifier: BSD-3-Clause
"""snippets.py ROOT OUT.cc OUT.c: the C++ and C snippets of docs/*.md as two sources, to see that they compile.

Each snippet becomes the body of a function, or of a namespace where it declares things. CONTEXT says what a page leaves
out: the variables that its reader has. A snippet without a row here is an error.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
HEADERS = """
#include <functional>
#include <iostream>
#include <optional>
#include <vector>

#include <hfremesh/HalfFace/TetMesh.hh>
#include <hfremesh/IO/ReadWrite.hh>
#include <hfremesh/Operators/EdgeRemoval.hh>
#include <hfremesh/Operators/FaceSwap.hh>
#include <hfremesh/Operators/Operator.hh>
#include <hfremesh/Quality/CellQuality.hh>
#include <hfremesh/Quality/Metrics.hh>
#include <hfremesh/Remesh/Improve.hh>
#include <hfremesh/Remesh/Remesher.hh>
#include <hfremesh/Scheduler/Round.hh>
#include <hfremesh/Scheduler/RunUntilQuiet.hh>
#include <hfremesh/Scheduler/Seeds.hh>
#include <hfremesh/Scheduler/Workspace.hh>
"""
HFR = "using namespace hfr; "
# (page, first words): what stands before it in the function; None: it declares things.
CONTEXT = {
    ("building", "#include"): "",
    ("library", "hfr::TetMesh mesh"): "",
    ("library", "auto heat"): "hfr::TetMesh mesh; hfr::CellHandle cell(0);",
    ("operators", "struct SwapInBall"): None,
    ("quality", "const hfr::CustomMetric"): "static auto my_value = [](hfr::Vec3, hfr::Vec3, hfr::Vec3, hfr::Vec3) { return 0.0; };",
    ("scheduler", "Workspace work"): HFR + "TetMesh mesh; par::Policy policy;",
    ("scheduler", "const auto op"): HFR + "TetMesh mesh; Workspace work;",
    ("simulation", "#include"): "hfr::TetMesh mesh; std::vector<hfr::Vec3> displacement; "
                                "struct { void rebuild(const hfr::Edits&) {} } solver;",
    ("tutorials", "for (hfr::EdgeHandle"): "hfr::TetMesh mesh; auto visit = [](hfr::EdgeHandle, hfr::CellHandle) {};",
    ("c-api", "hfr_mesh*"): "double* points = 0; int32_t* cells = 0; int64_t n = 0, m = 0; "
                            "hfr_array new_points = {0, 0, 3, HFR_FLOAT64, 0};",
}
BLOCK = re.compile(r"^```(cpp|c)\n(.*?)^```", re.M | re.S)


def main():
    cpp, c, seen = [HEADERS], ["#include <hfremesh.h>\n#include <stdint.h>\n#include <stdio.h>\n"], set()
    for page in sorted((ROOT / "docs").glob("*.md")):
        text = page.read_text()
        for block in BLOCK.finditer(text):
            code = block[2]
            key = next((k for k in CONTEXT if k[0] == page.stem and code.startswith(k[1]) and k not in seen), None)
            line = text.count("\n", 0, block.start(2)) + 1
            if key is None:
                sys.exit(f"{page}:{line}: unittests/house/snippets.py has no row for this snippet")
            seen.add(key)
            for header in re.findall(r"^#include.*$", code, re.M):
                if header not in HEADERS:
                    sys.exit(f"{page}:{line}: HEADERS of unittests/house/snippets.py lacks {header}")
            body = re.sub(r"^#include.*$", "", code, flags=re.M)  # HEADERS has it, outside of the function
            place = f'#line {line} "{page}"\n'
            name = f"snippet_{len(seen)}"
            before = CONTEXT[key]
            if before is None:
                cpp.append(f"namespace {name} {{\nusing namespace hfr;\n{place}{body}}}\n")
            else:
                (cpp if block[1] == "cpp" else c).append(f"void {name}(void) {{\n{before}\n{place}{body}}}\n")
    if seen != set(CONTEXT):
        sys.exit(f"rows for snippets that are no more: {set(CONTEXT) - seen}")
    pathlib.Path(sys.argv[2]).write_text("\n".join(cpp))
    pathlib.Path(sys.argv[3]).write_text("\n".join(c))


main()
