// SPDX-License-Identifier: MIT
// The page of a furnished room as the program makes it.
import { test } from "node:test";
import { check_page, missing } from "./program.mjs";

const max_page_bytes = 3_000_000;

test("the page of the classroom opens without complaints", { skip: missing }, async (t) => {
    await check_page(t, "classroom", ["--order", "3", "--rays", "4000"], max_page_bytes);
});
