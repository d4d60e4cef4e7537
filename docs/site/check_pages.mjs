// Opens pages of the built site in Chromium: node docs/site/check_pages.mjs FOLDER [PICTURES].  Prints what is wrong and
// exits with 1: a request to another host or one that fails, an error of a script, a formula that is not set, a page
// wider than the window, what axe-core finds, in both themes, and a question whose answer is not among the first results.

import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join, normalize, resolve } from "node:path";

const require = createRequire(resolve(import.meta.dirname, "../../web/package.json"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const folder = resolve(process.argv[2]);
const pictures = process.argv[3];
const pages = {
  front: "index.html",
  guide: "sections.html",
  tables: "benchmarks.html",
  formulas: "proof.html",
  name: "reference/orbits.integrate.html",
  class: "reference/phase_space.Leaf.html",
  names: "reference/index.html",
  command: "commands/orbit.html",
  search: "search.html?q=kovalevskaya",
};
const questions = {
  "lyapunov exponents with convergence and errors": ["exponents", "spectrum", "reference/chaos.lyapunov_exponent"],
  "uncertainty of lyapunov exponent": ["exponents", "spectrum", "reference/chaos.lyapunov_exponent"],
  "events that are never missed": ["sections"],
  "poincare section": ["sections"],
  "event detection root finding": ["sections", "reference/sections.section"],
  "hamiltonian flow with tangent vectors": ["spectrum", "exponents", "reference/orbits.integrate"],
  "hamiltonian tangent vectors": ["spectrum", "exponents", "reference/orbits.integrate"],
  "random initial conditions energy": ["leaves", "reference/phase_space.Leaf"],
  "starts on a leaf and an energy": ["leaves", "reference/phase_space.Leaf"],
  "covariant lyapunov vectors": ["spectrum", "reference/results.CovariantVectors"],
  "CLV": ["spectrum", "reference/results.CovariantVectors"],
  "frequency map analysis": ["chaos", "reference/chaos.frequency_drift"],
  "exact lie algebras": ["brackets", "reference/algebras.LieAlgebra"],
  "define my own poisson bracket": ["brackets", "systems", "reference/brackets.Bracket"],
  "resume an interrupted parameter sweep": ["sweeps", "cluster"],
  "dask slurm": ["cluster"],
  "save and reload results": ["saved-results"],
  "dense output interpolation": ["getting-started", "reference/orbits.integrate", "reference/results.Orbit"],
  "sali gali": ["chaos", "reference/chaos.alignment"],
  "conserved quantities of a system": ["integrability", "reference/integrability.first_integrals"],
  "fixed points and stability": ["equilibria"],
  "install on windows": ["installing"],
  "how do I plot a rigid body": ["tops", "frames", "gallery/index"],
  "cite bibtex": ["reference/citations.cite"],
};
const first = 3; // results among which one of these pages must be
const kinds = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".png": "image/png", ".woff": "font/woff", ".woff2": "font/woff2", ".json": "application/json" };

const server = createServer((request, response) => {
  try {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://site").pathname));
    const content = readFileSync(join(folder, path));
    response.writeHead(200, { "content-type": kinds[extname(path)] ?? "application/octet-stream" }).end(content);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const site = `http://127.0.0.1:${server.address().port}/`;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage"],
});

/** What is wrong with a page in a window of some width and a theme. */
async function faults(name, theme, width) {
  const tab = await browser.newPage({ viewport: { width, height: 900 }, colorScheme: theme, reducedMotion: "reduce" });
  const wrong = [];
  tab.on("pageerror", (error) => wrong.push(error.message));
  tab.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  tab.on("request", (request) => !/^(data|blob):/.test(request.url()) && !request.url().startsWith(site) && wrong.push(`asks ${request.url()}`));
  tab.on("response", (response) => response.status() >= 400 && wrong.push(`${response.status()} for ${response.url()}`));
  await tab.goto(site + pages[name], { waitUntil: "load" });
  await tab.waitForFunction(() => !window.MathJax || (window.MathJax.startup?.promise !== undefined));
  await tab.evaluate(() => window.MathJax?.startup?.promise);
  if (name === "search") await tab.waitForSelector("#search-results li p.context, #search-results li .context", { timeout: 60_000 });
  await tab.waitForTimeout(300);
  const unset = await tab.evaluate(() => ({
    formulas: [...document.querySelectorAll(".math")].filter((one) => !one.querySelector("mjx-container")).map((one) => one.textContent),
    refused: [...document.querySelectorAll("mjx-merror, [data-mjx-error]")].map((one) => one.textContent),
    wide: document.documentElement.scrollWidth - window.innerWidth,
    results: document.querySelectorAll("#search-results > ul > li, #search-results .search > li").length,
  }));
  wrong.push(...unset.formulas.map((text) => `a formula is not set: ${text}`), ...unset.refused.map((text) => `a formula is refused: ${text}`));
  if (unset.wide > 0) wrong.push(`wider than the window by ${unset.wide} pixels`);
  if (name === "search" && unset.results < 5) wrong.push(`a search finds ${unset.results} pages`);
  await tab.evaluate(axe);
  const { violations } = await tab.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  for (const { id, nodes } of violations) {
    wrong.push(`${id}: ${nodes.slice(0, 4).map(({ target, any }) => `${target} ${any[0]?.message ?? ""}`).join("; ")} (${nodes.length})`);
  }
  if (pictures) await tab.screenshot({ path: join(pictures, `${name}-${theme}-${width}.png`) });
  await tab.close();
  return wrong;
}

/** Questions whose answers are not among the first results, with what is there. */
async function unanswered() {
  const tab = await browser.newPage();
  const wrong = [];
  for (const [question, answers] of Object.entries(questions)) {
    await tab.goto(`${site}search.html?q=${encodeURIComponent(question)}`, { waitUntil: "load" });
    await tab.waitForFunction(() => document.querySelectorAll("#search-results ul.search > li").length > 2 || /finished|did not match/.test(document.querySelector("#search-results .search-summary")?.textContent ?? ""), undefined, { timeout: 60_000 });
    const found = await tab.evaluate((n) => [...document.querySelectorAll("#search-results ul.search > li > a")].slice(0, n).map((one) => one.getAttribute("href")), first);
    const pages = found.map((link) => link.replace(/\.html.*/, ""));
    if (!answers.some((page) => pages.includes(page))) wrong.push(`${question}: found ${pages.join(", ") || "nothing"}; wanted ${answers.join(" or ")}`);
  }
  await tab.close();
  return wrong;
}

let n = 0;
let failed = false;
for (const name of Object.keys(pages)) {
  for (const [theme, width] of [["light", 1440], ["dark", 1440], ["light", 390]]) {
    const wrong = await faults(name, theme, width);
    n += 1;
    failed ||= wrong.length > 0;
    for (const fault of wrong) console.log(`${pages[name]} (${theme}, ${width}): ${fault}`);
  }
}
for (const question of await unanswered()) {
  failed = true;
  console.log(`search: ${question}`);
}
await browser.close();
server.close();
console.log(failed ? "the pages in Chromium are not as they should be" : `pages in Chromium: ${n} views, nothing asked of another host, axe-core finds nothing; ${Object.keys(questions).length} questions answered`);
process.exit(failed ? 1 : 0);
