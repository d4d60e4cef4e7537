/** From what was typed to a system: the core reads the formulas and derives all that follows from them. */

import { Refusal, type Core, type FunctionsDescription, type System, type SystemWritten } from "../../core/core.js";
import { MOST_COMPONENTS, MOST_TERMS, sizeOf, type SurfaceDescription, type SystemDescription } from "../description";
import type { Draft, Given, Listed } from "./draft";

export interface Made {
  readonly made: true;
  readonly system: SystemDescription;
  readonly written: SystemWritten;
  /** Those that the system has, with those that a name has made. */
  readonly parameters: Readonly<Record<string, Given>>;
  /** Formulas; null where nobody has looked for them. */
  readonly casimirs: readonly string[] | null;
}

export interface NotMade {
  readonly made: false;
  /** Where it is wrong. */
  readonly field: "hamiltonian" | "bracket";
  readonly message: string;
  /** The text that is wrong, and the place in it, or -1. */
  readonly text: string;
  readonly place: number;
  /** A name that may become a parameter. */
  readonly offered: string | null;
}

/** Where the orbit of the page begins now. */
export interface Begun {
  readonly names: readonly string[];
  readonly values: readonly number[];
}

/** Time, on which no system that is typed here may depend. */
const TIME = "t";
/** Of components that nobody has given a start. */
const START = ["0.5", "0.3", "0.2", "0.4", "-0.3", "0.6", "0.1", "-0.2", "0.7"];

interface BracketMade {
  readonly record: object;
  readonly names: readonly string[];
  readonly length: number;
  readonly angles: readonly string[];
  readonly fields: Readonly<Record<string, readonly string[]>>;
  /** Formulas in which parameters may occur, besides the Hamiltonian. */
  readonly formulas: readonly string[];
  readonly casimirs: readonly string[] | null;
}

class Wrong extends Error {
  constructor(readonly field: NotMade["field"], message: string, readonly text = "", readonly place = -1, readonly offered: string | null = null) {
    super(message);
  }
}

/** What is typed, with what the list has of its bracket, and where the orbit begins now, which is checked. */
export interface Question {
  readonly draft: Draft;
  readonly listed: Listed | null;
  readonly start: Begun | null;
}

/** The system, or what is wrong. */
export function made(core: Core, { draft, listed, start }: Question): Made | NotMade {
  try {
    return system(core, draft, listed, start);
  } catch (error) {
    if (error instanceof Wrong) return { made: false, field: error.field, message: error.message, text: error.text, place: error.place, offered: error.offered };
    if (error instanceof Refusal) return { made: false, field: "hamiltonian", message: sentence(error.message), text: draft.hamiltonian, place: error.place, offered: null };
    throw error;
  }
}

function system(core: Core, draft: Draft, listed: Listed | null, start: Begun | null): Made {
  const bracket = bracketOf(draft, listed);
  if (!draft.hamiltonian.trim()) throw new Wrong("hamiltonian", "Type a Hamiltonian, a formula in the coordinates, such as " + `${bracket.names[0]}^2/2.`);
  checkBracket(core, bracket, draft);
  const { typed, parameters } = withParameters(core, draft, bracket);
  try {
    const description = described(core, typed, draft, bracket, start);
    return { made: true, system: description, written: typed.written, parameters, casimirs: bracket.casimirs };
  } finally {
    typed.free();
  }
}

/** The bracket by itself, so that what is wrong with it is not said of the Hamiltonian. */
function checkBracket(core: Core, bracket: BracketMade, draft: Draft): void {
  const { record, names, formulas } = bracket;
  try {
    const wanted = allNames(core, formulas);
    const parameters = used(draft.parameters, wanted, bracket);
    core.system({ bracket: record as never, hamiltonian: names[0], parameters: parameters as never, declared: unknown(wanted, bracket, parameters) }).free();
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    const text = formulas.find((formula) => error.place >= 0 && cannotBeRead(core, formula)) ?? "";
    throw new Wrong("bracket", sentence(error.message), text, text ? error.place : -1);
  }
}

function cannotBeRead(core: Core, formula: string): boolean {
  try {
    core.names(formula);
    return false;
  } catch {
    return true;
  }
}

