/**
 * Many orbits at once on the energy surface and the leaf of a start, chosen to fill the section, and the verdict of each.
 *
 * Starts are random: each guess is carried onto the energy and the Casimirs of the start by the core, and then to the surface.
 * Of those the next orbits are the ones farthest from all crossings that there are, in the plane of the two axes.
 */

import type { Core, Field, Functions, FunctionsDescription, Method } from "../core/core.js";
import { modelOf } from "../worker/model";
import type { SystemDescription } from "../systems/description";

/** What is wanted. */
export interface FanJob {
  readonly system: SystemDescription;
  readonly start: readonly number[];
  readonly surface: number;
  readonly direction: -1 | 0 | 1;
  readonly axes: readonly [number, number];
  readonly tol: number;
  /** Orbits that fill the section. */
  readonly count: number;
  /** Points between the axes through which others go. */
  readonly added: readonly (readonly [number, number])[];
}

export type Verdict = "regular" | "chaotic" | "undecided";

/** What is known of the orbits, after and after. */
export type FanUpdate =
  /** Guesses that led to no state of this energy, those whose orbits do not cross, and points through which no orbit of this energy goes. */
  | { readonly say: "starts"; readonly guesses: number; readonly failed: number; readonly uncrossed: number; readonly missed: readonly number[] }
  /** Crossings (crossing, component) of an orbit, the first of which is its start; `added` is the number of its point, or null. */
  | { readonly say: "orbit"; readonly index: number; readonly added: number | null; readonly count: number; readonly crossings: Float64Array }
  | { readonly say: "verdict"; readonly index: number; readonly verdict: Verdict; readonly exponent: number; readonly indicators: readonly number[] }
  /** All orbits are there; so many others ran away, and are left out. */
  | { readonly say: "filled"; readonly left: number }
  /** All verdicts are there, of runs up to the end. */
  | { readonly say: "decided"; readonly end: number }
  | { readonly say: "nothing"; readonly why: string };

/** Crossings of each orbit. */
export const CROSSINGS = 500;
/** Guesses for each orbit that is wanted. */
const GUESSES = 10;
/** Longest way, in units of time: to the surface from a guess, and for all crossings of an orbit. */
const FIRST = 200;
const LONGEST = 10 * CROSSINGS;
/** Orbits that are computed at a time: as many as the core has lanes in WebAssembly. */
const TOGETHER = 2;
/** Length of the run of a verdict in natural times, and its tolerance: those of `liepoisson.decide`. */
const NATURAL_TIMES = 1000;
const TOLERANCE = 1e-13;
const SEED = 20_241;

/** Why a system has no fan; null where it has one. */
export function withoutFan({ components, clock, invariants, saved }: SystemDescription): string | null {
  const n = components.length;
  if (clock !== null) return "H depends on time, so that orbits have no common energy.";
  if (!invariants) return "The page knows no energy of this system.";
  if (n - invariants.names.length < 2) return "An energy surface on a leaf is a curve here: it is one orbit.";
  if (n > MOST) return `The state has ${n} components; the page fills a section of at most ${MOST}.`;
  return saved?.kind === "section" ? "The file has a section of its own." : null;
}

/** Components of a system whose fan somebody would wait for. */
const MOST = 24;

/** The orbits, one piece of work after the other. */
export function* fan(core: Core, job: FanJob): Generator<FanUpdate> {
  const held: { free(): void }[] = [];
  const keep = <T extends { free(): void }>(thing: T): T => (held.push(thing), thing);
  try {
    yield* found(core, job, keep);
  } finally {
    for (const thing of held) thing.free();
  }
}

