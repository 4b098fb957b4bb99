# SPDX-License-Identifier: MIT
"""Simulations: the options of ``earshot ir`` in Python."""

from __future__ import annotations

import os
import threading
from typing import Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError, Error
from ._library import (
    Object,
    check,
    choice,
    created,
    encoded,
    ffi,
    handle_of,
    integer,
    lib,
    new_options,
    number,
    real_array,
    vector,
)
from ._progress import Progress, run_long
from .materials import BANDS
from .names import Names
from .result import Result
from .scene import Scene
from .visible_sets import VisibleSets

#: A-weighted levels of speech 1 m in front of the talker, decibels (IEC 60268-16, ISO 9921).
SPEECH_LEVELS = {"normal": 60.0, "raised": 66.0, "loud": 72.0}

FORMATS = {"mono": 0, "binaural": 1, "ambisonic": 2}

_MAX_AUTO_RAYS = 1_000_000


def _speech(options: Any, noise: Any, speech: Any) -> list[Any]:
    keep: list[Any] = []
    if noise is None and speech is None:
        return keep
    options.speech = 1
    if isinstance(speech, str):
        speech = SPEECH_LEVELS.get(speech, speech)
    if speech is not None:
        if isinstance(speech, str):
            raise ArgumentError("speech", f"is {speech!r}",
                                f"give {', '.join(SPEECH_LEVELS)} or A-weighted decibels")
        options.speech_level_db = number(speech, "speech")
    if isinstance(noise, str):
        name = noise.upper().removeprefix("NC").lstrip("-")
        if not noise.upper().startswith("NC") or not (name.isascii() and name.isdigit()):
            raise ArgumentError("noise", f"is {noise!r}", "give NC-15 ... NC-70, or seven levels")
        levels = ffi.new("double[7]")
        check(lib.es_noise_criterion(float(name), levels))
        keep.append(levels)
    elif noise is not None:
        levels = real_array(noise, "noise", "7 octave levels, 125 Hz to 8 kHz")
        if levels.shape != (7,):
            raise ArgumentError("noise", f"has shape {np.shape(noise)}",
                                "give 7 octave levels, 125 Hz to 8 kHz")
        keep.append(ffi.new("double[7]", levels.tolist()))
    if keep:
        options.noise_db = keep[-1]
    return keep


def _format(options: Any, name: str) -> None:
    kind, colon, order = name.partition(":") if isinstance(name, str) else ("", "", "")
    is_order = order.isascii() and order.isdigit() and len(order) < 10
    if kind not in FORMATS or (kind == "ambisonic") != bool(colon) or bool(colon) != is_order:
        raise ArgumentError("format", f"is {name!r}", "give mono, binaural or ambisonic:N")
    options.format = FORMATS[kind]
    if order:
        options.ambisonic_order = int(order)


def _rays(options: Any, rays: Union[str, int], rays_error: float | None) -> None:
    if isinstance(rays, str) and rays == "auto":
        options.rays = _MAX_AUTO_RAYS
        if rays_error is not None:
            options.rays_error = number(rays_error, "rays_error")
        return
    if isinstance(rays, str):
        raise ArgumentError("rays", f"is {rays!r}", "give a number or 'auto'")
    options.rays = integer(rays, "rays", 0, 2**63 - 1)
    options.rays_error = 0.0 if rays_error is None else number(rays_error, "rays_error")


