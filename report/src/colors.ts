// SPDX-License-Identifier: MIT
// Colour scales that readers with colour-vision deficiencies can tell apart: sequential ones grow in
// lightness alone, orders of reflection take the palette of Okabe and Ito 2008.
import type { Scheme } from "./theme";

export type Rgb = [number, number, number];

function of_hex(hex: string): Rgb {
    const value = parseInt(hex.slice(1), 16);
    return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}

export function css(color: Rgb): string {
    return `rgb(${color.map((c) => Math.round(c)).join(", ")})`;
}

/** Linear interpolation in a list of colours at equal steps; x is clamped to 0..1. */
export function interpolate(stops: Rgb[], x: number): Rgb {
    const place = Math.min(Math.max(x, 0), 1) * (stops.length - 1);
    const i = Math.min(Math.floor(place), stops.length - 2);
    const a = stops[i] ?? [0, 0, 0];
    const b = stops[i + 1] ?? a;
    return [0, 1, 2].map((k) => a[k]! + (place - i) * (b[k]! - a[k]!)) as Rgb;
}

// Viridis, by Smith and van der Walt 2015.
const viridis = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"]
    .map(of_hex);
const absorption_light = ["#f7efe2", "#cde6e0", "#8fcdcb", "#43a5b1", "#14758d", "#074a66"].map(of_hex);
const absorption_dark = ["#454a52", "#3f626b", "#3a8088", "#46a3a4", "#72c7bd", "#b5ecd9"].map(of_hex);

/** Metrics of listeners and maps. */
export function metric_color(x: number): Rgb {
    return interpolate(viridis, x);
}

/** Absorption of surfaces: 0 fades into the background. */
export function absorption_color(x: number, scheme: Scheme): Rgb {
    return interpolate(scheme === "dark" ? absorption_dark : absorption_light, x);
}

const orders_light = ["#111111", "#0072b2", "#c24e00", "#007a57", "#a8447f", "#7a6200", "#5b6470"].map(of_hex);
const orders_dark = ["#ffffff", "#56b4e9", "#f0a030", "#2fc99a", "#e39ac6", "#f0e442", "#a3adb8"].map(of_hex);

/** The direct sound is order 0; orders beyond the palette share its last colour. */
export function order_color(order: number, scheme: Scheme): Rgb {
    const palette = scheme === "dark" ? orders_dark : orders_light;
    return palette[Math.min(order, palette.length - 1)]!;
}

export function material_less_color(scheme: Scheme): Rgb {
    return scheme === "dark" ? [88, 92, 98] : [214, 214, 214];
}