function* found(core: Core, job: FanJob, keep: <T extends { free(): void }>(thing: T) => T): Generator<FanUpdate> {
  const { system, start, direction, axes, count, added } = job;
  const model = modelOf(core, { ...job, horizon: 0, saved: null });
  const invariants = model.invariants as FunctionsDescription;
  const n = model.nComponents;
  const field: Field = keep(core.field(model.field));
  const method: Method = keep(core.method({ kind: "taylor", tol: job.tol }));
  const deciding: Method = keep(core.method({ kind: "taylor", tol: TOLERANCE }));
  const surface = keep(core.functions(model.surface));
  const conserved = keep(core.functions(invariants));
  const periods = system.turns.map((turn) => (turn ? turn[1] - turn[0] : Infinity));
  const values = conserved.values(start);
  const own = core.units(field, deciding, start, periods);
  const across = new Across(system, axes);
  const random = randomNumbers(SEED);

  const projected: Float64Array[] = [];
  const guesses = GUESSES * count;
  for (let k = 0; k < guesses; k++) {
    const guess = start.map((_, i) => {
      const [normal, part] = [random.normal(), random.uniform()];
      const turn = system.turns[i];
      return turn ? turn[0] + part * (turn[1] - turn[0]) : own.component[i] * normal;
    });
    const state = onto(core, conserved, guess, values, own.component);
    if (state) projected.push(state);
  }
  const firstOf = (states: readonly Float64Array[]) => firstCrossings(core, field, method, surface, states, { to: FIRST * system.unit, direction });
  const candidates = firstOf(projected).filter((state): state is Float64Array => state !== null);
  const itself = firstOf([Float64Array.from(start)])[0];
  const clicked = added.map((point) => through(core, { invariants, surface: model.surface, axes }, values, point, itself ? [itself, ...candidates] : candidates, across, own.component));
  // in the other direction the orbit comes here, too, but is not seen
  const crosses = (state: Float64Array) => firstOf([before(core, field, method, state, system.unit)])[0]?.every((x, i) => Math.abs(x - state[i]) <= SAME * own.component[i]);
  const reached = clicked.map((state) => (state && crosses(state) ? state : null));
  yield { say: "starts", guesses, failed: guesses - projected.length, uncrossed: projected.length - candidates.length, missed: reached.flatMap((state, k) => (state ? [] : [k])) };
  if (!itself && candidates.length === 0 && !reached.some(Boolean)) {
    yield { say: "nothing", why: "No orbit of this energy crosses the surface in this direction." };
    return;
  }

  const starts: Float64Array[] = [];
  let left = 0;
  let begun = candidates;
  let distances: number[] = [];
  const seen: Float64Array[] = [];
  const see = (rows: Float64Array) => begun.forEach((state, k) => {
    for (let at = 0; at < rows.length; at += n) distances[k] = Math.min(distances[k], across.distance(state, rows.subarray(at, at + n)));
  });
  /** Looks at the section anew, without a candidate. */
  const measure = (without: Float64Array | null) => {
    begun = begun.filter((state) => state !== without);
    across.fit(begun);
    distances = begun.map(() => Infinity);
    seen.forEach(see);
  };
  measure(null);
  const follow = function* (states: readonly Float64Array[], points: readonly (number | null)[]): Generator<FanUpdate> {
    const run = core.section(field, method, surface, flat(states), { to: LONGEST * system.unit, direction, nCrossings: CROSSINGS });
    let from = 0;
    for (let k = 0; k < states.length; k++) {
      const length = run.crossings.count[k] * n;
      if (run.outcome[k] !== "finished") {
        // one that runs away fills nothing, and would be next to nothing that does
        from += length;
        left += 1;
        measure(states[k]);
        continue;
      }
      const crossings = new Float64Array(n + length);
      crossings.set(states[k]);
      crossings.set(run.crossings.state.subarray(from, from + length), n);
      from += length;
      seen.push(crossings);
      see(crossings);
      starts.push(states[k]);
      yield { say: "orbit", index: starts.length - 1, added: points[k], count: crossings.length / n, crossings };
    }
  };
  if (itself) yield* follow([itself], [null]);
  while (starts.length < count) {
    const next: Float64Array[] = [];
    while (next.length < Math.min(TOGETHER, count - starts.length)) {
      const farthest = distances.reduce((best, distance, k) => (distance > distances[best] ? k : best), 0);
      if (!(distances[farthest] > 0)) break;
      next.push(begun[farthest]);
      see(begun[farthest]);
    }
    if (next.length === 0) break;
    yield* follow(next, next.map(() => null));
  }
  for (const [k, state] of reached.entries()) if (state) yield* follow([state], [k]);
  yield { say: "filled", left };
  if (starts.length === 0) {
    yield { say: "nothing", why: "Every orbit of this energy that was tried runs away." };
    return;
  }

  const units = core.units(field, deciding, flat(starts), periods);
  const end = twoDigits(NATURAL_TIMES * median([...units.time.slice(0, count)]));
  const isPlane = n - (model.names.length - 1) === 2;
  for (let k = 0; k < starts.length; k += TOGETHER) {
    const some = starts.slice(k, k + TOGETHER);
    const unit = units.component.slice(k * n, (k + some.length) * n);
    const tangents = some.flatMap((_, i) => directions(SEED + k + i, n).map((x, at) => x * unit[i * n + (at % n)]));
    const naturalTimes = Array.from(units.time.slice(k, k + some.length), (time) => end / time);
    const said = core.decide(field, deciding, flat(some), { tangents, units: unit, periods, naturalTimes, end, isPlane });
    for (let i = 0; i < some.length; i++) {
      const verdict = (["regular", "undecided", "chaotic"] as const)[said.kind[i] + 1];
      yield { say: "verdict", index: k + i, verdict, exponent: said.exponent[i], indicators: [...said.indicators.slice(4 * i, 4 * i + 4)] };
    }
  }
  yield { say: "decided", end };
}

/** The state nearest to a guess on the energy and the leaf; null where there is none nearby. */
function onto(core: Core, functions: Functions, guess: readonly number[] | Float64Array, values: ArrayLike<number>, units: ArrayLike<number>): Float64Array | null {
  const { state, residual } = core.project(functions, guess, values, units);
  return residual.every((one) => one <= RESIDUAL) ? state : null;
}

/** States that are the same, in units of the components. */
const SAME = 1e-9;
/** Of a solution, as the core says it. */
const RESIDUAL = 1e-13;

