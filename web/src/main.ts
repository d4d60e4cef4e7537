/** The page: holds the state, hands it to the panels, and the orbit to the worker. */

import "./style/page.css";
import { components, families, N, presetOf, presets } from "./data/tops";
import { exports, tables } from "./export/charts";
import { menu, savePicture } from "./export/menu";
import { asPython } from "./export/python";
import { attitudeOf } from "./panels/attitude";
import { ControlsPanel } from "./panels/controls";
import { DriftPanel } from "./panels/drift";
import { fillHelp, openHelp } from "./panels/help";
import { LyapunovPanel } from "./panels/lyapunov";
import { PortraitPanel } from "./panels/portrait";
import { ScenePanel } from "./panels/scene";
import { SectionPanel } from "./panels/section";
import { Tours } from "./panels/tour";
import { Results } from "./results";
import { shortest, type Exact } from "./state/exact";
import { begun, changed, FRAMES, HORIZON, sameRun, THEMES, type Action, type Laboratory } from "./state/laboratory";
import { place, withPartsOf } from "./state/place";
import { read, written } from "./state/url";
import { palette as currentPalette, type Palette } from "./style/palette";
import { plain } from "./symbols";
import { Client } from "./worker/client";
import type { Job } from "./worker/messages";

/** Time units of a step, of a frame at speed 1, and how far the motion is computed ahead. */
const STEP = 1 / 60;
const AHEAD = 60;
/** Charts that do not move are looked at every so many frames. */
const CHARTS_EVERY = 6;

const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const { query } = place();
const still = /^\d{1,6}$/.test(query.get("still") ?? "") ? Number(query.get("still")) : null;
const quality = (["low", "full"] as const).find((one) => one === query.get("quality")) ?? null;

let lab: Laboratory = begun("twisted-kovalevskaya");
let results = new Results();
let palette: Palette = currentPalette();
let client: Client | null = null;
let asked = 0;

/** A message, which stays until it is closed; "" closes it. */
function tell(message: string): void {
  const box = find("message");
  (box.firstElementChild as HTMLElement).textContent = message;
  box.hidden = message === "";
  place().report(message);
}
const say = (text: string) => (find("said").textContent = text);

const controls = new ControlsPanel(find("controls"), act, tell, startOn);
const scene = new ScenePanel(find("scene"), quality);
const section = new SectionPanel(find("section"), (state) => {
  startAt(state);
  say("a new orbit starts at the crossing");
}, say);
const portrait = new PortraitPanel(find("portrait"));
const lyapunov = new LyapunovPanel(find("lyapunov"));
const drift = new DriftPanel(find("drift"));

const now = () => ({ lab, results, palette });
exports(find("section"), "section", section, tables.section, now);
exports(find("portrait"), "portrait", portrait, tables.portrait, now);
exports(find("lyapunov"), "exponent", lyapunov, tables.lyapunov, now);
exports(find("drift"), "drift", drift, tables.drift, now);
menu(find("scene"), "view", [
  ["picture, PNG", () => savePicture(`${lab.preset ?? "top"}-${lab.view.frame}.png`, scene.picture(palette, `${find("title").textContent}, ${find("subtitle").textContent}, ${find("clock").textContent}`))],
]);

/** The one way in which the state changes. */
function act(action: Action): void {
  const before = lab;
  try {
    lab = changed(lab, action);
  } catch (error) {
    tell((error as Error).message);
  }
  if (!sameRun(before, lab)) run();
  show();
}

function run(): void {
  results = new Results();
  delete document.documentElement.dataset.ready;
  asked = 0;
  lab = { ...lab, time: still === null ? lab.time : Math.min(still * STEP * lab.speed, HORIZON) };
  client?.run(jobOf(lab));
}

/** A projection has converged where no equation is off by more. */
const CONVERGED = 1e-13;

