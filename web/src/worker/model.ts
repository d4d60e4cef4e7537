/** What moves, as the core takes it: a top with its parameters, or a system that the page carries. */

import type { Core, FieldDescription, FunctionsDescription } from "../core/core.js";
import { ellipsoid, families, moving, N, position, WIDTH } from "../data/tops";
import type { Turn } from "../state/turn";
import { sizeOf } from "../systems/description";
import type { Job, SystemJob } from "./messages";

export interface Model {
  readonly nComponents: number;
  /** Components of what is drawn: the state, and attitude and position of a body. */
  readonly width: number;
  readonly field: FieldDescription;
  /** Along which tangent vectors are measured. */
  readonly tangentField: FieldDescription;
  /** The component that is time, if there is one; tangent vectors lead to neighbours at the same time. */
  readonly clock: number | null;
  /** State, attitude, position and parameters, whose rates are zero. */
  readonly moving: FieldDescription;
  /** Of each component its turn, if it is a point of a circle. */
  readonly turns: readonly (Turn | null)[];
  readonly attitude: readonly number[];
  readonly parameters: readonly number[];
  readonly surface: FunctionsDescription;
  /** Functions of state and parameters. */
  readonly invariants: FunctionsDescription | null;
  /** Half axes of the ellipsoid of a top. */
  readonly ellipsoid: FunctionsDescription | null;
  readonly names: readonly string[];
  readonly family: string;
  /** Whether a second orbit close to the first is followed. */
  readonly shadow: boolean;
  /** The time in which it moves. */
  readonly unit: number;
  /** Into how many parts the work between checkpoints is cut, a power of two. */
  readonly parts: number;
}

/** Terms of a field with which a piece of work takes some milliseconds. */
const TERMS = 200;
const MOST_PARTS = 64;

export function modelOf(core: Core, job: Job | SystemJob): Model {
  return "system" in job ? systemModel(job) : topModel(core, job);
}

function topModel(core: Core, { parameters, start, attitude, surface }: Job): Model {
  const [inertia, a, b] = [0, 3, 6].map((k) => parameters.slice(k, k + 3));
  const { names, name, functions } = familyOf(core, [...start, ...parameters]);
  return {
    nComponents: N,
    width: WIDTH,
    field: { kind: "top", inertia, a, b, epsilon: parameters[9] },
    tangentField: { kind: "top", inertia, a, b, epsilon: parameters[9] },
    clock: null,
    moving,
    turns: [],
    attitude: [...attitude, ...position.map(() => 0)],
    parameters,
    surface: { n_components: N, instructions: [], outputs: [surface] },
    invariants: functions,
    ellipsoid,
    names,
    family: name,
    shadow: true,
    unit: 1,
    parts: 1,
  };
}

/** The last family that the top belongs to. */
function familyOf(core: Core, at: readonly number[]) {
  const member = families.filter(({ conditions }) => {
    if (!conditions) return true;
    const functions = core.functions(conditions);
    const values = functions.values(at);
    functions.free();
    return values.every((value) => value === 0);
  });
  return member[member.length - 1];
}

function systemModel({ system, surface }: SystemJob): Model {
  const { components, clock, field, invariants, turns, unit } = system;
  const parts = Math.min(2 ** Math.max(Math.ceil(Math.log2(sizeOf(field) / TERMS)), 0), MOST_PARTS);
  return {
    nComponents: components.length,
    width: components.length,
    field,
    tangentField: clock === null ? field : withoutMomentum(field),
    clock,
    moving: field,
    turns,
    attitude: [],
    parameters: [],
    surface: system.surfaces[surface].functions,
    invariants: invariants?.functions ?? null,
    ellipsoid: null,
    names: invariants?.names ?? [],
    family: system.name,
    shadow: false,
    unit,
    parts,
  };
}

/** The field with the momentum of time at rest, which drives nothing and whose tangent vectors would outgrow the others. */
function withoutMomentum(field: FieldDescription): FieldDescription {
  if (field.kind !== "tape") return field;
  const { n_components, instructions, outputs } = field as unknown as FunctionsDescription;
  const found = {
    ...field,
    instructions: [...instructions, ["linear", [], [0]]],
    outputs: [...outputs.slice(0, -1), n_components + instructions.length],
  };
  return found as FieldDescription;
}
