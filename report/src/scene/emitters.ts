// SPDX-License-Identifier: MIT
// Sources and listeners as spheres with names beside them; listeners coloured by a metric.
import { Color, Mesh, MeshBasicMaterial, OctahedronGeometry, SphereGeometry } from "three";
import { css, metric_color } from "../colors";
import type { Emitter, Vector } from "../data/schema";
import { el } from "../dom";
import { number, with_unit } from "../format";
import { find_metric } from "../metrics/definitions";
import { value_of } from "../metrics/values";
import { current_pair, type Report } from "../report";
import { style_color } from "../theme";
import { listener_scale, type Scale } from "./listener_scale";
import type { Viewer } from "./viewer";

const max_labels = 60;

interface Marker {
    mesh: Mesh<OctahedronGeometry | SphereGeometry, MeshBasicMaterial>;
    label: HTMLElement | null;
    emitter: Emitter;
    position: Vector;
    index: number;
}

export class Emitters {
    private readonly sources: Marker[];
    private readonly listeners: Marker[];

    constructor(private readonly viewer: Viewer, private readonly report: Report, size: number) {
        const { sources = [], listeners = [] } = report.data;
        const has_labels = sources.length + listeners.length <= max_labels;
        const marker = (emitter: Emitter, index: number, kind: string): Marker[] => {
            const { position } = emitter;
            if (position === null) {
                return [];
            }
            const geometry = kind === "source" ? new OctahedronGeometry(1.3 * size) : new SphereGeometry(size, 20, 14);
            const mesh = new Mesh(geometry, new MeshBasicMaterial({ depthTest: false, transparent: true }));
            mesh.position.set(...position);
            mesh.renderOrder = 5;
            viewer.scene.add(mesh);
            const label = has_labels ? el("span", { class: `label ${kind}` }, emitter.name) : null;
            if (label) {
                viewer.element.append(label);
            }
            return [{ mesh, label, emitter, position, index }];
        };
        this.sources = sources.flatMap((e, i) => marker(e, i, "source"));
        this.listeners = listeners.flatMap((e, i) => marker(e, i, "listener"));
        viewer.on_frame(() => this.place_labels());
    }

    /** Values of the metric at the listeners, from the chosen pair's source. */
    values(): (number | null)[] {
        const { data, state } = this.report;
        const metric = find_metric(state.now.metric);
        const source = current_pair(this.report)?.source;
        return (data.listeners ?? []).map((_, listener) => {
            const pair = data.pairs?.find((p) => p.source === source && p.listener === listener);
            return metric ? value_of(pair?.metrics, metric, state.now.band) : null;
        });
    }

    scale(): Scale | null {
        const metric = find_metric(this.report.state.now.metric);
        const values = this.values();
        if (!metric) {
            return null;
        }
        const present = values.filter((v): v is number => v !== null);
        const mean = present.reduce((sum, v) => sum + v, 0) / Math.max(present.length, 1);
        return listener_scale(values, metric.jnd_is_share ? metric.jnd * mean : metric.jnd / metric.scale);
    }

    update(): void {
        const values = this.values();
        const scale = this.scale();
        const metric = find_metric(this.report.state.now.metric);
        const pair = current_pair(this.report);
        this.listeners.forEach((marker) => {
            const i = marker.index;
            const value = values[i] ?? null;
            marker.mesh.material.color = value !== null && scale
                ? new Color(css(metric_color((value - scale.from) / Math.max(scale.to - scale.from, 1e-9))))
                : new Color(style_color("--muted"));
            marker.mesh.scale.setScalar(pair?.listener === i ? 1.5 : 1);
            if (marker.label) {
                const text = metric && value !== null
                    ? `${metric.name} ${with_unit(number(value * metric.scale, metric.digits), metric.unit)}` : "";
                marker.label.classList.toggle("chosen", pair?.listener === i);
                marker.label.replaceChildren(marker.emitter.name, ...(text ? [el("small", {}, text)] : []));
            }
        });
        this.sources.forEach((marker) => {
            const i = marker.index;
            marker.mesh.material.color = new Color(style_color("--source"));
            marker.mesh.scale.setScalar(pair?.source === i ? 1.5 : 1);
            marker.label?.classList.toggle("chosen", pair?.source === i);
        });
        this.viewer.ask_frame();
    }

    /** The listener at a place of the canvas, in pixels. */
    listener_at(x: number, y: number): number | null {
        const found = this.listeners.find((marker) => {
            const p = this.viewer.project(marker.mesh.position);
            return p !== null && Math.hypot(p.x - x, p.y - y) < 12;
        });
        return found?.index ?? null;
    }

    private place_labels(): void {
        for (const { label, position } of [...this.sources, ...this.listeners]) {
            if (label) {
                const p = this.viewer.project(position);
                label.hidden = p === null;
                if (p) {
                    // Shares of the view, so that labels stay in place on paper.
                    label.style.left = `${((100 * p.x) / this.viewer.width).toFixed(2)}%`;
                    label.style.top = `${((100 * p.y) / this.viewer.height).toFixed(2)}%`;
                }
            }
        }
    }
}
