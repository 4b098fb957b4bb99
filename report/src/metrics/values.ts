// SPDX-License-Identifier: MIT
// Values, standard errors and reasons of withheld values, read from a pair of metrics.json.
import type { Note, PairMetrics, PerBand } from "../data/schema";
import type { Metric } from "./definitions";

/** A band's index, or "mid": the mean of 500 Hz and 1 kHz; STI is the same for all of them. */
export type BandChoice = number | "mid";

const as_number = (value: unknown): number | null =>
    typeof value === "number" && Number.isFinite(value) ? value : null;

function in_record(record: Record<string, unknown> | null | undefined, metric: Metric, band: BandChoice): number | null {
    if (!record) {
        return null;
    }
    if (metric.key === "sti") {
        return as_number(record["sti"]);
    }
    if (band === "mid") {
        const single = record["single"] as Record<string, unknown> | undefined;
        return metric.mid === null ? null : as_number(single?.[metric.mid]);
    }
    const list = record[metric.key] as PerBand | undefined;
    return Array.isArray(list) ? as_number(list[band]) : null;
}

export function value_of(metrics: PairMetrics | undefined, metric: Metric, band: BandChoice): number | null {
    return in_record(metrics, metric, band);
}

export function error_of(metrics: PairMetrics | undefined, metric: Metric, band: BandChoice): number | null {
    return in_record(metrics?.standard_error, metric, band);
}

export function is_present(metrics: PairMetrics | undefined, metric: Metric): boolean {
    return metrics !== undefined && metric.key in metrics;
}

/** The note that tells why a value is null or what it is of. */
export function reason_of(
    metrics: PairMetrics | undefined, metric: Metric, band: BandChoice, bands: number[]
): string | null {
    const key = band === "mid" && metric.mid !== null ? metric.mid : metric.key;
    const frequency_hz = typeof band === "number" ? bands[band] : null;
    const applies = (note: Note): boolean =>
        (note.metric === key || note.metric === metric.key || note.metric === "all") &&
        (note.band_hz === null || note.band_hz === frequency_hz);
    const notes = Array.isArray(metrics?.notes) ? metrics.notes : [];
    return notes.find(applies)?.text ?? null;
}
