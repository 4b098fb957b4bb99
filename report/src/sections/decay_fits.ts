// SPDX-License-Identifier: MIT
// Lines fitted to decay curves.
import type { FitLine } from "../data/schema";

/** A fitted line's level at a time. */
function level_at(fit: FitLine, time: number): number {
    return fit.level_from + ((fit.level_to - fit.level_from) / (fit.to - fit.from)) * (time - fit.from);
}

/** A fitted line at the curve's times; null outside of the range that it was fitted to. */
export function line_values(fit: FitLine, times: number[]): (number | null)[] {
    const margin = (times[1] ?? 0) / 2;
    return times.map((t) => t < fit.from - margin || t > fit.to + margin ? null : level_at(fit, t));
}

/** The same line as far as it lies above a level. */
export function extended_values(fit: FitLine, times: number[], lowest_level_db: number): (number | null)[] {
    return times.map((t) => {
        const level = level_at(fit, t);
        return level < lowest_level_db ? null : level;
    });
}

/** Reverberation time of a line: 60 dB over its slope. */
export function fit_time(fit: FitLine): number {
    return (-60 * (fit.to - fit.from)) / (fit.level_to - fit.level_from);
}
