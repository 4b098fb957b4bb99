# SPDX-License-Identifier: MIT
"""Scenes: geometry, materials, sources and listeners."""

from __future__ import annotations

import os
from typing import Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError, Error, UnknownName
from ._library import (
    ALL,
    Messages,
    Object,
    check,
    choice,
    created,
    doubles,
    encoded,
    ffi,
    index_array,
    indices,
    lib,
    messages,
    new_options,
    new_struct,
    number,
    points,
    real_array,
    text,
    vector,
    view,
)
from .materials import BANDS, Material, band_centres
from .names import Names

#: A file name.
Path = Union[str, "os.PathLike[str]"]

_SOURCES, _LISTENERS, _MATERIALS, _MESHES, _TRIANGLES, _VERTICES = range(6)
_KINDS = {_SOURCES: "source", _LISTENERS: "listener", _MATERIALS: "material", _MESHES: "mesh"}


def _names_array(names: Sequence[str | None]) -> tuple[Any, list[Any]]:
    """A C array of texts, and what must live as long."""
    if isinstance(names, (str, bytes)):
        raise ArgumentError(repr(names), "is one name", "give a list of names")
    keep = [ffi.NULL if name is None else ffi.new("char[]", encoded(name)) for name in names]
    return ffi.new("const char *[]", keep), keep


