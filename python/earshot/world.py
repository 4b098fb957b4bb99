# SPDX-License-Identifier: MIT
"""Worlds: contacts and distances of meshes that move."""

from __future__ import annotations

import dataclasses
from typing import Any, Iterator, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError, Error, UnknownName
from ._library import (
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
    number,
    points,
    text,
    vector,
    view,
)
from .scene import Scene

CONTACT_KINDS = ("vertex_face", "edge_edge", "triangle_triangle")

_ELEMENT_TYPE = np.dtype(
    [("mesh", "u4"), ("vertex_count", "u4"), ("vertices", "u4", (3,))], align=True)

#: A row of :attr:`Contacts.table`, as ``es_contact`` of earshot.h.
CONTACT_TYPE = np.dtype(
    [
        ("kind", "i4"),
        ("reserved", "u4"),
        ("a", _ELEMENT_TYPE),
        ("b", _ELEMENT_TYPE),
        ("toi", "f8"),
        ("point", "f8", (3,)),
        ("normal", "f8", (3,)),
    ],
    align=True,
)

#: A mesh by its number, its name or what :meth:`World.add` returned.
MeshLike = Union[int, str, "MeshInWorld"]


@dataclasses.dataclass(frozen=True)
class MeshInWorld:
    """A mesh of a world."""

    index: int
    name: str

    def __index__(self) -> int:
        return self.index


@dataclasses.dataclass(frozen=True)
class Element:
    """A vertex, an edge or a face of a mesh."""

    mesh: int
    name: str  #: of the mesh
    vertices: tuple[int, ...]  #: 1, 2 or 3, ascending


@dataclasses.dataclass(frozen=True, eq=False)
class Contact:
    """Two elements in contact."""

    kind: str  #: 'vertex_face', 'edge_edge' or 'triangle_triangle'
    a: Element
    b: Element
    toi: float  #: within the step, 0 ... 1, never later than the true time of impact
    point: npt.NDArray[np.float64]  #: (3,) metres, on a at that time
    normal: npt.NDArray[np.float64]  #: (3,) unit, towards a; 0 if there is none


class Contacts(Sequence[Contact]):
    """Contacts sorted by time, kind and elements; ``contacts.table`` is a structured array of type
    ``CONTACT_TYPE``, a view that cannot be written to."""

    def __init__(self, table: npt.NDArray[Any], names: Sequence[str]) -> None:
        self.table = table
        self._names = names

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return Contacts(self.table[key], self._names)
        return _contact(self.table[key], self._names)

    def __iter__(self) -> Iterator[Contact]:
        return (_contact(row, self._names) for row in self.table)

    def where(self, mesh: MeshLike) -> Contacts:
        """Those of a mesh."""
        if isinstance(mesh, str) and mesh not in self._names:
            raise UnknownName(mesh, "there is no such mesh", f"there are {', '.join(self._names)}")
        index = self._names.index(mesh) if isinstance(mesh, str) else integer(mesh, "mesh")
        chosen = (self.table["a"]["mesh"] == index) | (self.table["b"]["mesh"] == index)
        return Contacts(self.table[chosen], self._names)

    def __repr__(self) -> str:
        first = f", the first at {self.table['toi'][0]:.6g}" if len(self) else ""
        return f"<{len(self)} contacts{first}>"


def _element(row: Any, names: Sequence[str]) -> Element:
    vertices = tuple(int(v) for v in row["vertices"][: row["vertex_count"]])
    return Element(int(row["mesh"]), names[row["mesh"]], vertices)


def _contact(row: Any, names: Sequence[str]) -> Contact:
    return Contact(CONTACT_KINDS[row["kind"]], _element(row["a"], names), _element(row["b"], names),
                   float(row["toi"]), row["point"], row["normal"])


@dataclasses.dataclass(frozen=True, eq=False)
class Distance:
    """How far apart the surfaces of two meshes are."""

    distance: float  #: metres; 0: they intersect
    triangle_a: int  #: the closest triangles within their meshes; ``earshot.NONE`` if there are none
    triangle_b: int
    on_a: npt.NDArray[np.float64]  #: (3,) closest points, metres
    on_b: npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True, eq=False)
class Depth:
    """How deep two meshes of convex solids are in each other."""

    depth: float  #: metres
    move: npt.NDArray[np.float64]  #: (3,) of a, after which the solids only touch
    part_a: int  #: which solid of each mesh
    part_b: int


