// SPDX-License-Identifier: MIT
// The metrics of a pair: names, units, digits shown, and just-noticeable differences
// (ISO 3382-1:2009, table A.1; STI: Bradley, Reich and Norcross 1999).

export interface Metric {
    key: string;
    name: string;
    description: string;
    unit: string;
    digits: number;
    /** In the unit of `shown`, or a share of the value. */
    jnd: number;
    jnd_is_share: boolean;
    /** Values of the data times this are shown in `unit`. */
    scale: number;
    mid: string | null;
}

function metric(
    key: string, name: string, description: string, unit: string, digits: number, jnd: number,
    options: Partial<Metric> = {}
): Metric {
    return { key, name, description, unit, digits, jnd, jnd_is_share: false, scale: 1, mid: `${key}_mid`, ...options };
}

export const band_metrics: Metric[] = [
    metric("edt", "EDT", "early decay time", "s", 2, 0.05, { jnd_is_share: true }),
    metric("t20", "T20", "reverberation time from 5 to 25 dB of decay", "s", 2, 0.05, { jnd_is_share: true }),
    metric("t30", "T30", "reverberation time from 5 to 35 dB of decay", "s", 2, 0.05, { jnd_is_share: true }),
    metric("c50", "C50", "clarity of speech", "dB", 1, 1),
    metric("c80", "C80", "clarity of music", "dB", 1, 1),
    metric("d50", "D50", "definition", "", 2, 0.05),
    metric("ts", "Ts", "centre time", "ms", 0, 10, { scale: 1000 }),
    metric("g", "G", "strength, re free field at 10 m", "dB", 1, 1),
    metric("lf", "LF", "early lateral energy fraction", "", 2, 0.05, { mid: null }),
    metric("iacc_early", "IACC early", "interaural cross-correlation up to 80 ms", "", 2, 0.075, { mid: null }),
];

export const sti: Metric =
    metric("sti", "STI", "speech transmission index", "", 2, 0.03, { mid: null });

export const all_metrics: Metric[] = [...band_metrics, sti];

export function find_metric(key: string): Metric | undefined {
    return all_metrics.find((m) => m.key === key);
}
