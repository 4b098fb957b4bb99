# SPDX-License-Identifier: MIT
import sys

import numpy as np
import pytest

import earshot as es


def test_figures_show_the_numbers(room, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    result = es.simulate(room, order=2, rays=1000, length=0.4)
    response = result["talker", "seat"]
    axes = response.plot_response()
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), response.ir[0])
    decay = response.plot_decay().lines[1].get_ydata()
    assert decay[0] == pytest.approx(0.0) and (np.diff(decay[np.isfinite(decay)]) <= 0).all()
    drawn = sum(len(lines.get_segments()) for lines in response.plot_echogram().collections)
    assert drawn == len(response.paths)
    heights = [bar.get_height() for bar in result.plot_metric("sti").patches]
    np.testing.assert_array_equal(heights, result.sti[0])
    assert len(result.plot_metric("t30").containers) == 2
    axes = room.plot()
    assert axes.get_title() == "shoebox"
    axes.figure.savefig(tmp_path / "room.png")
    with pytest.raises(es.ArgumentError, match="t31"):
        result.plot_metric("t31")


def test_without_matplotlib_the_error_says_so(room, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(es.MissingPackage, match="pip install matplotlib"):
        room.plot()
