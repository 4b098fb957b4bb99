// SPDX-License-Identifier: MIT
// The 3-D view with its controls: what it shows follows the reader's choices, and a click in it
// makes them. Without WebGL one plain message stands in its place.
import { Vector2 } from "three";
import { absorption_color, metric_color } from "../colors";
import { after_first_paint, button, checkbox, el, next_id, replace_children, select } from "../dom";
import { band as band_name, number, with_unit } from "../format";
import { announce } from "../live_region";
import { all_metrics, find_metric } from "../metrics/definitions";
import { is_present } from "../metrics/values";
import { current_pair, describe_path, pair_name, type Report } from "../report";
import { order_legend } from "../sections/order_legend";
import { section, type Section } from "../sections/section";
import { on_scheme_change, scheme } from "../theme";
import type { DecodedScene } from "./decoded_scene";
import { Emitters } from "./emitters";
import { MapOverlay } from "./map_overlay";
import { PathLines } from "./path_lines";
import { printed_picture } from "./printed_picture";
import { draw_scale } from "./scales";
import { absorption_scale, Surfaces } from "./surfaces";
import { time_control } from "./time_control";
import { view_points, Viewer } from "./viewer";

export const no_webgl_message =
    "This browser shows no 3-D view, because WebGL is missing or switched off. Tables, curves and plans below are complete.";

/** The view's layers, redrawn by the members of the state that they show. */
class SceneView {
    readonly viewer: Viewer;
    private readonly surfaces: Surfaces;
    private readonly emitters: Emitters;
    private readonly paths: PathLines;
    private readonly tooltip = el("div", { class: "tooltip", hidden: true, "aria-hidden": "true" });
    private readonly absorption_legend = el("div", { class: "scale" });
    private readonly metric_legend = el("div", { class: "scale" });
    private pointer: PointerEvent | null = null;

    constructor(private readonly report: Report, scene: DecodedScene) {
        this.viewer = new Viewer(`Room ${report.data.title} with sources, listeners and sound paths`, scene.min, scene.max);
        this.surfaces = new Surfaces(this.viewer, scene, report.data.materials ?? []);
        const diagonal = Math.hypot(...scene.max.map((x, i) => x - scene.min[i]!));
        this.emitters = new Emitters(this.viewer, report, diagonal / 110);
        this.paths = new PathLines(this.viewer, report);
        this.viewer.element.append(this.tooltip,
            el("div", { class: "scales" }, this.absorption_legend, this.metric_legend));
        this.viewer.element.append(printed_picture(this.viewer));
        this.listen();
        this.update_all();
    }

    controls(): HTMLElement {
        const { report } = this;
        const { data, state } = report;
        const metrics = all_metrics.filter((m) => data.pairs?.some((pair) => is_present(pair.metrics, m)));
        const metric = metrics.length > 0 && select("Listeners coloured by",
            metrics.map((m) => ({ value: m.key, text: m.name })), state.now.metric, (value) => state.set({ metric: value })).field;
        const most = Math.max(0, ...(data.pairs ?? []).map((pair) => pair.paths?.length ?? 0));
        const overlay = data.maps?.length ? new MapOverlay(this.viewer, data.maps) : null;
        return el("div", { class: "view-controls" },
            el("div", { class: "controls" },
                el("div", { class: "buttons", role: "group", "aria-label": "View from" },
                    ...view_points.map((v) => button(v.name, () => this.viewer.look_from(v.direction)))),
                metric,
                checkbox("Near walls opaque", false, (on) => this.surfaces.set_walls_opaque(on)),
                overlay?.control()),
            most > 0 && this.time_slider(),
            most > 0 && el("div", { class: "controls" }, order_legend(report), this.count_slider(most)));
    }

    private time_slider(): HTMLElement {
        const control = time_control("Time after emission", 9, (time) => this.report.state.set({ time }));
        const update = (): void => {
            const paths = current_pair(this.report)?.paths ?? [];
            control.set_end(Math.max(0, ...paths.map((p) => p.delay)));
        };
        update();
        this.report.state.subscribe(["pair"], update);
        return control.element;
    }

    private count_slider(most: number): HTMLElement {
        const id = next_id("count");
        const { state } = this.report;
        const output = el("output", { for: id }, String(state.now.max_paths));
        const slider = el("input", { type: "range", id, min: 1, max: most, value: state.now.max_paths });
        slider.addEventListener("input", () => {
            replace_children(output, slider.value);
            state.set({ max_paths: Number(slider.value) });
        });
        return el("span", { class: "field" }, el("label", { for: id }, "Strongest paths shown"), slider, output);
    }

