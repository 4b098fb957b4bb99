// SPDX-License-Identifier: MIT
// Which stem of an echogram a click means.

/** The stem that a click means: the closest tip within reach, else the closest stem beside it. */
export function closest_stem(stems: { index: number; x: number; y: number }[], x: number, y: number): number | null {
    let best: number | null = null;
    let best_distance = 14;
    for (const stem of stems) {
        const beside = Math.abs(stem.x - x);
        const distance = Math.min(Math.hypot(stem.x - x, stem.y - y), y >= stem.y ? beside + 4 : Infinity);
        if (distance < best_distance) {
            best = stem.index;
            best_distance = distance;
        }
    }
    return best;
}
