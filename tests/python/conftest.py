# SPDX-License-Identifier: MIT
"""What the tests share: the program, the scenes, and a furnished room."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import earshot as es

PROJECT = pathlib.Path(__file__).resolve().parents[2]
SCENES = PROJECT / "scenes"


@pytest.fixture(scope="session")
def scenes():
    return SCENES


@pytest.fixture(scope="session")
def program():
    """Runs the earshot program of this build and returns its standard output."""
    name = os.environ.get("EARSHOT_PROGRAM")
    if not name:
        pytest.skip("EARSHOT_PROGRAM names no program to compare with")

    def run(*arguments):
        return subprocess.run([name, *map(str, arguments)], capture_output=True, text=True,
                              check=True).stdout

    return run


@pytest.fixture
def room():
    """A box with a source and two listeners."""
    made = es.shoebox((5.0, 2.7, 4.0), absorption=0.3)
    made.add_source("talker", (1.0, 1.5, 1.0))
    made.add_listeners([(4.0, 1.2, 3.0), (2.0, 1.2, 3.0)], ["seat", "desk"])
    return made


@pytest.fixture(scope="session")
def soup():
    """Random triangles in the unit cube: vertices (n, 3), triangles (m, 3)."""
    random = np.random.default_rng(21)
    centres = random.uniform(size=(200, 1, 3))
    corners = centres + random.normal(scale=0.04, size=(200, 3, 3))
    return corners.reshape(-1, 3), np.arange(600).reshape(-1, 3)


def crossings(start, end, corners):
    """Which of n segments cross which of m triangles, (n, m): signed volumes, in numpy."""

    def volume(a, b, c, d):
        return np.einsum("...i,...i", np.cross(b - a, c - a), d - a)

    s, e = start[:, None], end[:, None]
    a, b, c = (corners[None, :, k] for k in range(3))
    apart = volume(a, b, c, s) * volume(a, b, c, e) < 0.0
    sides = [volume(s, e, p, q) > 0.0 for p, q in ((a, b), (b, c), (c, a))]
    return apart & ((sides[0] == sides[1]) & (sides[1] == sides[2]))
