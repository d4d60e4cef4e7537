/** A start on the leaf and the energy surface that are wanted: Newton's method, which the core carries out. */

import type { Core } from "../core/core.js";
import { families } from "../data/tops";
import type { Job } from "./messages";

export interface Projected {
  readonly state: Float64Array;
  /** How far each invariant is from its value, relative to what must cancel. */
  readonly residuals: Readonly<Record<string, number>>;
}

/** The energy and the Casimirs of every top. */
const [{ names, functions }] = families;

/**
 * The state nearest to first order to the start of a job.
 * @throws where the core refuses the numbers
 */
export function projected(core: Core, { start, parameters }: Pick<Job, "start" | "parameters">, wanted: Readonly<Record<string, number>>): Projected {
  const chosen = names.filter((name) => name in wanted);
  const outputs = chosen.map((name) => functions.outputs[names.indexOf(name)]);
  const equations = core.functions({ ...functions, outputs });
  try {
    const values = chosen.map((name) => wanted[name]);
    const { state, residual } = core.project(equations, [...start, ...parameters], values, start.map(() => 1));
    return { state: state.slice(0, start.length), residuals: Object.fromEntries(chosen.map((name, k) => [name, residual[k]])) };
  } finally {
    equations.free();
  }
}
