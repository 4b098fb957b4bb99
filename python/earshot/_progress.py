# SPDX-License-Identifier: MIT
"""Long calls: progress, and an end by Ctrl-C."""

from __future__ import annotations

import os
import queue
import sys
import threading
from typing import Any, Callable, Union

from ._errors import ArgumentError
from ._library import ffi

#: ``True``: a line on standard error. A function of (stage, done, total): called; an answer of
#: False stops the work. A class such as ``tqdm.tqdm``: a bar per stage.
Progress = Union[None, bool, Callable[[str, int, int], Any], type]


class _Line:
    """What ``progress=True`` shows."""

    def __init__(self) -> None:
        self._shown = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        line = f"{stage} {100 * done // max(total, 1)} %"
        if line != self._shown:
            sys.stderr.write(f"\r{line:<{len(self._shown)}}")
            sys.stderr.flush()
            self._shown = line

    def close(self) -> None:
        if self._shown:
            sys.stderr.write("\n")


class _Bars:
    """A bar of tqdm's kind for each stage in turn."""

    def __init__(self, bar_class: Any) -> None:
        self._class = bar_class
        self._bar: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        if self._bar is None or stage != self._stage:
            self.close()
            self._bar, self._stage = self._class(total=total, desc=stage), stage
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class _Worker:
    """A thread that makes the main thread's calls. It stays: the library keeps memory and filters
    for each thread, which a new one would have to make anew."""

    def __init__(self) -> None:
        self._tasks: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        threading.Thread(target=self._run, name="earshot", daemon=True).start()

    def _run(self) -> None:
        while True:
            self._tasks.get()()

    def start(self, work: Callable[[], None]) -> threading.Event:
        """Begins the work, which throws nothing; the event tells its end."""
        done = threading.Event()

        def task() -> None:
            work()
            done.set()

        self._tasks.put(task)
        return done


_worker: _Worker | None = None


def _forget_worker() -> None:
    """Threads do not survive a fork."""
    global _worker
    _worker = None


os.register_at_fork(after_in_child=_forget_worker)


def _start(work: Callable[[], None]) -> threading.Event:
    global _worker
    if _worker is None:
        _worker = _Worker()
    return _worker.start(work)


def _listener(progress: Progress) -> Any:
    if progress is None or progress is False:
        return None
    if progress is True:
        return _Line()
    if hasattr(progress, "update") and hasattr(progress, "close"):
        return _Bars(progress)
    if callable(progress):
        return progress
    raise ArgumentError("progress", f"is {progress!r}", "give True, a function or tqdm.tqdm")


def run_long(call: Callable[[Any], Any], progress: Progress) -> Any:
    """``call(callback)``, whose callback tells ``progress`` and stops the work after Ctrl-C.

    Python handles signals in its main thread alone, and only between its own steps. So the main
    thread waits, which it can be woken from, while another makes the call.
    """
    listener = _listener(progress)
    in_main = threading.current_thread() is threading.main_thread()
    if listener is None and not in_main:
        return call(ffi.NULL)
    stopped = threading.Event()
    outcome: dict[str, Any] = {}

    def told(_data: Any, stage: Any, done: int, total: int) -> int:
        if stopped.is_set():
            return 1
        if listener is not None:
            try:
                if listener(ffi.string(stage).decode(), done, total) is False:
                    return 1
            except BaseException as error:  # raised again when the work has stopped
                outcome["raised"] = error
                return 1
        return 0

    callback = ffi.callback("es_progress_callback", told)

    def work() -> None:
        try:
            outcome["result"] = call(callback)
        except BaseException as error:
            outcome["failed"] = error

    try:
        if in_main:
            done = _start(work)
            try:
                done.wait()
            except BaseException:
                stopped.set()
                done.wait()
                raise
        else:
            work()
    finally:
        if isinstance(listener, (_Line, _Bars)):
            listener.close()
    for key in ("raised", "failed"):
        if key in outcome:
            raise outcome[key]
    return outcome["result"]
