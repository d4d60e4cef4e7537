/**
 * The section of many orbits at once.  The shape of a point, its colour and the list say which orbits are regular, chaotic or
 * undecided; a click adds the orbit through a point, and the pointer over a crossing shows all of its orbit.
 */

import type { Results } from "../results";
import { padded, type Plot } from "../panels/plot";
import { remarkIn, setText } from "../panels/remark";
import { FANS, type EverydayAction } from "../state/everyday";
import { shortest } from "../state/exact";
import type { Charted } from "../state/charted";
import { within } from "../state/turn";
import type { Palette } from "../style/palette";
import { element, plain } from "../symbols";
import type { Table } from "../export/table";
import type { SystemDescription } from "../systems/description";
import { FanClient } from "./client";
import { withoutFan, type FanJob, type FanUpdate, type Verdict } from "./computation";

interface Orbit {
  readonly added: number | null;
  readonly count: number;
  readonly crossings: Float64Array;
  verdict: Verdict | null;
  exponent: number;
  indicators: readonly number[];
}

interface Does {
  readonly act: (action: EverydayAction) => void;
  readonly start: (state: ArrayLike<number>, words?: string) => void;
  readonly say: (text: string) => void;
}

/** Milliseconds for which a slider rests before a fan is computed. */
const REST = 250;
/** How near the pointer must be, in pixels. */
const REACH = 10;
/** Digits of a point that is clicked, beyond which no pixel tells. */
const DIGITS = 5;
const NOTHING = { guesses: 0, failed: 0, uncrossed: 0, left: 0, last: false, nothing: "", end: 0 };
const VERDICTS = ["regular", "chaotic", "undecided"] as const;
const SHAPES: Record<Verdict, string> = { regular: "●", chaotic: "✕", undecided: "□" };

export class FanSection {
  private readonly client: FanClient;
  private orbits: Orbit[] = [];
  private about = { ...NOTHING };
  private wanted: FanJob | null = null;
  private job = "";
  private timer = 0;
  private finished = false;
  /** Of an earlier job, until the next one has its first orbit. */
  private old = false;
  private dirty = true;
  private shown = "";
  private chosen: number | null = null;
  private columns: readonly [number, number] = [0, 1];
  private readonly head: HTMLElement;
  private readonly remark: HTMLElement;
  private readonly bar = document.createElement("div");
  private readonly counts = document.createElement("p");
  private readonly count = document.createElement("select");
  private readonly status = document.createElement("p");
  private readonly list = document.createElement("div");
  private readonly listed = document.createElement("button");
  private readonly remove = document.createElement("button");
  /** The energy of all orbits, in words. */
  private energy = "";
  private began = 0;
  private took = 0;

  constructor(private readonly panel: HTMLElement, private readonly plot: Plot, private system: SystemDescription, private readonly does: Does) {
    this.client = new FanClient((update) => this.take(update), (message) => this.refuse(message));
    this.head = panel.querySelector("p") as HTMLElement;
    this.remark = remarkIn(panel);
    this.controls();
    const { canvas } = plot;
    canvas.addEventListener("pointermove", (event) => this.isShown && this.choose(this.near(event.offsetX, event.offsetY)));
    canvas.addEventListener("pointerleave", () => this.choose(null));
    canvas.addEventListener("click", (event) => this.isShown && this.add(event.offsetX, event.offsetY));
    canvas.addEventListener("keydown", (event) => this.isShown && this.key(event));
  }

