// SPDX-License-Identifier: MIT
// The scale of the colours of listeners.

export interface Scale {
    from: number;
    to: number;
}

/** The scale of a metric over the listeners of the chosen pair's source; null without values. */
export function listener_scale(values: (number | null)[], jnd: number): Scale | null {
    const present = values.filter((v): v is number => v !== null);
    if (present.length === 0) {
        return null;
    }
    const from = Math.min(...present);
    const to = Math.max(...present);
    // At least four just-noticeable differences, so that equal seats look equal.
    const spread = Math.max((4 * jnd - (to - from)) / 2, 0);
    return { from: from - spread, to: to + spread };
}
