// SPDX-License-Identifier: MIT
// The frame of an SVG diagram: grid, numbers and titles of two axes, and the mapping into it.
import { svg } from "../dom";
import { number } from "../format";
import { tick_digits, tick_step, ticks } from "./ticks";

export interface Axis {
    from: number;
    to: number;
    title: string;
    /** In place of ticks at round numbers. */
    labels?: { value: number; text: string }[];
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

/** The axis's own labels, every second one or fewer where there is no room. */
function labels_of(axis: Axis, max_count: number): { value: number; text: string }[] {
    if (axis.labels) {
        const every = Math.ceil(axis.labels.length / (1.6 * max_count));
        return axis.labels.filter((_, i) => i % every === 0);
    }
    const digits = tick_digits(tick_step(axis.to - axis.from, max_count));
    return ticks(axis.from, axis.to, max_count).map((value) => ({ value, text: number(value, digits) }));
}

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
    for (const { value, text } of labels_of(x_axis, x_count)) {
        group.append(
            svg("line", { class: "grid", x1: x(value), x2: x(value), y1: top, y2: bottom }),
            svg("text", { x: x(value), y: bottom + 16, "text-anchor": "middle" }, text));
    }
    for (const { value, text } of labels_of(y_axis, y_count)) {
        group.append(
            svg("line", { class: "grid", x1: left, x2: right, y1: y(value), y2: y(value) }),
            svg("text", { x: left - 8, y: y(value) + 4, "text-anchor": "end" }, text));
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
