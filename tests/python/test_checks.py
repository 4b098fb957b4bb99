# SPDX-License-Identifier: MIT
"""Checks of models with known faults, and mended copies."""

import json

import numpy as np
import pytest

import earshot as es
from earshot._library import lib

pytestmark = pytest.mark.skipif(lib.es_has_check() == 0, reason="this build is without OpenMesh")

SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(low, high):
    """Corners and triangles, fronts inside."""
    corners = [[(low, high)[corner >> axis & 1][axis] for axis in range(3)] for corner in range(8)]
    return corners, [(a, *rest) for a, b, c, d in SIDES for rest in ((b, c), (c, d))]


def house(*more, doubled=False):
    """A room of 6 x 3 x 4 m and boxes, whose fronts look inside too."""
    vertices, triangles = [], []
    for low, high in (((0, 0, 0), (6, 3, 4)), *more):
        corners, sides = box(low, high)
        triangles += [tuple(v + len(vertices) for v in side) for side in sides]
        vertices += corners
    if doubled:
        triangles.append(triangles[0])
    return es.Scene.from_arrays(vertices, triangles, materials=["brick-painted"])


def placed(scene, listener=(5, 2, 3)):
    scene.add_source("talker", (4, 1, 1))
    scene.add_listener("seat", listener)
    return scene


def test_a_sound_model_is_clean():
    found = es.check(placed(house()), forecast=0.1)
    assert found.verdict == "clean"
    assert found.volume == pytest.approx(72) and found.surface == pytest.approx(108)
    assert not (found.leaks or found.misplaced or found.reversed or found.doubled)
    assert found.materials["brick-painted"].origin == "by name"
    assert found.materials["brick-painted"].area == pytest.approx(108)
    assert sorted(found.seconds) == [2, 3, 4, 5, 6]
    assert str(found).startswith("clean\n")
    assert found.extent.tolist() == [[0, 0, 0], [6, 3, 4]]


def test_faults_are_told_with_their_places():
    found = es.check(placed(house(((1, 1, 1), (2, 2, 2)), doubled=True), listener=(9, 1, 1)))
    assert found.verdict == "unusable"
    assert [(it.kind, it.name, it.fault) for it in found.misplaced][1] == (
        "listener", "seat", "outside")
    group, = found.reversed
    np.testing.assert_allclose(group.centre, 1.5)
    assert (group.triangles, group.first_triangle) == (12, 12)
    assert found.reversed_triangles.tolist() == list(range(12, 24))
    assert [group.first_triangle for group in found.doubled] == [24]
    assert found.air_of_sources.tolist() == [0] and found.air_of_listeners.tolist() == [1]
    assert any("outside of the room" in it.text for it in found.findings)


def test_a_leak_is_told_and_filled():
    corners, sides = box((0, 0, 0), (6, 3, 4))
    found = es.check(placed(es.Scene.from_arrays(corners, sides[:-1])))
    leak, = found.leaks
    assert leak.escapes and found.holes[leak.hole].area == pytest.approx(6)
    assert leak.area == pytest.approx(6, rel=0.2)
    assert es.check(found.mend(max_hole_area=10).scene()).leaks == []
    assert found.mend().filled_holes == 0


def test_a_mended_copy_has_what_can_be_reached(tmp_path):
    scene = placed(house(((1, 1, 1), (2, 2, 2)), ((1.4, 1.4, 1.4), (1.6, 1.6, 1.6)), doubled=True))
    found = es.check(scene)
    assert found.proven_unreached.tolist() == list(range(24, 36))
    mending = found.mend()
    assert mending.unreached.tolist() == list(range(24, 36))
    assert mending.doubled.tolist() == [36]
    assert mending.turned.tolist() == list(range(12, 24))
    assert mending.kept_unreached.size == 0
    assert len(mending.scene().triangles) == 24
    mending.write(tmp_path / "mended.glb")
    assert es.check(es.load(tmp_path / "mended.glb")).verdict == "clean"
    with pytest.raises(ValueError, match="glb"):
        mending.write(tmp_path / "mended.obj")


def test_the_report_is_that_of_the_program(tmp_path):
    found = es.check(placed(house()))
    found.write(tmp_path / "check.json")
    report = json.loads((tmp_path / "check.json").read_text())
    assert report["verdict"] == found.verdict
    assert report["volume"] == found.volume
    assert [it["text"] for it in report["findings"]] == [it.text for it in found.findings]


def test_inches_are_proposed():
    corners, sides = box((0, 0, 0), (6 / 0.0254, 3 / 0.0254, 4 / 0.0254))
    found = es.check(es.Scene.from_arrays(corners, sides), rays=10000)
    assert (found.proposed_unit, found.proposed_up) == ("in", "")


def test_wrong_arguments():
    scene = placed(house())
    with pytest.raises(ValueError, match="rays"):
        es.check(scene, rays=10)
    with pytest.raises(ValueError, match="crack"):
        es.check(scene, crack=2)
    with pytest.raises(es.Cancelled):
        es.check(scene, progress=lambda stage, done, total: False)
