// SPDX-License-Identifier: MIT
// Ticks of axes at 1, 2 or 5 times a power of ten.

export function tick_step(length: number, max_count: number): number {
    if (!(length > 0) || max_count < 1) {
        return 1;
    }
    const rough = length / max_count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const factor = [1, 2, 5, 10].find((f) => f * power >= rough * (1 - 1e-9)) ?? 10;
    return factor * power;
}

export function ticks(from: number, to: number, max_count: number): number[] {
    const step = tick_step(to - from, max_count);
    const first = Math.ceil(from / step - 1e-9);
    const last = Math.floor(to / step + 1e-9);
    return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => (first + i) * step);
}

/** Digits after the point that tell the ticks of a step apart. */
export function tick_digits(step: number): number {
    return Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
}
