// Types systems into the widget without a notebook: node test/widget_typed.mjs STATE FOLDER.
// STATE is a file with what Python sends to a notebook, and with what it sets afterwards. Prints as JSON what the model was told.

import { readFileSync } from "node:fs";
import { hosted } from "./widget_host.mjs";

const [file, folder] = process.argv.slice(2);
const { traits, wanted } = JSON.parse(readFileSync(file, "utf8"));
const { browser, tab, found, set, count, said } = await hosted(traits);

/** The page in its frame, once it moves; another one after the frame has loaded again. */
async function shown(title = null) {
  const frame = await (await tab.waitForSelector("iframe", { state: "attached" })).contentFrame();
  const isShown = (wanted) => (wanted ? document.getElementById("title")?.textContent === wanted : window.typed?.rests()) && window.laboratory?.results().top.end > 1;
  await frame.waitForFunction(isShown, title, { polling: 100 });
  return frame;
}
const seen = (frame) => frame.evaluate(() => {
  const { start, theme, time, playing } = window.laboratory.state();
  const sliders = [...document.querySelectorAll(".parameter > input[type=range]")].map((one) => [one.getAttribute("aria-label"), one.getAttribute("aria-valuetext")]);
  const texts = [...document.querySelectorAll("#typing :is(input, textarea, select)")].map((one) => one.clientHeight);
  return {
    title: document.getElementById("title").textContent, start: start.map((one) => one.value), theme, time, playing, sliders,
    first: [...window.laboratory.results().first], at: [...window.laboratory.results().top.at(1)],
    hamiltonian: document.getElementById("hamiltonian").value, isUsable: texts.some((height) => height > 10),
    message: document.getElementById("message").hidden ? "" : document.querySelector("#message p").textContent,
    wrong: [...document.querySelectorAll(".wrong")].filter((one) => !one.hidden).map((one) => one.textContent),
    markup: document.querySelectorAll("img, #typing script, #message b").length,
  };
});

try {
  let frame = await shown();
  await frame.waitForFunction(() => window.typed.rests(), null, { polling: 100 });
  await tab.waitForTimeout(600);
  found.opened = { ...(await seen(frame)), told: await count(), said: await tab.evaluate(() => window.model.saved.at(-1) ?? null) };

  // what is typed arrives
  let before = await count();
  await frame.locator("#hamiltonian").fill(wanted.right);
  found.right = { said: await said(before), ...(await seen(frame)) };

  // what is wrong is said, and the last right system stays; when it is mended nothing is said any more
  before = await count();
  await frame.locator("#hamiltonian").fill(wanted.wrong);
  found.wrongly = { said: await said(before), ...(await seen(frame)) };
  await tab.waitForTimeout(1500); // a processor that draws is behind
  await tab.screenshot({ path: `${folder}/typed.png` });
  before = await count();
  await frame.locator("#hamiltonian").fill(wanted.right);
  found.mended = { said: await said(before), ...(await seen(frame)) };

  // a slider
  before = await count();
  await frame.locator(".parameter > input[type=range]").first().focus();
  for (let k = 0; k < 5; k++) await tab.keyboard.press("ArrowRight");
  found.slid = { said: await said(before), ...(await seen(frame)) };

  // what Python sets is shown: parameters and state, then another system; all settle
  for (const [name, address] of Object.entries(wanted.addresses)) {
    before = await count();
    await set({ address, message: "" });
    await tab.waitForTimeout(300);
    await frame.waitForFunction(() => window.typed.rests() && window.laboratory.results().top.end > 1, null, { polling: 100 });
    await tab.waitForTimeout(700);
    found[name] = { ...(await seen(frame)), echoes: (await count()) - before, said: await tab.evaluate(() => window.model.saved.at(-1)) };
  }

  // the page of tops takes the place of this one, and the address of a typed system that of the page of tops
  await set({ _carried: "", address: wanted.top });
  await shown("A top of your own");
  await set({ address: wanted.addresses.parameters });
  frame = await shown();
  found.again = await seen(frame);
} catch (error) {
  found.error = String(error.stack ?? error);
  await tab.screenshot({ path: `${folder}/typed-error.png` }).catch(() => undefined);
} finally {
  await browser.close();
}
console.log(JSON.stringify(found, null, 1));
process.exit(found.error ? 1 : 0);
