# SPDX-License-Identifier: MIT
"""libearshot.so: calls, handles and views of its arrays."""

from __future__ import annotations

import pathlib
import weakref
from typing import Any

import numpy as np
import numpy.typing as npt

from ._bindings import ffi
from ._errors import ArgumentError, Cancelled, Error, OutOfMemory, OutOfRange

_SONAME = "libearshot.so.0"


def _open() -> Any:
    """The library that the package carries, or else the system's."""
    carried = pathlib.Path(__file__).with_name(_SONAME)
    # Its threads may outlive the interpreter's modules, so it is never unloaded.
    flags = ffi.RTLD_NOW | ffi.RTLD_NODELETE
    try:
        return ffi.dlopen(str(carried) if carried.exists() else _SONAME, flags)
    except OSError as error:
        raise ImportError(f"{_SONAME} cannot be loaded ({error}); reinstall the package") from None


lib = _open()

#: An index of nothing, and one that stands for all.
NONE = ALL = 0xFFFFFFFF

_ERRORS: dict[int, type[Error]] = {
    lib.ES_ERROR_ARGUMENT: ArgumentError,
    lib.ES_ERROR_INDEX: OutOfRange,
    lib.ES_ERROR_CANCELLED: Cancelled,
    lib.ES_ERROR_OUT_OF_MEMORY: OutOfMemory,
}


def text(pointer: Any) -> str:
    """A text of the library."""
    return ffi.string(pointer).decode()


def check(status: int) -> None:
    """Raises what the status of this thread's last call says."""
    if status != lib.ES_OK:
        raise _ERRORS.get(status, Error)(
            text(lib.es_error_subject()),
            text(lib.es_error_problem()),
            text(lib.es_error_remedy()),
            text(lib.es_status_name(status)),
        )


def new_struct(name: str) -> Any:
    """A struct of the library, all members at nothing but its size."""
    struct = ffi.new(f"{name} *")
    struct.struct_size = ffi.sizeof(name)
    return struct


def new_options(name: str) -> Any:
    """A struct of the library with its defaults."""
    struct = ffi.new(f"{name} *")
    check(getattr(lib, f"{name}_init")(struct, ffi.sizeof(name)))
    return struct


def encoded(string: Any) -> bytes:
    """A text or a path for the library."""
    if isinstance(string, (str, bytes, pathlib.PurePath)):
        data = bytes(string) if isinstance(string, (bytes, pathlib.PurePath)) else string.encode()
    else:
        data = str(string).encode()
    if b"\0" in data:
        raise ArgumentError(repr(string), "holds a zero byte", "leave it out")
    return data


class _Owner:
    """Keeps an object of the library until the last one lets go: of Python's object and all arrays
    that show its memory. The end of the process ends what is left."""

    def __init__(self, handle: int) -> None:
        weakref.finalize(self, lib.es_release, handle).atexit = False


class Object:
    """An object of the library, which ends with this one and its arrays."""

    def __init__(self, handle: int) -> None:
        self._handle = handle
        self._owner = _Owner(handle)


def created(function: Any, *arguments: Any) -> int:
    """The handle that a function gives by its last argument."""
    handle = ffi.new("uint64_t *")
    check(function(*arguments, handle))
    return handle[0]


class _View:
    """Memory of the library, kept while an array shows it."""

    def __init__(self, address: int, shape: tuple[int, ...], dtype: np.dtype, owner: Any) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "version": 3,
            "data": (address, True),
            "shape": shape,
            "typestr": dtype.str,
            "descr": dtype.descr,
        }


def view(pointer: Any, shape: tuple[int, ...], dtype: Any, owner: Object) -> npt.NDArray[Any]:
    """An array over memory of an object, without a copy. It cannot be written to."""
    kind = np.dtype(dtype)
    if pointer == ffi.NULL or 0 in shape:
        return np.zeros(shape, kind)
    if kind.fields is None:
        return np.asarray(_View(int(ffi.cast("uintptr_t", pointer)), shape, kind, owner._owner))
    # A structured type keeps its offsets in a view of bytes.
    size = int(np.prod(shape)) * kind.itemsize
    byte = np.dtype("u1")
    flat = np.asarray(_View(int(ffi.cast("uintptr_t", pointer)), (size,), byte, owner._owner))
    return flat.view(kind).reshape(shape)


