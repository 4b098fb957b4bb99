// SPDX-License-Identifier: MIT
// Canvas, camera and frames. A frame is drawn only when something has changed.
import { Color, DirectionalLight, HemisphereLight, MOUSE, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { el } from "../dom";
import type { Vector } from "../data/schema";
import { on_scheme_change, scheme, style_color } from "../theme";
import { pixel_ratios } from "./rendering_speed";

const field_of_view_degrees = 38;
/** Of the picture's width or height, by the scene at first. */
const used_share = 0.94;
const fitting_steps = 4;
/** Without a change the view is at rest. */
const rest_milliseconds = 250;

export interface ViewPoint {
    /** From the middle of the scene towards the camera. */
    direction: Vector;
    name: string;
}

export const view_points: ViewPoint[] = [
    { name: "Corner", direction: [0.8, 0.72, 1] },
    { name: "Above", direction: [0, 1, 0.001] },
    { name: "Front", direction: [0, 0.12, 1] },
    { name: "Side", direction: [1, 0.12, 0] },
];

export class Viewer {
    readonly scene = new Scene();
    readonly camera = new PerspectiveCamera(field_of_view_degrees, 1, 0.05, 2000);
    readonly element: HTMLElement;
    readonly canvas: HTMLCanvasElement;
    private readonly renderer: WebGLRenderer;
    private readonly orbit: OrbitControls;
    private readonly before_frame: (() => void)[] = [];
    private readonly middle: Vector3;
    private readonly radius: number;
    private readonly corners: Vector3[];
    /** Of the last chosen view point, until the reader turns the view. */
    private direction: Vector | null = null;
    private readonly ratios = pixel_ratios();
    private is_dragged = false;
    private rest_timer: number | undefined;
    private frame_is_asked = false;
    private size = { width: 0, height: 0 };

    /** Throws if the browser has no WebGL. */
    constructor(label: string, min: Vector, max: Vector) {
        this.renderer = new WebGLRenderer({ antialias: this.ratios.smooth_edges, powerPreference: "low-power" });
        this.canvas = this.renderer.domElement;
        this.canvas.setAttribute("tabindex", "0");
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute("aria-label", `${label}. Arrow keys turn the view, plus and minus zoom.`);
        this.element = el("div", { class: "view" }, this.canvas);
        this.middle = new Vector3(...min).add(new Vector3(...max)).multiplyScalar(0.5);
        this.radius = Math.max(new Vector3(...max).sub(new Vector3(...min)).length() / 2, 1e-3);
        this.corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
            new Vector3((i & 1 ? max : min)[0], (i & 2 ? max : min)[1], (i & 4 ? max : min)[2]));
        this.camera.near = this.radius / 200;
        this.camera.far = this.radius * 40;
        this.add_lights();
        this.orbit = new OrbitControls(this.camera, this.canvas);
        this.orbit.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
        this.orbit.enableDamping = false;
        // The wheel zooms once the reader works in the view; before, it scrolls the page.
        this.orbit.enableZoom = false;
        this.canvas.addEventListener("pointerdown", () => (this.orbit.enableZoom = true));
        this.canvas.addEventListener("blur", () => (this.orbit.enableZoom = false));
        this.orbit.addEventListener("change", () => this.ask_frame());
        this.orbit.addEventListener("start", () => {
            this.direction = null;
            this.is_dragged = true;
        });
        this.orbit.addEventListener("end", () => {
            this.is_dragged = false;
            this.ask_frame();
        });
        this.canvas.addEventListener("keydown", (event) => this.on_key(event));
        this.renderer.setPixelRatio(this.ratios.still);
        new ResizeObserver(() => this.fit()).observe(this.element);
        on_scheme_change(() => {
            this.set_background();
            this.draw();
        });
        this.set_background();
        this.look_from(view_points[0]!.direction);
    }

    /** Calls before every frame, for labels that follow the view. */
    on_frame(update: () => void): void {
        this.before_frame.push(update);
    }

    ask_frame(): void {
        if (!this.frame_is_asked) {
            this.frame_is_asked = true;
            requestAnimationFrame(() => this.draw_moving());
        }
    }

    /** Pixels of the canvas per pixel of the page. */
    get pixel_ratio(): number {
        return this.renderer.getPixelRatio();
    }

    draw(): void {
        this.frame_is_asked = false;
        if (this.size.width === 0) {
            return;
        }
        this.camera.updateMatrixWorld();
        for (const update of this.before_frame) {
            update();
        }
        this.renderer.render(this.scene, this.camera);
    }

    look_from(direction: Vector): void {
        this.direction = direction;
        const towards_camera = new Vector3(...direction).normalize();
        const right = new Vector3(0, 1, 0).cross(towards_camera).normalize();
        const up = towards_camera.clone().cross(right);
        const target = this.middle.clone();
        let distance = 0;
        // What is close to the camera looks larger, so the middle of the picture is found by steps.
        for (let step = 0; step < fitting_steps; ++step) {
            const heights = this.corners.map((corner) => corner.clone().sub(target));
            distance = this.fitting_distance(heights, right, up, towards_camera);
            const slopes = heights.map((offset) => offset.dot(up) / Math.max(distance - offset.dot(towards_camera), 1e-9));
            target.addScaledVector(up, ((Math.max(...slopes) + Math.min(...slopes)) / 2) * distance);
        }
        this.orbit.target.copy(target);
        this.camera.position.copy(target).addScaledVector(towards_camera, distance);
        this.orbit.update();
        this.ask_frame();
    }

    /** Where a point is on the canvas, in pixels of the page; null behind the camera. */
    project(point: Vector | Vector3): { x: number; y: number } | null {
        const p = (Array.isArray(point) ? new Vector3(...point) : point.clone()).project(this.camera);
        if (p.z > 1) {
            return null;
        }
        return { x: ((p.x + 1) / 2) * this.size.width, y: ((1 - p.y) / 2) * this.size.height };
    }

    /** The picture of the present view, for paper. */
    picture(): string {
        this.draw();
        return this.canvas.toDataURL("image/png");
    }

    get width(): number {
        return this.size.width;
    }

    get height(): number {
        return this.size.height;
    }

    /** From where all corners of the scene's extent are in the picture. */
    private fitting_distance(offsets: Vector3[], right: Vector3, up: Vector3, towards_camera: Vector3): number {
        const slope_up = used_share * Math.tan((field_of_view_degrees / 2) * (Math.PI / 180));
        const slope_right = slope_up * this.camera.aspect;
        return Math.max(...offsets.map((offset) => offset.dot(towards_camera) +
            Math.max(Math.abs(offset.dot(right)) / slope_right, Math.abs(offset.dot(up)) / slope_up)));
    }

    private draw_moving(): void {
        if (this.ratios.moving !== this.ratios.still) {
            window.clearTimeout(this.rest_timer);
            this.rest_timer = window.setTimeout(() => this.draw_still(), rest_milliseconds);
            if (this.pixel_ratio !== this.ratios.moving) {
                this.renderer.setPixelRatio(this.ratios.moving);
            }
        }
        this.draw();
    }

    private draw_still(): void {
        if (!this.is_dragged && !this.frame_is_asked) {
            this.renderer.setPixelRatio(this.ratios.still);
            this.draw();
        }
    }

    private add_lights(): void {
        this.scene.add(new HemisphereLight(0xffffff, 0xb9b4ab, 2.4));
        const sun = new DirectionalLight(0xffffff, 1.1);
        sun.position.set(0.5, 1, 0.8);
        this.scene.add(sun);
    }

    private set_background(): void {
        this.scene.background = new Color(style_color("--view") || (scheme() === "dark" ? "#111418" : "#f3f2ee"));
    }

    private fit(): void {
        const width = this.element.clientWidth;
        const height = this.element.clientHeight;
        if (width === 0 || height === 0) {
            return;
        }
        this.size = { width, height };
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        if (this.direction !== null) {
            this.look_from(this.direction);
        }
        // Setting the size clears the canvas: draw at once, so that nothing flickers.
        this.draw();
    }

    private on_key(event: KeyboardEvent): void {
        const offset = this.camera.position.clone().sub(this.orbit.target);
        const step = 0.1;
        const horizontal = new Vector3(offset.z, 0, -offset.x).normalize();
        const turns: Record<string, () => void> = {
            ArrowLeft: () => offset.applyAxisAngle(new Vector3(0, 1, 0), -step),
            ArrowRight: () => offset.applyAxisAngle(new Vector3(0, 1, 0), step),
            ArrowUp: () => offset.applyAxisAngle(horizontal, -step),
            ArrowDown: () => offset.applyAxisAngle(horizontal, step),
            "+": () => offset.multiplyScalar(1 / 1.1),
            "=": () => offset.multiplyScalar(1 / 1.1),
            "-": () => offset.multiplyScalar(1.1),
        };
        const turn = turns[event.key];
        if (turn && !event.ctrlKey && !event.metaKey && !event.altKey) {
            event.preventDefault();
            turn();
            this.direction = null;
            this.camera.position.copy(this.orbit.target).add(offset);
            this.orbit.update();
            this.ask_frame();
        }
    }
}