/** Moves the start to the nearest state with these values of energy and Casimirs; the others keep theirs. */
async function startOn(entered: Readonly<Record<string, Exact>>): Promise<void> {
  if (!client) return;
  const [before, { names, first }] = [lab, results];
  const kept = Object.fromEntries(names.flatMap((name, k) => (families[0].names.includes(name) ? [[name, first[k]]] : [])));
  const wanted = { ...kept, ...Object.fromEntries(Object.entries(entered).map(([name, to]) => [name, to.value])) };
  try {
    const { state, residuals } = await client.project(jobOf(lab), wanted);
    if (lab.start !== before.start || lab.parameters !== before.parameters) return;
    const [worst, off] = Object.entries(residuals).reduce((a, b) => (Math.abs(b[1]) > Math.abs(a[1]) ? b : a));
    if (!(Math.abs(off) <= CONVERGED)) {
      const values = Object.entries(wanted).map(([name, value]) => `${plain(name)} = ${Number(value.toPrecision(6))}`).join(", ");
      tell(`No state with ${values} was found near this start: Newton's method ends where ${plain(worst)} is off by ${Math.abs(off).toPrecision(1)} of its size. Values may exclude one another; try one nearer to the present.`);
      return;
    }
    startAt(state);
    say("the start has these values");
  } catch (error) {
    tell(`The start cannot be moved there: ${(error as Error).message}`);
  }
}

function jobOf({ parameters, start, surface, direction, method }: Laboratory): Job {
  const values = start.map((one) => one.value);
  return {
    parameters: parameters.map((one) => one.value),
    start: values,
    attitude: attitudeOf(values),
    surface: components.indexOf(surface),
    direction,
    tol: method.tol.value,
    horizon: HORIZON,
  };
}

function startAt(state: ArrayLike<number>): void {
  act({ do: "start at", state: Array.from(state, shortest) });
}

/** What changes with the state, not with time. */
function show(): void {
  const preset = presetOf(lab.preset);
  find("title").textContent = preset?.title ?? "A top of your own";
  const epsilon = lab.parameters[9].text.replace("-", "−");
  const isRod = lab.parameters.slice(3, 9).every(({ value }, k) => k % 3 === 2 || value === 0);
  const remark = lab.view.frame === "rod" && !isRod ? " · a or b is not along the third axis: a curve, but no rod in equilibrium" : "";
  find("subtitle").textContent = `ε = ${epsilon}${preset ? ` · ${preset.kind}` : ""}${remark}`;
  controls.show(lab, preset?.story ?? "A projection of the section is a cloud even where the motion is regular: look at the exponent, too.");
  for (const button of find("presets").querySelectorAll("button")) {
    const chosen = button.dataset.key === lab.preset;
    button.setAttribute("aria-pressed", String(chosen));
    if (chosen) find("presets").scrollLeft = button.offsetLeft - find("presets").offsetLeft - 60;
  }
  const play = find("play");
  play.textContent = lab.playing ? "❚❚" : "▶";
  play.setAttribute("aria-label", lab.playing ? "Pause" : "Play");
  const speed = find<HTMLInputElement>("speed");
  speed.value = String(Math.log2(lab.speed));
  speed.style.setProperty("--fill", `${((Math.log2(lab.speed) + 4) / 8) * 100}%`);
  find("rate").textContent = lab.speed < 1 ? `1/${1 / lab.speed}×` : `${lab.speed}×`;
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  document.documentElement.dataset.shown = lab.theme === "auto" ? (dark ? "dark" : "light") : lab.theme;
  palette = currentPalette();
  scene.dirty = true;
  place().keep(() => written(lab), lab.playing);
}

/** The state as somebody outside set it: what it leaves as it was goes on. */
function adopt(address: string, playing: boolean, sameTime: boolean): void {
  const before = lab;
  try {
    const next = withPartsOf(before, { ...read(address), playing });
    const sameOrbit = next.parameters === before.parameters && next.start === before.start;
    lab = sameTime && sameOrbit ? { ...next, time: before.time } : next;
  } catch (error) {
    tell(`This state cannot be shown: ${(error as Error).message}.`);
  }
  if (!sameRun(before, lab)) run();
  show();
}

