// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import { test } from "node:test";
import { decode_f32, decode_u16, decode_u32 } from "../../src/data/decode";
import { parse_report } from "../../src/data/report_data";
import { band, decibels, error, number, signed } from "../../src/format";

test("arrays are little-endian, whatever the length of their base64", () => {
    assert.deepEqual([...decode_f32(Buffer.from([0, 0, 128, 63, 0, 0, 0, 192]).toString("base64"))], [1, -2]);
    assert.deepEqual([...decode_u32(Buffer.from([1, 2, 0, 0, 255, 255, 255, 255]).toString("base64"))], [513, 4294967295]);
    assert.deepEqual([...decode_u16(Buffer.from([1, 2, 255, 0, 7, 0]).toString("base64"))], [513, 255, 7]);
    assert.equal(decode_f32("").length, 0);
});

test("data of another format is refused with one line", () => {
    assert.throws(() => parse_report("@EARSHOT_REPORT_DATA@"), /holds no data/);
    assert.throws(() => parse_report("{\"format\": 2}"), /format other than 1/);
    assert.throws(() => parse_report("null"), /format/);
    assert.equal(parse_report("{\"format\": 1, \"title\": \"x\"}").title, "x");
});

test("numbers have typographic signs, and a dash where they are missing", () => {
    assert.equal(number(-1.25, 1), "\u22121.3");
    assert.equal(number(-0.001, 2), "0.00");
    assert.equal(number(null, 2), "\u2013");
    assert.equal(number(NaN, 2), "\u2013");
    assert.equal(signed(0.5, 1), "+0.5");
    assert.equal(signed(0.001, 1), "0.0");
    assert.equal(decibels(null), "\u2013");
    assert.equal(band(31.5), "31.5\u00a0Hz");
    assert.equal(band(16000), "16\u00a0kHz");
});

test("standard errors show one digit more where a table's digits hide them", () => {
    assert.equal(error(0.0034, 2), "0.003");
    assert.equal(error(0.12, 1), "0.12");
    assert.equal(error(1.2, 0), "1.2");
});
