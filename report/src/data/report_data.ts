// SPDX-License-Identifier: MIT
// Reads the report's data from the page and says in one line what is wrong with it.
import type { ReportData } from "./schema";

const supported_format = 1;

export function parse_report(text: string): ReportData {
    let data: ReportData;
    try {
        data = JSON.parse(text) as ReportData;
    } catch {
        throw new Error("The report holds no data.");
    }
    if (typeof data !== "object" || data === null || data.format !== supported_format) {
        throw new Error(`The data of this report has a format other than ${supported_format}.`);
    }
    return data;
}

/** A name in the report's lists, or its number where the list lacks it. */
export function name_of(list: { name: string }[] | undefined, index: number): string {
    return list?.[index]?.name ?? `number ${index}`;
}
