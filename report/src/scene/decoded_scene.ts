// SPDX-License-Identifier: MIT
// The scene's triangles as arrays, fronts facing the air; decoded once for view and plans.
import type { ReportData, Vector } from "../data/schema";
import { decode_f32, decode_u16, decode_u32 } from "../data/decode";
import { face_air } from "./orientation";

export interface DecodedScene {
    positions: Float32Array;
    triangles: Uint32Array;
    /** Of each triangle. */
    material: Uint16Array;
    min: Vector;
    max: Vector;
}

/** Least and greatest coordinates of points, three numbers each. */
export function extent_of(positions: ArrayLike<number>): { min: Vector; max: Vector } {
    const min: Vector = [Infinity, Infinity, Infinity];
    const max: Vector = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < positions.length; ++i) {
        const axis = i % 3;
        min[axis] = Math.min(min[axis]!, positions[i]!);
        max[axis] = Math.max(max[axis]!, positions[i]!);
    }
    return { min, max };
}

export function decode_scene(data: ReportData): DecodedScene | null {
    if (!data.scene) {
        return null;
    }
    const positions = decode_f32(data.scene.positions_f32);
    const triangles = decode_u32(data.scene.triangles_u32);
    const material = decode_u16(data.scene.material_u16);
    if (triangles.length === 0 || triangles.some((i) => i >= positions.length / 3)) {
        return null;
    }
    const { min, max } = extent_of(positions);
    const middle: Vector = [0, 1, 2].map((a) => (min[a]! + max[a]!) / 2) as Vector;
    const eye = data.listeners?.[0]?.position ?? data.sources?.[0]?.position ?? middle;
    return { positions, triangles: face_air({ positions, triangles }, eye), material, min, max };
}
