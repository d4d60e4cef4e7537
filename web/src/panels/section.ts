/** Crossings of the surface in two components, coloured by their time.  A click on one starts there. */

import type { Results } from "../results";
import { COORDINATES_OF_TOPS, OF_TOPS, type Charted, type Clock, type Coordinates } from "../state/charted";
import { within } from "../state/turn";
import { timeColour, type Palette } from "../style/palette";
import { element, plain } from "../symbols";
import { padded, Plot } from "./plot";
import { remarkIn, setText } from "./remark";

/** How near the pointer must be, in pixels. */
const REACH = 12;

export class SectionPanel {
  readonly plot: Plot;
  /** Whether it has the canvas, and hears of the pointer and the keys. */
  private active = true;
  private drawn = 0;
  /** Crossings that the axes were fitted to. */
  private fitted = 0;
  private shown: unknown = null;
  private chosen: number | null = null;
  private readonly head: HTMLElement;
  private readonly remark: HTMLElement;

  constructor(panel: HTMLElement, private readonly start: (state: Float64Array) => void, private readonly said: (text: string) => void, private readonly coordinates: Coordinates = COORDINATES_OF_TOPS, private readonly clock: Clock = OF_TOPS) {
    this.plot = new Plot(panel, "Poincaré section");
    this.plot.zoomable();
    this.head = panel.querySelector("p") as HTMLElement;
    this.remark = remarkIn(panel);
    const { canvas } = this.plot;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", label("Crossings of the section"));
    canvas.addEventListener("pointermove", (event) => (this.chosen = this.active ? this.near(event.offsetX, event.offsetY) : null));
    canvas.addEventListener("pointerleave", () => (this.chosen = null));
    canvas.addEventListener("click", (event) => this.active && this.begin(this.near(event.offsetX, event.offsetY)));
    canvas.addEventListener("keydown", (event) => this.active && this.key(event));
  }

  /** Leaves its canvas to others, or takes it again. */
  use(active: boolean): void {
    if (active && !this.active) this.shown = null;
    if (!active) setText(this.remark, "");
    this.active = active;
  }