/** The first crossing of each orbit, null where there is none. */
function firstCrossings(core: Core, field: Field, method: Method, surface: Functions, states: readonly Float64Array[], { to, direction }: { to: number; direction: -1 | 0 | 1 }): (Float64Array | null)[] {
  if (states.length === 0) return [];
  const n = states[0].length;
  const { crossings } = core.section(field, method, surface, flat(states), { to, direction, nCrossings: 1 });
  let at = 0;
  return Array.from(crossings.count, (count) => {
    at += count * n;
    return count > 0 ? crossings.state.slice(at - n, at) : null;
  });
}

/** A short time earlier on the orbit. */
function before(core: Core, field: Field, method: Method, state: Float64Array, unit: number): Float64Array {
  return core.orbits(field, method, state, [0, -unit / 100]).endState;
}

/** The state on the surface, the energy and the leaf at a point between the axes, from the known state next to it; null where there is none. */
function through(core: Core, { invariants, surface, axes }: { invariants: FunctionsDescription; surface: FunctionsDescription; axes: readonly number[] }, values: ArrayLike<number>, point: readonly [number, number], known: readonly Float64Array[], across: Across, units: ArrayLike<number>): Float64Array | null {
  const equations = core.functions(joined(invariants, surface, axes));
  try {
    const near = [...known].sort((one, other) => across.from(one, point) - across.from(other, point));
    for (const state of near.slice(0, TRIED)) {
      const guess = state.slice();
      axes.forEach((axis, k) => (guess[axis] = point[k]));
      const found = onto(core, equations, guess, [...Array.from(values), 0, ...point], units);
      if (found) return found;
    }
    return null;
  } finally {
    equations.free();
  }
}

/** Known states from which a point is looked for. */
const TRIED = 12;

/** The functions that are conserved, that of the surface, and components, as one list. */
function joined(conserved: FunctionsDescription, surface: FunctionsDescription, axes: readonly number[]): FunctionsDescription {
  const n = conserved.n_components;
  const shift = conserved.instructions.length;
  const moved = (index: number) => (index < n ? index : index + shift);
  const others = surface.instructions.map(([name, inputs, numbers]): [string, number[], number[]] => [name, inputs.map(moved), numbers]);
  return { n_components: n, instructions: [...conserved.instructions, ...others], outputs: [...conserved.outputs, moved(surface.outputs[0]), ...axes] };
}

/** Distances in the plane of the axes, in units of what is seen there. */
class Across {
  private sizes = [1, 1];

  constructor(private readonly system: SystemDescription, private readonly axes: readonly [number, number]) {}

  fit(states: readonly Float64Array[]): void {
    this.sizes = this.axes.map((axis) => {
      const turn = this.system.turns[axis];
      const seen = states.map((state) => state[axis]);
      const size = turn ? turn[1] - turn[0] : Math.max(...seen) - Math.min(...seen);
      return size > 0 ? size : 1;
    });
  }

  distance(one: Float64Array, other: Float64Array): number {
    return this.from(one, [other[this.axes[0]], other[this.axes[1]]]);
  }

  from(state: Float64Array, point: readonly [number, number]): number {
    const parts = this.axes.map((axis, k) => {
      const turn = this.system.turns[axis];
      const apart = state[axis] - point[k];
      const period = turn ? turn[1] - turn[0] : Infinity;
      return (turn ? apart - period * Math.round(apart / period) : apart) / this.sizes[k];
    });
    return Math.hypot(parts[0], parts[1]);
  }
}

function flat(states: readonly Float64Array[]): Float64Array {
  const all = new Float64Array(states.reduce((sum, state) => sum + state.length, 0));
  states.reduce((at, state) => (all.set(state, at), at + state.length), 0);
  return all;
}

function median(values: readonly number[]): number {
  const known = values.filter((value) => Number.isFinite(value) && value > 0).sort((a, b) => a - b);
  const half = known.length / 2;
  return known.length === 0 ? 1 : (known[Math.ceil(half) - 1] + known[Math.floor(half)]) / 2;
}

function twoDigits(value: number): number {
  return Number(value.toPrecision(2));
}

/** Three random tangent vectors of length one. */
function directions(seed: number, n: number): number[] {
  const random = randomNumbers(seed);
  return [0, 1, 2].flatMap(() => {
    const vector = Array.from({ length: n }, () => random.normal());
    const length = Math.hypot(...vector);
    return vector.map((x) => x / length);
  });
}

/** Random numbers from a seed: Steele, Lea and Flood's SplitMix (2014) with 32 bits; normal ones by Box and Muller (1958). */
function randomNumbers(seed: number) {
  let state = seed >>> 0;
  const uniform = () => {
    state = (state + 0x9e3779b9) >>> 0;
    let z = state;
    z = Math.imul(z ^ (z >>> 16), 0x85ebca6b);
    z = Math.imul(z ^ (z >>> 13), 0xc2b2ae35);
    return (((z ^ (z >>> 16)) >>> 0) + 0.5) / 2 ** 32;
  };
  const normal = () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
  return { uniform, normal };
}
