// SPDX-License-Identifier: MIT
// axe-core finds nothing serious in both schemes of colours; paper gets everything.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { contacts_report, rooms_report } from "../fixture/report.mjs";
import { artefacts, launch, open, screenshot } from "./browser.mjs";

const axe_source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
let browser;
before(async () => {
    browser = await launch();
});
after(() => browser.close());

async function serious_findings(page) {
    await page.evaluate(axe_source);
    const { violations } = await page.evaluate(() => window.axe.run(document));
    return violations.filter((v) => ["serious", "critical"].includes(v.impact))
        .map((v) => `${v.id}: ${v.help}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 200)).join(" | ")}`);
}

for (const colorScheme of ["light", "dark"]) {
    test(`axe finds nothing serious (${colorScheme})`, async () => {
        const { page, complaints } = await open(browser, `axe_${colorScheme}`, rooms_report(), { colorScheme });
        await page.locator('.stem[data-path="2"] circle').click();
        await page.locator(".notices summary").click();
        assert.deepEqual(await serious_findings(page), []);
        await screenshot(page, `rooms_${colorScheme}`);
        assert.deepEqual(complaints, []);
        await page.context().close();
    });
}

test("axe finds nothing serious in a page of contacts", async () => {
    const { page } = await open(browser, "axe_contacts", contacts_report());
    assert.deepEqual(await serious_findings(page), []);
    await page.context().close();
});

test("prints to a PDF with the picture of the room, also from a dark screen", async () => {
    const { page } = await open(browser, "print", rooms_report(), { colorScheme: "dark" });
    const path = join(artefacts, "rooms.pdf");
    await page.pdf({ path, format: "A4", printBackground: true, margin: { top: "12mm", bottom: "12mm", left: "12mm", right: "12mm" } });
    const text = readFileSync(path, "latin1");
    assert.ok(text.startsWith("%PDF"));
    assert.ok(statSync(path).size > 50_000);
    assert.ok((text.match(/\/Type\s*\/Page\b/g) ?? []).length >= 3);
    assert.ok(text.includes("/Subtype /Image"));
    await page.context().close();
});
