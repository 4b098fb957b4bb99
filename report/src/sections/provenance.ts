// SPDX-License-Identifier: MIT
// How the same page can be made again.
import type { ReportData } from "../data/schema";
import { el } from "../dom";
import { section, type Section } from "./section";

export function provenance_section(data: ReportData): Section {
    const origin = data.provenance ?? {};
    const list = el("dl", { class: "provenance" });
    const line = (name: string, text: string | undefined, is_code = false): void => {
        if (text !== undefined && text !== "") {
            list.append(el("dt", {}, name), el("dd", {}, is_code ? el("code", {}, text) : text));
        }
    };
    line("Program", [origin.program, origin.version].filter(Boolean).join(" "));
    line("Command", origin.command, true);
    line("Seed", origin.seed === undefined || origin.seed === null ? undefined : String(origin.seed));
    line("Files", origin.files?.join(", "));
    line("Digest of the scene", origin.scene_digest, true);
    return section("provenance", "Provenance", list,
        el("p", { class: "hint" }, "The same command, version and scene give the same page, to the byte."));
}
