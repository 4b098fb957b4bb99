# SPDX-License-Identifier: MIT
"""What Python's callers do wrong is told in their words, and threads do not disturb each other."""

import copy
import multiprocessing
import os
import pickle
import threading

import numpy as np
import pytest

import earshot as es

TRIANGLE = np.zeros((3, 3))


def world():
    made = es.World()
    made.add("tip", np.eye(3), [[0, 1, 2]])
    return made


@pytest.fixture(scope="module")
def box():
    made = es.shoebox((5.0, 2.7, 4.0), absorption=0.3)
    made.add_source("talker", (1.0, 1.5, 1.0))
    made.add_listener("seat", (4.0, 1.2, 3.0))
    return made


@pytest.fixture(scope="module")
def result(box):
    return es.simulate(box, order=1, rays=0, length=0.05)


@pytest.mark.parametrize("subject, call", [
    ("position", lambda box: box.add_source("x", np.array([1 + 1j, 1, 1]))),
    ("position", lambda box: box.add_source("x", ["1", "2", "3"])),
    ("position", lambda box: box.add_source("x", None)),
    ("positions[0]", lambda box: box.add_source("x", (1, 1, np.nan))),
    ("vertices", lambda box: es.Bvh([[0, 0, 0], [1, 2]], [[0, 1, 2]])),
    ("triangles", lambda box: es.Bvh(TRIANGLE, [[True, False, True]])),
    ("triangles", lambda box: es.Bvh(TRIANGLE, [[0, 1, 2**70]])),
    ("triangles", lambda box: es.Bvh(TRIANGLE, [[0, 1], [1, 2, 3]])),
    ("builder", lambda box: es.Bvh(box, builder=None)),
    ("threads", lambda box: es.Bvh(box, threads=5000)),
    ("time", lambda box: box.extent("1")),
    ("time", lambda box: box.extent(10**400)),
    ("order", lambda box: es.simulate(box, order=-1)),
    ("order", lambda box: es.simulate(box, order=1.0)),
    ("format", lambda box: es.simulate(box, format=None)),
    ("format", lambda box: es.simulate(box, format="mono:")),
    ("format", lambda box: es.simulate(box, format="ambisonic:\N{SUPERSCRIPT TWO}")),
    ("format", lambda box: es.simulate(box, format="ambisonic:99999999999")),
    ("ambisonic_order", lambda box: es.simulate(box, format="ambisonic:6")),
    ("noise", lambda box: es.simulate(box, noise="NC-\N{SUPERSCRIPT TWO}")),
    ("noise", lambda box: es.simulate(box, noise=30)),
    ("rays", lambda box: es.simulate(box, rays=np.arange(3))),
    ("visible_sets", lambda box: es.simulate(box, visible_sets="rooms.pvs")),
    ("scene", lambda box: es.simulate(None)),
    ("scene", lambda box: es.Simulator(es.Bvh(box))),
    ("scene", lambda box: es.VisibleSets.build("room.obj")),
    ("scene", lambda box: world().add_scene(None)),
    ("scene", lambda box: es.Sight.of_scene("room.obj")),
    ("'\\udcff'", lambda box: box.add_source("\udcff", (1, 1, 1))),
    ("'wood'", lambda box: es.Scene.from_arrays(TRIANGLE, [[0, 1, 2]], materials="wood")),
    ("absorption", lambda box: box.assign({"*": None})),
    ("absorption", lambda box: es.shoebox((1, 2, 3), absorption="wood")),
    ("absorption", lambda box: box.assign({"*": np.nan})),
    ("frequencies", lambda box: box.assign({"*": es.Material({0: 0.1, 125: 0.2})})),
    ("frequencies", lambda box: box.assign({"*": es.Material({"low": 0.1})})),
    ("materials", lambda box: box.assign(["brick"])),
    ("height", lambda box: box.grid(height="1", step=1)),
    ("path", lambda box: es.simulate(box, order=0, rays=0, metrics=False).paths["talker"]),
    ("metric", lambda box: es.simulate(box, order=0, rays=0, length=0.1).why(None, 0, 0)),
    ("band", lambda box: es.simulate(box, order=0, rays=0, length=0.1).why("t30", 0, 0, -1)),
    ("results", lambda box: es.write_sofa([box], "x.sofa")),
    ("5", lambda box: es.auralize(5, (np.ones(3), 48000))),
    ("pairs", lambda box: world().contacts(pairs=[0])),
    ("tolerance", lambda box: world().contacts(min_separation=0.1, tolerance=1e-13)),
    ("mesh", lambda box: world().contacts().where(0.5)),
])
def test_wrong_arguments_are_named(box, subject, call):
    with pytest.raises(es.ArgumentError) as told:
        call(box)
    assert told.value.subject == subject and told.value.problem and told.value.remedy


@pytest.mark.parametrize("call", [
    lambda result: result.paths[99999],
    lambda result: es.Bvh(TRIANGLE, [[0, 1, -1]]),
    lambda result: es.Bvh(TRIANGLE, [[0, 1, 3]]),
    lambda result: world().remove(7),
    lambda result: result.why("t30", 0, 0, 10),
    lambda result: es.Scene.from_arrays(TRIANGLE, [[0, 1, 2]], material_of_triangle=[-1]),
])
def test_wrong_indices_are_told(result, call):
    with pytest.raises(es.OutOfRange):
        call(result)


@pytest.mark.parametrize("call", [
    lambda result: result["nobody", 0],
    lambda result: result[0, -2],
    lambda result: world().contacts().where("nobody"),
    lambda result: world().contacts(pairs=[("tip", "nobody")]),
])
def test_wrong_names_are_told(result, call):
    with pytest.raises(es.UnknownName):
        call(result)


