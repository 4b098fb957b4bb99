// SPDX-License-Identifier: MIT
// Reasons of withheld values, numbered in the order of their first use below a table.
import { el } from "../dom";
import { dash } from "../format";

export class Reasons {
    private readonly texts: string[] = [];

    /** `id` starts the names of the anchors, different for each table. */
    constructor(private readonly id: string) {}

    /** What stands in the table in place of a value. */
    mark(text: string): HTMLElement {
        let index = this.texts.indexOf(text);
        if (index < 0) {
            index = this.texts.push(text) - 1;
        }
        return el("a", {
            class: "reason-mark", href: `#${this.id}-${index + 1}`, title: text, "aria-label": `no value, reason ${index + 1}`,
        }, `${dash}\u2009`, el("sup", {}, String(index + 1)));
    }

    /** The list below the table; null if no value is missing. */
    list(): HTMLElement | null {
        return this.texts.length === 0 ? null : el("div", { class: "reasons" },
            el("h3", {}, "Why values are missing"),
            el("ol", {}, ...this.texts.map((text, i) => el("li", { id: `${this.id}-${i + 1}` }, text))));
    }
}
