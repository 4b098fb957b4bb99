// SPDX-License-Identifier: MIT
// Listening: the dry recording and the same in the room, switched without losing the place.
import { button, el, replace_children } from "../dom";
import { announce } from "../live_region";
import { current_pair, pair_name, type Report } from "../report";
import { section, type Section } from "./section";

function player(label: string, source: string): HTMLAudioElement {
    // Only sound inside of the page is played.
    return el("audio", { controls: true, preload: "metadata", "aria-label": label, src: source.startsWith("data:audio/") ? source : null });
}

function draw(report: Report, place: HTMLElement): void {
    const pair = current_pair(report);
    const audio = pair?.audio;
    if (!pair || !audio || (!audio.dry && !audio.wet)) {
        replace_children(place, el("p", { class: "empty" }, "This pair has no sound in this report."));
        return;
    }
    const name = pair_name(report.data, pair);
    const dry = audio.dry ? player("Dry recording", audio.dry) : null;
    const wet = audio.wet ? player(`In the room: ${name}`, audio.wet) : null;
    const row = (text: string, element: HTMLElement | null): HTMLElement | null =>
        element && el("div", { class: "player" }, el("span", {}, text), element);
    const swap = dry && wet && button("Switch dry / room", () => {
        const from = dry.paused ? wet : dry;
        const to = dry.paused ? dry : wet;
        to.currentTime = Math.min(from.currentTime, to.duration || 0);
        from.pause();
        void to.play();
        announce(to === dry ? "Dry recording" : "In the room");
    });
    replace_children(place, audio.text ? el("p", {}, audio.text) : null, row("Dry", dry), row("In the room", wet), swap);
}

export function audio_section(report: Report): Section | null {
    if (!report.data.pairs?.some((pair) => pair.audio)) {
        return null;
    }
    const place = el("div", { class: "audio" });
    const update = (): void => draw(report, place);
    update();
    report.state.subscribe(["pair"], update);
    return section("audio", "Listening", place);
}