class World(Object):
    """Meshes that move in steps, and when they touch. No contact is ever missed.

    >>> import earshot as es, numpy as np
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]], float), [[0, 1, 2]]
    >>> world = es.World()
    >>> floor = world.add("floor", *triangle)
    >>> tip = world.add("tip", [[.2, 1, .2], [.3, 2, .2], [.2, 2, .3]], [[0, 1, 2]])
    >>> begin = np.array([[.2, 1, .2], [.3, 2, .2], [.2, 2, .3]])
    >>> world.step(tip, begin, begin - [0, 2, 0])
    >>> round(world.first_contact().toi, 9)
    0.5
    """

    def __init__(self) -> None:
        super().__init__(created(lib.es_world_create))
        self._names: list[str] = []

    def add(
        self, name: str, vertices: Any, triangles: npt.ArrayLike | None = None
    ) -> MeshInWorld:
        """Adds a mesh at rest: vertices (n, 3) metres and triangles (m, 3), or an object with
        ``vertices`` and ``faces``."""
        if triangles is None:
            if not hasattr(vertices, "faces"):
                raise ArgumentError("triangles", "is left out", "give (m, 3) vertex indices")
            vertices, triangles = vertices.vertices, vertices.faces
        corners, faces = points(vertices, "vertices"), index_array(triangles, "triangles", 3)
        mesh = ffi.new("uint32_t *")
        with self._lock:
            check(lib.es_world_add_mesh(self._handle, encoded(name), doubles(corners), len(corners),
                                        indices(faces), len(faces), mesh))
            self._read_names()
        return MeshInWorld(mesh[0], self._names[mesh[0]])

    def add_scene(self, scene: Scene, *, weld: bool = True) -> list[MeshInWorld]:
        """Adds all meshes of a scene, which :meth:`set_time_step` moves. ``weld``: vertices of a
        mesh that are at one position at all times are one."""
        first = ffi.new("uint32_t *")
        with self._lock:
            check(lib.es_world_add_scene(
                self._handle, handle_of(scene, Scene, "scene"), int(bool(weld)), first))
            self._read_names()
            return [MeshInWorld(i, self._names[i]) for i in range(first[0], len(self._names))]

    def _read_names(self) -> None:
        count, name = ffi.new("size_t *"), ffi.new("const char **")
        check(lib.es_world_mesh_count(self._handle, count))
        for index in range(len(self._names), count[0]):
            check(lib.es_world_mesh_name(self._handle, index, name))
            self._names.append(text(name[0]))

    def _mesh(self, mesh: MeshLike) -> int:
        if isinstance(mesh, str):
            if mesh not in self._names:
                raise UnknownName(mesh, "there is no such mesh",
                                  f"there are {', '.join(self._names)}")
            return self._names.index(mesh)
        return integer(mesh, "mesh", 0, 2**32 - 1)

    @property
    def meshes(self) -> list[MeshInWorld]:
        """All meshes, those that were removed too."""
        return [MeshInWorld(index, name) for index, name in enumerate(self._names)]

    def remove(self, mesh: MeshLike) -> None:
        """Takes a mesh out; others keep their numbers."""
        check(lib.es_world_remove_mesh(self._handle, self._mesh(mesh)))

    def step(
        self, mesh: MeshLike, begin: npt.ArrayLike, end: npt.ArrayLike | None = None
    ) -> None:
        """In the next step the mesh's vertices move on straight lines from ``begin`` to ``end``,
        (n, 3) each; without ``end`` it rests there. A mesh that is not told again keeps its step."""
        start = points(begin, "begin")
        stop = None if end is None else points(end, "end", len(start))
        check(lib.es_world_step_mesh(self._handle, self._mesh(mesh), doubles(start),
                                     ffi.NULL if stop is None else doubles(stop), len(start)))

    def step_screw(
        self,
        mesh: MeshLike,
        begin: npt.ArrayLike,
        *,
        point: npt.ArrayLike,
        axis: npt.ArrayLike,
        angle: float,
        slide: float = 0.0,
    ) -> None:
        """The same on a screw: from ``begin`` the mesh turns by ``angle`` radians about the axis
        through ``point`` along ``axis``, and slides along it by ``slide`` metres."""
        start = points(begin, "begin")
        check(lib.es_world_step_screw(
            self._handle, self._mesh(mesh), doubles(start), len(start), vector(point, "point"),
            vector(axis, "axis"), number(angle, "angle"), number(slide, "slide")))

    def set_time_step(self, begin: float, end: float, *, rigid: bool = False) -> None:
        """The meshes of the scene move from where they are at ``begin`` to ``end``, seconds of its
        animation; ``rigid``: those that follow a node turn with it."""
        check(lib.es_world_set_time_step(self._handle, number(begin, "begin"), number(end, "end"),
                                         int(bool(rigid))))

    def _options(
        self,
        self_contacts: bool = False,
        moving_only: bool = False,
        min_separation: float = 0.0,
        tolerance: float | None = None,
        pairs: Sequence[tuple[MeshLike, MeshLike]] | None = None,
        threads: int = 1,
    ) -> tuple[Any, Any]:
        options = new_options("es_contact_options")
        options.within_meshes = int(bool(self_contacts))
        options.moving_only = int(bool(moving_only))
        options.min_separation = number(min_separation, "min_separation")
        if tolerance is not None:
            options.tolerance = number(tolerance, "tolerance")
        options.threads = integer(threads, "threads")
        keep = None
        if pairs is not None:
            try:
                numbers = [[self._mesh(a), self._mesh(b)] for a, b in pairs]
            except (TypeError, ValueError) as error:
                if isinstance(error, Error):
                    raise
                raise ArgumentError("pairs", f"are {pairs!r}", "give pairs of meshes") from None
            keep = np.array(numbers, np.uint32).reshape(-1, 2)
            options.pairs, options.pair_count = indices(keep), len(keep)
        return options, keep

    def contacts(self, **options: Any) -> Contacts:
        """All contacts of the step.

        Parameters (by name)
        ----------
        self_contacts : bool
            Also of a mesh with itself (False).
        moving_only : bool
            Of pairs of which one moves (False).
        min_separation : float
            Elements this close along every axis touch, metres (0: exact).
        pairs : list of pairs of meshes
            Those that are tested; left out: all.
        threads : int
            0: one per core; changes no result (1).
        """
        return self._found(lib.es_world_contacts, options)

    def intersections(self, **options: Any) -> Contacts:
        """All pairs of triangles that intersect at the beginning of the step."""
        return self._found(lib.es_world_intersections, options)

    def _found(self, function: Any, options: dict[str, Any]) -> Contacts:
        struct, keep = self._options(**options)
        owner = Object(created(function, self._handle, struct))
        del keep
        array, count = ffi.new("const es_contact **"), ffi.new("size_t *")
        check(lib.es_contacts_get(owner._handle, array, count))
        return Contacts(view(array[0], (count[0],), CONTACT_TYPE, owner), tuple(self._names))

    def first_contact(self, **options: Any) -> Contact | None:
        """The first of :meth:`contacts`, in less time; None if there is none."""
        struct, keep = self._options(**options)
        contact, found = ffi.new("es_contact *"), ffi.new("int32_t *")
        check(lib.es_world_first_contact(self._handle, struct, contact, found))
        del keep
        if not found[0]:
            return None
        row = np.frombuffer(ffi.buffer(contact), CONTACT_TYPE)[0].copy()
        return _contact(row, tuple(self._names))

    def distance(self, a: MeshLike, b: MeshLike, *, threads: int = 1) -> Distance:
        """Of two meshes at the beginning of the step."""
        found = ffi.new("es_distance *")
        check(lib.es_world_distance(self._handle, self._mesh(a), self._mesh(b),
                                    integer(threads, "threads"), found))
        return Distance(found.distance, found.triangle_a, found.triangle_b,
                        np.array(list(found.on_a)), np.array(list(found.on_b)))

    def depth(self, a: MeshLike, b: MeshLike) -> Depth | None:
        """How deep two meshes of convex solids, or the solids of one, are in each other at the
        beginning of the step; None if none overlap."""
        found = ffi.new("es_depth *")
        check(lib.es_world_depth(self._handle, self._mesh(a), self._mesh(b), found))
        if not found.overlap:
            return None
        return Depth(found.depth, np.array(list(found.move)), found.part_a, found.part_b)

    def __repr__(self) -> str:
        shown = ", ".join(self._names[:5]) + (", ..." if len(self._names) > 5 else "")
        return f"<World: {len(self._names)} meshes: {shown}>"
