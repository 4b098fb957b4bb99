# SPDX-License-Identifier: MIT
import types

import numpy as np
import pytest

import earshot as es

CUBE = np.array([[x, y, z] for x in (0, 2) for y in (0, 3) for z in (0, 4)], float)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def test_arrays_come_back():
    of_triangle = np.arange(12) % 2
    scene = es.Scene.from_arrays(CUBE, FACES, material_of_triangle=of_triangle,
                                 materials=["brick-painted", "mystery"], name="cube")
    assert scene.name == "cube"
    np.testing.assert_array_equal(scene.vertices, CUBE)
    np.testing.assert_array_equal(scene.triangles, FACES)
    np.testing.assert_array_equal(scene.material_of_triangle, of_triangle)
    assert list(scene.materials) == ["brick-painted", "mystery"]
    np.testing.assert_array_equal(scene.extent(), [[0, 0, 0], [2, 3, 4]])
    library = es.library()["brick-painted"]
    np.testing.assert_array_equal(scene.coefficients()[0], library.absorption)
    np.testing.assert_array_equal(scene.coefficients("scattering")[1], np.full(10, 0.1))
    assert "12 triangles, 2 x 3 x 4 m, 2 materials" in repr(scene)


def test_up_axis_is_turned():
    scene = es.Scene.from_arrays(CUBE, FACES, up="z")
    np.testing.assert_array_equal(scene.extent(), [[0, 0, -3], [2, 4, 0]])
    # A rotation keeps which side is in front: the volume has the same sign.
    a, b, c = (scene.vertices[scene.triangles[:, k]] for k in range(3))
    p, q, r = (CUBE[FACES[:, k]] for k in range(3))
    assert np.isclose(np.einsum("ij,ij", a, np.cross(b, c)), np.einsum("ij,ij", p, np.cross(q, r)))


def test_mesh_objects_are_taken():
    mesh = types.SimpleNamespace(vertices=CUBE.astype(np.float32), faces=FACES.astype(np.int64))
    assert list(es.Scene.from_mesh(mesh, material="wood-door").materials) == ["wood-door"]
    painted = types.SimpleNamespace(
        vertices=CUBE, faces=FACES,
        visual=types.SimpleNamespace(
            face_materials=[0] * 11 + [1],
            material=types.SimpleNamespace(
                materials=[types.SimpleNamespace(name="a"), types.SimpleNamespace(name="b")])))
    scene = es.Scene.from_mesh(painted)
    assert list(scene.materials) == ["a", "b"] and scene.material_of_triangle[11] == 1


def test_shoebox_and_extruded_plan_are_the_same_room():
    box = es.shoebox((5, 3, 4), absorption=0.2, materials={"floor": "carpet-thin"})
    plan = es.extrude([(0, 0), (5, 0), (5, 4), (0, 4)], 3, absorption=0.2,
                      materials={"floor": "carpet-thin"})
    assert list(box.materials) == ["floor", "ceiling", "north", "east", "south", "west"]
    assert list(plan.materials) == ["floor", "ceiling", "wall 0", "wall 1", "wall 2", "wall 3"]
    delays = []
    for scene in (box, plan):
        np.testing.assert_array_equal(scene.coefficients()[0],
                                      es.library()["carpet-thin"].absorption)
        np.testing.assert_array_equal(scene.coefficients()[1:], np.full((5, 10), 0.2))
        scene.add_source(None, (1, 1, 1))
        scene.add_listener(None, (4, 2, 3))
        delays.append(es.simulate(scene, order=3, rays=0, responses=False, metrics=False)
                      .paths.delay)
    np.testing.assert_allclose(*delays, rtol=1e-12)


def test_materials_are_assigned_by_pattern(room):
    curtain = es.Material({125: 0.1, 1000: 0.5}, scattering=0.3)
    assert room.assign({"*th": curtain, "east": 0.7}, default="plaster-on-masonry"
                       if "plaster-on-masonry" in es.library() else 0.05) == 3
    absorption = room.coefficients()
    octaves = es.band_centres()
    north = absorption[room.materials.index("north")]
    assert north[octaves == 125] == pytest.approx(0.1, abs=0.02)
    assert (np.diff(north) >= 0).all() and north[-1] == pytest.approx(0.5)
    np.testing.assert_array_equal(absorption[room.materials.index("east")], np.full(10, 0.7))
    with pytest.raises(es.UnknownName, match="curtain: matches no material; there are floor"):
        room.assign({"curtain": 0.5})
    with pytest.raises(es.Error, match="brick"):
        room.assign({"*": "brik-painted"})


def test_material_points_on_several_grids_join():
    material = es.Material({100: 0.2, 1000: 0.4}, scattering={400: 0.1})
    scene = es.shoebox((3, 3, 3))
    scene.assign({"*": material})
    np.testing.assert_allclose(scene.coefficients("scattering"), np.full((6, 10), 0.1))
    sequence = es.Material([0.2, 0.4], frequencies=[100, 1000])
    other = es.shoebox((3, 3, 3))
    other.assign({"*": sequence})
    np.testing.assert_allclose(scene.coefficients(), other.coefficients(), atol=1e-12)
    with pytest.raises(es.ArgumentError, match="absorption: has 2 values; give as many"):
        other.assign({"*": es.Material([0.2, 0.4])})


