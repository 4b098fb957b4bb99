// SPDX-License-Identifier: MIT
// Runs tests: node run.mjs types | unit|browser NAME FOLDER. Types are checked by the TypeScript
// compiler, the others run by node's test runner. NAME is that of a file tests/unit/NAME.test.ts or
// tests/browser/NAME.test.mjs ("all": every one); FOLDER takes bundles, pages and screenshots.
// Exits with 77 and one line where something is missing.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync } from "node:fs";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";

const folder = fileURLToPath(new URL(".", import.meta.url));
const report_folder = join(folder, "..");
const skipped = 77;
const browser = process.env.EARSHOT_CHROMIUM ?? "/usr/bin/chromium";

function skip(reason) {
    console.log(`skipped: ${reason}`);
    process.exit(skipped);
}

function test_files(kind, suffix, name) {
    const names = readdirSync(join(folder, kind)).filter((file) => file.endsWith(suffix)).sort();
    return names.filter((file) => name === "all" || file === name + suffix).map((file) => join(folder, kind, file));
}

/** TypeScript becomes JavaScript that node runs. */
async function bundled(files, target) {
    const { build } = await import("esbuild");
    await build({
        entryPoints: files, bundle: true, platform: "node", format: "esm", outdir: target, outExtension: { ".js": ".mjs" },
        logLevel: "warning", target: ["node18"],
    });
    return files.map((file) => join(target, `${basename(file, ".ts")}.mjs`));
}

const [kind = "unit", name = "all", target = join(report_folder, "dist", "tests")] = process.argv.slice(2);
if (!existsSync(join(report_folder, "node_modules", "esbuild"))) {
    skip("the page's packages are not installed; run report/bundle");
}
if (kind === "browser") {
    if (!existsSync(join(report_folder, "dist", "page.html"))) {
        skip("the page is not bundled; run report/bundle");
    }
    if (!existsSync(browser)) {
        skip(`there is no ${browser} (package chromium)`);
    }
}
if (kind === "types") {
    const compiler = join(report_folder, "node_modules", "typescript", "bin", "tsc");
    process.exit(spawnSync(process.execPath, [compiler, "--noEmit", "-p", report_folder], { stdio: "inherit" }).status ?? 1);
}
mkdirSync(target, { recursive: true });
const files = kind === "browser" ? test_files(kind, ".test.mjs", name) : await bundled(test_files(kind, ".test.ts", name), target);
if (files.length === 0) {
    throw new Error(`there is no test ${name}`);
}
const result = spawnSync(process.execPath, ["--test", ...files], {
    stdio: "inherit", env: { ...process.env, EARSHOT_ARTEFACTS: target, EARSHOT_CHROMIUM: browser },
});
process.exit(result.status ?? 1);
