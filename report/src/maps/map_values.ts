// SPDX-License-Identifier: MIT
// A map's cells in space, and its scale in steps of one just-noticeable difference.
import type { MetricMap, Vector } from "../data/schema";
import { find_metric } from "../metrics/definitions";

export interface Cell {
    corners: [Vector, Vector, Vector, Vector];
    value: number | null;
}

export interface MapScale {
    from: number;
    to: number;
    step: number;
    /** Place of a value on the scale, 0..1, at the middle of its step. */
    share(value: number): number;
}

export function map_name(map: MetricMap): string {
    return find_metric(map.metric)?.name ?? map.metric;
}

export function map_cells(map: MetricMap): Cell[] {
    const plane = map.plane;
    if (!plane) {
        return [];
    }
    const at = (u: number, v: number): Vector =>
        [0, 1, 2].map((k) => plane.origin[k]! + u * plane.u[k]! + v * plane.v[k]!) as Vector;
    return (map.cells ?? []).map(([u0, v0, u1, v1, value]) =>
        ({ corners: [at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)], value }));
}

function present_values(map: MetricMap): number[] {
    const values = map.values?.length ? map.values : (map.cells ?? []).map((c) => c[4]);
    return values.filter((v): v is number => typeof v === "number" && Number.isFinite(v));
}

/** Steps of one just-noticeable difference, fewer and longer where they would be more than 16. */
export function map_scale(map: MetricMap): MapScale {
    const values = present_values(map);
    const metric = find_metric(map.metric);
    const low = values.length > 0 ? Math.min(...values) : 0;
    const high = values.length > 0 ? Math.max(...values) : 1;
    const is_share = typeof map.jnd === "number" ? map.jnd_is_relative === true : metric?.jnd_is_share === true;
    const difference = map.jnd ?? (metric?.jnd ?? 0) / (metric?.scale ?? 1);
    let step = is_share ? difference * ((low + high) / 2) : difference;
    if (!(step > 0)) {
        step = (high - low) / 8 || 1;
    }
    const jnd = step;
    for (let factor = 2; (high - low) / step > 16; ++factor) {
        step = factor * jnd;
    }
    // A limit lies between two steps, so that meeting it shows as a change of colour.
    const base = map.limit ?? 0;
    const from = base + step * Math.floor((low - base) / step + 1e-9);
    const to = Math.max(base + step * Math.ceil((high - base) / step - 1e-9), from + step);
    const count = Math.max(Math.round((to - from) / step), 1);
    const share = (value: number): number => {
        const i = Math.min(Math.max(Math.floor((value - from) / step + 1e-9), 0), count - 1);
        return count === 1 ? 0.5 : i / (count - 1);
    };
    return { from, to, step, share };
}