class Scene(Object):
    """Geometry, materials, sources and listeners.

    :func:`load`, :func:`shoebox`, :func:`extrude`, :meth:`from_arrays` and :meth:`from_mesh` make
    one. Metres, +Y up, everywhere.
    """

    @classmethod
    def from_arrays(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        material_of_triangle: npt.ArrayLike | None = None,
        materials: Sequence[str] | None = None,
        mesh_of_triangle: npt.ArrayLike | None = None,
        meshes: Sequence[str] | None = None,
        name: str = "scene",
        up: str = "y",
    ) -> Scene:
        """A scene from arrays, which are copied.

        Parameters
        ----------
        vertices : (n, 3) floats
            Metres.
        triangles : (m, 3) integers
            Vertex indices, counter-clockwise seen from the front.
        material_of_triangle : (m,) integers, optional
            Indices into ``materials``; all 0 if left out.
        materials : sequence of str, optional
            Names; one that is in :func:`earshot.library` has its data.
        mesh_of_triangle : (m,) integers, optional
            Indices into ``meshes``, for contacts; no vertex may be of two.
        up : {'y', 'z'}
            The axis of ``vertices`` that points up.
        """
        corners = _upright(points(vertices, "vertices"), up)
        faces = index_array(triangles, "triangles", 3)
        arrays = new_struct("es_scene_arrays")
        keep: list[Any] = [corners, faces, ffi.new("char[]", encoded(name))]
        arrays.name = keep[-1]
        arrays.vertices, arrays.vertex_count = doubles(corners), len(corners)
        arrays.triangles, arrays.triangle_count = indices(faces), len(faces)
        for kind, of_triangle, names in (
            ("material", material_of_triangle, materials),
            ("mesh", mesh_of_triangle, meshes),
        ):
            if of_triangle is not None:
                column = index_array(of_triangle, f"{kind}_of_triangle")
                if len(column) != len(faces):
                    raise ArgumentError(
                        f"{kind}_of_triangle", f"has {len(column)} entries", f"give {len(faces)}")
                keep.append(column)
                setattr(arrays, f"{kind}_of_triangle", indices(column))
                count = int(column.max()) + 1 if len(column) else 1
                setattr(arrays, f"{kind}_count", count if names is None else len(names))
            if names is not None:
                keep.append(_names_array(names))
                setattr(arrays, f"{kind}_names", keep[-1][0])
                setattr(arrays, f"{kind}_count", len(names))
        return cls(created(lib.es_scene_create, arrays))

    @classmethod
    def from_mesh(cls, mesh: Any, *, material: str | None = None, up: str = "y") -> Scene:
        """A scene from an object with ``vertices`` (n, 3) and ``faces`` (m, 3), as trimesh makes.

        ``material`` names the one material; a mesh whose ``visual.face_materials`` and
        ``visual.material.materials`` tell of several keeps their names.
        """
        visual = getattr(mesh, "visual", None)
        several = getattr(getattr(visual, "material", None), "materials", None)
        of_face = getattr(visual, "face_materials", None)
        if material is None and several is not None and of_face is not None:
            return cls.from_arrays(mesh.vertices, mesh.faces, material_of_triangle=of_face,
                                   materials=[str(m.name) for m in several], up=up)
        return cls.from_arrays(mesh.vertices, mesh.faces, up=up,
                               materials=None if material is None else [material])

    def copy(self) -> Scene:
        """An object of its own with the same contents."""
        return Scene(created(lib.es_scene_copy, self._handle))

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, _memo: Any) -> Scene:
        return self.copy()

    def _change(self, function: Any, *arguments: Any) -> None:
        """A call that changes the scene, while no other thread copies what it holds."""
        with self._lock:
            check(function(self._handle, *arguments))

    # --- What it consists of

    def _count(self, item: int) -> int:
        count = ffi.new("size_t *")
        check(lib.es_scene_count(self._handle, item, count))
        return count[0]

    def _names(self, item: int) -> Names:
        name, names = ffi.new("const char **"), []
        with self._lock:
            for index in range(self._count(item)):
                check(lib.es_scene_item_name(self._handle, item, index, name))
                names.append(text(name[0]))
        return Names(names, _KINDS[item])

    @property
    def name(self) -> str:
        """That of its file, without the folder."""
        name = ffi.new("const char **")
        with self._lock:
            check(lib.es_scene_name(self._handle, name))
            return text(name[0])

    @property
    def sources(self) -> Names:
        """Names of the sources."""
        return self._names(_SOURCES)

    @property
    def listeners(self) -> Names:
        """Names of the listeners."""
        return self._names(_LISTENERS)

    @property
    def materials(self) -> Names:
        """Names of the materials."""
        return self._names(_MATERIALS)

    @property
    def meshes(self) -> Names:
        """Names of the meshes."""
        return self._names(_MESHES)

    @property
    def duration(self) -> float:
        """Seconds of its animation; 0: nothing moves."""
        seconds = ffi.new("double *")
        check(lib.es_scene_duration(self._handle, seconds))
        return seconds[0]

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """Where its vertices are at time 0, (n, 3) metres. Assigning moves them."""
        return self.positions()

    @vertices.setter
    def vertices(self, positions: npt.ArrayLike) -> None:
        array = points(positions, "vertices")
        self._change(lib.es_scene_set_positions, doubles(array), len(array))

    def positions(self, time: float = 0.0) -> npt.NDArray[np.float64]:
        """Where its vertices are at an instant of its animation, (n, 3) metres."""
        array = np.empty((self._count(_VERTICES), 3))
        check(lib.es_scene_positions(self._handle, number(time, "time"), doubles(array),
                                     len(array)))
        return array

    def _columns(self) -> tuple[npt.NDArray[np.uint32], ...]:
        """Copies: the scene may change under a view."""
        pointers = [ffi.new("const uint32_t **") for _ in range(3)]
        count = ffi.new("size_t *")
        with self._lock:
            check(lib.es_scene_triangles(self._handle, *pointers, count))
            shapes = ((count[0], 3), (count[0],), (count[0],))
            return tuple(view(pointer[0], shape, np.uint32, self).copy()
                         for pointer, shape in zip(pointers, shapes))

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """Vertex indices, (m, 3)."""
        return self._columns()[0]

    @property
    def material_of_triangle(self) -> npt.NDArray[np.uint32]:
        """Index of each triangle's material, (m,)."""
        return self._columns()[1]

    @property
    def mesh_of_triangle(self) -> npt.NDArray[np.uint32]:
        """Index of each triangle's mesh, (m,)."""
        return self._columns()[2]

    def extent(self, time: float = 0.0) -> npt.NDArray[np.float64]:
        """Lower and upper corner of the box around it, (2, 3) metres."""
        corners = np.empty((2, 3))
        check(lib.es_scene_extent(self._handle, number(time, "time"),
                                  ffi.from_buffer("double[]", corners[0]),
                                  ffi.from_buffer("double[]", corners[1])))
        return corners

    def warnings(self) -> Messages:
        """What the reader of its file found odd."""
        return messages(created(lib.es_scene_warnings, self._handle))

    def check(self, time: float = 0.0) -> Messages:
        """:meth:`warnings`, and what else makes results doubtful: a size that is not a room's,
        sources or listeners outside or in solids, materials without data."""
        return messages(created(lib.es_scene_check, self._handle, number(time, "time")))

    def __repr__(self) -> str:
        size = ""
        if self._count(_TRIANGLES):
            lower, upper = self.extent()
            size = ", " + " x ".join(f"{side:.3g}" for side in upper - lower) + " m"
        return (f"<Scene {self.name!r}: {self._count(_TRIANGLES)} triangles{size}, "
                f"{self._count(_MATERIALS)} materials, {self._count(_SOURCES)} sources, "
                f"{self._count(_LISTENERS)} listeners>")

    # --- Materials

    def assign(
        self,
        materials: Mapping[str, str | Material | float],
        *,
        default: str | Material | float | None = None,
    ) -> int:
        """Gives acoustic data to materials whose names match shell patterns.

        Parameters
        ----------
        materials : mapping
            From patterns (``"Carpet*"``) to names of :func:`earshot.library`, to
            :class:`Material`, or to an absorption coefficient. The last match counts.
        default : optional
            The same for materials that match none of the patterns.

        Returns
        -------
        int
            The number of matches. A pattern that matches nothing is an error.
        """
        if not isinstance(materials, Mapping):
            raise ArgumentError("materials", f"are {materials!r}",
                                "give a mapping from patterns to materials")
        if default is not None:
            self._assign("*", default)
        matches = 0
        for pattern, material in materials.items():
            found = self._assign(pattern, material)
            if found == 0:
                raise UnknownName(pattern, "matches no material",
                                  f"there are {', '.join(self.materials)}")
            matches += found
        return matches

    def _assign(self, pattern: str, material: str | Material | float) -> int:
        matches, shape = ffi.new("size_t *"), encoded(pattern)
        if isinstance(material, str):
            self._change(lib.es_scene_assign_library, shape, encoded(material), matches)
        else:
            data = material if isinstance(material, Material) else Material(material)
            struct, keep = data._struct()
            self._change(lib.es_scene_assign, shape, struct, matches)
            del keep
        return matches[0]

    def assign_file(self, file: Path) -> None:
        """What a file as ``SCENE.materials.json`` says."""
        self._change(lib.es_scene_assign_file, encoded(os.fspath(file)))

    def coefficients(
        self, name: str = "absorption", bands: str = "octave"
    ) -> npt.NDArray[np.float64]:
        """A coefficient of all materials per band, (materials, bands).

        ``name``: 'absorption', 'scattering' or 'transmission'; bands as :func:`band_centres`.
        """
        kind = choice(name, {"absorption": 0, "scattering": 1, "transmission": 2}, "name")
        values = np.empty((self._count(_MATERIALS), len(band_centres(bands))))
        for index, row in enumerate(values):
            check(lib.es_scene_coefficients(self._handle, index, kind, BANDS[bands],
                                            ffi.from_buffer("double[]", row), len(row)))
        return values

    # --- Sources and listeners

    def add_source(
        self,
        name: str | None,
        position: npt.ArrayLike,
        *,
        directivity: str | None = None,
        look_at: npt.ArrayLike | None = None,
    ) -> int:
        """Adds a source and returns its index.

        ``directivity``: 'omni', 'subcardioid', 'cardioid', 'supercardioid', 'hypercardioid',
        'figure-of-eight' or a .csv file of levels; ``look_at``: the point that it faces.
        """
        index = self._add(_SOURCES, points(position, "position", 1), [name])
        try:
            if directivity is not None:
                self._change(lib.es_scene_set_directivity, index, encoded(directivity))
            if look_at is not None:
                self._look_at(_SOURCES, index, look_at)
        except Error:
            self._change(lib.es_scene_remove, _SOURCES, index)
            raise
        return index

    def add_listener(
        self, name: str | None, position: npt.ArrayLike, *, look_at: npt.ArrayLike | None = None
    ) -> int:
        """Adds a listener, which faces ``look_at``, and returns its index."""
        index = self._add(_LISTENERS, points(position, "position", 1), [name])
        if look_at is not None:
            try:
                self._look_at(_LISTENERS, index, look_at)
            except Error:
                self._change(lib.es_scene_remove, _LISTENERS, index)
                raise
        return index

    def add_sources(
        self, positions: npt.ArrayLike, names: str | Sequence[str] = "source"
    ) -> Names:
        """Adds sources at ``positions``, (n, 3). A single name becomes "name 1", "name 2", ..."""
        return self._add_all(_SOURCES, positions, names)

    def add_listeners(
        self, positions: npt.ArrayLike, names: str | Sequence[str] = "listener"
    ) -> Names:
        """Adds listeners at ``positions``, (n, 3). A single name becomes "name 1", ..."""
        return self._add_all(_LISTENERS, positions, names)

    def _add(self, item: int, array: npt.NDArray[np.float64], names: Sequence[str | None]) -> int:
        first, (pointers, keep) = ffi.new("uint32_t *"), _names_array(names)
        self._change(lib.es_scene_add, item, doubles(array), pointers, len(array), first)
        del keep
        return first[0]

    def _add_all(self, item: int, positions: npt.ArrayLike, names: str | Sequence[str]) -> Names:
        array = points(positions, "positions")
        if isinstance(names, str):
            names = [f"{names} {index + 1}" for index in range(len(array))]
        if len(names) != len(array):
            raise ArgumentError("names", f"has {len(names)} entries", f"give {len(array)}")
        self._add(item, array, names)
        return Names(names, _KINDS[item])

    def remove_source(self, source: str | int) -> None:
        """Takes a source out; those behind it move up."""
        self._change(lib.es_scene_remove, _SOURCES, self.sources.index(source))

    def remove_listener(self, listener: str | int) -> None:
        """Takes a listener out; those behind it move up."""
        self._change(lib.es_scene_remove, _LISTENERS, self.listeners.index(listener))

    def clear_sources(self) -> None:
        """Takes all sources out."""
        self._change(lib.es_scene_remove, _SOURCES, ALL)

    def clear_listeners(self) -> None:
        """Takes all listeners out."""
        self._change(lib.es_scene_remove, _LISTENERS, ALL)

    def move_source(self, source: str | int, position: npt.ArrayLike) -> None:
        """Moves a source to a point, metres."""
        self._change(lib.es_scene_set_position, _SOURCES, self.sources.index(source),
                                        vector(position, "position"))

    def move_listener(self, listener: str | int, position: npt.ArrayLike) -> None:
        """Moves a listener to a point, metres."""
        self._change(lib.es_scene_set_position, _LISTENERS, self.listeners.index(listener),
                                        vector(position, "position"))

    def _look_at(self, item: int, index: int, point: npt.ArrayLike) -> None:
        self._change(lib.es_scene_set_look_at, item, index, vector(point, "look_at"))

    def _positions(self, item: int, time: float) -> npt.NDArray[np.float64]:
        pose, found = ffi.new("es_pose *"), np.empty((self._count(item), 3))
        for index, row in enumerate(found):
            check(lib.es_scene_pose(self._handle, item, index, number(time, "time"), pose))
            row[:] = list(pose.position)
        return found

    def source_positions(self, time: float = 0.0) -> npt.NDArray[np.float64]:
        """Where the sources are, (n, 3) metres."""
        return self._positions(_SOURCES, time)

    def listener_positions(self, time: float = 0.0) -> npt.NDArray[np.float64]:
        """Where the listeners are, (n, 3) metres."""
        return self._positions(_LISTENERS, time)

    def grid(
        self, *, height: float, step: float, clearance: float = 0.3, time: float = 0.0
    ) -> npt.NDArray[np.float64]:
        """Points ``step`` apart in the room, (n, 3) metres, by z, then x.

        They are ``height`` above the lowest point of the scene, at least ``clearance`` from every
        surface, and have surfaces on all six sides.
        """
        from .bvh import Bvh

        (x0, y0, z0), (x1, _, z1) = self.extent(time)
        if not (number(step, "step") > 0.0 and np.isfinite(step)):
            raise ArgumentError("step", f"is {step}", "give metres above 0")
        height, clearance = number(height, "height"), number(clearance, "clearance")
        # Centred, so that a symmetrical room has a symmetrical grid.
        xs, zs = (np.arange(int((b - a) / step) + 1) for a, b in ((x0, x1), (z0, z1)))
        xs = 0.5 * (x0 + x1) + step * (xs - 0.5 * (len(xs) - 1))
        zs = 0.5 * (z0 + z1) + step * (zs - 0.5 * (len(zs) - 1))
        x, z = np.meshgrid(xs, zs)
        found = np.stack([x.ravel(), np.full(x.size, y0 + height), z.ravel()], axis=1)
        bvh = Bvh.of_scene(self, time)
        found = found[bvh.closest_points(found).distance >= clearance]
        for axis in range(3):
            for sign in (1.0, -1.0):
                direction = np.zeros(3)
                direction[axis] = sign
                hits = bvh.closest_hits(found, np.broadcast_to(direction, found.shape))
                found = found[np.isfinite(hits.t)]
        return found

    def plot(self, **options: Any) -> Any:
        """The scene in 3D by matplotlib; see :func:`earshot.plot_scene`."""
        from .plots import plot_scene

        return plot_scene(self, **options)


