// The browsers of the tests: CHROMIUM and FIREFOX, else Debian's. The shell of Chromium without windows
// is the same engine for half of the processor time.
import { existsSync } from "node:fs";

const installed = ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium"];

export const chromium = process.env.CHROMIUM ?? installed.find(existsSync) ?? installed[0];
export const firefox = process.env.FIREFOX ?? "/usr/bin/firefox-esr";

/** Why tests cannot open a page; false if they can. */
export const noChromium = !existsSync(chromium) && `there is no Chromium at ${chromium}`;
export const noFirefox = [firefox, "/usr/bin/Xvfb"].filter((file) => !existsSync(file)).map((file) => `there is no ${file}`).join(", ") || false;
