# SPDX-License-Identifier: MIT
import numpy as np
import pytest

import earshot as es


def test_built_sets_are_the_programs(tmp_path, scenes, program):
    scene = es.load(scenes / "coupled_rooms.gltf")
    for number, (arguments, options) in enumerate((
        ("--region 1,1,1:2,1.5,2 --until 2 --validation 3000",
         {"region": [[1, 1, 1], [2, 1.5, 2]], "until": 2, "validation_rays": 3000}),
        ("--cells 4 --segments 5000 --objects 2 --seed 3 --skip-solids",
         {"cells": 4, "segments": 5000, "triangles_per_object": 2, "seed": 3,
          "skip_solids": True}),
        ("--grid 2,1,2 --validation 0", {"grid": (2, 1, 2), "validation_rays": 0, "threads": 1}),
    )):
        theirs, mine = tmp_path / f"{number}.pvs", tmp_path / f"{number}-mine.pvs"
        program("pvs", "build", scenes / "coupled_rooms.gltf", "--rays", 30000, *arguments.split(),
                "-o", theirs, "--quiet")
        es.VisibleSets.build(scene, rays=30000, **options).write(mine)
        assert mine.read_bytes() == theirs.read_bytes(), arguments


def test_box_is_seen_from_within():
    room = es.shoebox((5, 2.7, 4))
    stages = []
    sets = es.VisibleSets.build(room, region=[[1, 1, 1], [2, 2, 2]], rays=10_000,
                                progress=lambda stage, *_: stages.append(stage))
    assert sets.at((1.5, 1.5, 1.5)).tolist() == list(range(12))
    assert list(dict.fromkeys(stages)) == ["rays", "validation rays"]
    assert sets.validation_rays == 65536 and sets.missed_share == 0.0
    assert 0.0 < sets.missed_share_upper < 1e-4
    assert np.isnan(es.VisibleSets.build(room, rays=1000, validation_rays=0).missed_share)


def test_callback_stops_the_sampling():
    room = es.shoebox((5, 2.7, 4))
    with pytest.raises(es.Cancelled):
        es.VisibleSets.build(room, cells=3, progress=lambda stage, *_: stage != "rays")


@pytest.mark.parametrize("options, subject", [
    ({"region": [[1, 1, 1]]}, "region"),
    ({"region": [[2, 2, 2], [1, 1, 1]]}, "region"),
    ({"region": [[0, 0, 0], [1, np.nan, 1]]}, "region"),
    ({"grid": (2, 2)}, "grid"),
    ({"grid": (2.5, 1, 1)}, "grid"),
    ({"grid": (0, 1, 1)}, "grid"),
    ({"grid": (2, 1, 1), "cells": 2}, "grid"),
    ({"cells": -1}, "cells"),
    ({"rays": 1e6}, "rays"),
    ({"until": -1}, "until"),
    ({"seconds": np.nan}, "seconds"),
    ({"seconds": "soon"}, "seconds"),
    ({"triangles_per_object": 0}, "triangles_per_object"),
    ({"threads": -1}, "threads"),
])
def test_wrong_options_are_told(options, subject):
    with pytest.raises(es.ArgumentError) as told:
        es.VisibleSets.build(es.shoebox((5, 2.7, 4)), **options)
    assert subject in told.value.subject and told.value.remedy


def test_scenes_without_geometry_are_told(tmp_path):
    with pytest.raises(es.Error, match="no triangles"):
        es.VisibleSets.build(es.Scene.from_arrays(np.empty((0, 3)), np.empty((0, 3), int)))
    sets = es.VisibleSets.build(es.shoebox((5, 2.7, 4)), rays=1000)
    with pytest.raises(es.Error, match="no/such"):
        sets.write(tmp_path / "no/such/file.pvs")
