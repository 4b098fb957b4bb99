# SPDX-License-Identifier: MIT
import itertools
import json

import numpy as np
import pytest

import earshot as es


def test_image_sources_of_a_box(room):
    """Delays and amplitudes of the order 2 images, by Allen and Berkley's lattice."""
    result = es.simulate(room, order=2, rays=0, air_absorption=False, responses=False,
                         metrics=False)
    room.assign({"*": es.Material(0.3, scattering=0.0)})
    mirror = es.simulate(room, order=2, rays=0, air_absorption=False, responses=False,
                         metrics=False)
    size, source, seat = np.array([5, 2.7, 4]), np.array([1, 1.5, 1]), np.array([4, 1.2, 3])
    expected = []
    for cell in itertools.product(range(-2, 3), repeat=3):
        for flip in itertools.product((0, 1), repeat=3):
            n, q = np.array(cell), np.array(flip)
            order = np.abs(2 * n - q).sum()
            if order <= 2:
                distance = np.linalg.norm((1 - 2 * q) * source + 2 * n * size - seat)
                expected.append((distance, 0.7 ** (order / 2) / distance))
    expected = np.array(sorted(expected))
    for found, factor in ((mirror, 1.0), (result, 0.9)):
        paths = found.paths["talker", "seat"]
        np.testing.assert_allclose(paths.length, expected[:, 0], rtol=1e-12)
        np.testing.assert_allclose(paths.delay, paths.length / found.speed_of_sound, rtol=1e-12)
        np.testing.assert_allclose(paths.pressure[:, 4],
                                   expected[:, 1] * factor ** (paths.order / 2), rtol=1e-9)


def test_files_are_the_programs(tmp_path, scenes, program):
    for name, more, options in [
        ("classroom.gltf", ["--order", 2, "--rays", 2000, "--length", 0.4, "--histograms"],
         {"order": 2, "rays": 2000, "length": 0.4, "histograms": True}),
        ("concert_hall.gltf",
         ["--order", 1, "--rays", 500, "--length", 0.2, "--format", "ambisonic:1", "--seed", 7,
          "--noise", "NC-30", "--speech-level", "raised", "--sample-rate", 16000],
         {"order": 1, "rays": 500, "length": 0.2, "format": "ambisonic:1", "seed": 7,
          "noise": "NC-30", "speech": "raised", "sample_rate": 16000}),
        ("lroom.gltf", ["--order", 1, "--diffraction", 2, "--min-diffraction-level", -30, "--rays", 0,
                          "--length", 0.2],
         {"order": 1, "diffraction": 2, "min_diffraction_level_db": -30, "rays": 0,
          "length": 0.2}),
    ]:
        ours, theirs = tmp_path / "ours" / name, tmp_path / "theirs" / name
        program("ir", scenes / name, "-o", theirs, *more)
        result = es.simulate(es.load(scenes / name), **options)
        result.write(ours)
        if options.get("histograms"):
            result.write_json(ours / "histograms.json", "histograms")
        names = sorted(path.name for path in theirs.iterdir())
        assert sorted(path.name for path in ours.iterdir()) == names
        for file in names:
            assert (ours / file).read_bytes() == (theirs / file).read_bytes(), file


def test_diffracted_paths_have_edges(tmp_path, scenes):
    scene = es.load(scenes / "lroom.gltf")
    result = es.simulate(scene, order=1, diffraction=1, rays=0, responses=False, metrics=False)
    result.write_json(tmp_path / "paths.json", "paths")
    told = json.loads((tmp_path / "paths.json").read_text())["pairs"]
    kinds = set()
    for pair in told:
        paths = result.paths[pair["source"], pair["listener"]]
        for path, expected in zip(paths, pair["paths"], strict=True):
            kinds.add(path.kind)
            assert path.kind == expected["kind"]
            assert path.edges.tolist() == expected.get("edges", [])
            assert path.edges.shape == (1 if path.kind == "diffracted" else 0, 2, 3)
    assert kinds == {"direct", "specular", "diffracted"}
    with pytest.raises(es.ArgumentError, match="diffraction"):
        es.simulate(scene, diffraction=3)