def points(values: npt.ArrayLike, name: str, count: int | None = None) -> npt.NDArray[np.float64]:
    """Points as (n, 3) doubles; a single point becomes (1, 3)."""
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(name, f"is not an array of numbers ({error})", "give (n, 3)") from None
    if array.shape == (3,):
        array = array.reshape(1, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(name, f"has shape {array.shape}", "give points as (n, 3)")
    if count is not None and array.shape[0] != count:
        raise ArgumentError(name, f"has {array.shape[0]} points", f"give {count}")
    return array


def vector(values: npt.ArrayLike, name: str) -> Any:
    """One point or direction as three doubles."""
    array = points(values, name, 1)
    return ffi.new("double[3]", array[0].tolist())


def index_array(values: npt.ArrayLike, name: str, columns: int = 0) -> npt.NDArray[np.uint32]:
    """Indices as (n,) or (n, columns) of 32 bits."""
    given = np.asarray(values)
    if given.size == 0:
        given = given.astype(np.uint32)
    if given.dtype.kind not in "ui":
        raise ArgumentError(name, f"has numbers of type {given.dtype}", "give integers")
    if given.dtype != np.uint32 and ((given < 0) | (given > 0xFFFFFFFF)).any():
        raise OutOfRange(name, "has an index that is no number of 32 bits", "count from 0")
    array = np.ascontiguousarray(given, dtype=np.uint32)
    if columns and array.size == 0:
        array = array.reshape(0, columns)
    if array.ndim != (2 if columns else 1) or (columns and array.shape[1] != columns):
        wanted = f"(n, {columns})" if columns else "(n,)"
        raise ArgumentError(name, f"has shape {array.shape}", f"give {wanted}")
    return array


def doubles(array: npt.NDArray[np.float64]) -> Any:
    """A pointer to an array's numbers; the array must live as long."""
    return ffi.from_buffer("double[]", array) if array.size else ffi.new("double[1]")


def indices(array: npt.NDArray[np.uint32]) -> Any:
    """A pointer to an array's indices; the array must live as long."""
    return ffi.from_buffer("uint32_t[]", array) if array.size else ffi.new("uint32_t[1]")


def integer(value: Any, name: str, low: int = -(2**31), high: int = 2**31 - 1) -> int:
    """A whole number that C can hold."""
    try:
        number = value.__index__()
    except AttributeError:
        raise ArgumentError(name, f"is {value!r}", "give a whole number") from None
    if not low <= number <= high:
        raise ArgumentError(name, f"is {number}", f"give {low} to {high}")
    return number


def number(value: Any, name: str) -> float:
    """A number that C can hold."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ArgumentError(name, f"is {value!r}", "give a number") from None


def choice(value: str, choices: dict[str, int], name: str) -> int:
    """The number of one of some words."""
    if value not in choices:
        raise ArgumentError(name, f"is {value!r}", f"give one of {', '.join(choices)}")
    return choices[value]


class Message:
    """A warning or note of the library."""

    def __init__(self, subject: str, text: str) -> None:
        self.subject = subject
        self.text = text

    def __repr__(self) -> str:
        return f"{self.subject}: {self.text}" if self.subject else self.text


class Messages(list):
    """A list of :class:`Message` that prints one per line."""

    def __str__(self) -> str:
        return "\n".join(map(repr, self)) or "nothing to tell"


def messages(handle: int) -> Messages:
    """All messages behind a handle, which ends."""
    holder, count = Object(handle), ffi.new("size_t *")
    check(lib.es_messages_count(handle, count))
    subject, told = ffi.new("const char **"), ffi.new("const char **")
    found = Messages()
    for index in range(count[0]):
        check(lib.es_messages_get(handle, index, subject, told))
        found.append(Message(text(subject[0]), text(told[0])))
    del holder
    return found
