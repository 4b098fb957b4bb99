// SPDX-License-Identifier: MIT
// What the reader has chosen; sections subscribe to the members that they show.

export interface Choices {
    pair: number;
    /** Index into the report's bands. */
    band: number;
    /** Key of the metric that colours listeners. */
    metric: string;
    /** Index into the pair's paths. */
    path: number | null;
    hidden_orders: ReadonlySet<number>;
    /** The strongest paths of the band are drawn in 3-D. */
    max_paths: number;
    /** Seconds after emission; null: whole paths are drawn. */
    time: number | null;
    /** "reference": the one in the data; a number: another pair. */
    reference: "none" | "reference" | number;
}

type Key = keyof Choices;

export class State {
    private readonly listeners: { keys: Key[]; update: () => void }[] = [];

    constructor(public readonly now: Choices) {}

    subscribe(keys: Key[], update: () => void): void {
        this.listeners.push({ keys, update });
    }

    set(changes: Partial<Choices>): void {
        const changed = (Object.keys(changes) as Key[]).filter((key) => changes[key] !== this.now[key]);
        if (changed.length === 0) {
            return;
        }
        Object.assign(this.now, changes);
        // A path belongs to its pair.
        if (changed.includes("pair") && !("path" in changes) && this.now.path !== null) {
            this.now.path = null;
            changed.push("path");
        }
        for (const listener of this.listeners) {
            if (listener.keys.some((key) => changed.includes(key))) {
                listener.update();
            }
        }
    }
}