def test_sensitivity_tells_which_surfaces_matter(tmp_path, scenes, program):
    program("ir", scenes / "shoebox.gltf", "-o", tmp_path / "program", "--order", 2, "--rays",
            4000, "--quiet", "--sensitivity")
    scene = es.load(scenes / "shoebox.gltf")
    result = es.simulate(scene, order=2, rays=4000, sensitivity=True, responses=False)
    result.write_json(tmp_path / "sensitivity.json", "sensitivity")
    text = (tmp_path / "sensitivity.json").read_bytes()
    assert text == (tmp_path / "program" / "sensitivity.json").read_bytes()
    record = json.loads(text)
    pair, found = record["pairs"][0], result.sensitivity
    shape = (len(result.sources), len(result.listeners), len(result.materials), 10)
    assert list(found.materials) == [material["name"] for material in record["materials"]]
    np.testing.assert_array_equal(found.areas, [material["area"] for material in record["materials"]])
    for name in ("touched_before", "touched_after", "absorbed_before", "reflections_after"):
        assert getattr(found, name).shape == shape
        assert (getattr(found, name) >= 0.0).all()
    np.testing.assert_array_equal(found.touched_before[0, 0, 0], pair["energy"][0]["before_80ms"])
    for name, values in found.derivatives.items():
        assert values.shape == found.standard_errors[name].shape == shape
        told = np.array(pair["derivatives"][name], dtype=float)
        np.testing.assert_array_equal(values[0, 0], told)
    for name, values in found.single.items():
        assert values.shape == found.single_standard_errors[name].shape == shape[:3]
        told = np.array(pair["derivatives"]["single"][name], dtype=float)
        np.testing.assert_array_equal(values[0, 0], told)
    assert (found.single["t30_mid"] < 0.0).all()  # what absorbs more decays faster


def test_sensitivity_is_on_request(room):
    with pytest.raises(es.Error, match="sensitivity=True"):
        es.simulate(room, order=1, rays=0, responses=False).sensitivity
    with pytest.raises(es.ArgumentError):
        es.simulate(room, order=1, rays=0, paths=False, sensitivity=True)


def test_sofa_files_are_the_programs(tmp_path, scenes, program):
    program("ir", scenes / "door.gltf", "-o", tmp_path / "program", "--quiet", "--order", 1,
            "--rays", 0, "--frames", "0:2:1", "--length", 0.1, "--sofa")
    simulator = es.Simulator(es.load(scenes / "door.gltf"), order=1, rays=0, length=0.1, sofa=True)
    results = [simulator.run(time) for time in (0.0, 1.0, 2.0)]
    es.write_sofa(results, tmp_path / "all.sofa")
    assert (tmp_path / "all.sofa").read_bytes() == (
        tmp_path / "program/responses.sofa").read_bytes()
    results[0].write_sofa(tmp_path / "first.sofa")
    program("ir", scenes / "door.gltf", "-o", tmp_path / "first", "--quiet", "--order", 1,
            "--rays", 0, "--length", 0.1, "--sofa")
    assert (tmp_path / "first.sofa").read_bytes() == (
        tmp_path / "first/responses.sofa").read_bytes()
    with pytest.raises(es.Error, match="64 bits"):
        es.simulate(es.load(scenes / "door.gltf"), order=0, rays=0).write_sofa(tmp_path / "x.sofa")
    with pytest.raises(es.ArgumentError, match="count"):
        es.write_sofa([], tmp_path / "x.sofa")


def test_reports_show_what_the_programs_do(tmp_path, scenes, program):
    program("ir", scenes / "shoebox.gltf", "-o", tmp_path / "out", "--quiet", "--order", 2,
            "--rays", 4000, "--histograms")
    program("report", tmp_path / "out", scenes / "shoebox.gltf", "-o", tmp_path / "theirs.json",
            "--limit", "sti=0.5", "--against", tmp_path / "out", "--quiet")
    scene = es.load(scenes / "shoebox.gltf")
    result = es.simulate(scene, order=2, rays=4000, histograms=True)
    result.report(tmp_path / "ours.json", scene, title="shoebox", limits={"sti": 0.5},
                  against=tmp_path / "out/metrics.json", command="result.report()")
    ours, theirs = (json.loads((tmp_path / name).read_text())
                    for name in ("ours.json", "theirs.json"))
    assert ours["provenance"]["command"] == "result.report()"
    assert ours["provenance"]["scene_digest"] == theirs["provenance"]["scene_digest"]
    for data in (ours, theirs):
        for pair in data["pairs"]:
            del pair["reference"]["name"]
    for key in ("title", "verdict", "room", "scene", "materials", "pairs", "listeners"):
        assert ours[key] == theirs[key], key
    with pytest.raises(es.Error, match="loudness"):
        result.report(tmp_path / "x.json", limits={"loudness": 1})
    with pytest.raises(es.ArgumentError, match="scene"):
        result.report(tmp_path / "x.json", "shoebox")


