/** What is drawn of an orbit in the plane: two components, some components over time, or a picture of the state. */

import type { Results } from "../results";
import { Plot, padded, type Axis, type Range } from "../panels/plot";
import type { Clock } from "../state/charted";
import { Extent, within, type Turn } from "../state/turn";
import { timeColour, type Palette } from "../style/palette";
import type { Picture, SystemDescription } from "./description";
import type { SystemState } from "./state";

/** Units of time that are seen of a path, and of curves over time. */
export const PAST = 40;
const PIECES = 32;

/** Ranges of all components along what is known of the orbit. */
export class Ranges {
  private results: Results | null = null;
  private seen = 0;
  private extents: Extent[] = [];

  constructor(readonly turns: readonly (Turn | null)[]) {}

  look(results: Results): void {
    const { width } = results;
    if (results !== this.results) {
      [this.results, this.seen] = [results, 0];
      this.extents = this.turns.map(() => new Extent());
    }
    const { chunks } = results.top;
    for (; this.seen < chunks.length; this.seen++) {
      const { states } = chunks[this.seen];
      for (let at = 0; at < states.length; at++) this.extents[at % width].add(states[at], this.turns[at % width]);
    }
  }

  of(component: number): Range {
    return this.extents[component]?.range ?? [-1, 1];
  }
}

export function seriesColours(palette: Palette): readonly string[] {
  return [palette.l, palette.alpha, palette.beta, palette.b, palette.a, palette.ink, palette.faint, palette.accent];
}

/** The canvas of the views in the plane. */
export class FlatView {
  readonly plot: Plot;
  private readonly holder = document.createElement("div");
  private readonly image = document.createElement("canvas");
  private key = "";
  private largest: { of: Results | null; value: number; until: number } = { of: null, value: 0, until: -1 };

  constructor(panel: HTMLElement, private readonly system: SystemDescription, private readonly clock: Clock) {
    this.holder.className = "flat";
    panel.append(this.holder);
    this.plot = new Plot(this.holder, "");
  }

  show(shown: boolean, words: string): void {
    this.holder.hidden = !shown;
    this.plot.canvas.setAttribute("aria-label", words);
  }

  draw(state: SystemState, results: Results, ranges: Ranges, palette: Palette): void {
    if (state.view === "picture" && this.system.picture) this.picture(this.system.picture, state, results, palette);
    else if (state.view === "series") this.series(state, results, ranges, palette);
    else this.path(state, results, ranges, palette);
  }

  private axes(x: Axis, y: Axis, palette: Palette): void {
    const { plot } = this;
    const key = [x.range, x.name, y.range, y.name, palette.panel, palette.dark].join();
    if (plot.measure() || key !== this.key) {
      [this.key, plot.x, plot.y] = [key, x, y];
      plot.axes(palette);
    }
    plot.clearAbove();
  }

  /** Two components, the past paler. */
  private path({ space, time }: SystemState, results: Results, ranges: Ranges, palette: Palette): void {
    const [x, y] = space;
    const { components, turns } = this.system;
    const axis = (k: number): Axis => ({ range: padded(ranges.of(k), turns[k]), name: components[k], turn: turns[k] });
    this.axes(axis(x), axis(y), palette);
    const { plot } = this;
    const points: number[] = [];
    results.top.visit(Math.max(0, time - PAST * this.clock.unit), time, (_, states, at) => points.push(states[at + x], states[at + y]));
    const now = results.top.at(time);
    if (!now) return;
    points.push(now[x], now[y]);
    const [c, count] = [plot.above, points.length / 2];
    c.lineJoin = "round";
    c.lineWidth = 1.8;
    for (let piece = 0; piece < PIECES; piece++) {
      c.strokeStyle = timeColour(piece / (PIECES - 1), palette.dark);
      c.globalAlpha = 0.2 + (0.8 * piece) / PIECES;
      c.beginPath();
      plot.trace(c, points, Math.floor((piece * count) / PIECES), Math.min(Math.floor(((piece + 1) * count) / PIECES), count - 1));
      c.stroke();
    }
    c.globalAlpha = 1;
    disc(c, plot.px(now[x]), plot.py(now[y]), 5.5, palette.l);
  }

  /** Components over the last units of time. */
  private series({ series, time }: SystemState, results: Results, ranges: Ranges, palette: Palette): void {
    const { plot, clock } = this;
    const { turns } = this.system;
    const from = Math.max(0, time - PAST * clock.unit);
    const among = series.map((k) => ranges.of(k));
    const range = among.reduce<Range>(([a, b], [low, high]) => [Math.min(a, low), Math.max(b, high)], [Infinity, -Infinity]);
    this.axes({ range: [from, from + PAST * clock.unit], name: "t" }, { range: range[0] <= range[1] ? padded(range) : [-1, 1], name: "" }, palette);
    const colours = seriesColours(palette);
    const now = results.top.at(time);
    if (!now) return;
    const places: [number, Float64Array][] = [];
    results.top.visit(from, time, (when, states, at) => places.push([when, states.subarray(at, at + results.width)]));
    places.push([time, now]);
    const c = plot.above;
    c.save();
    plot.clip(c);
    c.lineWidth = 1.8;
    c.lineJoin = "round";
    series.forEach((component, k) => {
      c.strokeStyle = colours[k % colours.length];
      c.beginPath();
      // each has a turn of its own
      plot.y = { ...plot.y, turn: turns[component] };
      plot.trace(c, places.flatMap(([when, values]) => [when, values[component]]));
      c.stroke();
    });
    c.restore();
    plot.y = { ...plot.y, turn: null };
    series.forEach((component, k) => disc(c, plot.px(time), plot.py(within(now[component], turns[component])), 4, colours[k % colours.length]));
  }

