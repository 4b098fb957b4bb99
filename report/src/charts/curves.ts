// SPDX-License-Identifier: MIT
// Curves over time by uPlot, redrawn when the scheme of colours changes. Dragging zooms, a double
// click shows everything again. The legend below tells the values at the pointer.
import uPlot from "uplot";
import { el, replace_children } from "../dom";
import { number } from "../format";
import { on_scheme_change, style_color } from "../theme";
import { on_width } from "./resize";

export interface Curve {
    /** Curves without a label are not in the legend. */
    label?: string;
    /** A variable of the style sheet, such as `--curve`. */
    color: string;
    values: (number | null)[];
    width?: number;
    dash?: number[];
}

export interface CurveChart {
    x_title: string;
    y_title: string;
    x: number[];
    x_unit: string;
    curves: Curve[];
    /** Pairs of curve indices between which the area is filled. */
    areas?: { between: [number, number]; color: string; label: string }[];
    y_range: [number, number];
}

const font = '12px system-ui, "Noto Sans", "DejaVu Sans", sans-serif';

function axis(title: string, size: number): uPlot.Axis {
    const line = style_color("--grid");
    return {
        label: title,
        labelSize: 24,
        labelFont: font,
        font,
        stroke: style_color("--muted"),
        grid: { stroke: line, width: 1 },
        ticks: { stroke: line, width: 1, size: 4 },
        size,
        values: (_, splits) => splits.map((v) => String(v).replace("-", "\u2212")),
    };
}

function swatch(color: string, curve?: Curve): HTMLElement {
    const element = el("span", { class: "swatch", "aria-hidden": "true" });
    element.style.backgroundColor = `var(${color})`;
    if (curve) {
        element.classList.add("line");
    }
    return element;
}

/** The legend and a function that tells the values at an index of x; null: none. */
function make_legend(chart: CurveChart): { element: HTMLElement; tell: (index: number | null) => void } {
    const labelled = chart.curves.filter((curve) => curve.label !== undefined);
    const x_value = el("span", { class: "legend-x" });
    const values = labelled.map(() => el("span", { class: "legend-value" }));
    const element = el("ul", { class: "legend curve-legend" },
        ...labelled.map((curve, i) => el("li", {}, swatch(curve.color, curve), curve.label, values[i])),
        ...(chart.areas ?? []).map((area) => el("li", {}, swatch(area.color), area.label)),
        el("li", {}, x_value));
    const tell = (index: number | null): void => {
        const x = index === null ? undefined : chart.x[index];
        replace_children(x_value, x === undefined ? "" : `at ${number(x, 1)} ${chart.x_unit}`);
        labelled.forEach((curve, i) => {
            const value = index === null ? null : curve.values[index] ?? null;
            replace_children(values[i]!, value === null ? "" : `${number(value, 1)} dB`);
        });
    };
    return { element, tell };
}

function options(chart: CurveChart, width: number, height: number, tell: (index: number | null) => void): uPlot.Options {
    return {
        width,
        height,
        scales: { x: { time: false }, y: { range: chart.y_range } },
        axes: [axis(chart.x_title, 32), axis(chart.y_title, 44)],
        series: [
            {},
            ...chart.curves.map((curve): uPlot.Series => ({
                stroke: style_color(curve.color),
                width: curve.width ?? 1.5,
                ...(curve.dash ? { dash: curve.dash } : {}),
                points: { show: false },
            })),
        ],
        bands: (chart.areas ?? []).map((area) => ({
            series: [area.between[0] + 1, area.between[1] + 1] as [number, number],
            fill: style_color(area.color),
        })),
        legend: { show: false },
        cursor: { drag: { x: true, y: false }, points: { show: false }, y: false },
        hooks: { setCursor: [(plot) => tell(plot.cursor.idx ?? null)] },
    };
}

/** Draws into the element what `chart` gives at each call of the returned function. */
export function curve_chart(element: HTMLElement, height: number, chart: () => CurveChart | null): () => void {
    let width = 0;
    let plot: uPlot | null = null;
    const draw = (): void => {
        plot?.destroy();
        plot = null;
        element.replaceChildren();
        const content = chart();
        if (content === null || width === 0) {
            return;
        }
        const legend = make_legend(content);
        const data = [content.x, ...content.curves.map((c) => c.values)] as uPlot.AlignedData;
        plot = new uPlot(options(content, width, height, legend.tell), data, element);
        element.append(legend.element);
    };
    on_width(element, (next) => {
        width = next;
        draw();
    });
    on_scheme_change(draw);
    return draw;
}
