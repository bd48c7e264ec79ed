#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many tangled meshes are repaired, and how fast.

Random boxes: every inner vertex, and those of the sides in their planes, moved at random until up to a third of the
cells are inverted. Where triangles of a side come to lie on one another, no mesh inside can be free of faults: such a
box must end with exit code 4, the folded faces listed, and no invalid cell but at these. Then the cavity and the
bulk-shear field at rising amplitudes: cells a second of the untangling passes, the whole mesh counted.

usage: bench/untangle.py TOOL [--seeds N] [--threads N] [--output FILE]
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

JITTERS = (0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1.0)
FIELDS = [("cavity", a, f"--sigma 0.08 --amplitude {a}") for a in (0.30, 0.35, 0.45)] + [
    ("bulk shear", a, f"--field bulk-shear --amplitude {a}") for a in (0.16, 0.18, 0.2)]


class Runner:
    def __init__(self, tool, threads):
        self.tool, self.threads = tool, threads
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="hfremesh-bench-"))

    def repair(self, *generate):
        """The report of a run that only repairs, and its exit code."""
        mesh, report = self.folder / "in.mesh", self.folder / "report.json"
        subprocess.run([self.tool, "generate", *generate, "-q", "-o", mesh], check=True)
        done = subprocess.run([self.tool, mesh, "-o", self.folder / "out.mesh", "-q", "-j", str(self.threads),
                               "--min-dihedral", "0.001", "--json", report], stderr=subprocess.DEVNULL)
        return json.loads(report.read_text()), done.returncode


def invalid(statistics):
    return statistics["inverted"] + statistics["flat"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the hfremesh program")
    parser.add_argument("--seeds", type=int, default=100, help="boxes of each jitter")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--output", help="Markdown file to write (default: standard output)")
    options = parser.parse_args()
    runner = Runner(options.tool, options.threads)
    lines = ["| jitter | inverted, % | repaired | exit 4, folded surface | of these: invalid cells left, all at folds | "
             "left elsewhere | worse | s a box |", "|---|---|---|---|---|---|---|---|"]
    for jitter in JITTERS:
        share = repaired = folded = at_folds = elsewhere = worse = seconds = 0
        for seed in range(1, options.seeds + 1):
            report, code = runner.repair("box", "--n", "9", "9", "10", "--jitter", str(jitter), "--seed", str(seed))
            before, after = report["before"], report["after"]
            share += 100 * invalid(before) / before["cells"] / options.seeds
            seconds += report["seconds"]["improve"] / options.seeds
            repaired += code == 0
            worse += invalid(after) > invalid(before)
            if code == 4:
                folded += report["result"]["n_folded_faces"] > 0
                n_at_folds = report["limits"]["counts"]["folded surface"]
                at_folds += n_at_folds
                elsewhere += invalid(after) - n_at_folds
        lines.append(f"| {jitter} | {share:.1f} | {repaired} | {folded} | {at_folds} | {elsewhere} | {worse} | {seconds:.2f} |")
    lines += ["", "| field | amplitude | cells | inverted | left | volume error | untangling, s | cells a second |",
              "|---|---|---|---|---|---|---|---|"]
    for name, amplitude, arguments in FIELDS:
        report, _ = runner.repair("cavity", "--n", "44", "46", "50", "--jitter", "0.201", *arguments.split())
        before, after = report["before"], report["after"]
        seconds = sum(p["seconds"]["total"] for p in report["passes"] if p["stage"] == "untangle")
        rate = f"{before['cells'] / seconds:,.0f}" if seconds > 0 else ""
        lines.append(f"| {name} | {amplitude} | {before['cells']:,} | {invalid(before):,} | {invalid(after)} | "
                     f"{abs(after['volume'] - before['enclosed_volume']):.1e} | {seconds:.2f} | {rate} |")
    text = "\n".join(lines) + "\n"
    if options.output:
        pathlib.Path(options.output).write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
