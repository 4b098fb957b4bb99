// SPDX-License-Identifier: MIT
// A picture in place of the canvas on paper, where browsers leave WebGL canvases empty.
import { el } from "../dom";
import type { Viewer } from "./viewer";

export function printed_picture(viewer: Viewer): HTMLElement {
    const image = el("img", { class: "printed", alt: "The 3-D view as it was when the page was printed" });
    window.addEventListener("beforeprint", () => {
        image.src = viewer.picture();
    });
    return image;
}
