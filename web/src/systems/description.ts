/** The system that the page carries: plain data, which Python has written (`liepoisson/laboratory/pages.py`). */

import type { FunctionsDescription, OtherDescription } from "../core/core.js";
import type { Turn } from "../state/turn";

/** The element of the page that holds it. */
export const CARRIED = "system";
const VERSION = 2;
/** What a page can show and compute while somebody waits. */
export const MOST_COMPONENTS = 400;
export const MOST_TERMS = 100_000;

export interface Named {
  readonly names: readonly string[];
  readonly functions: FunctionsDescription;
}

/** Where the first function is zero and the guard, if there is one, positive; `modulus` is the number modulo which that is meant. */
export interface SurfaceDescription {
  readonly name: string;
  readonly functions: FunctionsDescription;
  readonly modulus: string | null;
}

/** A linear map from the state to a picture: sums of coefficient * component * across(x) * up(y). */
export interface Picture {
  readonly name: string;
  /** Functions of the columns and of the rows, each at all points. */
  readonly across: readonly (readonly number[])[];
  readonly up: readonly (readonly number[])[];
  /** Component, function of the columns, function of the rows, coefficient. */
  readonly terms: readonly (readonly [number, number, number, number])[];
}

/** A result of Python, which the page computes again. */
export interface Saved {
  readonly kind: "orbit" | "section";
  readonly words: string;
  /** Why it is only shown; null where it can be computed again. */
  readonly shown_only: string | null;
  readonly tol: number;
  /** Starts (trajectory, component). */
  readonly starts: readonly (readonly number[])[];
  /** Of an orbit: times with the states (time, component) of its first trajectory; of a section those of crossings. */
  readonly times: readonly number[];
  readonly states: readonly (readonly number[])[];
  /** Of a section: the trajectory of each crossing, its surface and what is kept, and how it was asked for. */
  readonly trajectory: readonly number[];
  readonly functions: FunctionsDescription | null;
  readonly direction: -1 | 0 | 1;
  readonly n_crossings: number;
  readonly t_end: number;
  /** Whether the states are states of the system, and not functions of them. */
  readonly has_states: boolean;
  readonly coordinates: readonly string[];
}

export interface SystemDescription {
  readonly version: number;
  /** A short hash of the rest, which an address repeats. */
  readonly id: string;
  readonly name: string;
  readonly words: string;
  readonly components: readonly string[];
  readonly vector_length: number;
  /** Of each component the turn within which it is drawn, if it is a point of a circle. */
  readonly turns: readonly (Turn | null)[];
  /** The component that is time, of a Hamiltonian that depends on it; its momentum is the next one. */
  readonly clock: number | null;
  readonly field: OtherDescription;
  readonly invariants: Named | null;
  /** Surfaces of section: of each component, then others. */
  readonly surfaces: readonly SurfaceDescription[];
  /** Texts of exact numbers. */
  readonly start: readonly string[];
  /** The time in which it moves. */
  readonly unit: number;
  readonly surface: number;
  readonly direction: -1 | 0 | 1;
  readonly axes: readonly [number, number];
  readonly picture: Picture | null;
  readonly saved: Saved | null;
}

/** A description that cannot be shown: what is wrong with it. */
export class Malformed extends Error {}

type Plain = Record<string, unknown>;

/** Reads and checks the text of the element; throws `Malformed`. */
export function described(text: string): SystemDescription {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new Malformed("it is no JSON; the file may be truncated");
  }
  const one = record(value, "the description");
  if (one.version !== VERSION) throw new Malformed(`it has version ${shown(one.version)}; this page reads version ${VERSION}`);
  for (const name of ["id", "name", "words"]) text_(one[name], name);
  const components = texts(one.components, "components");
  const n = components.length;
  if (n === 0) throw new Malformed("it has no components");
  if (n > MOST_COMPONENTS) throw new Malformed(`it has ${n} components; a page shows at most ${MOST_COMPONENTS}. Use the Python package for it`);
  const field = record(one.field, "field");
  if (!["quadratic", "tape", "pieces", "top"].includes(String(field.kind))) throw new Malformed(`its field has the kind ${shown(field.kind)}, which the core does not know`);
  if (field.kind !== "top" && field.n_components !== n) throw new Malformed(`its field has ${shown(field.n_components)} components, and there are ${n} names`);
  const size = sizeOf(one.field as OtherDescription);
  if (size > MOST_TERMS) throw new Malformed(`its field has ${size} terms; a page follows at most ${MOST_TERMS}. Use the Python package for it`);
  if (one.invariants !== null) named(one.invariants, "invariants", n);
  const surfaces = list(one.surfaces, "surfaces");
  for (const surface of surfaces) surface_(record(surface, "a surface"), n);
  if (surfaces.length < n) throw new Malformed(`it has ${surfaces.length} surfaces; wanted one for each of its ${n} components`);
  whole(one.vector_length, "vector_length", 1, n);
  for (const turn of list(one.turns, "turns", n)) if (turn !== null) turn_(numbers(turn, "turns"));
  if (one.clock !== null) whole(one.clock, "clock", 0, n - 2);
  if (texts(one.start, "start").length !== n) throw new Malformed(`its start has ${(one.start as unknown[]).length} numbers; wanted ${n}`);
  if (!(typeof one.unit === "number" && one.unit > 0 && Number.isFinite(one.unit))) throw new Malformed("its unit of time is no positive number");
  whole(one.surface, "surface", 0, surfaces.length - 1);
  whole(one.direction, "direction", -1, 1);
  list(one.axes, "axes", 2).forEach((axis) => whole(axis, "axes", 0, n - 1));
  if (one.picture !== null) picture(record(one.picture, "picture"), n);
  if (one.saved !== null) saved(record(one.saved, "saved"), n);
  return value as SystemDescription;
}

