# SPDX-License-Identifier: MIT
"""Engines: scenes that are heard while they move."""

import earshot as es
import numpy as np
import pytest


def room():
    scene = es.shoebox((5, 3, 4), absorption=0.2)
    scene.add_source("talker", (1, 1.2, 1.5))
    scene.add_listener("seat", (3.5, 1.7, 2.5))
    return scene


def play(engine):
    heard = []
    for block in range(16):
        engine.place_source("talker", (1 + 0.002 * block, 1.2, 1.5))
        engine.publish()
        engine.update()
        signal = np.zeros((1, 256))
        signal[0, 0] = block == 0
        heard.append(engine.render(signal))
    return np.concatenate(heard, axis=2)


def test_direct_sound_of_a_click():
    engine = es.Engine(room(), order=0, rays=0, format="ambisonic:1", air_absorption=False)
    heard = play(engine)
    assert heard.shape == (1, 4, 4096)
    distance = np.hypot(np.hypot(2.5, 0.5), 1.0)
    loudest = np.abs(heard[0, 0]).argmax()
    assert abs(loudest - engine.latency - distance / 343.2 * 48000) < 2
    assert abs(heard[0, 0].sum() * distance - 1) < 0.01
    # The listener looks along -Z: the source, at -X and -Z from there, is ahead and on the left.
    assert heard[0, 1].sum() > 0 and heard[0, 3].sum() > 0
    assert engine.statistics.paths == 1
    assert engine.statistics.blocks == 16


def test_same_bits_with_a_budget_of_work():
    options = dict(order=2, rays=300, late_length=0.2, budget_work=500, format="mono")
    first = play(es.Engine(room(), **options))
    assert np.array_equal(first, play(es.Engine(room(), threads=1, **options)))
    assert np.isfinite(first).all() and first.any()


def test_begins_at_a_time_of_the_animation(scenes):
    door = es.load(scenes / "door.gltf")
    for time in (0.0, 0.5, 1.0):
        engine = es.Engine(door, order=2, rays=0, time=time)
        found = es.simulate(door, order=2, rays=0, time=time)
        assert engine.statistics.paths == len(found.paths)
    assert es.Engine(door, order=2, rays=0).statistics.paths < engine.statistics.paths


def test_misuse():
    engine = es.Engine(room(), order=0, rays=0, format="mono")
    with pytest.raises(es.ArgumentError, match="signals"):
        engine.render(np.zeros((2, 256)))
    with pytest.raises(es.ArgumentError, match="frames"):
        engine.render(np.zeros((1, 100)))
    with pytest.raises(es.UnknownName):
        engine.place_source("nobody", (0, 0, 0))
    with pytest.raises(es.ArgumentError, match="block"):
        es.Engine(room(), block=100)
    engine.start()
    with pytest.raises(es.Error):
        engine.update()
    engine.stop()
    engine.update()
