# SPDX-License-Identifier: MIT
"""libearshot.so: calls, handles and views of its arrays."""

from __future__ import annotations

import operator
import os
import pathlib
import re
import threading
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
    """A text of the library; names of files that are not UTF-8 have surrogates, as Python has it."""
    return ffi.string(pointer).decode(errors="surrogateescape")


#: What C programs are told to set, and how Python's options are.
_OPTION_IN_C = re.compile(r"es_simulation_options::(\w+) = 1")


def check(status: int) -> None:
    """Raises what the status of this thread's last call says, in words of Python's callers."""
    if status != lib.ES_OK:
        subject = text(lib.es_error_subject())
        if status != lib.ES_ERROR_FAILED:
            # Of "es_simulate, options->order" the argument is of interest.
            subject = subject.partition(", ")[2].rpartition("->")[2] or subject
        raise _ERRORS.get(status, Error)(
            subject,
            text(lib.es_error_problem()),
            _OPTION_IN_C.sub(r"\1=True", text(lib.es_error_remedy())),
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
    """A text or a path for the library, as UTF-8."""
    if isinstance(string, pathlib.PurePath):
        string = os.fspath(string)
    try:
        data = string if isinstance(string, bytes) else str(string).encode()
    except UnicodeEncodeError:
        raise ArgumentError(repr(string), "is not Unicode", "leave lone surrogates out") from None
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
        #: Held while what another thread may change is copied, and while it is changed.
        self._lock = threading.Lock()

    def __reduce_ex__(self, _protocol: Any) -> Any:
        # A handle means nothing, or something else, to another process.
        raise TypeError(f"a {type(self).__name__} cannot be pickled or copied: it is an object of "
                        "the library in this process; make another from the same data")


def handle_of(value: Any, kind: type, name: str) -> int:
    """The handle behind an argument that must be of a class."""
    if not isinstance(value, kind):
        raise ArgumentError(name, f"is {value!r}", f"give a {kind.__name__}")
    return value._handle


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


def told_array(
    owner: Object, function: Any, *arguments: Any, shape: tuple[int, ...] = (), dtype: Any = np.float64
) -> npt.NDArray[Any]:
    """(count, *shape) over the memory that a function of ``owner`` tells by its last two arguments,
    the address and the count; ``arguments`` are those between."""
    kind = {np.float64: "double", np.uint32: "uint32_t"}[dtype]
    address, count = ffi.new(f"const {kind} **"), ffi.new("size_t *")
    check(function(owner._handle, *arguments, address, count))
    return view(address[0], (count[0], *shape), dtype, owner)


def real_array(values: npt.ArrayLike, name: str, shape: str) -> npt.NDArray[np.float64]:
    """Numbers as doubles in C order, without a copy where they are that; `shape` is told."""
    try:
        given = np.asarray(values)
        if given.size and given.dtype.kind not in "fiuO":
            raise TypeError(f"numbers of type {given.dtype}")
        return np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(name, f"is no array of numbers ({error})", f"give {shape}") from None


def points(values: npt.ArrayLike, name: str, count: int | None = None) -> npt.NDArray[np.float64]:
    """Points as (n, 3) doubles; a single point becomes (1, 3)."""
    array = real_array(values, name, "(n, 3)")
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
    try:
        given = np.asarray(values)
    except ValueError as error:
        raise ArgumentError(name, f"is no array of integers ({error})", "give integers") from None
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
        number = operator.index(value)
    except TypeError:
        raise ArgumentError(name, f"is {value!r}", "give a whole number") from None
    if not low <= number <= high:
        raise ArgumentError(name, f"is {number}", f"give {low} to {high}")
    return number


def number(value: Any, name: str) -> float:
    """A number that C can hold."""
    try:
        if isinstance(value, (str, bytes, bytearray)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(name, f"is {value!r}", "give a number") from None


def choice(value: str, choices: dict[str, int], name: str) -> int:
    """The number of one of some words."""
    if not isinstance(value, str) or value not in choices:
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
