# SPDX-License-Identifier: MIT
"""Checks: what a model needs before its results are trusted, and mended copies."""

from __future__ import annotations

import dataclasses
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from ._library import (
    NONE,
    Object,
    check as must,
    created,
    encoded,
    ffi,
    integer,
    lib,
    new_options,
    new_struct,
    number,
    text,
    told_array,
)
from ._progress import Progress, run_long
from .scene import Scene

_SEVERITIES = ("note", "questionable", "unusable")
_VERDICTS = ("clean", "questionable", "unusable")
_FAULTS = ("in solid", "outside", "sealed")
_ORIGINS = ("none", "by name", "library", "stated")


@dataclasses.dataclass(frozen=True)
class Finding:
    """A sentence about a model."""

    severity: str  #: 'note', 'questionable' or 'unusable'
    text: str


@dataclasses.dataclass(frozen=True)
class Leak:
    """An opening between the air of the sources and what is no part of it."""

    centre: npt.NDArray[np.float64]  #: (3,) metres, of the box around it
    size: npt.NDArray[np.float64]  #: (3,) metres
    area: float  #: square metres that leak
    escapes: bool  #: out of the scene; else into a solid or another air
    hole: int | None  #: index into ``holes``; None: a gap between borders


@dataclasses.dataclass(frozen=True)
class Hole:
    """A loop of edges that belong to one triangle."""

    centre: npt.NDArray[np.float64]  #: (3,) metres
    size: npt.NDArray[np.float64]  #: (3,) metres
    area: float  #: square metres
    rim_length: float  #: metres
    edges: int
    outline: bool  #: the border of a sheet


@dataclasses.dataclass(frozen=True)
class Misplaced:
    """A source or a listener at a place where it is of no use."""

    kind: str  #: 'source' or 'listener'
    name: str
    position: npt.NDArray[np.float64]  #: (3,) metres
    fault: str  #: 'in solid', 'outside' or 'sealed'
    proven: bool  #: by a closed surface; else by rays


@dataclasses.dataclass(frozen=True)
class FaceGroup:
    """Connected triangles with the same fault."""

    centre: npt.NDArray[np.float64]  #: (3,) metres
    size: npt.NDArray[np.float64]  #: (3,) metres
    area: float  #: square metres
    triangles: int  #: how many
    first_triangle: int
    reversed: bool  #: of doubled ones: the copy faces the other way


@dataclasses.dataclass(frozen=True)
class MaterialUse:
    """The part of a material in the surface of the air."""

    origin: str  #: of its data: 'none', 'by name' (a guess), 'library' or 'stated'
    area: float  #: square metres
    absorption_share: float  #: of the absorbed energy, mean of 500 Hz and 1 kHz
    doubts: tuple[str, ...]  #: 'absorbs the same', ...


@dataclasses.dataclass(frozen=True)
class SmallFacets:
    """Facets whose largest extent is below half a wavelength: they do not reflect like mirrors."""

    frequency: float  #: hertz
    half_wavelength: float  #: metres
    facets: int
    area: float  #: square metres
    area_share: float  #: of all facets


def _box(place: Any) -> dict[str, Any]:
    return {"centre": np.array(list(place.centre)), "size": np.array(list(place.size)),
            "area": place.area}


class _Lists(Object):
    """An object whose functions give arrays."""

    def _records(self, function: Any, kind: str, *arguments: Any) -> list[Any]:
        array, count = ffi.new(f"const {kind} **"), ffi.new("size_t *")
        must(function(self._handle, *arguments, array, count))
        return [array[0][index] for index in range(count[0])]

    def _numbers(self, function: Any, which: int) -> npt.NDArray[np.uint32]:
        return told_array(self, function, which, dtype=np.uint32)


