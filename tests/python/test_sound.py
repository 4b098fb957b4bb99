# SPDX-License-Identifier: MIT
import json

import numpy as np
import pytest

import earshot as es


def test_auralization_is_convolution(room):
    response = es.simulate(room, order=2, rays=0, length=0.1)["talker", "seat"]
    dry = np.random.default_rng(1).uniform(-0.5, 0.5, 5000)
    wet = es.auralize((dry, 48000), response)
    assert wet.sample_rate == 48000 and wet.samples.shape[1] == 1
    expected = np.convolve(dry, response.ir[0].astype(float))
    np.testing.assert_allclose(wet.samples[: len(expected), 0], expected, atol=1e-9)


def test_files_are_the_programs(tmp_path, room, program):
    result = es.simulate(room, order=2, rays=500, length=0.2, sample_rate=16000)
    result.write(tmp_path)
    dry = es.Sound(np.random.default_rng(2).uniform(-0.5, 0.5, (3000, 1)), 44100)
    dry.write(tmp_path / "dry.wav")
    program("auralize", tmp_path / "dry.wav", tmp_path / "talker__seat.wav",
            tmp_path / "talker__desk.wav", "-o", tmp_path / "theirs.wav")
    wet = es.auralize(tmp_path / "dry.wav",
                      [tmp_path / "talker__seat.wav", tmp_path / "talker__desk.wav"])
    wet.write(tmp_path / "ours.wav")
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "theirs.wav").read_bytes()


def test_a_source_that_moves_is_heard_at_another_frequency(room):
    rate = 8000
    tone = np.sin(2 * np.pi * 1000 * np.arange(3000) / rate)
    where = np.array([[0.0, 1.0, 1.5, 1.0], [0.2, 3.0, 1.5, 1.0]])
    options = {"order": 0, "rays": 0, "air_absorption": False}
    wet = es.auralize_moving((tone, rate), room, source="talker", listener="seat",
                             source_path=where, **options)
    still = es.auralize_moving((tone, rate), room, source="talker", listener="seat", **options)
    assert wet.sample_rate == rate and not np.array_equal(wet.samples[:3000], still.samples[:3000])
    # Away from the wall at 10 m/s towards the seat: the phase runs ahead of that of the start.
    spectrum = np.abs(np.fft.rfft(wet.samples[400:1600, 0] * np.hanning(1200), 65536))
    assert np.argmax(spectrum) * rate / 65536 > 1010
    with pytest.raises(es.ArgumentError, match="source_path: has shape"):
        es.auralize_moving((tone, rate), room, source=0, listener=0, source_path=where[:, :3])
    with pytest.raises(es.ArgumentError):
        es.auralize_moving((tone, rate), room, source=0, listener=0, step=0.0)


FORMS = ["mono", "binaural", "ambisonic:1"]


@pytest.mark.parametrize("form", FORMS)
def test_paths_of_results_sound_as_their_scene(form):
    room = es.shoebox((12.0, 5.0, 9.0), absorption=0.3)
    room.add_source("car", (2.0, 1.5, 3.0))
    room.add_listener("seat", (8.0, 1.2, 6.0), look_at=(9.0, 1.0, 2.0))
    dry = (np.random.default_rng(4).uniform(-0.5, 0.5, 8000), 16000)
    options = {"order": 1, "rays": 0}
    simulator = es.Simulator(room, responses=False, metrics=False, **options)
    results = []
    for time in np.arange(7) / 10:
        simulator.move_source("car", (2.0 + 8.0 * time, 1.5, 3.0))
        results.append(simulator.run(time))
    wet = es.auralize_paths(dry, results, source="car", format=form)
    ends = np.array([[0.0, 2.0, 1.5, 3.0], [0.6, 6.8, 1.5, 3.0]])
    moving = es.auralize_moving(dry, room, source_path=ends, format=form, **options)
    assert wet.sample_rate == 16000 and wet.samples.shape[1] == moving.samples.shape[1]
    count = min(len(wet.samples), len(moving.samples))
    off = wet.samples[:count] - moving.samples[:count]
    assert np.sum(off**2) < 1e-6 * np.sum(moving.samples**2)
    with pytest.raises(es.Error, match="is not later"):
        es.auralize_paths(dry, results[::-1])
    with pytest.raises(es.ArgumentError, match="paths"):
        es.auralize_paths(dry, [results[0], "paths.json"])
    with pytest.raises(es.ArgumentError, match="paths: are no results"):
        es.auralize_paths(dry, [])
    with pytest.raises(es.ArgumentError, match="count"):
        es.auralize_paths(dry, results[:1])


@pytest.mark.parametrize("form", FORMS)
def test_paths_of_a_file_sound_as_the_programs(tmp_path, scenes, program, form):
    program("ir", scenes / "door.gltf", "-o", tmp_path, "--frames", "0:1:0.25", "--order", "1",
            "--rays", "0")
    paths = tmp_path / "paths.json"
    pair = next(p for p in json.loads(paths.read_text())["pairs"] if p["paths"])
    dry = tmp_path / "dry.wav"
    es.Sound(np.random.default_rng(5).uniform(-0.5, 0.5, 4000), 8000).write(dry)
    program("auralize", dry, "--paths", paths, "--from", pair["source"], "--to", pair["listener"],
            "--format", form, "-o", tmp_path / "theirs.wav")
    wet = es.auralize_paths(dry, paths, source=pair["source"], listener=pair["listener"],
                            format=form)
    wet.write(tmp_path / "ours.wav")
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "theirs.wav").read_bytes()
    with pytest.raises(es.Error, match="has no such source"):
        es.auralize_paths(dry, paths, source="nobody")
    with pytest.raises(es.ArgumentError, match="give the name of a source"):
        es.auralize_paths(dry, paths, source=0)


def test_sounds_are_written_and_read(tmp_path):
    samples = np.random.default_rng(3).uniform(-1, 1, (800, 2)).astype(np.float32)
    sound = es.Sound(samples, 8000)
    assert "2 channels, 0.100 s at 8000 Hz" in repr(sound) and sound.duration == 0.1
    assert sound.write(tmp_path / "a.wav") == 0
    np.testing.assert_array_equal(es.Sound.read(tmp_path / "a.wav").samples, samples)
    assert es.Sound(samples * 2, 8000).write(tmp_path / "a.flac") > 0
    both = es.mix([sound, sound], [0.0, -np.inf] if False else [0.0, -20.0])
    np.testing.assert_allclose(both.samples, samples * 1.1, atol=1e-12)
    with pytest.raises(es.ArgumentError, match="gains_db: has 1 entries; give 2"):
        es.mix([sound, sound], [1.0])
    for wrong in (np.zeros((2, 2, 2)), "abc", np.full(3, np.nan)):
        with pytest.raises(es.ArgumentError):
            es.Sound(wrong, 8000)
    with pytest.raises(es.Error):
        es.Sound.read(tmp_path / "none.wav")
