# SPDX-License-Identifier: MIT
"""Three jobs by pyroomacoustics and by earshot's Python package, in one run, in turns.

    bench/peers/run_side_by_side /tmp/peers build/release/python

An L-shaped room with rays, a shoe-box of order 17, and an array of eight microphones; conventions
as docs/pyroomacoustics.md lists them. Prints the processor time of both, whether their paths are
the same, how far the responses are apart, and how far each is from the sum of the paths. Last, the
energy of rays beside that of the image sources for which they stand.
"""

import argparse
import statistics
import time

import numpy as np
import pyroomacoustics as pra

import earshot as es

RATE = 16000
FILTER_DELAY = 40  # samples; half of pyroomacoustics' fractional delay filter
SPEED = 343.0
TEMPERATURE = 293.15 * (SPEED / 343.2) ** 2 - 273.15  # at which earshot's speed of sound is that
OCTAVES = [125, 250, 500, 1000, 2000, 4000, 8000]
RAYS = 20000
# In the boxes.
SOURCE, MICROPHONE = (1.031, 1.413, 0.972), (4.022, 1.234, 3.087)


def set_conventions():
    """One thread, and no high-pass filter, which earshot does not have."""
    pra.constants.set("num_threads", 1)
    pra.constants.set("rir_hpf_enable", False)


class Job:
    """A room, and the options of both programs."""

    def __init__(self, name, *, order, source, microphones, rays=0):
        self.name, self.order, self.rays = name, order, rays
        self.source, self.microphones = np.asarray(source), np.asarray(microphones)

    def pra(self):
        """pyroomacoustics' room, with responses."""
        room = self.pra_room()
        room.add_source(self.to_pra(self.source))
        room.add_microphone_array(self.to_pra(self.microphones).T)
        room.compute_rir()
        return room

    def es(self, **options):
        """earshot's result."""
        room = self.es_room()
        room.add_source("source", self.source)
        room.add_listeners(self.microphones, "microphone")
        if self.rays:
            options = {"rays_error": 0.0, **options}  # all rays
        return es.simulate(room, **{
            "order": self.order, "rays": self.rays, "sample_rate": RATE, "air_absorption": False,
            "temperature": TEMPERATURE, "metrics": False, "threads": 1, **options})

    def to_pra(self, points):
        return points


class LShape(Job):
    CORNERS = [(0, 0), (9, 0), (9, 4), (5, 4), (5, 7), (0, 7)]
    HEIGHT = 3.2

    def to_pra(self, points):
        """Floor plans lie in x, y there and in x, z here."""
        return points[..., [0, 2, 1]]

    def pra_room(self):
        material = pra.Material(0.3, 0.1)
        room = pra.Room.from_corners(
            np.transpose(self.CORNERS), fs=RATE, max_order=self.order, materials=material,
            ray_tracing=True, air_absorption=False)
        room.extrude(self.HEIGHT, materials=material)
        room.set_ray_tracing(n_rays=self.rays, receiver_radius=0.5)
        return room

    def es_room(self):
        return es.extrude(self.CORNERS, self.HEIGHT, absorption=0.3, scattering=0.1)


class ShoeBox(Job):
    SIZE = (6, 3, 5)
    ABSORPTION = 0.3

    def pra_room(self):
        absorption = self.ABSORPTION
        if isinstance(absorption, dict):
            absorption = {"coeffs": list(absorption.values()), "center_freqs": list(absorption)}
        return pra.ShoeBox(self.SIZE, fs=RATE, materials=pra.Material(absorption),
                           max_order=self.order, air_absorption=False)

    def es_room(self):
        return es.shoebox(self.SIZE, absorption=self.ABSORPTION, scattering=0.0)


class Bands(ShoeBox):
    ABSORPTION = dict(zip(OCTAVES, (0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40)))


class RayBox(ShoeBox):
    """Rays from order 4 on."""

    def pra_room(self):
        room = pra.ShoeBox(self.SIZE, fs=RATE, materials=pra.Material(self.ABSORPTION, 0.0),
                           max_order=self.order, ray_tracing=True, air_absorption=False)
        room.set_ray_tracing(n_rays=self.rays, receiver_radius=0.5)
        return room


def circle(centre, radius, count):
    angles = 2.0 * np.pi * np.arange(count) / count
    return centre + radius * np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], axis=1)


JOBS = [
    LShape(f"L-shaped room, order 3, {RAYS} rays, 2 microphones", order=3, rays=RAYS,
           source=(8, 1.6, 2.5), microphones=[(2.1, 1.2, 2), (3.5, 1.2, 6)]),
    ShoeBox("shoe-box, order 17", order=17, source=SOURCE, microphones=[MICROPHONE]),
    Bands("shoe-box with bands, order 10, 8 microphones", order=10, source=SOURCE,
          microphones=circle(np.array(MICROPHONE), 0.05, 8)),
]


