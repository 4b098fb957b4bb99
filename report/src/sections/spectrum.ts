// SPDX-License-Identifier: MIT
// A metric over frequency: the chosen pair with its standard errors, the other pairs faintly, and for
// reverberation times Sabine's and Eyring's.
import { draw_axes, type Frame } from "../charts/axes";
import { on_width } from "../charts/resize";
import { el, replace_children, select, svg } from "../dom";
import { band as band_name, number } from "../format";
import { band_metrics, type Metric } from "../metrics/definitions";
import { error_of, is_present, value_of } from "../metrics/values";
import { current_pair, type Report } from "../report";
import type { PerBand } from "../data/schema";
import { section, type Section } from "./section";

const height = 280;
const reverberation_times = ["edt", "t20", "t30"];

interface Line {
    kind: string;
    label: string;
    values: PerBand;
    errors?: PerBand;
}

function lines_of(report: Report, metric: Metric): Line[] {
    const { data } = report;
    const bands = (data.bands ?? []).map((_, i) => i);
    const scaled = (value: number | null): number | null => (value === null ? null : value * metric.scale);
    const pair = current_pair(report);
    const lines: Line[] = (data.pairs ?? []).filter((p) => p !== pair)
        .map((p) => ({ kind: "other", label: "other pairs", values: bands.map((b) => scaled(value_of(p.metrics, metric, b))) }));
    if (reverberation_times.includes(metric.key)) {
        if (data.room?.sabine) {
            lines.push({ kind: "sabine", label: "Sabine", values: data.room.sabine });
        }
        if (data.room?.eyring) {
            lines.push({ kind: "eyring", label: "Eyring", values: data.room.eyring });
        }
    }
    if (pair?.reference) {
        const reference = pair.reference;
        lines.push({
            kind: "reference", label: reference.name ?? "reference",
            values: bands.map((b) => scaled(value_of(reference, metric, b))),
        });
    }
    lines.push({
        kind: "pair", label: "this pair \u00b1 standard error",
        values: bands.map((b) => scaled(value_of(pair?.metrics, metric, b))),
        errors: bands.map((b) => scaled(error_of(pair?.metrics, metric, b))),
    });
    return lines.filter((line) => line.values.some((v) => v !== null));
}

/** Segments between neighbouring bands that both have a value. */
function path_of(values: PerBand, frame: Frame): string {
    let text = "";
    values.forEach((value, i) => {
        if (value !== null) {
            const before = i > 0 ? values[i - 1] : null;
            text += `${before === null || before === undefined ? "M" : "L"}${frame.x(i).toFixed(1)} ${frame.y(value).toFixed(1)}`;
        }
    });
    return text;
}

function points_of(line: Line, metric: Metric, bands: number[], frame: Frame): SVGElement[] {
    return line.values.flatMap((value, i) => {
        if (value === null) {
            return [];
        }
        const error = line.errors?.[i] ?? 0;
        return [svg("g", { class: "point" },
            svg("line", { x1: frame.x(i), x2: frame.x(i), y1: frame.y(value - error), y2: frame.y(value + error) }),
            svg("circle", { cx: frame.x(i), cy: frame.y(value), r: 3.5 }),
            svg("title", {}, `${band_name(bands[i]!)}: ${number(value, metric.digits + 1)} ${metric.unit}`))];
    });
}

function draw(report: Report, metric: Metric, width: number): SVGSVGElement | null {
    const bands = report.data.bands ?? [];
    const lines = lines_of(report, metric);
    const values = lines.flatMap((line) => line.values).filter((v): v is number => v !== null);
    if (values.length === 0 || bands.length < 2) {
        return null;
    }
    const low = Math.min(...values);
    const high = Math.max(...values);
    const space = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
    // Times and shares start at zero, decibels where they are.
    const from = metric.unit === "dB" ? low - space : 0;
    const frame = draw_axes(width, height,
        { from: -0.3, to: bands.length - 0.7, title: "Frequency band", labels: bands.map((f, i) => ({ value: i, text: band_name(f) })) },
        { from, to: high + space, title: metric.unit === "" ? metric.name : `${metric.name} (${metric.unit})` });
    const chosen = report.state.now.band;
    const mark = svg("rect", {
        class: "chosen-band", x: frame.x(chosen - 0.3), width: frame.x(chosen + 0.3) - frame.x(chosen - 0.3),
        y: frame.top, height: frame.bottom - frame.top,
    });
    const drawn = lines.map((line) => svg("g", { class: `spectrum-${line.kind}` },
        svg("path", { d: path_of(line.values, frame) }),
        ...(line.kind === "pair" ? points_of(line, metric, bands, frame) : [])));
    return svg("svg", {
        width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${metric.name} over frequency; the table of metrics has the values`,
    }, mark, frame.group, ...drawn);
}

function legend(lines: Line[]): HTMLElement {
    const kinds = lines.filter((line, i) => lines.findIndex((other) => other.kind === line.kind) === i);
    return el("ul", { class: "legend curve-legend" }, ...kinds.reverse().map((line) =>
        el("li", {}, el("span", { class: `swatch line spectrum-swatch-${line.kind}`, "aria-hidden": "true" }), line.label)));
}

export function spectrum_section(report: Report): Section | null {
    const metrics = band_metrics.filter((m) => report.data.pairs?.some((pair) => is_present(pair.metrics, m)));
    const first = metrics.find((m) => m.key === "t30") ?? metrics[0];
    if (!first) {
        return null;
    }
    let metric = first;
    let width = 0;
    const place = el("div", { class: "chart" });
    const update = (): void => {
        if (width > 0) {
            replace_children(place, draw(report, metric, width) ?? el("p", { class: "empty" }, "This metric has no values."),
                legend(lines_of(report, metric)));
        }
    };
    on_width(place, (next) => {
        width = next;
        update();
    });
    report.state.subscribe(["pair", "band"], update);
    const choice = select("Metric over frequency", metrics.map((m) => ({ value: m.key, text: `${m.name}, ${m.description}` })), metric.key, (key) => {
        metric = metrics.find((m) => m.key === key) ?? metric;
        update();
    });
    const made = section("spectrum", "Over frequency", el("div", { class: "controls" }, choice.field),
        el("figure", {}, place, el("figcaption", {}, "Gaps are withheld values; the table of metrics tells why. The shaded band is the chosen one.")));
    return { ...made, short_title: "Frequency" };
}