def _options(
    *,
    time: float = 0.0,
    order: int = 4,
    diffraction: int = 0,
    min_diffraction_level_db: float = -40.0,
    mode: str = "complete",
    resolution: int = 0,
    transmission: bool = False,
    max_length: float = 0.0,
    min_level_db: float | None = None,
    rays: Union[str, int] = "auto",
    rays_error: float | None = None,
    seed: int = 1,
    temperature: float = 20.0,
    humidity: float = 50.0,
    pressure: float = 101.325,
    air_absorption: bool = True,
    bands: str = "octave",
    format: str = "mono",
    hrtf: Union[str, os.PathLike[str], None] = None,
    hrtf_raw: bool = False,
    sample_rate: float = 48000.0,
    length: float = 0.0,
    responses: bool = True,
    metrics: bool = True,
    histograms: bool = False,
    sofa: bool = False,
    paths: bool = True,
    sensitivity: bool = False,
    noise: Union[str, Sequence[float], None] = None,
    speech: Union[str, float, None] = None,
    visible_sets: VisibleSets | None = None,
    threads: int = 0,
    keep_traces: bool = False,
) -> tuple[Any, list[Any]]:
    """The C struct and what must live as long."""
    options = new_options("es_simulation_options")
    options.time = number(time, "time")
    options.order = integer(order, "order")
    options.diffraction = integer(diffraction, "diffraction")
    options.min_diffraction_level_db = number(min_diffraction_level_db, "min_diffraction_level_db")
    options.mode = choice(mode, {"complete": 0, "sampled": 1}, "mode")
    options.resolution = integer(resolution, "resolution")
    options.transmission = int(bool(transmission))
    options.max_length = number(max_length, "max_length")
    if min_level_db is not None:
        options.min_level_db = number(min_level_db, "min_level_db")
    _rays(options, rays, rays_error)
    options.seed = integer(seed, "seed", 0, 2**63 - 1)
    options.temperature_c = number(temperature, "temperature")
    options.humidity_percent = number(humidity, "humidity")
    options.pressure_kpa = number(pressure, "pressure")
    options.air_absorption = int(bool(air_absorption))
    options.bands = choice(bands, BANDS, "bands")
    _format(options, format)
    options.sample_rate = number(sample_rate, "sample_rate")
    options.length = number(length, "length")
    options.hrtf_raw = int(bool(hrtf_raw))
    options.responses = int(bool(responses))
    options.metrics = int(bool(metrics))
    options.histograms = int(bool(histograms))
    options.sofa = int(bool(sofa))
    options.paths = int(bool(paths))
    options.sensitivity = int(bool(sensitivity))
    options.keep_traces = int(bool(keep_traces))
    options.threads = integer(threads, "threads")
    keep = _speech(options, noise, speech)
    if hrtf is not None:
        keep.append(ffi.new("char[]", encoded(os.fspath(hrtf))))
        options.hrtf_file = keep[-1]
    if visible_sets is not None:
        options.visible_sets = handle_of(visible_sets, VisibleSets, "visible_sets")
        keep.append(visible_sets)
    return options, keep


def _prepared(scene: Scene) -> tuple[int, tuple[Names, Names, Names]]:
    """The handle of a scene with sources and listeners, and the names that its results have."""
    handle = handle_of(scene, Scene, "scene")
    for names, role in ((scene.sources, "source"), (scene.listeners, "listener")):
        if not names:
            raise Error(scene.name, f"the scene has no {role}", f"add_{role}() gives it one")
    return handle, (scene.sources, scene.listeners, scene.materials)