  /** A picture of the state; one scale of colours for the orbit, so that its strength can be compared. */
  private picture(picture: Picture, { time }: SystemState, results: Results, palette: Palette): void {
    const { plot } = this;
    const now = results.top.at(time);
    if (plot.measure() || this.key) plot.below.clearRect(0, 0, plot.width, plot.height);
    this.key = "";
    plot.clearAbove();
    if (!now) return;
    const values = pictured(picture, now);
    const [rows, columns] = [picture.up[0].length, picture.across[0].length];
    const largest = this.strongest(picture, results);
    const { image } = this;
    [image.width, image.height] = [columns, rows];
    const c = image.getContext("2d") as CanvasRenderingContext2D;
    const pixels = c.createImageData(columns, rows);
    const colour = diverging(palette);
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        // the first row of the picture is below
        const at = 4 * ((rows - 1 - row) * columns + column);
        const [red, green, blue] = colour(values[row * columns + column] / largest);
        pixels.data.set([red, green, blue, 255], at);
      }
    }
    c.putImageData(pixels, 0, 0);
    const side = Math.min(plot.width - 90, plot.height - 16);
    const [left, top] = [(plot.width - side) / 2, (plot.height - side) / 2];
    const above = plot.above;
    above.save();
    above.beginPath();
    above.roundRect(left, top, side, side, 10);
    above.clip();
    above.imageSmoothingEnabled = true;
    above.imageSmoothingQuality = "high";
    above.drawImage(image, left, top, side, side);
    above.restore();
    above.strokeStyle = palette.zero;
    above.beginPath();
    above.roundRect(left, top, side, side, 10);
    above.stroke();
    this.scale(left + side + 14, top, side, largest, colour, palette);
  }

  private scale(left: number, top: number, side: number, largest: number, colour: (part: number) => readonly number[], palette: Palette): void {
    const c = this.plot.above;
    const gradient = c.createLinearGradient(0, top + side * 0.8, 0, top + side * 0.2);
    for (let k = 0; k <= 12; k++) gradient.addColorStop(k / 12, `rgb(${colour(k / 6 - 1).join(" ")})`);
    c.fillStyle = gradient;
    c.fillRect(left, top + side * 0.2, 9, side * 0.6);
    c.fillStyle = palette.faint;
    c.font = `11px "Inter Variable", sans-serif`;
    c.textAlign = "left";
    const text = Number(largest.toPrecision(2));
    c.fillText(`+${text}`, left - 4, top + side * 0.2 - 8);
    c.fillText("0", left + 13, top + side * 0.5 + 4);
    c.fillText(`−${text}`, left - 4, top + side * 0.8 + 18);
  }

  /** The largest value of the picture along the first units of time. */
  private strongest(picture: Picture, results: Results): number {
    const known = this.largest;
    const until = Math.min(results.top.end, PAST * this.clock.unit);
    if (known.of === results && known.until >= until) return known.value;
    let [value, k] = [0, 0];
    results.top.visit(0, until, (_, states, at) => {
      if (k++ % 40 === 0) value = pictured(picture, states.subarray(at, at + results.width)).reduce((a, b) => Math.max(a, Math.abs(b)), value);
    });
    this.largest = { of: results, value: value || 1, until };
    return this.largest.value;
  }
}

/** The picture of a state, (row, column). */
export function pictured({ across, up, terms }: Picture, state: ArrayLike<number>): Float64Array {
  const [columns, rows] = [across[0].length, up[0].length];
  // first the rows of each function of the columns, so that each term costs one row
  const sums = across.map(() => new Float64Array(rows));
  for (const [component, i, j, coefficient] of terms) {
    const weight = coefficient * state[component];
    if (weight !== 0) for (let row = 0; row < rows; row++) sums[i][row] += weight * up[j][row];
  }
  const values = new Float64Array(rows * columns);
  sums.forEach((sum, i) => {
    for (let row = 0; row < rows; row++) {
      const weight = sum[row];
      if (weight !== 0) for (let column = 0; column < columns; column++) values[row * columns + column] += weight * across[i][column];
    }
  });
  return values;
}

/** Colours of -1 to 1: blue, the paper, and orange. */
function diverging(palette: Palette): (part: number) => readonly [number, number, number] {
  const stops = (palette.dark
    ? [[146, 204, 255], [55, 126, 220], [17, 24, 32], [226, 96, 34], [255, 204, 150]]
    : [[11, 52, 122], [88, 152, 219], [252, 250, 244], [228, 124, 60], [122, 34, 6]]) as readonly [number, number, number][];
  return (part) => {
    const at = (Math.min(Math.max(part, -1), 1) + 1) * 2;
    const k = Math.min(Math.floor(at), 3);
    return [0, 1, 2].map((i) => Math.round(stops[k][i] * (1 - at + k) + stops[k + 1][i] * (at - k))) as unknown as readonly [number, number, number];
  };
}

function disc(c: CanvasRenderingContext2D, x: number, y: number, radius: number, colour: string): void {
  c.fillStyle = colour;
  c.beginPath();
  c.arc(x, y, radius, 0, 7);
  c.fill();
}
