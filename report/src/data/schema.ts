// SPDX-License-Identifier: MIT
// The data of a report, as the program writes it into the page. Positions are metres, Y up. Every
// block but the first four members may be absent; withheld numbers are null.

export type Vector = [number, number, number];
export type PerBand = (number | null)[];

export interface ReportData {
    format: number;
    kind: "rooms" | "contacts" | "map";
    title: string;
    provenance: Provenance;
    verdict?: VerdictLine[];
    warnings?: string[];
    room?: Room;
    bands?: number[];
    scene?: SceneData;
    materials?: Material[];
    sources?: Emitter[];
    listeners?: Emitter[];
    pairs?: Pair[];
    sensitivity?: Sensitivity;
    maps?: MetricMap[];
    contacts?: ContactData;
}

export interface Provenance {
    program?: string;
    version?: string;
    command?: string;
    seed?: number | null;
    scene_digest?: string;
    files?: string[];
}

export interface VerdictLine {
    question: string;
    answer: string;
    state: "met" | "missed" | "told";
    pair?: number;
}

export interface Room {
    extent?: Vector;
    volume?: number | null;
    surface?: number | null;
    sabine?: PerBand;
    eyring?: PerBand;
}

/** Arrays are base64 of little-endian values. */
export interface SceneData {
    positions_f32: string;
    triangles_u32: string;
    material_u16: string;
    meshes?: { name: string; first_triangle: number; triangle_count: number }[];
    /** Triangles that are not in the page. */
    left_out?: number;
}

export interface Material {
    name: string;
    area?: number | null;
    absorption?: PerBand;
    scattering?: PerBand;
    guessed?: boolean;
}

export interface Emitter {
    name: string;
    /** Null where no scene tells it. */
    position: Vector | null;
}

export interface Pair {
    source: number;
    listener: number;
    /** Of the scene's animation. */
    time?: number;
    metrics?: PairMetrics;
    reference?: PairMetrics;
    paths?: SoundPath[];
    paths_left_out?: number;
    decay?: Decay;
    histogram?: Histogram;
    audio?: { dry?: string; wet?: string; text?: string };
}

export interface Note {
    metric: string;
    band_hz: number | null;
    text: string;
}

/** A pair of metrics.json: a list per band under each metric's key, and single numbers. */
export interface PairMetrics {
    name?: string;
    sti?: number | null;
    sti_letter?: string | null;
    single?: Record<string, number | null>;
    standard_error?: (Record<string, unknown> & { single?: Record<string, number | null> }) | null;
    notes?: Note[];
    [metric: string]: unknown;
}

/** A path of paths.json; `pressure` is per band, relative to the source at 1 m. */
export interface SoundPath {
    kind?: string;
    order: number;
    length: number;
    delay: number;
    points: Vector[];
    materials?: string[];
    pressure: number[];
}

export interface FitLine {
    from: number;
    to: number;
    level_from: number;
    level_to: number;
}

export interface Decay {
    step: number;
    level_db: ((number | null)[] | null)[];
    fits?: (Partial<Record<"edt" | "t20" | "t30", FitLine | null>> | null)[];
}

export interface Histogram {
    step: number;
    energy_db: ((number | null)[] | null)[];
    relative_error: ((number | null)[] | null)[];
}

export interface Sensitivity {
    pairs: PairSensitivity[];
}

/**
 * Lists run over the report's materials; derivatives are per +1 of absorption. Energy is that which
 * reaches the listener: the share that a material reflected at least once.
 */
export interface PairSensitivity {
    source: number;
    listener: number;
    energy?: { name?: string; before_80ms?: PerBand; after_80ms?: PerBand }[];
    derivatives?: Partial<Record<"t30" | "c80" | "sti", (PerBand | null)[]>> & {
        /** Of single numbers, absorption of all bands together. */
        single?: Record<string, (number | null)[]>;
    };
}

export interface MetricMap {
    metric: string;
    unit?: string;
    source?: number | null;
    jnd?: number | null;
    /** Then `jnd` is a share of the value. */
    jnd_is_relative?: boolean;
    limit?: number | null;
    limit_is_minimum?: boolean;
    share?: number | null;
    plane?: { origin: Vector; u: Vector; v: Vector };
    points?: Vector[];
    values?: (number | null)[];
    errors?: (number | null)[];
    cells?: [number, number, number, number, number | null][];
    contour?: Vector[][];
}

export interface ContactData {
    times?: number[];
    meshes?: {
        name: string;
        triangles_u32: string;
        frames: { time: number; positions_f32: string }[];
    }[];
    contacts?: Contact[];
    summary?: unknown[];
    /** Contacts that are not in the page. */
    left_out?: number;
}

export interface Contact {
    time: number;
    kind?: string;
    a?: string;
    b?: string;
    point?: Vector | null;
    normal?: Vector | null;
    depth?: number | null;
}