function allNames(core: Core, formulas: readonly string[]): string[] {
  return formulas.flatMap((formula) => core.names(formula));
}

/** Names that stand for no coordinate and no parameter. */
function unknown(wanted: readonly string[], { names, fields }: BracketMade, parameters: Readonly<Record<string, Given>>): string[] {
  const own = Object.entries(parameters).flatMap(([name, given]) => [name, ...(typeof given === "string" ? [] : given.map((_, k) => `${name}${k + 1}`))]);
  const known = new Set([...names, ...Object.keys(fields), ...own]);
  return [...new Set(wanted)].filter((name) => !known.has(name));
}

/** Parameters that formulas name, themselves or by an entry; a name that is that of a coordinate by now is none. */
function used(parameters: Draft["parameters"], wanted: readonly string[], bracket: BracketMade): Record<string, Given> {
  const coordinates = new Set([...bracket.names, ...Object.keys(bracket.fields)]);
  const names = wanted.filter((name) => !coordinates.has(name));
  const has = (name: string, given: Given) => names.includes(name) || (typeof given !== "string" && given.some((_, k) => names.includes(`${name}${k + 1}`)));
  return Object.fromEntries(Object.entries(parameters).filter(([name, given]) => has(name, given)));
}

/** The system with its parameters: a name that stands for nothing else is one, and begins with 1. */
function withParameters(core: Core, draft: Draft, bracket: BracketMade): { typed: System; parameters: Record<string, Given> } {
  const { hamiltonian } = draft;
  const { record, names, fields, formulas } = bracket;
  const wanted = [...core.names(hamiltonian), ...allNames(core, formulas)];
  if (wanted.includes(TIME) && !names.includes(TIME)) throw new Wrong("hamiltonian", "t is the time, and a system that is typed here does not depend on it. Give the parameter another name.", hamiltonian, placeOf(hamiltonian, TIME));
  const coordinates = [...names, ...Object.keys(fields)];
  if (!core.names(hamiltonian).some((name) => coordinates.includes(name))) {
    throw new Wrong("hamiltonian", `H has none of the coordinates ${names.slice(0, 6).join(", ")}${names.length > 6 ? ", …" : ""}, so that nothing would move.`);
  }
  const parameters = used(draft.parameters, wanted, bracket);
  const missing = unknown(wanted, bracket, parameters);
  // the core takes names of the bracket for symbols
  for (const name of unknown(allNames(core, formulas), bracket, parameters)) parameters[name] = "1";
  for (;;) {
    try {
      return { typed: core.system({ bracket: record as never, hamiltonian, parameters: parameters as never }), parameters };
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      const next = missing.find((name) => !(name in parameters));
      if (next === undefined) return { typed: reshaped(core, { bracket: record as never, hamiltonian }, parameters, fields, error), parameters };
      // a name that is nearly one that is known is more likely mistyped
      if (/ (Did you mean|[A-Za-z_0-9]+ has \d+ components)/.test(error.message) && error.place === placeOf(hamiltonian, next)) {
        throw new Wrong("hamiltonian", sentence(error.message), hamiltonian, error.place, next);
      }
      parameters[next] = "1";
    }
  }
}

/** Parameters of which the shape is tried at most: each doubles the number of systems. */
const MOST_SHAPES = 6;

/**
 * The system in which some parameters are vectors that were numbers, as inv(I)*l wants, or numbers that were vectors: as few
 * as can be. What was wrong first is said where none fit.
 */
