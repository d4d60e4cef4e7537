/**
 * One orbit and what is known of it, computed piece by piece by the core.  Each call of `advance` takes some milliseconds and
 * gives one update, so that a newer job is never kept waiting.
 *
 * The orbit is integrated once, from one checkpoint to the next, and looked at for crossings on the way.  What is drawn of
 * the moving body starts from these checkpoints again, so that it stays on the same orbit however chaotic that is.
 *
 * At a checkpoint points of circles are moved into their turns, since steps are as exact as the largest component; the turns
 * are added to what is said.
 */

import type { Core, Field, Functions, Method } from "../core/core.js";
import { comparison } from "../systems/comparison";
import type { Job, SystemJob, Update } from "./messages";
import { modelOf, type Model } from "./model";
import { Extent, within, type Turn } from "../state/turn";
import { interval } from "./times";

/** Between checkpoints, once the time is beyond it; this and the other times are in the unit of the model. */
const STRIDE = 20;
/** Checkpoints before that: the drift is drawn over the logarithm of time. */
const EARLY = [0.1, 0.2, 0.35, 0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8, 11, 15];
/** Between the states that are drawn. */
const SAMPLING = 1 / 50;
/** Distance of the shadow, in the first component. */
const SHADOW = 1e-3;
const MEMBERS = 24;
/** The exponents of an ensemble are followed to this part of the horizon. */
const BAND_HORIZON = 0.2;
/** Points of the grid of level curves in each direction. */
const GRID = 161;
/** How often a range is doubled at most: of energies that do not grow. */
const WIDENED = 8;
/** At most so many time units times members in one call. */
const AT_ONCE = 200;

export class Computation {
  private readonly held: { free(): void }[] = [];
  private readonly field: Field;
  private readonly tangentField: Field;
  private readonly moving: Field;
  private readonly method: Method;
  private readonly surface: Functions;
  private readonly invariants: Functions | null;
  private readonly ellipsoid: Functions | null;
  private readonly names: readonly string[];
  private readonly family: string;
  private readonly first: Float64Array;

  private readonly times: number[] = [0];
  /** States within their turns, and the whole turns before. */
  private readonly checkpoints: Float64Array[];
  private readonly turned: Float64Array[];
  private side: Float64Array = new Float64Array();
  private readonly moved: { next: number; state: Float64Array; stopped: boolean }[];
  private readonly early: readonly number[];
  private readonly stride: number;
  private wanted: number;
  private exponent: Growth | null = null;
  private band: Growth | null = null;
  private stopped = false;
  private opened = false;
  private reported = false;
  private compared = false;

  constructor(private readonly core: Core, private readonly job: Job | SystemJob, private readonly model: Model = modelOf(core, job)) {
    const { start, tol } = job;
    this.field = this.hold(core.field(model.field));
    this.tangentField = this.hold(core.field(model.tangentField));
    this.moving = this.hold(core.field(model.moving));
    this.method = this.hold(core.method({ kind: "taylor", tol }));
    this.surface = this.hold(core.functions(model.surface));
    this.names = model.names;
    this.family = model.family;
    this.invariants = model.invariants && this.hold(core.functions(model.invariants));
    this.ellipsoid = model.ellipsoid && this.hold(core.functions(model.ellipsoid));
    this.stride = (STRIDE * model.unit) / model.parts;
    this.early = EARLY.map((time) => time * model.unit).filter((time) => time < this.stride);
    this.wanted = 2 * STRIDE * model.unit;
    this.checkpoints = [inTurns(Float64Array.from(start), model.turns)];
    this.turned = [this.checkpoints[0].map((value, k) => start[k] - value)];
    this.first = this.valuesAt(this.checkpoints[0]);
    const shadow = start.with(0, start[0] + SHADOW);
    this.moved = [start, shadow].map((state, k) => ({ next: 0, state: Float64Array.from([...state, ...model.attitude]), stopped: k === 1 && !model.shadow }));
  }

