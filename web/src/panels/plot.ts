/** Axes of a chart on a canvas: scales, grid, ticks; a second canvas above carries what moves in every frame. */

import { trace, within, type Turn } from "../state/turn";
import { draw } from "../symbols";
import type { Palette } from "../style/palette";

export type Range = readonly [number, number];

export interface Axis {
  readonly range: Range;
  readonly log?: boolean;
  readonly name: string;
  /** Of a point of a circle, which is drawn within it. */
  readonly turn?: Turn | null;
}

const LEFT = 48;
const RIGHT = 16;
const TOP = 14;
const BOTTOM = 38;
/** Of a range, on either side. */
const MARGIN = 0.08;
/** Below the upper end of the axis, where its name stands in place of a number. */
const NAME = 16;
/** Pixels that a pointer may slip in a click. */
const SLIP = 4;
const NUMBERS = `12px "Inter Variable", sans-serif`;
const POWERS = `11px "Inter Variable", sans-serif`;

export class Plot {
  below: CanvasRenderingContext2D;
  above: CanvasRenderingContext2D;
  readonly canvas: HTMLCanvasElement;
  width = 0;
  height = 0;
  x: Axis = { range: [0, 1], name: "" };
  y: Axis = { range: [0, 1], name: "" };
  /** Whether the size, or what is seen, has changed since the last `measure`. */
  private resized = true;
  /** Of both axes what is seen, where somebody has chosen it; and for which names. */
  private window: { readonly x: Range; readonly y: Range; readonly of: string } | null = null;
  private elsewhere = false;

  constructor(panel: HTMLElement, label: string) {
    const holder = document.createElement("div");
    holder.className = "plot";
    const [below, above] = [0, 1].map(() => document.createElement("canvas"));
    holder.append(below, above);
    panel.append(holder);
    above.setAttribute("role", "img");
    above.setAttribute("aria-label", label);
    this.canvas = above;
    this.below = below.getContext("2d") as CanvasRenderingContext2D;
    this.above = above.getContext("2d") as CanvasRenderingContext2D;
    new ResizeObserver(() => (this.resized = true)).observe(holder);
  }

  /** Sets both axes; what somebody has chosen to see of them stays. */
  fit(x: Axis, y: Axis): void {
    const of = `${x.name}, ${y.name}`;
    if (this.window && this.window.of !== of) this.see(null);
    [this.x, this.y] = [{ ...x, range: this.window?.x ?? x.range }, { ...y, range: this.window?.y ?? y.range }];
    this.named = of;
  }

  private named = "";

  get isZoomed(): boolean {
    return this.window !== null;
  }

  /** Shows a part of the plane; null shows all of it again. */
  private see(window: { readonly x: Range; readonly y: Range } | null): void {
    this.window = window && { ...window, of: this.named };
    if (this.window) [this.x, this.y] = [{ ...this.x, range: this.window.x }, { ...this.y, range: this.window.y }];
    this.whole.hidden = window === null;
    this.canvas.classList.toggle("zoomed", window !== null);
    this.resized = true;
  }

  /** Makes the plane larger by a factor around a place. */
  private zoom(factor: number, px: number, py: number): void {
    const at = this.point(px, py);
    if (!at) return;
    const around = ([low, high]: Range, middle: number): Range => [middle + (low - middle) / factor, middle + (high - middle) / factor];
    const next = { x: around(this.x.range, at[0]), y: around(this.y.range, at[1]) };
    // beyond this the numbers of the axes would be the same
    const isFine = ([low, high]: Range) => high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    if (isFine(next.x) || isFine(next.y)) return;
    this.see(next);
  }

  private readonly whole = Object.assign(document.createElement("button"), { type: "button", className: "whole", textContent: "all", title: "See all of it again (0)", hidden: true });

