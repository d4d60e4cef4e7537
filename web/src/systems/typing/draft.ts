/** What somebody has typed: texts, right or wrong, from which a system is made, and which the address keeps. */

import { exact, type Exact } from "../../state/exact";
import { Refused } from "../../state/everyday";
import { shortened } from "../../state/query";
import data from "../../data/systems.json";

/** A parameter: the text of a number, or those of a vector. */
export type Given = string | readonly string[];

/** Where a slider begins and ends, and its step: texts of numbers. */
export type Range = readonly [string, string, string];

export interface Draft {
  readonly name: string;
  /** "canonical", "tensor", or one of the brackets of the list. */
  readonly bracket: string;
  /** Names of coordinates, of momenta if they have their own, and of those that are angles; one number stands for q1, p1, ... */
  readonly coordinates: string;
  readonly momenta: string;
  readonly angles: string;
  /** Lines {x, y} = formula. */
  readonly entries: string;
  readonly hamiltonian: string;
  readonly parameters: Readonly<Record<string, Given>>;
  /** Of single numbers, by the name of the parameter or of its entry. */
  readonly ranges: Readonly<Record<string, Range>>;
  /** Where the orbit begins, as long as nobody has chosen another start. */
  readonly start: readonly string[];
  /** The time in which it moves. */
  readonly unit: number;
}

export interface Listed {
  readonly words: string;
  readonly algebra: string;
  readonly extension: string;
  readonly fields: Readonly<Record<string, readonly string[]>>;
  readonly terms: readonly (readonly [number, number, number, string])[];
  readonly casimirs: readonly string[];
}

interface Example {
  readonly key: string;
  readonly words: string;
  readonly bracket: string;
  readonly coordinates: string;
  readonly momenta: string;
  readonly angles: string;
  readonly entries: string;
  readonly hamiltonian: string;
  readonly parameters: Readonly<Record<string, Given>>;
  readonly start: readonly string[];
  readonly unit: number;
}

export const BRACKETS = data.brackets as unknown as Readonly<Record<string, Listed>>;
export const EXAMPLES = data.examples as unknown as readonly Example[];

/** The kinds of brackets, and what they are called. */
export const KINDS: readonly (readonly [string, string])[] = [
  ["canonical", "canonical, coordinates and momenta"],
  ...Object.entries(BRACKETS).map(([key, { words }]) => [key, words] as const),
  ["tensor", "your own: structure constants or a tensor"],
];

const VERSION = "1";
const LONGEST = 16_000;
/** Characters of each text at most. */
const MOST = { name: 80, bracket: 20, coordinates: 200, momenta: 200, angles: 200, entries: 4_000, hamiltonian: 4_000 } as const;
const TEXTS = Object.keys(MOST) as (keyof typeof MOST)[];
/** Parameters, entries of one, and numbers of a start at most. */
const MOST_PARAMETERS = 40;
const MOST_ENTRIES = 20;
const MOST_NUMBERS = 64;
const NAME = /^(?!__)[A-Za-z_][A-Za-z0-9_]{0,39}$/;

export function draftOf(key: string): Draft {
  const example = EXAMPLES.find((one) => one.key === key) ?? EXAMPLES[0];
  const { words, key: _, ...rest } = example;
  return { name: words, ...rest, ranges: {} };
}

/** The example that a draft is; none where something was changed. */
export function exampleOf(draft: Draft): string | undefined {
  return EXAMPLES.find(({ key }) => checksum(draftOf(key)) === checksum(draft))?.key;
}

/** A single number of a parameter, as I1 of I. */
interface SingleNumber {
  readonly name: string;
  readonly of: string;
  readonly place: number | null;
  readonly text: string;
}

/** Single numbers of the parameters. */
export function numbersOf(parameters: Draft["parameters"]): SingleNumber[] {
  return Object.entries(parameters).flatMap(([of, given]): SingleNumber[] =>
    typeof given === "string" ? [{ name: of, of, place: null, text: given }] : given.map((text, place) => ({ name: `${of}${place + 1}`, of, place, text })),
  );
}

/** A draft with another value for one number. */
export function withNumber(draft: Draft, of: string, place: number | null, text: string): Draft {
  const given = draft.parameters[of];
  const next = place === null || typeof given === "string" ? text : given.with(place, text);
  return { ...draft, parameters: { ...draft.parameters, [of]: next } };
}

/** The range of a slider: the one that was set, or from 0 to twice the number; of 0 from -1 to 1. */
export function rangeOf(draft: Draft, name: string, text: string): Range {
  const own = draft.ranges[name];
  if (own) return own;
  let value = 0;
  try {
    value = exact(text).value;
  } catch {
    // a number that is not read keeps its text, and its slider stands in the middle
  }
  const size = value === 0 ? 1 : Math.abs(Number((2 * value).toPrecision(3)));
  const step = String(Number((size / 200).toPrecision(2)));
  return [value > 0 ? "0" : String(-size), value < 0 ? "0" : String(size), step];
}

