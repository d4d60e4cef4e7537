/** The orbit in the two components of the section, up to the time of the cursor. */

import { components as ofTops } from "../data/tops";
import type { Results } from "../results";
import { inUnits, OF_TOPS, type Charted, type Clock } from "../state/charted";
import { timeColour, type Palette } from "../style/palette";
import { padded, Plot, type Range } from "./plot";

/** Time units that are seen. */
export const PAST = 40;
const PIECES = 24;

export class PortraitPanel {
  readonly plot: Plot;
  private key = "";
  private results: Results | null = null;
  private ranges: [Range, Range] = [[Infinity, -Infinity], [Infinity, -Infinity]];
  private seen = 0;

  constructor(panel: HTMLElement, private readonly components: readonly string[] = ofTops, private readonly clock: Clock = OF_TOPS) {
    const past = `last ${inUnits(PAST, clock)} time units`;
    this.plot = new Plot(panel, `Phase portrait of the ${past}`);
    (panel.querySelector("p") as HTMLElement).textContent = past;
  }

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const columns = lab.axes.map((name) => this.components.indexOf(name));
    const key = `${lab.axes.join()} ${palette.dark} ${palette.panel}`;
    const anew = results !== this.results || key !== this.key;
    if (anew) [this.results, this.key, this.seen, this.ranges] = [results, key, 0, [[Infinity, -Infinity], [Infinity, -Infinity]]];
    const grown = this.look(results, columns);
    if (plot.measure() || anew || grown) {
      plot.x = { range: shown(this.ranges[0]), name: lab.axes[0] };
      plot.y = { range: shown(this.ranges[1]), name: lab.axes[1] };
      plot.axes(palette);
    }
    plot.clearAbove();
    this.line(lab.time, results, columns, palette);
  }

  /** Widens the ranges by what is new. */
  private look(results: Results, columns: readonly number[]): boolean {
    const { chunks } = results.top;
    if (this.seen === chunks.length) return false;
    for (; this.seen < chunks.length; this.seen++) {
      const { states } = chunks[this.seen];
      columns.forEach((column, axis) => {
        let [low, high] = this.ranges[axis];
        for (let at = column; at < states.length; at += results.width) [low, high] = [Math.min(low, states[at]), Math.max(high, states[at])];
        this.ranges[axis] = [low, high];
      });
    }
    return true;
  }

  private line(time: number, results: Results, columns: readonly number[], palette: Palette): void {
    const { plot } = this;
    const c = plot.above;
    const from = Math.max(0, time - PAST * this.clock.unit);
    const points: number[] = [];
    results.top.visit(from, time, (_, states, at) => points.push(plot.px(states[at + columns[0]]), plot.py(states[at + columns[1]])));
    const now = results.top.at(time);
    if (!now) return;
    points.push(plot.px(now[columns[0]]), plot.py(now[columns[1]]));
    const count = points.length / 2;
    c.save();
    plot.clip(c);
    c.lineJoin = "round";
    c.lineWidth = 1.5;
    for (let piece = 0; piece < PIECES; piece++) {
      const [first, last] = [Math.floor((piece * count) / PIECES), Math.min(Math.floor(((piece + 1) * count) / PIECES), count - 1)];
      c.strokeStyle = timeColour(piece / (PIECES - 1), palette.dark);
      c.globalAlpha = 0.25 + (0.75 * piece) / PIECES;
      c.beginPath();
      for (let k = first; k <= last; k++) c.lineTo(points[2 * k], points[2 * k + 1]);
      c.stroke();
    }
    c.restore();
    c.fillStyle = palette.l;
    c.beginPath();
    c.arc(points[2 * count - 2], points[2 * count - 1], 4.5, 0, 7);
    c.fill();
  }
}

function shown(range: Range): Range {
  return range[0] <= range[1] ? padded(range) : [-1, 1];
}
