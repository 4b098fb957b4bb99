# SPDX-License-Identifier: MIT
"""What the way through Python costs: the same work in C++ and in Python, in turns.

    PYTHONPATH=build/release/python python3 bench/python_loops.py build/release/bench/bench_python_loops.so

Random shoe-boxes one by one, in one thread and in two at the same time, and lines of sight in one
call. The C++ side is bench_python_loops.so, which works in this process; every answer is compared.
Times are processor times, those of two threads wall-clock times.
"""

import argparse
import ctypes
import pathlib
import statistics
import threading
import time

import numpy as np

import earshot as es

SCENE = pathlib.Path(__file__).resolve().parents[1] / "scenes" / "concert_hall.gltf"
BLOCK = 50  # rooms that one side simulates before it is the other's turn


class Rooms(ctypes.Structure):
    _fields_ = [
        ("sizes", ctypes.c_void_p),
        ("absorption", ctypes.c_void_p),
        ("sources", ctypes.c_void_p),
        ("listeners", ctypes.c_void_p),
        ("listener_count", ctypes.c_uint64),
        ("rays", ctypes.c_uint64),
        ("sample_rate", ctypes.c_double),
        ("length", ctypes.c_double),
        ("order", ctypes.c_int32),
    ]


def address(array):
    return array.ctypes.data


class Job:
    """Random shoe-boxes of one source, by either side."""

    def __init__(self, library, count, *, microphones, order, rays):
        random = np.random.default_rng(1)
        self.library, self.count = library, count
        self.order, self.rays, self.microphones = order, rays, microphones
        self.sizes = random.uniform((3, 2.5, 3), (9, 4, 9), (count, 3))
        self.absorption = random.uniform(0.1, 0.6, count)
        inside = random.uniform(0.0, 1.0, (count, 2, 3)) * (self.sizes[:, None] - 1.0) + 0.5
        self.sources = np.ascontiguousarray(inside[:, 0])
        angles = 2.0 * np.pi * np.arange(microphones) / microphones
        array = 0.05 * np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], axis=1)
        self.listeners = np.ascontiguousarray(inside[:, 1, None] + array)
        self.options = {"order": order, "rays": rays, "sample_rate": 16000, "length": 0.5,
                        "metrics": False, "threads": 1}
        self.struct = Rooms(address(self.sizes), address(self.absorption), address(self.sources),
                            address(self.listeners), microphones, rays, 16000.0, 0.5, order)

    def simulate(self, index):
        room = es.shoebox(self.sizes[index], absorption=self.absorption[index], scattering=0.1)
        room.add_source("talker", self.sources[index])
        room.add_listeners(self.listeners[index], "microphone")
        return es.simulate(room, **self.options).ir

    def in_python(self, begin, end):
        for index in range(begin, end):
            self.simulate(index)

    def in_cpp(self, begin, end):
        assert self.library.bench_rooms(ctypes.byref(self.struct), begin, end, None) == 0

    def check(self):
        """The digest of all samples, which are the same on both sides."""
        theirs, ours = np.empty((2, self.count), np.uint64)
        assert self.library.bench_rooms(
            ctypes.byref(self.struct), 0, self.count, address(theirs)) == 0
        for index in range(self.count):
            responses = self.simulate(index)
            ours[index] = self.library.bench_digest(address(responses), responses.nbytes)
        assert np.array_equal(ours, theirs), np.nonzero(ours != theirs)
        return self.library.bench_digest(address(ours), ours.nbytes)


def processor_time(work, *arguments):
    start = time.process_time()
    work(*arguments)
    return time.process_time() - start


def compare_loops(job):
    """Seconds of processor time of all rooms in C++ and in Python, and the ratios of the blocks."""
    totals, ratios = [0.0, 0.0], []
    for begin in range(0, job.count, BLOCK):
        end = min(begin + BLOCK, job.count)
        cpp, python = (processor_time(work, begin, end) for work in (job.in_cpp, job.in_python))
        totals = [totals[0] + cpp, totals[1] + python]
        ratios.append(python / cpp)
    return totals, ratios


def wall_time(work, threads, count):
    """Seconds until each thread has done `count` rooms, its own in turn."""
    gate = threading.Barrier(threads + 1)

    def run(first):
        gate.wait()
        work(first, first + count)

    workers = [threading.Thread(target=run, args=(i * count,)) for i in range(threads)]
    for worker in workers:
        worker.start()
    gate.wait()
    start = time.perf_counter()
    for worker in workers:
        worker.join()
    return time.perf_counter() - start


