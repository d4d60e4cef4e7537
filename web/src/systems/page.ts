/** The page of a system that it carries or that is typed: holds the state, hands it to the panels, and the orbit to the worker. */

import "../style/page.css";
import "./systems.css";
import { DriftPanel } from "../panels/drift";
import { openHelp } from "../panels/help";
import { LyapunovPanel } from "../panels/lyapunov";
import { PortraitPanel } from "../panels/portrait";
import { entry } from "../panels/scene";
import { SectionPanel } from "../panels/section";
import { Tours } from "../panels/tour";
import { Results } from "../results";
import type { Charted } from "../state/charted";
import { shortest, type Exact } from "../state/exact";
import { THEMES } from "../state/laboratory";
import { place, withPartsOf } from "../state/place";
import { palette as currentPalette, type Palette } from "../style/palette";
import { Client } from "../worker/client";
import type { Update } from "../worker/messages";
import { inWords } from "./comparison";
import { SystemControls } from "./controls";
import { FanSection } from "./fan/panel";
import { CARRIED, described, type SystemDescription } from "./description";
import { FlatView, Ranges, seriesColours } from "./flat";
import { fillHelp } from "./help";
import { SpaceView } from "./space";
import { begun, changed, clockOf, sameRun, timeText, viewsOf, type SystemAction, type SystemState, type View } from "./state";
import { aboutSurface, counted, isStroboscopic } from "./time";
import { read, written } from "./url";

/** A step, of a frame at speed 1, and how far the motion is computed ahead: in units of time. */
const STEP = 1 / 60;
const AHEAD = 60;
/** Charts that do not move are looked at every so many frames. */
const CHARTS_EVERY = 6;
/** Saved states that are drawn around the time of the cursor, in units of time. */
const SAVED_PAST = 10;
const MOST_LETTERS = 20;

const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const { query } = place();
const still = /^\d{1,6}$/.test(query.get("still") ?? "") ? Number(query.get("still")) : null;
const quality = (["low", "full"] as const).find((one) => one === query.get("quality")) ?? null;

/** A message, which stays until it is closed; "" closes it. */
export function tell(message: string): void {
  const box = find("message");
  (box.firstElementChild as HTMLElement).textContent = message;
  box.hidden = message === "";
  place().report(message);
}
const say = (text: string) => (find("said").textContent = text);

document.documentElement.dataset.page = "system";
find("message").querySelector("button")?.addEventListener("click", () => tell(""));
fillHelp(find<HTMLDialogElement>("keys"));

/** What the page shows, once it is known that it can. */
export class SystemPage {
  private readonly clock;
  private state: SystemState;
  private results: Results;
  private palette: Palette = currentPalette();
  private client: Client | null = null;
  private asked = 0;
  private readonly ranges: Ranges;
  private readonly controls: SystemControls;
  private readonly space: SpaceView;
  private readonly flat: FlatView;
  private readonly section: SectionPanel;
  private readonly fan: FanSection;
  private readonly portrait: PortraitPanel;
  private readonly lyapunov: LyapunovPanel;
  private readonly drift: DriftPanel;
  private readonly views: readonly View[];
  private readonly tours: Tours<SystemState>;

  /** Ends what listens to the window, and the frames. */
  private readonly gone = new AbortController();