  private controls(): void {
    const { bar, counts, count, status, list, listed, remove } = this;
    bar.className = "fan";
    count.setAttribute("aria-label", "Orbits in the section");
    Object.assign(listed, { type: "button", textContent: "List", title: "The orbits with their verdicts" });
    listed.setAttribute("aria-expanded", "false");
    listed.addEventListener("click", () => this.openList(list.hidden === true));
    Object.assign(remove, { type: "button", textContent: "Remove the added orbits" });
    remove.addEventListener("click", () => this.does.act({ do: "orbits", added: [] }));
    counts.className = "counts";
    status.className = "status";
    list.className = "orbits";
    list.hidden = true;
    list.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      this.openList(false);
      listed.focus();
    });
    count.addEventListener("change", () => this.does.act({ do: "fan", count: Number(count.value) }));
    bar.append(counts, status, listed, count);
    bar.hidden = withoutFan(this.system) !== null;
    this.panel.append(bar, list);
  }

  /** Whether the section is that of many orbits. */
  get isShown(): boolean {
    return (this.wanted?.count ?? 0) > 0;
  }

  /** What there is, for whoever tests the page. */
  get now() {
    const { orbits, about, finished, took, chosen, plot } = this;
    const n = this.system.components.length;
    const place = (state: ArrayLike<number>, from = 0) => [plot.px(state[from + this.columns[0]]), plot.py(state[from + this.columns[1]])];
    const places = () => orbits.map(({ crossings }) => Array.from({ length: crossings.length / n }, (_, k) => place(crossings, k * n)));
    return { orbits, about, finished, took, chosen, places };
  }

  free(): void {
    clearTimeout(this.timer);
    this.client.free();
  }

  /** The fan of a job is wanted, once the state rests; none, where it has no orbits. */
  want(wanted: FanJob): void {
    this.system = wanted.system;
    this.wanted = wanted;
    const job = wanted.count ? wanted : null;
    const key = JSON.stringify(job);
    this.dirty = true;
    this.options(wanted.count);
    if (key === this.job) return;
    const isFirst = this.job === "";
    this.job = key;
    this.finished = false;
    this.old = true;
    this.choose(null);
    if (job === null) this.empty();
    clearTimeout(this.timer);
    this.client.ask(null);
    this.timer = window.setTimeout(() => {
      this.began = performance.now();
      this.client.ask(job);
    }, isFirst || job === null ? 0 : REST);
  }

  private options(fan: number): void {
    const values = [...new Set([...FANS, ...(fan ? [fan] : [])])].sort((a, b) => a - b);
    const wanted = [...values.map(String), "0"];
    if (wanted.join() !== [...this.count.options].map((option) => option.value).join()) {
      this.count.replaceChildren(...wanted.map((value) => new Option(value === "0" ? "1 orbit" : `${value} orbits`, value)));
    }
    this.count.value = String(fan);
    const { bar, counts, listed, status } = this;
    bar.classList.toggle("off", fan === 0);
    counts.hidden = listed.hidden = status.hidden = fan === 0;
    if (fan === 0) {
      this.openList(false);
      setText(this.remark, "");
    }
    this.plot.canvas.classList.toggle("starts", fan > 0);
  }

  private empty(): void {
    this.old = false;
    this.orbits = [];
    this.about = { ...NOTHING };
    this.dirty = true;
  }

  private refuse(message: string): void {
    this.empty();
    this.finished = true;
    this.about.nothing = `The orbits could not be computed: ${message}.`;
  }

  private take(update: FanUpdate): void {
    if (update.say === "starts") {
      this.empty();
      Object.assign(this.about, { guesses: update.guesses, failed: update.failed, uncrossed: update.uncrossed, last: update.missed.includes((this.wanted?.added.length ?? 0) - 1) });
      if (this.about.last) this.does.say("no orbit of this energy goes through the point");
    } else if (update.say === "orbit") {
      this.orbits[update.index] = { ...update, verdict: null, exponent: Number.NaN, indicators: [] };
    } else if (update.say === "verdict") {
      const { verdict, exponent, indicators } = update;
      Object.assign(this.orbits[update.index], { verdict, exponent, indicators });
    } else if (update.say === "filled") {
      this.about.left = update.left;
    } else {
      this.finished = true;
      this.took = performance.now() - this.began;
      if (update.say === "nothing") this.about.nothing = update.why;
      else this.about.end = update.end;
      this.does.say(update.say === "nothing" ? update.why : this.summary());
    }
    this.dirty = true;
  }

  /** The orbits and their verdicts in words. */
  summary(): string {
    return VERDICTS.map((verdict) => `${this.number(verdict)} ${verdict}`).join(", ");
  }

  private number(verdict: Verdict): number {
    return this.orbits.filter((orbit) => orbit.verdict === verdict).length;
  }

  draw(charted: Charted, results: Results, palette: Palette): void {
    const { plot, orbits, system } = this;
    const { components, turns } = system;
    this.columns = [components.indexOf(charted.axes[0]), components.indexOf(charted.axes[1])];
    const key = `${charted.axes.join()} ${palette.dark} ${palette.panel}`;
    if (plot.measure() || this.dirty || key !== this.shown) {
      this.shown = key;
      this.dirty = false;
      const [x, y] = this.columns.map((column) => ({ range: this.range(column, results.top.least(column, components.length)), name: components[column], turn: turns[column] }));
      plot.fit(x, y);
      plot.axes(palette);
      const colours = verdictColours();
      plot.below.save();
      plot.clip(plot.below);
      plot.below.globalAlpha = this.old ? 0.35 : 1;
      orbits.forEach((orbit) => this.points(plot.below, orbit, colours[orbit.verdict ?? "none"], 1));
      plot.below.restore();
      this.heading(charted);
      this.words(colours);
    }
    setText(this.remark, charted.remark ?? this.about.nothing);
    const energy = results.first[results.names.indexOf("H")];
    const said = energy === undefined ? "" : `H = ${String(Number(energy.toPrecision(4))).replace("-", "−")}.`;
    if (said !== this.energy) {
      this.energy = said;
      this.describe();
    }
    plot.clearAbove();
    if (this.chosen !== null && orbits[this.chosen]) this.highlight(orbits[this.chosen], palette);
    this.follow(charted, results, palette);
  }

  private range(column: number, least: number): readonly [number, number] {
    const [n, turn] = [this.system.components.length, this.system.turns[column]];
    let [low, high] = [Infinity, -Infinity];
    for (const { crossings } of this.orbits) {
      for (let at = column; at < crossings.length; at += n) {
        const value = within(crossings[at], turn);
        [low, high] = [Math.min(low, value), Math.max(high, value)];
      }
    }
    return low <= high ? padded([low, high], turn, least) : [-1, 1];
  }

  /** The last crossing of the motion, as long as it is on the energy surface of the fan. */
  private follow(charted: Charted, results: Results, palette: Palette): void {
    const last = results.crossings.before(charted.time);
    if (last < 0 || this.old) return;
    const row = results.crossings.rows[last];
    const { above } = this.plot;
    const [x, y] = [this.plot.px(row[this.columns[0]]), this.plot.py(row[this.columns[1]])];
    if (!this.plot.holds(x, y)) return;
    above.strokeStyle = palette.ink;
    above.lineWidth = 2;
    above.beginPath();
    above.arc(x, y, 6, 0, 7);
    above.stroke();
    above.lineWidth = 1;
  }

  /** Dots of a regular orbit, crosses of a chaotic one, squares of one that is undecided. */
  private points(c: CanvasRenderingContext2D, { crossings, verdict }: Orbit, colour: string, size: number): void {
    const { plot } = this;
    const [n, [first, second]] = [this.system.components.length, this.columns];
    c.beginPath();
    c.strokeStyle = c.fillStyle = colour;
    c.lineWidth = 0.8 * size;
    for (let at = 0; at < crossings.length; at += n) {
      const [x, y] = [plot.px(crossings[at + first]), plot.py(crossings[at + second])];
      const half = (verdict === "chaotic" ? 1.25 : 1.1) * size;
      if (verdict === "chaotic") {
        c.moveTo(x - half, y - half);
        c.lineTo(x + half, y + half);
        c.moveTo(x - half, y + half);
        c.lineTo(x + half, y - half);
      } else if (verdict === "undecided") {
        c.rect(x - half, y - half, 2 * half, 2 * half);
      } else {
        c.moveTo(x + size, y);
        c.arc(x, y, size, 0, 7);
      }
    }
    if (verdict === "chaotic" || verdict === "undecided") c.stroke();
    else c.fill();
    c.lineWidth = 1;
  }

  private highlight(orbit: Orbit, palette: Palette): void {
    const { plot } = this;
    const c = plot.above;
    c.save();
    plot.clip(c);
    c.globalAlpha = 0.72;
    c.fillStyle = palette.panel;
    c.fillRect(0, 0, plot.width, plot.height);
    c.globalAlpha = 1;
    this.points(c, orbit, verdictColours()[orbit.verdict ?? "none"], 1.6);
    c.restore();
  }

  private heading(charted: Charted): void {
    const sign = charted.direction === 0 ? " ↕" : charted.direction > 0 ? " ↑" : " ↓";
    const bold = document.createElement("b");
    const all = this.orbits.reduce((sum, orbit) => sum + orbit.count, 0);
    bold.textContent = all.toLocaleString("en");
    const words = Object.assign(document.createElement("span"), { className: "words", textContent: " crossings" });
    const modulo = charted.modulus ? ` mod ${charted.modulus}` : "";
    this.head.replaceChildren(element(charted.surface), ` = 0${modulo}${sign} · `, bold, ...(modulo ? [] : [words]));
    this.head.setAttribute("title", "Crossings that rise (↑), fall (↓), or both (↕), of orbits with the energy and the Casimirs of the start.");
    const way = ["fall through", "cross", "rise through"][charted.direction + 1];
    this.plot.canvas.setAttribute("aria-label", `${this.orbits.length} orbits that ${way} ${plain(charted.surface)} = 0${modulo}: ${this.summary()}. A click adds the orbit through a point. Arrow keys choose an orbit, Enter follows it.`);
  }

  private words(colours: Record<Verdict | "none", string>): void {
    this.counts.replaceChildren(
      ...VERDICTS.map((verdict) => {
        const item = document.createElement("span");
        item.append(mark(verdict, colours[verdict]), ` ${this.number(verdict)} ${verdict}`);
        return item;
      }),
    );
    this.describe();
    if (!this.list.hidden) this.fill();
  }

  /** What is said below the section. */
  private describe(): void {
    const { orbits, about, chosen, finished } = this;
    const { guesses, failed, uncrossed, left, last } = about;
    const parts = [];
    if (chosen !== null && orbits[chosen]) parts.push(this.said(chosen));
    else if (!finished) parts.push(orbits.some(({ verdict }) => verdict) || orbits.length >= (this.wanted?.count ?? 0) ? "Deciding …" : "Filling the section …");
    else if (last) parts.push("No orbit of this energy goes through the last point.");
    else {
      if (this.energy) parts.push(this.energy);
      if (left) parts.push(`${left} escaping ${left === 1 ? "orbit" : "orbits"} left out.`);
      if (2 * (failed + uncrossed) > guesses) parts.push(`Of ${guesses} guesses ${failed} had no state of this energy, ${uncrossed} no crossing.`);
      parts.push("A click adds an orbit.");
    }
    const text = parts.join(" ");
    if (this.status.textContent === text) return;
    this.status.textContent = text;
    // it has two lines, so that the section keeps its size
    this.status.title = text;
  }

  /** Crossings of all orbits. */
  table(): Table {
    const { components } = this.system;
    const n = components.length;
    const rows = this.orbits.flatMap(({ crossings, verdict, exponent }, k) =>
      Array.from({ length: crossings.length / n }, (_, i) => [k + 1, verdict ?? "", verdict ? exponent : Number.NaN, ...crossings.subarray(i * n, (i + 1) * n)]),
    );
    const decided = this.about.end ? `, verdicts by the rule of liepoisson.decide at t = ${this.about.end}, exponents up to there` : "";
    return { what: `crossings of ${this.orbits.length} orbits with the energy and the Casimirs of the start${decided}`, columns: ["orbit", "verdict", "exponent", ...components], rows };
  }

  private said(index: number): string {
    const { verdict, exponent, count, added } = this.orbits[index];
    const kind = verdict ?? "not decided yet";
    return `Orbit ${index + 1}${added === null ? "" : ", added"}: ${kind}${verdict ? `, λ = ${exponentText(exponent)}` : ""}, ${count.toLocaleString("en")} crossings`;
  }

  private openList(open: boolean): void {
    this.list.hidden = !open;
    this.listed.setAttribute("aria-expanded", String(open));
    if (open) this.fill();
  }

  private fill(): void {
    const colours = verdictColours();
    const note = Object.assign(document.createElement("p"), { textContent: this.about.end ? `Decided at t = ${this.about.end} by the rule of liepoisson.decide. λ is the exponent up to there.` : "" });
    const rows = this.orbits.map((orbit, k) => {
      const row = document.createElement("button");
      row.type = "button";
      row.className = "orbit";
      row.title = "Follow this orbit";
      const number = Object.assign(document.createElement("span"), { textContent: `${k + 1}${orbit.added === null ? "" : "+"}` });
      const verdict = document.createElement("span");
      verdict.append(mark(orbit.verdict ?? "undecided", colours[orbit.verdict ?? "none"]), ` ${orbit.verdict ?? "…"}`);
      const exponent = Object.assign(document.createElement("span"), { textContent: orbit.verdict ? `λ = ${exponentText(orbit.exponent)}` : "" });
      row.append(number, verdict, exponent);
      row.addEventListener("click", () => this.begin(k));
      row.addEventListener("pointerenter", () => this.choose(k));
      row.addEventListener("focus", () => this.choose(k));
      return row;
    });
    const focused = [...this.list.querySelectorAll("button.orbit")].indexOf(document.activeElement as HTMLButtonElement);
    this.list.replaceChildren(note, ...(this.wanted?.added.length ? [this.remove] : []), ...rows);
    if (focused >= 0) rows[focused]?.focus();
  }

  private choose(index: number | null): void {
    if (index === this.chosen) return;
    this.chosen = index;
    this.describe();
  }

  private near(x: number, y: number): number | null {
    const { plot, orbits } = this;
    const [n, [first, second]] = [this.system.components.length, this.columns];
    let [best, nearest]: [number, number | null] = [REACH ** 2, null];
    orbits.forEach(({ crossings }, k) => {
      for (let at = 0; at < crossings.length; at += n) {
        const distance = (plot.px(crossings[at + first]) - x) ** 2 + (plot.py(crossings[at + second]) - y) ** 2;
        if (distance < best) [best, nearest] = [distance, k];
      }
    });
    return nearest;
  }

  private add(x: number, y: number): void {
    const point = this.plot.point(x, y);
    if (!point || !this.wanted) return;
    const [one, other] = point.map((value) => Number(value.toPrecision(DIGITS)));
    this.does.act({ do: "orbits", added: [...this.wanted.added, [one, other]] });
    this.does.say("an orbit is added through this point");
  }

  private begin(index: number | null): void {
    const orbit = index === null ? undefined : this.orbits[index];
    if (!orbit) return;
    this.openList(false);
    this.does.start(Array.from(orbit.crossings.slice(0, this.system.components.length), (value) => shortest(value).value), `the motion follows orbit ${(index as number) + 1}`);
  }

  private key(event: KeyboardEvent): void {
    const count = this.orbits.length;
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (step && count) {
      this.choose(((this.chosen ?? (step > 0 ? -1 : count)) + step + count) % count);
      this.does.say(this.said(this.chosen as number));
    } else if (event.key === "Enter") this.begin(this.chosen);
    else if (event.key === "Escape") this.choose(null);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** The sign of a verdict. */
function mark(verdict: Verdict, colour: string): HTMLElement {
  const sign = document.createElement("span");
  sign.className = "mark";
  sign.textContent = SHAPES[verdict];
  sign.style.color = colour;
  sign.setAttribute("aria-hidden", "true");
  return sign;
}

function verdictColours(): Record<Verdict | "none", string> {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return { regular: of("regular"), chaotic: of("chaotic"), undecided: of("undecided"), none: of("faint") };
}

function exponentText(value: number): string {
  return Number.isFinite(value) ? value.toPrecision(2).replace("-", "−") : "none";
}
