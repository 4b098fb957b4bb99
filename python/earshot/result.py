# SPDX-License-Identifier: MIT
"""Results: responses, paths and metrics as arrays."""

from __future__ import annotations

import dataclasses
import functools
import os
import pathlib
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError, Error, MissingPackage
from ._library import (
    NONE,
    Messages,
    Object,
    check,
    created,
    encoded,
    ffi,
    handle_of,
    integer,
    lib,
    messages,
    new_struct,
    text,
    told_array,
    view,
)
from .names import Names
from .paths import PATH_TYPE, Paths
from .sound import Sound

if TYPE_CHECKING:
    from .scene import Scene


@dataclasses.dataclass(frozen=True)
class Room:
    """The air that sound of the sources reaches, and its times if sound were diffuse."""

    volume: float  #: cubic metres
    surface: float  #: square metres that sound reaches
    opening: float  #: square metres through which sound leaves
    absorption: npt.NDArray[np.float64]  #: (bands,) mean
    sabine: npt.NDArray[np.float64]  #: (bands,) seconds
    eyring: npt.NDArray[np.float64]  #: (bands,) seconds


@dataclasses.dataclass(frozen=True)
class Histogram:
    """Energy of a pair's late sound over time, in units of a free field's at 1 m."""

    bin: float  #: seconds
    energy: npt.NDArray[np.float64]  #: (bins, bands)
    error: npt.NDArray[np.float64]  #: (bins, bands) standard errors
    rays: int
    t30_error: float  #: relative standard error of T30
    level_error_db: float


@dataclasses.dataclass(frozen=True)
class Sensitivity:
    """Which surfaces matter: what each material of the scene means to each pair.

    Energies are (sources, listeners, materials, bands), before and after 80 ms. Derivatives are by
    the energy absorption coefficient of a material, per unit of it: a metric of a band depends on
    the coefficient in that band; 'sti' is derived by the coefficient in each band; single numbers
    by all bands together. NaN where the metric has no value or the material absorbs everything.
    """

    materials: Names
    areas: npt.NDArray[np.float64]  #: (materials,) square metres
    touched_before: npt.NDArray[np.float64]  #: share of the energy that the material reflected
    touched_after: npt.NDArray[np.float64]
    reflections_before: npt.NDArray[np.float64]  #: mean number of its reflections on the way
    reflections_after: npt.NDArray[np.float64]
    absorbed_before: npt.NDArray[np.float64]  #: share of the emitted energy that it absorbs
    absorbed_after: npt.NDArray[np.float64]
    #: 'edt', 't20', 't30', 'c50', 'c80', 'd50', 'ts', 'g', 'sti': (sources, listeners, materials,
    #: bands).
    derivatives: dict[str, npt.NDArray[np.float64]]
    standard_errors: dict[str, npt.NDArray[np.float64]]  #: of these; NaN without rays
    #: 'edt_mid', ..., 'sti': (sources, listeners, materials).
    single: dict[str, npt.NDArray[np.float64]]
    single_standard_errors: dict[str, npt.NDArray[np.float64]]


