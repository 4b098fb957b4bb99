// SPDX-License-Identifier: MIT
// What a sensitivity tells about each material.
import type { PairSensitivity, PerBand } from "../data/schema";

/** Derivatives are told for this much more absorption. */
export const absorption_step = 0.1;

export interface MaterialRow {
    name: string;
    before: number | null;
    after: number | null;
    t30: number | null;
    c80: number | null;
    sti: number | null;
}

const at = (list: PerBand | null | undefined, band: number): number | null => list?.[band] ?? null;

/** Change of STI if the absorption of all octaves grows. */
function sum(list: PerBand | null | undefined): number | null {
    const present = (list ?? []).filter((v): v is number => v !== null);
    return present.length === 0 ? null : present.reduce((a, b) => a + b, 0);
}

export function material_rows(sensitivity: PairSensitivity, names: string[], band: number): MaterialRow[] {
    const step = (value: number | null): number | null => (value === null ? null : absorption_step * value);
    const { energy = [], derivatives = {} } = sensitivity;
    const { t30 = [], c80 = [], sti = [] } = derivatives;
    const count = Math.max(energy.length, t30.length, c80.length, sti.length);
    const rows = Array.from({ length: count }, (_, i): MaterialRow => ({
        name: energy[i]?.name ?? names[i] ?? `material ${i}`,
        before: at(energy[i]?.before_80ms, band),
        after: at(energy[i]?.after_80ms, band),
        t30: step(at(derivatives.t30?.[i], band)),
        c80: step(at(derivatives.c80?.[i], band)),
        sti: step(derivatives.single?.["sti"]?.[i] ?? sum(derivatives.sti?.[i])),
    }));
    return rows.sort((a, b) => (b.after ?? 0) - (a.after ?? 0) || (b.before ?? 0) - (a.before ?? 0));
}
