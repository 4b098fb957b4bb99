// SPDX-License-Identifier: MIT
// Paths of the chosen pair as lines coloured by order, the chosen one thicker; with a time, the part
// that the wave front has passed and the front itself.
import { BufferAttribute, BufferGeometry, Color, Points, ShaderMaterial } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { css, order_color } from "../colors";
import type { SoundPath, Vector } from "../data/schema";
import { current_pair, type Report, strongest_paths } from "../report";
import { scheme } from "../theme";
import { distance_to_segment, front_at, passed_points } from "./path_motion";
import type { Viewer } from "./viewer";

const reach_in_pixels = 9;
const dot_pixels = 9;

function color_of(path: SoundPath): Color {
    return new Color(css(order_color(path.order, scheme())));
}

/** Round dots; their size is in pixels of the canvas. */
function dot_material(): ShaderMaterial {
    return new ShaderMaterial({
        uniforms: { size: { value: dot_pixels } },
        vertexColors: true,
        depthTest: false,
        transparent: true,
        vertexShader: "uniform float size; varying vec3 tint; void main() { tint = color; " +
            "gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_PointSize = size; }",
        fragmentShader: "varying vec3 tint; void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5) discard; " +
            "gl_FragColor = vec4(tint, 1.0); #include <colorspace_fragment>\n}",
    });
}

class Lines {
    private readonly material: LineMaterial;
    private mesh: LineSegments2 | null = null;

    constructor(private readonly viewer: Viewer, width: number, opacity: number, order: number) {
        this.material = new LineMaterial({
            linewidth: width, vertexColors: true, transparent: opacity < 1, opacity, depthTest: false,
        });
        this.order = order;
    }

    private readonly order: number;

    set(lines: { points: Vector[]; color: Color }[]): void {
        if (this.mesh) {
            this.viewer.scene.remove(this.mesh);
            this.mesh.geometry.dispose();
            this.mesh = null;
        }
        const positions: number[] = [];
        const colors: number[] = [];
        for (const { points, color } of lines) {
            for (let i = 0; i + 1 < points.length; ++i) {
                positions.push(...points[i]!, ...points[i + 1]!);
                colors.push(color.r, color.g, color.b, color.r, color.g, color.b);
            }
        }
        if (positions.length > 0) {
            const geometry = new LineSegmentsGeometry().setPositions(positions).setColors(colors);
            this.mesh = new LineSegments2(geometry, this.material);
            this.mesh.renderOrder = this.order;
            this.mesh.frustumCulled = false;
            this.viewer.scene.add(this.mesh);
        }
    }

    set opacity(value: number) {
        this.material.opacity = value;
        this.material.transparent = value < 1;
    }
}

export class PathLines {
    private readonly all: Lines;
    private readonly passed: Lines;
    private readonly chosen: Lines;
    private readonly fronts: Points<BufferGeometry, ShaderMaterial>;
    private shown: number[] = [];

    constructor(private readonly viewer: Viewer, private readonly report: Report) {
        this.all = new Lines(viewer, 1.6, 0.9, 1);
        this.passed = new Lines(viewer, 2, 1, 2);
        this.chosen = new Lines(viewer, 4.5, 1, 3);
        this.fronts = new Points(new BufferGeometry(), dot_material());
        this.fronts.renderOrder = 4;
        this.fronts.frustumCulled = false;
        viewer.scene.add(this.fronts);
        viewer.on_frame(() => (this.fronts.material.uniforms["size"]!.value = dot_pixels * viewer.pixel_ratio));
    }

    /** Draws what the reader has chosen. */
    update(): void {
        const { band, hidden_orders, max_paths, path, time } = this.report.state.now;
        const paths = current_pair(this.report)?.paths ?? [];
        this.shown = strongest_paths(paths, band, hidden_orders, max_paths);
        const line = (index: number): { points: Vector[]; color: Color } =>
            ({ points: paths[index]!.points, color: color_of(paths[index]!) });
        // Weak paths first, so that strong ones lie above them.
        this.all.set([...this.shown].reverse().map(line));
        this.all.opacity = time !== null ? 0.15 : path !== null ? 0.35 : 0.9;
        this.chosen.set(path !== null && paths[path] ? [line(path)] : []);
        this.update_fronts(paths, time);
        this.viewer.ask_frame();
    }

    /** The path that is drawn closest to a place on the canvas, in pixels; null if none is near. */
    path_at(x: number, y: number): number | null {
        const paths = current_pair(this.report)?.paths ?? [];
        let best: number | null = null;
        let best_distance = reach_in_pixels;
        for (const index of this.shown) {
            const points = paths[index]!.points.map((p) => this.viewer.project(p));
            for (let i = 0; i + 1 < points.length; ++i) {
                const a = points[i];
                const b = points[i + 1];
                const distance = a && b ? distance_to_segment(x, y, a.x, a.y, b.x, b.y) : Infinity;
                if (distance < best_distance) {
                    best = index;
                    best_distance = distance;
                }
            }
        }
        return best;
    }

    private update_fronts(paths: SoundPath[], time: number | null): void {
        const positions: number[] = [];
        const colors: number[] = [];
        const passed: { points: Vector[]; color: Color }[] = [];
        if (time !== null) {
            for (const index of this.shown) {
                const path = paths[index]!;
                const front = front_at(path, time);
                if (front) {
                    const color = color_of(path);
                    positions.push(...front);
                    colors.push(color.r, color.g, color.b);
                    passed.push({ points: passed_points(path, time), color });
                }
            }
        }
        this.passed.set(passed);
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
        geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
        this.fronts.geometry.dispose();
        this.fronts.geometry = geometry;
        this.fronts.visible = positions.length > 0;
    }
}
