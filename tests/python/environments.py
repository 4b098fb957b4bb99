# SPDX-License-Identifier: MIT
"""Virtual environments with the package in them, and what must work there."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import pytest

from conftest import PROJECT

BUILD = os.environ.get("EARSHOT_BUILD", "")

# Run by the environment's own Python: the package's README.
README_PROGRAM = """
import re, sys
import numpy, earshot as es
assert "site-packages/earshot" in es.__file__, es.__file__
readme = open(sys.argv[1]).read()
exec(re.search(r"```python\\n(.*?)```", readme, re.DOTALL)[1])
assert open("talker__seat.wav", "rb").read(4) == b"RIFF"
assert es.simulate(room, order=1, rays=0, format="binaural").ir.any()
"""


def run(*command, **options):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, **options)


def unreachable(errors):
    """Whether pip's errors are those of a machine without a package index."""
    return "No matching distribution" in errors or "Connection" in errors


def new_environment(folder, *options):
    """The Python of a new virtual environment."""
    run(sys.executable, "-m", "venv", *options, folder / "venv", check=True)
    return folder / "venv/bin/python"


def numpy_wheels(version, folder):
    """A folder with numpy and what else the package needs, fetched once per build."""
    wheels = pathlib.Path(BUILD, "wheels", version)
    if not wheels.exists():
        result = run(sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary=:all:",
                     "--require-hashes", "-d", folder / "wheels",
                     "-r", PROJECT / f"tests/python/numpy-{version}.txt")
        if result.returncode != 0:
            pytest.skip(f"numpy {version} cannot be fetched: {result.stderr.strip()[-200:]}")
        # In one step, as another test may do the same at this moment.
        wheels.parent.mkdir(exist_ok=True)
        place = tempfile.mkdtemp(dir=wheels.parent)
        shutil.copytree(folder / "wheels", place, dirs_exist_ok=True)
        try:
            os.rename(place, wheels)
        except OSError:
            shutil.rmtree(place)
    return wheels


def run_readme(python, folder, program=README_PROGRAM):
    """What the README's program prints in an environment whose PATH has no compiler."""
    result = run(python, "-c", program, PROJECT / "python/README.md", cwd=folder,
                 env={"PATH": "/nowhere"})
    assert result.returncode == 0, result.stderr
    assert "talker to seat" in result.stdout
    return result.stdout
