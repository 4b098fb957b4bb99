# SPDX-License-Identifier: MIT
"""Names of what a scene holds, in order."""

from __future__ import annotations

from typing import Any, Iterator, Sequence

import numpy as np
import numpy.typing as npt

from ._errors import UnknownName
from ._library import integer


class Names(Sequence[str]):
    """Names of a scene's sources, listeners, materials or meshes, in order.

    ``names[i]`` is a name, ``names.index(name)`` its index, ``name in names`` whether there is one.
    """

    def __init__(self, names: Sequence[str], kind: str) -> None:
        self._names = tuple(names)
        self._kind = kind
        self._index = {name: index for index, name in reversed(list(enumerate(names)))}

    def __len__(self) -> int:
        return len(self._names)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __getitem__(self, index: Any) -> Any:
        return self._names[index]

    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[Any]:
        return np.array(self._names, dtype=dtype)

    def __contains__(self, name: object) -> bool:
        return name in self._index

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, Sequence) else NotImplemented

    def index(self, name: Any, *_limits: Any) -> int:  # type: ignore[override]
        """The index of a name, or of an index itself (counted from the end if negative)."""
        if isinstance(name, str):
            if name not in self._index:
                known = ", ".join(self._names[:8]) + (", ..." if len(self) > 8 else "")
                raise UnknownName(
                    name, f"there is no such {self._kind}",
                    f"there are {known}" if known else f"there is no {self._kind} at all")
            return self._index[name]
        index = integer(name, self._kind)
        if not -len(self) <= index < len(self):
            raise UnknownName(str(index), f"there is no such {self._kind}",
                              f"there are {len(self)}")
        return index % len(self)

    def __repr__(self) -> str:
        return repr(list(self._names))
