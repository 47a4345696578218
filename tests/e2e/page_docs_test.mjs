// The API at /docs: what the contract has, and that a call can be tried there.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, describe, test } from "node:test";

import { load } from "js-yaml";

import { Bench, missing } from "./page.mjs";

const METHODS = ["get", "put", "post", "delete", "patch"];
const { paths } = load(readFileSync(new URL("../../api/openapi.yaml", import.meta.url), "utf8"));
const operations = Object.values(paths).flatMap((path) => METHODS.filter((method) => path[method]));

describe("the page of the API", { skip: missing }, () => {
  const bench = new Bench();
  before(() => bench.open());
  after(() => bench.close());

  /** The page, once it shows the calls; complaints are what its console got. */
  async function docs(t) {
    const page = await bench.blank(t);
    await page.goto(`${bench.server.base}/docs`);
    await page.locator(".opblock").first().waitFor();
    return page;
  }

  test("has every call of the contract and loads nothing from elsewhere", async (t) => {
    const page = await docs(t);
    assert.equal(await page.locator(".opblock").count(), operations.length);
    assert.deepEqual(page.elsewhere, []);
    assert.deepEqual(page.complaints, []);
  });

  test("tries a call, and shows its curl command", async (t) => {
    const page = await docs(t);
    const call = page.locator(".opblock", { hasText: "/v1/limits" });
    await call.locator(".opblock-summary-control").click();
    await call.getByRole("button", { name: "Execute" }).click();
    await call.locator(".live-responses-table .response-col_status", { hasText: "200" }).waitFor();
    assert.match(await call.locator(".curl").textContent(), /curl -X 'GET'.*\/v1\/limits/s);
    assert.match(await call.locator(".live-responses-table").textContent(), /max_sync_faces/);
    assert.deepEqual(page.elsewhere, []);
    assert.deepEqual(page.complaints, []);
  });
});
