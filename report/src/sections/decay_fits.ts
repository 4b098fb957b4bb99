// SPDX-License-Identifier: MIT
// Lines fitted to decay curves.
import type { FitLine } from "../data/schema";

/** A fitted line at the curve's times; null outside of its range. */
export function line_values(fit: FitLine, times: number[]): (number | null)[] {
    const slope = (fit.level_to - fit.level_from) / (fit.to - fit.from);
    const margin = (times[1] ?? 0) / 2;
    return times.map((t) => t < fit.from - margin || t > fit.to + margin ? null : fit.level_from + slope * (t - fit.from));
}

/** Reverberation time of a line: 60 dB over its slope. */
export function fit_time(fit: FitLine): number {
    return (-60 * (fit.to - fit.from)) / (fit.level_to - fit.level_from);
}