  /** `address` gives the whole address where that of the state is a part of it. */
  constructor(private system: SystemDescription, private readonly address: (() => string) | null = null) {
    const clock = (this.clock = clockOf(system));
    this.ranges = new Ranges(system.turns);
    this.views = viewsOf(system);
    this.state = begun(system);
    this.results = new Results(system.components.length);
    const panel = find("scene");
    panel.setAttribute("aria-label", "The motion");
    this.controls = new SystemControls(find("controls"), system, (action) => this.act(action), tell);
    this.space = new SpaceView(panel.querySelector(".view") as HTMLElement, system, clock, quality, this.views.includes("vectors"));
    this.flat = new FlatView(panel, system, clock);
    this.section = new SectionPanel(find("section"), (state) => this.startAt(state), say, system, clock);
    this.fan = new FanSection(find("section"), this.section.plot, system, { act: (action) => this.act(action), start: (state) => this.startAt(state), say, tell });
    this.portrait = new PortraitPanel(find("portrait"), system, clock);
    if (address) this.startsByClick();
    this.lyapunov = new LyapunovPanel(find("lyapunov"), clock);
    this.drift = new DriftPanel(find("drift"), clock);
    this.tours = new Tours(find<HTMLDialogElement>("tours"), find<HTMLDialogElement>("tour"), {
      system: system.name,
      now: () => this.state,
      set: (state) => this.set(state),
      // that of a tour may leave out the system, whose hash another version changes
      read: (address) => ({ ...read(system, /(^|&)system=/.test(address) ? address : `system=${system.id}&${address}`), theme: this.state.theme, playing: this.state.playing }),
      tell,
    });
  }

  private set(state: SystemState): void {
    const before = this.state;
    this.state = withPartsOf(before, state);
    if (!sameRun(before, this.state)) this.run();
    this.show();
  }

  get now(): SystemState {
    return this.state;
  }

  /** Another system with the same components, in a state of its own or in that of the last one, perhaps with another start. */
  replace(system: SystemDescription, start: readonly Exact[] | null, state: SystemState | null = null): void {
    this.system = system;
    this.state = state ?? { ...this.state, time: 0, start: start ?? this.state.start };
    this.name();
    this.run();
    this.show();
  }

  /** Leaves its panels to another page. */
  leave(): void {
    this.gone.abort();
    this.fan.free();
    this.space.free();
  }

  /** A click into the portrait starts an orbit with these two components. */
  private startsByClick(): void {
    const { plot } = this.portrait;
    plot.canvas.classList.add("starts");
    plot.canvas.addEventListener("click", (event) => {
      const point = plot.point(event.offsetX, event.offsetY);
      if (!point) return;
      const start = this.state.start.map((one) => one.value);
      this.state.axes.forEach((axis, k) => (start[axis] = point[k]));
      this.startAt(start, "a new orbit starts at this point");
    });
  }

  /** The one way in which the state changes. */
  private act(action: SystemAction): void {
    const before = this.state;
    try {
      this.state = changed(this.system, this.state, action);
    } catch (error) {
      tell((error as Error).message);
    }
    if (!sameRun(before, this.state)) this.run();
    this.show();
  }

  private run(): void {
    this.results = new Results(this.system.components.length);
    delete document.documentElement.dataset.ready;
    this.asked = 0;
    const { unit, horizon } = this.clock;
    if (still !== null) this.state = { ...this.state, time: Math.min(still * STEP * this.state.speed * unit, horizon) };
    const { start, surface, direction, tol } = this.state;
    this.client?.run({ system: this.system, start: start.map((one) => one.value), surface, direction, tol: tol.value, horizon, saved: this.system.saved });
  }

  private startAt(state: ArrayLike<number>, words = "a new orbit starts at the crossing"): void {
    try {
      this.act({ do: "start at", state: Array.from(state, shortest) });
      say(words);
    } catch (error) {
      tell((error as Error).message);
    }
  }

  /** What changes with the state, not with time. */
  private show(): void {
    const { state, system } = this;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.shown = state.theme === "auto" ? (dark ? "dark" : "light") : state.theme;
    this.palette = currentPalette();
    const colours = seriesColours(this.palette);
    this.controls.show(state, colours);
    for (const button of find("presets").querySelectorAll("button")) button.setAttribute("aria-pressed", String(button.dataset.key === state.view));
    const play = find("play");
    play.textContent = state.playing ? "❚❚" : "▶";
    play.setAttribute("aria-label", state.playing ? "Pause" : "Play");
    const speed = find<HTMLInputElement>("speed");
    speed.value = String(Math.log2(state.speed));
    speed.style.setProperty("--fill", `${((Math.log2(state.speed) + 4) / 8) * 100}%`);
    find("rate").textContent = state.speed < 1 ? `1/${1 / state.speed}×` : `${state.speed}×`;
    this.fan.want(system, state);
    this.section.use(!this.fan.isShown);
    const isFlat = this.isFlat();
    this.space.show(!isFlat);
    this.flat.show(isFlat, state.view === "picture" ? `${system.picture?.name} of the state` : state.view === "series" ? "Components over time" : "Path in two components");
    this.legend(colours);
    find("section-h").textContent = isStroboscopic(system, state.surface) ? "Stroboscopic map" : "Poincaré section";
    this.space.dirty = true;
    place().keep(() => this.whole(), state.playing);
  }

