// SPDX-License-Identifier: MIT
// Maps of metrics as plans, with their scale, the share of the area that meets a limit, and extremes.
import { on_width } from "../charts/resize";
import { css, metric_color } from "../colors";
import type { MetricMap } from "../data/schema";
import { name_of } from "../data/report_data";
import { el, replace_children, select } from "../dom";
import { number, percent } from "../format";
import { find_metric } from "../metrics/definitions";
import { map_name, map_scale } from "../maps/map_values";
import { draw_plan, value_text } from "../maps/plan";
import type { Report } from "../report";
import type { DecodedScene } from "../scene/decoded_scene";
import { section, type Section } from "./section";

const legend_width = 170;
const min_plan_width = 280;

function map_choice_name(report: Report, map: MetricMap): string {
    const source = typeof map.source === "number" ? `, from ${name_of(report.data.sources, map.source)}` : "";
    return map_name(map) + source;
}

/** One swatch per step, as the cells are coloured. */
function step_legend(map: MetricMap): HTMLElement {
    const metric = find_metric(map.metric);
    const text = (v: number): string => number(v * (metric?.scale ?? 1), metric?.digits ?? 2);
    const { from, to, step, share } = map_scale(map);
    const count = Math.max(1, Math.round((to - from) / step));
    const items = Array.from({ length: count }, (_, i) => {
        const low = from + i * step;
        const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
        swatch.style.backgroundColor = css(metric_color(share(low + step / 2)));
        return el("li", {}, swatch, `${text(low)} to ${text(low + step)}`);
    });
    return el("ul", { class: "legend steps", "aria-label": `Colours of ${map_name(map)}` }, ...items.reverse());
}

function summary(map: MetricMap): HTMLElement {
    const values = (map.values ?? []).map((v, i) => ({ v, i })).filter((e): e is { v: number; i: number } => typeof e.v === "number");
    const parts: string[] = [];
    if (values.length > 0) {
        const low = values.reduce((a, b) => (b.v < a.v ? b : a));
        const high = values.reduce((a, b) => (b.v > a.v ? b : a));
        parts.push(`From ${value_text(map, low.v, map.errors?.[low.i])} to ${value_text(map, high.v, map.errors?.[high.i])} at ${values.length} points.`);
    }
    if (typeof map.limit === "number" && typeof map.share === "number") {
        parts.push(`${map.limit_is_minimum === false ? "At most" : "At least"} ${value_text(map, map.limit, null)} is met on ${percent(map.share)} of the area${map.contour?.length ? "; the line in the plan is its contour" : ""}.`);
    }
    return el("p", {}, parts.join(" "));
}

export function maps_section(report: Report, scene: DecodedScene | null): Section | null {
    const maps = report.data.maps ?? [];
    if (maps.length === 0) {
        return null;
    }
    let shown = 0;
    let width = 0;
    const place = el("div", { class: "plan-place" });
    const words = el("div");
    const legend = el("div");
    const draw = (): void => {
        const map = maps[shown]!;
        replace_children(place, width > 0 && (draw_plan(report.data, map, scene, width) ??
            el("p", { class: "empty" }, "This map has no cells.")));
        replace_children(words, summary(map));
        replace_children(legend, step_legend(map));
    };
    const chooser = select("Metric", maps.map((map, i) => ({ value: String(i), text: map_choice_name(report, map) })), "0", (value) => {
        shown = Number(value);
        draw();
    });
    draw();
    const figure = el("figure", { class: "map" }, place, legend);
    on_width(figure, (next) => {
        width = Math.max(next - legend_width, min_plan_width);
        draw();
    });
    return section("maps", "Map", el("div", { class: "controls" }, chooser.field), words,
        figure);
}
