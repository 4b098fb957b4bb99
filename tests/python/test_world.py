# SPDX-License-Identifier: MIT
import json

import numpy as np
import pytest

import earshot as es

BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


@pytest.fixture
def world():
    made = es.World()
    made.add("table", BOX * [4, 1, 4], FACES)
    made.add("box", BOX + [1.5, 3, 1.3], FACES)
    return made


def test_falling_box_meets_the_table(world):
    begin = BOX + [1.5, 3, 1.3]
    world.step("box", begin, begin - [0, 4, 0])
    first = world.first_contact()
    assert 0.5 - 1e-9 < first.toi <= 0.5 and first.point[1] == pytest.approx(1.0)
    assert {first.a.name, first.b.name} == {"table", "box"}
    contacts = world.contacts()
    assert len(contacts) >= 4 and contacts[0].toi == first.toi
    assert (np.diff(contacts.table["toi"]) >= 0).all()
    assert [c.kind for c in contacts][0] == "vertex_face"
    assert len(contacts.where("box")) == len(contacts) and "the first at 0.5" in repr(contacts)
    assert not contacts.table.flags.writeable
    world.step("box", begin, begin - [0, 1.9, 0])
    assert world.first_contact() is None and len(world.contacts()) == 0
    assert world.first_contact(min_separation=0.2, tolerance=1e-3).toi < 1.0


def test_screw_and_pairs(world):
    begin = BOX + [1.5, 1.001, 1.3]
    world.step_screw("box", begin, point=(2, 2, 1.8), axis=(0, 1, 0), angle=np.pi / 2, slide=0.0)
    assert world.first_contact() is None
    world.step_screw("box", begin, point=(2, 2, 1.8), axis=(1, 0, 0), angle=np.pi / 8)
    assert 0 < world.first_contact().toi < 1
    assert len(world.contacts(pairs=[])) == 0
    assert len(world.contacts(pairs=[("table", "box")])) == len(world.contacts())


def test_distances_and_depths(world):
    distance = world.distance("table", "box")
    assert distance.distance == 2.0 and distance.on_a[1] == 1.0 and distance.on_b[1] == 3.0
    world.step("box", BOX + [1.5, 0.75, 1.3])
    assert world.distance("table", "box").distance == 0.0
    depth = world.depth("table", "box")
    assert depth.depth == pytest.approx(0.25) and np.allclose(np.abs(depth.move), [0, 0.25, 0])
    crossing = world.intersections()
    assert len(crossing) > 0 and crossing[0].kind == "triangle_triangle"
    world.step("box", BOX + [1.5, 2, 1.3])
    assert world.depth("table", "box") is None


def test_contacts_are_the_programs(tmp_path, scenes, program):
    program("collide", scenes / "door.gltf", "--frames", "0:1:0.5", "--min-separation", 0.02, "--tolerance", 1e-3,
            "-o", tmp_path / "c.json")
    told = json.loads((tmp_path / "c.json").read_text())
    world = es.World()
    meshes = world.add_scene(es.load(scenes / "door.gltf"))
    assert len(meshes) == len(told["meshes"])
    total = 0
    for step in told["steps"]:
        world.set_time_step(step["t0"], step["t1"])
        found = world.contacts(moving_only=True, min_separation=0.02, tolerance=1e-3)
        expected = [c for c in step["contacts"] if c["a"]["mesh"] != c["b"]["mesh"]]
        assert len(found) == len(expected)
        for ours, theirs in zip(found, expected):
            assert ours.kind == theirs["kind"] and ours.toi == theirs["toi"]
            assert list(ours.a.vertices) == theirs["a"]["element"]
            assert list(ours.b.vertices) == theirs["b"]["element"]
            assert ours.point.tolist() == theirs["point"]
            assert ours.normal.tolist() == theirs["normal"]
        total += len(found)
    assert total > 0


def test_wrong_meshes_are_told(world):
    assert [mesh.name for mesh in world.meshes] == ["table", "box"]
    for call in (lambda: world.distance("table", "chair"), lambda: world.step("chair", BOX)):
        with pytest.raises(es.UnknownName, match="chair: there is no such mesh; there are table"):
            call()
    with pytest.raises(es.Error):
        world.distance(0, 7)
    with pytest.raises(es.Error):
        world.step("box", BOX[:5])
    world.remove("box")
    with pytest.raises(es.Error):
        world.distance("table", "box")
