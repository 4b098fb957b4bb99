// SPDX-License-Identifier: MIT
// Puts the report together: what can be read at once first, drawings after the first paint.
import type { ReportData } from "./data/schema";
import { parse_report } from "./data/report_data";
import { contacts_section } from "./contacts/contacts_section";
import { append, el } from "./dom";
import { live_region } from "./live_region";
import type { Report } from "./report";
import { audio_section } from "./sections/audio";
import { decay_section } from "./sections/decay";
import { echogram_section } from "./sections/echogram";
import { late_energy_section } from "./sections/late_energy";
import { maps_section } from "./sections/maps";
import { metrics_section } from "./sections/metrics_table";
import { overview_section } from "./sections/overview";
import { provenance_section } from "./sections/provenance";
import type { Section } from "./sections/section";
import { sensitivity_section } from "./sections/sensitivity";
import { spectrum_section } from "./sections/spectrum";
import { toolbar } from "./sections/toolbar";
import { verdict_section } from "./sections/verdict";
import { decode_scene } from "./scene/decoded_scene";
import { scene_section } from "./scene/scene_section";
import { State } from "./state";
import { start_theme } from "./theme";

const default_band_hz = 1000;
const default_max_paths = 30;

function first_choices(data: ReportData): State {
    const band = data.bands?.indexOf(default_band_hz) ?? -1;
    return new State({
        pair: 0,
        band: Math.max(band, 0),
        metric: "sti",
        path: null,
        hidden_orders: new Set(),
        max_paths: default_max_paths,
        time: null,
        reference: data.pairs?.some((pair) => pair.reference) ? "reference" : "none",
    });
}

function sections_of(report: Report): Section[] {
    const { data } = report;
    const scene = decode_scene(data);
    const sections = [
        verdict_section(report),
        overview_section(report),
        scene && scene_section(report, scene),
        contacts_section(report),
        maps_section(report, scene),
        echogram_section(report),
        decay_section(report),
        late_energy_section(report),
        spectrum_section(report),
        metrics_section(report),
        sensitivity_section(report),
        audio_section(report),
        provenance_section(data),
    ];
    return sections.filter((s): s is Section => s !== null);
}

function start(): void {
    const place = document.getElementById("report")!;
    const text = document.getElementById("report-data")?.textContent ?? "";
    let data: ReportData;
    try {
        data = parse_report(text);
    } catch (error) {
        place.append(el("p", { class: "plain-message", role: "alert" }, (error as Error).message));
        return;
    }
    const kind = data.kind === "contacts" ? "report of contacts" : "sound report";
    document.title = `${data.title} \u2013 ${kind}`;
    start_theme();
    const report: Report = { data, state: first_choices(data) };
    const sections = sections_of(report);
    append(place, [
        el("header", { class: "page-header" }, el("h1", {}, data.title),
            el("p", { class: "byline" }, [`${kind[0]!.toUpperCase()}${kind.slice(1)} by`, data.provenance?.program ?? "earshot", data.provenance?.version ?? ""].join(" ").trim())),
        toolbar(report, sections),
        el("main", { id: "content", tabindex: -1 }, ...sections.map((s) => s.element)),
        live_region(),
    ]);
}

start();