def test_arrays_say_what_the_files_say(tmp_path, scenes):
    result = es.simulate(es.load(scenes / "classroom.gltf"), order=2, rays=20000)
    assert np.isfinite(result.sti).all() and np.isfinite(result.c50).all()
    result.write(tmp_path)
    told = json.loads((tmp_path / "paths.json").read_text())["pairs"]
    for pair in told:
        paths = result.paths[pair["source"], pair["listener"]]
        assert len(paths) == len(pair["paths"])
        for path, expected in zip(paths, pair["paths"]):
            assert (path.kind, path.order) == (expected["kind"], expected["order"])
            assert path.delay == expected["delay"] and path.length == expected["length"]
            assert path.points.tolist() == expected["points"]
            assert path.triangles.tolist() == expected["triangles"]
            assert list(path.materials) == expected["materials"]
            assert path.pressure.tolist() == expected["pressure"]
            assert path.departure.tolist() == expected["departure"]
            assert path.arrival.tolist() == expected["arrival"]
    told = json.loads((tmp_path / "metrics.json").read_text())

    def numbers(values):
        return np.array([np.nan if value is None else value for value in values])

    np.testing.assert_array_equal(result.bands, told["bands_hz"])
    assert result.room.volume == told["room"]["volume"]
    np.testing.assert_array_equal(result.room.eyring, told["room"]["eyring"])
    for pair in told["pairs"]:
        metrics = result[pair["source"], pair["listener"]].metrics
        for name in ("edt", "t20", "t30", "c50", "c80", "d50", "ts", "g"):
            np.testing.assert_array_equal(metrics[name], numbers(pair[name]))
        np.testing.assert_array_equal(metrics["sti"], numbers([pair["sti"]])[0])
        for name, value in pair["single"].items():
            if name in metrics:
                np.testing.assert_array_equal(metrics[name], numbers([value])[0])
        errors = result.standard_errors
        at = (result.sources.index(pair["source"]), result.listeners.index(pair["listener"]))
        np.testing.assert_array_equal(errors["t30"][at], numbers(pair["standard_error"]["t30"]))
        response = result.response_metrics
        np.testing.assert_array_equal(response["edt"][at], numbers(pair["response"]["edt"]))
    notes = [(pair["source"], pair["listener"], note) for pair in told["pairs"]
             for note in pair["notes"] if "band_hz" in note and note["metric"] == "t30"]
    for source, listener, note in notes[:3]:
        band = list(result.bands).index(note["band_hz"])
        assert note["text"] in result.why("t30", source, listener, band)


def test_many_listeners_make_one_block_without_a_copy(room):
    room.clear_listeners()
    count = 27
    room.add_listeners(room.grid(height=1.2, step=0.6)[:count])
    result = es.simulate(room, order=1, rays=0, length=0.1, sample_rate=16000,
                         format="ambisonic:1")
    ir = result.ir
    assert ir.shape == (1, count, 4, 1600) and ir.dtype == np.float32
    assert ir.flags.c_contiguous and not ir.flags.owndata and not ir.flags.writeable
    assert np.shares_memory(ir, result.ir) and np.shares_memory(ir, result["talker", 3].ir)
    assert result.sti.shape == (1, count) and result.metrics["t30"].shape == (1, count, 10)
    assert repr(result).startswith(f"<Result: 1 sources x {count} listeners, 4 x 1600 samples")


def test_pairs_are_found_by_name_and_index(room):
    result = es.simulate(room, order=1, rays=0, length=0.1)
    response = result["talker", "desk"]
    assert (response.source, response.listener) == ("talker", "desk")
    np.testing.assert_array_equal(response.ir[0], result.ir[0, 1, 0])
    assert [(r.source, r.listener) for r in result] == [("talker", "seat"), ("talker", "desk")]
    assert len(result.paths["talker", "seat"]) + len(result.paths[0, -1]) == len(result.paths)
    assert result.paths[2:4][0].points.tolist() == result.paths[2].points.tolist()
    result = es.simulate(room, order=2, rays=2000)
    assert result["talker", "desk"].sti == result.sti[0, 1] == result.metrics["sti"][0, 1] > 0.5
    with pytest.raises(es.UnknownName, match="there are seat, desk"):
        result["talker", "dask"]
    with pytest.raises(IndexError):
        result.paths[len(result.paths)]
    table = result.table(["t30_mid", "sti"]).splitlines()
    assert table[0].split() == ["t30_mid", "sti"] and table[1].startswith("talker to seat ")
    with pytest.raises(es.ArgumentError, match="'t31'"):
        result.table(["t31"])