class Mending(_Lists):
    """A mended copy of a scene, and what was done, as :meth:`ModelCheck.mend` gives it. Triangles are
    numbers of the scene that was checked."""

    def __init__(self, handle: int) -> None:
        super().__init__(handle)
        info = new_struct("es_mending_info")
        must(lib.es_mending_get_info(handle, info))
        self.welded_vertices: int = info.welded_vertices
        self.filled_holes: int = info.filled_holes
        self.added_triangles: int = info.added_triangles  #: that fill them
        self.max_rounding: float = info.max_rounding  #: metres, of coordinates in a .glb file
        numbers = lib.es_mending_triangles
        #: Removed: without an area; copies of others; proved to be out of reach.
        self.degenerate = self._numbers(numbers, lib.ES_REMOVED_DEGENERATE)
        self.doubled = self._numbers(numbers, lib.ES_REMOVED_DOUBLED)
        self.unreached = self._numbers(numbers, lib.ES_REMOVED_UNREACHED)
        #: Kept: rays did not reach them, but nothing proves that none can.
        self.kept_unreached = self._numbers(numbers, lib.ES_KEPT_UNREACHED)
        self.turned = self._numbers(numbers, lib.ES_TURNED)  #: their fronts now face the air

    def scene(self) -> Scene:
        """The mended copy as a scene."""
        return Scene(created(lib.es_mending_scene, self._handle))

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the mended copy as a .glb file, as ``earshot check --fix`` does."""
        must(lib.es_mending_write(self._handle, encoded(os.fspath(file))))

    def __repr__(self) -> str:
        removed = len(self.degenerate) + len(self.doubled) + len(self.unreached)
        return (f"<Mending: {removed} triangles removed, {len(self.turned)} turned, "
                f"{self.filled_holes} holes filled>")


class ModelCheck(_Lists):
    """What a model needs before its results are trusted, as :func:`earshot.check` gives it."""

    def __init__(self, handle: int, scene: Scene) -> None:
        super().__init__(handle)
        info = new_struct("es_check_info")
        must(lib.es_check_get_info(handle, info))
        self.verdict: str = _VERDICTS[info.verdict]  #: 'clean', 'questionable' or 'unusable'
        self.outdoors: bool = info.outdoors == 1  #: the size is judged as that of a place outdoors
        self.open: bool = info.open == 1  #: the air goes on beyond the scene
        self.rays: int = info.rays  #: that looked for the air
        self.extent = np.array([list(info.lower), list(info.upper)])  #: (2, 3) metres
        self.volume: float = info.volume  #: of the largest air, cubic metres; 0: unknown
        self.surface: float = info.surface  #: square metres
        #: The unit, and the axis that is up, which would make the model plausible; '': none.
        self.proposed_unit, self.proposed_up = text(info.unit), text(info.up)
        self.findings = tuple(self._finding(index) for index in range(info.findings))
        #: (volume, surface) per air, cubic and square metres; 0: unknown.
        self.airs = [(air.volume, air.surface)
                     for air in self._records(lib.es_check_airs, "es_air")]
        #: The index of the air of each source and of each listener.
        self.air_of_sources = self._numbers(lib.es_check_air_of, lib.ES_SOURCES)
        self.air_of_listeners = self._numbers(lib.es_check_air_of, lib.ES_LISTENERS)
        self.leaks = [Leak(**_box(leak.place), escapes=leak.escapes == 1,
                           hole=None if leak.hole == NONE else leak.hole)
                      for leak in self._records(lib.es_check_leaks, "es_leak")]
        self.holes = [Hole(**_box(hole.place), rim_length=hole.rim_length, edges=hole.edges,
                           outline=hole.is_outline == 1)
                      for hole in self._records(lib.es_check_holes, "es_hole")]
        emitters = (tuple(scene.sources), tuple(scene.listeners))
        self.misplaced = [Misplaced(("source", "listener")[it.item], emitters[it.item][it.index],
                                    np.array(list(it.position)), _FAULTS[it.fault], it.proven == 1)
                          for it in self._records(lib.es_check_misplaced, "es_misplaced")]
        self.reversed = self._faces(lib.ES_REVERSED)  #: groups that show only their backs to the air
        self.doubled = self._faces(lib.ES_DOUBLED)
        #: By the names of the materials.
        self.materials = {
            name: MaterialUse(_ORIGINS[use.origin], use.area, use.absorption_share,
                              tuple(filter(None, text(use.doubts).split(", "))))
            for name, use in zip(scene.materials,
                                 self._records(lib.es_check_materials, "es_material_use"))}
        self.small_facets = [SmallFacets(it.frequency, it.half_wavelength, it.facets, it.area,
                                         it.area_share)
                             for it in self._records(lib.es_check_small_facets, "es_small_facets")]
        #: Seconds by order, as far as a forecast was asked for.
        self.seconds = {cost.order: cost.seconds
                        for cost in self._records(lib.es_check_costs, "es_order_cost")}

    def _finding(self, index: int) -> Finding:
        severity, sentence = ffi.new("int32_t *"), ffi.new("const char **")
        must(lib.es_check_finding(self._handle, index, severity, sentence))
        return Finding(_SEVERITIES[severity[0]], text(sentence[0]))

    def _faces(self, fault: int) -> list[FaceGroup]:
        return [FaceGroup(**_box(group.place), triangles=group.triangles,
                          first_triangle=group.first_triangle, reversed=group.is_reversed == 1)
                for group in self._records(lib.es_check_faces, "es_face_group", fault)]

    @property
    def unreached(self) -> npt.NDArray[np.uint32]:
        """(n,) triangles of which rays reached neither side, ascending."""
        return self._numbers(lib.es_check_triangles, lib.ES_UNREACHED)

    @property
    def proven_unreached(self) -> npt.NDArray[np.uint32]:
        """(n,) those of them that a closed surface keeps from all sources and listeners."""
        return self._numbers(lib.es_check_triangles, lib.ES_PROVEN_UNREACHED)

    @property
    def reversed_triangles(self) -> npt.NDArray[np.uint32]:
        """(n,) triangles that show only their backs to the air, ascending."""
        return self._numbers(lib.es_check_triangles, lib.ES_REVERSED_TRIANGLES)

    def mend(self, *, max_hole_area: float = 0.05, freeze: bool = False) -> Mending:
        """A mended copy of the scene that was checked: equal vertices become one, fronts turn to the
        air, holes of up to ``max_hole_area`` square metres are filled, triangles without area,
        doubled ones and those proved to be out of reach go. A scene that moves is refused, unless
        ``freeze``: then the copy is at rest, as the scene is at the time of the check."""
        options = new_options("es_mend_options")
        options.max_hole_area = number(max_hole_area, "max_hole_area")
        options.freeze = int(bool(freeze))
        return Mending(created(lib.es_mending_create, self._handle, options))

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a .json file, the report of ``earshot check --json``."""
        must(lib.es_check_write(self._handle, encoded(os.fspath(file))))

    def __str__(self) -> str:
        lines = [f"{finding.severity:13}{finding.text}" for finding in self.findings]
        return "\n".join([self.verdict, *lines])

    def __repr__(self) -> str:
        return f"<ModelCheck: {self.verdict}, {len(self.findings)} findings>"


