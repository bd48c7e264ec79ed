# SPDX-License-Identifier: BSD-3-Clause
"""stage.py ROOT OUT: the sources of the site in the folder OUT.

The pages of docs/ come as they are. Only links change: docs/README.md is the index, README.md, CHANGELOG.md and
CONTRIBUTING.md are pages of the site, and a link to any other file of the checkout becomes its path. A page for the
public headers of each layer, and one for C, say what Breathe puts there.
"""

import pathlib
import posixpath
import re
import shutil
import sys

ABOVE = {"README.md": "about.md", "CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md"}
# The order of the table of contents. A page that is missing here is an error: Sphinx warns of it.
CONTENTS = {
    "Start": ["start", "tutorials", "gallery/README", "coming-from", "about"],
    "Use": ["tool", "surface", "simulation", "file-formats", "reports", "json", "exit-codes", "opencl", "install", "building"],
    "Programs": ["library", "half-face-kernel", "python", "c-api", "petsc"],
    "How it works": ["architecture", "pipeline", "ablation", "quality", "operators", "scheduler", "distributed", "untangling", "determinism"],
    "Figures": ["performance", "worst-angles", "peers", "paper-tables", "fuzzing"],
    "Project": ["versions", "contributing", "changelog"],
}
# A link, or code, which stays what it is: a fenced block, or words between single backticks that begin no link's text.
LINK = re.compile(r"^```.*?^```$|(?<!\[)`[^`\n]*`|\]\((?!https?:|#)([^)#\s]+)(#[^)\s]*)?\)", re.M | re.S)


def headers(root):
    """Public headers of each layer, in the order of their CMakeLists.txt."""
    layers = {}
    order = re.search(r"set\(HFR_LAYERS ([^)]*)\)", (root / "cmake/HfrLayer.cmake").read_text()).group(1).split()
    for layer in order:
        words = re.sub(r"#.*", "", (root / "src" / layer / "CMakeLists.txt").read_text()).replace(")", " ) ").split()
        public, within = [], False
        for word in words:
            if word.isupper() or word == ")":
                within = word == "HEADERS"
            elif within and word.endswith(".hh"):
                public.append(word)
        if public:  # each once: some are named for builds with and without OpenMesh
            layers[layer] = list(dict.fromkeys(public))
    return layers


def place(inside):
    """Where a file of the checkout stands in the site; "" where it does not."""
    if inside in ("docs", "docs/README.md"):
        return "index.md"
    if inside.startswith("docs/"):
        return inside[len("docs/") :]
    return ABOVE.get(inside, "")


def relinked(text, page, root):
    """The text of `page` (a path in the checkout) with links as the site has them."""

    def link(match):
        if match.group(1) is None:
            return match.group(0)
        target, anchor = match.group(1), match.group(2) or ""
        path = (root / page).parent.joinpath(target).resolve()
        if not path.is_relative_to(root) or not path.exists():
            sys.exit(f"stage: {page} links to {target}, which is not there")
        inside = path.relative_to(root).as_posix()
        if place(inside):
            return f"]({posixpath.relpath(place(inside), posixpath.dirname(place(str(page))) or '.')}{anchor})"
        return f"](#outside){{outside}}{inside}{{/outside}}"

    text = LINK.sub(link, text)
    # "[what](file outside of the site)" is shown as "what (file)"; where both are one, once.
    outside = re.compile(r"\[([^\]]*)\]\(#outside\)\{outside\}(.*?)\{/outside\}")
    return outside.sub(lambda m: f"`{m[2]}`" if m[1].strip("`") == m[2] else f"{m[1]} (`{m[2]}`)", text)


def contents():
    blocks = []
    for caption, pages in CONTENTS.items():
        blocks.append("```{toctree}\n:hidden:\n:caption: " + caption + "\n\n" + "\n".join(pages) + "\n```\n")
    blocks.append("```{toctree}\n:hidden:\n:caption: Reference\n:glob:\n\nreference/*\n```\n")
    return "\n" + "\n".join(blocks)


def reference(root, out):
    (out / "reference").mkdir()
    for layer, files in headers(root).items():
        text = f"# C++: {layer}\n\n"
        for file in files:
            text += f"## {file}\n\n`#include <hfremesh/{layer}/{file}>`\n\n"
            text += "```{doxygenfile} " + f"{file}\n```\n\n"
        (out / "reference" / f"cpp-{layer}.md").write_text(text)
    text = "# C\n\n[c-api.md](../c-api.md) says how it is used.\n\n```{doxygenfile} hfremesh.h\n```\n"
    (out / "reference" / "c.md").write_text(text)
    text = "# Python\n\n[python.md](../python.md) says how it is used.\n\n```{automodule} hfremesh\n"
    (out / "reference" / "python.md").write_text(text + ":members:\n:imported-members:\n:no-index-entry:\n```\n")


def main():
    root, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    if len(sys.argv) > 3 and sys.argv[3] == "--headers":
        print(" ".join(f"src/{layer}/{file}" for layer, files in headers(root).items() for file in files))
        return
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    for file in sorted((root / "docs").rglob("*")):
        inside = file.relative_to(root).as_posix()
        if not file.is_file() or inside.startswith("docs/site/"):
            continue
        target = out / place(inside)
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            target.write_text(relinked(file.read_text(), inside, root))
        else:
            shutil.copy(file, target)
    for page, name in ABOVE.items():
        (out / name).write_text(relinked((root / page).read_text(), page, root))
    (out / "index.md").write_text((out / "index.md").read_text() + contents())
    reference(root, out)


main()
