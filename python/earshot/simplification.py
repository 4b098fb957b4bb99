# SPDX-License-Identifier: MIT
"""Scenes with fewer triangles for sound."""

from __future__ import annotations

import json
import os
from typing import Any, NamedTuple

from ._library import created, check, encoded, ffi, handle_of, integer, lib, new_options, number, text
from ._progress import Progress, run_long
from .scene import Scene
from .simulation import _options


class Simplified(NamedTuple):
    """What :func:`earshot.simplify` gives."""

    scene: Scene  #: a new one; the original stays as it is
    report: dict[str, Any]  #: as ``earshot simplify --json`` prints it

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the scene as a .glb file, with the acoustic data of its materials."""
        check(lib.es_scene_write(self.scene._handle, encoded(os.fspath(file))))


def simplify(
    scene: Scene,
    *,
    distance: float = 0.01,
    max_frequency: float | None = None,
    angle: float = 180.0,
    objects: float | None = None,
    compare: bool = False,
    progress: Progress = None,
    threads: int = 0,
    **options: Any,
) -> Simplified:
    """A scene with fewer triangles, within a distance that is measured, and a report.

    Parameters (all but the scene by name)
    ----------
    distance : float
        Metres between the surfaces before and after, at most (0.01).
    max_frequency : float, optional
        In place of ``distance``: what sound of up to so many hertz tells apart.
    angle : float
        Degrees: the opening of the cone that holds the normals of all that a triangle replaces (180).
    objects : float, optional
        Parts of up to this extent, metres, become boxes; 0: none. By default those of up to half the
        wavelength of ``max_frequency``, or whose boxes keep ``distance``.
    compare : bool
        Simulate both scenes and tell paths and metrics before and after (False).
    order, rays, rays_error, seed, ...
        Of these simulations, as in :func:`earshot.simulate`; ``order`` is 3 by default.
    """
    own = new_options("es_simplify_options")
    own.distance = number(distance, "distance")
    if max_frequency is not None:
        own.max_frequency = number(max_frequency, "max_frequency")
    own.angle_deg = number(angle, "angle")
    if objects is not None:
        own.object_size = number(objects, "objects")
    own.threads = integer(threads, "threads")
    options.setdefault("order", 3)
    simulation, _keep = _options(**options)
    handle = handle_of(scene, Scene, "scene")

    def work(callback: Any) -> int:
        own.progress = callback
        return created(lib.es_scene_simplify, handle, own, simulation if compare else ffi.NULL)

    simplified = Scene(run_long(work, progress))
    value = ffi.new("const char **")
    check(lib.es_scene_simplification_json(simplified._handle, value))
    return Simplified(simplified, json.loads(text(value[0])))
