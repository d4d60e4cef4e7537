// How fast is the core in WebAssembly, and how long does a frame of the page take?  Called by benchmarks/laboratory.py.
//   node web/test/speed.mjs CORE CASES PAGE: prints seconds by case, and what Chromium says of the page, as JSON.

import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { Core } from "../src/core/core.js";

const [program, cases, page] = process.argv.slice(2);
const core = await Core.start(new WebAssembly.Module(readFileSync(program)));
const { field, start, starts, tangents, times, end, surface } = JSON.parse(readFileSync(cases, "utf8"));
const [f, m, s] = [core.field(field), core.method({ kind: "taylor" }), core.functions(surface)];

function fastest(run) {
  let least = Infinity;
  for (let k = 0; k < 5; k++) {
    const begun = performance.now();
    run();
    least = Math.min(least, performance.now() - begun);
  }
  return least / 1000;
}

const found = {
  section: fastest(() => core.section(f, m, s, start, { to: end, direction: 1 })),
  orbit: fastest(() => core.orbits(f, m, start, [0, end])),
  exponents: fastest(() => core.exponents(f, m, starts.flat(), tangents.flat(), times)),
};

if (page) {
  const { chromium } = await import("playwright-core");
  const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
  for (const quality of ["low", "full"]) {
    const tab = await browser.newPage({ viewport: { width: 1440, height: 900 } });
    const begun = performance.now();
    await tab.goto(`file://${resolve(page)}?quality=${quality}`);
    await tab.waitForFunction(() => window.laboratory?.frameTimes().some((time) => time > 0));
    const first = performance.now() - begun;
    await tab.waitForTimeout(6000);
    found[quality] = await tab.evaluate(async (first) => {
      const frames = await new Promise((done) => {
        let count = 0;
        const begun = performance.now();
        const next = () => (count++, performance.now() - begun < 5000 ? requestAnimationFrame(next) : done(count / 5));
        requestAnimationFrame(next);
      });
      const times = window.laboratory.frameTimes().sort((a, b) => a - b);
      return { first: first / 1000, frames, median: times[times.length >> 1], worst: times.at(-1) };
    }, first);
    await tab.close();
  }
  await browser.close();
}
console.log(JSON.stringify(found));