def check(
    scene: Scene,
    *,
    time: float = 0.0,
    seed: int = 1,
    rays: int = 20_000_000,
    crack: float = 0.01,
    forecast: float = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> ModelCheck:
    """Examines a scene as ``earshot check`` does: unit and up axis, leaks, misplaced sources and
    listeners, reversed and doubled faces, materials without data. :meth:`Scene.check` gives a few
    warnings in less time.

    Parameters (all but ``scene`` by name)
    ----------
    time : float
        Instant of the scene's animation, seconds.
    seed : int
        Of random numbers.
    rays : int
        At most so many look for the air.
    crack : float
        Share of a room's surface below which an opening into a solid counts as a crack.
    forecast : float
        Seconds to spend on the forecast of time, ``seconds``; 0: none.
    threads, progress
        As in :func:`earshot.simulate`.

    Examples
    --------
    >>> import earshot as es
    >>> room = es.shoebox((5, 2.7, 4), absorption={500: 0.2, 1000: 0.3})
    >>> _ = room.add_source("talker", (1, 1.5, 1))
    >>> _ = room.add_listener("seat", (9, 1.2, 3))
    >>> found = es.check(room)
    >>> found.verdict
    'unusable'
    >>> found.misplaced[1].name, found.misplaced[1].fault
    ('seat', 'outside')
    """
    options = new_options("es_check_options")
    options.time = number(time, "time")
    options.seed = integer(seed, "seed", 0, 2**63 - 1)
    options.rays = integer(rays, "rays", 0, 2**63 - 1)
    options.crack = number(crack, "crack")
    options.forecast_seconds = number(forecast, "forecast")
    options.threads = integer(threads, "threads")

    def work(callback: Any) -> int:
        options.progress = callback
        return created(lib.es_check_create, scene._handle, options)

    return ModelCheck(run_long(work, progress), scene)
