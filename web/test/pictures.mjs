// Takes pictures of the built page: node test/pictures.mjs FOLDER [name=hash;width;height;search ...].  Without names it takes
// the page, its panels and dialogs in three themes and two sizes.

import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [folder, ...named] = process.argv.slice(2);
const PANELS = ["controls", "scene", "section", "portrait", "lyapunov", "drift"];
const SHOWN = { light: "twisted-lagrange", dark: "charged", projector: "sticky" };
const sizes = [["wide", 1440, 900], ["phone", 390, 844]];
const every = Object.entries(SHOWN).flatMap(([theme, preset]) => sizes.map(([size, width, height]) => `${theme}-${size}=v=1&preset=${preset}&theme=${theme};${width};${height}`));
const wanted = named.length ? named : every;
const page = `file://${resolve(import.meta.dirname, "../dist/index.html")}`;
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
for (const picture of wanted) {
  const [name, rest] = picture.split(/=(.*)/s);
  const [hash, width, height, search] = rest.split(";");
  const tab = await browser.newPage({ viewport: { width: Number(width ?? 1440), height: Number(height ?? 900) } });
  tab.on("console", (message) => ["error", "warning"].includes(message.type()) && console.log(name, message.type(), message.text().slice(0, 300)));
  tab.on("pageerror", (error) => console.log(name, "error:", error.message));
  tab.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && console.log(name, "request:", request.url()));
  await tab.goto(`${page}?still=2490&${search ?? "quality=full"}#${hash}`);
  const begun = Date.now();
  await tab.waitForSelector("html[data-ready]", { timeout: 120_000, state: "attached" }).catch(() => console.log(name, "is not ready"));
  const found = await tab.evaluate(() => {
    const results = window.laboratory.results();
    const times = window.laboratory.frameTimes().sort((a, b) => a - b);
    return { crossings: results.crossings.length, exponent: results.exponent.rows.at(-1)?.[0], median: times[times.length >> 1], wide: document.documentElement.scrollWidth };
  });
  console.log(name, Date.now() - begun, "ms", JSON.stringify(found));
  await tab.screenshot({ path: `${folder}/${name}.png`, fullPage: Number(width) < 900 });
  if (!named.length) {
    for (const panel of PANELS) await tab.locator(`#${panel}`).screenshot({ path: `${folder}/${name}-${panel}.png` });
    await tab.evaluate(() => scrollTo(0, 0));
    await tab.screenshot({ path: `${folder}/${name}-first.png` });
    for (const [dialog, key] of [["keys", "?"], ["tours", "h"]]) {
      await tab.keyboard.press(key);
      await tab.screenshot({ path: `${folder}/${name}-${dialog}.png` });
      if (dialog === "keys") await tab.locator("#keys button").click();
    }
    await tab.locator("#tours li button").first().click();
    await tab.screenshot({ path: `${folder}/${name}-tour.png` });
  }
  await tab.close();
}
await browser.close();
