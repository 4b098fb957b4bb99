// SPDX-License-Identifier: MIT
// Pages that the program makes of a scene, EARSHOT_PROGRAM, opened in the browser.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { artefacts, launch, open_file, screenshot } from "./browser.mjs";

const program = process.env.EARSHOT_PROGRAM;
const scenes = fileURLToPath(new URL("../../../scenes/", import.meta.url));

/** Why no pages of the program can be tested; false if they can. */
export const missing = program ? false : "EARSHOT_PROGRAM names no program";

/** Runs earshot ir --report and opens its page: everything is there, and the browser has nothing to complain about. */
export async function check_page(test, name, options, max_bytes) {
    const folder = join(artefacts, name);
    const run = spawnSync(program, ["ir", `${scenes}${name}.gltf`, "--report", "-o", folder, "--quiet", ...options], { encoding: "utf8" });
    if (run.status !== 0 && run.stderr.includes("report/bundle")) {
        test.skip("the program was built without the page");
        return;
    }
    assert.equal(run.status, 0, run.stderr);
    const file = join(folder, "report.html");
    assert.ok(statSync(file).size < max_bytes);
    const browser = await launch();
    const { page, complaints } = await open_file(browser, file);
    await page.locator(".view-place[data-ready]").waitFor();
    const first_paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
    console.log(`${name}: ${(statSync(file).size / 1e6).toFixed(1)} MB, first paint ${first_paint.toFixed(0)} ms`);

    const sections = await page.locator("h2").allTextContents();
    for (const section of ["Verdict", "All pairs", "Room", "Echogram", "Decay", "Late energy", "Metrics", "Which surface matters", "Provenance"]) {
        assert.ok(sections.includes(section), section);
    }
    const { pairs } = JSON.parse(readFileSync(join(folder, "metrics.json"), "utf8"));
    assert.equal(await page.locator("#overview tbody tr").count(), pairs.length);
    // The first path in 3-D and in the echogram are one.
    await page.locator(".stem circle").first().click();
    await page.locator("#scene canvas").scrollIntoViewIfNeeded();
    await screenshot(page, name);
    assert.deepEqual(complaints, []);
    await browser.close();
}
