// SPDX-License-Identifier: MIT
// The slider of time and the button that plays it in slow motion.
import { button, el, next_id, replace_children } from "../dom";
import { milliseconds } from "../format";

export interface TimeControl {
    element: HTMLElement;
    /** The end of the slider changes with the pair. */
    set_end(seconds: number): void;
}

/** `on_time` gets seconds, null when time is switched off. */
export function time_control(label: string, playing_seconds: number, on_time: (time: number | null) => void): TimeControl {
    const id = next_id("time");
    const slider = el("input", { type: "range", id, min: 0, max: 1000, step: 1, value: 0 });
    const output = el("output", { for: id });
    let end = 0;
    let started: number | null = null;
    const show = (share: number | null): void => {
        replace_children(output, share === null ? "whole paths" : milliseconds(share * end));
        slider.setAttribute("aria-valuetext", output.textContent ?? "");
        on_time(share === null ? null : share * end);
    };
    const play = button("Play", () => (started === null ? start() : stop()), { class: "play" });
    const stop = (): void => {
        started = null;
        replace_children(play, "Play");
    };
    const step = (now: number): void => {
        if (started === null) {
            return;
        }
        const share = (now - started) / (1000 * playing_seconds);
        slider.value = String(Math.round(1000 * Math.min(share, 1)));
        show(Math.min(share, 1));
        if (share < 1) {
            requestAnimationFrame(step);
        } else {
            stop();
        }
    };
    const start = (): void => {
        const from = Number(slider.value) >= 1000 ? 0 : Number(slider.value) / 1000;
        started = performance.now() - 1000 * playing_seconds * from;
        replace_children(play, "Pause");
        requestAnimationFrame(step);
    };
    slider.addEventListener("input", () => {
        stop();
        show(Number(slider.value) / 1000);
    });
    const reset = button("Whole paths", () => {
        stop();
        slider.value = "0";
        show(null);
    });
    replace_children(output, "whole paths");
    return {
        element: el("div", { class: "controls time" }, play, el("label", { for: id }, label), slider, output, reset),
        set_end: (seconds) => {
            end = seconds;
        },
    };
}