class Response:
    """What a result holds of a pair of a source and a listener: ``result["talker", "seat"]``."""

    def __init__(self, result: Result, source: int, listener: int) -> None:
        self.result = result
        self.source_index, self.listener_index = source, listener
        self.source, self.listener = result.sources[source], result.listeners[listener]

    @property
    def ir(self) -> npt.NDArray[np.float32]:
        """(channels, samples) of its own length; a view."""
        at = self.source_index, self.listener_index
        return self.result.ir[at][:, : int(self.result.lengths[at])]

    @property
    def sample_rate(self) -> float:
        """Hertz."""
        return self.result.sample_rate

    @property
    def paths(self) -> Paths:
        """Its paths."""
        return self.result.paths[self.source_index, self.listener_index]

    @property
    def metrics(self) -> dict[str, Any]:
        """Its entries of :attr:`Result.metrics`: (bands,) arrays and floats."""
        at = self.source_index, self.listener_index
        return {name: values[at] for name, values in self.result.metrics.items()}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.result, name)[self.source_index, self.listener_index]

    def sound(self) -> Sound:
        """Its samples as a :class:`Sound`."""
        return Sound._of(created(lib.es_result_sound, self.result._handle, self.source_index,
                                 self.listener_index))

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a 32-bit float .wav, the bytes of ``earshot ir``, or .flac or .ogg."""
        self.sound().write(file)

    def plot_response(self, **options: Any) -> Any:
        """See :func:`earshot.plot_response`."""
        from .plots import plot_response

        return plot_response(self, **options)

    def plot_decay(self, **options: Any) -> Any:
        """See :func:`earshot.plot_decay`."""
        from .plots import plot_decay

        return plot_decay(self, **options)

    def plot_echogram(self, **options: Any) -> Any:
        """See :func:`earshot.plot_echogram`."""
        from .plots import plot_echogram

        return plot_echogram(self, **options)

    def __repr__(self) -> str:
        channels, samples = self.ir.shape
        return (f"<Response {self.source!r} to {self.listener!r}: {channels} x {samples} samples "
                f"at {self.sample_rate:g} Hz, {len(self.paths) if self.result._has_paths else 0} "
                "paths>")


class _MetricKind:
    """A metric that the library knows."""

    def __init__(self, index: int) -> None:
        key, unit = ffi.new("const char **"), ffi.new("const char **")
        difference, relative = ffi.new("double *"), ffi.new("int32_t *")
        check(lib.es_metric_get(index, key, unit, difference, relative))
        self.index, self.key, self.unit = index, text(key[0]), text(unit[0])


@functools.lru_cache(maxsize=None)
def _metric_kinds() -> tuple[_MetricKind, ...]:
    kinds = []
    try:
        for index in range(256):
            kinds.append(_MetricKind(index))
    except Error:
        return tuple(kinds)
    return tuple(kinds)


class Result(Object):
    """Responses, paths and metrics of all pairs of a source and a listener.

    Arrays begin with (sources, listeners) and are views that cannot be written to. ``result[source,
    listener]``, by name or index, is a :class:`Response`.
    """

    def __init__(self, handle: int, names: tuple[Names, Names, Names]) -> None:
        super().__init__(handle)
        #: Names of its sources, its listeners and its scene's materials.
        self.sources, self.listeners, self.materials = names
        info = new_struct("es_result_info")
        check(lib.es_result_get_info(handle, info))
        self._info = info
        #: Hertz.
        self.sample_rate: float = info.sample_rate
        #: Seconds, of the scene's animation.
        self.time: float = info.time
        #: Metres per second.
        self.speed_of_sound: float = info.speed_of_sound

    def _pair(self, source: Any, listener: Any) -> int:
        return self.sources.index(source) * len(self.listeners) + self.listeners.index(listener)

    def __getitem__(self, pair: tuple[str | int, str | int]) -> Response:
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise ArgumentError(repr(pair), "is no pair", "give result[source, listener]")
        return Response(self, self.sources.index(pair[0]), self.listeners.index(pair[1]))

    def __len__(self) -> int:
        return len(self.sources) * len(self.listeners)

    def __iter__(self) -> Iterator[Response]:
        for source in range(len(self.sources)):
            for listener in range(len(self.listeners)):
                yield Response(self, source, listener)

    @functools.cached_property
    def bands(self) -> npt.NDArray[np.float64]:
        """Nominal centres of the frequency bands, hertz."""
        return told_array(self, lib.es_result_bands)

    @functools.cached_property
    def ir(self) -> npt.NDArray[np.float32]:
        """Impulse responses, (sources, listeners, channels, samples), without a copy.

        Pressure re the source's free field at 1 m; sample 0 is the instant of emission. Shorter
        ones end in zeros.
        """
        samples, shape = ffi.new("const float **"), ffi.new("size_t[4]")
        check(lib.es_result_responses(self._handle, samples, shape))
        return view(samples[0], tuple(shape), np.float32, self)

    @functools.cached_property
    def lengths(self) -> npt.NDArray[np.uint64]:
        """How long each response is, (sources, listeners) samples."""
        lengths, shape = ffi.new("const uint64_t **"), ffi.new("size_t[2]")
        check(lib.es_result_lengths(self._handle, lengths, shape))
        return view(lengths[0], tuple(shape), np.uint64, self)

    @functools.cached_property
    def _has_paths(self) -> bool:
        """Whether they were asked for."""
        given = new_struct("es_path_arrays")
        return bool(lib.es_result_paths(self._handle, given) == lib.ES_OK)

    @property
    def paths(self) -> Paths:
        """All paths; an error after a simulation with ``paths=False``."""
        given = new_struct("es_path_arrays")
        check(lib.es_result_paths(self._handle, given))
        count = given.path_count
        pairs = len(self.sources) * len(self.listeners)
        arrays = {
            "paths": view(given.paths, (count,), PATH_TYPE, self),
            "first_path": view(given.first_path, (pairs + 1,), np.uint64, self),
            "points": view(given.points, (given.point_count, 3), np.float64, self),
            "triangles": view(given.triangles, (given.interaction_count,), np.uint32, self),
            "materials": view(given.materials, (given.interaction_count,), np.uint32, self),
            "pressure": view(given.pressure, (count, given.band_count), np.float64, self),
            "first_edge": view(given.first_edge, (count + 1,), np.uint64, self),
            "edges": view(given.edges, (given.edge_count, 2, 3), np.float64, self),
        }
        return Paths(self, arrays, slice(0, count))

    # --- Metrics

    def _metric(self, kind: int, metric_set: int, form: int) -> Any:
        """(values, standard errors), or None if there are no such."""
        values, errors = ffi.new("const double **"), ffi.new("const double **")
        shape = ffi.new("size_t[3]")
        status = lib.es_result_metric(self._handle, kind, metric_set, form, values, errors, shape)
        if status in (lib.ES_ERROR_FAILED, lib.ES_ERROR_ARGUMENT):
            return None  # that metric has no such form, or none were made
        check(status)
        if values[0] == ffi.NULL:
            return None
        return tuple(view(found[0], tuple(shape), np.float64, self) if found[0] != ffi.NULL
                     else np.full(tuple(shape), np.nan) for found in (values, errors))

    def _metrics(self, metric_set: int, column: int) -> dict[str, npt.NDArray[np.float64]]:
        table = {}
        for kind in _metric_kinds():
            per_band = self._metric(kind.index, metric_set, lib.ES_PER_BAND)
            single = self._metric(kind.index, metric_set, lib.ES_SINGLE_NUMBER)
            if per_band is not None:
                table[kind.key] = per_band[column]
            if single is not None:
                name = kind.key if per_band is None else f"{kind.key}_mid"
                table[name] = single[column][..., 0]
        return table

    @functools.cached_property
    def metrics(self) -> dict[str, npt.NDArray[np.float64]]:
        """Expected metrics by name, NaN where there is no value.

        'edt', 't20', 't30', 'ts' (seconds), 'c50', 'c80', 'g' (decibels) and 'd50' are (sources,
        listeners, bands); the same with '_mid' are means of 500 Hz and 1 kHz, (sources, listeners),
        as are 'sti' and 'schroeder' (hertz). Empty if no metrics were made.
        """
        return self._metrics(lib.ES_EXPECTED, 0)

    @functools.cached_property
    def standard_errors(self) -> dict[str, npt.NDArray[np.float64]]:
        """Standard errors of :attr:`metrics`, NaN where there are none."""
        return self._metrics(lib.ES_EXPECTED, 1)

    @functools.cached_property
    def response_metrics(self) -> dict[str, npt.NDArray[np.float64]]:
        """The metrics of the responses, each one realisation; 'lf' of ambisonic ones and 'iacc',
        'iacc_early' and 'iacc_late' of binaural ones with them."""
        return self._metrics(lib.ES_RESPONSE, 0)

    @property
    def sti(self) -> npt.NDArray[np.float64]:
        """Speech transmission index, (sources, listeners)."""
        return self._of_metrics("sti")

    @property
    def t30(self) -> npt.NDArray[np.float64]:
        """Reverberation time T30, mean of 500 Hz and 1 kHz, (sources, listeners) seconds."""
        return self._of_metrics("t30_mid")

    @property
    def edt(self) -> npt.NDArray[np.float64]:
        """Early decay time, mean of 500 Hz and 1 kHz, (sources, listeners) seconds."""
        return self._of_metrics("edt_mid")

    @property
    def c50(self) -> npt.NDArray[np.float64]:
        """Clarity C50, mean of 500 Hz and 1 kHz, (sources, listeners) decibels."""
        return self._of_metrics("c50_mid")

    @property
    def c80(self) -> npt.NDArray[np.float64]:
        """Clarity C80, mean of 500 Hz and 1 kHz, (sources, listeners) decibels."""
        return self._of_metrics("c80_mid")

    def _of_metrics(self, name: str) -> npt.NDArray[np.float64]:
        if name not in self.metrics:
            raise Error(name, "no metrics were made", "simulate with metrics=True")
        return self.metrics[name]

    def why(
        self,
        metric: str,
        source: str | int,
        listener: str | int,
        band: int | None = None,
        *,
        of_response: bool = False,
    ) -> str:
        """Why a metric ('t30') has no value in a band (its index; None: the single number), or what
        else is to be known of it."""
        kinds = {kind.key: kind.index for kind in _metric_kinds()}
        key = str(metric).removesuffix("_mid")
        if key not in kinds:
            raise ArgumentError("metric", f"is {metric!r}", f"give one of {', '.join(kinds)}")
        note = ffi.new("const char **")
        check(lib.es_result_metric_note(
            self._handle, kinds[key], lib.ES_RESPONSE if of_response else lib.ES_EXPECTED,
            self.sources.index(source), self.listeners.index(listener),
            NONE if band is None else integer(band, "band", 0, NONE - 1), note))
        return text(note[0])

    def frame(self, names: Sequence[str] | None = None) -> Any:
        """Single-number metrics as a pandas table, a row per source and listener."""
        try:
            import pandas
        except ImportError:
            raise MissingPackage("pandas", "is not installed", "pip install pandas") from None
        chosen = self._single_numbers(names)
        index = pandas.MultiIndex.from_product(
            [list(self.sources), list(self.listeners)], names=["source", "listener"])
        return pandas.DataFrame({name: chosen[name].ravel() for name in chosen}, index=index)

    def _single_numbers(self, names: Sequence[str] | None) -> dict[str, npt.NDArray[np.float64]]:
        if isinstance(names, str):
            names = [names]
        singles = {name: values for name, values in self.metrics.items() if values.ndim == 2}
        if names is None:
            return singles
        missing = [name for name in names if name not in singles]
        if missing:
            raise ArgumentError("names", f"has {missing[0]!r}", f"give of {', '.join(singles)}")
        return {name: singles[name] for name in names}

    def table(
        self, names: Sequence[str] = ("t30_mid", "edt_mid", "c50_mid", "c80_mid", "sti")
    ) -> str:
        """Single-number metrics as text, a line per source and listener."""
        chosen = self._single_numbers(names)
        pairs = [f"{source} to {listener}" for source in self.sources for listener in self.listeners]
        width = max(map(len, pairs), default=0)
        lines = [" " * width + "".join(f"{name:>10}" for name in chosen)]
        for row, pair in enumerate(pairs):
            cells = (values.ravel()[row] for values in chosen.values())
            lines.append(f"{pair:<{width}}" + "".join(
                f"{'-' if np.isnan(cell) else f'{cell:.2f}':>10}" for cell in cells))
        return "\n".join(lines)

    @functools.cached_property
    def room(self) -> Room | None:
        """The room by statistics; None outdoors, or if no metrics were made."""
        given = new_struct("es_room")
        check(lib.es_result_room(self._handle, given))
        if not given.is_enclosed:
            return None
        shape = (given.band_count,)
        return Room(given.volume, given.surface, given.opening, *(
            view(values, shape, np.float64, self)
            for values in (given.absorption, given.sabine, given.eyring)))

    def histogram(self, source: str | int, listener: str | int) -> Histogram:
        """Late sound of a pair over time; simulate with ``histograms=True``."""
        given = new_struct("es_histogram")
        check(lib.es_result_histogram(self._handle, self.sources.index(source),
                                      self.listeners.index(listener), given))
        if given.energy == ffi.NULL:
            raise Error("histogram", "was not kept", "simulate with histograms=True")
        shape = (given.bin_count, given.band_count)
        return Histogram(given.bin, view(given.energy, shape, np.float64, self),
                         view(given.error, shape, np.float64, self), given.rays,
                         given.t30_error, given.level_error_db)

    @functools.cached_property
    def sensitivity(self) -> Sensitivity:
        """Which surfaces matter; simulate with ``sensitivity=True``."""
        given = new_struct("es_sensitivity")
        check(lib.es_result_sensitivity(self._handle, given))
        shape = (len(self.sources), len(self.listeners), given.material_count, given.band_count)
        energies = {
            name: view(getattr(given, name), shape, np.float64, self)
            for name in ("touched_before", "touched_after", "reflections_before",
                         "reflections_after", "absorbed_before", "absorbed_after")
        }
        tables: tuple[dict[str, npt.NDArray[np.float64]], ...] = ({}, {}, {}, {})
        for kind in _metric_kinds()[: lib.ES_METRIC_STI + 1]:
            is_index = kind.index == lib.ES_METRIC_STI
            values, errors = self._derivative(kind.index, lib.ES_PER_BAND)
            tables[0][kind.key], tables[1][kind.key] = values, errors
            values, errors = self._derivative(kind.index, lib.ES_SINGLE_NUMBER)
            name = kind.key if is_index else f"{kind.key}_mid"
            tables[2][name], tables[3][name] = values[..., 0], errors[..., 0]
        return Sensitivity(self.materials,
                           view(given.areas, (given.material_count,), np.float64, self),
                           **energies, derivatives=tables[0], standard_errors=tables[1],
                           single=tables[2], single_standard_errors=tables[3])

    def _derivative(self, kind: int, form: int) -> Any:
        """(values, standard errors)."""
        values, errors = ffi.new("const double **"), ffi.new("const double **")
        shape = ffi.new("size_t[4]")
        check(lib.es_result_derivative(self._handle, kind, form, values, errors, shape))
        return tuple(view(found[0], tuple(shape), np.float64, self) for found in (values, errors))

    def notes(self) -> Messages:
        """What is to be told: pairs without a path, errors not reached, decays that are longer than
        the room explains."""
        return messages(created(lib.es_result_notes, self._handle))

    # --- Files

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``earshot ir`` into a folder: SOURCE__LISTENER.wav, paths.json and
        metrics.json, the same bytes; of responses, paths and metrics those that there are."""
        place = pathlib.Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        files: dict[str, str] = {}
        for source in self.sources:
            for listener in self.listeners:
                name = f"{_file_name(source)}__{_file_name(listener)}.wav"
                if name in files:
                    raise Error(name, "would hold the response of two pairs", "rename one of them")
                files[name] = ""
        for name, response in zip(files, self):
            if self._info.samples:
                response.write(place / name)
        if self._has_paths:
            self.write_json(place / "paths.json", "paths")
        if self.metrics:
            self.write_json(place / "metrics.json", "metrics")

    def write_json(self, file: str | os.PathLike[str], document: str) -> None:
        """Writes 'paths', 'metrics', 'histograms' or 'sensitivity' as ``earshot ir`` does."""
        kinds = {"paths": 0, "metrics": 1, "histograms": 2, "sensitivity": 3}
        if document not in kinds:
            raise ArgumentError("document", f"is {document!r}", f"give one of {', '.join(kinds)}")
        check(lib.es_result_write(self._handle, kinds[document], encoded(os.fspath(file))))

    def write_sofa(self, file: str | os.PathLike[str]) -> None:
        """Writes all responses to a SOFA file, as ``earshot ir --sofa`` does; simulate with
        ``sofa=True``. See :func:`earshot.write_sofa`."""
        write_sofa([self], file)

    def report(
        self,
        file: str | os.PathLike[str],
        scene: Scene | None = None,
        *,
        title: str | None = None,
        command: str = "",
        against: str | os.PathLike[str] | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> None:
        """Writes a page for the browser that shows the result, complete in one file; only its data
        if the name ends in ``.json``.

        ``scene``: the simulated scene, whose walls the page shows. ``title``: the scene's name if
        None. ``command``: how the result was made, as the page tells it. ``against``: a metrics.json
        to compare with. ``limits``: what metrics are to be, ``{"sti": 0.6}``; times at most, all
        else at least. Decay curves need ``histograms=True`` in the simulation, which surfaces
        matter needs ``sensitivity=True``."""
        options = new_struct("es_report_options")
        kept = [ffi.new("char[]", encoded(f"{metric}={float(value)!r}"))
                for metric, value in (limits or {}).items()]
        texts = {"command": command}
        if title is not None:
            texts["title"] = title
        if against is not None:
            texts["reference_file"] = os.fspath(against)
        for member, value in texts.items():
            kept.append(ffi.new("char[]", encoded(value)))
            setattr(options, member, kept[-1])
        options.limit_count = len(limits or {})
        kept.append(ffi.new("char *[]", kept[:options.limit_count]))
        options.limits = kept[-1]
        if scene is not None:
            from .scene import Scene

            options.scene = handle_of(scene, Scene, "scene")
        check(lib.es_result_write_report(self._handle, options, encoded(os.fspath(file))))

    def plot_metric(self, name: str, source: str | int = 0, **options: Any) -> Any:
        """See :func:`earshot.plot_metric`."""
        from .plots import plot_metric

        return plot_metric(self, name, source, **options)

    def __repr__(self) -> str:
        info = self._info
        return (f"<Result: {info.sources} sources x {info.listeners} listeners, {info.channels} x "
                f"{info.samples} samples at {info.sample_rate:g} Hz, {info.paths} paths>")


def write_sofa(results: Sequence[Result], file: str | os.PathLike[str]) -> None:
    """Writes the responses of results of one scene, in order of time, to one SOFA file (AES69,
    SingleRoomSRIR): the bytes of ``earshot ir --frames ... --sofa``.

    The results must be of simulations with ``sofa=True``, of one format and sample rate. A wheel
    has no HDF5, by which SOFA files are written: there this is an error.
    """
    if isinstance(results, Result):
        results = [results]
    handles = ffi.new("es_result[]", [handle_of(one, Result, "results") for one in results])
    check(lib.es_results_write_sofa(handles, len(results), encoded(os.fspath(file))))


def _file_name(name: str) -> str:
    """As the program makes file names of names: at most 80 bytes, others than letters as _."""
    cut = name.encode()[:80].decode(errors="ignore")
    plain = "-_. "
    return "".join(
        c if not c.isascii() or c.isalnum() or c in plain else "_" for c in cut)
