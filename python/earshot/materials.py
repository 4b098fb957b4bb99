# SPDX-License-Identifier: MIT
"""Acoustic data of surfaces."""

from __future__ import annotations

import dataclasses
from typing import Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import check, choice, ffi, lib, new_options, number, text

#: A coefficient: one value, or values by frequency in hertz.
Coefficient = Union[float, Mapping[float, float], Sequence[float]]

BANDS = {"octave": 0, "third": 1}


def band_centres(bands: str = "octave") -> npt.NDArray[np.float64]:
    """Nominal centres of frequency bands, hertz: 10 octaves or 31 thirds of an octave."""
    values, count = ffi.new("const double **"), ffi.new("size_t *")
    check(lib.es_bands_nominal(choice(bands, BANDS, "bands"), values, count))
    return np.array(ffi.unpack(values[0], count[0]))


def _hertz(frequency: Any) -> float:
    """A frequency; the keys of mappings from JSON are texts."""
    try:
        return float(frequency)
    except (TypeError, ValueError):
        raise ArgumentError("frequencies", f"have {frequency!r}", "give hertz") from None


@dataclasses.dataclass(frozen=True)
class Material:
    """How a surface treats sound: energy coefficients, 0 ... 1.

    Parameters
    ----------
    absorption : float, mapping or sequence
        Share of the energy that is not reflected: of all frequencies, or ``{125: 0.1, 1000: 0.3}``,
        or one value per entry of ``frequencies``.
    scattering : float, mapping or sequence
        Share of what is reflected that leaves the specular direction; 0 is a mirror.
    transmission : float, mapping or sequence
        Share of all energy that goes through, a part of ``absorption``.
    frequencies : sequence, optional
        Hertz, of coefficients that are sequences.
    one_sided : bool
        Reflects on the front side only.
    """

    absorption: Coefficient = 0.1
    scattering: Coefficient = 0.1
    transmission: Coefficient = 0.0
    frequencies: Sequence[float] | None = None
    one_sided: bool = False

    def _struct(self) -> tuple[Any, list[Any]]:
        """The C struct and what must live as long."""
        grid = sorted(self._frequencies())
        if grid and not 0.0 < grid[0] <= grid[-1] < np.inf:
            raise ArgumentError("frequencies", f"are {grid}", "give hertz above 0")
        struct, keep = new_options("es_material"), []
        if grid:
            keep.append(ffi.new("double[]", grid))
            struct.frequencies = keep[-1]
            struct.frequency_count = len(grid)
        for name in ("absorption", "scattering", "transmission"):
            keep.append(ffi.new("double[]", self._values(name, grid)))
            setattr(struct, name, keep[-1])
        struct.one_sided = int(self.one_sided)
        return struct, keep

    def _frequencies(self) -> set[float]:
        found = set() if self.frequencies is None else {*map(_hertz, self.frequencies)}
        for name in ("absorption", "scattering", "transmission"):
            value = getattr(self, name)
            if isinstance(value, Mapping):
                found |= {*map(_hertz, value)}
        return found

    def _values(self, name: str, grid: list[float]) -> list[float]:
        """A coefficient at the frequencies of the grid; one value if there are none."""
        value: Any = getattr(self, name)
        if isinstance(value, Mapping):
            known = sorted((_hertz(f), number(v, name)) for f, v in value.items())
        elif np.ndim(value) == 0:
            return [number(value, name)] * max(len(grid), 1)
        else:
            if self.frequencies is None or len(self.frequencies) != len(value):
                raise ArgumentError(
                    name, f"has {len(value)} values", "give as many `frequencies`, or a mapping")
            known = sorted((_hertz(f), number(v, name)) for f, v in zip(self.frequencies, value))
        if not known:
            raise ArgumentError(name, "has no value", "give at least one")
        # As the library does between its points: linear over the logarithm of frequency.
        at, values = zip(*known)
        if list(at) == grid:
            return list(values)
        return np.interp(np.log(grid), np.log(at), values).tolist()


@dataclasses.dataclass(frozen=True, repr=False)
class LibraryMaterial:
    """A material of the built-in library, per octave of :func:`band_centres`."""

    name: str
    description: str
    source: str
    absorption: npt.NDArray[np.float64]
    scattering: npt.NDArray[np.float64]
    transmission: npt.NDArray[np.float64]

    def __repr__(self) -> str:
        return f"<LibraryMaterial {self.name!r}: {self.description}>"


def library(bands: str = "octave") -> dict[str, LibraryMaterial]:
    """The built-in library of materials by name; see ``earshot materials``."""
    kind, count = choice(bands, BANDS, "bands"), len(band_centres(bands))
    found = {}
    fields = [ffi.new("const char **") for _ in range(3)]
    for index in range(lib.es_library_count()):
        check(lib.es_library_get(index, *fields))
        coefficients = []
        for coefficient in range(3):
            values = np.empty(count)
            check(lib.es_library_coefficients(
                index, coefficient, kind, ffi.from_buffer("double[]", values), count))
            coefficients.append(values)
        name, description, source = (text(field[0]) for field in fields)
        found[name] = LibraryMaterial(name, description, source, *coefficients)
    return found
