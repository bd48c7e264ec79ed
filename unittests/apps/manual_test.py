# SPDX-License-Identifier: BSD-3-Clause
"""manual_test.py TOOL: what --help, the man page and the completions say is what the tool does."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

TOOL = os.path.abspath(sys.argv.pop(1))
SUBCOMMANDS = ["improve", "move", "check", "stats", "report", "convert", "generate", "devices", "manual"]
SHAPES = ["cavity", "box", "ball", "cylinder", "fandisk"]
COMMANDS = [[]] + [[name] for name in SUBCOMMANDS] + [["generate", shape] for shape in SHAPES]


def run(*words, **more):
    return subprocess.run([TOOL, *words], capture_output=True, text=True, check=False, **more)


def help_of(command):
    return run(*command, "--help").stdout


def options_of(command):
    return set(re.findall(r"^  (?:-[a-z], |B, -o, )?(--[a-z][a-z-]*)", help_of(command), re.M))


class Help(unittest.TestCase):
    def test_examples_come_before_usage_and_options(self):
        for command in COMMANDS:
            text = help_of(command)
            self.assertLess(0, text.find("\nExamples:\n"), command)
            self.assertLess(text.find("\nExamples:\n"), text.find("\nUsage: "), command)
            self.assertLess(text.find("\nUsage: "), text.find("\nEvery subcommand:\n"), command)

    def test_options_of_improve_stand_in_groups_goal_first(self):
        groups = re.findall(r"^([A-Z][A-Za-z ]*):$", help_of(["improve"]), re.M)
        self.assertEqual(groups, ["Examples", "Mesh", "Goal", "Surface", "Bounds", "Output", "Advanced", "Formats",
                                  "Every subcommand"])

    def test_lines_fit_a_terminal(self):
        for command in COMMANDS:
            for line in help_of(command).splitlines():
                if not line.startswith("  hfremesh"):  # an example is not broken
                    self.assertLessEqual(len(line), 80, line)

    def test_defaults_are_those_that_count(self):
        with tempfile.TemporaryDirectory() as folder:
            for shape in SHAPES:
                text = " ".join(help_of(["generate", shape]).split())
                counts = re.search(r"--n .*?\[default: ([0-9 ]+)\]", text).group(1).split()
                run("generate", shape, "-o", "a.mesh", cwd=folder)
                run("generate", shape, "-o", "b.mesh", "--n", *counts, cwd=folder)
                with open(f"{folder}/a.mesh", "rb") as a, open(f"{folder}/b.mesh", "rb") as b:
                    self.assertEqual(a.read(), b.read(), shape)

    def test_every_example_is_parsed(self):
        # Where no file is, exit code 2 says that the line was understood; 1 would be wrong use.
        seen = 0
        with tempfile.TemporaryDirectory() as folder:
            for command in COMMANDS:
                for line in re.findall(r"^  (hfremesh .*)$", help_of(command), re.M):
                    seen += 1
                    code = run(*line.split(" > ")[0].split()[1:], cwd=folder).returncode
                    self.assertIn(code, (0, 2, 3, 4), line)
        self.assertGreater(seen, 20)


class Man(unittest.TestCase):
    def test_page_names_every_option_of_every_subcommand(self):
        page = run("manual", "man").stdout.replace("\\-", "-")
        for command in COMMANDS:
            self.assertIn(" ".join(["hfremesh"] + command), page)
            for option in options_of(command):
                self.assertIn(option, page)

    @unittest.skipUnless(shutil.which("man"), "no man here")
    def test_page_is_formatted_without_a_warning(self):
        with tempfile.NamedTemporaryFile("w", suffix=".1") as file:
            file.write(run("manual", "man").stdout)
            file.flush()
            done = subprocess.run(["man", "--warnings", "-l", file.name], capture_output=True, text=True, check=False,
                                  env={**os.environ, "MANWIDTH": "80", "MANPAGER": "cat", "LC_ALL": "C.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("EXIT STATUS", done.stdout)


def completed_by_bash(words):
    script = ('source <("$0" manual bash); COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _hfremesh; '
              'printf "%s\\n" "${COMPREPLY[@]}"')
    with tempfile.TemporaryDirectory() as folder:  # where no file can be completed
        done = subprocess.run(["bash", "-c", script, TOOL, *words], capture_output=True, text=True, check=True, cwd=folder)
    return done.stdout.split()


class Completion(unittest.TestCase):
    @unittest.skipUnless(shutil.which("bash"), "no bash here")
    def test_bash_knows_subcommands_options_and_values(self):
        self.assertEqual(completed_by_bash(["hfremesh", "conv"]), ["convert"])
        self.assertEqual(completed_by_bash(["hfremesh", "improve", "--surf"]), ["--surface"])
        self.assertEqual(completed_by_bash(["hfremesh", "in.mesh", "--surf"]), ["--surface"])
        self.assertEqual(completed_by_bash(["hfremesh", "improve", "--surface", "f"]), ["frozen", "flat", "free"])
        self.assertEqual(completed_by_bash(["hfremesh", "improve", "--time-limit", ""]), [])
        self.assertEqual(completed_by_bash(["hfremesh", "generate", "b"]), ["box", "ball"])
        self.assertEqual(completed_by_bash(["hfremesh", "generate", "box", "--lo"]), ["--low"])
        self.assertEqual(completed_by_bash(["hfremesh", "manual", "z"]), ["zsh"])

    @unittest.skipUnless(shutil.which("bash"), "no bash here")
    def test_bash_knows_every_option(self):
        for command in COMMANDS[1:]:
            found = set(completed_by_bash(["hfremesh", *command, "--"]))
            self.assertEqual(found, options_of(command), command)

    @unittest.skipUnless(shutil.which("fish"), "no fish here")
    def test_fish_knows_options_and_values(self):
        with tempfile.NamedTemporaryFile("w", suffix=".fish") as file:
            file.write(run("manual", "fish").stdout)
            file.flush()

            def completed(line):
                done = subprocess.run(["fish", "--no-config", "-c", f"source {file.name}; complete -C '{line}'"],
                                      capture_output=True, text=True, check=True)
                return [found.split("\t")[0] for found in done.stdout.splitlines()]

            self.assertIn("convert", completed("hfremesh conv"))
            self.assertEqual(completed("hfremesh improve --surf"), ["--surface"])
            self.assertEqual(sorted(completed("hfremesh improve --surface f")), ["flat", "free", "frozen"])
            self.assertEqual(completed("hfremesh generate box --lo"), ["--low"])

    @unittest.skipUnless(shutil.which("zsh"), "no zsh here")
    def test_zsh_reads_its_file(self):
        with tempfile.NamedTemporaryFile("w") as file:
            file.write(run("manual", "zsh").stdout)
            file.flush()
            done = subprocess.run(["zsh", "-f", "-n", file.name], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""))


unittest.main()
