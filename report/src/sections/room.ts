// SPDX-License-Identifier: MIT
// The room in numbers: extent, volume, surface, and reverberation times by Sabine and Eyring.
import type { PerBand, ReportData } from "../data/schema";
import { el } from "../dom";
import { band, number, with_unit } from "../format";
import { scrolling } from "./section";

function fact(name: string, text: string): HTMLElement {
    return el("div", { class: "fact" }, el("dt", {}, name), el("dd", {}, text));
}

function times_row(name: string, times: PerBand | undefined): HTMLElement | null {
    return times
        ? el("tr", {}, el("th", { scope: "row" }, name), ...times.map((t) => el("td", {}, number(t, 2))))
        : null;
}

export function room_facts(data: ReportData): HTMLElement | null {
    const room = data.room;
    if (!room) {
        return null;
    }
    const facts = el("dl", { class: "facts" });
    if (room.extent) {
        facts.append(fact("Extent", with_unit(room.extent.map((x) => number(x, 1)).join(" \u00d7 "), "m")));
    }
    if (typeof room.volume === "number") {
        facts.append(fact("Volume", with_unit(number(room.volume, 0), "m\u00b3")));
    }
    if (typeof room.surface === "number") {
        facts.append(fact("Surface", with_unit(number(room.surface, 0), "m\u00b2")));
    }
    facts.append(
        fact("Sources", String(data.sources?.length ?? 0)), fact("Listeners", String(data.listeners?.length ?? 0)));
    const bands = data.bands ?? [];
    const times = (room.sabine || room.eyring) && bands.length > 0
        ? scrolling("Reverberation times of the room by formula", el("table", { class: "numbers" },
            el("caption", {}, "Reverberation time by formula, in seconds"),
            el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Formula"),
                ...bands.map((f) => el("th", { scope: "col" }, band(f))))),
            el("tbody", {}, times_row("Sabine", room.sabine), times_row("Eyring", room.eyring))))
        : null;
    return el("div", { class: "room" }, facts, times);
}
