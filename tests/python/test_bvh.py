# SPDX-License-Identifier: MIT
import json
import types

import numpy as np
import pytest

import earshot as es
from conftest import crossings


def test_sight_is_brute_force(soup):
    vertices, triangles = soup
    random = np.random.default_rng(1)
    eyes, targets = random.uniform(-0.2, 1.2, (30, 3)), random.uniform(-0.2, 1.2, (40, 3))
    sight = es.Sight(vertices, triangles)
    start, end = np.repeat(eyes, 40, axis=0), np.tile(targets, (30, 1))
    crossed = crossings(start, end, vertices[triangles])
    visible = sight.visible(start, end)
    assert visible.dtype == bool and 0.1 < visible.mean() < 0.9
    np.testing.assert_array_equal(visible, ~crossed.any(axis=1))
    np.testing.assert_array_equal(sight.matrix(eyes, targets), visible.reshape(30, 40))
    np.testing.assert_array_equal(sight.occluded(start, end), ~visible)
    blockers = sight.first_blockers(start, end)
    np.testing.assert_array_equal(blockers.triangle == es.NONE, visible)
    assert crossed[~visible, blockers.triangle[~visible]].all()
    sight.exclude(range(len(triangles)))
    assert sight.visible(start, end).all()
    assert sight.visible(eyes[0], targets[0]) is True
    assert sight.visible(eyes[0], targets).shape == (40,)


def test_shares_agree_with_rays(soup):
    sight = es.Sight(*soup)
    random = np.random.default_rng(5)
    eye, target, radius = np.array([-0.5, 0.4, 0.5]), np.array([1.4, 0.5, 0.5]), 0.3
    shares, errors = sight.shares([eye], [target, eye], radius)
    assert shares.shape == errors.shape == (1, 2) and shares[0, 1] == 1.0 and errors[0, 1] == 0.0
    # Points of the half that faces the eye, by solid angle: uniform in the cosine to the axis.
    axis, distance = (target - eye) / np.linalg.norm(target - eye), np.linalg.norm(target - eye)
    cosine = random.uniform(np.sqrt(1 - (radius / distance) ** 2), 1, 4000)
    across = random.normal(size=(4000, 3))
    across -= (across @ axis)[:, None] * axis
    across /= np.linalg.norm(across, axis=1)[:, None]
    ways = cosine[:, None] * axis + np.sqrt(1 - cosine**2)[:, None] * across
    near = distance * cosine - np.sqrt(radius**2 - distance**2 * (1 - cosine**2))
    expected = sight.visible(eye, eye + near[:, None] * ways).mean()
    assert 0 < expected < 1 and abs(shares[0, 0] - expected) < errors[0, 0] + 0.04
    with pytest.raises(es.ArgumentError):
        sight.shares([eye], [target], -1.0)


def test_closest_hits_are_first_blockers(soup):
    vertices, triangles = soup
    random = np.random.default_rng(2)
    start, end = random.uniform(-0.2, 1.2, (2, 500, 3))
    bvh = es.Bvh(vertices, triangles, builder="quality", threads=1)
    hits = bvh.closest_hits(start, end - start, 1.0)
    crossed = crossings(start, end, vertices[triangles])
    np.testing.assert_array_equal(np.isfinite(hits.t), crossed.any(axis=1))
    hit = np.isfinite(hits.t)
    a, b, c = (vertices[triangles[hits.triangle[hit], k]] for k in range(3))
    u, v = hits.uv[hit, :1], hits.uv[hit, 1:]
    np.testing.assert_allclose(a + u * (b - a) + v * (c - a),
                               start[hit] + hits.t[hit, None] * (end - start)[hit], atol=1e-12)
    assert (hits.triangle[~hit] == es.NONE).all()


def test_closest_points_are_not_beaten_by_samples(soup):
    vertices, triangles = soup
    random = np.random.default_rng(3)
    where = random.uniform(-0.5, 1.5, (50, 3))
    found = es.Bvh(vertices, triangles).closest_points(where)
    np.testing.assert_allclose(np.linalg.norm(found.point - where, axis=1), found.distance)
    weights = random.dirichlet(np.ones(3), 300)
    samples = (weights @ vertices[triangles]).reshape(-1, 3)
    best = np.linalg.norm(samples[None] - where[:, None], axis=2).min(axis=1)
    assert (found.distance <= best + 1e-12).all() and (best - found.distance < 0.03).all()
    none = es.Bvh(vertices, triangles).closest_points([(9, 9, 9)], 1.0)
    assert none.distance[0] == np.inf and none.triangle[0] == es.NONE
    assert np.isnan(none.point).all()