function header(): void {
  find("presets").replaceChildren(
    ...presets.map((preset) => {
      const button = document.createElement("button");
      const small = document.createElement("small");
      small.textContent = preset.kind;
      Object.assign(button, { type: "button" });
      button.dataset.key = preset.key;
      button.append(preset.title, small);
      button.addEventListener("click", () => act({ do: "preset", key: preset.key }));
      return button;
    }),
  );
  find("share").addEventListener("click", share);
  find("python").addEventListener("click", python);
  find("guide").addEventListener("click", () => tours.choose());
  find("theme").addEventListener("click", nextTheme);
  find("help").addEventListener("click", () => openHelp(find<HTMLDialogElement>("keys")));
  find("message").querySelector("button")?.addEventListener("click", () => tell(""));
  find("play").addEventListener("click", () => act({ do: "play", playing: !lab.playing }));
  find("restart").addEventListener("click", () => act({ do: "time", time: 0 }));
  find("step").addEventListener("click", () => step(1));
  find("speed").addEventListener("input", (event) => act({ do: "speed", speed: 2 ** Number((event.target as HTMLInputElement).value) }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
}

async function share(): Promise<void> {
  tell(await place().share(written(lab)));
}

/** The lines of Python; where there is no clipboard, in a dialog from which they can be copied. */
async function python(): Promise<void> {
  const lines = asPython(lab);
  try {
    await navigator.clipboard.writeText(lines);
    tell("The lines of Python that compute this orbit are copied.");
  } catch {
    const dialog = find<HTMLDialogElement>("lines");
    (dialog.querySelector("textarea") as HTMLTextAreaElement).value = lines;
    dialog.showModal();
    (dialog.querySelector("textarea") as HTMLTextAreaElement).select();
  }
}

function nextTheme(): void {
  const theme = THEMES[(THEMES.indexOf(lab.theme) + 1) % THEMES.length];
  act({ do: "theme", theme });
  say(`theme: ${theme}`);
}

function step(sign: number): void {
  act({ do: "play", playing: false });
  act({ do: "time", time: Math.min(lab.time + sign * STEP * lab.speed, Math.max(results.top.end, 0)) });
}

const tours = new Tours<Laboratory>(find<HTMLDialogElement>("tours"), find<HTMLDialogElement>("tour"), {
  now: () => lab,
  set(to) {
    const before = lab;
    lab = withPartsOf(before, to);
    if (!sameRun(before, lab)) run();
    show();
  },
  read: (address) => ({ ...read(address), theme: lab.theme, playing: lab.playing }),
  tell,
});

const KEYS: Readonly<Record<string, () => void>> = {
  " ": () => act({ do: "play", playing: !lab.playing }),
  ArrowRight: () => step(1),
  ArrowLeft: () => step(-1),
  "+": () => act({ do: "speed", speed: lab.speed * 2 }),
  "-": () => act({ do: "speed", speed: lab.speed / 2 }),
  r: () => act({ do: "time", time: 0 }),
  f: () => act({ do: "view", view: { frame: FRAMES[(FRAMES.indexOf(lab.view.frame) + 1) % FRAMES.length] } }),
  g: () => act({ do: "view", view: { shadow: !lab.view.shadow } }),
  t: nextTheme,
  s: () => void share(),
  p: () => void python(),
  h: () => tours.choose(),
  "?": () => openHelp(find<HTMLDialogElement>("keys")),
};
const TURNS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };

function keys(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea, dialog[open]")) return;
  if (event.key === " " && target.closest("button")) return;
  const turn = event.shiftKey ? TURNS[event.key] : undefined;
  const preset = /^[1-9]$/.test(event.key) ? presets[Number(event.key) - 1] : undefined;
  const does = turn ? () => scene.turn(...turn) : preset ? () => act({ do: "preset", key: preset.key }) : KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!does) return;
  event.preventDefault();
  does();
}

/** Distance of the two states, which is no longer small when the orbits have parted. */
function distance(): string {
  const [one, other] = [results.top.at(lab.time), results.shadow.at(lab.time)];
  if (!one || !other || results.shadow.end < lab.time) return "";
  let sum = 0;
  for (let k = 0; k < N; k++) sum += (one[k] - other[k]) ** 2;
  return Math.sqrt(sum) < 0.01 ? Math.sqrt(sum).toPrecision(2) : Math.sqrt(sum).toFixed(2);
}

