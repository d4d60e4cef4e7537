// Opens the section of Hénon–Heiles with many orbits in Chromium and prints, as JSON, what it shows: node test/fan.mjs PAGE WANTED.json
// `starts` are texts of starts, each of which is opened by its address; with the first one clicks, the pointer, the list and
// the sliders are tried.

import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [file, wantedFile] = process.argv.slice(2);
const page = `file://${resolve(file)}`;
const { starts } = JSON.parse(readFileSync(wantedFile, "utf8"));
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
const wrong = [];
const found = { fans: [], wrong };

async function opened(address, viewport = { width: 1440, height: 900 }) {
  const tab = await browser.newPage({ viewport });
  tab.on("pageerror", (error) => wrong.push(`error: ${error.message}`));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && wrong.push(`request: ${request.url()}`));
  await tab.goto(`${page}?still=0&quality=low${address}`);
  await finished(tab);
  return tab;
}

const finished = (tab) => tab.waitForFunction(() => window.laboratory?.fan().finished, null, { timeout: 60_000 });
const readOut = (tab) => tab.evaluate(() => {
  const { orbits, about, took } = window.laboratory.fan();
  const start = window.laboratory.state().start.map((one) => one.value);
  const list = orbits.map(({ crossings, ...rest }) => ({ ...rest, start: [...crossings.slice(0, start.length)], last: [...crossings.slice(-start.length)] }));
  return { start, about, took, orbits: list, words: document.querySelector(".fan .counts").textContent, status: document.querySelector(".fan .status").textContent };
});
const addressOf = (tab) => tab.evaluate(() => window.typed.address());

const first = await opened("#own=1");
for (const start of starts) {
  for (const [k, text] of start.entries()) {
    const field = first.locator("#controls > .row input").nth(k);
    await field.fill(text);
    await field.press("Enter");
  }
  await first.waitForTimeout(400);
  await finished(first);
  found.fans.push(await readOut(first));
}
const address = await addressOf(first);
const again = await opened(`#${address}`);
found.again = await readOut(again);
await again.close();

const canvas = first.locator("#section canvas").last();
const box = await canvas.boundingBox();
await canvas.click({ position: { x: box.width * 0.55, y: box.height * 0.45 } });
await first.waitForTimeout(400);
await finished(first);
found.clicked = { ...(await readOut(first)), added: await first.evaluate(() => window.laboratory.state().added), address: await addressOf(first) };
const height = () => first.evaluate(() => document.querySelector("#section .plot").clientHeight);
const tall = await height();
const place = await first.evaluate(() => {
  // a crossing of a regular orbit that has no other orbit beside it
  const { orbits, places } = window.laboratory.fan();
  const all = places();
  const isAlone = ([x, y], own) => all.every((points, k) => k === own || points.every(([u, v]) => Math.hypot(u - x, v - y) > 4));
  for (const [index, { verdict }] of orbits.entries()) {
    const point = verdict === "regular" && all[index].find((one) => isAlone(one, index));
    if (point) return { index, x: point[0], y: point[1] };
  }
});
await canvas.hover({ position: { x: place.x, y: place.y } });
await first.waitForFunction((index) => window.laboratory.fan().chosen === index, place.index, { timeout: 5_000 }).catch(() => {});
found.hovered = { ...(await first.evaluate(() => ({ chosen: window.laboratory.fan().chosen, status: document.querySelector(".fan .status").textContent }))), index: place.index, before: tall, after: await height() };
await first.getByRole("button", { name: "List" }).click();
found.listed = await first.locator(".orbits .orbit").allTextContents();
await first.keyboard.press("Escape");
await first.close();

const sliding = await opened("#own=1&example=heavy-top");
const before = await readOut(sliding);
await sliding.locator(".parameter input[type=range]").first().focus();
for (let k = 0; k < 3; k++) await sliding.keyboard.press("ArrowRight");
const isNew = (old) => window.laboratory.fan().finished && window.laboratory.fan().orbits.some(({ crossings }, k) => crossings[1] !== old[k]);
await sliding.waitForFunction(isNew, before.orbits.map(({ start }) => start[1]), { timeout: 60_000 });
found.slid = { before: before.orbits.map(({ start }) => start), after: (await readOut(sliding)).orbits.map(({ start }) => start) };
await sliding.locator(".fan select").selectOption("0");
await sliding.waitForTimeout(200);
found.single = await sliding.evaluate(() => document.querySelector("#section p").textContent);
await sliding.close();

const phone = await opened("#own=1", { width: 390, height: 844 });
found.phone = await phone.evaluate(() => {
  const inside = document.querySelector("#section").getBoundingClientRect();
  return { wide: document.documentElement.scrollWidth - innerWidth, plot: document.querySelector("#section .plot").clientHeight, fits: document.querySelector(".fan").getBoundingClientRect().bottom <= inside.bottom + 1 };
});
await browser.close();
console.log(JSON.stringify(found));
