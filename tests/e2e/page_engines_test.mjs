// The page where it cannot draw, and in another engine: a job runs from the file to the result. Where
// there are no views, the server's pictures stand in their place.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { noFirefox } from "./browsers.mjs";
import { Bench, cap, difference, draws, figure, jobOf, launchChromium, launchFirefox, missing, openMesh, shot, unwrap } from "./page.mjs";

const engines = {
  "Chromium without WebGL": [missing, () => launchChromium(["--no-sandbox", "--disable-quic", "--disable-gpu", "--disable-3d-apis"])],
  "Firefox": [missing || noFirefox, () => launchFirefox()],
};

for (const [name, [skip, launch]] of Object.entries(engines))
  describe(name, { skip }, () => {
    const bench = new Bench();
    before(() => bench.open(launch));
    after(() => bench.close());

    /** The pictures of both views follow what they are to show. */
    async function showsColours(page) {
      for (const view of ["#solid", "#flat"]) {
        await page.selectOption("#colouring", "checker");
        const checked = await shot(page, view);
        await page.selectOption("#colouring", "stretch");
        assert.ok(await difference(page, await shot(page, view), checked) > 0.03, view);
      }
    }

    const shownWidths = (page) => page.locator("#pictures img:visible").evaluateAll((all) => all.map((image) => image.naturalWidth));

    test("takes a mesh to its result, and shows it", async (t) => {
      const page = await bench.visit(t);
      const isBlank = !(await draws(page));
      assert.ok(isBlank || name === "Firefox");
      await openMesh(page, bench.file("cap.obj", cap()));
      assert.equal(await page.locator("#no-webgl").isVisible(), isBlank);
      assert.deepEqual(await shownWidths(page), []);
      await unwrap(page);
      assert.equal(await figure(page, "Charts"), "1");
      if (isBlank) await page.locator("#layout-picture").waitFor();
      assert.equal((await shownWidths(page)).filter((width) => width > 100).length, isBlank ? 2 : 0);
      assert.equal(await page.locator("#solid").isVisible(), !isBlank);
      await openMesh(page, bench.file("small.obj", cap(4)));
      assert.deepEqual(await shownWidths(page), [], "those of another mesh are gone");
      assert.deepEqual(page.complaints, []);
      assert.deepEqual(page.elsewhere, []);
    });

    test("draws what it is to show", { skip: name !== "Firefox" && "it cannot draw" }, async (t) => {
      const page = await bench.visit(t);
      if (!(await draws(page))) return t.skip("Firefox finds nothing here that draws for it");
      await unwrap(page, bench.file("cap.obj", cap()));
      await showsColours(page); // takes pictures, for which Playwright adds a style that Firefox complains of
    });

    test("finds the job again after a reload", async (t) => {
      const page = await bench.visit(t);
      await unwrap(page, bench.file("cap.obj", cap()));
      const job = jobOf(page);
      await page.reload();
      await page.locator("#result").waitFor();
      assert.equal(jobOf(page), job);
      assert.equal(await figure(page, "Charts"), "1");
      assert.deepEqual(page.complaints, []);
    });
  });
