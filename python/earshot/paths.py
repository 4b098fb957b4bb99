# SPDX-License-Identifier: MIT
"""Paths of sound as structured arrays."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError, OutOfRange
from ._library import integer

if TYPE_CHECKING:
    from .result import Result

PATH_KINDS = ("direct", "specular", "transmitted", "diffracted")

#: A row of :attr:`Paths.table`, as ``es_path`` of earshot.h.
PATH_TYPE = np.dtype(
    [
        ("source", "u4"),
        ("listener", "u4"),
        ("kind", "i4"),
        ("order", "u4"),
        ("length", "f8"),
        ("delay", "f8"),
        ("departure", "f8", (3,)),
        ("arrival", "f8", (3,)),
        ("first_point", "u8"),
        ("first_interaction", "u8"),
    ],
    align=True,
)


@dataclasses.dataclass(frozen=True)
class Path:
    """One way of sound from a source to a listener."""

    source: str
    listener: str
    kind: str  #: 'direct', 'specular', 'transmitted' or 'diffracted'
    order: int  #: reflections, transmissions and edges
    length: float  #: metres
    delay: float  #: seconds since emission
    points: npt.NDArray[np.float64]  #: (order + 2, 3): source, interactions, listener
    triangles: npt.NDArray[np.uint32]  #: (order,) of the scene
    materials: tuple[str, ...]  #: of each interaction
    pressure: npt.NDArray[np.float64]  #: (bands,) re the source's free field at 1 m
    departure: npt.NDArray[np.float64]  #: (3,) direction of travel at the source
    arrival: npt.NDArray[np.float64]  #: (3,) direction of travel at the listener
    edges: npt.NDArray[np.float64]  #: (edges, 2, 3): ends of the part of each that diffracts


class Paths(Sequence[Path]):
    """Paths of a result, by source, listener, delay, order and triangles.

    ``paths[i]`` is a :class:`Path`; ``paths["talker", "seat"]`` those of a pair; ``paths.table`` a
    structured array of type ``PATH_TYPE``, whose columns are attributes, too: ``paths.delay``.
    Arrays are views that cannot be written to.
    """

    def __init__(
        self, result: Result, arrays: Mapping[str, npt.NDArray[Any]], rows: slice
    ) -> None:
        self._result = result
        self._arrays = arrays
        self._rows = rows

    @property
    def table(self) -> npt.NDArray[Any]:
        """(n,) structured."""
        return self._arrays["paths"][self._rows]

    @property
    def pressure(self) -> npt.NDArray[np.float64]:
        """(n, bands): linear amplitude with spreading, air and directivity, re 1 m."""
        return self._arrays["pressure"][self._rows]

    @property
    def level_db(self) -> npt.NDArray[np.float64]:
        """(n, bands): level of the amplitude, decibels re the source at 1 m."""
        with np.errstate(divide="ignore"):
            return 20.0 * np.log10(np.abs(self.pressure))

    def __getattr__(self, name: str) -> npt.NDArray[Any]:
        if name in PATH_TYPE.names:
            return self.table[name]
        raise AttributeError(f"Paths has no {name}; columns are {', '.join(PATH_TYPE.names)}")

    def __len__(self) -> int:
        return self._rows.stop - self._rows.start

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, tuple):
            pair = self._result._pair(*key)
            first = self._arrays["first_path"]
            begin = max(int(first[pair]), self._rows.start)
            end = min(int(first[pair + 1]), self._rows.stop)
            return Paths(self._result, self._arrays, slice(begin, max(begin, end)))
        if isinstance(key, slice):
            begin, end, step = key.indices(len(self))
            if step != 1:
                raise ArgumentError("slice", f"has the step {step}", "use `.table` for others")
            start = self._rows.start
            return Paths(self._result, self._arrays, slice(start + begin, start + max(begin, end)))
        index = integer(key, "path")
        if not -len(self) <= index < len(self):
            raise OutOfRange("path", f"is {index}", f"there are {len(self)}")
        return self._path(self._rows.start + index % len(self))

    def _path(self, index: int) -> Path:
        row = self._arrays["paths"][index]
        point, interaction, order = (
            int(row[name]) for name in ("first_point", "first_interaction", "order"))
        first_edge = self._arrays["first_edge"]
        interactions = slice(interaction, interaction + order)
        return Path(
            source=self._result.sources[row["source"]],
            listener=self._result.listeners[row["listener"]],
            kind=PATH_KINDS[row["kind"]],
            order=order,
            length=float(row["length"]),
            delay=float(row["delay"]),
            points=self._arrays["points"][point : point + order + 2],
            triangles=self._arrays["triangles"][interactions],
            materials=tuple(
                self._result.materials[i] for i in self._arrays["materials"][interactions]),
            pressure=self._arrays["pressure"][index],
            departure=row["departure"],
            arrival=row["arrival"],
            edges=self._arrays["edges"][int(first_edge[index]) : int(first_edge[index + 1])],
        )

    def __repr__(self) -> str:
        delays = self.delay
        span = f", {delays[0]:.4f} to {delays.max():.4f} s" if len(self) else ""
        return f"<{len(self)} paths{span}>"
