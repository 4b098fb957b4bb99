#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Manual pages and completions, as the shells and man show them.

Usage: shells.py PROGRAM SHARE_FOLDER

The help is the oracle: what a shell offers for a command is what the command's --help lists.
"""

import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = pathlib.Path()
SHARE = pathlib.Path()


def earshot(*arguments):
    """Standard output of the program."""
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=True).stdout


def listed_commands(help_text):
    lines = help_text.partition("\nCommands:\n")[2].partition("\n\n")[0].splitlines()
    return [line.split()[0] for line in lines if re.match(r"  \S", line)]


def all_commands(words=()):
    """[], ["ir"], ..., ["pvs", "build"]: every command that some help lists."""
    yield list(words)
    for name in listed_commands(earshot(*words, "--help")):
        if name != "help":
            yield from all_commands((*words, name))


def listed_options(words):
    """The options that the help of a command lists, "-h" and "--help" both."""
    return {
        name
        for line in earshot(*words, "--help").splitlines()
        if re.match(r"  -", line)
        for name in line.split()[0].split(",")
    }


def at_terminal(command, keys, until, environment=None):
    """What a program prints on a terminal, typed `keys` when it has shown `$ `."""
    child, terminal = pty.fork()
    if child == 0:
        # The program's own folder comes first, so that a shell finds it.
        path = f"{PROGRAM.parent}:{os.environ['PATH']}"
        defaults = {"TERM": "xterm", "PS1": "$ ", "HOME": tempfile.gettempdir(), "PATH": path}
        os.execvpe(command[0], command, {**defaults, **(environment or {})})
    shown, typed, deadline = "", not keys, time.monotonic() + 20
    try:
        while time.monotonic() < deadline and not re.search(until, shown, re.DOTALL):
            if select.select([terminal], [], [], 0.1)[0]:
                try:
                    data = os.read(terminal, 65536)
                except OSError:  # the program has ended
                    break
                if not data:
                    break
                shown += data.decode()
            elif not typed and "$ " in shown:
                os.write(terminal, keys.encode())
                typed = True
        return shown
    finally:
        os.close(terminal)
        os.waitpid(child, 0)


class Bash(unittest.TestCase):
    SCRIPT = "bash-completion/completions/earshot"

    def words(self, line):
        """What completion offers at the end of `line`, without its readline."""
        words = line.split(" ")
        program = f"""
            source {SHARE / self.SCRIPT}
            COMP_WORDS=({' '.join(f"'{word}'" for word in words)}) COMP_CWORD={len(words) - 1}
            _earshot
            printf '%s\\n' "${{COMPREPLY[@]}}"
        """
        shell = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=True)
        self.assertEqual(shell.stderr, "")
        return set(shell.stdout.split())

    def test_offers_commands_and_options_of_the_help(self):
        self.assertEqual(self.words("earshot "), set(listed_commands(earshot("--help"))))
        for words in all_commands():
            line = " ".join(["earshot", *words, "-"])
            self.assertEqual(self.words(line), listed_options(words), line)

    def test_offers_values(self):
        self.assertEqual(self.words("earshot ir --mode "), {"complete", "sampled"})
        self.assertEqual(self.words("earshot ir hall.glb --mode = s"), {"sampled"})
        self.assertEqual(self.words("earshot ir --order "), set())
        self.assertEqual(self.words("earshot help mat"), {"materials"})
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "hall.glb")
            scene.touch()
            self.assertEqual(self.words(f"earshot ir {folder}/ha"), {str(scene)})
            self.assertEqual(self.words(f"earshot ir -o {folder}/ha"), {str(scene)})

    def test_completes_at_a_terminal(self):
        shell = ["bash", "--norc", "--noprofile", "-i"]
        keys = f"source {SHARE / self.SCRIPT}\nearshot ir --mat\t\t"
        self.assertRegex(at_terminal(shell, keys, "--material "), "--material ")
        shown = at_terminal(shell, keys[:-3] + "\t\t", "--max-length")
        self.assertRegex(shown, r"--material\s+--max-length")


@unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
class Zsh(unittest.TestCase):
    def completed(self, keys, until):
        setup = f"fpath=({SHARE / 'zsh/site-functions'} $fpath); autoload -U compinit; compinit -u -D"
        shell = ["zsh", "-f", "-i"]
        return at_terminal(shell, f"{setup}\n{keys}", until)

    def test_completes_at_a_terminal(self):
        shown = self.completed("earshot ir --ma\t\t", "--max-length")
        self.assertRegex(shown, r"--material\s")
        self.assertIn("--max-length", shown)
        shown = self.completed("earshot ir --mode \t\t", "sampled")
        self.assertRegex(shown, r"complete\s+sampled")
        shown = self.completed("earshot pvs bui\t", "pvs build")
        self.assertIn("build", shown)
        shown = self.completed("earshot help mater\t", "materials")
        self.assertIn("materials", shown)

    def test_has_every_option_of_the_help(self):
        text = (SHARE / "zsh/site-functions/_earshot").read_text()
        for words in all_commands():
            name = "_".join(["_earshot", *words])
            body = re.search(rf"^{name}\(\) {{\n(.*?)^}}", text, re.DOTALL | re.MULTILINE)[1]
            found = set(re.findall(r"^        '(?:\([^)]*\)|\*)(-[-\w]+)=?\[", body, re.MULTILINE))
            self.assertEqual(found, listed_options(words), name)
        subprocess.run(["zsh", "-n", SHARE / "zsh/site-functions/_earshot"], check=True)


@unittest.skipUnless(shutil.which("fish"), "fish is not installed")
class Fish(unittest.TestCase):
    def words(self, *lines):
        script = f"source {SHARE / 'fish/vendor_completions.d/earshot.fish'}\n"
        for line in lines:
            script += f"complete -C '{line}'\necho\n"
        home = {**os.environ, "HOME": tempfile.mkdtemp()}
        shell = subprocess.run(
            ["fish", "--no-config"], input=script, capture_output=True, text=True, env=home)
        shutil.rmtree(home["HOME"])
        self.assertEqual(shell.stderr, "")
        return [
            {line.split("\t")[0] for line in part.splitlines()}
            for part in shell.stdout.split("\n\n")[: len(lines)]
        ]

    def test_offers_commands_options_and_values(self):
        commands = list(all_commands())
        lines = [" ".join(["earshot", *words, "-"]) for words in commands]
        for words, offered in zip(commands, self.words(*lines)):
            self.assertEqual(offered, listed_options(words), words)
        lines = ["earshot ", "earshot ir --mode ", "earshot pvs ", "earshot help mater"]
        offered = self.words(*lines)
        self.assertEqual(offered[0], set(listed_commands(earshot("--help"))))
        self.assertEqual(offered[1], {"complete", "sampled"})
        self.assertEqual(offered[2], {"build", "query", "show", "extract"})
        self.assertEqual(offered[3], {"materials"})


@unittest.skipUnless(shutil.which("man"), "man is not installed")
class Man(unittest.TestCase):
    def page(self, *words):
        environment = {**os.environ, "MANPATH": str(SHARE / "man"), "MANWIDTH": "100",
                       "MANROFFOPT": "-ww", "LC_ALL": "C.UTF-8", "MAN_KEEP_FORMATTING": ""}
        shown = subprocess.run(["man", "--warnings=w", "-".join(["earshot", *words])],
                               capture_output=True, text=True, env=environment, check=True)
        self.assertEqual(shown.stderr, "")
        return re.sub(".\b", "", shown.stdout)

    def test_shows_every_command_and_option_of_the_help(self):
        for words in all_commands():
            page = self.page(*words)
            for name in listed_options(words):
                self.assertRegex(page, rf"(?m)^ +(-[-\w]+, )?{name}\b", words)
            for name in listed_commands(earshot(*words, "--help")):
                self.assertIn("-".join(["earshot", *words, name]) + "(1)", page)

    def test_keeps_the_lines_of_examples(self):
        for example in ["earshot ir room.obj --source 1,1.5,2 --listener seat=4,1.2,3 --order 6",
                        "--gain -6 --gain 0 --sample-rate 44100 -o duo.ogg"]:
            self.assertIn(example, self.page("ir") + self.page("auralize"))
        self.assertIn("brick-painted", self.page("materials"))


class Colour(unittest.TestCase):
    def error(self, **environment):
        return at_terminal([str(PROGRAM), "xyzzy"], "", "--help", environment)

    def test_is_shown_on_a_terminal_that_wants_it(self):
        self.assertIn("\x1b[1;31merror:\x1b[0m xyzzy", self.error())
        self.assertIn("\x1b[1;31merror:", self.error(NO_COLOR=""))
        for environment in [{"NO_COLOR": "1"}, {"TERM": "dumb"}]:
            self.assertIn("earshot: error: xyzzy", self.error(**environment))
        piped = subprocess.run([PROGRAM, "xyzzy"], capture_output=True, text=True)
        self.assertTrue(piped.stderr.startswith("earshot: error: xyzzy"))


if __name__ == "__main__":
    PROGRAM, SHARE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
