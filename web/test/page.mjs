// Drives the built page in Chromium: node test/page.mjs.  Prints what is wrong and exits with 1.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const page = process.env.PAGE ?? `file://${resolve(import.meta.dirname, "../dist/index.html")}`;
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox", "--disable-dev-shm-usage"];
let browser; // of the check that runs: one for all of them once refused to open another tab

/** A page that must neither complain nor ask for anything. */
async function opened(address, options = {}, before = () => undefined) {
  const tab = await browser.newPage({ viewport: { width: 1440, height: 900 }, ...options });
  await tab.addInitScript(before);
  const wrong = [];
  tab.on("pageerror", (error) => wrong.push(error.message));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(data|blob):/.test(request.url()) && !request.url().startsWith(page) && wrong.push(request.url()));
  await tab.goto(page + address);
  return { tab, wrong };
}
const state = (tab) => tab.evaluate(() => window.laboratory.state());
const ready = (tab) => tab.waitForSelector("html[data-ready]", { state: "attached", timeout: 60_000 });

/** What axe-core finds wrong, in words. */
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
async function violations(tab) {
  await tab.evaluate(axe);
  const { violations: found } = await tab.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return found.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, any }) => `${target} ${any[0]?.message ?? ""}`).join("; ")}`);
}
/** What a choice in the menu of a panel saves. */
async function savedOf(tab, panel, choice) {
  const waiting = tab.waitForEvent("download");
  await tab.locator(`#${panel} .menu summary`).click();
  await tab.locator(`#${panel} .menu button`, { hasText: choice }).click();
  const download = await waiting;
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}
const tourOf = (...steps) => ({ tour: 1, title: "a tour", about: "of a test", steps });
const PRESETS = ["lagrange", "twisted-lagrange", "kovalevskaya", "twisted-kovalevskaya", "charged", "sticky", "collinear", "two-field"];

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
    assert.deepEqual(Object.keys(await values()), Object.keys(wanted));
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
  async "axe-core finds nothing wrong in any theme, view or width"() {
    for (const theme of ["light", "dark", "projector"]) {
      for (const [search, width, hash] of [["", 1440, ""], ["", 390, ""], ["&embed=1", 800, ""], ["", 1440, "&frame=momentum"], ["", 1440, "&frame=rod"]]) {
        const { tab, wrong } = await opened(`?still=0&quality=low${search}#v=1&preset=twisted-lagrange&theme=${theme}${hash}`, { viewport: { width, height: 900 } });
        await ready(tab);
        assert.deepEqual(await violations(tab), [], `${theme} ${search} ${width} ${hash}`);
        if (width === 1440 && !hash) {
          for (const key of ["?", "h"]) {
            await tab.keyboard.press(key);
            await tab.waitForTimeout(300);
            assert.deepEqual(await violations(tab), [], `${theme}, after ${key}`);
            if (key === "h") {
              await tab.keyboard.press("Enter");
              assert.deepEqual(await violations(tab), [], `${theme}, in a tour`);
            }
            await tab.keyboard.press("Escape");
          }
        }
        assert.deepEqual(wrong, []);
        await tab.close();
      }
    }
  },
  async "the tab key reaches every control, and what has the focus is seen"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=lagrange&theme=dark");
    await ready(tab);
    const wanted = await tab.evaluate(() => {
      const all = document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex='0']");
      const reachable = [...all].filter((one) => one.checkVisibility({ checkVisibilityCSS: true }) && !one.disabled);
      reachable.forEach((one, k) => (one.dataset.walk = String(k)));
      return reachable.length;
    });
    const seen = new Set();
    for (let k = 0; k < wanted + 20 && seen.size < wanted; k++) {
      await tab.keyboard.press("Tab");
      const found = await tab.evaluate(() => {
        const one = document.activeElement;
        const { outlineStyle, outlineWidth } = getComputedStyle(one);
        const box = one.getBoundingClientRect();
        const inside = box.bottom > 0 && box.right > 0 && box.top < innerHeight && box.left < innerWidth;
        return { walk: one.dataset.walk, html: one.outerHTML.slice(0, 80), shown: outlineStyle !== "none" && parseFloat(outlineWidth) >= 2 && inside };
      });
      if (found.walk === undefined) continue;
      assert.ok(found.shown, `the focus is not seen on ${found.html}`);
      seen.add(found.walk);
    }
    const missed = await tab.evaluate((reached) => [...document.querySelectorAll("[data-walk]")].filter((one) => !reached.includes(one.dataset.walk)).map((one) => one.outerHTML.slice(0, 90)), [...seen]);
    assert.deepEqual(missed, []);
    console.log(`${wanted} controls`);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "the left column does not scroll, and no preset sticks out, in any theme"() {
    for (const theme of ["light", "dark", "projector"]) {
      const { tab } = await opened(`?still=0&quality=low#v=1&preset=lagrange&theme=${theme}`);
      for (const [k, preset] of PRESETS.entries()) {
        await tab.keyboard.press(String(k + 1));
        await tab.waitForFunction((key) => window.laboratory.state().preset === key && window.laboratory.results().names.length > 0, preset);
        await tab.waitForTimeout(150);
        const [scroll, height, wide, room] = await tab.evaluate(() => {
          const [column, nav] = ["controls", "presets"].map((id) => document.getElementById(id));
          return [column.scrollHeight, column.clientHeight, nav.scrollWidth, nav.clientWidth];
        });
        assert.ok(scroll <= height, `${theme}, ${preset}: the column needs ${scroll} of ${height} pixels`);
        assert.ok(wide <= room, `${theme}: the presets need ${wide} of ${room} pixels`);
      }
      await tab.close();
    }
  },
  async "the axes of a section fit its crossings"() {
    for (let k = 0; k < 4; k++) {
      const { tab } = await opened("?still=600&quality=low#v=1&preset=kovalevskaya&theme=light");
      await ready(tab);
      await tab.waitForTimeout(200);
      const [range, wanted] = await tab.evaluate(() => {
        const seen = window.laboratory.results().crossings.rows.map((row) => row[0]);
        return [window.laboratory.sectionRange(), [Math.min(...seen), Math.max(...seen)]];
      });
      assert.ok(range[1] - range[0] < 1.5 * (wanted[1] - wanted[0]), `${range} for ${wanted}`);
      await tab.close();
    }
  },
  async "a section of tops is filled by many orbits, seen in part, and saved"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=kovalevskaya&theme=light");
    await ready(tab);
    await tab.getByLabel("Orbits in the section").selectOption("10");
    await tab.waitForFunction(() => window.laboratory.fan().finished && window.laboratory.fan().orbits.length === 10, null, { timeout: 60_000 });
    // energy and Casimirs of all orbits are those of the start
    const spread = await tab.evaluate(() => {
      const { start, parameters } = window.laboratory.state();
      const [l, alpha] = [0, 3].map((k) => start.slice(k, k + 3).map((one) => one.value));
      const [inertia, a] = [0, 3].map((k) => parameters.slice(k, k + 3).map((one) => one.value));
      const values = (state) => {
        const [L, A, B] = [0, 3, 6].map((k) => state.slice(k, k + 3));
        const dot = (one, other) => one.reduce((sum, x, k) => sum + x * other[k], 0);
        return [dot(L, L.map((x, k) => x / inertia[k])) / 2 + dot(A, a), dot(B, B), dot(A, B)];
      };
      const wanted = values([...l, ...alpha, ...start.slice(6).map((one) => one.value)]);
      return window.laboratory.fan().orbits.flatMap(({ crossings }) => values([...crossings.slice(-9)]).map((value, k) => Math.abs(value - wanted[k])));
    });
    assert.ok(Math.max(...spread) < 1e-10, `${Math.max(...spread)}`);
    assert.match(await tab.evaluate(() => new Promise((done) => setTimeout(() => done(location.hash), 600))), /&fan=10&/);
    const range = () => tab.evaluate(() => window.laboratory.sectionRange());
    const whole = await range();
    const canvas = tab.locator("#section canvas").last();
    const box = await canvas.boundingBox();
    await tab.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    await tab.mouse.wheel(0, -600);
    await tab.waitForFunction((low) => window.laboratory.sectionRange()[0] > low, whole[0]);
    const part = await range();
    assert.ok(part[1] - part[0] < 0.6 * (whole[1] - whole[0]) && part[1] < whole[1], `${part} of ${whole}`);
    await tab.mouse.down();
    await tab.mouse.move(box.x + 0.5 * box.width + 40, box.y + 0.5 * box.height, { steps: 4 });
    await tab.mouse.up();
    // what is dragged to the right shows what is on the left
    await tab.waitForFunction((low) => window.laboratory.sectionRange()[0] < low, part[0]);
    assert.deepEqual((await state(tab)).added, [], "a drag adds no orbit");
    const table = (await savedOf(tab, "section", "CSV")).bytes.toString().trimEnd().split("\n").filter((line) => !line.startsWith("#"));
    assert.equal(table[0].split(",").slice(0, 4).join(), "orbit,verdict,exponent,l1");
    assert.equal(table.length - 1, await tab.evaluate(() => window.laboratory.fan().orbits.reduce((sum, { count }) => sum + count, 0)));
    const svg = (await savedOf(tab, "section", "SVG")).bytes.toString();
    assert.match(svg, /<title>Poincaré section: .*\d+ regular, \d+ chaotic, \d+ undecided<\/title>/);
    await canvas.focus();
    const isWhole = (wanted) => String(window.laboratory.sectionRange()) === String(wanted);
    await tab.keyboard.press("0");
    await tab.waitForFunction(isWhole, whole);
    await tab.keyboard.press("+");
    await tab.waitForFunction((low) => window.laboratory.sectionRange()[0] > low, whole[0]);
    await tab.locator("#section .whole").click();
    await tab.waitForFunction(isWhole, whole);
    assert.deepEqual(await violations(tab), []);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a pendulum that is typed moves on its level curves, and a click starts another orbit; both are saved"() {
    const { tab, wrong } = await opened("?still=0&quality=low#own=1");
    await tab.locator("#hamiltonian").waitFor();
    await tab.getByLabel("bracket", { exact: true }).selectOption("canonical");
    await tab.getByLabel("coordinates", { exact: true }).fill("q");
    await tab.getByLabel("angles", { exact: true }).fill("q");
    await tab.locator("#hamiltonian").fill("p_q^2/2 - w*cos(q)");
    await tab.waitForFunction(() => window.typed.rests() && window.laboratory.results().levels, null, { timeout: 30_000 });
    const { ranges, size, off } = await tab.evaluate(() => {
      const { ranges, size, values } = window.laboratory.results().levels;
      const at = (k, i) => ranges[k][0] + ((ranges[k][1] - ranges[k][0]) * i) / (size - 1);
      const off = [...values].map((value, k) => Math.abs(value - (at(1, Math.floor(k / size)) ** 2 / 2 - Math.cos(at(0, k % size)))));
      return { ranges, size, off: Math.max(...off) };
    });
    assert.deepEqual(ranges[0], [-Math.PI, Math.PI]);
    assert.equal(size, 161);
    assert.ok(off < 1e-14 && ranges[1][1] > 2 && ranges[1][1] < 4, `${off}, ${ranges[1]}`);
    await tab.waitForFunction(() => document.querySelector("#portrait > p").textContent === "level curves of H");
    const svg = (await savedOf(tab, "portrait", "SVG")).bytes.toString();
    assert.match(svg, /<desc>[^<]*p_q\^2\/2 - w\*cos\(q\)/);
    assert.ok((svg.match(/M[-\d.]+ [-\d.]+L/g) ?? []).length > 1000, "curves");
    const canvas = tab.locator("#portrait canvas").last();
    const { width, height } = await canvas.boundingBox();
    await canvas.click({ position: { x: 0.5 * width, y: 0.3 * height } });
    const start = (await state(tab)).start.map((one) => one.value);
    assert.ok(Math.abs(start[0]) < 0.5 && start[1] > 0, `${start}`);
    assert.match((await savedOf(tab, "section", "CSV")).bytes.toString(), /\n# start: q = .*\n# method: Taylor, tol = 1e-15\n# address: #own=1&/);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a state is handed on by its address, its code, a line and a file"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=sticky&theme=light");
    await ready(tab);
    await tab.locator("#share").click();
    const dialog = tab.locator("#sharing");
    assert.match(await dialog.innerText(), /on your machine/);
    assert.deepEqual(await violations(tab), []);
    const [url, line] = await dialog.locator("textarea").evaluateAll((all) => all.map((one) => one.value));
    assert.match(url, /^file:.*index\.html#v=1&preset=sticky&/);
    assert.match(line, /^<iframe src="file:[^"]*index\.html\?embed=1#v=1&amp;preset=sticky&amp;[^"]*" title="Sticky orbit, /);
    const waiting = tab.waitForEvent("download");
    await dialog.getByText("Save this page as one file").click();
    const file = `${await (await waiting).path()}.html`;
    writeFileSync(file, readFileSync(file.slice(0, -5)));
    await tab.close();
    const alone = await browser.newPage();
    alone.on("pageerror", (error) => wrong.push(error.message));
    alone.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
    await alone.goto(`file://${file}?still=0&quality=low`);
    await ready(alone);
    assert.equal((await state(alone)).preset, "sticky");
    await alone.close();
    // a frame in a page of somebody else
    const outer = await browser.newPage({ viewport: { width: 800, height: 460 } });
    outer.on("pageerror", (error) => wrong.push(error.message));
    const page = `${file}.outer.html`;
    writeFileSync(page, line);
    await outer.goto(`file://${page}`);
    await outer.frameLocator("iframe").locator("#section canvas").last().waitFor();
    const frame = outer.frames()[1];
    await frame.waitForFunction(() => window.laboratory?.results().crossings.length > 20, null, { timeout: 60_000 });
    assert.equal(await frame.evaluate(() => window.laboratory.state().preset), "sticky");
    assert.equal(await frame.locator("header").evaluate((one) => one.getBoundingClientRect().height) <= 1, true);
    assert.deepEqual(wrong, []);
    await outer.close();
  },
  async "pictures and tables are saved"() {
    const { tab, wrong } = await opened("?still=600&quality=low#v=1&preset=charged&theme=light");
    await ready(tab);
    const saved = (panel, choice) => savedOf(tab, panel, choice);
    const rows = { section: "crossings", lyapunov: "exponent", drift: "drift" };
    for (const panel of ["section", "portrait", "lyapunov", "drift"]) {
      const svg = (await saved(panel, "SVG")).bytes.toString();
      const problem = await tab.evaluate((text) => new DOMParser().parseFromString(text, "image/svg+xml").querySelector("parsererror")?.textContent ?? null, svg);
      assert.equal(problem, null);
      assert.match(svg, /<desc>liepoisson \d+\.\d+\.\d+.*a1 = 1, .*alpha1 = 4\/5/s);
      if (panel === "section") {
        const count = await tab.evaluate(() => window.laboratory.results().crossings.length);
        assert.ok((svg.match(/A1\.[59] /g) ?? []).length >= 2 * count, "a circle for each crossing");
      }
      const { name, bytes } = await saved(panel, "PNG");
      assert.match(name, /^charged-.*\.png$/);
      assert.equal(bytes.subarray(1, 4).toString(), "PNG");
      const lines = (await saved(panel, "CSV")).bytes.toString().trimEnd().split("\n");
      const table = lines.filter((line) => !line.startsWith("#"));
      const columns = table[0].split(",").length;
      assert.ok(table.every((line) => line.split(",").length === columns) && table.length > 20);
      assert.ok(lines.some((line) => line.startsWith("# top: I1 = 1, I2 = 3/2")));
      if (panel in rows) {
        const kept = await tab.evaluate((name) => window.laboratory.results()[name].times.length, rows[panel]);
        assert.equal(table.length - 1, kept);
      }
    }
    assert.match((await saved("scene", "PNG")).name, /^charged-space\.png$/);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "without a clipboard the lines of Python are shown"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=sticky&theme=light");
    await tab.evaluate(() => Object.defineProperty(navigator, "clipboard", { value: { writeText: () => Promise.reject(new Error("no")) } }));
    await tab.keyboard.press("p");
    assert.match(await tab.locator("#lines textarea").inputValue(), /lp\.Top\(inertia=\(2, 2, "6\/5"\)/);
    assert.deepEqual(await violations(tab), []);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "the tours go their steps by keys, and leaving one early brings the old state back"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=collinear&theme=light");
    await ready(tab);
    await tab.keyboard.press("h");
    const count = await tab.locator("#tours li button").count();
    assert.equal(count, 5);
    await tab.keyboard.press("Escape");
    for (let tour = 0; tour < count; tour++) {
      await tab.keyboard.press("h");
      for (let k = 0; k < tour; k++) await tab.keyboard.press("Tab");
      await tab.keyboard.press("Enter");
      for (let k = 0; k < 5; k++) {
        assert.match(await tab.locator("#tour h2").innerText(), new RegExp(`^${k + 1} of 5`));
        assert.equal(await tab.locator(".pointed").count(), 1);
        const { preset, theme, playing } = await state(tab);
        assert.notEqual(preset, "collinear");
        assert.deepEqual([theme, playing], ["light", false]);
        if (k < 4) await tab.keyboard.press(k % 2 ? "ArrowRight" : "Enter");
      }
      await tab.keyboard.press("Escape");
      assert.equal((await state(tab)).preset, "collinear");
      assert.equal(await tab.locator("#tour[open]").count(), 0);
    }
    await tab.keyboard.press("h");
    await tab.locator("#tours li button").last().click();
    for (let k = 0; k < 5; k++) await tab.keyboard.press("Enter");
    assert.equal((await state(tab)).preset, "twisted-kovalevskaya");
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a tour of another page is a link to it, which goes its steps there and covers nothing; what was changed has none"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=collinear&theme=light");
    await ready(tab);
    await tab.keyboard.press("h");
    await tab.locator("#tours a", { hasText: "From order to chaos" }).click();
    await tab.locator("#tour[open]").waitFor();
    const steps = [];
    for (let k = 0; k < 5; k++) {
      steps.push([await tab.locator("#tour h2").innerText(), (await state(tab)).start[1].value]);
      await tab.keyboard.press("ArrowRight");
    }
    assert.deepEqual(steps.map(([title]) => title.slice(0, 6)), [1, 2, 3, 4, 5].map((k) => `${k} of 5`));
    assert.deepEqual(steps.map(([, y]) => y), [0.3, -0.1, 0.1, -0.2, -0.1]);
    await tab.keyboard.press("h");
    await tab.locator("#tours button", { hasText: "From order to chaos" }).click();
    const [box, drift] = [await tab.locator("#tour").boundingBox(), await tab.locator("#drift").boundingBox()];
    assert.ok(box.y >= drift.y + drift.height, `${box.y} ${drift.y + drift.height}`);
    await tab.keyboard.press("Escape");
    await tab.locator("#hamiltonian").fill("(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y");
    await tab.waitForFunction(() => window.typed.rests());
    await tab.locator("#guide").click();
    assert.equal(await tab.locator("#tours button", { hasText: "From order to chaos" }).count(), 0);
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "arrow keys change the last digit of an entry, E hands the state on, and of a wrong formula the old charts fade"() {
    const { tab, wrong } = await opened("?still=0&quality=low#own=1&example=henon-heiles");
    await tab.locator("#hamiltonian").waitFor();
    await tab.waitForFunction(() => window.typed.rests() && window.laboratory);
    const entry = tab.getByLabel("p_x, exact value");
    await entry.fill("0.40");
    for (const key of ["ArrowUp", "ArrowUp", "ArrowDown", "ArrowUp"]) await entry.press(key);
    assert.deepEqual((await state(tab)).start[2], { text: "0.42", value: 0.42 });
    await entry.blur();
    await tab.keyboard.press("e");
    assert.equal(await tab.locator("#sharing[open]").count(), 1);
    await tab.keyboard.press("Escape");
    const seen = (opacity) => tab.waitForFunction((opacity) => getComputedStyle(document.querySelector("#section")).opacity === opacity, opacity);
    await tab.locator("#hamiltonian").fill("p_x^2 +");
    await seen("0.4");
    await tab.locator("#hamiltonian").fill("(p_x^2 + p_y^2 + x^2 + y^2)/2");
    await seen("1");
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "a tour of a teacher is taken from a file and from a link, and shown as text"() {
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=collinear&theme=light");
    await ready(tab);
    await tab.keyboard.press("h");
    const markup = "<img src=x onerror=alert(1)> <b>α</b>";
    const text = JSON.stringify(tourOf({ title: markup, words: markup, at: "drift", state: `${page}#v=1&preset=sticky&theme=dark` }));
    await tab.locator("#tours input").setInputFiles({ name: "mine.json", mimeType: "application/json", buffer: Buffer.from(text) });
    await tab.locator("#tour[open]").waitFor();
    const seen = async ({ tab }) => [await tab.locator("#tour h2").innerText(), await tab.locator("#tour p").innerText(), await tab.locator("#tour :is(img, b)").count(), (await state(tab)).preset];
    assert.deepEqual(await seen({ tab }), [`1 of 1: ${markup}`, markup, 0, "sticky"]);
    await tab.evaluate(() => Object.defineProperty(navigator, "clipboard", { value: { writeText: async (text) => void (window.copied = text) } }));
    await tab.locator("#tour button", { hasText: "Copy link" }).click();
    const link = await tab.evaluate(() => window.copied);
    const other = await opened(`?still=0&quality=low${link.slice(link.indexOf("#"))}`);
    await other.tab.locator("#tour[open]").waitFor();
    assert.deepEqual(await seen(other), await seen({ tab }));
    await other.tab.keyboard.press("Escape");
    assert.equal((await state(other.tab)).preset, "twisted-kovalevskaya");
    assert.deepEqual([...wrong, ...other.wrong], []);
    await tab.close();
    await other.tab.close();
  },
  async "a hostile tour does nothing but give a message"() {
    const step = { title: "a", words: "b", at: "scene", state: "v=1&preset=lagrange" };
    const hostile = {
      "no JSON": "<img src=x onerror=alert(1)>",
      'unknown part "__proto__"': `{"__proto__":{"shown":1},"tour":1,"title":"a","about":"b","steps":[]}`,
      'unknown part "constructor"': JSON.stringify({ ...tourOf(step), constructor: 1 }),
      "is one of scene": JSON.stringify(tourOf({ ...step, at: "#keys, body" })),
      "must have 1 to 600 characters; got 5000": JSON.stringify(tourOf({ ...step, words: "x".repeat(5000) })),
      "control character": JSON.stringify(tourOf({ ...step, words: "\u202Egnp.exe" })),
      "a list of 1 to 12; got 13": JSON.stringify({ ...tourOf(step), steps: Array(13).fill(step) }),
      "the state of step 2 cannot be shown": JSON.stringify({ ...tourOf(step), steps: [step, { ...step, state: "v=1&theme=<script>" }] }),
      "it is too long": "x".repeat(300_000),
      "for the page of henon-heiles": JSON.stringify({ ...tourOf(step), system: "henon-heiles" }),
    };
    const { tab, wrong } = await opened("?still=0&quality=low#v=1&preset=collinear&theme=light");
    await ready(tab);
    const before = await state(tab);
    for (const [why, text] of Object.entries(hostile)) {
      await tab.evaluate(() => document.getElementById("guide").click());
      await tab.locator("#tours input").setInputFiles({ name: "hostile.json", mimeType: "application/json", buffer: Buffer.from(text) });
      await tab.locator("#message").waitFor();
      const message = await tab.locator("#message").innerText();
      assert.ok(message.includes(why) && /tour of this file cannot be shown/.test(message), `${why}: ${message}`);
      assert.ok(message.length < 500, `${message.length} characters`);
      assert.deepEqual(await state(tab), before);
      assert.deepEqual(await tab.evaluate(() => [document.querySelectorAll("dialog[open], img, script:not([type])").length, {}.shown ?? null]), [0, null]);
      await tab.locator("#message button").click();
    }
    for (const link of ["tour=%E0%A4%A", "tour=", `tour=${"x".repeat(800_000)}`]) {
      const other = await opened(`?still=0&quality=low#${link}`);
      await other.tab.locator("#message").waitFor();
      assert.match(await other.tab.locator("#message").innerText(), /tour of this link cannot be shown/);
      assert.equal((await state(other.tab)).preset, "twisted-kovalevskaya");
      assert.deepEqual(other.wrong, []);
      await other.tab.close();
    }
    assert.deepEqual(wrong, []);
    await tab.close();
  },
  async "no text is smaller than 11 pixels, and each axis has two numbers, in any theme and width"() {
    const drawn = () => {
      window.drawn = [];
      const { fillText } = CanvasRenderingContext2D.prototype;
      CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
        const panel = this.canvas.closest(".panel")?.id;
        if (panel) window.drawn.push({ panel, text, x, bottom: this.canvas.clientHeight - y, size: parseFloat(/([\d.]+)px/.exec(this.font)[1]) });
        fillText.call(this, text, x, y, ...rest);
      };
    };
    for (const theme of ["light", "dark", "projector"]) {
      for (const [width, height] of [[1440, 900], [1000, 620], [390, 844]]) {
        const { tab } = await opened(`?still=60&quality=low#v=1&preset=twisted-lagrange&theme=${theme}`, { viewport: { width, height } }, drawn);
        await ready(tab);
        const where = `${theme}, ${width}`;
        for (const key of [null, "?", "h"]) {
          if (key) await tab.keyboard.press(key);
          await tab.waitForTimeout(300);
          const small = await tab.evaluate(() => {
            const [found, walker] = [[], document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT)];
            while (walker.nextNode()) {
              const { data, parentElement } = walker.currentNode;
              const size = parseFloat(getComputedStyle(parentElement).fontSize);
              if (data.trim() && parentElement.checkVisibility() && size < 11) found.push(`${data.trim().slice(0, 20)}: ${size}`);
            }
            return found;
          });
          assert.deepEqual(small, [], where);
          if (key) await tab.keyboard.press("Escape");
        }
        const texts = await tab.evaluate(() => window.drawn);
        assert.deepEqual(texts.filter(({ size }) => size < 11), [], where);
        for (const panel of ["section", "portrait", "lyapunov", "drift"]) {
          const numbers = texts.filter((one) => one.panel === panel && /^−?[\d.]+$/.test(one.text));
          const [across, up] = [numbers.filter(({ bottom }) => bottom < 38), numbers.filter(({ bottom, x }) => bottom > 30 && x < 48)];
          for (const axis of [across, up]) assert.ok(new Set(axis.map((one) => `${one.x} ${one.bottom}`)).size >= 2, `${where}, ${panel}: ${axis.map(({ text }) => text)}`);
        }
        await tab.close();
      }
    }
  },
  async "on a phone the twist is in reach without a scroll, and the rest when it is asked for"() {
    for (const theme of ["light", "dark", "projector"]) {
      const { tab, wrong } = await opened(`?still=0&quality=low#v=1&preset=twisted-lagrange&theme=${theme}`, { viewport: { width: 390, height: 844 } });
      await ready(tab);
      const slider = tab.locator('#controls input[type="range"]').first();
      const { y, height } = await slider.boundingBox();
      assert.ok(y > 0 && y + height < 844, `${theme}: the slider is at ${y}`);
      await slider.press("Home");
      assert.equal((await state(tab)).parameters[9].value, 0);
      const moment = tab.locator('input[aria-label="I₁, exact value"]');
      assert.equal(await moment.isVisible(), false);
      await tab.locator(".more").press("Enter");
      assert.equal(await moment.isVisible(), true);
      assert.deepEqual(wrong, []);
      await tab.close();
    }
  },
  async "the help opens at its head, in any size"() {
    for (const [width, height] of [[1440, 900], [1000, 500], [390, 844]]) {
      const { tab } = await opened("?still=0&quality=low#v=1&preset=lagrange", { viewport: { width, height } });
      await ready(tab);
      await tab.keyboard.press("?");
      assert.equal(await tab.locator("#keys").evaluate((one) => one.scrollTop), 0);
      const { y } = await tab.locator("#keys h2").boundingBox();
      assert.ok(y > 0 && y < height / 2, `the head is at ${y}`);
      await tab.keyboard.press("Escape");
      await tab.close();
    }
  },
  async "vectors are seen outside the body"() {
    // the field that stands still is drawn shorter, the longer the other one becomes
    const { tab } = await opened("?still=2490&quality=low#v=1&preset=twisted-lagrange&theme=light");
    await ready(tab);
    const [radius, [, , beta]] = await tab.evaluate(() => window.laboratory.sizes());
    assert.ok(beta > radius, `${beta} and ${radius}`);
    await tab.close();
  },
  async "numbers are told to those who do not see the charts"() {
    const { tab } = await opened("?still=60&quality=low#v=1&preset=twisted-kovalevskaya");
    await ready(tab);
    await tab.waitForTimeout(300);
    const label = (panel) => tab.locator(`#${panel} canvas`).last().getAttribute("aria-label");
    assert.match(await label("lyapunov"), /0\.130 at t = 10,240/);
    assert.match(await label("drift"), /at most \d.*e-1\d up to t = 10,/);
    assert.match(await label("section"), /1,246 crossings that rise through ℓ₃ = 0/);
    assert.match(await tab.locator("#numbers").textContent(), /^t = 1\.00: angular momentum (−?\d\.\d{3}(, )?){3}; first field/);
    await tab.close();
  },
  async "embedded, only the scene and the section are seen"() {
    for (const [width, height] of [[900, 420], [640, 360], [390, 700]]) {
      const { tab, wrong } = await opened("?still=0&quality=low&embed=1#v=1&preset=charged&theme=dark", { viewport: { width, height } });
      await ready(tab);
      const seen = await tab.evaluate(() => [...document.querySelectorAll("header, main > *")].filter((one) => one.getBoundingClientRect().height > 1).map((one) => one.id));
      assert.deepEqual(seen, ["scene", "section"]);
      assert.equal(await tab.evaluate(() => document.documentElement.scrollWidth), width);
      assert.deepEqual(wrong, []);
      await tab.close();
    }
  },
  async "with reduced motion nothing moves until it is asked to"() {
    const { tab, wrong } = await opened("?quality=low#v=1&preset=charged&theme=dark", { reducedMotion: "reduce" });
    await tab.waitForFunction(() => window.laboratory.results().top.end > 10);
    await tab.waitForTimeout(500);
    assert.equal((await state(tab)).time, 0);
    await tab.keyboard.press(" ");
    await tab.waitForFunction(() => window.laboratory.state().time > 0);
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
  async "the top moves in every view, and our own code takes little of a frame"() {
    for (const [quality, frame] of [["low", "space"], ["full", "space"], ["full", "momentum"], ["full", "rod"]]) {
      // nothing is rasterised: a processor that does what a graphics card is for would be all that is measured
      const { tab, wrong } = await opened(`?quality=${quality}#v=1&preset=twisted-kovalevskaya&frame=${frame}`, {}, () => {
        for (const name of ["drawArrays", "drawElements", "drawRangeElements"]) WebGL2RenderingContext.prototype[name] = () => undefined;
      });
      await tab.waitForFunction(() => window.laboratory.results().finished, null, { timeout: 60_000 });
      await tab.waitForTimeout(2500);
      const first = await tab.evaluate(() => window.laboratory.firstPicture());
      const { time } = await state(tab);
      const times = (await tab.evaluate(() => window.laboratory.frameTimes())).sort((a, b) => a - b);
      const at = (part) => times[Math.floor(part * (times.length - 1))].toFixed(1);
      console.log(`${quality}, ${frame}: first picture after ${first.toFixed(0)} ms; milliseconds of our own code in a frame: median ${at(0.5)}, 9 of 10 below ${at(0.9)}`);
      assert.ok(time > 0.1);
      assert.ok(Number(at(0.5)) < 10, "more than half of a frame of 60 in a second");
      assert.deepEqual(wrong, []);
      await tab.close();
    }
  },
  async "where the processor draws the scene, it is drawn simply"() {
    const { tab } = await opened("?still=0#v=1&preset=lagrange");
    await ready(tab);
    assert.equal(await tab.evaluate(() => window.laboratory.isLowQuality()), true);
    await tab.close();
  },
};

checks["without WebGL there is a message, and the charts go on"] = async () => {
  const bare = await chromium.launch({ executablePath, args: ["--disable-3d-apis", "--no-sandbox"] });
  const tab = await bare.newPage();
  await tab.goto(`${page}?still=0#v=1&preset=kovalevskaya`);
  await ready(tab);
  assert.match(await tab.locator("#scene .none").innerText(), /no WebGL/);
  assert.ok((await tab.evaluate(() => window.laboratory.results().crossings.length)) > 1000);
  await bare.close();
};

let failed = 0;
// node test/page.mjs WORDS: only the checks that have them in their name
for (const [name, check] of Object.entries(checks)) {
  if (!name.includes(process.argv[2] ?? "")) continue;
  browser = await chromium.launch({ executablePath, args });
  try {
    await check();
    console.log(`ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`not ok: ${name}\n${error.stack}`);
  }
  await browser.close();
}
process.exit(failed ? 1 : 0);
