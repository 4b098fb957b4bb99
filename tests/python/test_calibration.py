# SPDX-License-Identifier: MIT
"""Absorption fitted to the metrics of a simulation."""

import csv

import numpy as np
import pytest

import earshot as es


def room(floor, walls):
    scene = es.shoebox((6, 3, 5), absorption=walls)
    scene.assign({"floor": floor, "ceiling": 0.5})
    scene.add_source("talker", (1, 1.2, 1.5))
    for name, at in (("a", (4.5, 1.6, 3.5)), ("b", (2.5, 0.5, 4)), ("c", (3.5, 2.4, 1))):
        scene.add_listener(name, at)
    return scene


def measure(scene, **options):
    result = es.simulate(scene, order=2, rays=2048, **options)
    return [("talker", name, metric, 1000, float(result.metrics[metric][0, i, 5]), 0.01)
            for i, name in enumerate(("a", "b", "c")) for metric in ("t30", "c80", "g")
            if np.isfinite(result.metrics[metric][0, i, 5])]


@pytest.fixture
def rows():
    return measure(room(0.3, 0.2))


def calibrate(scene, measured, **options):
    try:
        return es.calibrate(scene, measured, order=2, rays=2048, **options)
    except es.Error as error:
        if "without Ceres" in str(error):
            pytest.skip("built without Ceres")
        raise


def test_metrics_come_out_as_measured(rows, tmp_path):
    scene = room(0.2, 0.25)
    fit = calibrate(scene, rows, keep=["ceiling"])
    assert fit.absorption.shape == (6, 10)
    assert (fit["ceiling"] == 0.5).all()
    low, high = fit.interval
    assert ((low <= fit.absorption) & (fit.absorption <= high)).all()
    report = fit.report
    assert report["bands"][5]["after_jnd"] < 0.3 * report["bands"][5]["before_jnd"]
    fit.apply(scene)
    again = {row[:4]: row[4] for row in measure(scene)}
    common = [row for row in rows if row[:4] in again]  # others are too uncertain to tell
    assert len(common) >= 6
    for row in common:
        assert again[row[:4]] == pytest.approx(row[4], rel=0.03, abs=0.15)
    fit.write(tmp_path / "room.materials.json")
    assert "floor" in (tmp_path / "room.materials.json").read_text()


def test_a_table_is_as_good_as_rows(rows, tmp_path):
    file = tmp_path / "table.csv"
    with file.open("w", newline="") as out:
        csv.writer(out).writerows([*rows, ("talker", "nobody", "t30", 1000, 1, 0.1)])
    scene = room(0.2, 0.25)
    of_rows = calibrate(scene, rows, max_simulations=2)
    of_file = calibrate(scene, file, max_simulations=2)
    np.testing.assert_array_equal(of_rows.absorption, of_file.absorption)
    assert any("nobody" in message.text for message in of_file.warnings)


def test_what_is_wrong_is_told(rows):
    scene = room(0.2, 0.25)
    for bad in ([], [("talker", "a", "t30", 1000)], [("nobody", "a", "t30", 1000, 1)],
                [("talker", "a", "t60", 1000, 1)], [("talker", "a", "t30", 440, 1)],
                [("talker", "a", "t30", 1000, "long")], [("talker", "a", "t30", 1000, 1, -1)]):
        with pytest.raises((es.Error, KeyError, ValueError, TypeError)):
            es.calibrate(scene, bad)
    with pytest.raises(es.Error):
        es.calibrate(scene, "absent.csv")


def test_scattering_is_fitted_if_asked_for(rows):
    scene = room(0.3, 0.2)
    kept = calibrate(scene, rows, max_simulations=1)
    with pytest.raises(es.Error):
        kept.scattering
    fit = calibrate(scene, rows, fit_scattering=True, max_simulations=2, keep=["ceiling"])
    assert fit.scattering.shape == fit.scattering_error.shape == fit.absorption.shape
    assert fit.scattering_identified.shape == fit.absorption.shape
    low, high = fit.scattering_interval
    assert ((low <= fit.scattering) & (fit.scattering <= high)).all()
    ceiling = scene.materials.index("ceiling")
    assert (fit.scattering_prior_error[ceiling] == 0).all()
    assert (fit.scattering[ceiling] == fit.scattering_prior[ceiling]).all()
    assert fit.report["materials"][ceiling]["scattering"]["value"] == list(fit.scattering[ceiling])
