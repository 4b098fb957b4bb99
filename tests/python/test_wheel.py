# SPDX-License-Identifier: MIT
"""A wheel with its libraries, in environments that have nothing else."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

import pytest

from conftest import PROJECT

BUILD = os.environ.get("EARSHOT_BUILD", "")
pytestmark = pytest.mark.skipif(
    not BUILD or not shutil.which("patchelf"), reason="needs a build (EARSHOT_BUILD) and patchelf")


def run(*command, **options):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, **options)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The wheel, and what was told of the libraries that it carries."""
    folder = tmp_path_factory.mktemp("wheel")
    result = run(PROJECT / "scripts/wheel", folder, pathlib.Path(BUILD, "capi"))
    if "No matching distribution" in result.stderr or "Connection" in result.stderr:
        pytest.skip("the package index cannot be reached")
    assert result.returncode == 0, result.stderr
    wheel, = folder.glob("*.whl")
    return wheel, result.stdout


def test_carries_the_libraries_of_the_list(made):
    wheel, told = made
    assert re.fullmatch(r"earshot-[0-9.]+-py3-none-manylinux_2_36_x86_64\.whl", wheel.name)
    rows = [line.split() for line in (PROJECT / "python/licenses.txt").read_text().splitlines()
            if not line.startswith("#")]
    assert [line.split() for line in told.splitlines()] == [[row[0], row[2]] for row in rows]
    assert not [row for row in rows if re.match(r"A?GPL", row[1])]
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    carried = [name for name in names if name.startswith("earshot/libraries/")]
    assert len(carried) == len(rows)
    for _, _, package in rows:
        assert any(name.endswith(f".dist-info/licenses/{package}.txt") for name in names), package
    assert {"earshot/libearshot.so.0", "earshot/_bindings.py", "earshot/py.typed"} <= set(names)
    assert not [name for name in names if "sofa" in name or "hdf5" in name]


# Run by the environment's own Python: the package's README, and a SOFA file that it cannot read.
PROGRAM = """
import re, sys
import numpy, earshot as es
assert "site-packages/earshot" in es.__file__, es.__file__
readme = open(sys.argv[1]).read()
exec(re.search(r"```python\\n(.*?)```", readme, re.DOTALL)[1])
assert open("talker__seat.wav", "rb").read(4) == b"RIFF"
assert es.simulate(room, order=1, rays=0, format="binaural").ir.any()
try:
    es.simulate(room, format="binaural", hrtf="head.sofa")
except es.Error as error:
    assert "libearshot-sofa.so" in str(error)
loaded = set(re.findall(r"/\\S+\\.so\\S*", open("/proc/self/maps").read()))
foreign = [name for name in loaded if re.search(r"lib(tbb|sndfile|hwy|draco)", name)]
assert foreign and all("earshot/libraries" in name for name in foreign), foreign
print(numpy.__version__)
"""


def check_in(python, wheel, folder):
    result = run(python, "-c", PROGRAM, PROJECT / "python/README.md", cwd=folder,
                 env={"PATH": "/nowhere"})
    assert result.returncode == 0, result.stderr
    assert "talker to seat" in result.stdout
    return result.stdout.split()[-1]


def test_runs_beside_the_systems_numpy(made, tmp_path):
    run(sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "venv", check=True)
    python = tmp_path / "venv/bin/python"
    run(python, "-m", "pip", "install", "--no-index", "--no-deps", made[0], check=True)
    assert check_in(python, made[0], tmp_path)


@pytest.mark.parametrize("version", ["1.26.4", "2.4.6"])
def test_runs_in_an_empty_environment(made, tmp_path, version):
    wheels = pathlib.Path(BUILD, "wheels", version)
    if not wheels.exists():
        result = run(sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary=:all:",
                     "--require-hashes", "-d", tmp_path / "wheels",
                     "-r", PROJECT / f"tests/python/numpy-{version}.txt")
        if result.returncode != 0:
            pytest.skip(f"numpy {version} cannot be fetched: {result.stderr.strip()[-200:]}")
        wheels.parent.mkdir(exist_ok=True)
        shutil.copytree(tmp_path / "wheels", wheels)
    run(sys.executable, "-m", "venv", tmp_path / "venv", check=True)
    python = tmp_path / "venv/bin/python"
    run(python, "-m", "pip", "install", "--no-index", "--find-links", wheels, made[0], check=True)
    assert check_in(python, made[0], tmp_path) == version
