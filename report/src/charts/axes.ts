// SPDX-License-Identifier: MIT
// The frame of an SVG diagram: grid, numbers and titles of two axes, and the mapping into it.
import { svg } from "../dom";
import { number } from "../format";
import { tick_digits, tick_step, ticks } from "./ticks";

export interface Axis {
    from: number;
    to: number;
    title: string;
}

export interface Frame {
    group: SVGGElement;
    x: (value: number) => number;
    y: (value: number) => number;
    left: number;
    right: number;
    top: number;
    bottom: number;
}

const margin = { left: 52, right: 12, top: 10, bottom: 40 };

export function draw_axes(width: number, height: number, x_axis: Axis, y_axis: Axis): Frame {
    const left = margin.left;
    const right = width - margin.right;
    const top = margin.top;
    const bottom = height - margin.bottom;
    const x = (value: number): number => left + ((value - x_axis.from) / (x_axis.to - x_axis.from)) * (right - left);
    const y = (value: number): number => bottom - ((value - y_axis.from) / (y_axis.to - y_axis.from)) * (bottom - top);
    const group = svg("g", { class: "axes", "aria-hidden": "true" });
    const x_count = Math.max(2, Math.floor((right - left) / 80));
    const y_count = Math.max(2, Math.floor((bottom - top) / 40));
    const x_digits = tick_digits(tick_step(x_axis.to - x_axis.from, x_count));
    const y_digits = tick_digits(tick_step(y_axis.to - y_axis.from, y_count));
    for (const tick of ticks(x_axis.from, x_axis.to, x_count)) {
        group.append(
            svg("line", { class: "grid", x1: x(tick), x2: x(tick), y1: top, y2: bottom }),
            svg("text", { x: x(tick), y: bottom + 16, "text-anchor": "middle" }, number(tick, x_digits)));
    }
    for (const tick of ticks(y_axis.from, y_axis.to, y_count)) {
        group.append(
            svg("line", { class: "grid", x1: left, x2: right, y1: y(tick), y2: y(tick) }),
            svg("text", { x: left - 8, y: y(tick) + 4, "text-anchor": "end" }, number(tick, y_digits)));
    }
    group.append(
        svg("line", { class: "axis", x1: left, x2: right, y1: bottom, y2: bottom }),
        svg("text", { class: "title", x: (left + right) / 2, y: bottom + 34, "text-anchor": "middle" }, x_axis.title),
        svg("text", {
            class: "title", "text-anchor": "middle",
            transform: `translate(14 ${(top + bottom) / 2}) rotate(-90)`,
        }, y_axis.title));
    return { group, x, y, left, right, top, bottom };
}
