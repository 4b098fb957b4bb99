// SPDX-License-Identifier: MIT
// Levels of energies with standard errors.

/** Levels at so many standard errors from the expected energy; null where nothing remains. */
export function error_levels(levels: (number | null)[], relative_errors: (number | null)[], count: number): (number | null)[] {
    return levels.map((level, i) => {
        const factor = 1 + count * (relative_errors[i] ?? 0);
        return level === null || factor <= 0 ? null : level + 10 * Math.log10(factor);
    });
}
