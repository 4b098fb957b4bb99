// SPDX-License-Identifier: MIT
// The metrics of the chosen pair: a row per metric, a column per band, coloured by the number of
// just-noticeable differences from a reference. Withheld values refer to their reasons below.
import type { PairMetrics } from "../data/schema";
import { el, replace_children, select } from "../dom";
import { band, dash, error, number, signed } from "../format";
import { band_metrics, type Metric, sti } from "../metrics/definitions";
import { difference_in_jnd, jnd_class } from "../metrics/difference";
import { Reasons } from "../metrics/reasons";
import { type BandChoice, error_of, is_present, reason_of, value_of } from "../metrics/values";
import { current_pair, pair_name, type Report } from "../report";
import { scrolling, section, type Section } from "./section";

function reference_of(report: Report): PairMetrics | undefined {
    const { reference } = report.state.now;
    if (reference === "reference") {
        return current_pair(report)?.reference;
    }
    return typeof reference === "number" ? report.data.pairs?.[reference]?.metrics : undefined;
}

function cell(report: Report, metric: Metric, choice: BandChoice, reasons: Reasons): HTMLElement {
    const metrics = current_pair(report)?.metrics;
    const value = value_of(metrics, metric, choice);
    if (value === null) {
        const reason = reason_of(metrics, metric, choice, report.data.bands ?? []);
        return el("td", { class: "missing" }, reason === null ? dash : reasons.mark(reason));
    }
    const standard_error = error_of(metrics, metric, choice);
    const reference = value_of(reference_of(report), metric, choice);
    const difference = difference_in_jnd(metric, value, reference);
    return el("td", { class: jnd_class(difference) },
        el("span", { class: "value" }, number(value * metric.scale, metric.digits)),
        standard_error !== null &&
            el("span", { class: "error" }, `\u00b1\u00a0${error(standard_error * metric.scale, metric.digits)}`),
        difference !== null && el("span", { class: "difference" }, `${signed(difference, 1)} JND`));
}

function row(report: Report, metric: Metric, reasons: Reasons): HTMLElement {
    const bands = report.data.bands ?? [];
    const name = el("th", { scope: "row", title: metric.description },
        metric.name, metric.unit !== "" && el("span", { class: "unit" }, ` ${metric.unit}`));
    return el("tr", { "data-metric": metric.key }, name,
        metric.mid === null ? el("td", {}) : cell(report, metric, "mid", reasons),
        ...bands.map((_, index) => cell(report, metric, index, reasons)));
}

function sti_line(report: Report, reasons: Reasons): HTMLElement | null {
    const metrics = current_pair(report)?.metrics;
    if (!is_present(metrics, sti)) {
        return null;
    }
    const letter = metrics?.sti_letter;
    const content = cell(report, sti, "mid", reasons);
    return el("tr", { "data-metric": "sti" },
        el("th", { scope: "row", title: sti.description }, sti.name), content,
        el("td", { class: "remark", colspan: (report.data.bands ?? []).length },
            typeof letter === "string" ? `of all octaves; qualification band ${letter} (IEC 60268-16)` : "of all octaves"));
}

function draw(report: Report, place: HTMLElement): void {
    const pair = current_pair(report);
    const bands = report.data.bands ?? [];
    if (!pair?.metrics) {
        replace_children(place, el("p", { class: "empty" }, "This pair has no metrics."));
        return;
    }
    const reasons = new Reasons("metrics-reason");
    const rows = band_metrics.filter((m) => is_present(pair.metrics, m)).map((m) => row(report, m, reasons));
    const table = el("table", { class: "numbers metrics" },
        el("caption", {}, `${pair_name(report.data, pair)}: expected values \u00b1 standard error`),
        el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Metric"),
            el("th", { scope: "col", title: "mean of the octaves 500 Hz and 1 kHz" }, "Mid"),
            ...bands.map((f, i) => el("th", { scope: "col", class: i === report.state.now.band ? "chosen-column" : null }, band(f))))),
        el("tbody", {}, sti_line(report, reasons), ...rows));
    replace_children(place, scrolling("Metrics of the pair", table),
        reasons.list());
}

function jnd_legend(): HTMLElement {
    const item = (name: string, text: string): HTMLElement =>
        el("li", {}, el("span", { class: `swatch ${name}`, "aria-hidden": "true" }), text);
    return el("ul", { class: "legend jnd-legend", "aria-label": "Colours of the table" },
        item("jnd-below-3", "3 or more below"), item("jnd-below-2", "2"), item("jnd-below-1", "1"),
        item("jnd-same", "less than 1 JND"),
        item("jnd-above-1", "1"), item("jnd-above-2", "2"), item("jnd-above-3", "3 or more above"));
}

export function metrics_section(report: Report): Section | null {
    const pairs = report.data.pairs ?? [];
    if (!pairs.some((pair) => pair.metrics)) {
        return null;
    }
    const place = el("div");
    const legend = jnd_legend();
    const own_reference = pairs.find((pair) => pair.reference)?.reference;
    const choices = [{ value: "none", text: "nothing" }];
    if (own_reference) {
        choices.push({ value: "reference", text: own_reference.name ?? "the reference of this report" });
    }
    pairs.forEach((pair, index) => choices.push({ value: String(index), text: pair_name(report.data, pair) }));
    const compare = select("Compare with", choices, String(report.state.now.reference), (value) =>
        report.state.set({ reference: value === "none" || value === "reference" ? value : Number(value) }));
    const update = (): void => {
        legend.hidden = report.state.now.reference === "none";
        draw(report, place);
    };
    update();
    report.state.subscribe(["pair", "reference", "band"], update);
    return section("metrics", "Metrics",
        el("div", { class: "controls" }, compare.field, legend), place,
        el("p", { class: "hint" }, "JND: just-noticeable difference (ISO 3382-1; STI 0.03). ",
            "Colour and number tell how many of them lie between a value and what it is compared with."));
}
