/** A start on the leaf and the energy surface that are wanted: Newton's method, which the core carries out. */

import type { Core, FunctionsDescription } from "../core/core.js";
import { families } from "../data/tops";
import type { Job, SystemJob } from "./messages";

export interface Projected {
  readonly state: Float64Array;
  /** How far each invariant is from its value, relative to what must cancel. */
  readonly residuals: Readonly<Record<string, number>>;
}

/** What is conserved, as functions of the state and what comes after it, and in which units the nearest state is meant. */
interface Equations {
  readonly names: readonly string[];
  readonly functions: FunctionsDescription;
  readonly after: readonly number[];
  readonly units: ArrayLike<number>;
}

type Moved = Pick<Job, "start" | "parameters"> | SystemJob;

/**
 * The state nearest to first order to the start of a job.
 * @throws where the core refuses the numbers
 */
export function projected(core: Core, job: Moved, wanted: Readonly<Record<string, number>>): Projected {
  const { names, functions, after, units } = "system" in job ? ofSystem(core, job) : ofTop(job);
  const chosen = names.filter((name) => name in wanted);
  const outputs = chosen.map((name) => functions.outputs[names.indexOf(name)]);
  const equations = core.functions({ ...functions, outputs });
  try {
    const values = chosen.map((name) => wanted[name]);
    const { state, residual } = core.project(equations, [...job.start, ...after], values, units);
    return { state: state.slice(0, job.start.length), residuals: Object.fromEntries(chosen.map((name, k) => [name, residual[k]])) };
  } finally {
    equations.free();
  }
}

/** The energy and the Casimirs of every top. */
function ofTop({ start, parameters }: Pick<Job, "start" | "parameters">): Equations {
  const [{ names, functions }] = families;
  return { names, functions, after: parameters, units: start.map(() => 1) };
}

/** Those that the page knows of a system, in the units in which its components move. */
function ofSystem(core: Core, { system, start, tol }: SystemJob): Equations {
  if (!system.invariants) throw new Error("nothing conserved is known of this system");
  const [field, method] = [core.field(system.field), core.method({ kind: "taylor", tol })];
  try {
    const periods = system.turns.map((turn) => (turn ? turn[1] - turn[0] : Infinity));
    return { ...system.invariants, after: [], units: core.units(field, method, start, periods).component };
  } finally {
    field.free();
    method.free();
  }
}
