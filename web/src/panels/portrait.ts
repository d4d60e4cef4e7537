/** The orbit in the two components of the section, up to the time of the cursor. */

import type { Results } from "../results";
import { COORDINATES_OF_TOPS, inUnits, OF_TOPS, type Charted, type Clock, type Coordinates } from "../state/charted";
import { Extent } from "../state/turn";
import { timeColour, type Palette } from "../style/palette";
import { chosenLevels, curveOf, type Levels } from "./levels";
import { padded, Plot, type Range } from "./plot";

/** Time units that are seen. */
export const PAST = 40;
const PIECES = 24;

export class PortraitPanel {
  readonly plot: Plot;
  private key = "";
  private results: Results | null = null;
  private extents = [new Extent(), new Extent()];
  private seen = 0;
  private readonly head: HTMLElement;
  private readonly past: string;

  constructor(panel: HTMLElement, private readonly coordinates: Coordinates = COORDINATES_OF_TOPS, private readonly clock: Clock = OF_TOPS) {
    const past = `last ${inUnits(PAST, clock)} time units`;
    this.plot = new Plot(panel, `Phase portrait of the ${past}`);
    this.plot.zoomable();
    this.head = panel.querySelector("p") as HTMLElement;
    this.past = past;
  }

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const { components, turns } = this.coordinates;
    const columns = lab.axes.map((name) => components.indexOf(name));
    const { levels } = results;
    const key = `${lab.axes.join()} ${palette.dark} ${palette.panel} ${levels !== null}`;
    const anew = results !== this.results || key !== this.key;
    if (anew) [this.results, this.key, this.seen, this.extents] = [results, key, 0, [new Extent(), new Extent()]];
    const grown = this.look(results, columns);
    if (plot.measure() || anew || grown) {
      const [x, y] = this.extents.map(({ range }, axis) => {
        const turn = turns[columns[axis]];
        const seen = levels && range ? union(levels.ranges[columns[axis]], range) : range;
        return { range: seen ? (levels ? seen : padded(seen, turn)) : ([-1, 1] as const), name: lab.axes[axis], turn };
      });
      plot.fit(x, y);
      this.head.textContent = levels ? "level curves of H" : this.past;
      plot.axes(palette);
      if (levels && columns[0] !== columns[1]) this.curves(levels, columns, palette);
    }
    plot.clearAbove();
    this.line(lab.time, results, columns, palette);
  }

  /** All orbits of a system of two components. */
  private curves(levels: Levels, columns: readonly number[], palette: Palette): void {
    const { plot } = this;
    const c = plot.below;
    c.save();
    plot.clip(c);
    c.strokeStyle = palette.zero;
    c.lineWidth = 1;
    for (const level of chosenLevels(levels)) {
      const ends = curveOf(levels, level);
      c.beginPath();
      for (let k = 0; k < ends.length; k += 4) {
        c.moveTo(plot.px(ends[k + columns[0]]), plot.py(ends[k + columns[1]]));
        c.lineTo(plot.px(ends[k + 2 + columns[0]]), plot.py(ends[k + 2 + columns[1]]));
      }
      c.stroke();
    }
    c.restore();
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

function union([a, b]: Range, [c, d]: Range): Range {
  return [Math.min(a, c), Math.max(b, d)];
}
