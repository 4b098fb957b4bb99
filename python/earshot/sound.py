# SPDX-License-Identifier: MIT
"""Sounds: files, and what a dry recording sounds like in a room."""

from __future__ import annotations

import os
from typing import Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    Object,
    check,
    created,
    doubles,
    encoded,
    ffi,
    integer,
    lib,
    number,
    real_array,
    view,
)

#: A sound, a file of one, or (samples, sample rate).
SoundLike = Union["Sound", str, "os.PathLike[str]", "tuple[npt.ArrayLike, float]"]


class Sound(Object):
    """Samples of a sound, full scale is 1.

    Parameters
    ----------
    samples : (frames,) or (frames, channels) floats
        Copied.
    sample_rate : float
        Hertz.
    """

    def __init__(self, samples: npt.ArrayLike, sample_rate: float) -> None:
        array = real_array(samples, "samples", "(frames,) or (frames, channels)")
        if array.ndim == 1:
            array = array.reshape(-1, 1)
        if array.ndim != 2:
            raise ArgumentError("samples", f"has shape {array.shape}", "give (frames, channels)")
        super().__init__(created(lib.es_sound_create, doubles(array), array.shape[0],
                                 array.shape[1], number(sample_rate, "sample_rate")))

    @classmethod
    def _of(cls, handle: int) -> Sound:
        sound = cls.__new__(cls)
        Object.__init__(sound, handle)
        return sound

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> Sound:
        """Reads WAV, FLAC, OGG or AIFF."""
        return cls._of(created(lib.es_sound_read, encoded(os.fspath(file))))

    def write(self, file: str | os.PathLike[str]) -> int:
        """Writes 32-bit float .wav, 24-bit .flac or Vorbis .ogg, whole or not at all.

        Returns how many samples were beyond full scale and lost (never of .wav).
        """
        clipped = ffi.new("size_t *")
        check(lib.es_sound_write(self._handle, encoded(os.fspath(file)), clipped))
        return clipped[0]

    def _view(self) -> tuple[npt.NDArray[np.float64], float]:
        samples, frames, channels, rate = (
            ffi.new(kind) for kind in ("const double **", "size_t *", "size_t *", "double *"))
        check(lib.es_sound_samples(self._handle, samples, frames, channels, rate))
        return view(samples[0], (frames[0], channels[0]), np.float64, self), rate[0]

    @property
    def samples(self) -> npt.NDArray[np.float64]:
        """(frames, channels), without a copy; it cannot be written to."""
        return self._view()[0]

    @property
    def sample_rate(self) -> float:
        """Hertz."""
        return self._view()[1]

    @property
    def duration(self) -> float:
        """Seconds."""
        samples, rate = self._view()
        return len(samples) / rate

    def __repr__(self) -> str:
        samples, rate = self._view()
        return (f"<Sound: {samples.shape[1]} channels, {len(samples) / rate:.3f} s "
                f"at {rate:g} Hz>")


def _sound(value: Any) -> Sound:
    if isinstance(value, Sound):
        return value
    if isinstance(value, tuple) and len(value) == 2:
        return Sound(*value)
    if hasattr(value, "sound"):
        return value.sound()
    if isinstance(value, (str, bytes, os.PathLike)):
        return Sound.read(value)
    raise ArgumentError(repr(value), "is no sound",
                        "give a Sound, a Response, a file or (samples, sample rate)")


def auralize(dry: SoundLike, responses: Any, *, threads: int = 0) -> Sound:
    """A dry recording as it sounds at a listener.

    Parameters
    ----------
    dry : Sound, file, or (samples, sample rate)
        One channel, or as many as the response has. Resampled to the response's rate.
    responses : Response, Sound, file, or a list of these
        A list is of a listener that moves: its responses are applied to equal parts of the
        recording in turn and cross-faded, as ``earshot auralize`` does.
    """
    if not isinstance(responses, list):
        responses = [responses]
    recording, sounds = _sound(dry), [_sound(response) for response in responses]
    handles = ffi.new("es_sound[]", [sound._handle for sound in sounds])
    return Sound._of(created(lib.es_auralize, recording._handle, handles, len(sounds),
                             integer(threads, "threads")))


def mix(
    sounds: Sequence[SoundLike],
    gains_db: Sequence[float] | None = None,
    sample_rate: float = 0.0,
) -> Sound:
    """Several sounds of as many channels added, each with its gain in decibels (0 if left out), at
    ``sample_rate`` hertz (0: that of the first)."""
    given = [_sound(sound) for sound in sounds]
    gains = ffi.NULL
    if gains_db is not None:
        if len(gains_db) != len(given):
            raise ArgumentError("gains_db", f"has {len(gains_db)} entries", f"give {len(given)}")
        gains = ffi.new("double[]", [number(gain, "gains_db") for gain in gains_db])
    handles = ffi.new("es_sound[]", [sound._handle for sound in given])
    return Sound._of(created(lib.es_sound_mix, handles, gains, len(given),
                             number(sample_rate, "sample_rate")))
