# SPDX-License-Identifier: MIT
"""Maps: metrics over an area."""

from __future__ import annotations

import dataclasses
import math
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
    lib,
    new_options,
    new_struct,
    number,
    points,
    text,
    told_array,
    view,
)
from ._progress import Progress, run_long
from .names import Names
from .scene import Scene
from .simulation import _options


#: A few hard points must not trace rays for all.
_MAX_AUTO_RAYS = 200_000


@dataclasses.dataclass(frozen=True)
class MapLimit:
    """How much of a map keeps a limit."""

    share: float  #: of the area that keeps it, 0 ... 1; of given points: of their number
    uncertain_share: float  #: nearer to the limit than two standard errors
    unknown_share: float  #: without a value, which counts as not keeping it
    worst: float  #: the worst value; NaN if there is none
    worst_point: npt.NDArray[np.float64]  #: (3,) where it is


class MetricMap(Object):
    """Metrics of all sources of a scene over an area, as :func:`earshot.map` gives them."""

    def __init__(self, handle: int, scene: Scene) -> None:
        super().__init__(handle)
        info = new_struct("es_map_info")
        check(lib.es_map_get_info(handle, info))
        self.time: float = info.time  #: instant of the scene's animation, seconds
        self.points_evaluated: int = info.points_evaluated  #: with those of cells that were halved
        self.points_uncertain: int = info.points_uncertain  #: the error asked for is not reached
        #: How many points were left out, by reason.
        self.excluded: dict[str, int] = {"outside": info.outside, "in_solid": info.in_solid,
                                         "near_surface": info.near_surface}
        #: Names of the sources and the metrics, the order of the last axes of ``values``.
        self.sources = Names(tuple(scene.sources), "source")
        name = ffi.new("const char **")
        names = []
        for metric in range(info.metrics):
            check(lib.es_map_metric(handle, metric, name, ffi.NULL, ffi.NULL, ffi.NULL))
            names.append(text(name[0]))
        self.metrics = Names(names, "metric")

    def _arrays(self) -> tuple[Any, Any, tuple[int, ...]]:
        values, errors = ffi.new("const double **"), ffi.new("const double **")
        shape = ffi.new("size_t[3]")
        check(lib.es_map_values(self._handle, values, errors, shape))
        return values[0], errors[0], tuple(shape)

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """(points, sources, metrics); NaN where there is no value."""
        values, _, shape = self._arrays()
        return view(values, shape, np.float64, self)

    @property
    def standard_errors(self) -> npt.NDArray[np.float64]:
        """(points, sources, metrics); NaN where there is none."""
        _, errors, shape = self._arrays()
        return view(errors, shape, np.float64, self)

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """(points, 3) metres: the middles of the cells, or the given points."""
        return told_array(self, lib.es_map_points, shape=(3,))

    @property
    def cells(self) -> npt.NDArray[np.float64]:
        """(points, 4): x0, z0, x1, z1 of the cells, metres; NaN for given points."""
        return told_array(self, lib.es_map_cells, shape=(4,))

    def __getitem__(self, metric: str) -> npt.NDArray[np.float64]:
        """A metric's values, (points, sources)."""
        return self.values[:, :, self.metrics.index(metric)]

    def limit(self, metric: str | int, value: float, *, at_least: bool = True,
              source: str | int = 0) -> MapLimit:
        """How much of the map of a source keeps values ``at_least`` (or at most) the limit."""
        result = new_struct("es_map_limit")
        check(lib.es_map_evaluate_limit(self._handle, self.sources.index(source), self.metrics.index(metric),
                                        number(value, "value"), int(bool(at_least)), result))
        return MapLimit(result.share, result.uncertain_share, result.unknown_share, result.worst,
                        np.array(list(result.worst_point)))

    def contour(self, metric: str | int, level: float, *,
                source: str | int = 0) -> list[npt.NDArray[np.float64]]:
        """Lines where the value is ``level``, each (n, 3); a closed one ends where it begins."""
        count = ffi.new("size_t *")
        where = (self._handle, self.sources.index(source), self.metrics.index(metric), number(level, "level"))
        check(lib.es_map_contour(*where, ffi.NULL, ffi.NULL, 0, count))
        at = np.empty((count[0], 3))
        line = np.empty(count[0], np.uint32)
        check(lib.es_map_contour(*where, doubles(at), indices(line), len(line), count))
        return [at[line == index] for index in range(int(line.max()) + 1 if len(line) else 0)]

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a .csv or .json file, as ``earshot map`` does."""
        check(lib.es_map_write(self._handle, encoded(os.fspath(file))))

    def draw(self, file: str | os.PathLike[str], metric: str | int = 0, *, source: str | int = 0,
             walls: Scene | None = None, limit: float | None = None) -> None:
        """Draws a metric of a source as a plan into a .svg or .png file, as ``earshot map`` does.

        ``walls``: the scene whose section is drawn. ``limit``: a value whose contour is drawn, and about
        which the colours step.
        """
        check(lib.es_map_draw(self._handle, self.sources.index(source), self.metrics.index(metric),
                              0 if walls is None else walls._handle,
                              math.nan if limit is None else number(limit, "limit"),
                              encoded(os.fspath(file))))

    def __repr__(self) -> str:
        return (f"<MetricMap of {', '.join(self.metrics)}: {len(self.points)} points x "
                f"{len(self.sources)} sources>")


def map(
    scene: Scene,
    *,
    rect: Sequence[float] | None = None,
    on: str | int | None = None,
    at: npt.ArrayLike | None = None,
    height: float = 1.2,
    step: float = 0.25,
    coarse_step: float = 0.0,
    clearance: float = 0.1,
    metrics: str | Sequence[str] = ("sti", "t30", "c80"),
    progress: Progress = None,
    **options: Any,
) -> MetricMap:
    """Metrics of all sources of a scene over an area, without impulse responses.

    Parameters (all but ``scene`` by name); exactly one of ``rect``, ``on`` and ``at``
    ----------
    rect : 4 floats
        x0, z0, x1, z1 of a rectangle at ``height``, metres.
    on : str or int
        Name or index of a material: at ``height`` above its faces that look upwards.
    at : (n, 3) array
        Given points.
    height, step, coarse_step, clearance : float
        Metres (1.2); edge of the smallest cells (0.25); of the first ones, which are halved where
        values change, 0: four times ``step``; least distance of points to surfaces (0.1).
    metrics : str or list of str
        'sti', 'edt', 't20', 't30', 'c50', 'c80', 'd50', 'ts', 'g' (means of 500 Hz and 1 kHz), or
        of one band, 't30:125'.
    time, order, transmission, rays, rays_error, seed, temperature, humidity, pressure,
    air_absorption, bands, noise, speech, threads, progress
        As in :func:`earshot.simulate`; ``order`` is 3 and ``rays_error`` 0.04 by
        default, and 'auto' traces at most 200,000 rays.

    Examples
    --------
    >>> import earshot as es
    >>> room = es.shoebox((5, 2.7, 4), absorption=0.3)
    >>> _ = room.add_source("talker", (1, 1.5, 1))
    >>> found = es.map(room, rect=(0, 0, 5, 4), step=1, metrics="g", rays=0, order=12)
    >>> found
    <MetricMap of g: 20 points x 1 sources>
    >>> found.limit("g", 10).share
    1.0
    """
    if sum(area is not None for area in (rect, on, at)) != 1:
        raise ArgumentError("area", "is not told by exactly one of rect, on and at", "give one")
    own = new_options("es_map_options")
    keep: list[Any] = []
    if rect is not None:
        corners = [number(value, "rect") for value in rect]
        if len(corners) != 4:
            raise ArgumentError("rect", f"has {len(corners)} numbers", "give x0, z0, x1, z1")
        own.rectangle = corners
    elif on is not None:
        own.area = 1
        own.material = scene.materials.index(on)
    else:
        array = points(at, "at")
        own.area, own.points, own.point_count = 2, doubles(array), len(array)
        keep.append(array)
    own.height, own.step = number(height, "height"), number(step, "step")
    own.coarse_step = number(coarse_step, "coarse_step")
    own.clearance = number(clearance, "clearance")
    names = metrics if isinstance(metrics, str) else ",".join(metrics)
    keep.append(ffi.new("char[]", encoded(names)))
    own.metrics = keep[-1]
    options.setdefault("order", 3)
    is_auto = options.get("rays", "auto") == "auto"
    if is_auto:
        options.setdefault("rays_error", 0.04)
    simulation, keep_simulation = _options(**options)
    keep += keep_simulation
    if is_auto:
        simulation.rays = _MAX_AUTO_RAYS

    def work(callback: Any) -> int:
        simulation.progress = callback
        return created(lib.es_map_create, scene._handle, simulation, own)

    return MetricMap(run_long(work, progress), scene)