/** The state at rest, for those who do not see the scene. */
function inNumbers(): string {
  const state = results.top.at(lab.time);
  if (!state) return "";
  const vector = (words: string, at: number) => `${words} ${Array.from(state.subarray(at, at + 3), (value) => value.toFixed(3).replace("-", "−")).join(", ")}`;
  return `${find("clock").textContent}: ${vector("angular momentum", 0)}; ${vector("first field", 3)}; ${vector("second field", 6)}`;
}

let frames = 0;
let before = 0;
const spent: number[] = [];

function frame(now: number): void {
  const began = performance.now();
  const passed = Math.min((now - before) / 1000, 0.1);
  before = now;
  if (lab.playing && still === null) {
    // a time from the address waits for the motion to come so far
    const time = Math.max(lab.time, Math.min(lab.time + passed * lab.speed, results.top.end));
    if (time !== lab.time) lab = changed(lab, { do: "time", time });
  }
  if (lab.time + AHEAD / 2 > asked) {
    asked = lab.time + AHEAD * Math.max(lab.speed, 1);
    client?.until(asked);
  }
  draw();
  spent[frames % 120] = performance.now() - began;
  frames += 1;
  requestAnimationFrame(frame);
}

/** Milliseconds from the request of the page to the first drawn state. */
let firstPicture = 0;
let drawnAt = -1;
let drawnFor: Results | null = null;
let drawnChunks = 0;

function draw(): void {
  const chunks = results.top.chunks.length + results.shadow.chunks.length;
  const moved = lab.time !== drawnAt || results !== drawnFor || chunks !== drawnChunks;
  // a processor that draws the scene itself is given half of the frames
  if ((moved || scene.dirty) && (!scene.software || frames % 2 === 0)) {
    scene.draw(lab, results, palette);
    portrait.draw(lab, results, palette);
    [drawnAt, drawnFor, drawnChunks] = [lab.time, results, chunks];
    if (chunks > 0 && firstPicture === 0) firstPicture = performance.now();
    find("clock").textContent = `${lab.view.frame === "rod" ? "s" : "t"} = ${lab.time.toFixed(2)}`;
    const apart = distance();
    find("apart").hidden = !lab.view.shadow || !apart;
    (find("apart").lastElementChild as HTMLElement).textContent = apart;
    controls.conserved(results, lab.time);
    if (!lab.playing) find("numbers").textContent = inNumbers();
  }
  section.draw(lab, results, palette);
  if (frames % CHARTS_EVERY === 0) lyapunov.draw(lab, results, palette);
  if (frames % CHARTS_EVERY === CHARTS_EVERY / 2) drift.draw(lab, results, palette);
  if (still !== null && drawnFor === results && results.finished && results.top.end >= lab.time && frames > 30) document.documentElement.dataset.ready = "1";
}

async function begin(): Promise<void> {
  header();
  fillHelp(find<HTMLDialogElement>("keys"));
  document.addEventListener("keydown", keys);
  const { address, playing } = place();
  const isTour = tours.isLink(address);
  if (address && !isTour) {
    try {
      lab = read(address);
    } catch (error) {
      tell(`This address cannot be read: ${(error as Error).message}. The page shows the twisted Kovalevskaya top instead.`);
    }
  }
  if (matchMedia("(prefers-reduced-motion: reduce)").matches || still !== null || playing === false) lab = { ...lab, playing: false };
  place().follow({ adopt, tell });
  show();
  requestAnimationFrame(frame);
  try {
    client = await Client.start((update) => {
      results.take(update);
      if (update.say === "ended") tell(`The orbit ends at t = ${update.time.toPrecision(6)}: ${update.outcome}. Another tolerance or another start may help.`);
    }, (message) => tell(`The core refuses this: ${message}`));
    run();
    if (isTour) tours.follow(address);
  } catch (error) {
    tell(`The core did not start: ${(error as Error).message}. The laboratory needs WebAssembly with vector instructions and workers.`);
  }
}

/** For tests: what the page has computed, and how long a frame took our own code. */
Object.assign(window, {
  laboratory: {
    state: () => lab,
    results: () => results,
    frameTimes: () => [...spent],
    sectionRange: () => section.plot.x.range,
    firstPicture: () => firstPicture,
    isLowQuality: () => scene.software,
    python: () => asPython(lab),
    sizes: () => scene.sizes(),
  },
});

void begin();
