// SPDX-License-Identifier: MIT
// A headless Chromium that opens pages from files and keeps what it complains about.
import { chromium } from "playwright-core";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { page_of } from "../fixture/page.mjs";

export const artefacts = process.env.EARSHOT_ARTEFACTS ?? "dist/tests";
mkdirSync(artefacts, { recursive: true });

/** Rendering by the processor gives the same pictures on all machines. */
export async function launch(extra_arguments = []) {
    return chromium.launch({
        executablePath: process.env.EARSHOT_CHROMIUM ?? "/usr/bin/chromium",
        args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", ...extra_arguments],
        // Chromium's own sandbox does not run as root.
        chromiumSandbox: process.getuid?.() !== 0,
    });
}

/** Opens a page of made-up data, as open_file() does. */
export async function open(browser, name, data, options = {}) {
    const file = join(artefacts, `${name}.html`);
    writeFileSync(file, page_of(data));
    const opened = await open_file(browser, file, options);
    if (data.scene) {
        await opened.page.locator(".view-place[data-ready]").waitFor();
    }
    return opened;
}

/** Opens a page; `complaints` collects errors, warnings and requests that leave the file. */
export async function open_file(browser, file, options = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...options });
    const page = await context.newPage();
    page.setDefaultTimeout(60000);
    const complaints = [];
    const url = pathToFileURL(file).href;
    page.on("console", (message) => {
        if (["error", "warning"].includes(message.type())) {
            complaints.push(`${message.type()}: ${message.text()}`);
        }
    });
    page.on("pageerror", (error) => complaints.push(`exception: ${error.message}`));
    page.on("request", (request) => {
        if (request.url() !== url && !request.url().startsWith("data:")) {
            complaints.push(`request: ${request.url()}`);
        }
    });
    await page.goto(url);
    return { page, complaints, file };
}

export async function screenshot(page, name, selector) {
    const path = join(artefacts, `${name}.png`);
    if (selector) {
        await page.locator(selector).screenshot({ path });
    } else {
        await page.screenshot({ path, fullPage: true });
    }
}
