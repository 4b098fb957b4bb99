# SPDX-License-Identifier: MIT
"""Positions from arrivals that images in a box tell."""

import json
import math

import numpy as np
import pytest

import earshot as es

SIZE = np.array((5, 2.7, 4))
SPEED = 343.2
WALLS = {"west": (0, 0), "east": (0, 1), "floor": (1, 0), "ceiling": (1, 1), "north": (2, 0), "south": (2, 1)}
SOURCES = {"talker": (1, 1.5, 1), "loudspeaker": (4, 1.2, 0.8)}
EARS = {"left": (3.1, 1.2, 2.6), "right": (3.3, 1.1, 2.9), "back": (1.5, 2, 3.2)}


def arrivals(with_names=True):
    rows = []
    for source, at in SOURCES.items():
        for ear, to in EARS.items():
            for wall in ["direct", *WALLS]:
                image = np.array(at, float)
                if wall != "direct":
                    axis, end = WALLS[wall]
                    image[axis] = 2 * end * SIZE[axis] - image[axis]
                time = np.linalg.norm(image - to) / SPEED
                rows.append((source, ear, time, wall) if with_names else (source, ear, time))
    return rows


@pytest.fixture
def room():
    """Stated up to 2 cm off."""
    scene = es.shoebox(SIZE)
    off = np.array((0.01, -0.02, 0.015))
    for name, at in SOURCES.items():
        scene.add_source(name, at)
    for sign, (name, at) in zip((1, -1, 0.5), EARS.items()):
        scene.add_listener(name, at + sign * off)
    try:
        es.locate(scene, arrivals()[:1])
    except es.Error as error:
        if "Ceres" not in str(error):
            raise
        pytest.skip("built without Ceres' headers")
    return scene


@pytest.mark.parametrize("with_names", [True, False])
def test_positions_are_found(room, with_names):
    found = es.locate(room, arrivals(with_names), source_error=0, temperature_error=5,
                      listener_error=math.inf, timing_error=1e-6, folds=5)
    assert found.converged and found.matched == 42 and found.order == 1
    for name, at in EARS.items():
        np.testing.assert_allclose(found.listeners[name], at, atol=3e-4)
    assert (found.listeners.errors > 0).all() and (found.listeners.data_shares == 1).all()
    assert (found.sources.errors == 0).all()
    assert found.speed_of_sound == pytest.approx(SPEED, abs=0.02)
    assert found.median_after <= found.median_held_out < 1e-6 < found.median_before
    assert found.arrivals.shape == (42, 4) and found.walls.shape == (6, 5)
    assert found.motions == {}
    assert "42 arrivals" in repr(found)


def test_latencies_and_motions(room):
    late = [(*row[:2], row[2] + 0.004, row[3]) for row in arrivals()]
    found = es.locate(room, late, latency_error=0.01, timing_error=1e-6)
    np.testing.assert_allclose(found.latencies, 0.004, atol=2e-5)
    assert list(found.motions)[:2] == ["translation x", "translation y"]
    assert all(share > 0.5 for share in found.motions.values())
    direct = es.locate(room, [row for row in arrivals() if row[3] == "direct"])
    assert all(share < 0.01 for name, share in direct.motions.items() if name != "scale")


def test_the_file_is_that_of_the_result(room, tmp_path):
    found = es.locate(room, arrivals())
    found.write(tmp_path / "positions.json")
    document = json.loads((tmp_path / "positions.json").read_text())
    assert [source["name"] for source in document["sources"]] == list(SOURCES)
    assert document["listeners"][1]["position"] == list(found.listeners["right"])
    assert document["arrivals"][1]["surfaces"] == "west"
    assert document["median_error"]["after"] == found.median_after


def test_wrong_arrivals(room):
    for wrong, message in [([("nobody", "left", 0.1)], "nobody"),
                           ([("talker", "left")], "surfaces"),
                           ([("talker", "left", 0.01, "roof")], "roof"),
                           ([("talker", "left", math.nan)], "times"),
                           ([], "arrivals")]:
        with pytest.raises(es.Error, match=message):
            es.locate(room, wrong)
