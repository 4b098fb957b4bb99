# SPDX-License-Identifier: MIT
"""Absorption and scattering of materials fitted to measurements."""

from __future__ import annotations

import json
import os
from typing import Any, Iterable, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError
from ._library import (
    Messages,
    Object,
    check,
    created,
    encoded,
    ffi,
    handle_of,
    indices,
    integer,
    lib,
    messages,
    new_options,
    new_struct,
    number,
    text,
    view,
)
from ._progress import Progress, run_long
from .names import Names
from .scene import Scene
from .simulation import _options

_METRICS = ("edt", "t20", "t30", "c50", "c80", "d50", "ts", "g")
#: The rays' chance must be small beside the errors of measurement, and hard pairs must not trace
#: rays for all.
_RAYS_ERROR, _MAX_AUTO_RAYS = 0.01, 200_000

#: source, listener, metric, band in hertz, value and, if known, its standard error.
MeasuredRow = Sequence[Any]


class Calibration(Object):
    """Materials fitted to measurements, as :func:`earshot.calibrate` gives them.

    Tables are (materials, bands) arrays; those of scattering raise an error unless it was fitted.
    ``report`` has everything else, as ``earshot calibrate --json`` prints it.
    """

    def __init__(self, handle: int, scene: Scene) -> None:
        super().__init__(handle)
        info = new_struct("es_calibration_info")
        check(lib.es_calibration_get_info(handle, info))
        self.simulations: int = info.simulations  #: that were made
        self.rays: int = info.rays  #: of each simulation, per source
        self.converged: bool = bool(info.converged)  #: whether the absorption stayed in the end
        self.materials = Names(tuple(scene.materials), "material")

    def _table(self, table: int) -> npt.NDArray[np.float64]:
        values, shape = ffi.new("const double **"), ffi.new("size_t[2]")
        check(lib.es_calibration_values(self._handle, table, values, shape))
        return view(values[0], tuple(shape), np.float64, self)

    @property
    def prior(self) -> npt.NDArray[np.float64]:
        """The absorption before."""
        return self._table(lib.ES_CALIBRATION_PRIOR)

    @property
    def prior_error(self) -> npt.NDArray[np.float64]:
        """Its standard deviation; 0 of kept materials."""
        return self._table(lib.ES_CALIBRATION_PRIOR_ERROR)

    @property
    def absorption(self) -> npt.NDArray[np.float64]:
        """The fitted absorption; as before where nothing was measured."""
        return self._table(lib.ES_CALIBRATION_ABSORPTION)

    @property
    def error(self) -> npt.NDArray[np.float64]:
        """Its standard error, of measurements and prior together."""
        return self._table(lib.ES_CALIBRATION_ERROR)

    @property
    def interval(self) -> npt.NDArray[np.float64]:
        """(2, materials, bands): the ends of the 95 % interval."""
        return np.stack([self._table(lib.ES_CALIBRATION_LOWER),
                         self._table(lib.ES_CALIBRATION_UPPER)])

    @property
    def identified(self) -> npt.NDArray[np.bool_]:
        """Whether the measurements alone tell it."""
        return self._table(lib.ES_CALIBRATION_IDENTIFIED) != 0

    @property
    def scattering_prior(self) -> npt.NDArray[np.float64]:
        """The scattering before."""
        return self._table(lib.ES_CALIBRATION_SCATTERING_PRIOR)

    @property
    def scattering_prior_error(self) -> npt.NDArray[np.float64]:
        """Its standard deviation; 0 of kept materials."""
        return self._table(lib.ES_CALIBRATION_SCATTERING_PRIOR_ERROR)

    @property
    def scattering(self) -> npt.NDArray[np.float64]:
        """The fitted scattering; as before where nothing was measured."""
        return self._table(lib.ES_CALIBRATION_SCATTERING)

    @property
    def scattering_error(self) -> npt.NDArray[np.float64]:
        """Its standard error, of measurements and prior together."""
        return self._table(lib.ES_CALIBRATION_SCATTERING_ERROR)

    @property
    def scattering_interval(self) -> npt.NDArray[np.float64]:
        """(2, materials, bands): the ends of the 95 % interval."""
        return np.stack([self._table(lib.ES_CALIBRATION_SCATTERING_LOWER),
                         self._table(lib.ES_CALIBRATION_SCATTERING_UPPER)])

    @property
    def scattering_identified(self) -> npt.NDArray[np.bool_]:
        """Whether the measurements alone tell it."""
        return self._table(lib.ES_CALIBRATION_SCATTERING_IDENTIFIED) != 0

    @property
    def report(self) -> dict[str, Any]:
        """Everything, with residuals, groups of materials that are not told apart, and warnings."""
        value = ffi.new("const char **")
        check(lib.es_calibration_json(self._handle, value))
        return json.loads(text(value[0]))

    @property
    def warnings(self) -> Messages:
        """What is odd about the measurements and the fit."""
        return messages(created(lib.es_calibration_warnings, self._handle))

    def __getitem__(self, material: str | int) -> npt.NDArray[np.float64]:
        """The fitted absorption of a material, per band."""
        return self.absorption[self.materials.index(material)]

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the materials as a file SCENE.materials.json."""
        check(lib.es_calibration_write(self._handle, encoded(os.fspath(file))))

    def apply(self, scene: Scene) -> None:
        """Gives the coefficients to the materials of a scene."""
        handle = handle_of(scene, Scene, "scene")
        with scene._lock:
            check(lib.es_calibration_apply(self._handle, handle))

    def __repr__(self) -> str:
        return (f"<Calibration of {len(self.materials)} materials: {self.simulations} simulations, "
                f"{'converged' if self.converged else 'not converged'}>")


def _rows(scene: Scene, measured: Iterable[MeasuredRow]) -> Any:
    sources, listeners = Names(tuple(scene.sources), "source"), Names(tuple(scene.listeners), "listener")
    metrics = Names(_METRICS, "metric")
    rows = []
    for row in measured:
        if isinstance(row, str) or len(row) not in (5, 6):
            raise ArgumentError("measured", f"has the row {row!r}",
                                "give source, listener, metric, band, value and, if known, error")
        error = row[5] if len(row) == 6 and row[5] is not None else 0.0
        rows.append((sources.index(row[0]), listeners.index(row[1]), metrics.index(row[2]), 0,
                     number(row[3], "band"), number(row[4], "value"), number(error, "error")))
    if not rows:
        raise ArgumentError("measured", "is empty", "give measured values")
    return ffi.new("es_measured_metric[]", rows), len(rows)


def calibrate(
    scene: Scene,
    measured: Union[str, "os.PathLike[str]", Iterable[MeasuredRow]],
    *,
    metrics: Union[str, Sequence[str], None] = None,
    error: float = 0.5,
    spread: float = 1.0,
    unknown: Sequence[str | int] = (),
    keep: Sequence[str | int] = (),
    fit_scattering: bool = False,
    max_simulations: int = 5,
    noise_free: bool = False,
    reference: float | None = None,
    progress: Progress = None,
    **options: Any,
) -> Calibration:
    """Fits the absorption of a scene's materials, per band, to measured metrics, and scattering.

    The scene stays as it is; :meth:`Calibration.apply` gives it the result.

    Parameters (all but the first two by name)
    ----------
    measured : rows, or path
        Rows of source, listener (names or indices), metric ('edt', 't20', 't30', 'c50', 'c80',
        'd50', 'ts', 'g'), band (nominal, hertz), value and, if known, its standard error; or a
        folder of recordings SOURCE__LISTENER.wav, or such a table as .csv.
    metrics : str or list of str
        Of a folder or table: those to fit. By default edt, t30 and c80 of recordings, all of a table.
    error, spread : float
        Standard error of values that have none, just-noticeable differences (0.5); how far coefficients
        may be off, a factor of the spread in literature (1).
    unknown, keep : list of str or int
        Materials of which nothing is known, beside those without data; materials that stay.
    fit_scattering : bool
        Fits scattering as well, which is kept otherwise (False).
    max_simulations : int
        Until the coefficients stay (5).
    noise_free, reference
        Recordings are computed responses (False); level of the source in free field at 1 m,
        decibels re full scale, for G (None: not calibrated).
    time, order, transmission, rays, rays_error, seed, temperature, humidity, pressure,
    air_absorption, bands, threads, progress
        As in :func:`earshot.simulate`; ``order`` is 3 and ``rays_error`` 0.01 by default, and
        'auto' traces at most 200,000 rays.
    """
    own = new_options("es_calibration_options")
    own.default_error, own.spread = number(error, "error"), number(spread, "spread")
    own.max_simulations = integer(max_simulations, "max_simulations")
    own.noise_free = int(bool(noise_free))
    own.fit_scattering = int(bool(fit_scattering))
    if reference is not None:
        own.reference_db = number(reference, "reference")
    names = Names(tuple(scene.materials), "material")
    keep_alive: list[Any] = []
    for given, field in ((unknown, "unknown"), (keep, "kept")):
        array = np.array([names.index(name) for name in given], np.uint32)
        keep_alive.append(array)
        setattr(own, f"{field}_materials", indices(array) if len(array) else ffi.NULL)
        setattr(own, f"{field}_count", len(array))
    rows, count = ffi.NULL, 0
    if isinstance(measured, (str, os.PathLike)):
        keep_alive.append(ffi.new("char[]", encoded(os.fspath(measured))))
        own.measured = keep_alive[-1]
        if metrics is not None:
            keys = metrics if isinstance(metrics, str) else ",".join(metrics)
            keep_alive.append(ffi.new("char[]", encoded(keys)))
            own.metrics = keep_alive[-1]
    else:
        rows, count = _rows(scene, measured)
    options.setdefault("order", 3)
    is_auto = options.get("rays", "auto") == "auto"
    if is_auto:
        options.setdefault("rays_error", _RAYS_ERROR)
    simulation, keep_simulation = _options(**options)
    keep_alive += keep_simulation
    if is_auto:
        simulation.rays = _MAX_AUTO_RAYS

    def work(callback: Any) -> int:
        simulation.progress = callback
        return created(lib.es_calibrate, scene._handle, simulation, own, rows, count)

    return Calibration(run_long(work, progress), scene)