  free(): void {
    this.held.forEach((one) => one.free());
  }

  /** The motion is wanted up to a time. */
  until(time: number): void {
    this.wanted = Math.min(time, this.job.horizon);
  }

  /** The next update; null when all is done that is wanted. */
  advance(): Update | null {
    if (!this.opened) {
      this.opened = true;
      return { say: "invariants", names: this.names, values: [...this.first], family: this.family };
    }
    return this.motion() ?? this.levels() ?? this.compare() ?? this.pass() ?? this.growth() ?? this.ensemble() ?? this.end();
  }

  private end(): Update | null {
    if (this.reported) return null;
    this.reported = true;
    return { say: "finished" };
  }

  private hold<T extends { free(): void }>(one: T): T {
    this.held.push(one);
    return one;
  }

  private readonly extents = [new Extent(), new Extent()];
  private surveyed = false;

  /** The energy of a system of two components, of which all orbits are level curves, over twice what its orbit covers. */
  private levels(): Update | null {
    const { nComponents, turns, width } = this.model;
    if (this.surveyed || nComponents !== 2 || width !== 2 || !this.invariants) return null;
    this.surveyed = true;
    const ranges = this.extents.map(({ range }, k): [number, number] => {
      const turn = turns[k];
      if (turn || !range) return turn ? [...turn] : [-1, 1];
      const [middle, half] = [(range[0] + range[1]) / 2, (range[1] - range[0]) / 2 || Math.abs(range[0]) / 2 || 1];
      return [middle - 2 * half, middle + 2 * half];
    });
    this.widen(ranges);
    const at = (k: number, index: number) => ranges[k][0] + ((ranges[k][1] - ranges[k][0]) * index) / (GRID - 1);
    const points = Float64Array.from({ length: 2 * GRID * GRID }, (_, k) => (k % 2 ? at(1, Math.floor(k / 2 / GRID)) : at(0, (k / 2) % GRID)));
    const [all, several] = [this.valuesAt(points), this.names.length];
    return { say: "levels", levels: { ranges, size: GRID, values: Float64Array.from({ length: GRID * GRID }, (_, k) => all[k * several]) } };
  }

  /**
   * Widens the range of what goes with an angle until orbits go all around at both of its ends: there the least energy is
   * above the largest one in the middle, so that what divides the two kinds of orbits lies between.
   */
  private widen(ranges: [number, number][]): void {
    const angle = this.model.turns.findIndex((turn) => turn);
    if (angle < 0 || this.model.turns[1 - angle]) return;
    const [other, several] = [ranges[1 - angle], this.names.length];
    const energies = (value: number) => {
      const points = Float64Array.from({ length: 2 * GRID }, (_, k) => (k % 2 === angle ? ranges[angle][0] + ((ranges[angle][1] - ranges[angle][0]) * (k >> 1)) / (GRID - 1) : value));
      return this.valuesAt(points).filter((_, k) => k % several === 0);
    };
    const middle = (other[0] + other[1]) / 2;
    const top = Math.max(...energies(middle));
    for (let doubled = 0; doubled < WIDENED && other.some((end) => !(Math.min(...energies(end)) > top)); doubled++) {
      const half = other[1] - other[0];
      [other[0], other[1]] = [middle - half, middle + half];
    }
  }

  /** A saved result, computed again. */
  private compare(): Update | null {
    if (this.compared || !("saved" in this.job) || !this.job.saved) return null;
    this.compared = true;
    return comparison(this.core, this.job.system, this.job.saved);
  }

  /** Functions at states of `width` components, of which the first are those of the system. */
  private valuesAt(states: Float64Array, width: number = this.model.nComponents, functions: Functions | null = this.invariants): Float64Array {
    if (!functions) return new Float64Array();
    const { nComponents: n, parameters } = this.model;
    const [count, all] = [states.length / width, n + parameters.length];
    const points = new Float64Array(count * all);
    for (let k = 0; k < count; k++) {
      points.set(states.subarray(k * width, k * width + n), k * all);
      points.set(parameters, k * all + n);
    }
    return functions.values(points);
  }