    private listen(): void {
        const { state } = this.report;
        state.subscribe(["band"], () => this.update_surfaces());
        state.subscribe(["pair", "metric", "band"], () => this.update_emitters());
        state.subscribe(["pair", "band", "path", "hidden_orders", "max_paths", "time"], () => this.paths.update());
        on_scheme_change(() => this.update_all());
        const { canvas } = this.viewer;
        let pressed_at = { x: 0, y: 0 };
        canvas.addEventListener("pointerdown", (e) => (pressed_at = { x: e.clientX, y: e.clientY }));
        canvas.addEventListener("click", (e) => {
            // A drag that turned the view is no click.
            if (Math.hypot(e.clientX - pressed_at.x, e.clientY - pressed_at.y) < 4) {
                this.click(e.offsetX, e.offsetY);
            }
        });
        canvas.addEventListener("pointermove", (e) => {
            if (this.pointer === null) {
                requestAnimationFrame(() => this.hover());
            }
            this.pointer = e;
        });
        canvas.addEventListener("pointerleave", () => (this.tooltip.hidden = true));
    }

    private click(x: number, y: number): void {
        const { report } = this;
        const listener = this.emitters.listener_at(x, y);
        const source = current_pair(report)?.source;
        const pair = report.data.pairs?.findIndex((p) => p.source === source && p.listener === listener) ?? -1;
        if (pair >= 0) {
            report.state.set({ pair });
            announce(`The report now shows ${pair_name(report.data, report.data.pairs![pair]!)}.`);
            return;
        }
        const path = this.paths.path_at(x, y);
        report.state.set({ path });
        const data = path === null ? undefined : current_pair(report)?.paths?.[path];
        if (data) {
            announce(`Path ${describe_path(data, report.state.now.band)}`);
        }
    }

    /** Tells what is below the pointer: a path's delay and level, or a surface's material. */
    private hover(): void {
        const event = this.pointer;
        this.pointer = null;
        if (event === null || event.buttons !== 0) {
            this.tooltip.hidden = true;
            return;
        }
        const text = this.text_at(event.offsetX, event.offsetY);
        this.tooltip.hidden = text === null;
        this.tooltip.textContent = text ?? "";
        const x = Math.min(event.offsetX + 14, this.viewer.width - 240);
        this.tooltip.style.transform = `translate(${x}px, ${event.offsetY + 14}px)`;
    }

    private text_at(x: number, y: number): string | null {
        const { band } = this.report.state.now;
        const path = this.paths.path_at(x, y);
        const data = path === null ? undefined : current_pair(this.report)?.paths?.[path];
        if (data) {
            return describe_path(data, band);
        }
        const place = new Vector2((2 * x) / this.viewer.width - 1, 1 - (2 * y) / this.viewer.height);
        const index = this.surfaces.material_at(place);
        const material = index === null ? undefined : this.report.data.materials?.[index];
        if (!material) {
            return null;
        }
        const absorption = material.absorption?.[band];
        return material.name + (typeof absorption === "number" ? `: absorption ${number(absorption, 2)}` : "") +
            (typeof material.area === "number" ? `, ${with_unit(number(material.area, 1), "m\u00b2")}` : "") +
            (material.guessed ? ", guessed from its name" : "");
    }

    private update_all(): void {
        this.update_surfaces();
        this.update_emitters();
        this.paths.update();
    }

    private update_surfaces(): void {
        const { band } = this.report.state.now;
        this.surfaces.color_by_absorption(band);
        const limit = absorption_scale(this.report.data.materials ?? [], band);
        draw_scale(this.absorption_legend, `Absorption, ${band_name(this.report.data.bands?.[band] ?? 0)}`,
            (x) => absorption_color(x, scheme()), [number(0, 1), number(limit / 2, 2), number(limit, 1)]);
    }

    private update_emitters(): void {
        this.emitters.update();
        const metric = find_metric(this.report.state.now.metric);
        const scale = this.emitters.scale();
        this.metric_legend.hidden = !metric || !scale;
        if (metric && scale) {
            const text = (x: number): string => number(x * metric.scale, metric.digits);
            draw_scale(this.metric_legend, `Listeners: ${metric.name}${metric.unit === "" ? "" : ` (${metric.unit})`}`,
                metric_color, [text(scale.from), text((scale.from + scale.to) / 2), text(scale.to)]);
        }
    }
}

/** The view is made after the first paint, so that the page can be read at once. */
export function scene_section(report: Report, scene: DecodedScene): Section {
    const place = el("div", { class: "view-place" });
    after_first_paint(() => {
        try {
            const view = new SceneView(report, scene);
            replace_children(place, view.viewer.element, view.controls(),
                el("p", { class: "hint" }, "Drag to turn, right-drag to move; click the view, then use the wheel to zoom. ",
                    "Click a path or a listener to choose it. With the keyboard: arrows turn, plus and minus zoom."),
                report.data.scene?.left_out
                    ? el("p", { class: "hint" }, `${report.data.scene.left_out} triangles are left out of this page.`) : null);
        } catch {
            replace_children(place, el("p", { class: "plain-message", role: "note" }, no_webgl_message));
        }
        place.dataset["ready"] = "true";
    });
    return section("scene", "Room", place);
}
