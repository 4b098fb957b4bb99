// SPDX-License-Identifier: MIT
// Which pose of a mesh, and which contacts, belong to a time.
import type { Contact } from "../data/schema";

/** Index of the last frame at or before the time; the first one before all. Frames are in order of time. */
export function frame_at(frames: { time: number }[], time: number): number {
    let index = 0;
    for (let i = 1; i < frames.length && frames[i]!.time <= time + 1e-9; ++i) {
        index = i;
    }
    return index;
}

/** Contacts of the interval of time that ends at `times[step]`. */
export function contacts_at(contacts: Contact[], times: number[], step: number): Contact[] {
    const to = times[step] ?? Infinity;
    const from = step > 0 ? times[step - 1]! : -Infinity;
    return contacts.filter((c) => c.time > from + 1e-9 && c.time <= to + 1e-9);
}