  /** A piece of the motion between two checkpoints, of the top or of its shadow, whichever is behind. */
  private motion(): Update | null {
    const [top, shadow] = this.moved;
    const which = shadow.stopped || top.next <= shadow.next ? 0 : 1;
    const one = this.moved[which];
    const from = this.times[one.next];
    if (one.stopped || from >= this.wanted) return null;
    if (one.next + 1 >= this.times.length) return this.stopped ? null : this.pass();
    const to = this.times[one.next + 1];
    if (which === 0) one.state.set(this.checkpoints[one.next]);
    const orbit = this.core.orbit(this.moving, this.method, [...one.state, ...this.model.parameters], from, to);
    const count = Math.max(Math.ceil((to - from) / (SAMPLING * this.model.unit) - 1e-9), 1);
    const times = Float64Array.from({ length: count + 1 }, (_, k) => from + ((to - from) * k) / count);
    const wide = orbit.at(times);
    const { outcome, endTime } = orbit.ends;
    orbit.free();
    const states = withoutParameters(wide, times.length, this.model.width);
    one.state = states.slice(-this.model.width);
    const turned = this.turned[one.next];
    one.next += 1;
    if (outcome[0] !== "finished") {
      one.stopped = true;
      return { say: "ended", what: which === 0 ? "motion" : "shadow", outcome: outcome[0], time: endTime[0] };
    }
    if (which === 0 && !this.surveyed && this.model.nComponents === 2) this.extents.forEach((extent, k) => states.forEach((value, at) => at % this.model.width === k && extent.add(value, this.model.turns[k] ?? null)));
    const [values, axes] = [this.invariants, this.ellipsoid].map((functions) => (which === 0 ? this.valuesAt(states, this.model.width, functions) : new Float64Array()));
    return { say: "motion", shadow: which === 1, times, states: this.withTurns(states, turned, this.model.width), values, ellipsoid: axes };
  }

  private drifted: { times: number[]; differences: number[] } = { times: [], differences: [] };

  /** The orbit to the next checkpoint, and its crossings; now and then the drift. */
  private pass(): Update | null {
    const from = this.times[this.times.length - 1];
    if (this.stopped || from >= this.job.horizon) return this.drift();
    if (this.drifted.times.length >= 32) return this.drift();
    const to = this.early.find((time) => time > from) ?? Math.min((Math.floor(from / this.stride + 1e-9) + 1) * this.stride, this.job.horizon);
    const last = this.checkpoints[this.checkpoints.length - 1];
    const { direction } = this.job;
    const found = this.core.section(this.field, this.method, this.surface, last, { from, to, direction, sides: this.side });
    this.side = found.side;
    if (found.outcome[0] !== "finished") {
      this.stopped = true;
      return { say: "ended", what: "orbit", outcome: found.outcome[0], time: found.endTime[0] };
    }
    const end = inTurns(found.endState, this.model.turns);
    const turned = this.turned[this.turned.length - 1];
    this.times.push(to);
    this.checkpoints.push(end);
    this.turned.push(turned.map((value, k) => value + (found.endState[k] - end[k])));
    const values = this.valuesAt(end);
    this.drifted.times.push(to);
    this.drifted.differences.push(...values.map((value, k) => value - this.first[k]));
    const states = this.withTurns(found.crossings.state, turned, this.model.nComponents);
    return { say: "crossings", times: found.crossings.time, states, until: to };
  }

  /** States of `width` components with the turns before their checkpoint. */
  private withTurns(states: Float64Array, turned: Float64Array, width: number): Float64Array {
    this.model.turns.forEach((turn, k) => {
      if (turn && turned[k] !== 0) for (let at = k; at < states.length; at += width) states[at] += turned[k];
    });
    return states;
  }

