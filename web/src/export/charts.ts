/** Pictures and tables of charts. */

import type { Key } from "../panels/drift";
import { PAST } from "../panels/portrait";
import type { Plot } from "../panels/plot";
import type { Results } from "../results";
import type { Charted, Clock } from "../state/charted";
import type { Palette } from "../style/palette";
import { draw } from "../symbols";
import { menu, save, savePicture } from "./menu";
import { SvgContext } from "./svg";
import { csv, type Table } from "./table";

/** Room for the title, and pixels of a picture for each of the page. */
const TITLE = 26;
const FINE = 3;

export interface Chart {
  readonly plot: Plot;
  draw(charted: Charted, results: Results, palette: Palette): void;
  keys?(results: Results, palette: Palette): Key[];
  /** What a picture says beside what stands at the head of the panel. */
  about?(): string;
}

/** What the page shows, and of what. */
export interface Now {
  readonly charted: Charted;
  readonly results: Results;
  readonly palette: Palette;
  readonly clock: Clock;
  /** With which the name of a file begins. */
  readonly file: string;
  /** System, start and method, each as it was entered. */
  readonly facts: readonly string[];
  readonly components: readonly string[];
  /** Of a row of the motion, and what these numbers are. */
  readonly columns: readonly string[];
  readonly row: string;
}

/** Puts the menu into the panel of a chart; `now` says what it shows. */
export function exports(panel: HTMLElement, name: string, chart: Chart, table: (now: Now) => Table, now: () => Now): void {
  const file = (kind: string) => `${now().file}-${name}.${kind}`;
  const title = () => {
    const heading = panel.querySelector("h3")?.textContent ?? "";
    const about = chart.about?.();
    const text = chart.keys ? heading : `${heading}: ${words(panel.querySelector("p") as HTMLElement, now().clock)}`;
    return about ? `${text}: ${about}` : text;
  };
  menu(panel, name, [
    ["picture, SVG", () => save(file("svg"), new Blob([svgOf(chart, title(), now())], { type: "image/svg+xml" }))],
    ["picture, PNG", () => savePicture(file("png"), pictureOf(chart, title(), now()))],
    ["numbers, CSV", () => save(file("csv"), new Blob([csv(now().facts, table(now()))], { type: "text/csv" }))],
  ]);
}

export function svgOf(chart: Chart, title: string, now: Now): string {
  const { width, height } = chart.plot;
  const context = new SvgContext(chart.plot.below);
  chart.plot.onto(context as unknown as CanvasRenderingContext2D, () => chart.draw(now.charted, now.results, now.palette));
  caption(context as unknown as CanvasRenderingContext2D, chart, title, now);
  return context.document(width, height + TITLE, now.palette.panel, title, now.facts.join("\n"));
}

export function pictureOf(chart: Chart, title: string, now: Now): HTMLCanvasElement {
  const { width, height } = chart.plot;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width * FINE, (height + TITLE) * FINE];
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  context.scale(FINE, FINE);
  context.fillStyle = now.palette.panel;
  context.fillRect(0, 0, width, height + TITLE);
  chart.plot.onto(withoutClearing(context), () => chart.draw(now.charted, now.results, now.palette));
  caption(context, chart, title, now);
  return canvas;
}

/** Below a picture: what it is, and which curve is which. */
function caption(context: CanvasRenderingContext2D, chart: Chart, title: string, { results, palette }: Now): void {
  const y = chart.plot.height + TITLE - 9;
  context.font = `13px "Inter Variable", sans-serif`;
  context.textAlign = "left";
  context.fillStyle = palette.ink;
  context.fillText(title, 10, y);
  let x = 10 + context.measureText(title).width + 14;
  for (const { name, colour, dash } of chart.keys?.(results, palette) ?? []) {
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.setLineDash([...dash]);
    context.beginPath();
    context.moveTo(x, y - 4);
    context.lineTo(x + 18, y - 4);
    context.stroke();
    context.setLineDash([]);
    x += 22 + draw(context, name, x + 22, y, 14) + 12;
  }
}

/** The text of a heading, with indices below the line. */
function words(heading: HTMLElement, { horizon }: Clock): string {
  const copy = heading.cloneNode(true) as HTMLElement;
  copy.querySelectorAll("sub").forEach((sub) => sub.replaceWith([...(sub.textContent ?? "")].map((letter) => (/\d/.test(letter) ? String.fromCharCode(0x2080 + Number(letter)) : letter)).join("")));
  const scale = copy.querySelector(".scale");
  scale?.previousSibling?.remove();
  return (copy.textContent ?? "") + (scale ? `, coloured by time from 0 to ${horizon.toLocaleString("en")}` : "");
}

/** Both canvases of a chart are this one, and the second must not wipe off the first. */
function withoutClearing(context: CanvasRenderingContext2D): CanvasRenderingContext2D {
  context.clearRect = () => undefined;
  return context;
}

export const tables = {
  section: ({ charted, results, components }: Now): Table => ({
    what: `crossings of ${charted.surface} = 0${charted.modulus ? ` mod ${charted.modulus}` : ""}, ${["falling", "both directions", "rising"][charted.direction + 1]}, up to t = ${results.until}`,
    columns: ["t", ...components],
    rows: results.crossings.rows.map((row, k) => [results.crossings.times[k], ...row]),
  }),
  portrait: ({ charted, results, clock, columns, row }: Now): Table => {
    const rows: number[][] = [];
    const past = PAST * clock.unit;
    results.top.visit(Math.max(0, charted.time - past), charted.time, (time, states, at) => rows.push([time, ...states.subarray(at, at + columns.length)]));
    return { what: `orbit in the last ${past} time units before t = ${charted.time}: ${row}`, columns: ["t", ...columns], rows };
  },
  lyapunov: ({ results: { exponent, band, members } }: Now): Table => {
    const other = new Map(band.times.map((time, k) => [time, band.rows[k]]));
    return {
      what: `finite-time exponent of one tangent vector (1, ..., 1); of ${members} starts along the orbit the deciles 1, 5, 9`,
      columns: ["t", "exponent", "decile1", "median", "decile9"],
      rows: exponent.times.map((time, k) => [time, exponent.rows[k][0], ...(other.get(time) ?? [NaN, NaN, NaN])]),
    };
  },
  drift: ({ results: { names, first, drift } }: Now): Table => ({
    what: `invariants less their values at the start, which are ${names.map((name, k) => `${name} = ${first[k]}`).join(", ")}`,
    columns: ["t", ...names],
    rows: drift.rows.map((row, k) => [drift.times[k], ...row]),
  }),
} as const;
