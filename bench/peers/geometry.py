# SPDX-License-Identifier: MIT
"""Geometric queries by earshot's Python package and by its peers, in turns in one process.

Closest hits: Embree 4 through embreex. Continuous collision detection of meshes and of elements:
ipctk, whose elementary queries are Tight-Inclusion's. Prints medians of processor time and ratios
to earshot's; README.md says in what the programs differ.
"""

import argparse
import csv
import os
import subprocess
import time
from fractions import Fraction
from pathlib import Path

import numpy as np

import earshot as es


def take_turns(repeats, *works):
    """Medians of processor time, seconds, of works that take turns, after one turn that warms up."""
    times = np.empty((repeats + 1, len(works)))
    for turn in times:
        for i, work in enumerate(works):
            start = time.process_time()
            work()
            turn[i] = time.process_time() - start
    return np.median(times[1:], axis=0), np.median(times[1:, 1:] / times[1:, :1], axis=0)


def bumpy_sphere(triangles):
    """A sphere of latitudes and longitudes with bumps: (n, 3) metres, (m, 3)."""
    rows = max(4, int((triangles / 4) ** 0.5))
    theta, phi = np.meshgrid(
        np.linspace(0.01, np.pi - 0.01, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows, False),
        indexing="ij")
    radius = 1 + 0.05 * np.sin(13 * theta) * np.cos(17 * phi) + 0.01 * np.sin(71 * phi + 53 * theta)
    vertices = np.stack([radius * np.sin(theta) * np.cos(phi), radius * np.cos(theta),
                         radius * np.sin(theta) * np.sin(phi)], axis=-1).reshape(-1, 3)
    row, column = np.meshgrid(np.arange(rows), np.arange(2 * rows), indexing="ij")
    a, b = row * 2 * rows + column, row * 2 * rows + (column + 1) % (2 * rows)
    c, d = a + 2 * rows, b + 2 * rows
    faces = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], -2).reshape(-1, 3)
    return vertices, faces


def mesh_of(file):
    if file is None:
        return bumpy_sphere(100_000)
    scene = es.load(file)
    return scene.vertices, scene.triangles


def random_rays(vertices, count):
    """Rays from points of the box of a mesh in all directions."""
    rng = np.random.default_rng(1)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return rng.uniform(low, high, size=(count, 3)), directions


def camera_rays(vertices, side):
    """A square picture from outside, in tiles of 8 x 8."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    eye = middle + 0.8 * size * np.array([0.3, 0.4, 1.2])
    look = (middle - eye) / np.linalg.norm(middle - eye)
    right = 0.4 * np.cross(look, [0, 1, 0]) / np.linalg.norm(np.cross(look, [0, 1, 0]))
    up = np.cross(right, look)
    tile, pixel = np.divmod(np.arange(side * side), 64)
    x = (tile % (side // 8) * 8 + pixel % 8 + 0.5) / side * 2 - 1
    y = 1 - (tile // (side // 8) * 8 + pixel // 8 + 0.5) / side * 2
    directions = look + x[:, None] * right + y[:, None] * up
    return np.repeat(eye[None], side * side, axis=0), directions


def compare_rays(files, repeats):
    if not files:
        return
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    print("\nClosest hits, million rays per second of arrays, and Embree 4's time / earshot's\n")
    print("| mesh | triangles | rays | earshot | Embree 4 | ratio | other triangles |")
    print("| --- | ---: | --- | ---: | ---: | ---: | ---: |")
    for file in files:
        vertices, faces = mesh_of(file)
        bvh = es.Bvh(vertices, faces, builder="quality", threads=1)
        scene = EmbreeScene()
        TriangleMesh(scene, np.asarray(vertices, np.float32), np.asarray(faces, np.int32))
        for kind, (origins, directions) in (("random", random_rays(vertices, 1 << 20)),
                                            ("camera", camera_rays(vertices, 1024))):
            single = np.asarray(origins, np.float32), np.asarray(directions, np.float32)
            scene.run(single[0][:8], single[1][:8])  # builds
            found = {}

            def ours():
                found["earshot"] = bvh.closest_hits(origins, directions, threads=1).triangle

            def theirs():
                found["Embree"] = scene.run(*single)

            (own, other), ratios = take_turns(repeats, ours, theirs)
            hits = found["earshot"].astype(np.int64)
            hits[hits == es.NONE] = -1
            differ = np.count_nonzero(hits != found["Embree"])
            count = len(origins)
            print(f"| {Path(file).name if file else 'bumpy sphere'} | {len(faces)} | {kind} "
                  f"| {1e-6 * count / own:.2f} | {1e-6 * count / other:.2f} | {ratios[0]:.2f} "
                  f"| {1e6 * differ / count:.0f} ppm |", flush=True)


def read_queries(file):
    """(n, 8, 3) positions, rounded to doubles, and whether there is a contact."""
    with open(file, newline="") as lines:
        rows = [[int(number) for number in row] for row in csv.reader(lines) if row]
    points = np.array([[float(Fraction(row[2 * k], row[2 * k + 1])) for k in range(3)]
                       for row in rows]).reshape(-1, 8, 3)
    return points, np.array([row[6] for row in rows[::8]], bool)


def compare_elements(folder, bench):
    """Elementary queries: the peer's calls cost time of their own, which a trivial call tells."""
    import ipctk

    tested = ipctk.TightInclusionCCD()
    printed = subprocess.run([os.path.join(bench, "bench_collision"), folder], check=True,
                             capture_output=True, text=True).stdout
    ours = {}
    for line in printed.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[0] in ("vertex-face", "edge-edge"):
            ours[cells[0]] = cells
    print("\nElementary queries, microseconds, and ipctk's mean / earshot's\n")
    print("| queries | count | earshot: wrong | mean | median | ipctk: wrong | mean | median "
          "| an empty call | ratio |")
    print("| --- " + "| ---: " * 9 + "|")
    for kind, query, empty in (
            ("vertex-face", tested.point_triangle_ccd, ipctk.point_triangle_aabb_ccd),
            ("edge-edge", tested.edge_edge_ccd, ipctk.edge_edge_aabb_ccd)):
        times, calls, wrong = [], [], 0
        for file in sorted(Path(folder).glob(f"*/{kind}/*.csv")):
            for points, truth in zip(*read_queries(file)):
                start = time.perf_counter()
                found = query(*points)[0]
                between = time.perf_counter()
                empty(*points, 0.0)
                calls.append(time.perf_counter() - between)
                times.append(between - start)
                wrong += found != truth
        call = 1e6 * np.median(calls)
        mean = 1e6 * np.mean(times) - call
        own = ours[kind]
        print(f"| {kind} | {len(times)} | {own[3]} | {own[4]} | {own[5]} | {wrong} | {mean:.2f} "
              f"| {max(0.0, 1e6 * np.median(times) - call):.2f} | {call:.2f} "
              f"| {mean / float(own[4]):.1f} |", flush=True)