def test_points_have_names_and_places(room):
    assert list(room.listeners) == ["seat", "desk"] and room.listeners.index("desk") == 1
    np.testing.assert_array_equal(room.listener_positions(), [(4, 1.2, 3), (2, 1.2, 3)])
    names = room.add_listeners(np.ones((2, 3)), "row")
    assert list(names) == ["row 1", "row 2"] and len(room.listeners) == 4
    room.move_listener("row 2", (1, 1, 2))
    room.remove_listener("row 1")
    np.testing.assert_array_equal(room.listener_positions()[-1], (1, 1, 2))
    with pytest.raises(es.Error, match="talker"):
        room.add_source("talker", (2, 1, 1))
    with pytest.raises(es.UnknownName, match="nobody: there is no such source; there are talker"):
        room.remove_source("nobody")
    with pytest.raises(es.Error):
        room.add_source("second", (2, 1, 1), directivity="no such pattern")
    assert list(room.sources) == ["talker"]
    other = room.copy()
    other.clear_sources()
    assert len(other.sources) == 0 and len(room.sources) == 1


def test_grid_is_in_the_room_and_clear_of_it():
    scene = es.extrude([(0, 0), (6, 0), (6, 3), (3, 3), (3, 6), (0, 6)], 3)
    points = scene.grid(height=1.2, step=0.5, clearance=0.4)
    x, y, z = points.T
    inside = ((x < 5.6) & (z < 2.6)) | ((x < 2.6) & (z < 5.6))
    assert inside.all() and (x >= 0.4).all() and (z >= 0.4).all() and (y == 1.2).all()
    # Of the lattice of 13 x 13 points those that keep the distance.
    lattice = np.arange(0.0, 6.01, 0.5)
    expected = sum(((0.4 <= a <= 5.6 and 0.4 <= b <= 2.6) or (0.4 <= a <= 2.6 and 0.4 <= b <= 5.6))
                   for a in lattice for b in lattice)
    # Around the inner corner the distance is to the edge.
    near = sum(np.hypot(a - 3, b - 3) < 0.4 for a in lattice for b in lattice if a <= 3 and b <= 3)
    assert len(points) in (expected, expected - near)


def test_files_are_read_in_their_units(tmp_path, scenes):
    text = "".join(f"v {x / 0.0254} {y / 0.0254} {z / 0.0254}\n" for x, y, z in CUBE)
    text += "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    (tmp_path / "cube.obj").write_text(text)
    scene = es.load(tmp_path / "cube.obj", units="in")
    np.testing.assert_allclose(scene.extent(), [[0, 0, 0], [2, 3, 4]], atol=1e-12)
    hall = es.load(scenes / "concert_hall.gltf")
    assert list(hall.sources) == ["soloist", "winds"] and len(hall.listeners) == 4
    assert es.load(str(scenes / "door.gltf")).duration > 0.0


def test_errors_tell_subject_problem_and_remedy(tmp_path):
    with pytest.raises(es.Error) as caught:
        es.load(tmp_path / "no.obj")
    error = caught.value
    assert error.subject.endswith("no.obj") and "no such file" in error.problem and error.remedy
    assert str(error) == f"{error.subject}: {error.problem}; {error.remedy}"
    assert error.status == "ES_ERROR_FAILED"
    for call, kind in [
        (lambda: es.Scene.from_arrays(CUBE[:, :2], FACES), es.ArgumentError),
        (lambda: es.Scene.from_arrays(CUBE, FACES + 1), es.OutOfRange),
        (lambda: es.Scene.from_arrays(CUBE, FACES - 1), es.OutOfRange),
        (lambda: es.Scene.from_arrays(CUBE, FACES.astype(float)), es.ArgumentError),
        (lambda: es.Scene.from_arrays(np.full((8, 3), np.nan), FACES), es.ArgumentError),
        (lambda: es.Scene.from_arrays("abc", FACES), es.ArgumentError),
        (lambda: es.Scene.from_arrays(CUBE, FACES, materials=["a\0b"]), es.ArgumentError),
        (lambda: es.shoebox((1, 2)), es.ArgumentError),
        (lambda: es.shoebox((1, -2, 3)), es.Error),
        (lambda: es.extrude([(0, 0), (1, 1), (1, 0), (0, 1)], 2), es.Error),
        (lambda: es.load("a.obj", units="miles"), es.Error),
        (lambda: es.load("a.obj", up="x"), es.ArgumentError),
    ]:
        with pytest.raises(kind) as caught:
            call()
        assert caught.value.problem
    assert issubclass(es.ArgumentError, ValueError) and issubclass(es.OutOfRange, IndexError)


def test_objects_end_with_their_last_reference(room):
    from earshot._library import lib

    before = lib.es_object_count()
    kept = es.simulate(room, rays=0, order=1, length=0.05).ir
    assert lib.es_object_count() == before + 1  # the result, for its array
    assert np.isfinite(kept).all()
    del kept
    assert lib.es_object_count() == before
