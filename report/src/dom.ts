// SPDX-License-Identifier: MIT
// Elements made by calls. Text is only ever inserted as text, so names cannot become markup.

export type Child = Node | string | null | undefined | false;
export type Attributes = Record<string, string | number | boolean | null | undefined>;

function fill<E extends Element>(element: E, attributes: Attributes, children: Child[]): E {
    for (const [name, value] of Object.entries(attributes)) {
        if (value === true) {
            element.setAttribute(name, "");
        } else if (value !== null && value !== undefined && value !== false) {
            element.setAttribute(name, String(value));
        }
    }
    append(element, children);
    return element;
}

export function append(element: Element, children: Child[]): void {
    for (const child of children) {
        if (typeof child === "string") {
            element.append(document.createTextNode(child));
        } else if (child) {
            element.append(child);
        }
    }
}

export function el<K extends keyof HTMLElementTagNameMap>(
    tag: K, attributes: Attributes = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
    return fill(document.createElement(tag), attributes, children);
}

export function svg<K extends keyof SVGElementTagNameMap>(
    tag: K, attributes: Attributes = {}, ...children: Child[]
): SVGElementTagNameMap[K] {
    return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

export function replace_children(element: Element, ...children: Child[]): void {
    element.replaceChildren();
    append(element, children);
}

/** A number for `id` and `for` attributes, different at each call. */
let last_id = 0;
export function next_id(prefix: string): string {
    last_id += 1;
    return `${prefix}-${last_id}`;
}

export interface Choice {
    value: string;
    text: string;
}

/** A labelled drop-down list. */
export function select(
    label: string, choices: Choice[], value: string, on_change: (value: string) => void
): { field: HTMLElement; input: HTMLSelectElement } {
    const id = next_id("choice");
    const input = el("select", { id },
        ...choices.map((c) => el("option", { value: c.value, selected: c.value === value }, c.text)));
    input.addEventListener("change", () => on_change(input.value));
    return { field: el("span", { class: "field" }, el("label", { for: id }, label), input), input };
}

export function checkbox(
    label: string, checked: boolean, on_change: (checked: boolean) => void
): HTMLLabelElement {
    const input = el("input", { type: "checkbox", checked });
    input.addEventListener("change", () => on_change(input.checked));
    return el("label", { class: "check" }, input, label);
}

export function button(label: string, on_click: () => void, attributes: Attributes = {}): HTMLButtonElement {
    const element = el("button", { type: "button", ...attributes }, label);
    element.addEventListener("click", on_click);
    return element;
}

/** Calls when the browser has painted what the page holds now. */
export function after_first_paint(run: () => void): void {
    requestAnimationFrame(() => window.setTimeout(run, 0));
}
