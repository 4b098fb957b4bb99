// SPDX-License-Identifier: MIT
// The one place that speaks to screen readers when a choice changes what is shown elsewhere.
import { el } from "./dom";

const region = el("p", { class: "visually-hidden", role: "status", "aria-live": "polite" });

export function live_region(): HTMLElement {
    return region;
}

export function announce(text: string): void {
    region.textContent = text;
}
