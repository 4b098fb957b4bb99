# SPDX-License-Identifier: MIT
"""Sound of sources, listeners and scenes that move."""

from __future__ import annotations

from typing import Any, Union

import numpy.typing as npt

from ._errors import ArgumentError
from ._library import created, doubles, ffi, lib, new_options, number, real_array
from ._progress import Progress, run_long
from .scene import Scene
from .simulation import _options, _prepared
from .sound import Sound, SoundLike, _sound

_RAYS, _RAYS_ERROR, _ORDER = 200_000, 0.05, 3


def _index(names: Any, item: Union[int, str, None], role: str) -> int:
    if item is None:
        if len(names) > 1:
            raise ArgumentError(role, f"is one of {len(names)}", f"name the {role}")
        return 0
    return names.index(item)


def _path(path: npt.ArrayLike | None, name: str) -> tuple[Any, int, Any]:
    """The pointer, the number of rows, and what must live as long."""
    if path is None:
        return ffi.NULL, 0, None
    array = real_array(path, name, "(n, 4): time, x, y, z")
    if array.ndim != 2 or array.shape[1] != 4:
        raise ArgumentError(name, f"has shape {array.shape}", "give (n, 4): time, x, y, z")
    return doubles(array), len(array), array


def auralize_moving(
    dry: SoundLike,
    scene: Scene,
    *,
    source: Union[int, str, None] = None,
    listener: Union[int, str, None] = None,
    source_path: npt.ArrayLike | None = None,
    listener_path: npt.ArrayLike | None = None,
    step: float = 0.05,
    late_step: float = 0.5,
    progress: Progress = None,
    **options: Any,
) -> Sound:
    """What a listener hears of a dry recording while the source, the listener or the scene moves,
    as ``earshot auralize --scene`` does: every path is a delay that follows its length, so that
    frequency and level are those of the motion.

    Parameters
    ----------
    dry : Sound, file, or (samples, sample rate)
        One channel; its sample rate is that of the result.
    source, listener : int or str
        Those that take part; not needed where the scene has one.
    source_path, listener_path : (n, 4) floats
        Times, seconds, which ascend, and places; None: where the scene has them.
    step, late_step : float
        Seconds between the instants at which paths are found, and late sound is traced.
    options
        As :func:`simulate`; ``time`` is when the recording begins. Defaults: order 3, at most
        200,000 rays until T30 has a standard error of 5 %.
    """
    given = {"order": _ORDER, "rays": _RAYS, "rays_error": _RAYS_ERROR, **options}
    struct, keep = _options(**given)
    handle, (sources, listeners, _) = _prepared(scene)
    recording = _sound(dry)
    motion = new_options("es_motion_options")
    motion.source = _index(sources, source, "source")
    motion.listener = _index(listeners, listener, "listener")
    motion.source_path, motion.source_path_count, of_source = _path(source_path, "source_path")
    motion.listener_path, motion.listener_path_count, of_listener = _path(
        listener_path, "listener_path")
    motion.step = number(step, "step")
    motion.late_step = number(late_step, "late_step")

    def call(callback: Any) -> int:
        struct.progress = callback
        return created(lib.es_auralize_moving, handle, recording._handle, struct, motion)

    wet = Sound._of(run_long(call, progress))
    del keep, of_source, of_listener
    return wet
