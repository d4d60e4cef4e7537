// Drives the widget without a notebook: node test/widget.mjs STATE FOLDER.
// STATE is a file with what Python sends to a notebook (the traits, with the script). The script is loaded in Chromium as
// anywidget loads it, and a plain object stands for the model. Prints as JSON what the model was told.

import { readFileSync } from "node:fs";
import { hosted } from "./widget_host.mjs";

const [file, folder] = process.argv.slice(2);
const traits = JSON.parse(readFileSync(file, "utf8"));
const { browser, tab, found, set, count, said } = await hosted(traits);

try {
  const element = await tab.waitForSelector("iframe", { state: "attached" });
  const frame = await element.contentFrame();
  await frame.waitForFunction(() => window.laboratory?.results().crossings.length > 20, null, { polling: 200 });
  await frame.waitForFunction(() => (document.querySelector("#section p b")?.textContent ?? "0") !== "0", null, { polling: 200 });
  const box = () => frame.evaluate(() => ({ text: document.querySelector("#message p").textContent, elements: document.querySelector("#message p").children.length, hidden: document.getElementById("message").hidden }));
  found.title = await frame.evaluate(() => document.getElementById("title").textContent);
  found.images = await frame.evaluate(() => document.querySelectorAll("img, #title *").length);
  found.isApart = await frame.evaluate(() => {
    try {
      return window.parent.document === null;
    } catch (error) {
      return error.name;
    }
  });
  await tab.screenshot({ path: `${folder}/widget.png` });

  // a crossing that is chosen is the next start
  let before = await count();
  found.crossing = await frame.evaluate(() => [...window.laboratory.results().crossings.rows[0]]);
  await frame.locator("#section canvas").last().focus();
  await tab.keyboard.press("ArrowRight");
  await tab.keyboard.press("Enter");
  found.chosen = await said(before);

  // what Python sets is shown
  const address = (part, value) => found.chosen.address.replace(new RegExp(`(^|&)${part}=[^&]*`), `$1${part}=${value}`);
  before = await count();
  await set({ address: address("t", "2.5").replace(/(^|&)theme=[^&]*/, "$1theme=dark") });
  await frame.waitForFunction(() => window.laboratory.state().theme === "dark", null, { polling: 100 });
  found.set = await frame.evaluate(() => ({ time: window.laboratory.state().time, theme: window.laboratory.state().theme }));
  await tab.waitForTimeout(400);
  found.echo = (await count()) - before;

  // what the page cannot show comes back, with a message
  before = await count();
  await set({ address: `${address("theme", "dark")}&<img src=x onerror=alert(1)>=1` });
  found.refused = { said: await said(before), box: await box() };
  await tab.screenshot({ path: `${folder}/widget-refused.png` });

  // a message of Python is text
  await set({ message: "<img src=x onerror=\"alert(1)\"><b>no</b>" });
  await frame.waitForFunction(() => document.querySelector("#message p").textContent.startsWith("<img"), null, { polling: 100 });
  found.told = await box();
  before = await count();
  await frame.locator("#message button").click();
  found.closed = { said: await said(before), box: await box() };

  // what is no state is left alone, and the frame goes with the cell
  before = await count();
  for (const data of [null, 3, "x", { address: 1 }, { liepoisson: 1, name: "liepoisson:", address: "v=1", playing: true, message: "", carried: "", options: "" }]) {
    await tab.evaluate((one) => document.querySelector("iframe").contentWindow.postMessage(one, "*"), data);
  }
  await tab.waitForTimeout(300);
  found.stray = (await count()) - before;
  // another system is another page in the same frame
  before = await count();
  await set(traits.after);
  const next = await (await tab.$("iframe")).contentFrame();
  await next.waitForFunction(() => document.getElementById("title")?.textContent === "henon-heiles" && window.laboratory?.results().top.end > 2, null, { polling: 100 });
  found.other = await next.evaluate(() => {
    const at = (time) => [...window.laboratory.results().top.at(time)];
    return { title: document.getElementById("title").textContent, start: window.laboratory.state().start.map((one) => one.value), end: at(1) };
  });
  await tab.waitForTimeout(400);
  found.other.refused = await tab.evaluate((n) => window.model.saved.slice(n).filter((one) => /cannot be/.test(one.message)).length, before);

  await set({ height: 333 });
  found.height = await element.evaluate((one) => one.getBoundingClientRect().height);
  found.left = await tab.evaluate(() => {
    window.end();
    return [document.querySelectorAll("iframe").length, [...window.listeners.values()].reduce((sum, one) => sum + one.size, 0)];
  });
} catch (error) {
  found.error = String(error.stack ?? error);
  await tab.screenshot({ path: `${folder}/widget-error.png` }).catch(() => undefined);
} finally {
  await browser.close();
}
console.log(JSON.stringify(found, null, 1));
process.exit(found.error ? 1 : 0);
