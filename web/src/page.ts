/**
 * What every page does: it holds the state, hands it to the panels and the orbit to a worker, and listens to buttons, keys and
 * what comes from outside.  That of tops adds the body with its parameters, that of a system its views.
 */

import "./style/page.css";
import { exports, pictureOf, tables, type Chart, type Now } from "./export/charts";
import { menu, savePicture } from "./export/menu";
import { DriftPanel } from "./panels/drift";
import { fillHelp, openHelp, type Help } from "./panels/help";
import { LyapunovPanel } from "./panels/lyapunov";
import { PortraitPanel } from "./panels/portrait";
import { SectionPanel } from "./panels/section";
import { ShareDialog } from "./panels/share";
import { Tours } from "./panels/tour";
import { Results } from "./results";
import type { Charted, Clock, Coordinates } from "./state/charted";
import { THEMES, type Everyday, type EverydayAction } from "./state/everyday";
import { shortest, type Exact } from "./state/exact";
import { place, withPartsOf } from "./state/place";
import { PRISTINE } from "./state/pristine";
import { palette as currentPalette, type Palette } from "./style/palette";
import { plain } from "./symbols";
import type { SystemDescription } from "./systems/description";
import type { FanJob } from "./fan/computation";
import { FanSection } from "./fan/panel";
import { Client } from "./worker/client";
import type { Job, SystemJob, Update } from "./worker/messages";

/** A step, of a frame at speed 1, and how far the motion is computed ahead: in units of time. */
const STEP = 1 / 60;
const AHEAD = 60;
/** Charts that do not move are looked at every so many frames. */
const CHARTS_EVERY = 6;
/** A projection has converged where no equation is off by more. */
const CONVERGED = 1e-13;
const TURNS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };

export const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const { query } = place();
/** The frame at which the page stands still, for pictures and tests. */
export const still = /^\d{1,6}$/.test(query.get("still") ?? "") ? Number(query.get("still")) : null;
export const quality = (["low", "full"] as const).find((one) => one === query.get("quality")) ?? null;

/** A message, which stays until it is closed; "" closes it. */
export function tell(message: string): void {
  const box = find("message");
  (box.firstElementChild as HTMLElement).textContent = message;
  box.hidden = message === "";
  place().report(message);
}
/** Whether what is typed cannot be read, and an older system is shown. */
const isStale = () => document.documentElement.hasAttribute("data-stale");
/** What is said to those who do not see it. */
export const say = (text: string) => (find("said").textContent = text);

find("message").querySelector("button")?.addEventListener("click", () => tell(""));

/** What a page is of. */
export interface Kind {
  /** That whose section is filled. */
  readonly system: SystemDescription;
  readonly coordinates: Coordinates;
  readonly clock: Clock;
  /** Numbers of a row of the motion. */
  readonly width: number;
  /** To whose values the start can be moved. */
  readonly conserved: readonly string[];
  readonly help: Help;
}

/** The view of the motion. */
export interface View {
  dirty: boolean;
  /** Whether the processor draws it, which is then given half of the frames. */
  readonly software: boolean;
  turn(azimuth: number, polar: number): void;
}

export abstract class Page<State extends Everyday, Action extends { readonly do: string }> {
  protected results: Results;
  protected palette: Palette = currentPalette();
  protected client: Client | null = null;
  protected readonly section: SectionPanel;
  protected readonly fan: FanSection;
  protected readonly portrait: PortraitPanel;
  protected readonly lyapunov: LyapunovPanel;
  protected readonly drift: DriftPanel;
  protected readonly tours: Tours<State>;
  /** Ends what listens to the window, and the frames. */
  protected readonly gone = new AbortController();
  private asked = 0;
  private readonly dialog = new ShareDialog(find<HTMLDialogElement>("sharing"), say);

