# SPDX-License-Identifier: MIT
"""Sound of sources, listeners and scenes that move."""

from __future__ import annotations

import os
from typing import Any, Sequence, Union

import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    created,
    doubles,
    encoded,
    ffi,
    handle_of,
    lib,
    new_options,
    number,
    real_array,
)
from ._progress import Progress, run_long
from .result import Result
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


def _name(name: str | None, role: str) -> Any:
    if name is None:
        return ffi.NULL
    if not isinstance(name, str):
        raise ArgumentError(role, f"is {name!r}", f"give the name of a {role}")
    return ffi.new("char[]", encoded(name))


def auralize_paths(
    dry: SoundLike,
    paths: Union[str, os.PathLike[str], Sequence[Result]],
    *,
    source: Union[int, str, None] = None,
    listener: Union[int, str, None] = None,
    format: str = "mono",
    hrtf: Union[str, os.PathLike[str], None] = None,
    hrtf_raw: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Sound:
    """What a listener hears of a dry recording over paths that have been found already, as
    ``earshot auralize --paths`` does: with Doppler shifts, without late sound.

    Parameters
    ----------
    dry : Sound, file, or (samples, sample rate)
        One channel; it begins at the first instant, and its sample rate is that of the result.
    paths : file, or a sequence of Result
        A paths.json of ``earshot ir --frames``, or results of a scene at times that ascend, as of
        :class:`Simulator`.
    source, listener : str, or int
        Those that take part; not needed where there is one. Those of a file have names.
    format, hrtf, hrtf_raw
        As of :func:`simulate`.
    """
    struct, keep = _options(format=format, hrtf=hrtf, hrtf_raw=hrtf_raw, threads=threads)
    recording = _sound(dry)
    if isinstance(paths, (str, bytes, os.PathLike)):
        function = lib.es_auralize_paths
        given = (encoded(os.fspath(paths)), _name(source, "source"), _name(listener, "listener"))
    else:
        results = list(paths)
        handles = ffi.new("es_result[]",
                          [handle_of(result, Result, "paths") for result in results])
        if not results:
            raise ArgumentError("paths", "are no results", "give a file or at least two results")
        function = lib.es_auralize_results
        given = (handles, len(results), _index(results[0].sources, source, "source"),
                 _index(results[0].listeners, listener, "listener"))

    def call(callback: Any) -> int:
        struct.progress = callback
        return created(function, *given, recording._handle, struct)

    wet = Sound._of(run_long(call, progress))
    del keep
    return wet
