// SPDX-License-Identifier: MIT
// The bar that stays in sight: which pair and which band the sections show.
import { el, select } from "../dom";
import { band } from "../format";
import { announce } from "../live_region";
import { pair_name, type Report } from "../report";
import type { Section } from "./section";

export function toolbar(report: Report, sections: Section[]): HTMLElement {
    const { data, state } = report;
    const pairs = data.pairs ?? [];
    const bands = data.bands ?? [];
    const pair_choice = pairs.length > 0 ? select("Pair",
        pairs.map((pair, i) => ({ value: String(i), text: pair_name(data, pair) })), String(state.now.pair),
        (value) => state.set({ pair: Number(value) })) : null;
    const band_choice = bands.length > 0 ? select("Band",
        bands.map((f, i) => ({ value: String(i), text: band(f) })), String(state.now.band),
        (value) => {
            state.set({ band: Number(value) });
            announce(`Band ${band(bands[Number(value)] ?? 0)}`);
        }) : null;
    state.subscribe(["pair"], () => {
        if (pair_choice) {
            pair_choice.input.value = String(state.now.pair);
        }
    });
    const links = sections.map((s) => el("li", {}, el("a", { href: `#${s.id}` }, s.short_title)));
    return el("div", { class: "toolbar" },
        el("nav", { "aria-label": "Contents" }, el("ul", {}, ...links)),
        (pair_choice || band_choice) && el("div", { class: "choices", role: "group", "aria-label": "What is shown" },
            pair_choice?.field, band_choice?.field));
}