function reshaped(core: Core, system: { bracket: never; hamiltonian: string }, parameters: Record<string, Given>, fields: BracketMade["fields"], first: Refusal): System {
  const longest = Math.max(0, ...Object.values(fields).map((components) => components.length));
  const lengthOf = (name: string) => {
    const entries = [...system.hamiltonian.matchAll(new RegExp(`\\b${name}\\s*\\[\\s*(\\d{1,2})\\s*\\]`, "g"))].map(([, entry]) => Number(entry));
    return entries.length ? Math.max(1, ...entries) : longest;
  };
  const other = (name: string): Given => {
    const given = parameters[name];
    return typeof given === "string" ? Array.from({ length: lengthOf(name) }, () => given) : given[0];
  };
  const names = Object.keys(parameters).filter((name) => typeof parameters[name] !== "string" || lengthOf(name) > 0).slice(0, MOST_SHAPES);
  const choices = Array.from({ length: 2 ** names.length - 1 }, (_, k) => names.filter((_name, place) => ((k + 1) >> place) & 1));
  for (const chosen of choices.sort((a, b) => a.length - b.length)) {
    const tried = { ...parameters, ...Object.fromEntries(chosen.map((name) => [name, other(name)])) };
    try {
      const typed = core.system({ ...system, parameters: tried as never });
      Object.assign(parameters, tried);
      return typed;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
    }
  }
  throw first;
}

function placeOf(text: string, name: string): number {
  return new RegExp(`(?<![A-Za-z0-9_])${name}(?![A-Za-z0-9_])`).exec(text)?.index ?? -1;
}

function bracketOf(draft: Draft, listed: Listed | null): BracketMade {
  if (listed) {
    const { fields, terms, casimirs } = listed;
    const names = Object.entries(fields).flatMap(([field, components]) => components.map((component) => field + component));
    const isOfThree = Object.values(fields).every((components) => components.length === 3);
    return { record: { name: "known", fields, terms }, names, length: isOfThree ? 3 : 1, angles: [], fields, formulas: [...new Set(terms.map((term) => term[3]))], casimirs };
  }
  return draft.bracket === "tensor" ? tensor(draft) : canonical(draft);
}

function canonical(draft: Draft): BracketMade {
  const coordinates = words(draft.coordinates);
  if (coordinates.length === 0) throw new Wrong("bracket", "Name the coordinates, such as x, y; each has a momentum.");
  if (coordinates.length === 1 && /^[1-9]$/.test(coordinates[0])) {
    const components = Array.from({ length: Number(coordinates[0]) }, (_, k) => String(k + 1));
    const fields = { q: components, p: components };
    const names = Object.entries(fields).flatMap(([field, list]) => list.map((component) => field + component));
    return { record: { name: "canonical", n: components.length }, names, length: components.length === 3 ? 3 : 1, angles: anglesOf(draft, names), fields, formulas: [], casimirs: [] };
  }
  const momenta = words(draft.momenta);
  const own = momenta.length ? momenta : coordinates.map((name) => `p_${name}`);
  const names = [...coordinates, ...own];
  const record = { name: "canonical", coordinates, ...(momenta.length ? { momenta } : {}) };
  return { record, names, length: 1, angles: anglesOf(draft, names), fields: {}, formulas: [], casimirs: [] };
}

function anglesOf(draft: Draft, names: readonly string[]): string[] {
  const angles = words(draft.angles);
  const unknown = angles.find((name) => !names.includes(name));
  if (unknown !== undefined) throw new Wrong("bracket", `An angle is one of the coordinates ${names.join(", ")}; got ${unknown.slice(0, 40)}.`);
  return angles;
}

/** The entries of a line {x, y} = formula. */
export const LINE = /^\s*[{[(]?\s*([A-Za-z_]\w*)\s*,\s*([A-Za-z_]\w*)\s*[}\])]?\s*=\s*(.+?)\s*$/;

function tensor(draft: Draft): BracketMade {
  const names = words(draft.coordinates);
  if (names.length < 2) throw new Wrong("bracket", "Name the coordinates, such as x, y, z.");
  const lines = draft.entries.split("\n").filter((line) => line.trim());
  const entries = lines.map((line): [number, number, string] => {
    const [, first, second, formula] = LINE.exec(line) ?? [];
    if (formula === undefined) throw new Wrong("bracket", `A line of the bracket is written {${names[0]}, ${names[1]}} = formula; got ${line.slice(0, 60)}`);
    const [i, j] = [names.indexOf(first), names.indexOf(second)];
    if (i < 0 || j < 0) throw new Wrong("bracket", `The coordinates are ${names.join(", ")}; got ${i < 0 ? first : second}.`);
    if (i === j) throw new Wrong("bracket", `{${first}, ${first}} is 0 in every bracket. Remove the line.`);
    return i < j ? [i, j, formula] : [j, i, `-(${formula})`];
  });
  const pairs = entries.map(([i, j]) => `${i},${j}`);
  const twice = pairs.findIndex((pair, k) => pairs.indexOf(pair) < k);
  if (twice >= 0) throw new Wrong("bracket", `{${names[entries[twice][0]]}, ${names[entries[twice][1]]}} is given twice. Keep one line.`);
  return { record: { name: "tensor", coordinates: names, entries }, names, length: 1, angles: anglesOf(draft, names), fields: {}, formulas: entries.map((entry) => entry[2]), casimirs: null };
}

