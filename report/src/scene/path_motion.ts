// SPDX-License-Identifier: MIT
// Where sound is on its path at a time; and which path a pointer means.
import type { SoundPath, Vector } from "../data/schema";

/** The point that the front has reached at `time` seconds; null before it starts and after it has arrived. */
export function front_at(path: SoundPath, time: number): Vector | null {
    if (time < 0 || time > path.delay || path.delay <= 0) {
        return null;
    }
    let rest = (time / path.delay) * length_of(path.points);
    for (let i = 0; i + 1 < path.points.length; ++i) {
        const a = path.points[i]!;
        const b = path.points[i + 1]!;
        const leg = distance(a, b);
        if (rest <= leg) {
            const s = leg > 0 ? rest / leg : 0;
            return [0, 1, 2].map((k) => a[k]! + s * (b[k]! - a[k]!)) as Vector;
        }
        rest -= leg;
    }
    return path.points[path.points.length - 1] ?? null;
}

/** The part of the path that the front has passed. */
export function passed_points(path: SoundPath, time: number): Vector[] {
    if (time >= path.delay) {
        return path.points;
    }
    const front = front_at(path, time);
    if (front === null) {
        return [];
    }
    let rest = (time / path.delay) * length_of(path.points);
    const passed: Vector[] = [path.points[0]!];
    for (let i = 0; i + 1 < path.points.length; ++i) {
        rest -= distance(path.points[i]!, path.points[i + 1]!);
        if (rest <= 0) {
            break;
        }
        passed.push(path.points[i + 1]!);
    }
    passed.push(front);
    return passed;
}

function distance(a: Vector, b: Vector): number {
    return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

function length_of(points: Vector[]): number {
    let sum = 0;
    for (let i = 0; i + 1 < points.length; ++i) {
        sum += distance(points[i]!, points[i + 1]!);
    }
    return sum;
}

/** Distance of a point from a line segment in the plane of the screen. */
export function distance_to_segment(px: number, py: number, ax: number, ay: number, bx: number, by: number): number {
    const dx = bx - ax;
    const dy = by - ay;
    const squared = dx * dx + dy * dy;
    const s = squared > 0 ? Math.min(Math.max(((px - ax) * dx + (py - ay) * dy) / squared, 0), 1) : 0;
    return Math.hypot(px - ax - s * dx, py - ay - s * dy);
}
