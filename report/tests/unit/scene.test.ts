// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import { test } from "node:test";
import type { SoundPath } from "../../src/data/schema";
import { connected_parts, face_air } from "../../src/scene/orientation";
import { distance_to_segment, front_at, passed_points } from "../../src/scene/path_motion";
import { section_at_height } from "../../src/scene/section_at_height";
import { listener_scale } from "../../src/scene/listener_scale";
import { box_paths, room_mesh, size } from "../fixture/box_room.mjs";

type Mesh = { positions: Float32Array; triangles: Uint32Array };

function mesh_of(quads: { positions: number[]; triangles: number[] }): Mesh {
    return { positions: new Float32Array(quads.positions), triangles: new Uint32Array(quads.triangles) };
}

function flipped(mesh: Mesh, from = 0, to = mesh.triangles.length): Mesh {
    const triangles = mesh.triangles.slice();
    for (let t = from; t < to; t += 3) {
        triangles[t + 1] = mesh.triangles[t + 2]!;
        triangles[t + 2] = mesh.triangles[t + 1]!;
    }
    return { positions: mesh.positions, triangles };
}

test("fronts face the air whatever the winding of rooms and furniture is", () => {
    const mesh = mesh_of(room_mesh(2));
    const room_end = 3 * 12 * 4;
    const eye = [1.6, 1.2, 2.9];
    assert.equal(connected_parts(mesh).count, 14);
    for (const wound of [mesh, flipped(mesh), flipped(mesh, 0, room_end), flipped(mesh, room_end)]) {
        assert.deepEqual(face_air(wound, eye), mesh.triangles);
    }
});

test("a single sheet faces the listener", () => {
    const sheet = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), triangles: new Uint32Array([0, 1, 2]) };
    assert.deepEqual([...face_air(sheet, [0.2, 0.2, 3])], [0, 1, 2]);
    assert.deepEqual([...face_air(sheet, [0.2, 0.2, -3])], [0, 2, 1]);
});

test("a plan's lines are the walls at its height", () => {
    const { positions, triangles } = mesh_of(room_mesh(1));
    const lines = section_at_height({ positions, triangles, material: new Uint16Array(), min: [0, 0, 0], max: [0, 0, 0] }, 1.5);
    const length = lines.reduce((sum, [x0, z0, x1, z1]) => sum + Math.hypot(x1 - x0, z1 - z0), 0);
    assert.ok(Math.abs(length - 2 * (size[0]! + size[2]!)) < 1e-5);
});

const path: SoundPath = { order: 1, length: 7, delay: 0.7, points: [[0, 0, 0], [3, 0, 0], [3, 4, 0]], pressure: [1] };

test("the front moves along the legs of a path at constant speed", () => {
    assert.deepEqual(front_at(path, 0), [0, 0, 0]);
    const near = (p: number[] | null, q: number[]): void => q.forEach((x, k) => assert.ok(Math.abs(p![k]! - x) < 1e-9));
    near(front_at(path, 0.15), [1.5, 0, 0]);
    near(front_at(path, 0.5), [3, 2, 0]);
    assert.equal(front_at(path, 0.71), null);
    assert.equal(passed_points(path, 0.5).length, 3);
    assert.equal(passed_points(path, 0.1).length, 2);
    assert.deepEqual(passed_points(path, 2), path.points);
});

test("the made-up paths are as long as they say, and reflect at walls", () => {
    for (const { points, length, order } of box_paths([3.3, 1.6, 1.1], [6, 1.2, 8], 3)) {
        const sum = points.slice(1).reduce((s: number, p: number[], i: number) => s + Math.hypot(...p.map((x, k) => x - points[i]![k]!)), 0);
        assert.ok(Math.abs(sum - length) < 1e-9);
        assert.equal(points.length, order + 2);
    }
});

test("distance in the plane of the screen is to the segment, not to its line", () => {
    assert.equal(distance_to_segment(5, 3, 0, 0, 10, 0), 3);
    assert.equal(distance_to_segment(13, 4, 0, 0, 10, 0), 5);
    assert.equal(distance_to_segment(3, 4, 0, 0, 0, 0), 5);
});

test("the scale of listeners spans at least four just-noticeable differences", () => {
    assert.equal(listener_scale([null], 1), null);
    assert.deepEqual(listener_scale([5, null, 6], 1), { from: 3.5, to: 7.5 });
    assert.deepEqual(listener_scale([0, 10], 1), { from: 0, to: 10 });
});
