# SPDX-License-Identifier: MIT
"""`pip install .` as users type it, in a virtual environment that has nothing but pip."""

import os
import pathlib

import pytest

from conftest import PROJECT
from environments import BUILD, new_environment, numpy_wheels, run, run_readme, unreachable

pytestmark = pytest.mark.skipif(not BUILD, reason="needs a build (EARSHOT_BUILD)")


def install(folder, *options):
    """The environment's Python, with the package that pip has made of the project's folder."""
    python = new_environment(folder)
    result = run(python, "-m", "pip", "install", "--disable-pip-version-check", "--find-links",
                 numpy_wheels("2.4.6", folder), *options, PROJECT)
    if unreachable(result.stderr):
        pytest.skip("the package index cannot be reached")
    assert result.returncode == 0, result.stderr
    return python


def test_pip_installs_the_folder(tmp_path):
    """With the library of this build, so that only the package is made."""
    python = install(tmp_path, "--config-settings=cmake.define.EARSHOT_PYTHON_LIBRARY="
                     + str(pathlib.Path(BUILD, "capi")))
    assert run_readme(python, tmp_path)
    run(python, "-m", "pip", "uninstall", "--yes", "earshot", check=True)
    assert not list((tmp_path / "venv").glob("lib/python*/site-packages/earshot/*.py"))


@pytest.mark.skipif(not os.environ.get("EARSHOT_INSTALL_FROM_SOURCES"),
                    reason="compiles the library: ctest -C Install -R install_from_sources")
def test_pip_builds_and_installs_the_folder(tmp_path):
    assert run_readme(install(tmp_path), tmp_path)
