// SPDX-License-Identifier: MIT
// Curves over time by uPlot, redrawn when the scheme of colours changes. Dragging zooms, a double
// click shows everything again.
import uPlot from "uplot";
import { number } from "../format";
import { on_scheme_change, style_color } from "../theme";
import { on_width } from "./resize";

export interface Curve {
    label: string;
    /** A variable of the style sheet, such as `--curve-1`. */
    color: string;
    values: (number | null)[];
    width?: number;
    dash?: number[];
}

export interface CurveChart {
    x_title: string;
    y_title: string;
    x: number[];
    x_digits: number;
    curves: Curve[];
    /** Pairs of curve indices between which the area is filled. */
    areas?: { between: [number, number]; color: string }[];
    y_range?: [number, number];
}

function axis(title: string, size: number): uPlot.Axis {
    const line = style_color("--grid");
    return {
        label: title,
        labelSize: 22,
        labelFont: "12px system-ui, sans-serif",
        font: "12px system-ui, sans-serif",
        stroke: style_color("--muted"),
        grid: { stroke: line, width: 1 },
        ticks: { stroke: line, width: 1, size: 4 },
        size,
        values: (_, splits) => splits.map((v) => String(v).replace("-", "\u2212")),
    };
}

function options(chart: CurveChart, width: number, height: number): uPlot.Options {
    return {
        width,
        height,
        scales: { x: { time: false }, y: chart.y_range ? { range: chart.y_range } : {} },
        axes: [axis(chart.x_title, 30), axis(chart.y_title, 40)],
        series: [
            { label: chart.x_title, value: (_, v) => number(v, chart.x_digits) },
            ...chart.curves.map((curve): uPlot.Series => ({
                label: curve.label,
                stroke: style_color(curve.color),
                width: curve.width ?? 1.5,
                ...(curve.dash ? { dash: curve.dash } : {}),
                points: { show: false },
                value: (_, v) => number(v, 1),
            })),
        ],
        bands: (chart.areas ?? []).map((area) => ({
            series: [area.between[0] + 1, area.between[1] + 1] as [number, number],
            fill: style_color(area.color),
        })),
        legend: { live: true },
        cursor: { drag: { x: true, y: false } },
    };
}

/** Draws into the element what `chart` gives at each call of the returned function. */
export function curve_chart(element: HTMLElement, height: number, chart: () => CurveChart | null): () => void {
    let width = 0;
    let plot: uPlot | null = null;
    const draw = (): void => {
        plot?.destroy();
        plot = null;
        const content = chart();
        if (content === null || width === 0) {
            return;
        }
        const data = [content.x, ...content.curves.map((c) => c.values)] as uPlot.AlignedData;
        plot = new uPlot(options(content, width, height), data, element);
    };
    on_width(element, (next) => {
        width = next;
        draw();
    });
    on_scheme_change(draw);
    return draw;
}