SIDES = ("pyroomacoustics", "earshot", "earshot with paths")


def compare_times(job, repeats):
    """Milliseconds of processor time, (repeats, 3), after one turn that warms up."""
    times = np.empty((repeats + 1, len(SIDES)))
    for turn in times:
        for side, work in enumerate((job.pra, lambda: job.es(paths=False), job.es)):
            start = time.process_time()
            work()
            turn[side] = time.process_time() - start
    return 1e3 * times[1:]


def decibels(energy, reference):
    return 10.0 * np.log10(energy / reference)


# Paths by order, then delay: where all walls are alike, amplitudes follow from these.


def pra_paths(room, microphone):
    """Delays in samples, and amplitudes of 1 kHz or of all frequencies."""
    source = room.sources[0]
    heard = np.asarray(room.visibility[0][microphone], bool)
    distance = np.linalg.norm(
        source.images[:, heard] - room.mic_array.R[:, microphone, None], axis=0)
    damping = source.damping[min(3, len(source.damping) - 1), heard]
    by_order = np.lexsort((distance, source.orders[heard]))
    return RATE * distance[by_order] / room.c, (damping / distance)[by_order]


def es_paths(result, microphone):
    paths = result.paths[0, microphone]
    by_order = np.lexsort((paths.delay, paths.order))
    return RATE * paths.delay[by_order], paths.pressure[by_order, 5]


def compare_paths(room, result):
    for microphone in range(len(room.mic_array)):
        delays, amplitudes = pra_paths(room, microphone)
        ours, pressures = es_paths(result, microphone)
        line = f"  microphone {microphone + 1}: {len(delays)} and {len(ours)} paths"
        if len(delays) == len(ours):
            line += (f"; delays differ by at most {np.abs(delays - ours).max():.1e} samples, "
                     f"amplitudes by {np.abs(pressures / amplitudes - 1.0).max():.1e}")
        print(line)


def responses(room, result, microphone):
    """Both as doubles of one length that begin at pyroomacoustics' time 0."""
    theirs, ours = room.rir[microphone][0], result.ir[0, microphone, 0]
    length = max(len(theirs), len(ours) + FILTER_DELAY)
    padded = np.zeros((2, length))
    padded[0, : len(theirs)] = theirs
    padded[1, FILTER_DELAY : FILTER_DELAY + len(ours)] = ours
    return padded


