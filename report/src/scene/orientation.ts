// SPDX-License-Identifier: MIT
// Turns triangles so that their front faces the air, whatever the winding of the file was: the view
// then shows a room from outside through the backs of its walls.

type Triangles = { positions: Float32Array; triangles: Uint32Array };

/** Connected parts over corners at equal places: the part of each triangle. */
export function connected_parts({ positions, triangles }: Triangles): { part: Uint32Array; count: number } {
    const corner_of = new Map<string, number>();
    const corners = new Uint32Array(positions.length / 3);
    for (let i = 0; i < corners.length; ++i) {
        const key = `${positions[3 * i]},${positions[3 * i + 1]},${positions[3 * i + 2]}`;
        const known = corner_of.get(key);
        corners[i] = known ?? i;
        if (known === undefined) {
            corner_of.set(key, i);
        }
    }
    const parent = Uint32Array.from({ length: corners.length }, (_, i) => i);
    const root = (i: number): number => {
        while (parent[i] !== i) {
            parent[i] = parent[parent[i]!]!;
            i = parent[i]!;
        }
        return i;
    };
    for (let t = 0; t < triangles.length; t += 3) {
        const a = root(corners[triangles[t]!]!);
        parent[root(corners[triangles[t + 1]!]!)] = a;
        parent[root(corners[triangles[t + 2]!]!)] = a;
    }
    const number_of = new Map<number, number>();
    const part = new Uint32Array(triangles.length / 3);
    for (let t = 0; t < part.length; ++t) {
        const r = root(corners[triangles[3 * t]!]!);
        part[t] = number_of.get(r) ?? number_of.size;
        number_of.set(r, part[t]!);
    }
    return { part, count: number_of.size };
}

/** Signed solid angle of a triangle from a point (van Oosterom and Strackee 1983): positive if its front is turned away. */
function solid_angle({ positions, triangles }: Triangles, t: number, eye: readonly number[]): number {
    const corner = (k: number): number[] =>
        [0, 1, 2].map((axis) => positions[3 * triangles[3 * t + k]! + axis]! - eye[axis]!);
    const [a, b, c] = [corner(0), corner(1), corner(2)] as [number[], number[], number[]];
    const dot = (u: number[], v: number[]): number => u[0]! * v[0]! + u[1]! * v[1]! + u[2]! * v[2]!;
    const [la, lb, lc] = [Math.hypot(...a), Math.hypot(...b), Math.hypot(...c)];
    const volume =
        a[0]! * (b[1]! * c[2]! - b[2]! * c[1]!) - a[1]! * (b[0]! * c[2]! - b[2]! * c[0]!) + a[2]! * (b[0]! * c[1]! - b[1]! * c[0]!);
    return 2 * Math.atan2(volume, la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la);
}

/** Six times the volume that a triangle adds to that of its part. */
function volume_share({ positions, triangles }: Triangles, t: number): number {
    const at = (k: number, axis: number): number => positions[3 * triangles[3 * t + k]! + axis]!;
    return at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
        at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
        at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
}

/**
 * The triangles with those parts turned round whose backs face `eye`, a point in the air. Parts that
 * do not enclose or face it, such as furniture, are turned if they are inside out.
 */
export function face_air(mesh: Triangles, eye: readonly number[]): Uint32Array {
    const { part, count } = connected_parts(mesh);
    const angle = new Float64Array(count);
    const volume = new Float64Array(count);
    for (let t = 0; t < part.length; ++t) {
        angle[part[t]!]! += solid_angle(mesh, t, eye);
        volume[part[t]!]! += volume_share(mesh, t);
    }
    const closed_limit = 1e-3 * 4 * Math.PI;
    const turned = Uint32Array.from(mesh.triangles);
    for (let t = 0; t < part.length; ++t) {
        const p = part[t]!;
        const faces_away = Math.abs(angle[p]!) > closed_limit ? angle[p]! > 0 : volume[p]! < 0;
        if (faces_away) {
            turned[3 * t + 1] = mesh.triangles[3 * t + 2]!;
            turned[3 * t + 2] = mesh.triangles[3 * t + 1]!;
        }
    }
    return turned;
}
