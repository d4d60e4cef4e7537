/** What page and worker say to each other.  Arrays are flat and row-major. */

import type { Levels } from "../panels/levels";
import type { Saved, SystemDescription } from "../systems/description";
import type { FanJob, FanUpdate } from "../fan/computation";
import type { Made, NotMade, Question } from "../systems/typing/made";

/** One orbit of a top, and all that is computed of it. */
export interface Job {
  readonly parameters: readonly number[];
  readonly start: readonly number[];
  /** Unit quaternion of the body at the start. */
  readonly attitude: readonly number[];
  /** Component that is zero on the section. */
  readonly surface: number;
  readonly direction: -1 | 0 | 1;
  /** Tolerance of the Taylor method. */
  readonly tol: number;
  readonly horizon: number;
}

/** The same of another system, which the page carries. */
export interface SystemJob {
  readonly system: SystemDescription;
  readonly start: readonly number[];
  /** A component, or after these one of the functions that the page carries. */
  readonly surface: number;
  readonly direction: -1 | 0 | 1;
  readonly tol: number;
  readonly horizon: number;
  /** What is computed again and compared. */
  readonly saved: Saved | null;
}

export type ToWorker =
  | { readonly say: "core"; readonly program: ArrayBuffer }
  | { readonly say: "job"; readonly generation: number; readonly job: Job | SystemJob }
  /** The motion is wanted up to here. */
  | { readonly say: "until"; readonly generation: number; readonly time: number }
  /** The state near the start of a job at which invariants have these values is wanted. */
  | { readonly say: "project"; readonly number: number; readonly job: Job | SystemJob; readonly wanted: Readonly<Record<string, number>> }
  /** The system that somebody has typed is wanted. */
  | { readonly say: "typed"; readonly number: number; readonly question: Question }
  /** The fan of a job is wanted, or none any more. */
  | { readonly say: "fan"; readonly generation: number; readonly job: FanJob | null }
  /** An update has been shown: another may come. */
  | { readonly say: "seen" };

export type Update =
  | { readonly say: "invariants"; readonly names: readonly string[]; readonly values: readonly number[]; readonly family: string }
  /**
   * States with attitude and position (time, 16) of the top or of its shadow; of the top invariants (time, invariant) and
   * the ellipsoid of its kinetic energy (time, 4), too.
   */
  | { readonly say: "motion"; readonly shadow: boolean; readonly times: Float64Array; readonly states: Float64Array; readonly values: Float64Array; readonly ellipsoid: Float64Array }
  | { readonly say: "crossings"; readonly times: Float64Array; readonly states: Float64Array; readonly until: number }
  /** Differences of the invariants from those of the start (time, invariant). */
  | { readonly say: "drift"; readonly times: Float64Array; readonly differences: Float64Array }
  | { readonly say: "exponent"; readonly times: Float64Array; readonly values: Float64Array }
  /** Deciles 1, 5 and 9 of an ensemble (time, 3). */
  | { readonly say: "band"; readonly members: number; readonly times: Float64Array; readonly values: Float64Array }
  /** The energy of a system of two components, around its orbit. */
  | { readonly say: "levels"; readonly levels: Levels }
  /** Largest difference of a saved result, where it is, up to which time it is small, and how many numbers were compared. */
  | { readonly say: "compared"; readonly largest: number; readonly at: number; readonly component: string; readonly until: number; readonly count: number; readonly words: string }
  | { readonly say: "ended"; readonly what: string; readonly outcome: string; readonly time: number }
  | { readonly say: "finished" };

export type FromWorker =
  | { readonly say: "ready" }
  | { readonly say: "update"; readonly generation: number; readonly update: Update }
  | { readonly say: "projected"; readonly number: number; readonly state: Float64Array; readonly residuals: Readonly<Record<string, number>> }
  | { readonly say: "fan"; readonly generation: number; readonly update: FanUpdate }
  /** Null where the core has stopped. */
  | { readonly say: "made"; readonly number: number; readonly found: Made | NotMade | null }
  | { readonly say: "not projected"; readonly number: number; readonly message: string }
  | { readonly say: "refused"; readonly generation: number; readonly kind: string; readonly message: string };