  private results: Results | null = null;
  private columns: readonly [number, number] = [0, 1];

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const sign = lab.direction === 0 ? " ↕" : lab.direction > 0 ? " ↑" : " ↓";
    const key = [results, lab.axes.join(), palette].map(String).join() && `${lab.axes.join()} ${palette.dark} ${palette.panel}`;
    const { components, turns } = this.coordinates;
    this.columns = [components.indexOf(lab.axes[0]), components.indexOf(lab.axes[1])];
    const { rows, times } = results.crossings;
    if (results !== this.results) this.chosen = null; // a crossing of another orbit
    const outside = !plot.isZoomed && rows.slice(this.drawn).some((row) => !plot.holds(plot.px(row[this.columns[0]]), plot.py(row[this.columns[1]])));
    // axes that were drawn before there was a crossing are of nothing
    const isFirst = this.fitted === 0 && rows.length > 0;
    if (plot.measure() || results !== this.results || key !== this.shown || outside || isFirst) {
      this.fitted = rows.length;
      [this.results, this.shown, this.drawn] = [results, key, 0];
      const [x, y] = this.columns.map((column) => {
        const turn = turns[column];
        const values = rows.map((row) => within(row[column], turn));
        const range = values.length ? padded([values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))], turn, results.top.least(column, components.length)) : ([-1, 1] as const);
        return { range, name: components[column], turn };
      });
      plot.fit(x, y);
      plot.axes(palette);
    }
    if (this.drawn < rows.length || rows.length === 0) this.heading(lab, sign, rows.length, palette);
    const size = rows.length > 3000 ? 1.5 : 1.9;
    for (; this.drawn < rows.length; this.drawn++) {
      const [x, y] = this.place(rows[this.drawn]);
      if (plot.isZoomed && !plot.holds(x, y)) continue;
      plot.below.fillStyle = timeColour(times[this.drawn] / this.clock.horizon, palette.dark);
      plot.below.beginPath();
      plot.below.arc(x, y, size, 0, 7);
      plot.below.fill();
    }
    const none = rows.length === 0 && results.until >= this.clock.horizon ? `Up to t = ${Number(results.until.toPrecision(3))} the orbit does not cross the surface in this direction.` : "";
    setText(this.remark, lab.remark ?? none);
    plot.clearAbove();
    const last = results.crossings.before(lab.time);
    if (last >= 0 && plot.holds(...this.place(rows[last]))) ring(plot.above, this.place(rows[last]), palette.l, 6);
    if (this.chosen !== null && rows[this.chosen]) this.hover(rows[this.chosen], times[this.chosen], palette);
  }

  private heading(lab: Charted, sign: string, count: number, palette: Palette): void {
    const scale = document.createElement("span");
    scale.className = "scale";
    scale.style.background = `linear-gradient(90deg, ${[0, 0.25, 0.5, 0.75, 1].map((part) => timeColour(part, palette.dark)).join(",")})`;
    const bold = document.createElement("b");
    bold.textContent = count.toLocaleString("en");
    // a modulus leaves no room for the word, nor do a narrow page and large letters
    const [modulo, text] = lab.modulus ? [` mod ${lab.modulus}`, ""] : ["", count === 1 ? " crossing" : " crossings"];
    const words = Object.assign(document.createElement("span"), { className: "words", textContent: text });
    this.head.replaceChildren(element("t"), scale, element(lab.surface), ` = 0${modulo}${sign} · `, bold, words);
    const way = ["fall through", "cross", "rise through"][lab.direction + 1];
    this.plot.canvas.setAttribute("aria-label", label(`${bold.textContent}${count === 1 ? " crossing" : " crossings"} that ${way} ${plain(lab.surface)} = 0${modulo}`));
    this.head.setAttribute("title", "Crossings that rise (↑), fall (↓), or both (↕); early ones violet, late ones yellow.");
  }

  private hover(row: Float64Array, time: number, palette: Palette): void {
    const { above, width } = this.plot;
    const [x, y] = this.place(row);
    ring(above, [x, y], palette.accent, 7);
    const text = `t = ${time.toFixed(1)} · click to start here`;
    above.font = `12px "Inter Variable", sans-serif`;
    const wide = above.measureText(text).width + 14;
    const left = Math.min(Math.max(x - wide / 2, 2), width - wide - 2);
    const top = y > 50 ? y - 34 : y + 14;
    above.fillStyle = palette.panel;
    above.strokeStyle = palette.accent;
    above.beginPath();
    above.roundRect(left, top, wide, 22, 6);
    above.fill();
    above.stroke();
    above.fillStyle = palette.ink;
    above.textAlign = "left";
    above.fillText(text, left + 7, top + 15);
  }

  private place(row: Float64Array): [number, number] {
    return [this.plot.px(row[this.columns[0]]), this.plot.py(row[this.columns[1]])];
  }

  private near(x: number, y: number): number | null {
    let [best, nearest]: [number, number | null] = [REACH ** 2, null];
    this.results?.crossings.rows.forEach((row, k) => {
      const at = this.place(row);
      const distance = (at[0] - x) ** 2 + (at[1] - y) ** 2;
      if (distance < best) [best, nearest] = [distance, k];
    });
    return nearest;
  }

  private begin(index: number | null): void {
    const row = index === null ? undefined : this.results?.crossings.rows[index];
    this.chosen = null;
    if (row) this.start(row);
  }

  private key(event: KeyboardEvent): void {
    const count = this.results?.crossings.length ?? 0;
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (step && count) {
      this.chosen = ((this.chosen ?? (step > 0 ? -1 : count)) + step + count) % count;
      const row = this.results!.crossings.rows[this.chosen];
      const { components, turns } = this.coordinates;
      const place = this.columns.map((column) => `${plain(components[column])} = ${within(row[column], turns[column]).toPrecision(4)}`).join(", ");
      this.said(`crossing ${this.chosen + 1} of ${count}, t = ${this.results!.crossings.times[this.chosen].toFixed(2)}, ${place}`);
    } else if (event.key === "Enter") this.begin(this.chosen);
    else if (event.key === "Escape") this.chosen = null;
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

function label(what: string): string {
  return `${what}. Arrow keys choose one, Enter starts there.`;
}

function ring(c: CanvasRenderingContext2D, [x, y]: readonly [number, number], colour: string, radius: number): void {
  c.strokeStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  c.arc(x, y, radius, 0, 7);
  c.stroke();
  c.lineWidth = 1;
}
