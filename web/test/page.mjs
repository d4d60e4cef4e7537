// Drives the built page in Chromium: node test/page.mjs.  Prints what is wrong and exits with 1.

import assert from "node:assert/strict";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const page = process.env.PAGE ?? `file://${resolve(import.meta.dirname, "../dist/index.html")}`;
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });

/** A page that must neither complain nor ask for anything. */
async function opened(address, options = {}) {
  const tab = await browser.newPage({ viewport: { width: 1440, height: 900 }, ...options });
  const wrong = [];
  tab.on("pageerror", (error) => wrong.push(error.message));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(data|blob):/.test(request.url()) && !request.url().startsWith(page) && wrong.push(request.url()));
  await tab.goto(page + address);
  return { tab, wrong };
}
const state = (tab) => tab.evaluate(() => window.laboratory.state());
const ready = (tab) => tab.waitForSelector("html[data-ready]", { state: "attached", timeout: 60_000 });

const checks = {
  async "an address that is no address gives a message, and is never markup"() {
    for (const hash of ["v=9", "v=1&theme=<img src=x onerror=alert(1)>", "v=1&start=1,2", "v=1&top=0,0,0,0,0,0,0,0,0,0"]) {
      const { tab, wrong } = await opened(`?still=0#${encodeURI(hash)}`);
      const message = tab.locator("#message");
      await message.waitFor();
      assert.match(await message.innerText(), /cannot be read/);
      assert.equal(await tab.locator("img").count(), 0);
      assert.equal((await state(tab)).preset, "twisted-kovalevskaya");
      assert.deepEqual(wrong, []);
      await tab.close();
    }
  },
  async "keys do what the help says"() {
    const { tab, wrong } = await opened("?still=60&quality=low#v=1&preset=lagrange&theme=light");
    await ready(tab);
    await tab.keyboard.press("f");
    await tab.keyboard.press("g");
    await tab.keyboard.press("t");
    let now = await state(tab);
    assert.deepEqual([now.view.frame, now.view.shadow, now.theme], ["body", false, "dark"]);
    await tab.keyboard.press("4");
    now = await state(tab);
    assert.equal(now.preset, "twisted-kovalevskaya");
    await tab.keyboard.press("?");
    assert.equal(await tab.locator("dialog[open]").count(), 1);
    await tab.keyboard.press("Escape");
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a crossing can be chosen and started from by keys"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=twisted-kovalevskaya");
    await ready(tab);
    await tab.locator("#section canvas").last().focus();
    await tab.keyboard.press("ArrowRight");
    assert.match(await tab.locator("#said").innerText(), /crossing 1 of/);
    const wanted = await tab.evaluate(() => [...window.laboratory.results().crossings.rows[0]]);
    await tab.keyboard.press("Enter");
    const now = await state(tab);
    assert.deepEqual(now.start.map((one) => one.value), wanted);
    await tab.waitForTimeout(600);
    const again = await opened(`?still=0&quality=low${await tab.evaluate(() => location.hash)}`);
    assert.deepEqual((await state(again.tab)).start.map((one) => one.value), wanted);
    assert.deepEqual([...wrong, ...again.wrong], []);
    await tab.close();
    await again.tab.close();
  },
  async "an exact entry is taken, and a wrong one is refused"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=lagrange");
    const entry = tab.locator('input[aria-label="ε, exact value"]');
    await entry.fill("1/3");
    await entry.press("Enter");
    assert.equal((await state(tab)).parameters[9].text, "1/3");
    await entry.fill("one");
    await entry.press("Enter");
    assert.match(await tab.locator("#message").innerText(), /not a number/);
    assert.equal((await state(tab)).parameters[9].text, "1/3");
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "values of energy and Casimirs are reached, and impossible ones give a message"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=charged");
    await ready(tab);
    const entry = (name) => tab.locator(`input[aria-label="${name}, value that the start is to have"]`);
    await entry("H").fill("6/5");
    await entry("C₃").fill("1.25");
    await entry("C₃").press("Enter");
    await tab.waitForFunction(() => window.laboratory.state().preset === null);
    await ready(tab);
    const values = () => tab.evaluate(() => Object.fromEntries(window.laboratory.results().names.map((name, k) => [name, window.laboratory.results().first[k]])));
    const wanted = { H: 6 / 5, C1: 1, C2: 0, C3: 1.25 };
    for (const [name, value] of Object.entries(await values())) assert.ok(Math.abs(value - wanted[name]) < 1e-13, `${name} = ${value}, wanted ${wanted[name]}`);
    const { start } = await state(tab);
    await entry("C₃").fill("-1");
    await entry("C₃").press("Enter");
    await tab.locator("#message").waitFor();
    assert.match(await tab.locator("#message").innerText(), /No state with .*C₃ = -1.*may exclude one another/);
    assert.deepEqual((await state(tab)).start, start);
    assert.equal(await entry("C₃").evaluate((one) => one === document.activeElement), true);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a phone has one column, and nothing sticks out"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=charged", { viewport: { width: 390, height: 844 } });
    await ready(tab);
    assert.equal(await tab.evaluate(() => document.documentElement.scrollWidth), 390);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "the top moves, and our own code takes little of a frame"() {
    const { tab, wrong } = await opened("?quality=low#v=1&preset=twisted-kovalevskaya");
    await tab.waitForFunction(() => window.laboratory.results().finished, null, { timeout: 60_000 });
    await tab.waitForTimeout(4000);
    const { time } = await state(tab);
    const times = (await tab.evaluate(() => window.laboratory.frameTimes())).sort((a, b) => a - b);
    console.log(`t = ${time.toFixed(2)}; milliseconds of a frame: median ${times[times.length >> 1].toFixed(1)}, longest ${times.at(-1).toFixed(1)}`);
    assert.ok(time > 0.5);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
};

checks["without WebGL there is a message, and the charts go on"] = async () => {
  const bare = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--disable-3d-apis", "--no-sandbox"] });
  const tab = await bare.newPage();
  await tab.goto(`${page}?still=0#v=1&preset=kovalevskaya`);
  await ready(tab);
  assert.match(await tab.locator("#scene .none").innerText(), /no WebGL/);
  assert.ok((await tab.evaluate(() => window.laboratory.results().crossings.length)) > 1000);
  await bare.close();
};

let failed = 0;
for (const [name, check] of Object.entries(checks)) {
  try {
    await check();
    console.log(`ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`not ok: ${name}\n${error.stack}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
