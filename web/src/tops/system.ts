/** A top as a system: what a section of many orbits needs of it. */

import type { FunctionsDescription } from "../core/core.js";
import { components, families, N } from "../data/tops";
import type { SystemDescription } from "../systems/description";

/** The energy and the Casimirs of every top. */
const [{ names, functions }] = families;

export function systemOf(parameters: readonly number[]): SystemDescription {
  const [inertia, a, b] = [0, 3, 6].map((k) => parameters.slice(k, k + 3));
  return {
    version: 2,
    id: "",
    name: "top",
    words: "",
    components,
    vector_length: 3,
    turns: components.map(() => null),
    clock: null,
    field: { kind: "top", inertia, a, b, epsilon: parameters[9] },
    invariants: { names, functions: atParameters(functions, parameters) },
    surfaces: components.map((name, k) => ({ name, functions: { n_components: N, instructions: [], outputs: [k] }, modulus: null })),
    start: [],
    unit: 1,
    surface: 0,
    direction: 1,
    axes: [0, 1],
    picture: null,
    saved: null,
  } as unknown as SystemDescription;
}

/** Functions of the state alone: the parameters, which came after it, are constants, and nothing else has another number. */
function atParameters({ instructions, outputs }: FunctionsDescription, parameters: readonly number[]): FunctionsDescription {
  const constants = parameters.map((value): [string, number[], number[]] => ["linear", [], [value]]);
  return { n_components: N, instructions: [...constants, ...instructions], outputs };
}
