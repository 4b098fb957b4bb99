# SPDX-License-Identifier: MIT
"""One hierarchy over a mesh that moves: rays, closest points, lines of sight."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    NONE,
    Object,
    check,
    choice,
    created,
    doubles,
    ffi,
    handle_of,
    index_array,
    indices,
    integer,
    lib,
    number,
    points,
)
from .scene import Scene

BUILDERS = {
    "binned-sah": 0,
    "sweep-sah": 1,
    "spatial-median": 2,
    "quality": 3,
    "lbvh": 4,
    "hybrid": 5,
    "fast": 6,
}


class Hits(NamedTuple):
    """Closest hits of n rays."""

    #: (n,) distances in multiples of the direction; infinity where nothing is hit.
    t: npt.NDArray[np.float64]
    #: (n,) triangles; ``earshot.NONE`` where nothing is hit.
    triangle: npt.NDArray[np.uint32]
    #: (n, 2) weights of the triangle's second and third vertex.
    uv: npt.NDArray[np.float64]


class ClosestPoints(NamedTuple):
    """Closest points of a mesh to n points."""

    #: (n,) metres; infinity where there is none.
    distance: npt.NDArray[np.float64]
    #: (n,) triangles; ``earshot.NONE`` where there is none.
    triangle: npt.NDArray[np.uint32]
    #: (n, 3) metres; NaN where there is none.
    point: npt.NDArray[np.float64]


class Blockers(NamedTuple):
    """What first blocks n segments."""

    #: (n,) triangles; ``earshot.NONE`` where nothing does.
    triangle: npt.NDArray[np.uint32]
    #: (n,) where: 0 at the segment's beginning, 1 at its end, infinity where nothing blocks.
    t: npt.NDArray[np.float64]


def _pairs(
    a: npt.ArrayLike, b: npt.ArrayLike, names: tuple[str, str]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Two lists of points of one length; a single point stands for as many as the other has."""
    first, second = points(a, names[0]), points(b, names[1])
    if len(first) != len(second):
        if len(first) == 1:
            first = np.ascontiguousarray(np.broadcast_to(first, second.shape))
        elif len(second) == 1:
            second = np.ascontiguousarray(np.broadcast_to(second, first.shape))
        else:
            raise ArgumentError(names[1], f"has {len(second)} points",
                                f"give one, or {len(first)} as {names[0]} has")
    return first, second


class Bvh(Object):
    """A mesh and the bounding volume hierarchy over it.

    Parameters
    ----------
    vertices : (n, 3) floats, or Scene, or an object with ``vertices`` and ``faces``
        Metres; copied.
    triangles : (m, 3) integers, optional
        Vertex indices; left out for a scene or mesh object.
    builder : str
        'binned-sah', 'quality', 'fast', ...; changes times only.
    threads : int
        0: one per core; changes no result.
    """

    def __init__(
        self,
        vertices: Any,
        triangles: npt.ArrayLike | None = None,
        *,
        builder: str = "binned-sah",
        threads: int = 0,
    ) -> None:
        kind = choice(builder, BUILDERS, "builder")
        threads = integer(threads, "threads")
        if isinstance(vertices, Scene):
            super().__init__(created(lib.es_bvh_create_from_scene, vertices._handle, 0.0, kind,
                                     threads))
            return
        if triangles is None:
            if not hasattr(vertices, "faces"):
                raise ArgumentError("triangles", "is left out", "give (m, 3) vertex indices")
            vertices, triangles = vertices.vertices, vertices.faces
        corners, faces = points(vertices, "vertices"), index_array(triangles, "triangles", 3)
        super().__init__(created(lib.es_bvh_create, doubles(corners), len(corners),
                                 indices(faces), len(faces), kind, threads))

    @classmethod
    def of_scene(
        cls, scene: Scene, time: float = 0.0, *, builder: str = "binned-sah", threads: int = 0
    ) -> Any:
        """Of all triangles of a scene at an instant of its animation, seconds."""
        made = cls.__new__(cls)
        Object.__init__(made, created(
            lib.es_bvh_create_from_scene, handle_of(scene, Scene, "scene"), number(time, "time"),
            choice(builder, BUILDERS, "builder"), integer(threads, "threads")))
        return made

    def _counts(self) -> tuple[int, int]:
        vertex_count, triangle_count = ffi.new("size_t *"), ffi.new("size_t *")
        check(lib.es_bvh_counts(self._handle, vertex_count, triangle_count))
        return vertex_count[0], triangle_count[0]

    def __repr__(self) -> str:
        vertex_count, triangle_count = self._counts()
        return f"<{type(self).__name__}: {triangle_count} triangles, {vertex_count} vertices>"

    def move(
        self, vertices: npt.ArrayLike, *, expected_queries: float = 0.0, threads: int = 0
    ) -> str:
        """Moves the vertices, (n, 3) metres, as many as before.

        The hierarchy is refitted, repaired or rebuilt so that this and ``expected_queries`` until
        the next move cost the least; returns which: 'refit', 'repair' or 'rebuild'.
        """
        array, action = points(vertices, "vertices"), ffi.new("int32_t *")
        check(lib.es_bvh_update(self._handle, doubles(array), len(array),
                                number(expected_queries, "expected_queries"),
                                integer(threads, "threads"), action))
        return ("refit", "repair", "rebuild")[action[0]]

    def closest_hits(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        max_t: npt.ArrayLike | None = None,
        *,
        threads: int = 0,
    ) -> Hits:
        """The closest hit of each ray, on either side of a triangle.

        Parameters
        ----------
        origins, directions : (n, 3) floats
            Directions have any length but 0, in multiples of which distances count.
        max_t : (n,) floats or float, optional
        """
        start, along = _pairs(origins, directions, ("origins", "directions"))
        count = len(start)
        limit = None
        if max_t is not None:
            try:
                limit = np.ascontiguousarray(np.broadcast_to(np.asarray(max_t, float), (count,)))
            except ValueError as error:
                raise ArgumentError("max_t", str(error), f"give one number or {count}") from None
        hits = Hits(np.empty(count), np.empty(count, np.uint32), np.empty((count, 2)))
        check(lib.es_bvh_closest_hits(
            self._handle, doubles(start), doubles(along),
            ffi.NULL if limit is None else doubles(limit), count, integer(threads, "threads"),
            doubles(hits.t), indices(hits.triangle), doubles(hits.uv)))
        return hits

    def occluded(
        self, start: npt.ArrayLike, end: npt.ArrayLike, *, threads: int = 0
    ) -> Any:
        """Whether any triangle shares a point with each closed segment: (n,) bool, or one bool of
        two single points. Decided exactly."""
        return self._segments(lib.es_bvh_occluded, start, end, threads)

    def closest_points(
        self, to: npt.ArrayLike, max_distance: float = np.inf, *, threads: int = 0
    ) -> ClosestPoints:
        """The closest point of the mesh to each of (n, 3) points, within ``max_distance``."""
        given = points(to, "to")
        count = len(given)
        found = ClosestPoints(np.empty(count), np.empty(count, np.uint32), np.empty((count, 3)))
        check(lib.es_bvh_closest_points(
            self._handle, doubles(given), count, number(max_distance, "max_distance"),
            integer(threads, "threads"), doubles(found.distance), indices(found.triangle),
            doubles(found.point)))
        return found

    def _segments(
        self, function: Any, start: npt.ArrayLike, end: npt.ArrayLike, threads: int
    ) -> Any:
        first, second = _pairs(start, end, ("start", "end"))
        answers = np.empty(len(first), np.bool_)
        check(function(self._handle, doubles(first), doubles(second), len(first),
                       integer(threads, "threads"), ffi.from_buffer("uint8_t[]", answers)))
        return bool(answers[0]) if np.ndim(start) == np.ndim(end) == 1 else answers


