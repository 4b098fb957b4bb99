# SPDX-License-Identifier: MIT
"""Maps against simulations with listeners at the same points."""

import csv
import json

import numpy as np
import pytest

import earshot as es


def room():
    scene = es.shoebox((5, 2.7, 4), absorption=0.3)
    scene.add_source("talker", (1, 1.5, 1))
    return scene


def test_values_are_those_of_listeners():
    scene = room()
    at = [(3.5, 1.2, 2.5), (2, 1.2, 3), (4.2, 1.5, 0.7)]
    found = es.map(scene, at=at, metrics=["c80", "t30:1000", "sti"], rays=0, order=12)
    assert found.values.shape == (3, 1, 3)
    assert found.metrics == ["c80", "t30:1000", "sti"]
    assert np.isnan(found.cells).all()
    for index, point in enumerate(at):
        scene.add_listener(f"seat {index}", point)
    expected = es.simulate(scene, rays=0, order=12)
    np.testing.assert_array_equal(found["c80"][:, 0],
                                  [expected.metrics["c80_mid"][0, i] for i in range(3)])


def test_rays_agree_within_their_standard_errors():
    scene = room()
    at = [(3.5, 1.2, 2.5), (4.2, 1.5, 0.7)]
    found = es.map(scene, at=at, metrics="g:1000", rays=20000)
    again = es.map(scene, at=at, metrics="g:1000", rays=20000, seed=5)
    error = np.hypot(found.standard_errors, again.standard_errors)
    assert (error > 0).all()
    assert (np.abs(found.values - again.values) < 4 * error).all()


def test_cells_cover_a_rectangle_and_are_halved_where_values_change():
    found = es.map(room(), rect=(0, 0, 5, 4), step=0.25, coarse_step=1, metrics="g", rays=0,
                   order=12)
    cells = found.cells
    area = (cells[:, 2] - cells[:, 0]) * (cells[:, 3] - cells[:, 1])
    assert area.sum() == pytest.approx(20)
    assert len(np.unique(area.round(9))) > 1
    middles = np.stack([cells[:, [0, 2]].mean(axis=1), cells[:, [1, 3]].mean(axis=1)], axis=1)
    np.testing.assert_allclose(found.points[:, [0, 2]], middles)
    assert found.excluded == {"outside": 0, "in_solid": 0, "near_surface": 0}


def test_limits_and_contours():
    scene = es.shoebox((5, 2.7, 4), absorption=0.999)
    scene.add_source("talker", (1, 1.5, 1))
    found = es.map(scene, rect=(0, 0, 5, 4), step=0.25, coarse_step=0.25, metrics="g", rays=0,
                   order=12)
    # Hardly more than the direct sound, whose G is 20 dB - 20 lg r, r the distance.
    level = 20 - 20 * np.log10(2)
    lines = found.contour("g", level)
    assert len(lines) == 1
    distance = np.linalg.norm(lines[0] - (1, 1.5, 1), axis=1)
    np.testing.assert_allclose(distance, 2, atol=0.02)
    limit = found.limit("g", level)
    near = np.linalg.norm(found.points - (1, 1.5, 1), axis=1) <= 2
    assert limit.share == pytest.approx(near.mean(), abs=0.01)
    assert found.limit("g", level, at_least=False).share == pytest.approx(1 - limit.share)


def test_files(tmp_path):
    found = es.map(room(), on="floor", step=1, coarse_step=1, metrics=["g", "ts"], rays=0,
                   order=12)
    found.write(tmp_path / "map.csv")
    rows = list(csv.DictReader((tmp_path / "map.csv").open()))
    assert len(rows) == len(found.points)
    assert [float(row["talker/g"]) for row in rows] == found["g"][:, 0].tolist()
    found.write(tmp_path / "map.json")
    maps = json.loads((tmp_path / "map.json").read_text())["maps"]
    assert [entry["metric"] for entry in maps] == ["g", "ts"]
    found.draw(tmp_path / "map.svg", "ts", walls=room())
    assert (tmp_path / "map.svg").read_text().startswith("<svg")
    found.draw(tmp_path / "map.png", limit=12.0)
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(es.ArgumentError, match="neither"):
        found.draw(tmp_path / "map.txt")


def test_wrong_arguments():
    scene = room()
    with pytest.raises(es.ArgumentError, match="exactly one"):
        es.map(scene)
    with pytest.raises(es.ArgumentError, match="rect"):
        es.map(scene, rect=(0, 0, 1))
    with pytest.raises(es.UnknownName):
        es.map(scene, on="carpet")
    with pytest.raises(es.Error, match="t3O"):
        es.map(scene, rect=(0, 0, 1, 1), metrics="t3O")
    found = es.map(scene, at=[(2, 1, 2)], metrics="g", rays=0)
    with pytest.raises(es.UnknownName):
        found.limit("sti", 0.5)