def compare_threads(job, repeats):
    """How many times as many rooms two threads do as one, by side."""
    count, ratios = job.count // 2 // repeats, {"C++": [], "Python": []}
    for _ in range(repeats):
        for side, work in (("C++", job.in_cpp), ("Python", job.in_python)):
            one, two = (wall_time(work, threads, count) for threads in (1, 2))
            ratios[side].append(2.0 * one / two)
    return ratios


def rooms(library, count, repeats):
    print("| microphones | order | rays | C++, ms | Python, ms | ratio (blocks) | two threads, C++ | "
          "two threads, Python | digest |")
    print("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |")
    for microphones, order, rays in ((1, 3, 0), (1, 6, 0), (4, 6, 1000)):
        job = Job(library, count, microphones=microphones, order=order, rays=rays)
        digest = job.check()  # and warms up
        (cpp, python), ratios = compare_loops(job)
        gains = compare_threads(job, repeats)
        cells = [microphones, order, rays, f"{1e3 * cpp / count:.2f}", f"{1e3 * python / count:.2f}",
                 f"{python / cpp:.2f} ({min(ratios):.2f} - {max(ratios):.2f})"]
        cells += [f"{statistics.median(gains[side]):.2f} ({min(gains[side]):.2f} - "
                  f"{max(gains[side]):.2f})" for side in gains]
        print("| " + " | ".join(map(str, cells)) + f" | {digest:016x} |", flush=True)


def segments(kind, count, low, high):
    """Ends of segments in a box: anywhere, from few eyes to few targets, or close together."""
    random = np.random.default_rng(2)
    if kind == "eyes":
        eyes, targets = random.uniform(low, high, (25, 3)), random.uniform(low, high, (4000, 3))
        index = np.arange(count)
        return eyes[index // 4000 % 25], targets[index % 4000]
    start, end = random.uniform(low, high, (2, count, 3))
    return start, start + random.normal(scale=0.5, size=(count, 3)) if kind == "short" else end


def compare_sight(library, scene, kind, count, repeats):
    """Milliseconds of a call in C++ and in Python, the ratio of each turn, and how many see."""
    corners, faces = np.ascontiguousarray(scene.vertices), np.ascontiguousarray(scene.triangles)
    start, end = map(np.ascontiguousarray,
                     segments(kind, count, corners.min(axis=0), corners.max(axis=0)))
    theirs, ours = np.empty((2, count), np.bool_)
    peer = library.bench_sight_create(address(corners), len(corners), address(faces), len(faces),
                                      address(start), address(end), count)
    through_python = es.Sight(corners, faces)

    def in_python():
        ours[:] = through_python.visible(start, end, threads=1)

    times = np.empty((repeats + 1, 2))
    for turn in times:
        turn[:] = (processor_time(library.bench_sight, peer, address(theirs)),
                   processor_time(in_python))
    library.bench_sight_destroy(peer)
    assert np.array_equal(ours, theirs)
    return 1e3 * np.median(times[1:], axis=0), times[1:, 1] / times[1:, 0], ours.mean()


def sight(library, count, repeats):
    """Lines of sight in a concert hall, all in one call."""
    scene = es.load(SCENE)
    print(f"\n| {count} segments | visible, % | C++, ms | Python, ms | ratio (quartiles) |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for kind in ("random", "eyes", "short"):
        (cpp, python), ratios, share = compare_sight(library, scene, kind, count, repeats)
        low, middle, high = np.quantile(ratios, (0.25, 0.5, 0.75))
        print(f"| {kind} | {100.0 * share:.1f} | {cpp:.2f} | {python:.2f} | "
              f"{middle:.3f} ({low:.3f} - {high:.3f}) |", flush=True)


def load(file):
    library = ctypes.CDLL(file)
    count, pointer = ctypes.c_uint64, ctypes.c_void_p
    library.bench_digest.argtypes, library.bench_digest.restype = [pointer, count], count
    library.bench_rooms.argtypes = [pointer, count, count, pointer]
    library.bench_sight_create.argtypes = [pointer, count, pointer, count, pointer, pointer, count]
    library.bench_sight_create.restype = pointer
    library.bench_sight.argtypes, library.bench_sight.restype = [pointer, pointer], None
    library.bench_sight_destroy.argtypes, library.bench_sight_destroy.restype = [pointer], None
    return library


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("library", help="bench_python_loops.so")
    parser.add_argument("--rooms", type=int, default=1000, help="0: none")
    parser.add_argument("--segments", type=int, default=100_000, help="0: none")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    library = load(options.library)
    if options.rooms:
        rooms(library, options.rooms, options.repeats)
    if options.segments:
        sight(library, options.segments, 20 * options.repeats)


if __name__ == "__main__":
    main()
