// SPDX-License-Identifier: MIT
// Contacts over time: the view of the meshes, a slider of time, a summary and a table of contacts.
import type { Contact, ContactData } from "../data/schema";
import { button, el, next_id, replace_children } from "../dom";
import { dash, number, with_unit } from "../format";
import type { Report } from "../report";
import { no_webgl_message } from "../scene/scene_section";
import { scrolling, section, type Section } from "../sections/section";
import { contacts_at } from "./contact_frames";
import { ContactView } from "./contact_view";

const max_rows = 200;
const frames_per_second = 12;

function plain(value: unknown): string {
    if (typeof value === "number") {
        return Number.isInteger(value) ? String(value) : number(value, 4);
    }
    if (Array.isArray(value)) {
        return value.map(plain).join(", ");
    }
    return value === null || value === undefined ? dash : typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** The program's own summary: a row per entry, a column per key. */
function summary_table(summary: unknown[]): HTMLElement | null {
    const rows = summary.filter((r): r is Record<string, unknown> => typeof r === "object" && r !== null);
    const keys = [...new Set(rows.flatMap((r) => Object.keys(r)))];
    if (rows.length === 0) {
        return null;
    }
    return scrolling("Summary of contacts", el("table", { class: "numbers" },
        el("caption", {}, "Summary by pair of meshes"),
        el("thead", {}, el("tr", {}, ...keys.map((key) => el("th", { scope: "col" }, key.replaceAll("_", " "))))),
        el("tbody", {}, ...rows.map((row) => el("tr", {}, ...keys.map((key) => el("td", {}, plain(row[key]))))))));
}

function contact_table(contacts: Contact[]): HTMLElement {
    const point = (p: Contact["point"]): string => p ? p.map((x) => number(x, 3)).join(", ") : dash;
    const has_depth = contacts.some((c) => typeof c.depth === "number");
    return scrolling("Contacts of this time", el("table", { class: "numbers" },
        el("caption", {}, contacts.length > max_rows ? `The first ${max_rows} of ${contacts.length} contacts of this time` : `${contacts.length} contacts of this time`),
        el("thead", {}, el("tr", {}, ...["Time (s)", "Kind", "Between", "Point (m)", "Normal", ...(has_depth ? ["Depth (m)"] : [])]
            .map((text) => el("th", { scope: "col" }, text)))),
        el("tbody", {}, ...contacts.slice(0, max_rows).map((c) => el("tr", {},
            el("td", {}, number(c.time, 4)), el("td", {}, (c.kind ?? dash).replaceAll("_", " ")),
            el("td", {}, `${c.a ?? dash} and ${c.b ?? dash}`), el("td", {}, point(c.point)), el("td", {}, point(c.normal)),
            has_depth && el("td", {}, number(c.depth, 4)))))));
}

function step_control(times: number[], on_step: (step: number) => void): HTMLElement {
    const id = next_id("step");
    const last = Math.max(times.length - 1, 0);
    const slider = el("input", { type: "range", id, min: 0, max: last, step: 1, value: 0 });
    const output = el("output", { for: id });
    let timer: number | null = null;
    const show = (): void => {
        const time = times[Number(slider.value)] ?? 0;
        replace_children(output, with_unit(number(time, 3), "s"));
        slider.setAttribute("aria-valuetext", output.textContent ?? "");
        on_step(Number(slider.value));
    };
    const stop = (): void => {
        window.clearInterval(timer ?? undefined);
        timer = null;
        replace_children(play, "Play");
    };
    const play = button("Play", () => {
        if (timer !== null) {
            stop();
            return;
        }
        if (Number(slider.value) >= last) {
            slider.value = "0";
        }
        replace_children(play, "Pause");
        timer = window.setInterval(() => {
            slider.value = String(Number(slider.value) + 1);
            show();
            if (Number(slider.value) >= last) {
                stop();
            }
        }, 1000 / frames_per_second);
    }, { class: "play" });
    slider.addEventListener("input", () => {
        stop();
        show();
    });
    show();
    return el("div", { class: "controls time" }, play, el("label", { for: id }, "Time"), slider, output);
}

function view_or_message(title: string, data: ContactData): ContactView | null {
    try {
        return new ContactView(title, data);
    } catch {
        return null;
    }
}

export function contacts_section(report: Report): Section | null {
    const data = report.data.contacts;
    if (!data) {
        return null;
    }
    const times = data.times ?? [];
    const table = el("div");
    const view = view_or_message(report.data.title, data);
    const control = step_control(times, (step) => {
        view?.show(step);
        replace_children(table, contact_table(contacts_at(data.contacts ?? [], times, step)));
    });
    return section("contacts", "Contacts",
        view ? view.viewer.element : el("p", { class: "plain-message", role: "note" }, no_webgl_message),
        data.left_out ? el("p", { class: "hint" }, `${data.left_out} contacts are left out of this page.`) : null,
        control, summary_table(data.summary ?? []), table);
}
