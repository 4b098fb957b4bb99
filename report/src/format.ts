// SPDX-License-Identifier: MIT
// Numbers as text, with the minus sign of typography.

export const dash = "\u2013";
const minus = "\u2212";
const no_break = "\u00a0";

export function number(value: number | null | undefined, digits: number): string {
    if (value === null || value === undefined || !Number.isFinite(value)) {
        return dash;
    }
    const text = value.toFixed(digits);
    const is_zero = Number(text) === 0;
    return is_zero ? (0).toFixed(digits) : text.replace("-", minus);
}

/** At least two significant digits and at most the digits of a table's values, plus one. */
export function error(value: number, digits: number): string {
    const needed = value > 0 ? Math.ceil(1 - Math.log10(value)) : digits;
    return number(value, Math.min(Math.max(needed, digits), digits + 1));
}

export function signed(value: number | null | undefined, digits: number): string {
    const text = number(value, digits);
    return typeof value === "number" && Number(value.toFixed(digits)) > 0 ? `+${text}` : text;
}

export function with_unit(text: string, unit: string): string {
    return unit === "" || text === dash ? text : `${text}${no_break}${unit}`;
}

/** Centre frequency as in standards: 63 Hz, 1 kHz, 31.5 Hz. */
export function band(frequency_hz: number): string {
    return frequency_hz < 1000 ? `${frequency_hz}${no_break}Hz` : `${frequency_hz / 1000}${no_break}kHz`;
}

export function milliseconds(seconds: number, digits = 1): string {
    return with_unit(number(1000 * seconds, digits), "ms");
}

export function decibels(value: number | null | undefined, digits = 1): string {
    return with_unit(number(value, digits), "dB");
}

export function percent(share: number | null | undefined, digits = 0): string {
    const has_value = share !== null && share !== undefined;
    return with_unit(number(has_value ? 100 * share : null, digits), "%");
}
