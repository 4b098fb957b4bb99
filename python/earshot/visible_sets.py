# SPDX-License-Identifier: MIT
"""Potentially visible sets of view cells."""

from __future__ import annotations

import os

import numpy as np
import numpy.typing as npt

from ._library import (
    NONE,
    Object,
    check,
    created,
    doubles,
    encoded,
    ffi,
    indices,
    integer,
    lib,
    new_struct,
    points,
    text,
    view,
)


class VisibleSets(Object):
    """What can be seen from the cells of a region: a file of ``earshot pvs build``."""

    def __init__(self, file: str | os.PathLike[str]) -> None:
        super().__init__(created(lib.es_visible_sets_read, encoded(os.fspath(file))))
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

    def locate(self, where: npt.ArrayLike) -> npt.NDArray[np.uint32]:
        """The cell of each of (n, 3) points, (n,); ``earshot.NONE`` outside of the region."""
        array = points(where, "where")
        cells = np.empty(len(array), np.uint32)
        check(lib.es_visible_sets_locate(self._handle, doubles(array), len(array), indices(cells)))
        return cells

    @property
    def volumes(self) -> npt.NDArray[np.float64]:
        """(cells,) cubic metres."""
        values, count = ffi.new("const double **"), ffi.new("size_t *")
        check(lib.es_visible_sets_volumes(self._handle, values, count))
        return view(values[0], (count[0],), np.float64, self)

    def objects(self, cell: int) -> npt.NDArray[np.uint32]:
        """The objects that are visible from a cell, ascending."""
        values, count = ffi.new("const uint32_t **"), ffi.new("size_t *")
        check(lib.es_visible_sets_objects(self._handle, integer(cell, "cell", 0, NONE), values,
                                          count))
        return view(values[0], (count[0],), np.uint32, self)

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
        values, count = ffi.new("const uint32_t **"), ffi.new("size_t *")
        check(lib.es_visible_sets_object_of_triangle(self._handle, values, count))
        return view(values[0], (count[0],), np.uint32, self)

    def __repr__(self) -> str:
        return (f"<VisibleSets of {self.scene!r}: {self.cells} cells, {self.triangle_count} "
                f"triangles, {self.entries} entries>")
