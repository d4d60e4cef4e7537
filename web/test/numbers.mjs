// Opens the built page with presets and prints, as JSON, the keys of all presets, and what it shows and has computed of those
// that are named: node test/numbers.mjs PAGE [KEY ...]

import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [file, ...wanted] = process.argv.slice(2);
const page = `file://${resolve(file)}`;
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
const tab = await browser.newPage({ viewport: { width: 1440, height: 900 } });
await tab.goto(`${page}?still=0&quality=low`);
const keys = await tab.evaluate(() => [...document.querySelectorAll("#presets button")].map((one) => one.dataset.key));
const found = {};
for (const key of wanted) {
  await tab.goto("about:blank");
  await tab.goto(`${page}?still=0&quality=low#v=1&preset=${key}`);
  await tab.waitForSelector("html[data-ready]", { state: "attached", timeout: 120_000 });
  await tab.waitForTimeout(500);
  found[key] = await tab.evaluate(() => {
    const { names, first, crossings, exponent, drift } = window.laboratory.results();
    const list = (rows) => rows.map((row) => [...row]);
    const digits = (text) => text.replaceAll("−", "-").replaceAll(",", "");
    const shown = [...document.querySelectorAll("#invariants dd")].map((one) => Number(digits(one.querySelector("input")?.value ?? one.textContent)));
    return {
      names, first, shown, lines: window.laboratory.python(),
      crossings: { time: crossings.times, state: list(crossings.rows), shown: Number(digits(document.querySelector("#section p b").textContent)) },
      exponent: { time: exponent.times, value: list(exponent.rows).flat(), shown: digits(document.querySelector("#lyapunov p b").textContent) },
      drift: Math.max(...list(drift.rows).flat().map(Math.abs)),
    };
  });
}
console.log(JSON.stringify({ keys, found }));
await browser.close();
