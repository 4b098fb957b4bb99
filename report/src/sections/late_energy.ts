// SPDX-License-Identifier: MIT
// Energy of late sound over time with bands of one and two standard errors.
import type { Histogram } from "../data/schema";
import { curve_chart, type CurveChart } from "../charts/curves";
import { el } from "../dom";
import { current_pair, type Report } from "../report";
import { error_levels } from "./error_levels";
import { section, type Section } from "./section";

function y_range(levels: (number | null)[]): [number, number] {
    const present = levels.filter((v): v is number => v !== null);
    const top = 5 * Math.ceil((Math.max(...present) + 3) / 5);
    return [Math.max(top - 80, 5 * Math.floor((Math.min(...present) - 3) / 5)), top];
}

function chart(histogram: Histogram | undefined, band: number): CurveChart | null {
    const levels = histogram?.energy_db[band];
    if (!histogram || !levels || !levels.some((v) => v !== null)) {
        return null;
    }
    const errors = histogram.relative_error[band] ?? [];
    const floor = y_range(levels)[0];
    const lower = (count: number): (number | null)[] =>
        error_levels(levels, errors, -count).map((v, i) => levels[i] === null ? null : v ?? floor);
    return {
        x_title: "Time after emission (ms)",
        y_title: "Energy (dB)",
        x: levels.map((_, i) => 1000 * histogram.step * (i + 0.5)),
        x_unit: "ms",
        y_range: y_range(levels),
        curves: [
            { color: "--clear", values: error_levels(levels, errors, 2), width: 0 },
            { color: "--clear", values: error_levels(levels, errors, 1), width: 0 },
            { color: "--clear", values: lower(1), width: 0 },
            { color: "--clear", values: lower(2), width: 0 },
            { label: "Energy", color: "--curve", values: levels, width: 1.5 },
        ],
        areas: [
            { between: [0, 3], color: "--error-2", label: "\u00b1 2 standard errors" },
            { between: [1, 2], color: "--error-1", label: "\u00b1 1 standard error" },
        ],
    };
}

export function late_energy_section(report: Report): Section | null {
    if (!report.data.pairs?.some((pair) => pair.histogram)) {
        return null;
    }
    const place = el("div", { class: "chart" });
    const empty = el("p", { class: "empty", hidden: true }, "No late sound reaches this listener in this band.");
    const content = (): CurveChart | null => chart(current_pair(report)?.histogram, report.state.now.band);
    const draw = curve_chart(place, 300, content);
    const update = (): void => {
        empty.hidden = content() !== null;
        draw();
    };
    update();
    report.state.subscribe(["pair", "band"], update);
    return section("late", "Late energy",
        el("figure", {}, place, empty,
            el("figcaption", {}, "Energy of late and scattered sound in each interval, with bands of one and two standard errors. ",
                "More rays narrow the bands.")));
}