/** The draft in an address; with its checksum, by which a damaged one is known. */
export function draftWritten(draft: Draft): URLSearchParams {
  const query = new URLSearchParams({ own: VERSION });
  for (const name of TEXTS) if (draft[name] !== "") query.set(name, draft[name]);
  const parameters = Object.entries(draft.parameters).map(([name, given]) => `${name}:${typeof given === "string" ? given : `${given.join(",")},`}`);
  if (parameters.length) query.set("parameters", parameters.join(";"));
  const ranges = Object.entries(draft.ranges).map(([name, range]) => `${name}:${range.join(",")}`);
  if (ranges.length) query.set("ranges", ranges.join(";"));
  query.set("from", draft.start.join(","));
  query.set("unit", String(draft.unit));
  query.set("sum", checksum(draft));
  return query;
}

/** Whether an address is one of a system that is typed. */
export function isTyped(address: string): boolean {
  return new URLSearchParams(address.replace(/^#/, "").slice(0, LONGEST)).has("own");
}

/** The draft of an address, and what is left of it for the state; throws `Refused` with what is wrong. */
export function draftRead(address: string): { readonly draft: Draft; readonly rest: string } {
  const text = address.replace(/^#/, "");
  if (text.length > LONGEST) throw new Refused(`the address is too long: ${text.length} characters, at most ${LONGEST}`);
  const query = new URLSearchParams(text);
  const version = query.get("own") ?? "";
  if (version !== VERSION) throw new Refused(`the address has version ${version.slice(0, 20) || "none"} of typed systems; this page reads version ${VERSION}`);
  if (!query.has("bracket") && !query.has("sum")) {
    const key = query.get("example");
    if (key !== null && !EXAMPLES.some((one) => one.key === key)) throw new Refused(`there is no example "${shortened(key)}"`);
    return { draft: draftOf(key ?? ""), rest: "" };
  }
  const texts = Object.fromEntries(
    TEXTS.map((name) => {
      const found = query.get(name) ?? "";
      if (found.length > MOST[name]) throw new Refused(`"${name}" has ${found.length} characters; at most ${MOST[name]}`);
      return [name, found];
    }),
  ) as Record<keyof typeof MOST, string>;
  if (!KINDS.some(([key]) => key === texts.bracket)) throw new Refused(`the address has an unknown bracket "${texts.bracket}"`);
  const parameters = pairs(query.get("parameters"), "parameters").map(([name, value]): [string, Given] => {
    if (!value.includes(",")) return [name, read(name, value).text];
    const entries = value.replace(/,$/, "").split(",").map((entry) => read(name, entry).text);
    if (entries.length > MOST_ENTRIES) throw new Refused(`${name} has ${entries.length} entries; at most ${MOST_ENTRIES}`);
    return [name, entries];
  });
  const ranges = pairs(query.get("ranges"), "ranges").map(([name, value]): [string, Range] => {
    const [low, high, step, ...more] = value.split(",");
    const isRange = step !== undefined && more.length === 0 && read(name, low).value < read(name, high).value && read(name, step).value > 0;
    if (!isRange) throw new Refused(`a slider goes from one number to a larger one, by steps above 0; got ${value.slice(0, 40)}`);
    return [name, [low, high, step]];
  });
  const start = (query.get("from") ?? "").split(",").filter(Boolean).map((text) => read("from", text).text);
  if (start.length > MOST_NUMBERS) throw new Refused(`the start has ${start.length} numbers; at most ${MOST_NUMBERS}`);
  const unit = Number(query.get("unit") ?? "1");
  if (!(unit >= 1e-6 && unit <= 1e6)) throw new Refused("the unit of time lies between 1e-6 and 1e6");
  const draft: Draft = { ...texts, parameters: Object.fromEntries(parameters), ranges: Object.fromEntries(ranges), start, unit };
  if (query.get("sum") !== checksum(draft)) throw new Refused("the address was damaged or cut on its way: its checksum is wrong. Ask for it again");
  for (const name of ["own", ...TEXTS, "parameters", "ranges", "from", "unit", "sum"]) query.delete(name);
  return { draft, rest: query.toString() };
}

function read(name: string, text: string): Exact {
  try {
    return exact(text);
  } catch (error) {
    throw new Refused(`${name}: ${(error as Error).message}`);
  }
}

function pairs(text: string | null, what: string): [string, string][] {
  if (!text) return [];
  const found = text.split(";").map((one): [string, string] => {
    const at = one.indexOf(":");
    const name = one.slice(0, Math.max(at, 0));
    if (!NAME.test(name)) throw new Refused(`"${what}" has something else than a name and its numbers: ${one.slice(0, 40)}`);
    return [name, one.slice(at + 1, at + 1 + 40 * MOST_ENTRIES)];
  });
  if (found.length > MOST_PARAMETERS) throw new Refused(`"${what}" has ${found.length} entries; at most ${MOST_PARAMETERS}`);
  return found;
}

/** A short hash of all that was typed (FNV-1a, of the code units). */
export function checksum(draft: Draft): string {
  const { parameters, ranges, start, unit } = draft;
  const text = JSON.stringify([TEXTS.map((name) => draft[name]), Object.entries(parameters), Object.entries(ranges), start, unit]);
  let hash = 0x811c9dc5;
  for (let k = 0; k < text.length; k++) hash = Math.imul(hash ^ text.charCodeAt(k), 0x01000193) >>> 0;
  return hash.toString(16).padStart(8, "0");
}
