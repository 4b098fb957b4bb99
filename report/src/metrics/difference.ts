// SPDX-License-Identifier: MIT
// How many just-noticeable differences lie between a value and its reference.
import type { Metric } from "./definitions";

/** Positive where the value is above the reference. Values are in the units of the data. */
export function difference_in_jnd(metric: Metric, value: number | null, reference: number | null): number | null {
    if (value === null || reference === null) {
        return null;
    }
    const step = metric.jnd_is_share ? metric.jnd * Math.abs(reference) : metric.jnd / metric.scale;
    return step > 0 ? (value - reference) / step : null;
}

/** The class of a table cell: steps of one just-noticeable difference, up to three. */
export function jnd_class(difference: number | null): string | null {
    if (difference === null) {
        return null;
    }
    const size = Math.abs(difference);
    const step = size < 1 ? 0 : size < 2 ? 1 : size < 3 ? 2 : 3;
    return step === 0 ? "jnd-same" : `jnd-${difference > 0 ? "above" : "below"}-${step}`;
}