  constructor(protected state: State, protected readonly kind: Kind) {
    const { system, coordinates, clock, width, help } = kind;
    this.results = new Results(width);
    this.section = new SectionPanel(find("section"), (from) => this.startAt(from), say, coordinates, clock);
    const act = (action: EverydayAction) => this.act(action);
    this.fan = new FanSection(find("section"), this.section.plot, system, { act, start: (from, words) => this.startAt(from, words), say });
    this.portrait = new PortraitPanel(find("portrait"), coordinates, clock);
    this.lyapunov = new LyapunovPanel(find("lyapunov"), clock);
    this.drift = new DriftPanel(find("drift"), clock);
    this.tours = new Tours<State>(find<HTMLDialogElement>("tours"), find<HTMLDialogElement>("tour"), {
      system: () => this.ofTours(),
      now: () => this.state,
      set: (to) => this.set(withPartsOf(this.state, to)),
      read: (address) => ({ ...this.readStep(address), theme: this.state.theme, playing: this.state.playing }),
      tell,
    });
    fillHelp(find<HTMLDialogElement>("keys"), help);
    this.saving();
  }

  /** What follows an action.  Throws `Refused`. */
  protected abstract changed(state: State, action: Action | EverydayAction): State;
  /** Whether the same orbit and crossings are computed. */
  protected abstract sameRun(one: State, other: State): boolean;
  protected abstract job(): Job | SystemJob;
  protected abstract fanJob(): FanJob;
  protected abstract charted(): Charted;
  protected abstract get view(): View;
  /** Shows what changes with the state, not with time. */
  protected abstract shows(): void;
  /** Draws the motion, and what goes with it, at the time of the state. */
  protected abstract draws(charted: Charted): void;
  /** The state of an address.  Throws `Refused`. */
  protected abstract read(address: string): State;
  /** The whole address. */
  protected abstract written(): string;
  /** What is shown where an address cannot be read. */
  protected abstract readonly instead: string;
  /** The lines of Python that compute the same; "" where there are none. */
  protected abstract lines(): string;
  /** What a picture or table says of the system. */
  protected abstract exported(): Pick<Now, "file" | "facts" | "columns" | "row">;
  /** The picture of the view, with a line of words. */
  protected abstract picture(title: string): HTMLCanvasElement;
  /** What keys do that only this page has; those of numbers from 1 on. */
  protected abstract readonly keys: Readonly<Record<string, () => void>>;
  protected abstract numbered(number: number): (() => void) | undefined;

  /** The system of the guided tours that it can show; none for those of tops. */
  protected ofTours(): string | undefined {
    return undefined;
  }

  /** Begins a guided tour of those that the page brings. */
  guide(number: string): void {
    this.tours.follow(`tour=${number}`);
  }

  /** The state of a step of a tour. */
  protected readStep(address: string): State {
    return this.read(address);
  }

  /** The one way in which the state changes. */
  protected act(action: Action | EverydayAction): void {
    let next = this.state;
    try {
      next = this.changed(this.state, action);
    } catch (error) {
      tell((error as Error).message);
    }
    this.set(next);
  }

  protected set(next: State): void {
    const before = this.state;
    this.state = next;
    if (!this.sameRun(before, next)) this.run();
    this.show();
  }

  /** What was told of the present run. */
  private toldOfRun = "";

  private tellOfRun(message: string): void {
    this.toldOfRun = message;
    tell(message);
  }

  protected run(): void {
    // what was said of another orbit does not hold of this one
    if (this.toldOfRun !== "" && find("message").firstElementChild?.textContent === this.toldOfRun) tell("");
    this.toldOfRun = "";
    this.results = new Results(this.kind.width);
    delete document.documentElement.dataset.ready;
    this.asked = 0;
    const { unit, horizon } = this.kind.clock;
    if (still !== null) this.state = { ...this.state, time: Math.min(still * STEP * this.state.speed * unit, horizon) };
    this.client?.run(this.job());
  }

  protected startAt(state: ArrayLike<number>, words = "a new orbit starts at the crossing"): void {
    try {
      this.act({ do: "start at", state: Array.from(state, shortest) });
      say(words);
    } catch (error) {
      tell((error as Error).message);
    }
  }

