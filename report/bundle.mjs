// SPDX-License-Identifier: MIT
// Bundles src/main.ts and styles/ with page.html into dist/page.html, one file without addresses.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const folder = dirname(fileURLToPath(import.meta.url));
const data_marker = "@EARSHOT_REPORT_DATA@";
const bundled_packages = ["three", "uplot"];

async function bundle(entry) {
    const result = await build({
        entryPoints: [join(folder, entry)],
        absWorkingDir: folder,
        bundle: true,
        minify: true,
        write: false,
        format: "iife",
        target: ["es2022"],
        charset: "ascii",
        legalComments: "none",
        logLevel: "warning",
    });
    return result.outputFiles[0].text.trim();
}

/** The licences of the bundled packages; they must stand in every copy of the page. */
function notices() {
    return bundled_packages.map((name) => {
        const package_folder = join(folder, "node_modules", name);
        const { version } = JSON.parse(readFileSync(join(package_folder, "package.json"), "utf8"));
        const licence = readFileSync(join(package_folder, "LICENSE"), "utf8").trim();
        return `${name} ${version}\n\n${licence}`;
    }).join("\n\n\n");
}

const escape_html = (text) =>
    text.replace(/[&<>]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[c]);

const hash = (text) => `'sha256-${createHash("sha256").update(text, "utf8").digest("base64")}'`;

/** Replaces a marker that must stand exactly once in the text; the value is taken literally. */
function replace_once(text, marker, value) {
    const parts = text.split(marker);
    if (parts.length !== 2) {
        throw new Error(`${marker} stands ${parts.length - 1} times in the page`);
    }
    return parts[0] + value + parts[1];
}

const script = await bundle("src/main.ts");
const style = await bundle("styles/page.css");
for (const [text, forbidden] of [[script, /<\/script|<!--/i], [style, /<\/style|url\(/i]]) {
    if (forbidden.test(text)) {
        throw new Error(`the bundle holds ${forbidden}, which ends its element early`);
    }
}
const policy = [
    "default-src 'none'",
    `script-src ${hash(script)}`,
    `style-src ${hash(style)}`,
    "img-src data:",
    "media-src data:",
    "base-uri 'none'",
    "form-action 'none'",
].join("; ");

let page = readFileSync(join(folder, "page.html"), "utf8");
page = replace_once(page, "@POLICY@", policy);
page = replace_once(page, "@STYLE@", style);
page = replace_once(page, "@NOTICES@", escape_html(notices()));
page = replace_once(page, "@SCRIPT@", script);
replace_once(page, data_marker, "");

// The file keeps its time if its bytes do not change, so that the build embeds it once.
const target = join(folder, "dist", "page.html");
mkdirSync(dirname(target), { recursive: true });
let previous = "";
try {
    previous = readFileSync(target, "utf8");
} catch {
    // There is no bundle yet.
}
if (page !== previous) {
    writeFileSync(target, page);
}
console.log(`report/dist/page.html: ${Buffer.byteLength(page)} bytes`);
