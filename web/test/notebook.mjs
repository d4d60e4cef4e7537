// Drives the widget in a real notebook: node test/notebook.mjs jupyter|marimo URL FOLDER.
// Prints, as JSON, what the cells said after each thing that was done in the page, and writes pictures into the folder.

import { chromium } from "playwright-core";

const [kind, url, folder] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox", "--disable-dev-shm-usage"];
const browser = await chromium.launch({ executablePath, args });
const tab = await browser.newPage({ viewport: { width: 1200, height: 1000 }, reducedMotion: "reduce" });
tab.setDefaultTimeout(90_000);
const found = { asked: [], wrong: [] };
const here = new URL(url).host;
let frame = null;
tab.on("request", (request) => {
  const inside = frame && request.frame() === frame;
  const address = new URL(request.url());
  if (/^https?:|^wss?:/.test(address.protocol) && (inside || address.host !== here)) found.asked.push({ inside: Boolean(inside), url: request.url().slice(0, 200) });
});
tab.on("console", (message) => message.type() === "error" && /liepoisson|about:srcdoc|Content Security/.test(message.text() + message.location().url) && found.wrong.push(message.text()));

/** What Python says of the widget: the text that begins with this word, once it is another one. */
async function said(before = "", word = "START", cell = 1) {
  if (kind === "jupyter") await runCell(cell);
  const texts = tab.locator(kind === "jupyter" ? ".jp-OutputArea-output pre" : "pre, .marimo-output, .output-area, [data-testid=console-output]");
  for (let tries = 0; tries < 100; tries++) {
    for (const text of await texts.allInnerTexts()) {
      const line = new RegExp(`${word} .* END`).exec(text)?.[0];
      if (line && line !== before) return line;
    }
    await tab.waitForTimeout(200);
    if (kind === "jupyter" && tries % 10 === 9) await runCell(cell);
  }
  throw new Error(`the cells say nothing new after ${before}`);
}

const runCell = (index) =>
  tab.evaluate(async (cell) => {
    const { content } = window.jupyterapp.shell.currentWidget;
    content.activeCellIndex = cell;
    await window.jupyterapp.commands.execute("notebook:run-cell");
  }, index);

async function typed() {
  await runCell(3);
  const element = await tab.waitForSelector('.jp-Cell:nth-of-type(4) iframe, .jp-Cell:has-text("lp.view(playing") iframe', { state: "attached" });
  frame = await element.contentFrame();
  const moves = () => frame.waitForFunction(() => window.typed?.rests() && window.laboratory?.results().top.end > 1, null, { polling: 300 });
  await moves();
  const first = await said("", "TYPED", 4);
  await frame.locator("#hamiltonian").fill("(p_x^2 + p_y^2 + x^2 + y^2)/2 + k*x^2*y");
  found.typed = await said(first, "TYPED", 4);
  await frame.locator("#hamiltonian").fill("(p_x^2 + p_y^2 + x^2 + y^2)/2 + sen(x)");
  found.wronglyTyped = await said(found.typed, "TYPED", 4);
  await runCell(5);
  await frame.waitForFunction(() => document.querySelector(".parameter > input[type=range]")?.getAttribute("aria-valuetext") === "1/3", null, { polling: 200 });
  await moves();
  found.slider = await said(found.wronglyTyped, "TYPED", 4);
  await tab.screenshot({ path: `${folder}/${kind}-typed.png` });
}

try {
  await tab.goto(url);
  if (kind === "jupyter") {
    await tab.waitForFunction(() => window.jupyterapp?.shell.currentWidget?.sessionContext?.isReady, null, { polling: 300 });
    await runCell(0);
  }
  const element = await tab.waitForSelector('iframe[title="The laboratory of liepoisson"]', { state: "attached" });
  frame = await element.contentFrame();
  await frame.waitForFunction(() => window.laboratory?.results().crossings.length > 50, null, { polling: 300 });
  await frame.waitForFunction(() => (document.querySelector("#section p b")?.textContent ?? "0") !== "0", null, { polling: 200 });
  found.isApart = await frame.evaluate(() => {
    try {
      return window.parent.document === null;
    } catch (error) {
      return error.name;
    }
  });
  found.first = await said();
  await tab.screenshot({ path: `${folder}/${kind}.png` });

  // a crossing that is chosen by keys is the next start
  await frame.locator("#section canvas").last().focus();
  await tab.keyboard.press("ArrowRight");
  found.crossing = await frame.evaluate(() => [...window.laboratory.results().crossings.rows[0]]);
  await tab.keyboard.press("Enter");
  found.afterKey = await said(found.first);

  // a click on a crossing, too
  await frame.waitForFunction(() => window.laboratory.results().crossings.length > 50, null, { polling: 300 });
  await frame.locator("#section canvas").last().focus();
  for (let k = 0; k < 7; k++) await tab.keyboard.press("ArrowRight");
  await tab.waitForTimeout(500);
  const box = await frame.locator("#section canvas").last().boundingBox();
  let start = await frame.evaluate(() => JSON.stringify(window.laboratory.state().start));
  const before = start;
  for (let k = 1; k < 20 && start === before; k++) {
    for (let j = 1; j < 20 && start === before; j++) {
      await tab.mouse.click(box.x + (box.width * k) / 20, box.y + (box.height * j) / 20);
      start = await frame.evaluate(() => JSON.stringify(window.laboratory.state().start));
    }
  }
  found.clicked = JSON.parse(start).map((one) => one.value);
  found.afterClick = await said(found.afterKey);

  // what Python sets is shown
  if (kind === "jupyter") await runCell(2);
  else await tab.getByRole("button", { name: "set" }).click();
  await frame.waitForFunction(() => window.laboratory.state().theme === "dark", null, { polling: 200 });
  found.set = await frame.evaluate(() => {
    const { theme, view, time, start, parameters } = window.laboratory.state();
    return { theme, view: view.frame, time, start: start.map((one) => one.value), epsilon: parameters[9].text };
  });
  await tab.waitForTimeout(1500);
  await tab.screenshot({ path: `${folder}/${kind}-set.png` });

  // a system is typed into another cell, and then wrongly; a slider that Python sets
  if (kind === "jupyter") await typed();
} catch (error) {
  found.error = String(error.stack ?? error);
  await tab.screenshot({ path: `${folder}/${kind}-error.png` }).catch(() => undefined);
} finally {
  await browser.close();
}
console.log(JSON.stringify(found, null, 1));
process.exit(found.error ? 1 : 0);
