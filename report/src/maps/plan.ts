// SPDX-License-Identifier: MIT
// A map as a plan: cells in steps of one just-noticeable difference, walls, sources and listeners,
// and the contour of the limit.
import { css, metric_color } from "../colors";
import type { Emitter, MetricMap, ReportData, Vector } from "../data/schema";
import { svg } from "../dom";
import { number, with_unit } from "../format";
import { find_metric } from "../metrics/definitions";
import type { DecodedScene } from "../scene/decoded_scene";
import { section_at_height } from "../scene/section_at_height";
import { map_scale } from "./map_values";

const max_height_in_pixels = 620;
const margin = 24;

type Plane = NonNullable<MetricMap["plane"]>;

/** Coordinates of a point along the plane's axes. */
function on_plane(plane: Plane, point: Vector): [number, number] {
    const d = point.map((x, k) => x - plane.origin[k]!);
    const dot = (axis: Vector): number => d[0]! * axis[0] + d[1]! * axis[1] + d[2]! * axis[2];
    return [dot(plane.u), dot(plane.v)];
}

export function value_text(map: MetricMap, value: number | null, error: number | null | undefined): string {
    const metric = find_metric(map.metric);
    const scale = metric?.scale ?? 1;
    const digits = metric?.digits ?? 2;
    const text = value === null ? "no value" : number(value * scale, digits);
    const unit = metric?.unit ?? map.unit ?? "";
    return with_unit(text, value === null ? "" : unit) +
        (value !== null && typeof error === "number" ? ` \u00b1 ${number(error * scale, digits + 1)}` : "");
}

/** Lines of the scene in the plane's coordinates; none if the plane is not horizontal. */
function walls(scene: DecodedScene | null, plane: Plane): [number, number, number, number][] {
    if (!scene || Math.abs(plane.u[1]) + Math.abs(plane.v[1]) > 1e-9) {
        return [];
    }
    const height = plane.origin[1];
    return section_at_height(scene, height).map(([x0, z0, x1, z1]) =>
        [...on_plane(plane, [x0, height, z0]), ...on_plane(plane, [x1, height, z1])]);
}

function marks(data: ReportData, plane: Plane, x: (u: number) => number, y: (v: number) => number): SVGElement[] {
    const mark = (kind: string) => (emitter: Emitter): SVGElement[] => {
        if (emitter.position === null) {
            return [];
        }
        const [u, v] = on_plane(plane, emitter.position);
        const shape = kind === "source"
            ? svg("path", { d: `M${x(u)} ${y(v) - 8}l8 8l-8 8l-8 -8z` })
            : svg("circle", { cx: x(u), cy: y(v), r: 5 });
        return [svg("g", { class: `plan-${kind}` }, shape,
            svg("text", { x: x(u) + 10, y: y(v) + 4 }, emitter.name))];
    };
    const listeners = data.listeners ?? [];
    return [...(data.sources ?? []).flatMap(mark("source")), ...(listeners.length <= 40 ? listeners.flatMap(mark("listener")) : [])];
}

export function draw_plan(data: ReportData, map: MetricMap, scene: DecodedScene | null, max_width: number): SVGSVGElement | null {
    const plane = map.plane;
    const cells = map.cells ?? [];
    if (!plane || cells.length === 0) {
        return null;
    }
    const lines = walls(scene, plane);
    const us = [...cells.flatMap((c) => [c[0], c[2]]), ...lines.flatMap((l) => [l[0], l[2]])];
    const vs = [...cells.flatMap((c) => [c[1], c[3]]), ...lines.flatMap((l) => [l[1], l[3]])];
    const range = (list: number[]): [number, number] =>
        list.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
    const [u0, u1] = range(us);
    const [v0, v1] = range(vs);
    const scale = Math.min((max_width - 2 * margin) / (u1 - u0), (max_height_in_pixels - 2 * margin) / (v1 - v0));
    const width = (u1 - u0) * scale + 2 * margin;
    const height = (v1 - v0) * scale + 2 * margin;
    const x = (u: number): number => Math.round(100 * (margin + (u - u0) * scale)) / 100;
    const y = (v: number): number => Math.round(100 * (margin + (v - v0) * scale)) / 100;
    const steps = map_scale(map);
    const has_errors = map.errors?.length === cells.length;
    const rectangles = cells.map(([a, b, c, d, value], i) => svg("rect", {
        class: value === null ? "no-value" : null,
        x: x(a), y: y(b), width: x(c) - x(a) + 0.3, height: y(d) - y(b) + 0.3,
        fill: value === null ? null : css(metric_color(steps.share(value))),
    }, svg("title", {}, value_text(map, value, has_errors ? map.errors?.[i] : null))));
    const contours = (map.contour ?? []).map((line) => svg("path", {
        class: "contour",
        d: line.map((p, i) => {
            const [u, v] = on_plane(plane, p);
            return `${i === 0 ? "M" : "L"}${x(u)} ${y(v)}`;
        }).join(""),
    }));
    const outline = lines.map(([a, b, c, d]) => `M${x(a)} ${y(b)}L${x(c)} ${y(d)}`).join("");
    const metre = svg("g", { class: "metre" },
        svg("line", { x1: x(u0), x2: x(u0) + scale, y1: height - 8, y2: height - 8 }),
        svg("text", { x: x(u0) + scale + 6, y: height - 4 }, "1 m"));
    return svg("svg", { class: "plan", width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Plan of ${map.metric}` },
        ...rectangles, svg("path", { class: "walls", d: outline }), ...contours, ...marks(data, plane, x, y), metre);
}
