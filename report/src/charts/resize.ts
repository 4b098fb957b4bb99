// SPDX-License-Identifier: MIT
// Calls a drawing with the width of its place, now and whenever that changes.

export function on_width(element: Element, draw: (width: number) => void): void {
    let width = 0;
    new ResizeObserver((entries) => {
        const next = Math.round(entries[0]?.contentRect.width ?? 0);
        if (next > 0 && next !== width) {
            width = next;
            draw(width);
        }
    }).observe(element);
}
