// The Chromium of the tests: CHROMIUM, else Debian's. The shell without windows is the same engine for
// half of the processor time.
import { existsSync } from "node:fs";

const installed = ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium"];

export const chromium = process.env.CHROMIUM ?? installed.find(existsSync) ?? installed[0];

/** Why tests cannot open a page; false if they can. */
export const noChromium = !existsSync(chromium) && `there is no Chromium at ${chromium}`;
