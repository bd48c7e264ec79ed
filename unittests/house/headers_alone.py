# SPDX-License-Identifier: BSD-3-Clause
"""Compiles each header alone, in less than half the time of CMake's verification of header sets.

Usage: headers_alone.py BUILD

BUILD/compile_commands.json has the sources of that verification: one line each, which includes one header and nothing
else. The header that most of them include is parsed once, and stands before each of those: they include it anyway. One that
they include before it, and that lacks what is in it, is compiled without it. Prints what the compiler says of those
that it does not take; exit 1 if there is one.
"""

import collections
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.MULTILINE)
VERIFICATION = "_verify_interface_header_sets/"


class Includes:
    """What files include of those in some folders, through others, too; standard headers are not looked for."""

    def __init__(self, folders):
        self.folders = [pathlib.Path(folder) for folder in folders]
        self.known = {}

    def find(self, name):
        candidates = [folder / name for folder in self.folders]
        return next((path for path in candidates if path.is_file()), None)

    def of(self, path):
        if path not in self.known:
            self.known[path] = frozenset()  # for files that include each other
            direct = {header for header in map(self.find, INCLUDE.findall(path.read_text())) if header}
            self.known[path] = frozenset(direct.union(*map(self.of, direct)))
        return self.known[path]


def sources_by_flags(build):
    """Sources of the verification, by the compiler and its flags."""
    groups = collections.defaultdict(list)
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if VERIFICATION in entry["file"]:
            words = shlex.split(entry["command"])
            end = words.index("-o")
            groups[tuple(words[:end])].append(pathlib.Path(entry["file"]))
    return groups


def most_shared(includes, sources):
    """The header that is worth parsing once: in how many sources it is, times what it includes."""
    count = collections.Counter(header for source in sources for header in includes.of(source))
    return max(count, key=lambda header: (count[header] * len(includes.of(header)), str(header)))


def check(flags, sources, build, scratch):
    """Number of sources that do not compile."""

    def accepts(*arguments):
        return subprocess.run([*flags, *map(str, arguments)], cwd=build, check=False).returncode == 0

    includes = Includes(flag[2:] for flag in flags if flag.startswith("-I"))
    shared = most_shared(includes, sources)
    copy = scratch / "shared.hh"
    copy.write_text(f'#include "{shared}"\n')
    before = []
    if accepts("-c", "-x", "c++-header", copy, "-o", f"{copy}.gch"):  # else its own source says so
        before = ["-Winvalid-pch", "-include", copy]
    faults = 0
    for source in sources:
        faults += not accepts(*(before if shared in includes.of(source) else []), "-fsyntax-only", source)
    return faults


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    groups = sources_by_flags(build)
    if not groups:
        sys.exit(f"{build}/compile_commands.json has no header that is compiled alone")
    faults = 0
    for flags, sources in groups.items():
        with tempfile.TemporaryDirectory() as scratch:
            faults += check(flags, sources, build, pathlib.Path(scratch))
    print(f"{sum(map(len, groups.values()))} headers, {faults} do not compile alone")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
