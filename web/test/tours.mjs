// Goes through the first tour of a page: node test/tours.mjs FILE HASH.  Prints what each step shows and the state before and
// after as JSON, which tests/web/test_tours.py reads.

import { chromium } from "playwright-core";

const [file, hash] = process.argv.slice(2);
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
const tab = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const wrong = [];
tab.on("pageerror", (error) => wrong.push(error.message));
tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
await tab.goto(`file://${file}?still=0&quality=low#${hash}`);
await tab.waitForSelector("html[data-ready]", { state: "attached", timeout: 60_000 });
const state = () => tab.evaluate(() => window.laboratory.state());
const before = await state();
await tab.keyboard.press("h");
await tab.locator("#tours li button").first().press("Enter");
const steps = [];
for (let k = 1; ; k++) {
  const title = await tab.locator("#tour h2").innerText();
  steps.push({ title, message: await tab.locator("#message p").textContent(), pointed: await tab.locator(".pointed").getAttribute("id"), state: await state() });
  if (!title.startsWith(`${k} of`) || title.startsWith(`${k} of ${k}:`)) break;
  await tab.keyboard.press("ArrowRight");
}
await tab.keyboard.press("Escape");
console.log(JSON.stringify({ before, steps, after: await state(), wrong }));
await browser.close();
