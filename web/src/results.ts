/** What the worker has found of the present orbit. */

import { N_ELLIPSOID, WIDTH } from "./data/tops";
import type { Levels } from "./panels/levels";
import type { Update } from "./worker/messages";

interface Chunk {
  readonly times: Float64Array;
  readonly states: Float64Array;
  readonly values: Float64Array;
  /** Squares of half axes and of the angular momentum (time, 4); none for the shadow. */
  readonly ellipsoid: Float64Array;
}

/** A list of rows that grows; `version` tells a chart that it has more to draw. */
export class Rows {
  readonly times: number[] = [];
  readonly rows: Float64Array[] = [];

  add(times: Float64Array, flat: Float64Array): void {
    const width = times.length ? flat.length / times.length : 0;
    times.forEach((time, k) => {
      this.times.push(time);
      this.rows.push(flat.slice(k * width, (k + 1) * width));
    });
  }

  get length(): number {
    return this.times.length;
  }

  /** The last one that is not later. */
  before(time: number): number {
    return lastBefore(this.times, time);
  }
}

/** Motion on a time axis without gaps; each state has `width` numbers. */
export class Motion {
  constructor(readonly width: number = WIDTH) {
    this.bounds = Array.from({ length: width }, () => [Infinity, -Infinity]);
  }

  readonly chunks: Chunk[] = [];
  private readonly begins: number[] = [];
  /** Of each number of a state, the smallest and the largest that there was. */
  private readonly bounds: [low: number, high: number][];

  add(chunk: Chunk): void {
    this.chunks.push(chunk);
    this.begins.push(chunk.times[0]);
    const { states } = chunk;
    this.bounds.forEach((bound, column) => {
      for (let at = column; at < states.length; at += this.width) {
        bound[0] = Math.min(bound[0], states[at]);
        bound[1] = Math.max(bound[1], states[at]);
      }
    });
  }

  /** A range of a component below which a chart would show nothing but the last digits of an orbit that hardly moves. */
  least(column: number, among: number): number {
    const spans = this.bounds.slice(0, among).map(([low, high]) => Math.max(high - low, 0));
    return Math.max(spans[column] / 50, Math.max(...spans) / 500);
  }

  get end(): number {
    return this.chunks.at(-1)?.times.at(-1) ?? 0;
  }

  /** The state with attitude and position, between two that were computed, which are closer than the eye can tell. */
  at(time: number): Float64Array | null {
    const found = this.place(time);
    if (!found) return null;
    const { chunk, k, part } = found;
    const { width } = this;
    const state = new Float64Array(width);
    for (let i = 0; i < width; i++) {
      const from = chunk.states[k * width + i];
      state[i] = from + part * (chunk.states[(k + 1) * width + i] - from);
    }
    return state;
  }

  /** Invariants at the computed state before. */
  values(time: number): Float64Array | null {
    const found = this.place(time);
    if (!found) return null;
    const n = found.chunk.values.length / found.chunk.times.length;
    return found.chunk.values.subarray(found.k * n, (found.k + 1) * n);
  }

  /** Squares of the half axes of the ellipsoid, and of the angular momentum, between two that were computed. */
  ellipsoid(time: number): Float64Array | null {
    const found = this.place(time);
    if (!found) return null;
    const { chunk, k, part } = found;
    const [from, to] = [k, k + 1].map((row) => chunk.ellipsoid.subarray(row * N_ELLIPSOID, (row + 1) * N_ELLIPSOID));
    return from.map((value, i) => value + part * (to[i] - value));
  }

  /** The largest square of a half axis, or of the angular momentum, up to a time. */
  largestOfEllipsoid(to: number): number {
    const early = this.chunks.filter(({ times }) => times[0] <= to);
    return early.reduce((most, { ellipsoid }) => ellipsoid.reduce((a, b) => Math.max(a, b), most), 0);
  }

  /** Visits the computed states from one time to another. */
  visit(from: number, to: number, see: (time: number, states: Float64Array, at: number) => void): void {
    for (let c = Math.max(lastBefore(this.begins, from), 0); c < this.chunks.length; c++) {
      const { times, states } = this.chunks[c];
      if (times[0] > to) return;
      // the last state of a chunk is the first of the next
      for (let k = 0; k < times.length - 1; k++) if (times[k] >= from && times[k] <= to) see(times[k], states, k * this.width);
    }
  }

  private place(time: number): { chunk: Chunk; k: number; part: number } | null {
    const chunk = this.chunks[lastBefore(this.begins, time)];
    if (!chunk) return null;
    const { times } = chunk;
    const length = times[times.length - 1] - times[0];
    const position = Math.min(Math.max(((time - times[0]) / length) * (times.length - 1), 0), times.length - 1);
    const k = Math.min(Math.floor(position), times.length - 2);
    return { chunk, k, part: position - k };
  }
}

export class Results {
  /** `width`: the numbers of a drawn state. */
  constructor(readonly width: number = WIDTH) {
    this.top = new Motion(width);
    this.shadow = new Motion(width);
  }

  names: readonly string[] = [];
  first: readonly number[] = [];
  family = "";
  readonly top: Motion;
  readonly shadow: Motion;
  readonly crossings = new Rows();
  readonly drift = new Rows();
  readonly exponent = new Rows();
  readonly band = new Rows();
  members = 0;
  until = 0;
  ended: { outcome: string; time: number } | null = null;
  /** Whether the worker has said which invariants there are. */
  opened = false;
  finished = false;
  /** The energy around the orbit, of a system of two components. */
  levels: Levels | null = null;
  /** How a saved result and what this page computes differ. */
  compared: Extract<Update, { say: "compared" }> | null = null;

  take(update: Update): void {
    switch (update.say) {
      case "invariants":
        [this.names, this.first, this.family, this.opened] = [update.names, update.values, update.family, true];
        break;
      case "motion":
        (update.shadow ? this.shadow : this.top).add(update);
        break;
      case "crossings":
        this.crossings.add(update.times, update.states);
        this.until = update.until;
        break;
      case "drift":
        this.drift.add(update.times, update.differences);
        break;
      case "exponent":
        this.exponent.add(update.times, update.values);
        break;
      case "band":
        this.band.add(update.times, update.values);
        this.members = update.members;
        break;
      case "ended":
        if (update.what !== "shadow") this.ended = { outcome: update.outcome, time: update.time };
        break;
      case "levels":
        this.levels = update.levels;
        break;
      case "compared":
        this.compared = update;
        break;
      case "finished":
        this.finished = true;
    }
  }
}

/** The last index whose value is not beyond; -1 if there is none. */
function lastBefore(sorted: ArrayLike<number>, value: number): number {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
