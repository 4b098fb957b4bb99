// SPDX-License-Identifier: MIT
// Paths of the 3-D view and stems of the echogram choose each other, by pointer and by keyboard.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { rooms_report } from "../fixture/report.mjs";
import { launch, open, screenshot } from "./browser.mjs";

let browser;
before(async () => {
    browser = await launch();
});
after(() => browser.close());

test("a click on a stem chooses its path, the 3-D view and the text follow", async () => {
    const data = rooms_report();
    const { page, complaints } = await open(browser, "choices", data);
    const before_choice = await page.locator(".view canvas").screenshot();
    const stem = page.locator('.stem[data-path="5"] circle');
    await stem.click();
    assert.match(await page.locator('.stem[data-path="5"]').getAttribute("class"), /chosen/);
    const path = data.pairs[0].paths[5];
    assert.ok((await page.locator(".path-detail").textContent()).includes(`${(1000 * path.delay).toFixed(1)} ms`));
    assert.equal(await page.locator('[role="status"]').textContent(), await page.locator(".path-detail").textContent());
    const after_choice = await page.locator(".view canvas").screenshot();
    assert.notDeepEqual(after_choice, before_choice);
    await screenshot(page, "chosen_path", "#scene");
    assert.deepEqual(complaints, []);
    await page.context().close();
});

test("a click on a path in the 3-D view chooses its stem", async () => {
    // The direct sound alone: the line between the labels of its ends is where to click.
    const data = rooms_report({ max_order: 0 });
    const { page } = await open(browser, "direct", data);
    await page.locator(".view canvas").scrollIntoViewIfNeeded();
    const place = async (selector) => {
        const label = page.locator(selector);
        const view = await page.locator(".view").boundingBox();
        const [left, top] = await label.evaluate((e) => [parseFloat(e.style.left), parseFloat(e.style.top)]);
        return [view.x + (view.width * left) / 100, view.y + (view.height * top) / 100];
    };
    const [x0, y0] = await place(".label.source");
    const [x1, y1] = await place(".label.listener.chosen");
    await page.mouse.click((x0 + x1) / 2, (y0 + y1) / 2);
    assert.match(await page.locator('.stem[data-path="0"]').getAttribute("class"), /chosen/);
    assert.match(await page.locator(".path-detail").textContent(), /direct sound/);
    await page.mouse.click(x0 - 200, y0 - 100);
    assert.equal(await page.locator(".stem.chosen").count(), 0);
    await page.context().close();
});

test("the keyboard reaches every path and turns the view", async () => {
    const data = rooms_report();
    const { page } = await open(browser, "keyboard", data);
    await page.getByLabel("Path, by delay").focus();
    await page.keyboard.press("Home");
    await page.keyboard.press("ArrowRight");
    assert.match(await page.locator(".stem.chosen").getAttribute("data-path"), /^1$/);
    await page.keyboard.press("End");
    assert.equal(await page.locator(".stem.chosen").getAttribute("data-path"), String(data.pairs[0].paths.length - 1));
    const left = () => page.locator(".label.source").evaluate((e) => e.style.left);
    const start = await left();
    await page.locator(".view canvas").focus();
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction((old) => document.querySelector(".label.source").style.left !== old, start);
    await page.context().close();
});

test("time moves the wave front, and a choice of pair reaches every section", async () => {
    const data = rooms_report();
    const { page } = await open(browser, "time", data);
    const whole = await page.locator(".view canvas").screenshot();
    await page.getByLabel("Time after emission").fill("400");
    const last = Math.max(...data.pairs[0].paths.map((p) => p.delay));
    assert.equal(await page.locator("#scene .time output").textContent(), `${(400 * last).toFixed(1)}\u00a0ms`);
    assert.notDeepEqual(await page.locator(".view canvas").screenshot(), whole);
    await screenshot(page, "wave_front", "#scene");
    await page.locator("#overview button").nth(2).click();
    assert.equal(await page.getByLabel("Pair", { exact: true }).inputValue(), "2");
    assert.match(await page.locator("table.metrics caption").textContent(), /back right/);
    assert.match(await page.locator("table.sensitivity caption").textContent(), /back right/);
    assert.equal(await page.locator(".stem").count(), data.pairs[2].paths.length);
    await page.context().close();
});