  /** The whole address. */
  private whole(): string {
    return this.address?.() ?? written(this.system, this.state);
  }

  private isFlat(): boolean {
    const { view, space } = this.state;
    return view === "picture" || view === "series" || (view === "projection" && space[2] === null);
  }

  private legend(colours: readonly string[]): void {
    const { state, system } = this;
    const at = (k: number) => colours[k % colours.length];
    const items: Partial<Record<View, () => HTMLElement[]>> = {
      vectors: () => this.space.names.map((name, k) => entry(name, "", at(k))),
      series: () => state.series.map((component, k) => entry(system.components[component], "", at(k))),
    };
    find("scene").querySelector(".legend")?.replaceChildren(...(items[state.view]?.() ?? []));
  }

  /** The state as somebody outside set it: what it leaves as it was goes on. */
  adopt(address: string, playing: boolean, sameTime: boolean): void {
    const before = this.state;
    try {
      const next = withPartsOf(before, { ...read(this.system, address), playing });
      this.state = sameTime && next.start === before.start ? { ...next, time: before.time } : next;
    } catch (error) {
      tell(`This state cannot be shown: ${(error as Error).message}.`);
    }
    if (!sameRun(before, this.state)) this.run();
    this.show();
  }

  private name(): void {
    const { system } = this;
    document.title = `${system.name} · liepoisson`;
    find("title").textContent = system.name;
    find("subtitle").textContent = `${counted(system)}${system.saved ? ", with a saved result" : ""}`;
  }