def spectrum_of_sum(delays, amplitudes, length):
    """The exact sum of paths without walls' filters: its Fourier transform."""
    turns = np.arange(length // 2 + 1) / length
    spectrum = np.zeros(len(turns), complex)
    for first in range(0, len(delays), 256):
        some = slice(first, first + 256)
        phase = np.outer(delays[some] + FILTER_DELAY, turns)
        spectrum += amplitudes[some] @ np.exp(-2j * np.pi * phase)
    return spectrum


RANGES = ((0, 200), (200, 2000), (2000, 6000), (6000, 8000))


def energies(spectrum, length):
    """Of each of RANGES, and in all."""
    hertz = RATE * np.arange(len(spectrum)) / length
    power = np.abs(spectrum) ** 2
    return np.array([power[(hertz >= low) & (hertz < high)].sum() for low, high in RANGES]
                    + [power.sum()])


def row(name, values):
    print(f"  {name:<34}" + "".join(f"{value:10.2f}" for value in values))


def compare_responses(job, room, result):
    """Errors in decibels of the energy in the same frequencies."""
    padded = np.pad(responses(room, result, 0), ((0, 0), (0, 4096)))
    length = padded.shape[1]
    theirs, ours = np.fft.rfft(padded)
    print("  dB in Hz                          "
          + "".join(f"{low:>5}-{high}" for low, high in RANGES) + "       all")
    row("level, earshot - pyroomacoustics",
        decibels(energies(ours, length), energies(theirs, length)))
    row("energy of the difference",
        decibels(energies(ours - theirs, length), energies(ours, length)))
    if job.rays == 0 and not isinstance(job, Bands):
        exact = spectrum_of_sum(*es_paths(result, 0), length)
        for name, spectrum in (("pyroomacoustics", theirs), ("earshot", ours)):
            row(f"{name} - sum of paths",
                decibels(energies(spectrum - exact, length), energies(exact, length)))


def reverberation_time(response):
    """T30 of the whole response, by Schroeder's integral: seconds."""
    decay = np.cumsum(response[::-1] ** 2)[::-1]
    level = decibels(np.maximum(decay, 1e-30), decay[0])
    begin, end = np.argmax(level <= -5.0), np.argmax(level <= -35.0)
    slope = np.polyfit(np.arange(begin, end) / RATE, level[begin:end], 1)[0]
    return -60.0 / slope


def late_level(response, arrival, seconds):
    """Energy after a time since the first arrival, of the energy before it, in decibels."""
    split = int(arrival + FILTER_DELAY + seconds * RATE)
    return decibels(np.sum(response[split:] ** 2), np.sum(response[:split] ** 2))


def describe_decay(name, seeds):
    """Mean and spread over seeds of (T30, late level, level) of responses."""
    mean, spread = np.mean(seeds, axis=0), np.std(seeds, axis=0, ddof=1)
    print(f"    {name:<16} T30 {mean[0]:.3f} +- {spread[0]:.3f} s, after 50 ms {mean[1]:.2f} +- "
          f"{spread[1]:.2f} dB, level {mean[2]:.2f} +- {spread[2]:.2f} dB")


def compare_decays(job, seeds=8):
    """What rays leave to chance: responses of several seeds."""
    expected = job.es(metrics=True)
    found = {}
    for seed in range(1, seeds + 1):
        pra.random.seed(numpy=seed, libroom=seed)
        room, result = job.pra(), job.es(seed=seed)
        for microphone in range(len(job.microphones)):
            first = es_paths(result, microphone)[0].min()
            for side, response in zip(("pyroomacoustics", "earshot"),
                                      responses(room, result, microphone)):
                level = decibels(np.sum(response**2), 1.0)
                found.setdefault((microphone, side), []).append(
                    (reverberation_time(response), late_level(response, first, 0.05), level))
    for microphone in range(len(job.microphones)):
        print(f"  microphone {microphone + 1}, {seeds} seeds:")
        for side in ("pyroomacoustics", "earshot"):
            describe_decay(side, found[microphone, side])
        print(f"    earshot's expected T30 of 1 kHz: {expected.metrics['t30'][0, microphone, 5]:.3f} s")
    same = np.array_equal(job.es(seed=1).ir, job.es(seed=1).ir)
    print(f"  earshot twice with one seed: {'the same' if same else 'other'} samples")


SPANS = ((0.0, 0.05), (0.05, 0.1), (0.1, 0.2), (0.2, 0.4))  # seconds


def in_spans(energy, times):
    return np.array([energy[(times >= begin) & (times < end)].sum() for begin, end in SPANS])


def rays_of(response, early):
    """Energy of a response without its image sources, per span."""
    rest = np.array(response, float)
    length = min(len(rest), len(early))
    rest[:length] -= early[:length]
    return in_spans(rest**2, np.arange(len(rest)) / RATE)


def compare_rays(seeds=8):
    """Energy of rays in decibels of the image sources of the same orders, which is exact."""
    position = {"source": SOURCE, "microphones": [MICROPHONE]}
    job = RayBox("", order=3, rays=RAYS, **position)
    paths = job.es(order=60, rays=0, length=1.0).paths[0, 0]
    exact, twice = (in_spans(paths.pressure[:, 5] ** 2 * (paths.order >= order), paths.delay)
                    for order in (4, 3))
    early = ShoeBox("", order=3, **position).pra().rir[0][0]
    found = {name: [] for name in ("earshot, histogram", "earshot, response",
                                   "pyroomacoustics, histogram", "pyroomacoustics, response")}
    for seed in range(1, seeds + 1):
        pra.random.seed(numpy=seed, libroom=seed)
        room, result = job.pra(), job.es(seed=seed, histograms=True)
        ours, theirs = result.histogram(0, 0), np.array(room.rt_histograms[0][0])[0, 0]
        width = room.rt_args["hist_bin_size"]
        response = result.ir[0, 0, 0]
        ours_early = job.es(rays=0, length=len(response) / RATE).ir[0, 0, 0]
        for name, energy in zip(found, (
                in_spans(ours.energy[:, 5], ours.bin * (np.arange(len(ours.energy)) + 0.5)),
                rays_of(response, ours_early),
                in_spans(theirs, width * (np.arange(len(theirs)) + 0.5)),
                rays_of(room.rir[0][0], early))):
            found[name].append(energy)
    print(f"\nshoe-box, scattering 0, order 3 and {RAYS} rays, {seeds} seeds: dB re image sources of "
          "orders 4 to 60")
    print("  seconds                           "
          + "".join(f"{begin:>5}-{end:<4}" for begin, end in SPANS))
    row("image sources of orders 3 to 60", decibels(twice, exact))
    for name, energy in found.items():
        row(name, decibels(np.mean(energy, axis=0), exact))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=15)
    repeats = parser.parse_args().repeats
    set_conventions()
    print(f"pyroomacoustics {pra.__version__}, earshot {es.__version__}, numpy {np.__version__}")
    for job in JOBS:
        print(f"\n{job.name}")
        times = compare_times(job, repeats)
        for side, name in enumerate(SIDES):
            print(f"  {name:<19}{statistics.median(times[:, side]):8.2f} ms, "
                  f"at least {times[:, side].min():.2f}")
        room, result = job.pra(), job.es()
        compare_paths(room, result)
        compare_responses(job, room, result)
        if job.rays:
            compare_decays(job)
    compare_rays()


if __name__ == "__main__":
    main()
