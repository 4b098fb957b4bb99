// SPDX-License-Identifier: MIT
// Meshes in their poses with the contacts of a time as dots with normals.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, Points, PointsMaterial } from "three";
import { css, order_color } from "../colors";
import type { Contact, ContactData, Vector } from "../data/schema";
import { decode_f32, decode_u32 } from "../data/decode";
import { extent_of } from "../scene/decoded_scene";
import { Viewer } from "../scene/viewer";
import { printed_picture } from "../scene/printed_picture";
import { on_scheme_change, scheme, style_color } from "../theme";
import { contacts_at, frame_at } from "./contact_frames";

const dot_pixels = 9;

interface MovingMesh {
    mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
    frames: { time: number; positions: Float32Array }[];
}

function decode_frames(data: ContactData): Float32Array[][] {
    return (data.meshes ?? []).map((mesh) => mesh.frames.map((frame) => decode_f32(frame.positions_f32)));
}

export class ContactView {
    readonly viewer: Viewer;
    private readonly meshes: MovingMesh[];
    private readonly dots = new Points(new BufferGeometry(), new PointsMaterial({ size: dot_pixels, sizeAttenuation: false, depthTest: false }));
    private readonly normals = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ depthTest: false }));
    private readonly normal_length: number;

    constructor(title: string, private readonly data: ContactData) {
        const frames = decode_frames(data);
        const extents = frames.flat().filter((p) => p.length > 0).map(extent_of);
        const min = [0, 1, 2].map((a) => Math.min(...extents.map((e) => e.min[a]!))) as Vector;
        const max = [0, 1, 2].map((a) => Math.max(...extents.map((e) => e.max[a]!))) as Vector;
        if (!min.every(Number.isFinite) || !max.every(Number.isFinite)) {
            throw new Error("no meshes");
        }
        this.normal_length = Math.hypot(...max.map((x, i) => x - min[i]!)) / 20;
        this.viewer = new Viewer(`Meshes of ${title} with their contacts`, min, max);
        this.viewer.element.append(printed_picture(this.viewer));
        this.meshes = (data.meshes ?? []).map((mesh, i) => {
            const geometry = new BufferGeometry();
            geometry.setIndex(new BufferAttribute(decode_u32(mesh.triangles_u32), 1));
            const material = new MeshLambertMaterial({ side: DoubleSide, flatShading: true });
            const object = new Mesh(geometry, material);
            object.frustumCulled = false;
            this.viewer.scene.add(object);
            return { mesh: object, frames: mesh.frames.map((f, k) => ({ time: f.time, positions: frames[i]![k]! })) };
        });
        this.dots.renderOrder = 2;
        this.normals.renderOrder = 1;
        this.dots.frustumCulled = false;
        this.normals.frustumCulled = false;
        this.viewer.scene.add(this.dots, this.normals);
        this.color();
        on_scheme_change(() => this.color());
    }

    show(step: number): void {
        const times = this.data.times ?? [];
        const time = times[step] ?? 0;
        for (const { mesh, frames } of this.meshes) {
            const frame = frames[frame_at(frames, time)];
            if (frame) {
                mesh.geometry.setAttribute("position", new BufferAttribute(frame.positions, 3));
            }
        }
        this.show_contacts(contacts_at(this.data.contacts ?? [], times, step));
        this.viewer.ask_frame();
    }

    private show_contacts(contacts: Contact[]): void {
        const points: number[] = [];
        const lines: number[] = [];
        for (const { point, normal } of contacts) {
            if (point) {
                points.push(...point);
                if (normal) {
                    lines.push(...point, ...point.map((x, k) => x + this.normal_length * normal[k]!));
                }
            }
        }
        const geometry = (values: number[]): BufferGeometry => {
            const made = new BufferGeometry();
            made.setAttribute("position", new BufferAttribute(new Float32Array(values), 3));
            return made;
        };
        this.dots.geometry.dispose();
        this.dots.geometry = geometry(points);
        this.dots.visible = points.length > 0;
        this.normals.geometry.dispose();
        this.normals.geometry = geometry(lines);
        this.normals.visible = lines.length > 0;
    }

    private color(): void {
        this.meshes.forEach(({ mesh }, i) => mesh.material.color.set(css(order_color(i === 0 ? 6 : ((i - 1) % 5) + 1, scheme()))));
        const contact = new Color(style_color("--source"));
        this.dots.material.color = contact;
        this.normals.material.color = contact;
        this.viewer.ask_frame();
    }
}