  /** Moves the start to the nearest state with these values of energy and Casimirs; the others keep theirs. */
  protected async startOn(entered: Readonly<Record<string, Exact>>): Promise<void> {
    if (!this.client) return;
    const [before, { names, first }] = [this.state, this.results];
    const kept = Object.fromEntries(names.flatMap((name, k) => (this.kind.conserved.includes(name) ? [[name, first[k]]] : [])));
    const wanted = { ...kept, ...Object.fromEntries(Object.entries(entered).map(([name, to]) => [name, to.value])) };
    try {
      const { state, residuals } = await this.client.project(this.job(), wanted);
      if (!this.sameMotion(before, this.state)) return;
      const [worst, off] = Object.entries(residuals).reduce((a, b) => (Math.abs(b[1]) > Math.abs(a[1]) ? b : a));
      if (!(Math.abs(off) <= CONVERGED)) {
        const values = Object.entries(wanted).map(([name, value]) => `${plain(name)} = ${Number(value.toPrecision(6))}`).join(", ");
        tell(`No state with ${values} was found near this start: Newton's method ends where ${plain(worst)} is off by ${Math.abs(off).toPrecision(1)} of its size. Values may exclude one another; try one nearer to the present.`);
        return;
      }
      this.startAt(state, "the start has these values");
    } catch (error) {
      tell(`The start cannot be moved there: ${(error as Error).message}`);
    }
  }

  protected show(): void {
    const { theme, playing, speed } = this.state;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.shown = theme === "auto" ? (dark ? "dark" : "light") : theme;
    this.palette = currentPalette();
    const play = find("play");
    play.textContent = playing ? "❚❚" : "▶";
    play.setAttribute("aria-label", playing ? "Pause" : "Play");
    const slider = find<HTMLInputElement>("speed");
    slider.value = String(Math.log2(speed));
    slider.style.setProperty("--fill", `${((Math.log2(speed) + 4) / 8) * 100}%`);
    find("rate").textContent = speed < 1 ? `1/${1 / speed}×` : `${speed}×`;
    this.fan.want(this.fanJob());
    this.section.use(!this.fan.isShown);
    this.shows();
    this.view.dirty = true;
    place().keep(() => this.written(), playing);
  }

  /** The state as somebody outside set it: what it leaves as it was goes on. */
  adopt(address: string, playing: boolean, sameTime: boolean): void {
    const before = this.state;
    let next = before;
    try {
      next = withPartsOf(before, { ...this.read(address), playing });
      if (sameTime && this.sameMotion(before, next)) next = { ...next, time: before.time };
    } catch (error) {
      tell(`This state cannot be shown: ${(error as Error).message}.`);
    }
    this.set(next);
  }

  /** Whether the same orbit moves. */
  protected sameMotion(one: State, other: State): boolean {
    return one.start === other.start;
  }