  /** Lets wheel, two fingers, keys and a dragged pointer choose what is seen. */
  zoomable(): void {
    const { canvas } = this;
    canvas.after(this.whole);
    this.whole.addEventListener("click", () => this.see(null));
    canvas.addEventListener("wheel", (event) => {
      // a page around this one must be able to move
      if (document.documentElement.dataset.embed && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(1.0015 ** -event.deltaY, event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const factor = { "+": 1.5, "-": 1 / 1.5 }[event.key];
      if (factor) this.zoom(factor, (LEFT + this.width - RIGHT) / 2, (TOP + this.height - BOTTOM) / 2);
      else if (event.key === "0") this.see(null);
      else return;
      event.preventDefault();
      event.stopImmediatePropagation();
    });
    this.fingers();
  }

  /** One pointer moves what is seen of a part of the plane, two change its size; a click after that is none. */
  private fingers(): void {
    const { canvas } = this;
    const down = new Map<number, readonly [number, number]>();
    let moved = false;
    const spread = () => {
      const [one, other] = [...down.values()];
      return Math.hypot(one[0] - other[0], one[1] - other[1]);
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (down.size === 0) moved = false;
      down.set(event.pointerId, [event.offsetX, event.offsetY]);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = down.get(event.pointerId);
      if (!before) return;
      const [dx, dy] = [event.offsetX - before[0], event.offsetY - before[1]];
      if (!moved && Math.hypot(dx, dy) < SLIP) return;
      moved = true;
      const old = down.size === 2 ? spread() : 0;
      down.set(event.pointerId, [event.offsetX, event.offsetY]);
      if (down.size === 2) this.zoom(Math.max(spread(), 1) / Math.max(old, 1), event.offsetX, event.offsetY);
      else if (this.window) {
        const [from, to] = [this.point(before[0], before[1]), this.point(event.offsetX, event.offsetY)];
        if (!from || !to) return;
        const by = ([low, high]: Range, k: 0 | 1): Range => [low + from[k] - to[k], high + from[k] - to[k]];
        this.see({ x: by(this.x.range, 0), y: by(this.y.range, 1) });
      }
    });
    for (const end of ["pointerup", "pointercancel", "pointerleave"] as const) canvas.addEventListener(end, (event) => down.delete(event.pointerId));
    canvas.addEventListener("click", (event) => moved && event.stopImmediatePropagation());
  }

  /** Has everything drawn onto something else, of the same size. */
  onto(context: CanvasRenderingContext2D, draw: () => void): void {
    const own = [this.below, this.above] as const;
    [this.below, this.above] = [context, context];
    [this.resized, this.elsewhere] = [true, true];
    try {
      draw();
    } finally {
      [this.below, this.above] = own;
      [this.resized, this.elsewhere] = [true, false];
    }
  }

  /** Fits the canvases to their place; true if they are new and empty. */
  measure(): boolean {
    if (!this.resized) return false;
    this.resized = false;
    if (this.elsewhere) return true;
    const holder = this.canvas.parentElement as HTMLElement;
    const scale = Math.min(devicePixelRatio, 2);
    [this.width, this.height] = [holder.clientWidth, holder.clientHeight];
    for (const context of [this.below, this.above]) {
      context.canvas.width = Math.max(this.width * scale, 1);
      context.canvas.height = Math.max(this.height * scale, 1);
      context.setTransform(scale, 0, 0, scale, 0, 0);
    }
    return true;
  }

  /** Place of a value, within its turn. */
  px(value: number): number {
    return this.across(within(value, this.x.turn ?? null));
  }

  py(value: number): number {
    return this.up(within(value, this.y.turn ?? null));
  }

  /** The point at a place between axes that are not logarithmic; null beside them. */
  point(px: number, py: number): readonly [number, number] | null {
    if (!this.holds(px, py)) return null;
    const [x, y] = [this.x.range, this.y.range];
    const [right, up] = [(px - LEFT) / (this.width - LEFT - RIGHT), (this.height - BOTTOM - py) / (this.height - TOP - BOTTOM)];
    return [x[0] + right * (x[1] - x[0]), y[0] + up * (y[1] - y[0])];
  }

  private across(value: number): number {
    return LEFT + part(this.x, value) * (this.width - LEFT - RIGHT);
  }

  private up(value: number): number {
    return this.height - BOTTOM - part(this.y, value) * (this.height - TOP - BOTTOM);
  }

  /** Adds points x, y, x, y, ... of a line to a path, from one to another; it is broken where a turn ends. */
  trace(c: CanvasRenderingContext2D, points: readonly number[], from?: number, to?: number): void {
    const turns = [this.x.turn ?? null, this.y.turn ?? null];
    trace(points, turns, ([x, y]) => c.moveTo(this.across(x), this.up(y)), ([x, y]) => c.lineTo(this.across(x), this.up(y)), from, to);
  }

  /** Empties the chart and draws its axes. */
  axes(palette: Palette): void {
    const { below: c, width, height } = this;
    c.clearRect(0, 0, width, height);
    c.lineWidth = 1;
    const bottom = height - BOTTOM;
    c.textAlign = "center";
    for (const { value, text } of ticks(this.x, (width - LEFT - RIGHT) / (this.x.log ? 50 : 90))) {
      const at = Math.round(this.px(value)) + 0.5;
      line(c, palette.grid, at, TOP, at, bottom);
      c.fillStyle = palette.faint;
      number(c, text, at, bottom + 15);
    }
    c.textAlign = "right";
    // where the name of an axis stands, a number has no place
    const hasPlace = (value: number) => !this.y.name || this.py(value) >= TOP + NAME;
    for (const { value, text } of ticks(this.y, (height - TOP - BOTTOM) / 45, hasPlace)) {
      const at = Math.round(this.py(value)) + 0.5;
      line(c, value === 0 && !this.y.log ? palette.zero : palette.grid, LEFT, at, width - RIGHT, at);
      if (!hasPlace(value)) continue;
      c.fillStyle = palette.faint;
      number(c, text, LEFT - 8, at + 4, LEFT - 10);
    }
    c.textAlign = "left";
    c.fillStyle = palette.ink;
    draw(c, this.x.name, width - RIGHT - 14, height - 6, 16);
    draw(c, this.y.name, 10, TOP + 2, 16);
  }

  clearAbove(): void {
    this.above.clearRect(0, 0, this.width, this.height);
    if (this.elsewhere) return;
    // Chromium goes on showing what was there before where a frame does nothing but clear
    this.above.fillStyle = "#00000001";
    this.above.fillRect(0, 0, 1, 1);
  }

  /** Whether a place lies between the axes. */
  holds(x: number, y: number): boolean {
    return x >= LEFT && x <= this.width - RIGHT && y >= TOP && y <= this.height - BOTTOM;
  }

  /** Keeps what is drawn between the axes. */
  clip(context: CanvasRenderingContext2D): void {
    context.beginPath();
    context.rect(LEFT, TOP, this.width - LEFT - RIGHT, this.height - TOP - BOTTOM);
    context.clip();
  }

  /** A dotted line at the time of the cursor. */
  cursor(time: number, palette: Palette): void {
    const at = Math.round(this.px(time)) + 0.5;
    if (at < LEFT || at > this.width - RIGHT) return;
    this.above.setLineDash([3, 3]);
    line(this.above, palette.accent, at, TOP, at, this.height - BOTTOM);
    this.above.setLineDash([]);
  }
}

function part({ range: [low, high], log }: Axis, value: number): number {
  if (log) return (Math.log10(Math.max(value, 1e-300)) - Math.log10(low)) / (Math.log10(high) - Math.log10(low));
  return (value - low) / (high - low);
}

function line(c: CanvasRenderingContext2D, style: string, x0: number, y0: number, x1: number, y1: number): void {
  c.strokeStyle = style;
  c.lineWidth = 1;
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x1, y1);
  c.stroke();
}

