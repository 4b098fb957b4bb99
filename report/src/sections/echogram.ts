// SPDX-License-Identifier: MIT
// Echogram: a stem per path, at its delay and level. A stem and the path in the 3-D view choose each
// other; the slider below steps through the paths with the keyboard.
import type { SoundPath } from "../data/schema";
import { draw_axes, type Frame } from "../charts/axes";
import { on_width } from "../charts/resize";
import { css, order_color } from "../colors";
import { button, el, next_id, replace_children, svg } from "../dom";
import { announce } from "../live_region";
import { current_pair, describe_path, path_level, type Report } from "../report";
import { on_scheme_change, scheme } from "../theme";
import { closest_stem } from "./closest_stem";
import { order_legend } from "./order_legend";
import { section, type Section } from "./section";

const height = 300;
const level_range_db = 60;

interface Stem {
    index: number;
    x: number;
    y: number;
    element: SVGGElement;
}

/** Paths by delay, the order of the slider. */
function by_delay(paths: SoundPath[], hidden_orders: ReadonlySet<number>): number[] {
    return paths.map((_, i) => i).filter((i) => !hidden_orders.has(paths[i]!.order))
        .sort((a, b) => paths[a]!.delay - paths[b]!.delay || a - b);
}

class Echogram {
    readonly place = el("div", { class: "chart echogram" });
    readonly detail = el("p", { class: "path-detail" });
    private readonly slider_id = next_id("path");
    private readonly slider = el("input", { type: "range", id: this.slider_id, min: 0, step: 1 });
    private stems: Stem[] = [];
    private order_of_slider: number[] = [];
    private width = 0;
    private frame: Frame | null = null;
    private time_line: SVGLineElement | null = null;

    constructor(private readonly report: Report) {
        on_width(this.place, (width) => {
            this.width = width;
            this.draw();
        });
        on_scheme_change(() => this.draw());
        this.slider.addEventListener("input", () => this.choose(this.order_of_slider[Number(this.slider.value)] ?? null));
        report.state.subscribe(["pair", "band", "hidden_orders"], () => this.draw());
        report.state.subscribe(["path"], () => this.mark());
        report.state.subscribe(["time"], () => this.show_time());
    }

    controls(): HTMLElement {
        const step = (by: number) => () => {
            const place = this.order_of_slider.indexOf(this.report.state.now.path ?? -1);
            const next = place < 0 && by < 0 ? this.order_of_slider.length - 1 : place + by;
            this.choose(this.order_of_slider[next] ?? this.report.state.now.path);
        };
        return el("div", { class: "controls path-controls" },
            el("label", { for: this.slider_id }, "Path, by delay"), this.slider,
            button("Previous", step(-1)), button("Next", step(1)),
            button("None", () => this.report.state.set({ path: null })));
    }

    private paths(): SoundPath[] {
        return current_pair(this.report)?.paths ?? [];
    }

    private choose(path: number | null): void {
        this.report.state.set({ path });
        if (path !== null) {
            announce(`Path ${describe_path(this.paths()[path]!, this.report.state.now.band)}`);
        }
    }

