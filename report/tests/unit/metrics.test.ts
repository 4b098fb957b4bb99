// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import { test } from "node:test";
import type { PairMetrics } from "../../src/data/schema";
import { find_metric } from "../../src/metrics/definitions";
import { difference_in_jnd, jnd_class } from "../../src/metrics/difference";
import { error_of, reason_of, value_of } from "../../src/metrics/values";

const metrics: PairMetrics = {
    t30: [0.5, null], sti: 0.6, single: { t30_mid: 0.55 }, standard_error: { t30: [0.01, 0.02], sti: 0.004, single: { t30_mid: 0.008 } },
    notes: [
        { metric: "t30", band_hz: 1000, text: "of the band" }, { metric: "t30_mid", band_hz: null, text: "of the mean" },
        { metric: "all", band_hz: null, text: "of every metric" },
    ],
};
const bands = [500, 1000];
const t30 = find_metric("t30")!;
const sti = find_metric("sti")!;

test("values, errors and reasons are those of the band, the mean or the whole", () => {
    assert.equal(value_of(metrics, t30, 0), 0.5);
    assert.equal(value_of(metrics, t30, 1), null);
    assert.equal(value_of(metrics, t30, "mid"), 0.55);
    assert.equal(value_of(metrics, sti, 1), 0.6);
    assert.equal(error_of(metrics, t30, 1), 0.02);
    assert.equal(error_of(metrics, t30, "mid"), 0.008);
    assert.equal(reason_of(metrics, t30, 1, bands), "of the band");
    assert.equal(reason_of(metrics, t30, "mid", bands), "of the mean");
    assert.equal(reason_of(metrics, t30, 0, bands), "of every metric");
    assert.equal(value_of(undefined, t30, 0), null);
    assert.equal(reason_of({ t30: [null] }, t30, 0, bands), null);
});

test("differences count just-noticeable ones: 5 % of a time, 1 dB, 10 ms, 0.03 of STI", () => {
    const jnd = (key: string, value: number, reference: number): number => difference_in_jnd(find_metric(key)!, value, reference)!;
    assert.ok(Math.abs(jnd("t30", 1.1, 1) - 2) < 1e-9);
    assert.ok(Math.abs(jnd("c80", -1, 2) + 3) < 1e-9);
    assert.ok(Math.abs(jnd("ts", 0.07, 0.05) - 2) < 1e-9);
    assert.ok(Math.abs(jnd("sti", 0.63, 0.6) - 1) < 1e-9);
    assert.equal(difference_in_jnd(t30, null, 1), null);
    assert.equal(difference_in_jnd(t30, 1, 0), null);
    assert.equal(jnd_class(null), null);
    assert.equal(jnd_class(0.99), "jnd-same");
    assert.equal(jnd_class(-1), "jnd-below-1");
    assert.equal(jnd_class(17), "jnd-above-3");
});
