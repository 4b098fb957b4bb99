// SPDX-License-Identifier: MIT
// Measures, but does not judge, first paint and turning: 60 paths and 10,000 triangles by software
// rendering in a window of 1280 x 720.
import assert from "node:assert/strict";
import { test } from "node:test";
import { rooms_report } from "../fixture/report.mjs";
import { launch, open } from "./browser.mjs";

const frames = 40;

test("first paint and turning are measured", async () => {
    const browser = await launch();
    const data = rooms_report({ wall_pieces: 29, max_order: 4 });
    const triangles = Buffer.from(data.scene.triangles_u32, "base64").length / 12;
    const { page } = await open(browser, "speed", data);
    await page.getByLabel("Strongest paths shown").fill("60");
    const first_paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
    const times = await page.evaluate(async (count) => {
        const canvas = document.querySelector(".view canvas");
        canvas.scrollIntoView({ block: "center" });
        const send = (type, x) => canvas.dispatchEvent(new PointerEvent(type, {
            pointerId: 1, pointerType: "mouse", button: 0, buttons: 1, clientX: x, clientY: 300, bubbles: true, isPrimary: true,
        }));
        canvas.setPointerCapture = () => {};
        canvas.releasePointerCapture = () => {};
        send("pointerdown", 400);
        const durations = [];
        let last = await new Promise(requestAnimationFrame);
        for (let i = 0; i < count; ++i) {
            send("pointermove", 400 + 3 * i);
            const now = await new Promise(requestAnimationFrame);
            durations.push(now - last);
            last = now;
        }
        send("pointerup", 400);
        return durations;
    }, frames);
    times.sort((a, b) => a - b);
    const shown = Number(await page.getByLabel("Strongest paths shown").inputValue());
    console.log(`first paint ${first_paint.toFixed(0)} ms; ${triangles} triangles, ${shown} paths: ` +
        `median frame ${times[frames / 2].toFixed(1)} ms, slowest ${times[frames - 1].toFixed(1)} ms`);
    assert.ok(triangles > 10_000);
    assert.equal(shown, 60);
    await browser.close();
});
