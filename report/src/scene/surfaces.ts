// SPDX-License-Identifier: MIT
// The room's surfaces, coloured by the absorption of the chosen band. Backs are see-through, so that
// walls between the camera and the room do not hide it.
import {
    BackSide, BufferAttribute, BufferGeometry, Color, EdgesGeometry, FrontSide, LineBasicMaterial, LineSegments, Mesh,
    MeshBasicMaterial, MeshLambertMaterial, Raycaster, Vector2,
} from "three";
import { absorption_color, css, material_less_color } from "../colors";
import type { Material } from "../data/schema";
import { scheme, style_color } from "../theme";
import type { DecodedScene } from "./decoded_scene";
import type { Viewer } from "./viewer";

const edge_angle_degrees = 25;

/** The upper end of the scale: at least 0.2, so that a hard room does not look soft. */
export function absorption_scale(materials: Material[], band: number): number {
    const greatest = Math.max(0, ...materials.map((m) => m.absorption?.[band] ?? 0));
    return Math.min(1, Math.max(0.2, Math.ceil(10 * greatest) / 10));
}

export class Surfaces {
    private readonly geometry = new BufferGeometry();
    private readonly front: Mesh;
    private readonly back: Mesh;
    private readonly edges: LineSegments<EdgesGeometry, LineBasicMaterial>;

    constructor(private readonly viewer: Viewer, private readonly scene: DecodedScene, private readonly materials: Material[]) {
        const count = scene.triangles.length;
        const corners = new Float32Array(3 * count);
        for (let i = 0; i < count; ++i) {
            corners.set(scene.positions.subarray(3 * scene.triangles[i]!, 3 * scene.triangles[i]! + 3), 3 * i);
        }
        this.geometry.setAttribute("position", new BufferAttribute(corners, 3));
        this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * count), 3));
        this.geometry.computeVertexNormals();
        this.front = new Mesh(this.geometry, new MeshLambertMaterial({
            vertexColors: true, side: FrontSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
        }));
        this.back = new Mesh(this.geometry, new MeshBasicMaterial({
            vertexColors: true, side: BackSide, transparent: true, opacity: 0.1, depthWrite: false,
        }));
        this.edges = new LineSegments(
            new EdgesGeometry(this.geometry, edge_angle_degrees),
            new LineBasicMaterial({ transparent: true, opacity: 0.35 }));
        viewer.scene.add(this.front, this.back, this.edges);
    }

    color_by_absorption(band: number): void {
        const colors = this.geometry.getAttribute("color") as BufferAttribute;
        const limit = absorption_scale(this.materials, band);
        const of_material = this.materials.map((m) => {
            const absorption = m.absorption?.[band];
            const rgb = typeof absorption === "number" ? absorption_color(absorption / limit, scheme()) : material_less_color(scheme());
            return new Color(css(rgb));
        });
        const other = new Color(css(material_less_color(scheme())));
        for (let t = 0; t < this.scene.triangles.length / 3; ++t) {
            const color = of_material[this.scene.material[t] ?? -1] ?? other;
            for (let k = 0; k < 3; ++k) {
                colors.setXYZ(3 * t + k, color.r, color.g, color.b);
            }
        }
        colors.needsUpdate = true;
        this.edges.material.color.set(style_color("--ink") || "#222222");
        this.viewer.ask_frame();
    }

    /** Shows walls between the camera and the room as they are. */
    set_walls_opaque(opaque: boolean): void {
        const material = this.back.material as MeshBasicMaterial;
        material.opacity = opaque ? 1 : 0.1;
        material.transparent = !opaque;
        material.depthWrite = opaque;
        material.needsUpdate = true;
        this.viewer.ask_frame();
    }

    /** Index of the material below a place of the canvas, in -1..1; null where there is none. */
    material_at(place: Vector2): number | null {
        const caster = new Raycaster();
        caster.setFromCamera(place, this.viewer.camera);
        const hit = caster.intersectObject(this.front, false)[0];
        return hit?.faceIndex === undefined || hit.faceIndex === null ? null : this.scene.material[hit.faceIndex] ?? null;
    }
}