def test_moving_answers_like_building_anew(soup):
    vertices, triangles = soup
    random = np.random.default_rng(4)
    start, end = random.uniform(0, 1, (2, 300, 3))
    sight = es.Sight(types.SimpleNamespace(vertices=vertices, faces=triangles))
    moved = vertices[:, [1, 2, 0]] * 1.1
    assert sight.move(moved, expected_queries=1e6) in ("refit", "repair", "rebuild")
    fresh = es.Sight(moved, triangles)
    np.testing.assert_array_equal(sight.visible(start, end), fresh.visible(start, end))
    with pytest.raises(es.Error):
        sight.move(moved[:-1])
    assert repr(sight) == "<Sight: 200 triangles, 600 vertices>"


def test_sight_lines_are_the_programs(tmp_path, scenes, program):
    random = np.random.default_rng(5)
    scene = es.load(scenes / "classroom.gltf")
    lower, upper = scene.extent()
    eyes, targets = random.uniform(lower, upper, (8, 3)), random.uniform(lower, upper, (9, 3))
    for name, points in (("eyes", eyes), ("targets", targets)):
        lines = (",".join(map(repr, point)) for point in points.tolist())
        (tmp_path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    program("los", scenes / "classroom.gltf", "--from", tmp_path / "eyes.csv",
            "--to", tmp_path / "targets.csv", "-o", tmp_path / "los.csv")
    expected = np.loadtxt(tmp_path / "los.csv", delimiter=",", dtype=int)
    found = es.Sight(scene).matrix(eyes, targets)
    np.testing.assert_array_equal(found, expected)
    assert found.any() and not found.all()


def test_empty_and_wrong_arrays(soup):
    sight = es.Sight(*soup)
    assert sight.visible(np.empty((0, 3)), np.empty((0, 3))).shape == (0,)
    assert sight.matrix(np.empty((0, 3)), [(0, 0, 0)]).shape == (0, 1)
    for call in (lambda: sight.visible(np.zeros((2, 3)), np.zeros((3, 3))),
                 lambda: sight.visible([(0, np.nan, 0)], [(0, 0, 0)]),
                 lambda: sight.visible([(0, 0)], [(0, 0)]),
                 lambda: sight.closest_hits([(0, 0, 0)], [(0, 0, 0)]),
                 lambda: es.Bvh(soup[0]),
                 lambda: es.Bvh(*soup, builder="best")):
        with pytest.raises(es.ArgumentError):
            call()
    with pytest.raises(es.OutOfRange):
        sight.exclude([200])


def test_layouts_are_taken(soup):
    vertices, triangles = soup
    start, end = np.random.default_rng(6).uniform(0, 1, (2, 100, 3))
    expected = es.Sight(vertices, triangles).visible(start, end)
    fortran = es.Sight(np.asfortranarray(vertices), triangles.astype(np.int16))
    np.testing.assert_array_equal(fortran.visible(start[::-1], end[::-1])[::-1], expected)
    np.testing.assert_array_equal(fortran.visible(start.tolist(), end.tolist()), expected)


def test_visible_sets_are_the_programs(tmp_path, scenes, program):
    file = tmp_path / "sets.pvs"
    program("pvs", "build", scenes / "classroom.gltf", "--grid", "2,1,2", "--rays", 20000,
            "--validation", 1000, "-o", file)
    sets = es.VisibleSets(file)
    assert sets.cells == 4 and "4 cells" in repr(sets)
    np.testing.assert_allclose(sets.volumes.sum(), np.prod(sets.region[1] - sets.region[0]))
    point = sets.region.mean(axis=0) * 0.9 + sets.region[0] * 0.1
    program("pvs", "query", file, "--at", ",".join(map(repr, point.tolist())),
            "-o", tmp_path / "seen.json")
    told = json.loads((tmp_path / "seen.json").read_text())
    triangles = next(value for key, value in told.items() if key == "triangles")
    assert sets.at(point).tolist() == [
        t["triangle"] if isinstance(t, dict) else t for t in triangles]
    assert len(sets.at(sets.region[1] + 1)) == 0
    assert sets.locate([point, sets.region[1] + 1]).tolist()[1] == es.NONE
    cell = int(sets.locate(point)[0])
    np.testing.assert_array_equal(np.isin(sets.object_of_triangle, sets.objects(cell)).nonzero()[0],
                                  sets.triangles(cell))
    with pytest.raises(es.OutOfRange):
        sets.triangles(4)
    # Paths whose first reflection the source's cell does not see are left out.
    scene = es.load(scenes / "classroom.gltf")
    options = {"order": 1, "rays": 0, "responses": False, "metrics": False}
    fewer = es.simulate(scene, visible_sets=sets, **options)
    assert len(fewer.paths) <= len(es.simulate(scene, **options).paths)