def _upright(array: npt.NDArray[np.float64], up: str) -> npt.NDArray[np.float64]:
    """Vertices with +Y up."""
    if choice(up, {"y": 0, "z": 1}, "up") == 0:
        return array
    return np.ascontiguousarray(np.stack([array[:, 0], array[:, 2], -array[:, 1]], axis=1))


def load(
    file: Path,
    *,
    units: str | None = None,
    up: str = "y",
    animation: str | None = None,
    allow_outside: bool = False,
    materials: Mapping[str, str | Material | float] | None = None,
) -> Scene:
    """Reads a .gltf, .glb, .obj, .ply, .stl or .off file.

    Parameters
    ----------
    units : {'m', 'cm', 'mm', 'in', 'ft'}, optional
        Unit of a mesh file; glTF is in metres. The scene is in metres.
    up : {'y', 'z'}
        Axis of a mesh file that points up. The scene has +Y up.
    animation : str, optional
        Name or number of a glTF file's animation; the first if left out.
    allow_outside : bool
        Lets a glTF file name files outside of its folder.
    materials : mapping, optional
        As :meth:`Scene.assign` takes.
    """
    options = new_options("es_load_options")
    keep = []
    for name, value in (("units", units), ("animation", animation)):
        if value is not None:
            keep.append(ffi.new("char[]", encoded(value)))
            setattr(options, name, keep[-1])
    options.up = choice(up, {"y": lib.ES_UP_Y, "z": lib.ES_UP_Z}, "up")
    options.allow_outside = int(bool(allow_outside))
    scene = Scene(created(lib.es_scene_load, encoded(os.fspath(file)), options))
    if materials is not None:
        scene.assign(materials)
    return scene


