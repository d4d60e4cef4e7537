// Types systems into the built page and prints, as JSON, what it shows: node test/typed.mjs PAGE WANTED.json
// A system that is wanted has a name, what is typed (`bracket`, `fields`, ...), a start, and until when it is followed. `mistakes` are
// formulas, `links` addresses that are opened; with `tries` sliders, keys, sizes of text and axe-core are tried, too.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
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
  await tab.goto(`${page}?still=0&quality=low${address}`);
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
  await tab.getByLabel(label, { exact: true }).fill(text);
}

for (const { name, bracket, fields = {}, hamiltonian, parameters = {}, start, until } of wanted.systems) {
  const tab = await opened("#own=1");
  await tab.getByLabel("bracket", { exact: true }).selectOption(bracket);
  for (const [label, text] of Object.entries(fields)) await typeInto(tab, label, text);
  await tab.locator("#hamiltonian").fill("");
  await tab.locator("#hamiltonian").pressSequentially(hamiltonian, { delay: 2 });
  await tab.waitForFunction(() => window.typed.rests(), null, { timeout: 15_000 });
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
const read = (tab) => tab.waitForFunction(() => window.typed.rests(), null, { timeout: 15_000 });
const message = (tab) => tab.evaluate(() => (document.querySelector("#message").hidden ? "" : document.querySelector("#message p").textContent));
const wrongs = (tab) => tab.evaluate(() => [...document.querySelectorAll(".wrong")].filter((one) => !one.hidden).map((one) => ({ text: one.textContent, mark: one.querySelector("pre")?.textContent ?? "" })));
const typedText = (tab) => tab.locator("#hamiltonian").inputValue();

/** What the page says of what is wrong, and what it keeps. */
const mistakes = {};
if (wanted.mistakes.length) {
  const tab = await opened("#own=1&example=heavy-top");
  const before = await tab.evaluate(() => window.laboratory.results().first[0]);
  for (const text of wanted.mistakes) {
    await tab.locator("#hamiltonian").fill(text);
    await read(tab);
    const [said = { text: "", mark: "" }] = await wrongs(tab);
    mistakes[text.slice(0, 40)] = { ...said, kept: (await typedText(tab)) === text, first: (await tab.evaluate(() => window.laboratory.results().first[0])) === before };
  }
  // a wrong formula is in the address, too
  const last = wanted.mistakes[0];
  await tab.locator("#hamiltonian").fill(last);
  await tab.waitForTimeout(700);
  const again = await opened(new URL(tab.url()).hash);
  await again.waitForFunction(() => [...document.querySelectorAll(".wrong")].some((one) => !one.hidden), null, { timeout: 10_000 });
  mistakes.again = { text: await typedText(again), said: (await wrongs(again))[0].text };
  await again.close();
  await tab.close();
}

const links = {};
for (const [name, hash] of Object.entries(wanted.links)) {
  const tab = await opened(hash);
  links[name] = { message: await message(tab), markup: await tab.evaluate(() => document.querySelectorAll("#typing img, #typing script, iframe, #scene img").length), ran: await tab.evaluate(() => window.ran ?? null), shown: await tab.locator("#title").textContent() };
  await tab.close();
}

/** A slider, the time from a letter to the picture, keys, and names that become parameters. */
const tried = {};
if (wanted.tries) {
  const tab = await opened("#own=1&example=henon-heiles");
  const formula = tab.locator("#hamiltonian");
  await formula.focus();
  await formula.press("End");
  // drawn in the plane: in three dimensions a processor without a graphics card draws longer than anything takes here
  await tab.locator('#presets button[data-key="series"]').click();
  await formula.focus();
  await tab.evaluate(() => {
    const watch = (window.watch = { since: 0, waits: [] });
    document.querySelector("#hamiltonian").addEventListener("input", () => (watch.since = performance.now(), (watch.of = window.laboratory.results())), true);
    setInterval(() => {
      const results = window.laboratory.results();
      if (!watch.since || results === watch.of || results.crossings.length === 0) return;
      watch.waits.push(performance.now() - watch.since);
      watch.since = 0;
    }, 2);
  });
  await formula.pressSequentially(" + k*x^4*y^2/1000", { delay: 400 });
  await tab.waitForTimeout(500);
  tried.waits = await tab.evaluate(() => window.watch.waits);
  tried.parameters = await tab.evaluate(() => [...document.querySelectorAll(".parameter > input[type=range]")].map((one) => one.getAttribute("aria-label")));
  const value = () => tab.evaluate(() => window.laboratory.results().first[0]);
  await tab.locator("#controls > .row input").nth(0).fill("1/10");
  await tab.keyboard.press("Enter");
  await tab.waitForTimeout(200);
  tried.before = await value();
  await tab.getByLabel("k", { exact: true }).focus();
  for (let k = 0; k < 10; k++) await tab.keyboard.press("ArrowRight");
  await tab.waitForTimeout(300);
  tried.after = await value();
  tried.k = await tab.getByLabel("k, exact value", { exact: true }).inputValue();
  // a click into the portrait
  const box = await tab.locator("#portrait canvas").last().boundingBox();
  await tab.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await tab.waitForTimeout(200);
  tried.clicked = await tab.evaluate(() => window.laboratory.state().start.map((one) => one.value));
  await tab.close();
}

/** Text sizes, width and what axe-core finds, on a desk and on a phone. */
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const looks = {};
for (const [name, viewport] of wanted.tries ? [["desk", { width: 1440, height: 900 }], ["phone", { width: 390, height: 844 }]] : []) {
  for (const hash of ["#own=1&example=double-pendulum", "#own=1&example=sklyanin"]) {
    const tab = await opened(hash, viewport);
    await tab.locator(".unfolded summary").first().click();
    await tab.waitForTimeout(300);
    await tab.evaluate(axe);
    looks[`${name} ${hash}`] = await tab.evaluate(async () => {
      const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
      const sizes = [...document.querySelectorAll("body *")].filter((one) => [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim()) && one.getClientRects().length && !one.closest("script, style, option, .unseen, .skip"));
      const small = sizes.map((one) => [parseFloat(getComputedStyle(one).fontSize), `${one.tagName} ${one.className} ${one.textContent.slice(0, 30)}`]).filter(([size]) => size < 11);
      return { axe: violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).slice(0, 4).join(", ")}`), small: small.map((one) => one.join(" ")), wide: document.documentElement.scrollWidth - innerWidth };
    });
    await tab.close();
  }
}
console.log(JSON.stringify({ found, wrong, mistakes, links, tried, looks }));
await browser.close();
