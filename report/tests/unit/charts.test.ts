// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import { test } from "node:test";
import { tick_digits, tick_step, ticks } from "../../src/charts/ticks";
import { contacts_at, frame_at } from "../../src/contacts/contact_frames";
import { map_cells, map_scale } from "../../src/maps/map_values";
import { strongest_paths } from "../../src/report";
import { closest_stem } from "../../src/sections/closest_stem";
import { extended_values, fit_time, line_values } from "../../src/sections/decay_fits";
import { error_levels } from "../../src/sections/error_levels";
import { material_rows } from "../../src/sections/material_rows";
import { State } from "../../src/state";

test("ticks stand at 1, 2 or 5 times a power of ten", () => {
    assert.equal(tick_step(100, 8), 20);
    assert.deepEqual(ticks(-61, -2, 7), [-60, -50, -40, -30, -20, -10]);
    assert.deepEqual(ticks(0, 0.3, 4).map((t) => t.toFixed(tick_digits(tick_step(0.3, 4)))), ["0.0", "0.1", "0.2", "0.3"]);
    assert.deepEqual(ticks(3, 3, 4), [3]);
});

test("a click means the closest tip, or the stem below it", () => {
    const stems = [{ index: 4, x: 100, y: 50 }, { index: 7, x: 110, y: 150 }];
    assert.equal(closest_stem(stems, 103, 52), 4);
    assert.equal(closest_stem(stems, 101, 200), 4);
    assert.equal(closest_stem(stems, 109, 200), 7);
    assert.equal(closest_stem(stems, 300, 50), null);
});

test("a fitted line tells its reverberation time and ends where the fit ends", () => {
    const fit = { from: 0.1, to: 0.3, level_from: -5, level_to: -25 };
    assert.ok(Math.abs(fit_time(fit) - 0.6) < 1e-12);
    assert.deepEqual(line_values(fit, [0, 0.1, 0.2, 0.3, 0.4]).map((v) => v === null ? null : Math.round(v)), [null, -5, -15, -25, null]);
    assert.deepEqual(extended_values(fit, [0, 0.1, 0.4, 0.7], -60).map((v) => v === null ? null : Math.round(v)), [5, -5, -35, null]);
});

test("bands of standard errors are those of the energy, not of the level", () => {
    assert.deepEqual(error_levels([-10, null], [1, 0.5], 1), [-10 + 10 * Math.log10(2), null]);
    assert.deepEqual(error_levels([-10], [0.6], -2), [null]);
});

test("a map's scale has steps of one just-noticeable difference that a limit divides", () => {
    const scale = map_scale({ metric: "sti", jnd: 0.03, limit: 0.6, values: [0.55, 0.7, null] });
    assert.ok(Math.abs(scale.from - 0.54) < 1e-9 && Math.abs(scale.to - 0.72) < 1e-9);
    assert.notEqual(scale.share(0.599), scale.share(0.6));
    assert.equal(scale.share(0.601), scale.share(0.629));
    assert.equal(map_scale({ metric: "t30", values: [1, 1] }).share(1), 0.5);
    const relative = map_scale({ metric: "t30", jnd: 0.05, jnd_is_relative: true, values: [0.9, 1.1] });
    assert.ok(Math.abs(relative.step - 0.05) < 1e-12);
    const wide = map_scale({ metric: "c80", jnd: 1, limit: null, values: [0, 40] });
    assert.equal(wide.step, 3);
});

test("cells of a map lie in its plane", () => {
    const [cell] = map_cells({ metric: "sti", plane: { origin: [1, 2, 3], u: [0, 0, 1], v: [1, 0, 0] }, cells: [[0, 0, 2, 1, 0.5]] });
    assert.deepEqual(cell!.corners, [[1, 2, 3], [1, 2, 5], [2, 2, 5], [2, 2, 3]]);
});

test("the strongest paths of a band come first, hidden orders are left out", () => {
    const path = (order: number, pressure: number[]): Parameters<typeof strongest_paths>[0][number] =>
        ({ order, length: 1, delay: 1, points: [], pressure });
    const paths = [path(0, [0.1, 0.5]), path(1, [-0.4, 0.1]), path(2, [0.2, 0])];
    assert.deepEqual(strongest_paths(paths, 0, new Set(), 2), [1, 2]);
    assert.deepEqual(strongest_paths(paths, 1, new Set(), 9), [0, 1]);
    assert.deepEqual(strongest_paths(paths, 0, new Set([1]), 9), [2, 0]);
});

test("materials are sorted by their late energy, derivatives told for 0.1 of absorption", () => {
    const rows = material_rows({
        source: 0, listener: 0,
        energy: [{ name: "a", before_80ms: [0.5], after_80ms: [0.1] }, { name: "b", before_80ms: [0.2], after_80ms: [0.6] }],
        derivatives: { t30: [[-1], [null]], sti: [[0.1, 0.2], null] },
    }, ["a", "b"], 0);
    assert.deepEqual(rows.map((r) => r.name), ["b", "a"]);
    assert.equal(rows[1]!.t30, -0.1);
    assert.ok(Math.abs(rows[1]!.sti! - 0.03) < 1e-12);
    assert.equal(rows[0]!.t30, null);
    assert.equal(rows[0]!.sti, null);
});

test("poses and contacts belong to the interval that ends at a time", () => {
    const frames = [{ time: 0 }, { time: 0.1 }, { time: 0.2 }];
    assert.equal(frame_at(frames, 0.15), 1);
    assert.equal(frame_at(frames, 9), 2);
    const contacts = [{ time: 0 }, { time: 0.05 }, { time: 0.1 }];
    assert.deepEqual(contacts_at(contacts, [0, 0.1], 1).map((c) => c.time), [0.05, 0.1]);
    assert.deepEqual(contacts_at(contacts, [0, 0.1], 0).map((c) => c.time), [0]);
});

test("choices reach those who show them, and a path is let go with its pair", () => {
    const state = new State({
        pair: 0, band: 0, metric: "sti", path: 3, hidden_orders: new Set(), max_paths: 9, time: null, reference: "none",
    });
    const heard: string[] = [];
    state.subscribe(["path"], () => heard.push("path"));
    state.subscribe(["band"], () => heard.push("band"));
    state.set({ band: 0 });
    assert.deepEqual(heard, []);
    state.set({ pair: 1 });
    assert.equal(state.now.path, null);
    assert.deepEqual(heard, ["path"]);
});
