# SPDX-License-Identifier: MIT
"""The sound of a scene in real time."""

from __future__ import annotations

import dataclasses
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import Object, check, created, ffi, integer, lib, new_options, new_struct, number, vector
from .scene import Scene
from .simulation import _options, _prepared


@dataclasses.dataclass(frozen=True)
class EngineStatistics:
    """What an :class:`Engine` has done so far; docs/engine.md explains the members."""

    updates: int
    median_update_milliseconds: float
    max_update_milliseconds: float
    work: int
    paths: int
    dropped_paths: int
    deferred_sources: int
    deferred_late: int
    reduced_late: int
    failed_updates: int
    max_filter_error: float
    blocks: int
    late_snapshots: int
    #: Blocks by the share of their duration that rendering took, in steps of 5 per cent.
    load: npt.NDArray[np.uint64]


class Engine(Object):
    """A scene that is heard while its sources and listeners move (docs/engine.md).

    Place what moves, :meth:`publish`, :meth:`update` and :meth:`render`, block by block: the result
    has the same bits each time. Or :meth:`start` a thread of updates, and render on another one.

    Parameters (all but ``scene`` by name)
    ----------
    order, rays : int
        Highest number of reflections of a path (3); rays of late sound per source and renewal
        (2000).
    format : 'mono', 'binaural' or 'ambisonic:N'
        What listeners receive ('binaural').
    block : int
        Frames that are rendered at once, a power of two (256).
    any_frame_count : bool
        Calls of :meth:`render` may have any number of frames, a block later (False).
    motion_delay, max_delay, late_length, update_interval : float
        Seconds: by which motion is heard later (0.1); of the longest path (1); of late sound, 0: as
        it decays (0); between the updates of the engine's thread (0.05).
    max_paths, max_filters : int
        Per listener (512); that stand for all spectra (24).
    budget_milliseconds, budget_work : float, int
        Of an update; 0: no limit (0).
    options
        As :func:`simulate`: air, bands, sample rate, seed, threads, limits of paths, and ``time``
        of the animation, at which the engine begins.

    Examples
    --------
    >>> import earshot as es
    >>> room = es.shoebox((5, 2.7, 4), absorption=0.3)
    >>> _ = room.add_source("talker", (1, 1.5, 1)), room.add_listener("seat", (4, 1.2, 3))
    >>> engine = es.Engine(room, rays=0, format="ambisonic:1")
    >>> engine.place_source(0, (1.01, 1.5, 1))
    >>> engine.publish()
    >>> engine.update()
    >>> engine.render([[1.0] + [0.0] * 255]).shape
    (1, 4, 256)
    """

    def __init__(
        self,
        scene: Scene,
        *,
        order: int = 3,
        rays: int = 2000,
        format: str = "binaural",
        block: int = 256,
        any_frame_count: bool = False,
        motion_delay: float = 0.1,
        max_delay: float = 1.0,
        max_paths: int = 512,
        max_filters: int = 24,
        late_length: float = 0.0,
        update_interval: float = 0.05,
        budget_milliseconds: float = 0.0,
        budget_work: int = 0,
        **options: Any,
    ) -> None:
        simulation, keep = _options(**{"format": format, **options})
        if format == "binaural":
            simulation.ambisonic_order = 3
        given = new_options("es_engine_options")
        given.order = integer(order, "order")
        given.rays = integer(rays, "rays", 0, 2**32 - 1)
        given.block = integer(block, "block", 0, 2**32 - 1)
        given.any_frame_count = int(bool(any_frame_count))
        given.motion_delay = number(motion_delay, "motion_delay")
        given.max_delay = number(max_delay, "max_delay")
        given.max_paths = integer(max_paths, "max_paths", 0, 2**32 - 1)
        given.max_filters = integer(max_filters, "max_filters", 0, 2**32 - 1)
        given.late_length = number(late_length, "late_length")
        given.update_interval = number(update_interval, "update_interval")
        given.budget_milliseconds = number(budget_milliseconds, "budget_milliseconds")
        given.budget_work = integer(budget_work, "budget_work", 0, 2**63 - 1)
        handle, (self.sources, self.listeners, _) = _prepared(scene)
        super().__init__(created(lib.es_engine_create, handle, simulation, given))
        del keep
        info = new_struct("es_engine_info")
        check(lib.es_engine_get_info(self._handle, info))
        #: Of each listener, hertz, frames of a block, and frames by which all is heard late besides
        #: the delays of paths.
        self.channels = int(info.channels)
        self.sample_rate = float(info.sample_rate)
        self.block = int(info.block)
        self.latency = int(info.latency)

    def place_source(
        self,
        source: Union[str, int],
        position: npt.ArrayLike,
        front: npt.ArrayLike | None = None,
    ) -> None:
        """Where a source is, metres, and where it looks; heard after :meth:`publish`."""
        looks = ffi.NULL if front is None else vector(front, "front")
        check(lib.es_engine_place_source(self._handle, self.sources.index(source),
                                         vector(position, "position"), looks))

    def place_listener(self, listener: Union[str, int], position: npt.ArrayLike) -> None:
        """Where a listener is, metres; heard after :meth:`publish`."""
        check(lib.es_engine_place_listener(self._handle, self.listeners.index(listener),
                                           vector(position, "position")))

    def turn_listener(
        self,
        listener: Union[str, int],
        front: npt.ArrayLike,
        up: npt.ArrayLike = (0.0, 1.0, 0.0),
    ) -> None:
        """How a listener is turned, from the next block on."""
        check(lib.es_engine_turn_listener(self._handle, self.listeners.index(listener),
                                          vector(front, "front"), vector(up, "up")))

    def set_time(self, time: float) -> None:
        """The time of the scene's animation, seconds."""
        check(lib.es_engine_set_time(self._handle, number(time, "time")))

    def publish(self) -> None:
        """Makes what was set valid for the frame that is rendered next."""
        check(lib.es_engine_publish(self._handle))

    def update(self) -> None:
        """Finds the paths of the newest state."""
        check(lib.es_engine_update(self._handle))

    def start(self) -> None:
        """Starts the engine's thread of updates."""
        check(lib.es_engine_start(self._handle))

    def stop(self) -> None:
        """Ends it."""
        check(lib.es_engine_stop(self._handle))

    def render(self, signals: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """The next frames: (listeners, channels, frames) of (sources, frames)."""
        given = np.ascontiguousarray(signals, dtype=np.float32)
        if given.ndim != 2 or given.shape[0] != len(self.sources):
            raise ArgumentError("signals", f"has shape {given.shape}",
                                f"give ({len(self.sources)}, frames): a row per source")
        frames = given.shape[1]
        heard = np.zeros((len(self.listeners), self.channels, frames), dtype=np.float32)
        check(lib.es_engine_render(self._handle, ffi.from_buffer("float[]", given), frames,
                                   ffi.from_buffer("float[]", heard, require_writable=True)))
        return heard

    @property
    def statistics(self) -> EngineStatistics:
        """What it has done so far."""
        struct = new_struct("es_engine_statistics")
        check(lib.es_engine_get_statistics(self._handle, struct))
        values = {field.name: getattr(struct, field.name)
                  for field in dataclasses.fields(EngineStatistics) if field.name != "load"}
        return EngineStatistics(**values, load=np.array(list(struct.load), dtype=np.uint64))

    def __repr__(self) -> str:
        return (f"<Engine: {len(self.sources)} sources, {len(self.listeners)} listeners, "
                f"{self.channels} channels>")
