// SPDX-License-Identifier: MIT
// Decay curves per band (Schroeder 1965) with the lines that were fitted to them.
import type { Decay } from "../data/schema";
import { type Curve, curve_chart, type CurveChart } from "../charts/curves";
import { checkbox, el } from "../dom";
import { band, number } from "../format";
import { current_pair, type Report } from "../report";
import { extended_values, fit_time, line_values } from "./decay_fits";
import { section, type Section } from "./section";

const lowest_level_db = -70;
const fit_colors = { edt: "--fit-edt", t20: "--fit-t20", t30: "--fit-t30" } as const;

function fit_curves(decay: Decay, band_index: number, times: number[]): Curve[] {
    const fits = decay.fits?.[band_index] ?? {};
    return (["edt", "t20", "t30"] as const).flatMap((name) => {
        const fit = fits[name];
        return fit ? [
            { color: fit_colors[name], values: extended_values(fit, times, lowest_level_db), width: 1.2, dash: [3, 5] },
            {
                label: `${name.toUpperCase()} ${number(fit_time(fit), 2)} s`,
                color: fit_colors[name],
                values: line_values(fit, times),
                width: 2.2,
            },
        ] : [];
    });
}

function chart(report: Report, show_all: boolean): CurveChart | null {
    const decay = current_pair(report)?.decay;
    const bands = report.data.bands ?? [];
    const band_index = report.state.now.band;
    const chosen = decay?.level_db[band_index];
    if (!decay || !chosen) {
        return null;
    }
    const above = (list: (number | null)[]): number => {
        const end = list.findIndex((v) => v === null || v < lowest_level_db);
        return end < 0 ? list.length : end;
    };
    const lists = decay.level_db.map((list) => list ?? []);
    const count = Math.max(...(show_all ? lists : [chosen]).map(above));
    const times = Array.from({ length: count }, (_, i) => i * decay.step);
    const clip = (list: (number | null)[]): (number | null)[] =>
        times.map((_, i) => (list[i] ?? null) !== null && list[i]! >= lowest_level_db ? list[i]! : null);
    const others = show_all ? lists.map((list, i) => ({ list, i })).filter((e) => e.i !== band_index && e.list.length > 0) : [];
    return {
        x_title: "Time after the direct sound (ms)",
        y_title: "Level (dB)",
        x: times.map((t) => 1000 * t),
        x_unit: "ms",
        y_range: [lowest_level_db, 2],
        curves: [
            ...others.map(({ list, i }) => ({ label: band(bands[i] ?? 0), color: "--faint-curve", values: clip(list), width: 1 })),
            { label: band(bands[band_index] ?? 0), color: "--wide-curve", values: clip(chosen), width: 7 },
            ...fit_curves(decay, band_index, times),
        ],
    };
}

export function decay_section(report: Report): Section | null {
    if (!report.data.pairs?.some((pair) => pair.decay)) {
        return null;
    }
    let show_all = false;
    const place = el("div", { class: "chart" });
    const empty = el("p", { class: "empty", hidden: true }, "There is no decay curve of this pair and band.");
    const draw = curve_chart(place, 340, () => chart(report, show_all));
    const update = (): void => {
        empty.hidden = chart(report, show_all) !== null;
        draw();
    };
    update();
    report.state.subscribe(["pair", "band"], update);
    const all = checkbox("All bands", show_all, (checked) => {
        show_all = checked;
        update();
    });
    return section("decay", "Decay", el("div", { class: "controls" }, all),
        el("figure", {}, place, empty,
            el("figcaption", {}, "Energy that is still to arrive, in the chosen band, and the lines fitted for EDT, T20 and T30, dotted beyond what they were fitted to. ",
                "Drag to zoom, double-click to zoom out.")));
}