  private header(): void {
    const { signal } = this.gone;
    const on = (id: string, does: () => void) => find(id).addEventListener("click", does, { signal });
    on("share", () => this.sharing());
    on("python", () => void this.python());
    on("guide", () => this.tours.choose());
    on("theme", () => this.nextTheme());
    on("help", () => openHelp(find<HTMLDialogElement>("keys")));
    on("play", () => this.play());
    on("restart", () => this.act({ do: "time", time: 0 }));
    on("step", () => this.step(1));
    find("speed").addEventListener("input", (event) => this.act({ do: "speed", speed: 2 ** Number((event.target as HTMLInputElement).value) }), { signal });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(), { signal });
    document.querySelector(".skip")?.addEventListener("click", (event) => {
      // the address is not for the place in the page
      event.preventDefault();
      find("scene").focus();
    }, { signal });
    document.addEventListener("keydown", (event) => this.key(event), { signal });
  }

  /** Buttons at the head of the page, each with a key for whether it is chosen. */
  protected buttons(label: string, entries: readonly (readonly [key: string, title: string, words: string, act: () => void])[]): void {
    const nav = find("presets");
    nav.setAttribute("aria-label", label);
    nav.replaceChildren(
      ...entries.map(([key, title, words, act]) => {
        const button = document.createElement("button");
        const small = document.createElement("small");
        small.textContent = words;
        button.type = "button";
        button.dataset.key = key;
        button.append(title, small);
        button.addEventListener("click", act);
        return button;
      }),
    );
  }

  protected choose(key: string | null): void {
    const nav = find("presets");
    for (const button of nav.querySelectorAll("button")) {
      const chosen = button.dataset.key === key;
      button.setAttribute("aria-pressed", String(chosen));
      if (chosen) nav.scrollLeft = button.offsetLeft - nav.offsetLeft - 60;
    }
  }

  private play(): void {
    this.act({ do: "play", playing: !this.state.playing });
  }

  private async share(): Promise<void> {
    tell(await place().share(this.written()));
  }

  private sharing(): void {
    const title = [find("title").textContent, "the laboratory of liepoisson"].filter(Boolean).join(", ");
    this.dialog.open({ base: location.href.split(/[?#]/)[0], address: this.written(), title, file: this.exported().file, pristine: PRISTINE, moves: this.state.playing, isStale: isStale() });
  }

  /** The lines of Python; where there is no clipboard, in a dialog from which they can be copied. */
  private async python(): Promise<void> {
    const lines = this.lines();
    if (!lines) return;
    try {
      await navigator.clipboard.writeText(lines);
      tell(isStale() ? "What is typed cannot be read: the copied lines are of the system before, which is shown." : "The lines of Python that compute this orbit are copied.");
    } catch {
      const dialog = find<HTMLDialogElement>("lines");
      const text = dialog.querySelector("textarea") as HTMLTextAreaElement;
      text.value = lines;
      dialog.showModal();
      text.select();
    }
  }

  private nextTheme(): void {
    const theme = THEMES[(THEMES.indexOf(this.state.theme) + 1) % THEMES.length];
    this.act({ do: "theme", theme });
    say(`theme: ${theme}`);
  }

  private step(sign: number): void {
    const { time, speed } = this.state;
    this.act({ do: "play", playing: false });
    this.act({ do: "time", time: Math.min(time + sign * STEP * speed * this.kind.clock.unit, Math.max(this.results.top.end, 0)) });
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea, dialog[open], .formulas")) return;
    if (event.key === " " && target.closest("button, summary")) return;
    const everywhere: Readonly<Record<string, () => void>> = {
      " ": () => this.play(),
      ArrowRight: () => this.step(1),
      ArrowLeft: () => this.step(-1),
      "+": () => this.act({ do: "speed", speed: this.state.speed * 2 }),
      "-": () => this.act({ do: "speed", speed: this.state.speed / 2 }),
      r: () => this.act({ do: "time", time: 0 }),
      t: () => this.nextTheme(),
      s: () => void this.share(),
      e: () => this.sharing(),
      p: () => void this.python(),
      h: () => this.tours.choose(),
      "?": () => openHelp(find<HTMLDialogElement>("keys")),
    };
    const turn = event.shiftKey ? TURNS[event.key] : undefined;
    const number = /^[1-9]$/.test(event.key) ? this.numbered(Number(event.key)) : undefined;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const does = turn ? () => this.view.turn(...turn) : (number ?? this.keys[key] ?? everywhere[key]);
    if (!does) return;
    event.preventDefault();
    does();
  }

  /** What is shown, for pictures and tables. */
  private shown(): Now {
    const { results, palette, kind: { clock, coordinates: { components } } } = this;
    return { charted: this.charted(), results, palette, clock, components, ...this.exported() };
  }

  /** Menus of pictures and tables in all panels. */
  private saving(): void {
    const now = () => this.shown();
    const { fan, section, portrait, lyapunov, drift } = this;
    const sections: Chart = {
      plot: section.plot,
      draw: (...what) => (fan.isShown ? fan : section).draw(...what),
      about: () => (fan.isShown ? fan.summary() : ""),
    };
    exports(find("section"), "section", sections, (what) => (fan.isShown ? fan.table() : tables.section(what)), now);
    exports(find("portrait"), "portrait", portrait, tables.portrait, now);
    exports(find("lyapunov"), "exponent", lyapunov, tables.lyapunov, now);
    exports(find("drift"), "drift", drift, tables.drift, now);
    const title = () => ["title", "subtitle", "clock"].map((id) => find(id).textContent).filter(Boolean).join(", ");
    menu(find("scene"), "view", [["picture, PNG", () => savePicture(`${this.exported().file}-${this.viewName()}.png`, this.picture(title()))]]);
  }

  /** The picture of a view in the plane. */
  protected flatPicture(chart: Chart, title: string): HTMLCanvasElement {
    return pictureOf(chart, title, this.shown());
  }

  /** With which the name of a picture of the view ends. */
  protected abstract viewName(): string;

  private frames = 0;
  private before = 0;
  private readonly spent: number[] = [];

  private frame(now: number): void {
    if (this.gone.signal.aborted) return;
    const began = performance.now();
    const passed = Math.min((now - this.before) / 1000, 0.1);
    this.before = now;
    const { state, kind: { clock } } = this;
    if (state.playing && still === null) {
      // a time from the address waits for the motion to come so far
      const time = Math.max(state.time, Math.min(state.time + passed * state.speed * clock.unit, this.results.top.end));
      if (time !== state.time) this.state = this.changed(state, { do: "time", time });
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

  private drawn: { at: number; of: Results | null; chunks: number; levels: unknown; size: string } = { at: -1, of: null, chunks: 0, levels: null, size: "" };
  /** Milliseconds from the request of the page to the first drawn state. */
  private firstPicture = 0;

  private draw(): void {
    const { results, state, palette, frames, view } = this;
    const charted = this.charted();
    const [chunks, size] = [results.top.chunks.length + results.shadow.chunks.length, `${innerWidth} ${innerHeight}`];
    const { drawn } = this;
    const moved = state.time !== drawn.at || results !== drawn.of || chunks !== drawn.chunks || results.levels !== drawn.levels || size !== drawn.size;
    if ((moved || view.dirty) && (!view.software || frames % 2 === 0)) {
      this.portrait.draw(charted, results, palette);
      this.draws(charted);
      this.drawn = { at: state.time, of: results, chunks, levels: results.levels, size };
      if (chunks > 0 && this.firstPicture === 0) this.firstPicture = performance.now();
    }
    (this.fan.isShown ? this.fan : this.section).draw(charted, results, palette);
    this.drawsSection();
    if (frames % CHARTS_EVERY === 0) this.lyapunov.draw(charted, results, palette);
    if (frames % CHARTS_EVERY === CHARTS_EVERY / 2) {
      this.drift.draw(charted, results, palette);
      this.drawsSeldom();
    }
    if (still !== null && this.drawn.of === results && results.finished && results.top.end >= state.time && frames > 30) document.documentElement.dataset.ready = "1";
  }

  /** Adds to the section. */
  protected drawsSection(): void {}

  /** Shows what takes its time. */
  protected drawsSeldom(): void {}

  /** Shows a state, and begins to draw. */
  open(state: State): void {
    this.state = state;
    this.header();
    const { playing } = place();
    if (matchMedia("(prefers-reduced-motion: reduce)").matches || still !== null || playing === false) this.state = { ...this.state, playing: false };
    // for tests: what the page has computed, and how long a frame took our own code
    Object.assign(window, {
      laboratory: {
        state: () => this.state,
        results: () => this.results,
        fan: () => this.fan.now,
        frameTimes: () => [...this.spent],
        sectionRange: () => this.section.plot.x.range,
        firstPicture: () => this.firstPicture,
        isLowQuality: () => this.view.software,
        python: () => this.lines(),
        ...this.forTests(),
      },
    });
    this.show();
    requestAnimationFrame((now) => this.frame(now));
  }

  protected forTests(): object {
    return {};
  }

  /** What the worker has found. */
  take(update: Update): void {
    this.results.take(update);
    if (update.say === "ended") this.tellOfRun(`The orbit ends at t = ${update.time.toPrecision(6)}: ${update.outcome}. Another tolerance or another start may help.`);
  }

  refuse(message: string): void {
    this.tellOfRun(`The core refuses this: ${message}`);
  }

  /** Has its orbits computed by a worker. */
  follow(client: Client): void {
    this.client = client;
    this.run();
  }

  get now(): State {
    return this.state;
  }

  /** Leaves its panels to another page. */
  leave(): void {
    this.gone.abort();
    this.fan.free();
  }

  /** Opens with what the address says. */
  async begin(): Promise<void> {
    const { address } = place();
    let { state } = this;
    const isTour = this.tours.isLink(address);
    if (address && !isTour) {
      try {
        state = this.read(address);
      } catch (error) {
        tell(`This address cannot be read: ${(error as Error).message}. The page shows ${this.instead} instead.`);
      }
    }
    place().follow({ adopt: (...said) => this.adopt(...said), tell });
    this.open(state);
    try {
      this.follow(await Client.start((update) => this.take(update), (message) => this.refuse(message)));
      if (isTour) this.tours.follow(address);
    } catch (error) {
      notStarted(error as Error);
    }
  }
}

/** Says that the core did not start. */
export function notStarted(error: Error): void {
  tell(`The core did not start: ${error.message}. The laboratory needs WebAssembly with vector instructions and workers.`);
}