function named(value: unknown, what: string, n: number): void {
  const one = record(value, what);
  const functions = record(one.functions, `functions of ${what}`);
  const outputs = list(functions.outputs, `outputs of ${what}`);
  if (functions.n_components !== n || texts(one.names, `names of ${what}`).length !== outputs.length) {
    throw new Malformed(`its ${what} do not fit its components`);
  }
}

function surface_(one: Plain, n: number): void {
  text_(one.name, "name of a surface");
  const functions = record(one.functions, "functions of a surface");
  if (functions.n_components !== n || list(functions.outputs, "outputs of a surface").length !== 1) throw new Malformed("a surface does not fit its components");
  if (one.modulus !== null) text_(one.modulus, "modulus of a surface");
}

function turn_(turn: readonly number[]): void {
  if (turn.length !== 2 || !(turn[0] < turn[1])) throw new Malformed(`a turn goes from one number to a larger one; got ${shown(turn)}`);
}

function picture(one: Plain, n: number): void {
  text_(one.name, "name of the picture");
  const sizes = ["across", "up"].map((side) => {
    const rows = list(one[side], `${side} of the picture`).map((row) => numbers(row, `${side} of the picture`).length);
    if (rows.some((length) => length !== rows[0] || length > 256)) throw new Malformed("its picture has rows of different lengths, or more than 256 points");
    return rows.length;
  });
  for (const term of list(one.terms, "terms of the picture")) {
    const [component, across, up] = numbers(term, "terms of the picture");
    whole(component, "component of the picture", 0, n - 1);
    whole(across, "term of the picture", 0, sizes[0] - 1);
    whole(up, "term of the picture", 0, sizes[1] - 1);
  }
}

function saved(one: Plain, n: number): void {
  if (one.kind !== "orbit" && one.kind !== "section") throw new Malformed(`its saved result has the kind ${shown(one.kind)}`);
  text_(one.words, "words of the saved result");
  const times = numbers(one.times, "times of the saved result");
  const states = list(one.states, "states of the saved result");
  if (states.length !== times.length) throw new Malformed(`its saved result has ${times.length} times and ${states.length} states`);
  const width = texts(one.coordinates, "coordinates of the saved result").length;
  if (states.some((state) => numbers(state, "states of the saved result").length !== width)) throw new Malformed("a saved state has another number of components");
  if (list(one.starts, "starts").some((start) => numbers(start, "starts").length !== n)) throw new Malformed("a saved start has another number of components");
}

/** Terms of a field, by which the work of a step grows. */
export function sizeOf(field: OtherDescription): number {
  let terms = 0;
  for (const part of Object.values(field as unknown as Plain)) {
    if (!Array.isArray(part)) continue;
    terms += part.length;
    for (const line of part) if (Array.isArray(line)) for (const inner of line) if (Array.isArray(inner)) terms += inner.length;
  }
  return terms;
}

/** Names of all surfaces, in the order of their numbers. */
export function surfaceNames({ surfaces }: SystemDescription): readonly string[] {
  return surfaces.map(({ name }) => name);
}

/** Components that are not of time: those before it. */
export function withoutTime({ components, clock }: SystemDescription): readonly string[] {
  return clock === null ? components : components.slice(0, clock);
}

/** What is conserved of a system, and to whose values a start can be moved; none, where time is one of the components. */
export function targetsOf({ clock, invariants }: SystemDescription): readonly string[] {
  return clock === null ? (invariants?.names ?? []) : [];
}

function record(value: unknown, what: string): Plain {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new Malformed(`${what} is no object`);
  return value as Plain;
}

function list(value: unknown, what: string, length?: number): unknown[] {
  if (!Array.isArray(value)) throw new Malformed(`its ${what} is no list`);
  if (length !== undefined && value.length !== length) throw new Malformed(`its ${what} has ${value.length} entries; wanted ${length}`);
  return value;
}

function text_(value: unknown, what: string): string {
  if (typeof value !== "string") throw new Malformed(`its ${what} is no text`);
  return value;
}

function texts(value: unknown, what: string): string[] {
  return list(value, what).map((one) => text_(one, what));
}

function numbers(value: unknown, what: string): number[] {
  return list(value, what).map((one) => {
    if (typeof one !== "number") throw new Malformed(`its ${what} has something else than numbers`);
    return one;
  });
}

function whole(value: unknown, what: string, least: number, most: number): number {
  if (typeof value !== "number" || !Number.isInteger(value) || value < least || value > most) {
    throw new Malformed(`its ${what} is ${shown(value)}; wanted a whole number from ${least} to ${most}`);
  }
  return value;
}

function shown(value: unknown): string {
  return (JSON.stringify(value) ?? "missing").slice(0, 40);
}
