// SPDX-License-Identifier: MIT
// Whether WebGL is drawn by the processor: then edges are not smoothed while the view moves, and a
// view at rest is drawn with more pixels instead.

const software_renderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;
const max_pixel_ratio = 2;

export interface PixelRatios {
    moving: number;
    still: number;
    smooth_edges: boolean;
}

/** Of a browser that tells no renderer, a graphics card is assumed. */
function draws_by_processor(): boolean {
    const context = document.createElement("canvas").getContext("webgl2");
    const names = context?.getExtension("WEBGL_debug_renderer_info");
    const renderer = context && names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return software_renderers.test(renderer);
}

export function pixel_ratios(): PixelRatios {
    const screen = Math.min(window.devicePixelRatio, max_pixel_ratio);
    return draws_by_processor()
        ? { moving: 1, still: Math.max(screen, 1.5), smooth_edges: false }
        : { moving: screen, still: screen, smooth_edges: true };
}