def compare_steps(files, repeats):
    """The first contact within a mesh that moves from one file's vertices to another's."""
    import ipctk

    if files:
        begin, faces = mesh_of(files[0])
        end = mesh_of(files[1])[0]
        name = Path(files[0]).name
    else:
        begin, faces = bumpy_sphere(1_000)
        # The upper half goes through the lower one.
        end = begin * np.where(begin[:, 1:2] > 0, [[1.0, -1.2, 1.0]], 1.0)
        name = "bumpy sphere"
    start, stop = (np.asfortranarray(array, dtype=np.float64) for array in (begin, end))
    triangles = np.asfortranarray(faces, dtype=np.int32)
    mesh = ipctk.CollisionMesh(start, np.asfortranarray(ipctk.edges(triangles)), triangles)
    world = es.World()
    part = world.add("mesh", begin, faces)
    found = {}

    def ours():
        world.step(part, begin, end)
        contact = world.first_contact(self_contacts=True, threads=1)
        found["earshot"] = 1.0 if contact is None else contact.toi

    def theirs(phase):
        found[phase] = ipctk.compute_collision_free_stepsize(
            mesh, start, stop, 0.0, getattr(ipctk, phase)())

    phases = ("LBVH", "HashGrid")
    times, ratios = take_turns(
        repeats, ours, *(lambda phase=phase: theirs(phase) for phase in phases))
    print(f"\nFirst contact in a step, {name}, {len(faces)} triangles, with itself, milliseconds\n")
    print("| | time | / earshot's | step |\n| --- | ---: | ---: | ---: |")
    for key, seconds, ratio in zip(("earshot", *phases), times, (1.0, *ratios)):
        label = key if key == "earshot" else f"ipctk, {key}"
        print(f"| {label} | {1e3 * seconds:.1f} | {ratio:.2f} | {found[key]:.9f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bench", required=True, help="folder of bench_collision")
    parser.add_argument("--mesh", nargs="*", help="meshes for rays, if any; default: a generated one")
    parser.add_argument("--queries", help="folder of elementary queries in CSV files")
    parser.add_argument("--cloth", nargs=2, help="a mesh before and after a step")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    print(f"earshot {es.__version__}, one thread, medians of {options.repeats}")
    compare_rays([None] if options.mesh is None else options.mesh, options.repeats)
    compare_steps(options.cloth, options.repeats)
    if options.queries:
        compare_elements(options.queries, options.bench)


if __name__ == "__main__":
    main()
