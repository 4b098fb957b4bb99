// SPDX-License-Identifier: MIT
// The frame of a section: a heading that names it for screen readers and for the list of contents.
import { type Child, el } from "../dom";

export interface Section {
    id: string;
    title: string;
    /** In the list of contents. */
    short_title: string;
    element: HTMLElement;
}

export function section(id: string, title: string, ...children: Child[]): Section {
    const heading = el("h2", { id: `${id}-title` }, title);
    const element = el("section", { id, "aria-labelledby": `${id}-title` }, heading, ...children);
    return { id, title, short_title: title, element };
}

/** A wide table that scrolls by itself, with the keyboard too. */
export function scrolling(label: string, table: HTMLElement): HTMLElement {
    return el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": label }, table);
}