def test_remedies_are_those_of_python(box):
    empty = es.shoebox((5, 3, 4))
    with pytest.raises(es.Error, match=r"no source; add_source\(\) gives it one"):
        es.simulate(empty)
    with pytest.raises(es.Error, match="simulate with responses=True"):
        es.simulate(box, order=0, rays=0, responses=False, metrics=False).ir
    with pytest.raises(es.Error, match="is 1e-13, not in 1e-12 ... 1"):
        world().contacts(min_separation=0.1, tolerance=1e-13)


def test_names_are_any_text(tmp_path):
    name = "Höhle \N{BAT} 你"
    (tmp_path / f"{name}.obj").write_text(
        f"v 0 0 0\nv 4 0 0\nv 0 0 4\nusemtl {name}\nf 1 2 3\n", encoding="utf-8")
    scene = es.load(tmp_path / f"{name}.obj")
    assert scene.name == f"{name}.obj" and scene.materials == [name]
    assert scene.assign({name: 0.5}) == 1
    scene.add_source(name, (1, 1, 1))
    scene.add_listener("l", (2, 1, 1))
    es.simulate(scene, order=0, rays=0, metrics=False, length=0.1).write(tmp_path / name)
    assert (tmp_path / name / f"{name}__l.wav").exists()
    # A name that is not UTF-8 is read, and shown as Python shows file names.
    (tmp_path / "latin.obj").write_bytes(
        b"v 0 0 0\nv 4 0 0\nv 0 0 4\nusemtl caf\xe9\nf 1 2 3\n")
    latin = es.load(tmp_path / "latin.obj")
    assert latin.materials == ["caf\udce9"] and latin.assign({"caf?": 0.5}) == 1


def test_objects_do_not_leave_their_process(box, result):
    for thing in (box, result, es.Sight(box), world(), es.Sound([1.0], 48000)):
        with pytest.raises(TypeError, match="cannot be pickled"):
            pickle.dumps(thing)
    with pytest.raises(TypeError):
        copy.deepcopy(result)
    for other in (copy.copy(box), copy.deepcopy(box)):
        other.clear_sources()
        assert len(other.sources) == 0 and len(box.sources) == 1


def simulate_in_child(expected):
    room = es.shoebox((5.0, 2.7, 4.0), absorption=0.3)
    room.add_source("talker", (1.0, 1.5, 1.0))
    room.add_listener("seat", (4.0, 1.2, 3.0))
    assert es.simulate(room, order=1, rays=2000, length=0.05, threads=2).ir.tobytes() == expected


def test_work_goes_on_after_a_fork(box):
    expected = es.simulate(box, order=1, rays=2000, length=0.05, threads=2).ir.tobytes()
    child = multiprocessing.get_context("fork").Process(target=simulate_in_child, args=(expected,))
    child.start()
    child.join(60)
    assert child.exitcode == 0


def test_threads_share_a_scene(box):
    """Readers copy what they read while others change it; a change that meets a simulation says
    that the scene is busy."""
    scene = box.copy()
    scene.add_source("a source whose name is too long to be stored inside of its string", (2, 1, 1))
    vertices, failures, rounds = scene.vertices, [], 60

    def repeat(work):
        for _ in range(rounds):
            try:
                work()
            except es.Error as error:
                if error.status != "ES_ERROR_BUSY":
                    failures.append(error)
            except BaseException as error:
                failures.append(error)

    def read():
        assert scene.triangles.max() == 7 and all(map(len, scene.sources))

    threads = [threading.Thread(target=repeat, args=(work,)) for work in (
        lambda: setattr(scene, "vertices", vertices * np.random.uniform(0.5, 2.0)),
        lambda: (scene.add_source(None, (1, 1, 1)), scene.remove_source(0)),
        read,
        lambda: es.simulate(scene, order=0, rays=0, length=0.01, threads=1, metrics=False),
    )]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def test_simulator_runs_once_at_a_time(box):
    simulator, told = None, []

    def meanwhile(*_):
        if not told:
            with pytest.raises(es.Error, match="running already") as error:
                simulator.run()
            told.append(error.value.status)

    simulator = es.Simulator(box, order=1, rays=0, length=0.05, progress=meanwhile)
    simulator.run()
    simulator.run()
    assert told == ["ES_ERROR_BUSY"]


def test_arrays_may_change_while_they_are_read():
    """Indices are checked in the library's own copy: a thread that spoils them meanwhile makes an
    error or a scene, never an access outside of the arrays."""
    vertices = np.random.default_rng(1).uniform(size=(3000, 3))
    triangles = np.arange(3000, dtype=np.uint32).reshape(-1, 3)
    stop = threading.Event()

    def spoil():
        while not stop.is_set():
            triangles[500] = 0xFFFFFFF0
            triangles[500] = (1500, 1501, 1502)

    thread = threading.Thread(target=spoil)
    thread.start()
    try:
        for _ in range(200):
            try:
                es.Bvh(vertices, triangles, threads=1)
            except es.OutOfRange:
                pass
    finally:
        stop.set()
        thread.join()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs /proc")
def test_failures_do_not_leak(box):
    def pages():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1])

    def fail():
        for _ in range(300):
            with pytest.raises(es.Error):
                es.simulate(box, order=99)
            with pytest.raises(es.Error):
                es.Bvh(np.full((1000, 3), np.nan), np.arange(999).reshape(-1, 3))

    fail()
    before = pages()
    fail()
    assert pages() - before < 2000  # 8 MB; the arrays of all calls together have 7 MB each way
