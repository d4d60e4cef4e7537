import { chromium } from "playwright-core";
import { resolve } from "node:path";
const [folder, ...wanted] = process.argv.slice(2);
const page = `file://${resolve(import.meta.dirname, "dist/index.html")}`;
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"] });
for (const one of wanted) {
  const [name, hash, width, height, script] = one.split("|");
  const tab = await browser.newPage({ viewport: { width: +width, height: +height } });
  tab.on("console", (m) => m.type() === "error" && console.log(name, m.text()));
  tab.on("pageerror", (e) => console.log(name, e.message));
  await tab.goto(`${page}?still=600&quality=low#${hash}`);
  await tab.waitForFunction(() => window.laboratory?.results().names.length > 0, null, { timeout: 60000 });
  if (script) await (new (Object.getPrototypeOf(async function () {}).constructor)("tab", script))(tab);
  await tab.waitForFunction(() => !window.laboratory.fan().orbits.length || window.laboratory.fan().finished, null, { timeout: 60000 }).catch(() => {});
  await tab.waitForTimeout(1500);
  await tab.screenshot({ path: `${folder}/${name}.png`, fullPage: +width < 900 });
  console.log(name, await tab.evaluate(() => [document.documentElement.scrollWidth, window.laboratory.fan().took]));
  await tab.close();
}
await browser.close();
