// SPDX-License-Identifier: MIT
// Which surface matters: the energy that its reflections bring before and after 80 ms, and what more
// absorption on it would change.
import { el, replace_children } from "../dom";
import { band as band_name, dash, percent, signed } from "../format";
import { current_pair, pair_name, type Report } from "../report";
import { absorption_step, material_rows, type MaterialRow } from "./material_rows";
import { scrolling, section, type Section } from "./section";

function bar(share: number | null, scale: number, kind: string): HTMLElement {
    const fill = el("span", { class: `fill ${kind}` });
    fill.style.width = `${Math.min(100, (100 * (share ?? 0)) / Math.max(scale, 1e-9))}%`;
    return el("td", { class: "bar-cell" },
        el("span", { class: "bar-value" }, share === null ? dash : percent(share)),
        el("span", { class: "track", "aria-hidden": "true" }, fill));
}

function advice(rows: MaterialRow[]): string {
    const best = rows.filter((r) => r.sti !== null && r.sti > 0.0005).sort((a, b) => b.sti! - a.sti!)[0];
    if (best) {
        return `Absorption on \u201c${best.name}\u201d changes STI most: ${signed(best.sti, 3)} for ${absorption_step} more in every octave.`;
    }
    const most = rows.find((r) => r.after !== null && r.after > 0);
    return most ? `\u201c${most.name}\u201d reflects most of the late energy.` : "";
}

function draw(report: Report, place: HTMLElement): void {
    const pair = current_pair(report);
    const found = report.data.sensitivity?.pairs.find((s) => s.source === pair?.source && s.listener === pair?.listener);
    const { band } = report.state.now;
    const frequency = report.data.bands?.[band] ?? 0;
    if (!pair || !found) {
        replace_children(place, el("p", { class: "empty" }, "This pair has no sensitivities."));
        return;
    }
    const rows = material_rows(found, (report.data.materials ?? []).map((m) => m.name), band);
    const scale = Math.max(...rows.flatMap((r) => [r.before ?? 0, r.after ?? 0]));
    const step = `+${absorption_step}`;
    const table = el("table", { class: "numbers sensitivity" },
        el("caption", {}, `${pair_name(report.data, pair)}, ${band_name(frequency)}: share of the energy at the listener that each material reflected at least once, ` +
            `and the change for ${step} of its absorption coefficient`),
        el("thead", {}, el("tr", {},
            ...["Material", "Energy before 80 ms", "Energy after 80 ms", "T30 (s)", "C80 (dB)", "STI, all octaves"]
                .map((text) => el("th", { scope: "col" }, text)))),
        el("tbody", {}, ...rows.map((row) => el("tr", {}, el("th", { scope: "row" }, row.name),
            bar(row.before, scale, "before"), bar(row.after, scale, "after"),
            el("td", {}, signed(row.t30, 3)), el("td", {}, signed(row.c80, 2)), el("td", {}, signed(row.sti, 3))))));
    const text = advice(rows);
    replace_children(place, text !== "" && el("p", { class: "advice" }, text), scrolling("Sensitivity to materials", table));
}

export function sensitivity_section(report: Report): Section | null {
    const pairs = report.data.sensitivity?.pairs ?? [];
    if (pairs.length === 0) {
        return null;
    }
    const place = el("div");
    const update = (): void => draw(report, place);
    update();
    report.state.subscribe(["pair", "band"], update);
    return { ...section("sensitivity", "Which surface matters", place), short_title: "Surfaces" };
}
