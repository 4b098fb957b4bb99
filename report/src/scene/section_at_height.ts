// SPDX-License-Identifier: MIT
// Lines in which a horizontal plane cuts the scene: the walls of a plan.
import type { DecodedScene } from "./decoded_scene";

/** A line from (x0, z0) to (x1, z1). */
export type PlanLine = [number, number, number, number];

export function section_at_height(scene: DecodedScene, height: number): PlanLine[] {
    const { positions, triangles } = scene;
    const lines: PlanLine[] = [];
    for (let t = 0; t < triangles.length; t += 3) {
        const points: [number, number][] = [];
        for (let k = 0; k < 3; ++k) {
            const a = 3 * triangles[t + k]!;
            const b = 3 * triangles[t + ((k + 1) % 3)]!;
            const ya = positions[a + 1]! - height;
            const yb = positions[b + 1]! - height;
            if (ya < 0 !== yb < 0) {
                const s = ya / (ya - yb);
                points.push([
                    positions[a]! + s * (positions[b]! - positions[a]!),
                    positions[a + 2]! + s * (positions[b + 2]! - positions[a + 2]!),
                ]);
            }
        }
        const [p, q] = points;
        if (p && q) {
            lines.push([p[0], p[1], q[0], q[1]]);
        }
    }
    return lines;
}