def simulate(scene: Scene, *, progress: Progress = None, **options: Any) -> Result:
    """Impulse responses, paths and metrics of all sources and listeners of a scene.

    Parameters (all but ``scene`` by name; defaults are those of ``earshot ir``)
    ----------
    time : float
        Instant of the scene's animation, seconds (0).
    order : int
        Highest number of reflections and transmissions of an exact path (4).
    diffraction : int
        Highest number of edges that a path bends round: 1, beside its reflections, or 2 in turn
        without any (0).
    min_diffraction_level_db : float
        Leave out paths round an edge that are weaker in their loudest band, decibels re the direct
        sound if nothing were in the way (-40).
    rays : int or 'auto'
        Rays of late sound; 0: none; 'auto': until T30 and level are certain, at most a million.
    rays_error : float
        Relative standard error of T30 at which 'auto' stops (0.02).
    transmission : bool
        Sound also goes through materials that transmit (False).
    max_length, min_level_db : float
        Leave out paths longer than this, metres, or weaker, decibels re the source at 1 m.
    mode, resolution : 'complete' or 'sampled', int
        'sampled' is faster and may miss paths at edges.
    format : 'mono', 'binaural' or 'ambisonic:N'
        Channels of a response: 1, 2, or (N + 1)^2 (ACN, SN3D).
    hrtf, hrtf_raw : file, bool
        SOFA file of a binaural format (a KEMAR manikin), used as it was measured (False).
    sample_rate, length : float
        Hertz (48000); seconds, 0: until the sound has decayed.
    bands : 'octave' or 'third'
        Frequency bands.
    temperature, humidity, pressure : float
        Of the air: degrees Celsius (20), per cent (50), kilopascal (101.325).
    air_absorption : bool
        The air absorbs (True).
    noise, speech : str or 7 octave levels; str or float
        For STI: 'NC-30', or decibels from 125 Hz to 8 kHz; 'normal', 'raised', 'loud', or
        A-weighted decibels 1 m in front of the talker.
    responses, metrics, histograms : bool
        Make responses (True) and metrics (True), keep energies of late sound over time (False).
    sofa : bool
        Keep responses of 64 bits, for :meth:`Result.write_sofa` (False).
    paths : bool
        Tell the paths (True). Without them boxes take less time and memory; responses and metrics
        are the same.
    sensitivity : bool
        Tell which surfaces matter, :attr:`Result.sensitivity` (False).
    visible_sets : VisibleSets
        Leave out paths whose first reflection the source's cell does not see.
    seed, threads : int
        Of rays and noise (1); 0: one thread per core, which changes no result.
    progress : bool, function or class
        True: a line on standard error. A function of (stage, done, total), which stops the work if
        it returns False. A class such as ``tqdm.tqdm``.

    Ctrl-C stops the work. Other threads run meanwhile.

    Examples
    --------
    >>> import earshot as es
    >>> room = es.shoebox((5, 2.7, 4), absorption=0.3)
    >>> _ = room.add_source("talker", (1, 1.5, 1)), room.add_listener("seat", (4, 1.2, 3))
    >>> result = es.simulate(room, order=2, rays=0, length=0.1)
    >>> result.ir.shape
    (1, 1, 1, 4800)
    """
    struct, keep = _options(**options)
    handle, names = _prepared(scene)

    def call(callback: Any) -> int:
        struct.progress = callback
        return created(lib.es_simulate, handle, struct)

    result = Result(run_long(call, progress), names)
    del keep
    return result


class Simulator(Object):
    """A scene prepared for many simulations: instants of its animation, or points that move.

    Takes a copy of the scene, and the options of :func:`simulate`. ``keep_traces=True`` keeps what
    nothing that has moved concerns. Results are those of :func:`simulate`.
    """

    def __init__(self, scene: Scene, *, progress: Progress = None, **options: Any) -> None:
        self._time = number(options.get("time", 0.0), "time")
        struct, self._keep = _options(**options)
        handle, (self.sources, self.listeners, self._materials) = _prepared(scene)
        self._progress = progress
        self._told: Any = None
        self._running = threading.Lock()
        # The callback of all runs is one that asks what the present run wants.
        self._callback = ffi.callback("es_progress_callback", self._tell)
        struct.progress = self._callback
        super().__init__(created(lib.es_simulator_create, handle, struct))

    def _tell(self, data: Any, stage: Any, done: int, total: int) -> int:
        told = self._told
        return 0 if told is None or told == ffi.NULL else told(data, stage, done, total)

    def run(self, time: float | None = None) -> Result:
        """The result at an instant of the scene's animation, seconds."""
        instant = self._time if time is None else number(time, "time")

        def call(callback: Any) -> int:
            self._told = callback
            try:
                return created(lib.es_simulator_run, self._handle, instant)
            finally:
                self._told = None

        names = self.sources, self.listeners, self._materials
        if not self._running.acquire(blocking=False):
            raise Error("simulator", "is running already",
                        "wait for that run, or give each thread a simulator of its own",
                        "ES_ERROR_BUSY")
        try:
            return Result(run_long(call, self._progress), names)
        finally:
            self._running.release()

    def move_source(self, source: str | int, position: npt.ArrayLike) -> None:
        """Moves a source for the next run, metres."""
        check(lib.es_simulator_set_position(self._handle, 0, self.sources.index(source),
                                            vector(position, "position")))

    def move_listener(self, listener: str | int, position: npt.ArrayLike) -> None:
        """Moves a listener for the next run, metres."""
        check(lib.es_simulator_set_position(self._handle, 1, self.listeners.index(listener),
                                            vector(position, "position")))

    def __repr__(self) -> str:
        return f"<Simulator: {len(self.sources)} sources, {len(self.listeners)} listeners>"
