// Takes pictures of pages that are files, perhaps with an address: node test/systems_pictures.mjs FOLDER NAME=FILE#...;theme;width;height;view ...

import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [folder, ...wanted] = process.argv.slice(2);
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
for (const picture of wanted) {
  const [name, rest] = picture.split(/=(.*)/s);
  const [file, theme, width, height, view] = rest.split(";");
  const tab = await browser.newPage({ viewport: { width: Number(width ?? 1440), height: Number(height ?? 900) }, colorScheme: theme === "dark" ? "dark" : "light" });
  tab.on("console", (message) => ["error", "warning"].includes(message.type()) && console.log(name, message.type(), message.text().slice(0, 300)));
  tab.on("pageerror", (error) => console.log(name, "error:", error.message));
  tab.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && console.log(name, "request:", request.url()));
  const [path, hash] = file.split(/(#.*)/);
  await tab.goto(`file://${resolve(path)}?still=2490&quality=full${hash ?? ""}`);
  const begun = Date.now();
  if (view) await tab.locator(`#presets button[data-key="${view}"]`).click();
  await tab.waitForSelector("html[data-ready]", { timeout: 60_000, state: "attached" }).catch(() => console.log(name, "is not ready"));
  await tab.waitForTimeout(600);
  const found = await tab.evaluate(() => {
    const results = window.laboratory.results();
    const times = window.laboratory.frameTimes().sort((a, b) => a - b);
    return { crossings: results.crossings.length, exponent: results.exponent.rows.at(-1)?.[0], to: results.until, median: times[times.length >> 1], wide: document.documentElement.scrollWidth };
  });
  console.log(name, Date.now() - begun, "ms", JSON.stringify(found));
  await tab.screenshot({ path: `${folder}/${name}.png`, fullPage: Number(width) < 900 });
  await tab.close();
}
await browser.close();
