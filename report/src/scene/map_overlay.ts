// SPDX-License-Identifier: MIT
// A map of a metric as coloured cells in the 3-D view.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial } from "three";
import { css, metric_color } from "../colors";
import type { MetricMap } from "../data/schema";
import { select } from "../dom";
import { map_cells, map_name, map_scale } from "../maps/map_values";
import { on_scheme_change } from "../theme";
import type { Viewer } from "./viewer";

function cell_geometry(map: MetricMap): BufferGeometry {
    const scale = map_scale(map);
    const positions: number[] = [];
    const colors: number[] = [];
    for (const { corners, value } of map_cells(map)) {
        if (value === null) {
            continue;
        }
        const color = new Color(css(metric_color(scale.share(value))));
        for (const k of [0, 1, 2, 0, 2, 3]) {
            positions.push(...corners[k]!);
            colors.push(color.r, color.g, color.b);
        }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
    return geometry;
}

export class MapOverlay {
    private readonly mesh: Mesh<BufferGeometry, MeshBasicMaterial>;

    constructor(private readonly viewer: Viewer, private readonly maps: MetricMap[]) {
        this.mesh = new Mesh(new BufferGeometry(), new MeshBasicMaterial({
            vertexColors: true, side: DoubleSide, transparent: true, opacity: 0.85,
        }));
        this.mesh.visible = false;
        viewer.scene.add(this.mesh);
        on_scheme_change(() => viewer.ask_frame());
    }

    control(): HTMLElement {
        const choices = [{ value: "none", text: "none" }, ...this.maps.map((map, i) => ({ value: String(i), text: map_name(map) }))];
        return select("Map", choices, "none", (value) => {
            const map = this.maps[Number(value)];
            this.mesh.visible = map !== undefined;
            if (map) {
                this.mesh.geometry.dispose();
                this.mesh.geometry = cell_geometry(map);
            }
            this.viewer.ask_frame();
        }).field;
    }
}
