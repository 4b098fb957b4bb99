// SPDX-License-Identifier: MIT
// What sections need: the data and the reader's choices.
import type { Pair, ReportData, SoundPath } from "./data/schema";
import { name_of } from "./data/report_data";
import { dash, number } from "./format";
import type { State } from "./state";

export interface Report {
    data: ReportData;
    state: State;
}

export function pair_name(data: ReportData, pair: Pair): string {
    const is_repeated = typeof pair.time === "number" &&
        data.pairs?.some((p) => p.source === pair.source && p.listener === pair.listener && p.time !== pair.time);
    return `${name_of(data.sources, pair.source)} to ${name_of(data.listeners, pair.listener)}` +
        (is_repeated ? ` at ${pair.time} s` : "");
}

export function current_pair(report: Report): Pair | undefined {
    return report.data.pairs?.[report.state.now.pair];
}

/** Level of a path in a band, decibels re the source at 1 m. */
export function path_level(path: SoundPath, band: number): number {
    const pressure = Math.abs(path.pressure[band] ?? 0);
    return pressure > 0 ? 20 * Math.log10(pressure) : -Infinity;
}

export function order_name(order: number): string {
    return order === 0 ? "direct" : `order ${order}`;
}

/** One line: order, delay, level, materials in the order of reflection. */
export function describe_path(path: SoundPath, band: number): string {
    const level = path_level(path, band);
    const surfaces = (path.materials ?? []).join(", ");
    return `${path.order === 0 ? "direct sound" : order_name(path.order)}, ` +
        `${number(1000 * path.delay, 1)} ms, ` +
        `${Number.isFinite(level) ? number(level, 1) : dash} dB` + (surfaces === "" ? "" : `, off ${surfaces}`);
}

/** Indices of the strongest paths of a band whose order is not hidden, strongest first. */
export function strongest_paths(
    paths: SoundPath[], band: number, hidden_orders: ReadonlySet<number>, max_paths: number
): number[] {
    return paths
        .map((path, index) => ({ index, level: path_level(path, band), order: path.order }))
        .filter((p) => !hidden_orders.has(p.order) && Number.isFinite(p.level))
        .sort((a, b) => b.level - a.level || a.index - b.index)
        .slice(0, max_paths)
        .map((p) => p.index);
}

export function orders_of(paths: SoundPath[]): number[] {
    return [...new Set(paths.map((p) => p.order))].sort((a, b) => a - b);
}
