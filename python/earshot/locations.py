# SPDX-License-Identifier: MIT
"""Positions of sources and listeners from measured arrival times."""

from __future__ import annotations

import dataclasses
import os
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    Object,
    check,
    created,
    doubles,
    encoded,
    ffi,
    indices,
    integer,
    lib,
    new_options,
    new_struct,
    number,
    text,
    told_array,
    view,
)
from ._progress import Progress, run_long
from .names import Names
from .scene import Scene


@dataclasses.dataclass(frozen=True)
class Located:
    """Where sources or listeners are, and how sure it is."""

    names: Names
    positions: npt.NDArray[np.float64]  #: (count, 3) metres
    errors: npt.NDArray[np.float64]  #: (count, 3) standard errors; infinite where nothing tells it
    data_shares: npt.NDArray[np.float64]  #: (count, 3) what the arrivals have told, 0 ... 1

    def __getitem__(self, name: str | int) -> npt.NDArray[np.float64]:
        """The position of one, (3,)."""
        return self.positions[self.names.index(name)]


class Location(Object):
    """Sources and listeners of a scene, as :func:`earshot.locate` finds them."""

    def __init__(self, handle: int, scene: Scene) -> None:
        super().__init__(handle)
        info = new_struct("es_location_info")
        check(lib.es_location_get_info(handle, info))
        self.matched: int = info.matched  #: arrivals that fit a path
        self.median_before: float = info.median_before  #: of absolute errors as stated, seconds
        self.median_after: float = info.median_after  #: as located
        #: Of arrivals predicted from others; NaN without folds.
        self.median_held_out: float = info.median_held_out
        self.rms_move: float = info.rms_move  #: of coordinates, in stated errors
        self.speed_of_sound: float = info.speed_of_sound  #: metres per second
        self.speed_error: float = info.speed_error  #: its standard error
        self.temperature: float = info.temperature_c  #: of air in which sound is so fast
        self.order: int = info.order  #: of the paths that were looked for
        self.converged: bool = bool(info.converged)
        self.sources = self._located(0, scene.sources, "source")
        self.listeners = self._located(1, scene.listeners, "listener")
        #: How far the arrivals tell each motion of all together, 0: it is as stated.
        self.motions: dict[str, float] = {}
        name, share = ffi.new("const char **"), ffi.new("double *")
        for motion in range(info.motions):
            check(lib.es_location_motion(handle, motion, name, share))
            self.motions[text(name[0])] = share[0]

    def _located(self, item: int, names: Sequence[str], kind: str) -> Located:
        arrays = [ffi.new("const double **") for _ in range(3)]
        count = ffi.new("size_t *")
        check(lib.es_location_positions(self._handle, item, *arrays, count))
        return Located(Names(tuple(names), kind),
                       *(view(array[0], (count[0], 3), np.float64, self) for array in arrays))

    @property
    def latencies(self) -> npt.NDArray[np.float64]:
        """(sources,) seconds that each starts late."""
        values, count = ffi.new("const double **"), ffi.new("size_t *")
        check(lib.es_location_latencies(self._handle, values, ffi.NULL, count))
        return view(values[0], (count[0],), np.float64, self)

    @property
    def walls(self) -> npt.NDArray[np.float64]:
        """(walls, 5): normal, stated and located offset along it, metres."""
        planes, count = ffi.new("const double **"), ffi.new("size_t *")
        check(lib.es_location_walls(self._handle, planes, ffi.NULL, ffi.NULL, count))
        return view(planes[0], (count[0], 5), np.float64, self)

    @property
    def arrivals(self) -> npt.NDArray[np.float64]:
        """(arrivals, 4): model - measured before, after and held out, seconds, and the weight."""
        return told_array(self, lib.es_location_arrivals, shape=(4,))

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a .json file, as ``earshot calibrate --locate`` does."""
        check(lib.es_location_write(self._handle, encoded(os.fspath(file))))

    def __repr__(self) -> str:
        return (f"<Location by {self.matched} arrivals: median error {1e3 * self.median_before:.3g} ms "
                f"as stated, {1e3 * self.median_after:.3g} ms as located>")


def locate(
    scene: Scene,
    arrivals: Sequence[tuple[Any, ...]],
    *,
    source_error: float = 0.01,
    listener_error: float = 0.01,
    temperature_error: float = 2.0,
    latency_error: float = 0.0,
    wall_error: float = 0.0,
    timing_error: float = 4e-5,
    match_window: float = 1e-3,
    order: int | None = None,
    folds: int = 0,
    seed: int = 1,
    time: float = 0.0,
    temperature: float = 20.0,
    humidity: float = 50.0,
    pressure: float = 101.325,
    threads: int = 0,
    progress: Progress = None,
) -> Location:
    """Where sources and listeners are, and how fast sound is, by measured arrival times.

    Parameters (all but the first two by name)
    ----------
    arrivals : sequence of (source, listener, time) or (source, listener, time, surfaces)
        Names or indices; seconds since the emission; the names of the materials or meshes that
        reflected it, in order, between '>' ('direct': none). Without them the path closest in time
        is taken.
    source_error, listener_error, temperature_error, latency_error, wall_error : float
        Standard deviations of what is stated: of coordinates in metres (0.01), of the air's
        temperature in kelvin (2), of how late sources start in seconds (0), of walls' planes in
        metres (0). 0 holds it, ``math.inf`` says that nothing is known.
    timing_error, match_window : float
        Of the times but for outliers (4e-5 s); how far a path may be from an arrival without
        surfaces (1e-3 s).
    order : int or None
        Most reflections of a path; None: what the arrivals need.
    folds, seed : int
        Parts of a cross-validation, each predicted from the others; 0: none.
    time, temperature, humidity, pressure, threads, progress
        As in :func:`earshot.simulate`.

    Examples
    --------
    >>> import earshot as es
    >>> room = es.shoebox((5, 2.7, 4))
    >>> _ = room.add_source("talker", (1, 1.5, 1))
    >>> _ = room.add_listener("ear", (3, 1.2, 2))
    >>> found = es.locate(room, [("talker", "ear", 0.0067, "direct")], source_error=0)
    >>> found.listeners["ear"].round(2)
    array([3.01, 1.2 , 2.  ])
    """
    sources, listeners = scene.sources, scene.listeners
    pairs = np.empty((len(arrivals), 2), np.uint32)
    times = np.empty(len(arrivals))
    surfaces = ffi.new("char *[]", len(arrivals))
    keep: list[Any] = []
    for row, arrival in enumerate(arrivals):
        if not isinstance(arrival, (tuple, list)) or len(arrival) not in (3, 4):
            raise ArgumentError("arrivals", f"holds {arrival!r}",
                                "give rows of source, listener, time and, if known, surfaces")
        pairs[row] = sources.index(arrival[0]), listeners.index(arrival[1])
        times[row] = number(arrival[2], "arrivals")
        if len(arrival) == 4 and arrival[3]:
            keep.append(ffi.new("char[]", encoded(arrival[3])))
            surfaces[row] = keep[-1]
    options = new_options("es_locate_options")
    for name, value in [("source_error", source_error), ("listener_error", listener_error),
                        ("temperature_error", temperature_error), ("latency_error", latency_error),
                        ("wall_error", wall_error), ("timing_error", timing_error),
                        ("match_window", match_window), ("time", time),
                        ("temperature_c", temperature), ("humidity_percent", humidity),
                        ("pressure_kpa", pressure)]:
        setattr(options, name, number(value, name))
    options.order = -1 if order is None else integer(order, "order", 0)
    options.folds = integer(folds, "folds", 0)
    options.seed = integer(seed, "seed", 0, 2**64 - 1)
    options.threads = integer(threads, "threads", 0)

    def work(callback: Any) -> int:
        options.progress = callback
        return created(lib.es_locate, scene._handle, indices(pairs), doubles(times), surfaces,
                       len(arrivals), options)

    return Location(run_long(work, progress), scene)