/** Powers of ten are written with a raised exponent; what is wider than there is room is condensed. */
function number(c: CanvasRenderingContext2D, text: string, x: number, y: number, most = 1e4): void {
  c.font = NUMBERS;
  const [base, power] = text.split("^");
  if (power === undefined) {
    c.fillText(base, x, y, most);
    return;
  }
  const align = c.textAlign;
  const width = c.measureText(base).width;
  c.font = POWERS;
  const raised = c.measureText(power).width;
  const left = align === "right" ? x - width - raised : x - (width + raised) / 2;
  c.textAlign = "left";
  c.fillText(power, left + width, y - 5);
  c.font = NUMBERS;
  c.fillText(base, left, y);
  c.textAlign = align;
}

interface Tick {
  readonly value: number;
  readonly text: string;
}

/** Round values for labels, about as many as wanted but at least two that have a place; parts of a turn for an angle. */
export function ticks({ range: [low, high], log, turn }: Axis, wanted: number, hasPlace: (value: number) => boolean = () => true): Tick[] {
  const count = Math.max(wanted, 2);
  if (turn && isAngle(turn) && high - low >= Math.PI) return quarters(low, high);
  if (log) {
    const [from, to] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
    const every = Math.max(1, Math.ceil((to - from) / count));
    const powers = [];
    for (let power = from; power <= to; power += every) powers.push(power);
    const found = powers.map((power) => ({ value: 10 ** power, text: powerOfTen(power) }));
    if (found.filter(({ value }) => hasPlace(value)).length >= 2) return found;
  }
  for (let more = count; more <= 64 * count; more *= 2) {
    const found = evenly(low, high, more);
    if (found.filter(({ value }) => hasPlace(value)).length >= 2) return found;
  }
  return evenly(low, high, count);
}

function evenly(low: number, high: number, count: number): Tick[] {
  const rough = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * size).find((one) => one >= rough) ?? rough;
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step); k <= Math.floor(high / step); k++) {
    found.push({ value: k * step, text: k === 0 ? "0" : (k * step).toFixed(digits).replace("-", "−") });
  }
  return found;
}

function isAngle([begin, end]: Turn): boolean {
  return Math.abs(end - begin - 2 * Math.PI) <= 4 * Number.EPSILON * 2 * Math.PI;
}

/** Quarters of a turn. */
function quarters(low: number, high: number): Tick[] {
  const quarter = Math.PI / 2;
  const found: Tick[] = [];
  for (let k = Math.ceil(low / quarter - 1e-9); k <= Math.floor(high / quarter + 1e-9); k++) {
    const size = Math.abs(k) % 2 ? `${Math.abs(k) === 1 ? "" : Math.abs(k)}π/2` : `${Math.abs(k) === 2 ? "" : Math.abs(k) / 2}π`;
    found.push({ value: k * quarter, text: k === 0 ? "0" : `${k < 0 ? "−" : ""}${size}` });
  }
  return found;
}

function powerOfTen(power: number): string {
  if (power >= -1 && power <= 2) return String(10 ** power);
  return `10^${String(power).replace("-", "−")}`;
}

/** A range with a margin, but within its turn; never empty, and never shorter than `least`. */
export function padded([low, high]: Range, turn: Turn | null = null, least = 0): Range {
  const room = Math.max(Math.max(high - low, 1e-3 * Math.max(Math.abs(low), Math.abs(high), 1)) * MARGIN, (least - (high - low)) / 2);
  return turn ? [Math.max(low - room, turn[0]), Math.min(high + room, turn[1])] : [low - room, high + room];
}
