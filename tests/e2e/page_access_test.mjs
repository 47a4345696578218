// The page for everybody: axe finds nothing in both themes and widths, everything works by keyboard, and
// nothing runs over the edge of a phone.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";

import { obj } from "../contract/meshes.mjs";
import { Bench, missing, openMesh, seen, unwrap } from "./page.mjs";

const bench = new Bench();
const axe = fileURLToPath(new URL("../node_modules/axe-core/axe.min.js", import.meta.url));
const tags = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];

const sizes = { wide: { width: 1280, height: 900 }, phone: { width: 360, height: 740 } };

describe("the page is for everybody", { skip: missing || (!existsSync(axe) && "axe-core is missing: run npm ci in tests/") }, () => {
  before(() => bench.open());
  after(() => bench.close());

  /** What axe finds in the page as it is. */
  async function findings(page) {
    await page.evaluate(readFileSync(axe, "utf8"));
    const { violations } = await page.evaluate((only) => window.axe.run(document, { runOnly: only }), tags);
    return violations.flatMap(({ id, nodes }) => nodes.map(({ html, failureSummary }) => `${id}: ${html} ${failureSummary}`));
  }

  const overflow = (page) => page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

  for (const colorScheme of ["light", "dark"])
    for (const [name, viewport] of Object.entries(sizes))
      test(`in ${colorScheme}, ${name}`, async (t) => {
        const isEachLookedAt = (colorScheme === "light") === (name === "wide"); // colours and widths know nothing of each other
        const page = await bench.visit(t, { colorScheme, viewport, bypassCSP: true });
        const states = {
          fresh: async () => {},
          options: async () => { await page.selectOption("[name=method]", "hybrid"); await page.click("#form summary"); },
          problem: async () => {
            await page.setInputFiles("#files", [bench.file("notes.txt", "x")]);
            await page.locator("#problem").waitFor();
          },
          open: () => openMesh(page, bench.file(`a-name-that-is-far-too-long-for-a-telephone-${"x".repeat(60)}.obj`, obj(4))),
          result: async () => {
            await unwrap(page);
            for (const summary of await page.locator("#result summary, #jobs summary").all()) await summary.click();
            await page.selectOption("#colouring", "stretch");
          },
          seams: () => page.check("#edit-seams"),
          pins: async () => {
            await page.check("#edit-pins");
            await page.focus("#flat");
            await page.keyboard.press("Enter");
            await page.locator("#pin-list li").waitFor();
          },
          islands: async () => {
            await page.check("#edit-islands");
            await page.focus("#flat");
            await page.keyboard.press("Enter");
            await page.locator("#island-place").waitFor();
          },
        };
        for (const [state, reach] of Object.entries(states)) {
          await reach();
          if (isEachLookedAt || state === "result") assert.deepEqual(await findings(page), [], state);
          assert.ok((await overflow(page)) <= 0, `${state} runs over the edge by ${await overflow(page)}`);
        }
        const [background] = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g));
        assert.equal(Number(background) < 128, colorScheme === "dark");
        for (const canvas of ["#solid", "#flat"])
          assert.equal((await seen(page, canvas)).ground < 128, colorScheme === "dark", `${canvas} is of the theme`);
        assert.ok((await seen(page, "#flat")).share > 0.1);
      });

  test("by keyboard alone, from the file to the download", async (t) => {
    const page = await bench.visit(t);
    const tabTo = async (selector) => {
      for (let presses = 0; presses < 120; presses += 1) {
        if (await page.evaluate((wanted) => document.activeElement.matches(wanted), selector)) return;
        await page.keyboard.press("Tab");
      }
      assert.fail(`no Tab leads to ${selector}`);
    };
    const choosing = page.waitForEvent("filechooser"); // long before the key, which may be faster
    await tabTo("#files");
    await page.keyboard.press("Enter");
    await (await choosing).setFiles(bench.file("grid.obj", obj(4)));
    await page.locator("#analysis li", { hasText: "triangle" }).first().waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.id), "mesh-name", "focus goes to what is new");
    await tabTo("#send");
    await page.keyboard.press("Enter");
    await page.locator("#result").waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.id), "result-title");
    await tabTo("#downloads .primary");
    const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Enter")]);
    assert.equal(download.suggestedFilename(), "grid.uv.obj");
  });

  test("with the licences of the packages in it", async (t) => {
    const page = await bench.visit(t);
    const scripts = [];
    page.on("response", (answer) => /\.js$/.test(answer.url()) && scripts.push(answer.text()));
    await page.reload();
    await page.locator("#option-method").waitFor();
    const texts = (await Promise.all(scripts)).filter((text) => text.includes("WebGLRenderer"));
    assert.ok(texts.length > 0);
    for (const text of texts) assert.ok(/three 0\.[^]*Copyright © 2010-\d+ three\.js authors[^]*Permission is hereby granted/.test(text));
  });

  test("within 300 kB for the first paint, without a word to elsewhere", async (t) => {
    const page = await bench.visit(t);
    const cdp = await page.context().newCDPSession(page);
    await cdp.send("Network.enable");
    await cdp.send("Network.setCacheDisabled", { cacheDisabled: true });
    let sum = 0;
    cdp.on("Network.loadingFinished", ({ encodedDataLength }) => { sum += encodedDataLength; });
    await page.reload();
    await page.locator("#option-method").waitFor();
    assert.ok(sum > 50_000 && sum < 300_000, `${sum} bytes`);
    t.diagnostic(`first paint: ${sum} bytes`);
    assert.deepEqual(page.elsewhere, []);
    assert.deepEqual(page.complaints, []);
    const policy = (await fetch(`${bench.server.base}/`)).headers.get("content-security-policy");
    assert.doesNotMatch(policy, /unsafe-inline|'unsafe-eval'|http|\*/);
  });
});
