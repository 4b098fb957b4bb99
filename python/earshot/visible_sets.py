# SPDX-License-Identifier: MIT
"""Potentially visible sets of view cells."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    NONE,
    Object,
    check,
    created,
    doubles,
    encoded,
    ffi,
    handle_of,
    index_array,
    indices,
    integer,
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
from .scene import Scene


class VisibleSets(Object):
    """What can be seen from the cells of a region: of a file of ``earshot pvs build``, or made by
    :meth:`build`."""

    def __init__(self, file: str | os.PathLike[str]) -> None:
        self._own(created(lib.es_visible_sets_read, encoded(os.fspath(file))))

    @classmethod
    def build(
        cls,
        scene: Scene,
        *,
        region: npt.ArrayLike | None = None,
        cells: int = 0,
        grid: npt.ArrayLike | None = None,
        time: float = 0.0,
        triangles_per_object: int = 1,
        rays: int = 0,
        until: int | None = None,
        validation_rays: int | None = None,
        segments: int = 200_000,
        seconds: float = np.inf,
        skip_solids: bool = False,
        seed: int = 1,
        threads: int = 0,
        progress: Progress = None,
    ) -> VisibleSets:
        """Finds by rays what can be seen from a region, or from each of its cells, as ``earshot pvs
        build`` does. What no ray has found is not in the sets.

        Parameters
        ----------
        region : (2, 3) floats, optional
            Lower and upper corner of all viewpoints, metres; the box around the scene if left out.
        cells : int
            At most so many cells the region is divided into, where visibility changes; 0: see
            ``grid``.
        grid : (3,) integers, optional
            Boxes along x, y and z that it is divided into instead; one cell if left out.
        time : float
            Instant of the scene's animation, seconds.
        triangles_per_object : int
            Sets consist of groups of so many triangles at most.
        rays : int
            At most so many; 0: 10 or, with cells, 20 million.
        until : int, optional
            Enough when a million rays found fewer triangles (50) or, with cells, when no set grew
            by more in 5 million (5).
        validation_rays : int, optional
            Fresh rays that measure what the sets miss (a tenth of the rays, at least 65,536).
        segments : int
            Random segments by which ``cells`` are found.
        seconds : float
            Enough after this time, too, whereupon the sets depend on the machine.
        skip_solids : bool
            Segments within closed solids do not count, for ``cells``.
        seed, threads : int
            0 threads: one per core, which changes no result.
        progress : bool, function or class
            As :func:`earshot.simulate` takes.

        Ctrl-C stops the work. Other threads run meanwhile.

        Examples
        --------
        >>> import earshot as es
        >>> room = es.shoebox((5, 2.7, 4))
        >>> es.VisibleSets.build(room, region=[[1, 1, 1], [2, 2, 2]], rays=10_000)
        <VisibleSets of 'shoebox': 1 cells, 12 triangles, 12 entries>
        """
        handle, options = handle_of(scene, Scene, "scene"), new_options("es_visible_sets_options")
        keep: list[Any] = []
        options.time = number(time, "time")
        if region is not None:
            keep.append(points(region, "region", 2))
            options.region = doubles(keep[-1])
        if grid is not None:
            keep.append(index_array(grid, "grid"))
            if len(keep[-1]) != 3:
                raise ArgumentError("grid", f"has {len(keep[-1])} numbers", "give three")
            options.grid = indices(keep[-1])
        options.cells = integer(cells, "cells", 0)
        options.triangles_per_object = integer(triangles_per_object, "triangles_per_object", 0)
        options.rays = integer(rays, "rays", 0, 2**63 - 1)
        for name, value in (("until", until), ("validation_rays", validation_rays)):
            if value is not None:
                setattr(options, name, integer(value, name, 0, 2**63 - 1))
        options.segments = integer(segments, "segments", 0)
        options.seconds = number(seconds, "seconds")
        options.skip_solids = int(bool(skip_solids))
        options.seed = integer(seed, "seed", 0, 2**63 - 1)
        options.threads = integer(threads, "threads")

        def call(callback: Any) -> int:
            options.progress = callback
            return created(lib.es_visible_sets_build, handle, options)

        made = cls.__new__(cls)
        made._own(run_long(call, progress))
        del keep
        return made

    def _own(self, handle: int) -> None:
        """Takes the object behind a handle for its own."""
        Object.__init__(self, handle)
        info = new_struct("es_visible_sets_info")
        check(lib.es_visible_sets_get_info(self._handle, info))
        self.cells: int = info.cells  #: number of cells
        self.object_count: int = info.objects  #: groups of triangles that sets consist of
        self.triangle_count: int = info.triangles  #: of the mesh
        self.entries: int = info.entries  #: of all sets together
        #: (2, 3) corners of the region, metres.
        self.region = np.array([list(info.lower), list(info.upper)])
        self.scene = text(info.scene)  #: name of the scene that they are of
        self.time: float = info.time  #: instant of its animation, seconds
        self.rays: int = info.rays  #: that were traced
        self.seed: int = info.seed
        self.validation_rays: int = info.validation_rays  #: that measured what the sets miss
        #: Share of all directions in which they lack what is closest; NaN if that was not measured.
        self.missed_share: float = info.missed_share
        #: A bound of it that holds in 95 % of all cases; NaN likewise.
        self.missed_share_upper: float = info.missed_share_upper

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a file of ``earshot pvs build``, the same bytes, whole or not at all."""
        check(lib.es_visible_sets_write(self._handle, encoded(os.fspath(file))))

    def locate(self, where: npt.ArrayLike) -> npt.NDArray[np.uint32]:
        """The cell of each of (n, 3) points, (n,); ``earshot.NONE`` outside of the region."""
        array = points(where, "where")
        cells = np.empty(len(array), np.uint32)
        check(lib.es_visible_sets_locate(self._handle, doubles(array), len(array), indices(cells)))
        return cells

    @property
    def volumes(self) -> npt.NDArray[np.float64]:
        """(cells,) cubic metres."""
        return told_array(self, lib.es_visible_sets_volumes)

    def objects(self, cell: int) -> npt.NDArray[np.uint32]:
        """The objects that are visible from a cell, ascending."""
        return told_array(
            self, lib.es_visible_sets_objects, integer(cell, "cell", 0, NONE), dtype=np.uint32)

    def triangles(self, cell: int) -> npt.NDArray[np.uint32]:
        """The triangles that are visible from a cell, ascending."""
        index, count = integer(cell, "cell", 0, NONE), ffi.new("size_t *")
        check(lib.es_visible_sets_triangles(self._handle, index, ffi.NULL, 0, count))
        found = np.empty(count[0], np.uint32)
        check(lib.es_visible_sets_triangles(self._handle, index, indices(found), len(found), count))
        return found

    def at(self, point: npt.ArrayLike) -> npt.NDArray[np.uint32]:
        """The triangles that are visible from the cell of a point; none outside of the region."""
        cell = self.locate(points(point, "point", 1))[0]
        return np.empty(0, np.uint32) if cell == NONE else self.triangles(int(cell))

    @property
    def object_of_triangle(self) -> npt.NDArray[np.uint32]:
        """(triangles,)"""
        return told_array(self, lib.es_visible_sets_object_of_triangle, dtype=np.uint32)

    def __repr__(self) -> str:
        return (f"<VisibleSets of {self.scene!r}: {self.cells} cells, {self.triangle_count} "
                f"triangles, {self.entries} entries>")
