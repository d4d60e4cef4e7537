// Opens pages in Chromium and says what they show: node test/systems.mjs WANTED.json, a list of {name, file, hash, until, width,
// click, remark}: `click` is the number of a crossing at which an orbit is started, `remark` asks for what the section says.
// The answers are JSON on standard output, which tests/web/test_systems.py compares with Python.

import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

const wanted = JSON.parse(readFileSync(process.argv[2], "utf8"));
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
const answers = {};
for (const { name, file, hash, until, width, click, remark } of wanted) {
  const tab = await browser.newPage({ viewport: { width: width ?? 1280, height: 800 } });
  const wrong = [];
  tab.on("pageerror", (error) => wrong.push(error.message));
  tab.on("dialog", (dialog) => (wrong.push(`dialog ${dialog.message()}`), dialog.dismiss()));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(data|blob|file):/.test(request.url()) && wrong.push(request.url()));
  await tab.goto(`file://${file}?still=60&quality=low${hash ?? ""}`);
  const done = ([end]) => {
    if (document.documentElement.dataset.broken) return true;
    const results = window.laboratory?.results();
    const has = [...document.querySelectorAll("#controls h3")].some((one) => one.textContent === "Saved result");
    const compared = !has || /Computed again|only shown/.test(document.querySelector(".saved").textContent);
    return results && results.until >= end && (results.exponent.times.at(-1) ?? 0) >= end && compared;
  };
  await tab.waitForFunction(done, [until ?? 0], { timeout: 60_000 });
  // what is compared is the section of the motion alone
  const orbits = tab.locator(".fan:not([hidden]) select");
  if (await orbits.count()) await orbits.selectOption("0");
  if (remark) await tab.waitForSelector("#section .remark:not([hidden])", { timeout: 60_000 });
  // charts are drawn anew in the frames that follow
  await tab.evaluate((frames) => new Promise((done) => requestAnimationFrame(function next() { frames-- > 0 ? requestAnimationFrame(next) : done(); })), 12);
  answers[name] = await tab.evaluate(() => {
    const results = window.laboratory?.results();
    const text = (selector) => document.querySelector(selector)?.textContent ?? "";
    return {
      title: document.title,
      heading: text("#title"),
      message: document.querySelector("#message").hidden ? "" : text("#message p"),
      saved: text(".saved"),
      subtitle: text("#subtitle"),
      controls: text("#controls"),
      charts: Object.fromEntries(["section", "drift"].map((id) => [id, ["h3", "p", ".remark"].map((part) => text(`#${id} ${part}`))])),
      count: text("#section p b"),
      drift: results && results.drift.rows.flatMap((row) => [...row]).reduce((most, value) => Math.max(most, Math.abs(value)), 0),
      views: [...document.querySelectorAll("#presets button")].map((one) => one.dataset.key),
      labels: [...document.querySelectorAll("#controls input")].map((one) => one.getAttribute("aria-label")),
      markup: document.querySelectorAll("img, iframe, object, embed").length,
      scripts: [...document.querySelectorAll("script")].map((one) => one.type),
      ran: window.ran ?? null,
      wide: document.documentElement.scrollWidth - innerWidth,
      start: window.laboratory?.state().start.map((one) => one.value),
      names: results?.names,
      first: results && [...results.first],
      crossings: results && { times: results.crossings.times, states: results.crossings.rows.map((row) => [...row]) },
      exponent: results && { times: results.exponent.times, values: results.exponent.rows.map((row) => row[0]) },
    };
  });
  if (click !== undefined) {
    await tab.locator("#section canvas").last().focus();
    for (let k = 0; k <= click; k++) await tab.keyboard.press("ArrowRight");
    await tab.keyboard.press("Enter");
    answers[name].clicked = { index: click, start: await tab.evaluate(() => window.laboratory.state().start.map((one) => one.value)) };
  }
  answers[name].wrong = wrong;
  await tab.close();
}
await browser.close();
console.log(JSON.stringify(answers));
