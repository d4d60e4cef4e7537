/** A saved result, computed again by the core of this page, and how far apart the two are. */

import type { Core, Functions } from "../core/core.js";
import type { Update } from "../worker/messages";
import type { Saved, SystemDescription } from "./description";

type Compared = Extract<Update, { say: "compared" }>;

/** Up to this difference, relative to the largest number, two results are called the same. */
export const SMALL = 1e-6;

export function comparison(core: Core, system: SystemDescription, saved: Saved): Compared | null {
  if (saved.shown_only !== null || saved.times.length === 0) return null;
  const field = core.field(system.field);
  const method = core.method({ kind: "taylor", tol: saved.tol });
  try {
    if (saved.kind === "orbit") {
      const run = core.orbits(field, method, saved.starts[0], saved.times);
      return compared(saved, run.state, saved.times, "");
    }
    const functions: Functions = core.functions(saved.functions as object as Parameters<Core["functions"]>[0]);
    const course = { to: saved.t_end, direction: saved.direction, nCrossings: saved.n_crossings };
    const found = core.section(field, method, functions, saved.starts.flat(), course);
    functions.free();
    return ofSection(saved, found.crossings);
  } finally {
    field.free();
    method.free();
  }
}

/** Crossings of each trajectory, one by one; a trajectory on which their numbers differ is compared as far as both go. */
function ofSection(saved: Saved, crossings: { count: Float64Array; time: Float64Array; state: Float64Array }): Compared {
  const width = saved.coordinates.length;
  const [mine, states, times] = [[] as number[], [] as number[][], [] as number[]];
  let [from, different] = [0, 0];
  crossings.count.forEach((count, member) => {
    const wanted = saved.trajectory.flatMap((one, k) => (one === member ? [k] : []));
    if (wanted.length !== count) different += 1;
    wanted.slice(0, count).forEach((k, i) => {
      mine.push(...crossings.state.subarray((from + i) * width, (from + i + 1) * width));
      states.push([...saved.states[k]]);
      times.push(saved.times[k]);
    });
    from += count;
  });
  const total = crossings.count.reduce((sum, count) => sum + count, 0);
  const words = different
    ? `the file has ${saved.times.length} crossings, this page finds ${total}; on ${different} of ${crossings.count.length} orbits their numbers differ`
    : `both find ${total} crossings`;
  return compared({ ...saved, states, times }, Float64Array.from(mine), times, words);
}

/** The largest difference, and the time up to which it is small. */
export function compared(saved: Saved, mine: Float64Array, times: readonly number[], words: string): Compared {
  const width = saved.coordinates.length;
  let [largest, where, scale] = [0, 0, 1];
  for (const state of saved.states) for (const value of state) scale = Math.max(scale, Math.abs(value));
  const late: number[] = [];
  saved.states.forEach((state, k) => {
    let here = 0;
    state.forEach((value, i) => {
      const distance = Math.abs(mine[k * width + i] - value);
      here = Math.max(here, Number.isNaN(distance) ? Infinity : distance);
      if (!(distance <= largest)) [largest, where] = [Number.isNaN(distance) ? Infinity : distance, k * width + i];
    });
    if (here > SMALL * scale) late.push(Math.abs(times[k]));
  });
  const first = late.reduce((a, b) => Math.min(a, b), Infinity);
  const before = times.map(Math.abs).filter((time) => time < first);
  const until = before.reduce((a, b) => Math.max(a, b), 0);
  return {
    say: "compared",
    largest,
    at: times[Math.floor(where / width)] ?? 0,
    component: saved.coordinates[where % width] ?? "",
    until: late.length ? until : Infinity,
    count: saved.states.length * width,
    words,
  };
}

/** What is said of it. */
export function inWords(saved: Saved, found: Compared | null): string {
  if (saved.shown_only !== null) return `${saved.words}. It is only shown: ${saved.shown_only}.`;
  if (!found) return `${saved.words}. It is being computed again …`;
  const { largest, at, component, until, count } = found;
  const words = found.words ? ` ${found.words[0].toUpperCase()}${found.words.slice(1)}.` : "";
  if (largest === 0) return `${saved.words}.${words} Computed again here: all ${count} numbers are the same.`;
  const power = largest.toExponential(1).replace("-", "−").replace("e", " · 10^");
  const size = !Number.isFinite(largest) ? "not a number" : largest >= 0.1 && largest < 1000 ? String(Number(largest.toPrecision(2))) : power;
  const place = `in ${component} at t = ${Number(at.toPrecision(5))}`;
  const early = Number.isFinite(until) ? ` Up to t = ${Number(until.toPrecision(4))} the two are the same to one part in 10⁶; beyond it, the orbit has enlarged what was rounded.` : "";
  return `${saved.words}.${words} Computed again here: the largest difference of ${count} numbers is ${raised(size)} (${place}).${early}`;
}

const RAISED: Readonly<Record<string, string>> = { "−": "⁻", "+": "", "0": "⁰", "1": "¹", "2": "²", "3": "³", "4": "⁴", "5": "⁵", "6": "⁶", "7": "⁷", "8": "⁸", "9": "⁹" };

function raised(text: string): string {
  const [base, power] = text.split("^");
  return power === undefined ? text : base + [...power].map((letter) => RAISED[letter] ?? letter).join("");
}