/** Names that are separated by commas or spaces. */
export function words(text: string): string[] {
  return text.split(/[\s,;]+/).filter(Boolean);
}

function described(core: Core, typed: System, draft: Draft, { names, length, angles, casimirs }: BracketMade, start: Begun | null): SystemDescription {
  const n = names.length;
  if (n > MOST_COMPONENTS) throw new Wrong("bracket", `There are ${n} components; a page shows at most ${MOST_COMPONENTS}.`);
  const field = typed.fieldRecord;
  if (field.kind !== "top" && sizeOf(field) > MOST_TERMS) {
    throw new Wrong("hamiltonian", `The equations have ${sizeOf(field)} terms; a page follows at most ${MOST_TERMS}. The Python package follows more.`);
  }
  const functions = typed.functionsRecord(draft.hamiltonian, ...(casimirs ?? []));
  const begin = names.map((_, k) => draft.start[draft.start.length === n ? k : -1] ?? START[k % START.length]);
  const isSame = start !== null && start.names.join() === names.join();
  checkStart(core, functions, isSame ? start.values : begin.map(numberOf), field.kind === "top" ? null : typed);
  const surfaces = names.map((name, k): SurfaceDescription => {
    if (!angles.includes(name)) return { name, functions: { n_components: n, instructions: [], outputs: [k] }, modulus: null };
    const { outputs, ...rest } = typed.functionsRecord(`sin(${name})`, `cos(${name})`);
    return { name, functions: { ...rest, outputs: [outputs[0]], guard: outputs[1] }, modulus: "2π" };
  });
  const isCanonical = draft.bracket === "canonical" && n > 2;
  return {
    version: 2,
    id: "",
    name: draft.name || "A system of your own",
    words: "",
    components: names,
    vector_length: length,
    turns: names.map((name) => (angles.includes(name) ? [-Math.PI, Math.PI] : null)),
    clock: null,
    field,
    invariants: { names: ["H", ...(casimirs ?? []).map((_, k) => `C${k + 1}`)], functions },
    surfaces,
    start: begin,
    unit: draft.unit,
    surface: 0,
    direction: 1,
    axes: isCanonical ? [1, 1 + n / 2] : [n > 2 ? 1 : 0, Math.min(n > 2 ? 2 : 1, n - 1)],
    picture: null,
    saved: null,
  } as SystemDescription;
}

function numberOf(text: string): number {
  const [above, below = "1"] = text.split("/");
  return Number(above) / Number(below);
}

/** Refuses a system that has no numbers where the orbit begins, before a picture is given up for it. */
function checkStart(core: Core, functions: FunctionsDescription, start: readonly number[], typed: System | null): void {
  const held = core.functions(functions);
  const [energy] = held.values(start);
  held.free();
  const words = "is not a finite number at the start: it divides by zero there, or takes a root or logarithm of what has none. Change the start or the formula.";
  if (!Number.isFinite(energy)) throw new Wrong("hamiltonian", `H ${words}`);
  if (!typed) return;
  const [field, method] = [typed.field(), core.method({ kind: "taylor", tol: 1e-15 })];
  const rates = core.rates(field, method, start);
  field.free();
  method.free();
  if (!rates.every(Number.isFinite)) throw new Wrong("hamiltonian", `The rate of change of a component ${words}`);
}

/** A message as a sentence of its own. */
function sentence(message: string): string {
  const text = message.replace(/ \(line 1, column (\d+)\)\.$/, ".");
  return text[0].toUpperCase() + text.slice(1);
}