  private drift(): Update | null {
    if (this.drifted.times.length === 0) return null;
    const { times, differences } = this.drifted;
    this.drifted = { times: [], differences: [] };
    return { say: "drift", times: Float64Array.from(times), differences: Float64Array.from(differences) };
  }

  /** The finite-time exponent of the orbit. */
  private growth(): Update | null {
    this.exponent ??= new Growth(this.core, this.tangentField, this.method, this.checkpoints[0], this.job.horizon, this.model);
    const found = this.exponent.advance();
    return found && { say: "exponent", times: Float64Array.of(found.time), values: found.values };
  }

  /** The exponents of an ensemble: starts along the orbit, so that all have its energy and its Casimirs. */
  private ensemble(): Update | null {
    if (this.stopped) return null;
    if (!this.band) {
      const late = this.checkpoints.slice(this.early.length);
      if (late.length < MEMBERS) return null;
      const states = Array.from({ length: MEMBERS }, (_, k) => late[Math.floor((k * late.length) / MEMBERS)]);
      const flat = Float64Array.from(states.flatMap((state) => [...state]));
      this.band = new Growth(this.core, this.tangentField, this.method, flat, this.job.horizon * BAND_HORIZON, this.model);
    }
    const found = this.band.advance();
    if (!found) return null;
    const sorted = found.values.filter(Number.isFinite).sort();
    const at = (part: number) => sorted[Math.round(part * (sorted.length - 1))];
    const values = Float64Array.of(at(0.1), at(0.5), at(0.9));
    return { say: "band", members: sorted.length, times: Float64Array.of(found.time), values };
  }
}

/** Growth of one tangent vector for each of some orbits, over times that double. */
class Growth {
  private readonly members: number;
  private time = 0;
  private done = 0;
  private readonly grown: Float64Array;
  private frames: Float64Array;
  private elapsed: Float64Array;
  private stopped = false;

  constructor(
    private readonly core: Core,
    private readonly field: Field,
    private readonly method: Method,
    private states: Float64Array,
    private readonly horizon: number,
    private readonly model: Model,
  ) {
    const n = field.nComponents;
    this.members = states.length / n;
    const measured = model.clock ?? n;
    this.frames = Float64Array.from(states, (_, k) => (k % n < measured ? 1 / Math.sqrt(measured) : 0));
    this.elapsed = new Float64Array(this.members);
    this.grown = new Float64Array(this.members);
  }

  /** Exponents at the next time. */
  advance(): { time: number; values: Float64Array } | null {
    if (this.stopped || this.time >= this.horizon) return null;
    const { unit, turns } = this.model;
    const length = interval(this.done) * unit;
    const parts = Math.max(1, Math.ceil((length * this.members) / unit / AT_ONCE / 4));
    const run = this.core.frames(this.field, this.method, this.states, this.frames, {
      nVectors: 1, elapsed: this.elapsed, duration: length / parts, nIntervals: parts,
    });
    if (run.outcome.some((outcome) => outcome !== "finished")) {
      this.stopped = true;
      return null;
    }
    for (let k = 0; k < this.members; k++) {
      for (let i = 0; i < parts; i++) this.grown[k] += run.growth[k * parts + i];
    }
    this.states = inTurns(run.endState, turns);
    this.frames = run.frame;
    this.elapsed = run.endTime;
    this.time += length;
    this.done += 1;
    return { time: this.time, values: this.grown.map((growth) => growth / this.time) };
  }
}

/** The same points of the circles, of states one after the other. */
function inTurns(states: Float64Array, turns: readonly (Turn | null)[]): Float64Array {
  return turns.some((turn) => turn) ? states.map((value, at) => within(value, turns[at % turns.length])) : states;
}

/** The first `width` numbers of each of `count` rows. */
function withoutParameters(wide: Float64Array, count: number, width: number): Float64Array {
  const states = new Float64Array(count * width);
  const all = wide.length / count;
  for (let k = 0; k < count; k++) states.set(wide.subarray(k * all, k * all + width), k * width);
  return states;
}
