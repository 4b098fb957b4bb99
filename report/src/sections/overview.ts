// SPDX-License-Identifier: MIT
// All pairs in one table; a row's button chooses the pair that the other sections show.
import { button, el } from "../dom";
import { error, number } from "../format";
import { announce } from "../live_region";
import { find_metric, type Metric } from "../metrics/definitions";
import { Reasons } from "../metrics/reasons";
import { error_of, reason_of, value_of } from "../metrics/values";
import { pair_name, type Report } from "../report";
import type { Pair } from "../data/schema";
import { scrolling, section, type Section } from "./section";

const shown = ["t30", "edt", "c50", "c80", "sti"]
    .map(find_metric).filter((m): m is Metric => m !== undefined);

function cell(report: Report, pair: Pair, metric: Metric, reasons: Reasons): HTMLElement {
    const value = value_of(pair.metrics, metric, "mid");
    const standard_error = error_of(pair.metrics, metric, "mid");
    const reason = reason_of(pair.metrics, metric, "mid", report.data.bands ?? []);
    const shown_value = value === null ? null : value * metric.scale;
    return el("td", value === null ? { class: "missing" } : {}, value === null && reason !== null ? reasons.mark(reason) : number(shown_value, metric.digits),
        value !== null && standard_error !== null &&
            el("span", { class: "error" }, ` \u00b1\u00a0${error(standard_error * metric.scale, metric.digits)}`));
}

export function overview_section(report: Report): Section | null {
    const pairs = report.data.pairs ?? [];
    if (!pairs.some((pair) => pair.metrics)) {
        return null;
    }
    const reasons = new Reasons("pair-reason");
    const rows = pairs.map((pair, index) => {
        const choose = button(pair_name(report.data, pair), () => {
            report.state.set({ pair: index });
            announce(`The report now shows ${pair_name(report.data, pair)}.`);
        }, { class: "link" });
        return el("tr", {}, el("th", { scope: "row" }, choose), ...shown.map((metric) => cell(report, pair, metric, reasons)));
    });
    const mark = (): void => rows.forEach((row, index) => {
        row.classList.toggle("chosen", index === report.state.now.pair);
        row.querySelector("button")?.setAttribute("aria-pressed", String(index === report.state.now.pair));
    });
    mark();
    report.state.subscribe(["pair"], mark);
    const table = el("table", { class: "numbers overview" },
        el("caption", {}, "Means of the octaves 500 Hz and 1 kHz \u00b1 standard error. Choose a pair to see it below."),
        el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Pair"),
            ...shown.map((m) => el("th", { scope: "col", title: m.description }, m.unit === "" ? m.name : `${m.name} (${m.unit})`)))),
        el("tbody", {}, ...rows));
    return { ...section("overview", "All pairs", scrolling("Metrics of all pairs", table), reasons.list()), short_title: "Pairs" };
}
