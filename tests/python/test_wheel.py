# SPDX-License-Identifier: MIT
"""A wheel with its libraries, in environments that have nothing else."""

import pathlib
import re
import shutil
import zipfile

import pytest

from conftest import PROJECT
from environments import (
    BUILD,
    README_PROGRAM,
    new_environment,
    numpy_wheels,
    run,
    run_readme,
    unreachable,
)

pytestmark = pytest.mark.skipif(
    not BUILD or not shutil.which("patchelf"), reason="needs a build (EARSHOT_BUILD) and patchelf")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The wheel, and what was told of the libraries that it carries."""
    folder = tmp_path_factory.mktemp("wheel")
    result = run(PROJECT / "scripts/wheel", folder, pathlib.Path(BUILD, "capi"))
    if unreachable(result.stderr):
        pytest.skip("the package index cannot be reached")
    assert result.returncode == 0, result.stderr
    wheel, = folder.glob("*.whl")
    return wheel, result.stdout


def test_carries_the_libraries_of_the_list(made):
    wheel, told = made
    assert re.fullmatch(r"earshot-[0-9.]+-py3-none-manylinux_2_36_x86_64\.whl", wheel.name)
    rows = [line.split() for line in (PROJECT / "python/licenses.txt").read_text().splitlines()
            if not line.startswith("#")]
    rows = [row for row in rows if row[3:] != ["optional"] or row[0] in told]
    assert [line.split() for line in told.splitlines()] == [[row[0], row[2]] for row in rows]
    assert not [row for row in rows if re.match(r"A?GPL", row[1])]
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    carried = [name for name in names if name.startswith("earshot/libraries/")]
    assert len(carried) == len(rows)
    for _, _, package, *_ in rows:
        assert any(name.endswith(f".dist-info/licenses/{package}.txt") for name in names), package
    assert {"earshot/libearshot.so.0", "earshot/_bindings.py", "earshot/py.typed"} <= set(names)
    assert not [name for name in names if "sofa" in name or "hdf5" in name]


# A SOFA file cannot be read, and every library but the system's is the wheel's.
PROGRAM = README_PROGRAM + """
try:
    es.simulate(room, format="binaural", hrtf="head.sofa")
except es.Error as error:
    assert "libearshot-sofa.so" in str(error)
loaded = set(re.findall(r"/\\S+\\.so\\S*", open("/proc/self/maps").read()))
foreign = [name for name in loaded if re.search(r"lib(tbb|sndfile|hwy|draco)", name)]
assert foreign and all("earshot/libraries" in name for name in foreign), foreign
print(numpy.__version__)
"""


def test_runs_beside_the_systems_numpy(made, tmp_path):
    python = new_environment(tmp_path, "--system-site-packages")
    run(python, "-m", "pip", "install", "--no-index", "--no-deps", made[0], check=True)
    assert run_readme(python, tmp_path, PROGRAM)


@pytest.mark.parametrize("version", ["1.26.4", "2.4.6"])
def test_runs_in_an_empty_environment(made, tmp_path, version):
    wheels = numpy_wheels(version, tmp_path)
    python = new_environment(tmp_path)
    run(python, "-m", "pip", "install", "--no-index", "--find-links", wheels, made[0], check=True)
    assert run_readme(python, tmp_path, PROGRAM).split()[-1] == version
