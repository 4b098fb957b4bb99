# SPDX-License-Identifier: MIT
"""Scenes with fewer triangles."""

import numpy as np
import pytest

import earshot as es


def simplify(scene, **options):
    try:
        return es.simplify(scene, **options)
    except es.Error as error:
        if "without OpenMesh" in str(error):
            pytest.skip("built without OpenMesh")
        raise


def bumpy_sheet(depth, cells=8):
    """A square of 4 x 4 m with a dent in the middle."""
    at = np.linspace(0, 4, cells + 1)
    x, z = (grid.ravel() for grid in np.meshgrid(at, at))
    y = np.where((x == 2) & (z == 2), depth, 0.0)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    quads = np.stack([corner, corner + cells + 1, corner + cells + 2, corner + 1], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return es.Scene.from_arrays(np.stack([x, y, z], axis=1), triangles, materials=["sheet"])


def test_keeps_the_distance_and_the_absorption_area():
    scene = bumpy_sheet(0.005)
    simple, report = simplify(scene, distance=0.01)
    assert len(simple.triangles) == 2 == report["triangles"]["after"]
    assert len(scene.triangles) == 128
    assert report["surfaces"]["to_simplified"]["upper"] == pytest.approx(0.005, abs=1e-3)
    area = report["absorption_area"]
    assert area["after"]["1000"] == pytest.approx(area["before"]["1000"])
    assert list(simple.materials) == ["sheet"]
    assert len(simplify(scene, distance=0.001).scene.triangles) > 2


def test_compares_both_scenes(tmp_path):
    room = es.shoebox((6, 3, 4), absorption=0.3)
    room.add_source("talker", (1, 1.2, 1))
    room.add_listener("ear", (4, 1.5, 3))
    simple = simplify(room, max_frequency=500, compare=True, order=1, rays=512)
    pair, = simple.report["pairs"]
    assert pair["paths"] == {"before": 7, "after": 7}
    assert "pairs" not in simplify(room).report
    simple.write(tmp_path / "room.glb")
    assert len(es.load(tmp_path / "room.glb").triangles) == len(simple.scene.triangles)


def test_tells_which_option_is_wrong():
    scene = bumpy_sheet(0.0)
    with pytest.raises(es.Error, match="distance"):
        es.simplify(scene, distance=-1.0)
    with pytest.raises(es.Error):
        es.simplify(scene, angle=270)
