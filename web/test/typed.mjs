// Types systems into the built page and prints, as JSON, what it shows: node test/typed.mjs PAGE WANTED.json
// A system that is wanted has a name, what is typed (`bracket`, `coordinates`, ...), a start, and until when it is followed.

import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [file, wantedFile] = process.argv.slice(2);
const page = `file://${resolve(file)}`;
const wanted = JSON.parse(readFileSync(wantedFile, "utf8"));
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
const found = {};
const wrong = [];

async function opened(address, viewport = { width: 1440, height: 900 }) {
  const tab = await browser.newPage({ viewport });
  tab.on("pageerror", (error) => wrong.push(`error: ${error.message}`));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && wrong.push(`request: ${request.url()}`));
  await tab.goto(`${page}?quality=low${address}`);
  await tab.waitForFunction(() => window.laboratory?.results().names.length > 0, null, { timeout: 60_000 });
  return tab;
}

const readOut = (tab) => tab.evaluate(() => {
  const { names, first, crossings, drift, until } = window.laboratory.results();
  const list = (rows) => rows.map((row) => [...row]);
  return {
    names: [...names], first: [...first], until, start: window.laboratory.state().start.map((one) => one.value),
    crossings: { times: [...crossings.times], states: list(crossings.rows) },
    drift: Math.max(...list(drift.rows).flat().map(Math.abs)),
    shown: [...document.querySelectorAll("#typing .formulas")].map((one) => one.textContent),
    file: window.typed.file(), lines: window.typed.lines(), hash: window.typed.address(),
  };
});

async function typeInto(tab, label, text) {
  const field = tab.getByLabel(label, { exact: true });
  await field.fill(text);
}

for (const { name, bracket, fields = {}, hamiltonian, parameters = {}, start, until } of wanted.systems) {
  const tab = await opened("#own=1");
  await tab.getByLabel("bracket", { exact: true }).selectOption(bracket);
  for (const [label, text] of Object.entries(fields)) await typeInto(tab, label, text);
  await tab.locator("#hamiltonian").fill("");
  await tab.locator("#hamiltonian").pressSequentially(hamiltonian, { delay: 2 });
  await tab.waitForFunction(() => [...document.querySelectorAll(".wrong")].every((one) => one.hidden), null, { timeout: 10_000 });
  for (const [label, text] of Object.entries(parameters)) {
    await typeInto(tab, `${label}, exact value`, text);
    await tab.keyboard.press("Enter");
  }
  for (const [k, text] of start.entries()) {
    const field = tab.locator("#controls > .row input").nth(k);
    await field.fill(text);
    await field.press("Enter");
  }
  await tab.waitForFunction((end) => window.laboratory.results().until >= end, until, { timeout: 60_000 });
  await tab.waitForTimeout(300);
  const typed = await readOut(tab);
  // what is sent and opened again is the same
  const again = await opened(`#${typed.hash}`);
  await again.waitForFunction((end) => window.laboratory.results().until >= end, until, { timeout: 60_000 });
  found[name] = { ...typed, again: await readOut(again) };
  await again.close();
  await tab.close();
}
console.log(JSON.stringify({ found, wrong }));
await browser.close();