def test_results_do_not_depend_on_threads(room):
    options = {"order": 3, "rays": 3000, "length": 0.3}
    one, two = (es.simulate(room, threads=threads, **options) for threads in (1, 2))
    assert one.ir.tobytes() == two.ir.tobytes()
    assert one.paths.table.tobytes() == two.paths.table.tobytes()


def test_simulator_follows_what_moves(room, scenes):
    options = {"order": 2, "rays": 200, "length": 0.2}
    simulator = es.Simulator(room, keep_traces=True, **options)
    for z in (1.0, 1.5):
        simulator.move_source("talker", (1.0, 1.5, z))
        room.move_source("talker", (1.0, 1.5, z))
        assert simulator.run().ir.tobytes() == es.simulate(room, **options).ir.tobytes()
    door = es.load(scenes / "door.gltf")
    simulator = es.Simulator(door, **options)
    for time in (0.0, 0.5):
        expected = es.simulate(door, time=time, **options)
        found = simulator.run(time)
        assert found.ir.tobytes() == expected.ir.tobytes() and found.time == time


def test_options_are_checked(room):
    for options, told in [
        ({"format": "stereo"}, "format"), ({"format": "ambisonic"}, "format"),
        ({"format": "ambisonic:9"}, "ambisonic"), ({"rays": "many"}, "rays"), ({"rays": -1}, "rays"),
        ({"rays": 1.5}, "rays"), ({"order": 99}, "order"), ({"bands": "third "}, "bands"),
        ({"noise": "NR-30"}, "noise"), ({"noise": [1, 2]}, "noise"), ({"speech": "soft"}, "speech"),
        ({"sample_rate": 0}, "sample_rate"), ({"seed": -1}, "seed"),
        ({"temperature": float("nan")}, "temperature"), ({"mode": "all"}, "mode"),
        ({"progress": 3}, "progress"),
    ]:
        with pytest.raises(es.ArgumentError) as caught:
            es.simulate(room, **options)
        assert told in str(caught.value), options
    with pytest.raises(TypeError, match="ordre"):
        es.simulate(room, ordre=3)
    with pytest.raises(es.Error, match="no source"):
        room.clear_sources()
        es.simulate(room)


def test_histograms_are_kept_where_asked_for(room):
    result = es.simulate(room, order=1, rays=1000, histograms=True, length=0.3)
    histogram = result.histogram("talker", "seat")
    assert histogram.energy.shape == histogram.error.shape and histogram.energy.shape[1] == 10
    assert histogram.rays == 1000 and (histogram.energy >= 0).all()
    with pytest.raises(es.Error, match="histograms=True"):
        es.simulate(room, order=1, rays=1000, length=0.1).histogram(0, 0)
    without = es.simulate(room, order=1, rays=0, metrics=False)
    assert without.metrics == {} and without.room is None
    with pytest.raises(es.Error, match="metrics=True"):
        without.sti


def test_third_octaves(room):
    result = es.simulate(room, order=1, rays=0, length=0.1, bands="third")
    assert len(result.bands) == 31 and result.metrics["edt"].shape == (1, 2, 31)
    np.testing.assert_array_equal(result.bands, es.band_centres("third"))


def test_frame_has_a_row_per_pair(room):
    pandas = pytest.importorskip("pandas")
    frame = es.simulate(room, order=1, rays=500).frame(["t30_mid", "sti"])
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == ["t30_mid", "sti"]
    assert list(frame.index) == [("talker", "seat"), ("talker", "desk")]


def test_responses_without_paths(room, tmp_path):
    options = {"order": 4, "rays": 200, "length": 0.2}
    told, untold = es.simulate(room, **options), es.simulate(room, paths=False, **options)
    assert np.array_equal(told.ir, untold.ir)
    assert np.array_equal(told.metrics["t30"], untold.metrics["t30"], equal_nan=True)
    assert "0 paths" in repr(untold) and "0 paths" in repr(untold[0, 0])
    with pytest.raises(es.Error, match="paths=True"):
        untold.paths
    untold.write(tmp_path)
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "metrics.json", "talker__desk.wav", "talker__seat.wav"]
