/** The orbit in the two components of the section, up to the time of the cursor. */

import type { Results } from "../results";
import { COORDINATES_OF_TOPS, inUnits, OF_TOPS, type Charted, type Clock, type Coordinates } from "../state/charted";
import { Extent } from "../state/turn";
import { timeColour, type Palette } from "../style/palette";
import { padded, Plot } from "./plot";

/** Time units that are seen. */
export const PAST = 40;
const PIECES = 24;

export class PortraitPanel {
  readonly plot: Plot;
  private key = "";
  private results: Results | null = null;
  private extents = [new Extent(), new Extent()];
  private seen = 0;

  constructor(panel: HTMLElement, private readonly coordinates: Coordinates = COORDINATES_OF_TOPS, private readonly clock: Clock = OF_TOPS) {
    const past = `last ${inUnits(PAST, clock)} time units`;
    this.plot = new Plot(panel, `Phase portrait of the ${past}`);
    this.plot.zoomable();
    (panel.querySelector("p") as HTMLElement).textContent = past;
  }

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const { components, turns } = this.coordinates;
    const columns = lab.axes.map((name) => components.indexOf(name));
    const key = `${lab.axes.join()} ${palette.dark} ${palette.panel}`;
    const anew = results !== this.results || key !== this.key;
    if (anew) [this.results, this.key, this.seen, this.extents] = [results, key, 0, [new Extent(), new Extent()]];
    const grown = this.look(results, columns);
    if (plot.measure() || anew || grown) {
      const [x, y] = this.extents.map(({ range }, axis) => {
        const turn = turns[columns[axis]];
        return { range: range ? padded(range, turn) : ([-1, 1] as const), name: lab.axes[axis], turn };
      });
      plot.fit(x, y);
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
        for (let at = column; at < states.length; at += results.width) this.extents[axis].add(states[at], this.coordinates.turns[column]);
      });
    }
    return true;
  }

  private line(time: number, results: Results, columns: readonly number[], palette: Palette): void {
    const { plot } = this;
    const c = plot.above;
    const from = Math.max(0, time - PAST * this.clock.unit);
    const points: number[] = [];
    results.top.visit(from, time, (_, states, at) => points.push(states[at + columns[0]], states[at + columns[1]]));
    const now = results.top.at(time);
    if (!now) return;
    points.push(now[columns[0]], now[columns[1]]);
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
      plot.trace(c, points, first, last);
      c.stroke();
    }
    c.restore();
    c.fillStyle = palette.l;
    c.beginPath();
    c.arc(plot.px(now[columns[0]]), plot.py(now[columns[1]]), 4.5, 0, 7);
    c.fill();
  }
}
