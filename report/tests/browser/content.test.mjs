// SPDX-License-Identifier: MIT
// What the page shows is what its data says, and nothing leaves the page.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, statSync } from "node:fs";
import { after, before, test } from "node:test";
import { contacts_report, rooms_report } from "../fixture/report.mjs";
import { launch, open, screenshot } from "./browser.mjs";

const max_page_bytes = 3_000_000;
let browser;
before(async () => {
    browser = await launch();
});
after(() => browser.close());

test("opens without complaints, requests or a size above the bound", async () => {
    const { page, complaints, file } = await open(browser, "rooms", rooms_report());
    assert.equal(await page.title(), "Box classroom \u2013 sound report");
    assert.deepEqual(await page.locator("h2").allTextContents(), [
        "Verdict", "All pairs", "Room", "Map", "Echogram", "Decay", "Late energy", "Over frequency", "Metrics", "Which surface matters",
        "Listening", "Provenance",
    ]);
    await screenshot(page, "rooms");
    assert.deepEqual(complaints, []);
    assert.ok(statSync(file).size < max_page_bytes);
    await page.context().close();
});

test("the policy allows nothing but the page's own script and style, by their hashes", async () => {
    const { page, file } = await open(browser, "policy", rooms_report());
    const text = readFileSync(file, "utf8");
    const policy = /Content-Security-Policy" content="([^"]*)"/.exec(text)[1];
    const hash = (part) => `'sha256-${createHash("sha256").update(part).digest("base64")}'`;
    assert.ok(policy.startsWith("default-src 'none';"));
    assert.ok(policy.includes(`script-src ${hash(/<script>(.*?)<\/script>/s.exec(text)[1])};`));
    assert.ok(policy.includes(`style-src ${hash(/<style>(.*?)<\/style>/s.exec(text)[1])};`));
    assert.ok(!policy.includes("unsafe"));
    assert.doesNotMatch(text.split("<script>")[0], /<[a-z][^>]*\son[a-z]+=/i);
    // Foreign script and requests are refused by the browser.
    const outcome = await page.evaluate(async () => {
        const script = document.createElement("script");
        script.textContent = "window.foreign = true";
        document.body.append(script);
        const request = await fetch("http://127.0.0.1:9/").then(() => "sent", () => "refused");
        return [window.foreign === undefined, request];
    });
    assert.deepEqual(outcome, [true, "refused"]);
    await page.context().close();
});

test("the table of metrics shows the values and standard errors of the data", async () => {
    const data = rooms_report({ with_reference: false });
    const { page } = await open(browser, "metrics", data);
    const metrics = data.pairs[1].metrics;
    await page.getByLabel("Pair", { exact: true }).selectOption("1");
    const row = async (key) => (await page.locator(`table.metrics tr[data-metric="${key}"] .value`).allTextContents())
        .map((text) => Number(text.replace("\u2212", "-")));
    const expected = (list, digits) => list.filter((x) => x !== null).map((x) => Number(x.toFixed(digits)));
    for (const [key, digits, scale] of [["edt", 2, 1], ["t20", 2, 1], ["c50", 1, 1], ["c80", 1, 1], ["d50", 2, 1], ["ts", 0, 1000], ["g", 1, 1]]) {
        const list = [metrics.single[`${key}_mid`], ...metrics[key]].map((x) => x * scale);
        assert.deepEqual(await row(key), expected(list, digits), key);
    }
    assert.deepEqual(await row("t30"), expected(metrics.t30, 2));
    assert.deepEqual(await row("sti"), expected([metrics.sti], 2));
    assert.deepEqual(await page.locator("table.metrics tr[data-metric=edt] .error").first().textContent(), "\u00b1\u00a00.008");
    // A withheld value leads to its reason.
    await page.locator('table.metrics tr[data-metric="t30"] .reason-mark').last().click();
    const target = page.locator(":target");
    assert.equal(await target.textContent(), metrics.notes[0].text);
    await page.context().close();
});

test("cells are coloured by their distance from the reference in just-noticeable differences", async () => {
    const data = rooms_report();
    const { page } = await open(browser, "differences", data);
    const { metrics, reference } = data.pairs[0];
    const cells = page.locator('table.metrics tr[data-metric="c80"] td');
    for (let band = 0; band < data.bands.length; ++band) {
        const difference = metrics.c80[band] - reference.c80[band];
        const step = Math.min(Math.floor(Math.abs(difference)), 3);
        const name = await cells.nth(band + 1).getAttribute("class");
        assert.equal(name, step === 0 ? "jnd-same" : `jnd-${difference > 0 ? "above" : "below"}-${step}`);
    }
    await page.getByLabel("Compare with").selectOption("none");
    assert.equal(await page.locator("table.metrics .difference").count(), 0);
    await page.context().close();
});

test("a page of contacts shows the contacts of the chosen time", async () => {
    const { page, complaints } = await open(browser, "contacts", contacts_report());
    const slider = page.getByLabel("Time", { exact: true });
    await slider.fill("4");
    assert.equal(await page.locator("#contacts tbody tr").filter({ hasText: "vertex face" }).count(), 4);
    await screenshot(page, "contacts");
    await slider.fill("1");
    assert.equal(await page.locator("#contacts tbody tr").filter({ hasText: "vertex face" }).count(), 0);
    assert.deepEqual(complaints, []);
    await page.context().close();
});

test("a page of a map alone shows its plan, with what each cell is", async () => {
    const { format, title, provenance, scene, materials, sources, maps, room, bands } = rooms_report();
    const data = { format, kind: "map", title, provenance, scene, materials, sources, maps, room, bands };
    const { page, complaints } = await open(browser, "map", data);
    assert.equal(await page.locator("#maps rect").count(), maps[0].cells.length);
    assert.match(await page.locator("#maps rect title").first().textContent(), new RegExp(maps[0].cells[0][4].toFixed(2)));
    assert.match(await page.locator("#maps").textContent(), new RegExp(`met on ${(100 * maps[0].share).toFixed(0)}`));
    await page.locator("#scene").getByLabel("Map", { exact: true }).selectOption("0");
    await screenshot(page, "map");
    assert.deepEqual(complaints, []);
    await page.context().close();
});

test("a page of the four members that are always there opens", async () => {
    const { page, complaints } = await open(browser, "least", { format: 1, kind: "rooms", title: "least", provenance: {} });
    assert.deepEqual(await page.locator("h2").allTextContents(), ["Verdict", "Provenance"]);
    assert.deepEqual(complaints, []);
    await page.context().close();
});
