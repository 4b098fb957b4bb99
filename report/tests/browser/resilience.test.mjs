// SPDX-License-Identifier: MIT
// Hostile names stay text, and a browser without WebGL still tells everything.
import assert from "node:assert/strict";
import { test } from "node:test";
import { contacts_report, rooms_report } from "../fixture/report.mjs";
import { launch, open, screenshot } from "./browser.mjs";

const hostile = [
    "<script>window.hit = 1</script>", "</script><script>window.hit = 2</script>", "<img src=x onerror=\"window.hit = 3\">",
    "\"quotes' & &lt; entities", "line\u2028and\u2029paragraph", "]]><!-- comment", "a".repeat(200),
];

test("hostile names are shown as text", async () => {
    const browser = await launch();
    const data = rooms_report({
        names: {
            title: hostile[1], source: hostile[0], listeners: [hostile[2], hostile[3], hostile[4]], materials: hostile.slice(0, 5),
            command: hostile[0], file: hostile[5], warning: hostile[1],
        },
    });
    const { page, complaints } = await open(browser, "hostile", data);
    assert.equal(await page.locator("h1").textContent(), hostile[1]);
    const text = await page.locator("#report").textContent();
    for (const name of hostile.slice(0, 6)) {
        assert.ok(text.includes(name), name);
    }
    await page.locator('.stem[data-path="3"] circle').click();
    assert.equal(await page.evaluate(() => window.hit), undefined);
    assert.equal(await page.locator("#report script, #report img[src=x]").count(), 0);
    const contacts = await open(browser, "hostile_contacts", contacts_report({ names: { meshes: [hostile[0], hostile[2]], title: hostile[6] } }));
    assert.ok((await contacts.page.locator("#report").textContent()).includes(hostile[2]));
    assert.equal(await contacts.page.evaluate(() => window.hit), undefined);
    assert.deepEqual([...complaints, ...contacts.complaints], []);
    await browser.close();
});

test("without WebGL one message stands in place of the view, and the rest is complete", async () => {
    const browser = await launch(["--disable-3d-apis"]);
    const { page, complaints } = await open(browser, "without_webgl", rooms_report());
    assert.match(await page.locator("#scene .plain-message").textContent(), /no 3-D view/);
    assert.equal(await page.locator("#scene canvas").count(), 0);
    assert.equal(await page.locator("#decay canvas").count(), 1);
    assert.ok((await page.locator("#maps rect").count()) > 100);
    await page.locator('.stem[data-path="2"] circle').click();
    assert.equal(await page.locator(".stem.chosen").count(), 1);
    await screenshot(page, "without_webgl");
    assert.deepEqual(complaints.filter((text) => !/WebGL/.test(text)), []);
    await browser.close();
});
