# SPDX-License-Identifier: MIT
"""Figures by matplotlib, which is imported when one is drawn.

Each function draws into ``axes``, or into a new figure, and returns the axes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import ArgumentError, MissingPackage


def _axes(axes: Any, **options: Any) -> Any:
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ImportError:
        raise MissingPackage("matplotlib", "is not installed", "pip install matplotlib") from None
    return pyplot.figure(layout="constrained").add_subplot(**options)


def plot_scene(scene: Any, *, time: float = 0.0, axes: Any = None) -> Any:
    """A scene in 3D: edges by material, sources as dots, listeners as triangles."""
    axes = _axes(axes, projection="3d")
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    corners = scene.positions(time)[scene.triangles]
    for index, name in enumerate(scene.materials):
        faces = corners[scene.material_of_triangle == index]
        # The figure's third axis points up.
        axes.add_collection3d(Poly3DCollection(
            faces[..., [0, 2, 1]], alpha=0.15, facecolor=f"C{index % 10}",
            edgecolor=f"C{index % 10}", linewidth=0.3, label=name))
    for positions, marker, label in (
        (scene.source_positions(time), "o", "sources"),
        (scene.listener_positions(time), "^", "listeners"),
    ):
        if len(positions):
            axes.scatter(*positions[:, [0, 2, 1]].T, marker=marker, label=label, depthshade=False)
    lower, upper = scene.extent(time)
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[2], upper[2]), zlim=(lower[1], upper[1]),
             xlabel="x, m", ylabel="z, m", zlabel="y, m", title=scene.name)
    axes.set_box_aspect(np.maximum((upper - lower)[[0, 2, 1]], 1e-3))
    return axes


def plot_response(response: Any, *, axes: Any = None) -> Any:
    """Samples of a response over time, a line per channel."""
    axes = _axes(axes)
    samples = response.ir
    seconds = np.arange(samples.shape[1]) / response.sample_rate
    for channel, line in enumerate(samples):
        axes.plot(seconds, line, linewidth=0.6, label=f"channel {channel + 1}")
    axes.set(xlabel="time, s", ylabel="pressure re 1 m",
             title=f"{response.source} to {response.listener}")
    if len(samples) > 1:
        axes.legend()
    return axes


def plot_decay(response: Any, *, channel: int = 0, axes: Any = None) -> Any:
    """Level and backward integrated (Schroeder's) decay of a response, decibels re its whole
    energy, broadband."""
    axes = _axes(axes)
    energy = np.square(response.ir[channel], dtype=np.float64)
    total = energy.sum()
    if not total > 0.0:
        raise ArgumentError("response", "is silent", "choose another channel")
    seconds = np.arange(len(energy)) / response.sample_rate
    with np.errstate(divide="ignore"):
        decay = 10.0 * np.log10(np.cumsum(energy[::-1])[::-1] / total)
        level = 10.0 * np.log10(energy / energy.max())
    axes.plot(seconds, level, linewidth=0.3, color="0.8", label="response")
    axes.plot(seconds, decay, color="C0", label="decay")
    axes.set(xlabel="time, s", ylabel="level, dB", ylim=(-80.0, 3.0),
             title=f"{response.source} to {response.listener}")
    axes.legend()
    return axes


def plot_echogram(response: Any, *, band_hz: float = 1000.0, axes: Any = None) -> Any:
    """Level of each path in a band over its delay, coloured by order."""
    axes = _axes(axes)
    paths, bands = response.paths, response.result.bands
    band = int(np.argmin(np.abs(np.log(bands / band_hz))))
    levels = paths.level_db[:, band]
    floor = (levels[np.isfinite(levels)].min() if np.isfinite(levels).any() else 0.0) - 5.0
    for order in np.unique(paths.order):
        chosen = (paths.order == order) & np.isfinite(levels)
        axes.vlines(1e3 * paths.delay[chosen], floor, levels[chosen], color=f"C{order % 10}",
                    label=f"order {order}")
    axes.set(xlabel="delay, ms", ylabel=f"level at {bands[band]:g} Hz, dB re 1 m",
             title=f"{response.source} to {response.listener}")
    axes.legend()
    return axes


def plot_metric(result: Any, name: str, source: str | int = 0, *, axes: Any = None) -> Any:
    """A metric of all listeners of a source: per band as lines, a single number as bars, both with
    their standard errors."""
    if name not in result.metrics:
        raise ArgumentError("name", f"is {name!r}", f"give one of {', '.join(result.metrics)}")
    axes = _axes(axes)
    row = result.sources.index(source)
    values, errors = result.metrics[name][row], result.standard_errors[name][row]
    errors = np.nan_to_num(errors)
    if values.ndim == 2:
        for listener, line, bar in zip(result.listeners, values, errors):
            axes.errorbar(result.bands, line, bar, capsize=2, label=listener)
        axes.set(xscale="log", xlabel="frequency, Hz")
        axes.legend()
    else:
        axes.bar(list(result.listeners), values, yerr=errors, capsize=2)
        axes.tick_params(axis="x", rotation=90)
    axes.set(ylabel=name, title=f"{name}, {result.sources[row]}")
    return axes