  private header(): void {
    const { system } = this;
    const { signal } = this.gone;
    this.name();
    (document.querySelector(".skip") as HTMLElement).textContent = "Skip to the motion";
    const nav = find("presets");
    nav.setAttribute("aria-label", "Views");
    const words: Record<View, readonly [string, string]> = {
      vectors: ["Vectors", "arrows with trails"],
      picture: [system.picture?.name ?? "Picture", "on the plane"],
      projection: ["Projection", "on two or three axes"],
      series: ["Time series", "of components"],
    };
    nav.replaceChildren(
      ...this.views.map((view) => {
        const button = document.createElement("button");
        const small = document.createElement("small");
        small.textContent = words[view][1];
        button.type = "button";
        button.dataset.key = view;
        button.append(words[view][0], small);
        button.addEventListener("click", () => this.act({ do: "view", view }));
        return button;
      }),
    );
    document.querySelector(".skip")?.addEventListener("click", (event) => {
      // the address is not for the place in the page
      event.preventDefault();
      find("scene").focus();
    }, { signal });
    find("share").addEventListener("click", () => void this.share(), { signal });
    find("theme").addEventListener("click", () => this.nextTheme(), { signal });
    find("guide").addEventListener("click", () => this.tours.choose(), { signal });
    find("help").addEventListener("click", () => openHelp(find<HTMLDialogElement>("keys")), { signal });
    find("play").addEventListener("click", () => this.act({ do: "play", playing: !this.state.playing }), { signal });
    find("restart").addEventListener("click", () => this.act({ do: "time", time: 0 }), { signal });
    find("step").addEventListener("click", () => this.step(1), { signal });
    find("speed").addEventListener("input", (event) => this.act({ do: "speed", speed: 2 ** Number((event.target as HTMLInputElement).value) }), { signal });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(), { signal });
  }

  private async share(): Promise<void> {
    tell(await place().share(this.whole()));
  }

  private nextTheme(): void {
    const theme = THEMES[(THEMES.indexOf(this.state.theme) + 1) % THEMES.length];
    this.act({ do: "theme", theme });
    say(`theme: ${theme}`);
  }

  private step(sign: number): void {
    const { time, speed } = this.state;
    this.act({ do: "play", playing: false });
    this.act({ do: "time", time: Math.min(time + sign * STEP * speed * this.clock.unit, Math.max(this.results.top.end, 0)) });
  }

  private keys(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea, dialog, .formulas")) return;
    if (event.key === " " && target.closest("button, summary")) return;
    const turn = event.shiftKey ? TURNS[event.key] : undefined;
    const view = /^[1-9]$/.test(event.key) ? this.views[Number(event.key) - 1] : undefined;
    const does: Readonly<Record<string, () => void>> = {
      " ": () => this.act({ do: "play", playing: !this.state.playing }),
      ArrowRight: () => this.step(1),
      ArrowLeft: () => this.step(-1),
      "+": () => this.act({ do: "speed", speed: this.state.speed * 2 }),
      "-": () => this.act({ do: "speed", speed: this.state.speed / 2 }),
      r: () => this.act({ do: "time", time: 0 }),
      t: () => this.nextTheme(),
      s: () => void this.share(),
      h: () => this.tours.choose(),
      "?": () => openHelp(find<HTMLDialogElement>("keys")),
    };
    const chosen = turn ? () => this.space.turn(...turn) : view ? () => this.act({ do: "view", view }) : does[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!chosen) return;
    event.preventDefault();
    chosen();
  }

  private frames = 0;
  private before = 0;
  private readonly spent: number[] = [];

  private frame(now: number): void {
    if (this.gone.signal.aborted) return;
    const began = performance.now();
    const passed = Math.min((now - this.before) / 1000, 0.1);
    this.before = now;
    const { state, clock } = this;
    if (state.playing && still === null) {
      // a time from the address waits for the motion to come so far
      const time = Math.max(state.time, Math.min(state.time + passed * state.speed * clock.unit, this.results.top.end));
      if (time !== state.time) this.state = changed(this.system, state, { do: "time", time });
    }
    if (this.state.time + (AHEAD / 2) * clock.unit > this.asked) {
      this.asked = this.state.time + AHEAD * clock.unit * Math.max(state.speed, 1);
      this.client?.until(this.asked);
    }
    this.draw();
    this.spent[this.frames % 120] = performance.now() - began;
    this.frames += 1;
    requestAnimationFrame((next) => this.frame(next));
  }

  private drawn: { at: number; of: Results | null; chunks: number; size: string } = { at: -1, of: null, chunks: 0, size: "" };

  private draw(): void {
    const { results, state, palette, frames, system } = this;
    const { name, modulus } = system.surfaces[state.surface];
    const charted: Charted = {
      axes: [system.components[state.axes[0]], system.components[state.axes[1]]],
      surface: shortened(name),
      modulus,
      remark: aboutSurface(system, state.surface),
      direction: state.direction,
      time: state.time,
    };
    const [chunks, size] = [results.top.chunks.length, `${innerWidth} ${innerHeight}`];
    const { drawn } = this;
    const moved = state.time !== drawn.at || results !== drawn.of || chunks !== drawn.chunks || size !== drawn.size;
    // a processor that draws the scene itself is given half of the frames
    if ((moved || this.space.dirty) && (!this.space.software || frames % 2 === 0)) {
      this.ranges.look(results);
      if (this.isFlat()) this.flat.draw(state, results, this.ranges, palette);
      else this.space.draw(state, results, this.ranges, system, palette);
      this.space.dirty = false;
      this.portrait.draw(charted, results, palette);
      this.drawn = { at: state.time, of: results, chunks, size };
      find("clock").textContent = `t = ${timeText(state.time, this.clock)}`;
      this.controls.conserved(results, state.time);
      this.savedStates("orbit");
    }
    if (this.fan.isShown) this.fan.draw(charted, results, palette);
    else this.section.draw(charted, results, palette);
    this.savedStates("section");
    if (frames % CHARTS_EVERY === 0) this.lyapunov.draw(charted, results, palette);
    if (frames % CHARTS_EVERY === CHARTS_EVERY / 2) {
      this.drift.draw(charted, results, palette);
      if (system.saved) this.controls.compare(inWords(system.saved, results.compared));
    }
    if (still !== null && results.finished && results.top.end >= state.time && frames > 30) document.documentElement.dataset.ready = "1";
  }

  /** Rings at the states of a saved orbit in the portrait, at those of a saved section in the section. */
  private savedStates(kind: "orbit" | "section"): void {
    const { saved } = this.system;
    if (saved?.kind !== kind || !saved.has_states || (kind === "section" && this.state.surface !== this.system.surface)) return;
    const { plot } = kind === "orbit" ? this.portrait : this.section;
    const { time, axes } = this.state;
    const c = plot.above;
    c.save();
    plot.clip(c);
    c.strokeStyle = this.palette.accent;
    c.lineWidth = 1;
    const near = (when: number) => kind === "section" || (when <= time && when >= time - SAVED_PAST * this.clock.unit);
    saved.times.forEach((when, k) => {
      if (!near(when)) return;
      c.beginPath();
      c.arc(plot.px(saved.states[k][axes[0]]), plot.py(saved.states[k][axes[1]]), 3.2, 0, 7);
      c.stroke();
    });
    c.restore();
  }

  /** Shows a state, and begins to draw. */
  open(state: SystemState): void {
    this.state = state;
    this.header();
    document.addEventListener("keydown", (event) => this.keys(event), { signal: this.gone.signal });
    const { playing } = place();
    if (matchMedia("(prefers-reduced-motion: reduce)").matches || still !== null || playing === false) this.state = { ...this.state, playing: false };
    Object.assign(window, { laboratory: { state: () => this.state, results: () => this.results, frameTimes: () => [...this.spent], fan: () => this.fan.now } });
    this.show();
    requestAnimationFrame((now) => this.frame(now));
  }

  /** What the worker has found. */
  take(update: Update): void {
    this.results.take(update);
    if (update.say === "ended") tell(`The orbit ends at t = ${update.time.toPrecision(6)}: ${update.outcome}. Another tolerance or another start may help.`);
  }

  refuse(message: string): void {
    tell(`The core refuses this: ${message}`);
  }

  /** Has its orbits computed by a worker. */
  follow(client: Client): void {
    this.client = client;
    this.run();
  }

  async begin(): Promise<void> {
    const { address } = place();
    let { state } = this;
    const isTour = this.tours.isLink(address);
    if (address && !isTour) {
      try {
        state = read(this.system, address);
      } catch (error) {
        tell(`This address cannot be read: ${(error as Error).message}. The page shows the start that it carries instead.`);
      }
    }
    place().follow({ adopt: (...said) => this.adopt(...said), tell });
    this.open(state);
    try {
      this.follow(await Client.start((update) => this.take(update), (message) => this.refuse(message)));
      if (isTour) this.tours.follow(address);
    } catch (error) {
      tell(`The core did not start: ${(error as Error).message}. The laboratory needs WebAssembly with vector instructions and workers.`);
    }
  }
}

/** A name that leaves room for the number of crossings beside it. */
function shortened(name: string): string {
  return name.length > MOST_LETTERS ? `${name.slice(0, MOST_LETTERS - 1).trimEnd()}…` : name;
}

const TURNS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };

/** The page of the system that it carries. */
export function start(): void {
  let page: SystemPage;
  try {
    page = new SystemPage(described(document.getElementById(CARRIED)?.textContent ?? ""));
  } catch (error) {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.shown = dark ? "dark" : "light";
    document.documentElement.dataset.broken = "1";
    tell(`The system of this page cannot be shown: ${(error as Error).message}.`);
    return;
  }
  void page.begin();
}
