/** How far each invariant is from its value at the start, both axes logarithmic. */

import type { Results } from "../results";
import { OF_TOPS, type Charted, type Clock } from "../state/charted";
import type { Palette } from "../style/palette";
import { element } from "../symbols";
import { Plot } from "./plot";
import { remarkIn, setText } from "./remark";

/** Below it, nothing can be seen of a double near one. */
const LEAST = 1e-17;
/** Places on the axis of time; where more times fall on one, the largest is drawn. */
const PLACES = 160;

/** A curve of the chart. */
export interface Key {
  readonly name: string;
  readonly colour: string;
  readonly dash: readonly number[];
}

const LABEL = "Drift of the invariants";

export class DriftPanel {
  readonly plot: Plot;
  private readonly head: HTMLElement;
  private readonly remark: HTMLElement;
  private drawn = "";
  private results: Results | null = null;

  constructor(panel: HTMLElement, private readonly clock: Clock = OF_TOPS) {
    this.plot = new Plot(panel, LABEL);
    this.head = panel.querySelector("p") as HTMLElement;
    this.remark = remarkIn(panel);
  }

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const { drift } = results;
    const key = `${drift.length} ${results.names.length} ${palette.dark} ${palette.panel}`;
    if (plot.measure() || key !== this.drawn || results !== this.results) {
      const colours = coloursOf(palette);
      if (results !== this.results || !this.drawn.endsWith(palette.panel) || !this.head.childElementCount) this.legend(results, colours);
      [this.drawn, this.results] = [key, results];
      const found = drift.rows.reduce((most, row) => row.reduce((a, b) => Math.max(a, Math.abs(b)), most), 0);
      const largest = Math.max(found, 1e-13);
      plot.canvas.setAttribute("aria-label", drift.length ? `${LABEL}, at most ${found.toPrecision(2)} up to t = ${Math.round(drift.times[drift.length - 1]).toLocaleString("en")}` : LABEL);
      plot.x = { range: [this.clock.unit, this.clock.horizon], log: true, name: "t" };
      plot.y = { range: [LEAST, Math.max(largest * 8, 1e-11)], log: true, name: "" };
      plot.axes(palette);
      this.curves(results, colours);
    }
    setText(this.remark, results.opened && results.names.length === 0 ? "No invariant of this system is known." : "");
    plot.clearAbove();
    plot.cursor(lab.time, palette);
  }

  private curves({ drift, names }: Results, colours: readonly string[]): void {
    const { plot } = this;
    const { unit, horizon } = this.clock;
    const reach = horizon / unit;
    const c = plot.below;
    c.save();
    plot.clip(c);
    c.lineWidth = 1.4;
    c.lineJoin = "round";
    names.forEach((_, column) => {
      c.strokeStyle = colours[column % colours.length];
      c.setLineDash(DASHES[column % DASHES.length]);
      c.beginPath();
      let [place, most] = [-1, 0];
      const mark = () => place >= 0 && c.lineTo(plot.px(unit * reach ** (place / PLACES)), plot.py(Math.max(most, LEAST)));
      drift.rows.forEach((row, k) => {
        const next = Math.floor((Math.log(drift.times[k] / unit) / Math.log(reach)) * PLACES);
        if (next !== place) {
          mark();
          [place, most] = [next, 0];
        }
        most = Math.max(most, Math.abs(row[column]));
      });
      mark();
      c.stroke();
    });
    c.restore();
  }

  /** Which curve is which, for a picture without the page around it. */
  keys({ names }: Results, palette: Palette): Key[] {
    const colours = coloursOf(palette);
    return names.map((name, k) => ({ name, colour: colours[k % colours.length], dash: DASHES[k % DASHES.length] }));
  }

  private legend({ names }: Results, colours: readonly string[]): void {
    this.head.replaceChildren(
      ...names.flatMap((name, k) => {
        const key = document.createElement("span");
        key.className = "key";
        key.style.borderTopColor = colours[k % colours.length];
        if (DASHES[k % DASHES.length].length) key.style.borderTopStyle = "dashed";
        return [key, element(name)];
      }),
    );
    this.head.title = "Distance from the value at the start";
  }
}

const DASHES: readonly number[][] = [[], [], [5, 3], [], [2, 2], [6, 2, 2, 2]];

function coloursOf(palette: Palette): string[] {
  return [palette.ink, palette.alpha, palette.l, palette.beta, palette.b, palette.a];
}