    private draw(): void {
        const { band, hidden_orders } = this.report.state.now;
        const paths = this.paths();
        this.order_of_slider = by_delay(paths, hidden_orders);
        this.slider.max = String(Math.max(this.order_of_slider.length - 1, 0));
        this.slider.disabled = this.order_of_slider.length === 0;
        if (this.width === 0) {
            return;
        }
        const levels = paths.map((path) => path_level(path, band));
        const top = 5 * Math.ceil(Math.max(...levels.filter(Number.isFinite), -level_range_db) / 5 + 0.2);
        const last = Math.max(...paths.map((p) => p.delay), 0.01);
        const frame = draw_axes(this.width, height,
            { from: 0, to: 1000 * last * 1.03, title: "Delay after emission (ms)" },
            { from: top - level_range_db, to: top, title: "Level (dB re 1 m)" });
        const drawing = svg("svg", {
            width: this.width, height, viewBox: `0 0 ${this.width} ${height}`, role: "img",
            "aria-label": `Echogram of ${paths.length} paths; the slider below steps through them`,
        }, frame.group);
        this.stems = this.order_of_slider.map((i) => this.stem(paths[i]!, i, levels[i]!, top, frame));
        drawing.append(this.limits(paths, frame), ...this.stems.map((s) => s.element));
        this.frame = frame;
        this.time_line = svg("line", { class: "time-line", y1: frame.top, y2: frame.bottom });
        drawing.append(this.time_line);
        this.show_time();
        drawing.addEventListener("click", (event) => {
            const box = drawing.getBoundingClientRect();
            this.choose(closest_stem(this.stems, event.clientX - box.left, event.clientY - box.top));
        });
        replace_children(this.place, drawing);
        this.mark();
    }

    /** Where the early energy of clarity ends: 50 and 80 ms after the direct sound. */
    private limits(paths: SoundPath[], frame: Frame): SVGGElement {
        const first = Math.min(...paths.map((p) => p.delay));
        const limit = (ms: number): SVGElement[] => {
            const x = frame.x(1000 * first + ms);
            return x > frame.right ? [] : [
                svg("line", { x1: x, x2: x, y1: frame.top, y2: frame.bottom }),
                svg("text", { x: x + 4, y: frame.top + 12 }, `${ms} ms after the first`),
            ];
        };
        return svg("g", { class: "limits", "aria-hidden": "true" }, ...limit(50), ...limit(80));
    }

    private show_time(): void {
        const { time } = this.report.state.now;
        if (this.time_line && this.frame) {
            const x = String(this.frame.x(1000 * (time ?? 0)));
            this.time_line.setAttribute("x1", x);
            this.time_line.setAttribute("x2", x);
            this.time_line.style.display = time === null ? "none" : "";
        }
    }

    private stem(path: SoundPath, index: number, level: number, top: number, frame: Frame): Stem {
        const x = frame.x(1000 * path.delay);
        const y = frame.y(Math.max(level, top - level_range_db));
        const color = css(order_color(path.order, scheme()));
        const element = svg("g", { class: "stem", "data-path": index },
            svg("line", { x1: x, x2: x, y1: frame.bottom, y2: y, stroke: color }),
            svg("circle", { cx: x, cy: y, r: path.order === 0 ? 4.5 : 3, fill: color }),
            svg("title", {}, describe_path(path, this.report.state.now.band)));
        return { index, x, y, element };
    }

    private mark(): void {
        const { path, band } = this.report.state.now;
        for (const stem of this.stems) {
            stem.element.classList.toggle("chosen", stem.index === path);
        }
        const chosen = this.stems.find((s) => s.index === path);
        chosen?.element.parentNode?.append(chosen.element);
        const data = path === null ? undefined : this.paths()[path];
        this.detail.textContent = data ? `Path ${describe_path(data, band)}` : "No path is chosen.";
        this.slider.setAttribute("aria-valuetext", this.detail.textContent);
        const place = this.order_of_slider.indexOf(path ?? -1);
        this.slider.value = String(Math.max(place, 0));
    }
}

export function echogram_section(report: Report): Section | null {
    if (!report.data.pairs?.some((pair) => pair.paths?.length)) {
        return null;
    }
    const echogram = new Echogram(report);
    const left_out = el("p", { class: "hint" });
    const update = (): void => {
        const count = current_pair(report)?.paths_left_out ?? 0;
        left_out.textContent = count > 0 ? `${count} weaker paths are left out of this page.` : "";
    };
    update();
    report.state.subscribe(["pair"], update);
    return section("echogram", "Echogram", el("div", { class: "controls" }, order_legend(report)),
        el("figure", {}, echogram.place,
            el("figcaption", {}, "Level and delay of each path in the chosen band; click a stem to see its path in the room.")),
        echogram.controls(), echogram.detail, left_out);
}
