/** Pictures and tables of charts. */

import { attitude, components, position } from "../data/tops";
import type { Key } from "../panels/drift";
import { PAST } from "../panels/portrait";
import type { Plot } from "../panels/plot";
import type { Results } from "../results";
import { HORIZON, type Laboratory } from "../state/laboratory";
import type { Palette } from "../style/palette";
import { draw } from "../symbols";
import { menu, save, savePicture } from "./menu";
import { SvgContext } from "./svg";
import { csv, facts, type Table } from "./table";

/** Room for the title, and pixels of a picture for each of the page. */
const TITLE = 26;
const FINE = 3;

export interface Chart {
  readonly plot: Plot;
  draw(lab: Laboratory, results: Results, palette: Palette): void;
  keys?(results: Results, palette: Palette): Key[];
}

export interface Now {
  readonly lab: Laboratory;
  readonly results: Results;
  readonly palette: Palette;
}

/** Puts the menu into the panel of a chart; `now` says what it shows. */
export function exports(panel: HTMLElement, name: string, chart: Chart, table: (now: Now) => Table, now: () => Now): void {
  const file = (kind: string) => `${now().lab.preset ?? "top"}-${name}.${kind}`;
  const heading = panel.querySelector("h3")?.textContent ?? "";
  const title = () => (chart.keys ? heading : `${heading}: ${words(panel.querySelector("p") as HTMLElement)}`);
  menu(panel, name, [
    ["picture, SVG", () => save(file("svg"), new Blob([svgOf(chart, title(), now())], { type: "image/svg+xml" }))],
    ["picture, PNG", () => savePicture(file("png"), pictureOf(chart, title(), now()))],
    ["numbers, CSV", () => save(file("csv"), new Blob([csv(now().lab, table(now()))], { type: "text/csv" }))],
  ]);
}

export function svgOf(chart: Chart, title: string, { lab, results, palette }: Now): string {
  const { width, height } = chart.plot;
  const context = new SvgContext(chart.plot.below);
  chart.plot.onto(context as unknown as CanvasRenderingContext2D, () => chart.draw(lab, results, palette));
  caption(context as unknown as CanvasRenderingContext2D, chart, title, { lab, results, palette });
  return context.document(width, height + TITLE, palette.panel, title, facts(lab).join("\n"));
}

export function pictureOf(chart: Chart, title: string, { lab, results, palette }: Now): HTMLCanvasElement {
  const { width, height } = chart.plot;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width * FINE, (height + TITLE) * FINE];
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  context.scale(FINE, FINE);
  context.fillStyle = palette.panel;
  context.fillRect(0, 0, width, height + TITLE);
  chart.plot.onto(withoutClearing(context), () => chart.draw(lab, results, palette));
  caption(context, chart, title, { lab, results, palette });
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
function words(heading: HTMLElement): string {
  const copy = heading.cloneNode(true) as HTMLElement;
  copy.querySelectorAll("sub").forEach((sub) => sub.replaceWith([...(sub.textContent ?? "")].map((digit) => String.fromCharCode(0x2080 + Number(digit))).join("")));
  const scale = copy.querySelector(".scale");
  scale?.previousSibling?.remove();
  return (copy.textContent ?? "") + (scale ? `, coloured by time from 0 to ${HORIZON.toLocaleString("en")}` : "");
}

/** Both canvases of a chart are this one, and the second must not wipe off the first. */
function withoutClearing(context: CanvasRenderingContext2D): CanvasRenderingContext2D {
  context.clearRect = () => undefined;
  return context;
}

const direction = (lab: Laboratory) => ["falling", "both directions", "rising"][lab.direction + 1];

export const tables = {
  section: ({ lab, results }: Now): Table => ({
    what: `crossings of ${lab.surface} = 0, ${direction(lab)}, up to t = ${results.until}`,
    columns: ["t", ...components],
    rows: results.crossings.rows.map((row, k) => [results.crossings.times[k], ...row]),
  }),
  portrait: ({ lab, results }: Now): Table => {
    const rows: number[][] = [];
    const columns = [...components, ...attitude, ...position];
    results.top.visit(Math.max(0, lab.time - PAST), lab.time, (time, states, at) => rows.push([time, ...states.subarray(at, at + columns.length)]));
    return {
      what: `orbit in the last ${PAST} time units before t = ${lab.time}: state, attitude (quaternion from body to space), centre line of the rod`,
      columns: ["t", ...columns],
      rows,
    };
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
