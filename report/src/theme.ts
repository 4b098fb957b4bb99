// SPDX-License-Identifier: MIT
// The scheme of colours that the reader's system asks for; paper is always light.

export type Scheme = "light" | "dark";

const query = window.matchMedia("(prefers-color-scheme: dark)");
let printing = false;
const listeners: ((scheme: Scheme) => void)[] = [];

export function scheme(): Scheme {
    return query.matches && !printing ? "dark" : "light";
}

/** A colour of the style sheet, such as `--ink`. */
export function style_color(name: string): string {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Calls at every change of scheme and size of paper; drawings on canvases are then made anew. */
export function on_scheme_change(update: (scheme: Scheme) => void): void {
    listeners.push(update);
}

function changed(): void {
    document.documentElement.dataset["scheme"] = scheme();
    for (const update of listeners) {
        update(scheme());
    }
}

export function start_theme(): void {
    query.addEventListener("change", changed);
    window.addEventListener("beforeprint", () => {
        printing = true;
        changed();
    });
    window.addEventListener("afterprint", () => {
        printing = false;
        changed();
    });
    document.documentElement.dataset["scheme"] = scheme();
}