def _furnish(scene: Scene, materials: Any, absorption: Any, scattering: Any) -> Scene:
    """Gives a made room its materials."""
    if absorption is not None or scattering is not None:
        scene._assign("*", Material(0.1 if absorption is None else absorption,
                                    0.1 if scattering is None else scattering))
    if materials is not None:
        scene.assign(materials)
    return scene


def shoebox(
    size: npt.ArrayLike,
    *,
    absorption: Any = None,
    scattering: Any = None,
    materials: Mapping[str, str | Material | float] | None = None,
) -> Scene:
    """A room that is a box from the origin to ``size`` (x, y, z), metres, y upwards.

    Its materials are "floor", "ceiling", "north" (z = 0), "east" (x = size x), "south" and "west".
    ``absorption`` and ``scattering`` (0.1 if left out) are of all of them, ``materials``, as
    :meth:`Scene.assign` takes, of some.
    """
    scene = Scene(created(lib.es_scene_create_shoebox, vector(size, "size")))
    return _furnish(scene, materials, absorption, scattering)


def extrude(
    corners: npt.ArrayLike,
    height: float,
    *,
    absorption: Any = None,
    scattering: Any = None,
    materials: Mapping[str, str | Material | float] | None = None,
) -> Scene:
    """A room of vertical walls on a floor plan.

    Parameters
    ----------
    corners : (n, 2) floats
        x and z of the outline, metres; a polygon that does not touch or cross itself.
    height : float
        Metres; the floor is at y = 0.
    absorption, scattering, materials : optional
        As :func:`shoebox`; the materials are "floor", "ceiling", "wall 0" (from corner 0 to
        corner 1), "wall 1", ...
    """
    outline = real_array(corners, "corners", "(n, 2)")
    if outline.ndim != 2 or outline.shape[1] != 2:
        raise ArgumentError("corners", f"has shape {outline.shape}", "give (n, 2)")
    scene = Scene(created(lib.es_scene_create_extruded, doubles(outline), len(outline),
                          number(height, "height")))
    return _furnish(scene, materials, absorption, scattering)
