# SPDX-License-Identifier: MIT
"""Every Python and shell block of the pages runs, and prints what the page shows below it.

Blocks that use pyroomacoustics run where it is installed; bench/peers/fetch does that.
"""

import contextlib
import doctest
import importlib.util
import io
import os
import re
import subprocess

import pytest

from conftest import PROJECT, SCENES

PAGES = ["README.md", "python/README.md", "docs/tutorial.md", "docs/pyroomacoustics.md"]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


HAS_PYROOMACOUSTICS = importlib.util.find_spec("pyroomacoustics") is not None


def blocks(page):
    """(language, text) of a page, Python and shell with what is shown below them."""
    return [(match[1], match[2]) for match in BLOCK.finditer((PROJECT / page).read_text())]


def same(shown, printed):
    """Whether a text is what was printed, a line of `...` standing for any lines.

    Numbers may differ by 5 %: results are the same everywhere, but pages
    need not follow every improvement of the method.
    """
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    number = re.compile(r"\d+\.?\d*")

    def rounded(match, other):
        value, near = float(match), float(other)
        return abs(value - near) <= 0.05 * max(abs(value), abs(near)) + 0.02

    if doctest.OutputChecker().check_output(shown, printed, flags):
        return True
    ours, theirs = shown.split(), printed.split()
    if "..." in ours:
        ours = ours[: ours.index("...")]
        theirs = theirs[: len(ours)]
    if [number.sub("#", word) for word in ours] != [number.sub("#", word) for word in theirs]:
        return False
    pairs = zip(number.findall(" ".join(ours)), number.findall(" ".join(theirs)))
    return all(rounded(a, b) for a, b in pairs)


def run_python(text, names):
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, "block", "exec"), names)  # the page's own names go on
    return printed.getvalue()


def run_shell(text):
    program = os.environ.get("EARSHOT_PROGRAM")
    if not program:
        pytest.skip("EARSHOT_PROGRAM names no program")
    path = f"{os.path.dirname(program)}:{os.environ['PATH']}"
    result = subprocess.run(["bash", "-euc", text], capture_output=True, text=True,
                            env={**os.environ, "PATH": path})
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.parametrize("page", PAGES)
def test_blocks_run_and_print_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    (tmp_path / "scenes").symlink_to(SCENES)
    names, printed, ran, left_out = {"__name__": "page"}, None, 0, False
    for language, text in blocks(page):
        if language != "text":
            left_out = "pra." in text and not HAS_PYROOMACOUSTICS
        if left_out:
            continue
        if language == "python":
            printed = run_python(text, names)
        elif language == "sh":
            printed = run_shell(text)
        elif language == "text":
            assert printed is not None and same(text, printed), f"printed:\n{printed}"
        if language in ("python", "sh"):
            ran += 1
        elif language != "text":
            printed = None
    assert ran > 0


def test_doctests_of_the_package():
    import earshot
    from earshot import simulation, world

    for module in (earshot, simulation, world):
        assert doctest.testmod(module).attempted > 0
        assert doctest.testmod(module).failed == 0


def test_every_public_name_is_described():
    import earshot

    for name in earshot.__all__:
        described = getattr(earshot, name)
        if callable(described):
            assert described.__doc__, name
    listed = set(re.findall(r"`es\.(\w+)", (PROJECT / "python/README.md").read_text()))
    assert {"load", "shoebox", "extrude", "simulate", "Sight", "World", "Bvh", "VisibleSets",
            "auralize"} <= listed <= set(earshot.__all__)


PROGRAMS = sorted((PROJECT / "tests/python/programs").glob("*.py"))


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_programs_are_short_and_run(program, tmp_path, monkeypatch):
    """What the three kinds of users write: acousticians, makers of data sets, roboticists."""
    lines = [line for line in program.read_text().splitlines()
             if line and not line.startswith("#")]
    assert len(lines) <= 15
    (tmp_path / "scenes").symlink_to(SCENES)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    assert run_python(program.read_text(), {"__name__": "program"})
