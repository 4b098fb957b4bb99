// SPDX-License-Identifier: MIT
// First what the reader came for: each question with its answer, then what to be careful about.
import type { ReportData, VerdictLine } from "../data/schema";
import { append, el } from "../dom";
import type { Report } from "../report";
import { room_facts } from "./room";
import { type Section, section } from "./section";

const states = {
    met: { text: "Met", icon: "\u2713" },
    missed: { text: "Missed", icon: "\u2717" },
    told: { text: "Result", icon: "\u2022" },
};

function verdict_line(report: Report, line: VerdictLine): HTMLElement {
    const state = states[line.state] ? line.state : "told";
    const item = el("li", { class: `verdict ${state}` },
        el("span", { class: "badge" }, el("span", { "aria-hidden": "true" }, states[state].icon), ` ${states[state].text}`),
        el("span", { class: "question" }, line.question),
        el("strong", { class: "answer" }, line.answer));
    const pair = line.pair;
    if (typeof pair === "number" && report.data.pairs?.[pair]) {
        const link = el("a", { href: "#scene" }, "Show it");
        link.addEventListener("click", () => report.state.set({ pair }));
        append(item, [link]);
    }
    return item;
}

function warnings(data: ReportData): HTMLElement | null {
    if (!data.warnings?.length) {
        return null;
    }
    return el("div", { class: "warnings" },
        el("h3", {}, data.warnings.length === 1 ? "Warning" : `${data.warnings.length} warnings`),
        el("ul", {}, ...data.warnings.map((text) => el("li", {}, text))));
}

export function verdict_section(report: Report): Section {
    // What was asked comes before what is told unasked, failures first; otherwise the order of the data.
    const rank = (line: VerdictLine): number => ["missed", "met", "told"].indexOf(line.state);
    const lines = [...(report.data.verdict ?? [])].sort((a, b) => rank(a) - rank(b)).map((line) => verdict_line(report, line));
    return section("verdict", "Verdict",
        lines.length > 0 && el("ul", { class: "verdicts" }, ...lines),
        warnings(report.data),
        room_facts(report.data));
}