class Sight(Bvh):
    """Lines of sight through a mesh; a :class:`Bvh`, made and moved in the same ways.

    A closed segment that touches a triangle, edges included, is blocked; the answer is exact and
    the same in both directions.
    """

    def visible(
        self, start: npt.ArrayLike, end: npt.ArrayLike, *, threads: int = 0
    ) -> Any:
        """Whether each segment from (n, 3) to (n, 3) touches no triangle: (n,) bool, or one bool of
        two single points. One point stands for as many as the other has."""
        return self._segments(lib.es_bvh_visible, start, end, threads)

    def matrix(
        self, eyes: npt.ArrayLike, targets: npt.ArrayLike, *, threads: int = 0
    ) -> npt.NDArray[np.bool_]:
        """Which of (n, 3) eyes see which of (m, 3) targets, (n, m)."""
        rows, columns = points(eyes, "eyes"), points(targets, "targets")
        answers = np.empty((len(rows), len(columns)), np.bool_)
        check(lib.es_bvh_visible_matrix(
            self._handle, doubles(rows), len(rows), doubles(columns), len(columns),
            integer(threads, "threads"), ffi.from_buffer("uint8_t[]", answers)))
        return answers

    def shares(
        self,
        eyes: npt.ArrayLike,
        targets: npt.ArrayLike,
        radius: float,
        *,
        max_rays: int = 2048,
        threads: int = 0,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """How much of a ball of ``radius`` metres about each of (m, 3) targets each of (n, 3) eyes
        sees, the share of its solid angle, and what it may be off by: two arrays (n, m).

        The error is 0 where nothing is between or one surface hides all of the ball; elsewhere rays
        leave one of at most 2.7 over the root of ``max_rays``.
        """
        rows, columns = points(eyes, "eyes"), points(targets, "targets")
        shares, errors = (np.empty((len(rows), len(columns))) for _ in range(2))
        check(lib.es_bvh_visible_shares(
            self._handle, doubles(rows), len(rows), doubles(columns), len(columns),
            number(radius, "radius"), integer(max_rays, "max_rays", 0), integer(threads, "threads"),
            doubles(shares), doubles(errors)))
        return shares, errors

    def first_blockers(
        self, start: npt.ArrayLike, end: npt.ArrayLike, *, threads: int = 0
    ) -> Blockers:
        """The triangle that blocks each segment first from its beginning."""
        first, second = _pairs(start, end, ("start", "end"))
        found = Blockers(np.empty(len(first), np.uint32), np.empty(len(first)))
        check(lib.es_bvh_first_blockers(
            self._handle, doubles(first), doubles(second), len(first),
            integer(threads, "threads"), indices(found.triangle), doubles(found.t)))
        return found

    def exclude(self, triangles: npt.ArrayLike) -> None:
        """From now on these triangles, (k,), block nothing; replaces what was excluded before."""
        array = index_array(triangles, "triangles")
        check(lib.es_bvh_exclude(self._handle, indices(array), len(array)))


__all__ = ["BUILDERS", "Blockers", "Bvh", "ClosestPoints", "Hits", "NONE", "Sight"]
