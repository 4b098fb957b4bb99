// SPDX-License-Identifier: MIT
// Legends: a bar of colours with numbers at its ends and between.
import { css, type Rgb } from "../colors";
import { el, replace_children } from "../dom";

const steps = 24;

/** Draws the scale into its element; colours are set as styles of elements, never as text of a style sheet. */
export function draw_scale(place: HTMLElement, title: string, color: (x: number) => Rgb, labels: string[]): void {
    const bar = el("div", { class: "bar", "aria-hidden": "true" });
    for (let i = 0; i < steps; ++i) {
        const cell = el("span");
        cell.style.backgroundColor = css(color(i / (steps - 1)));
        bar.append(cell);
    }
    replace_children(place, el("span", { class: "scale-title" }, title), bar,
        el("div", { class: "scale-labels" }, ...labels.map((text) => el("span", {}, text))));
}
