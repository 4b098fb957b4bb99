// SPDX-License-Identifier: MIT
// The page of the concert hall as the program makes it: eight pairs, paths by the hundred.
import { test } from "node:test";
import { check_page, missing } from "./program.mjs";

const max_page_bytes = 6_000_000;

test("the page of the concert hall opens without complaints", { skip: missing }, async (t) => {
    await check_page(t, "concert_hall", ["--rays", "20000"], max_page_bytes);
});
