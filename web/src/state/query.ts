/** Parts of an address, each read and checked on its own; what is wrong is said with the name of the part. */

import { Refused, type Everyday } from "./everyday";
import { exact, NotANumber, valueOf, type Exact } from "./exact";

/** The parts of an address, each of which is known and there once.  Throws `Refused` with a message that says what is wrong. */
export function queryOf(address: string, { version, names, longest }: { version: string; names: readonly string[]; longest: number }): URLSearchParams {
  const text = address.replace(/^#/, "");
  if (text.length > longest) throw new Refused(`the address is too long: ${text.length} characters, at most ${longest}`);
  const query = new URLSearchParams(text);
  const given = query.get("v");
  if (given !== version) throw new Refused(`the address has version ${shortened(given ?? "none")}; this page reads version ${version}`);
  for (const name of query.keys()) {
    if (!names.includes(name)) throw new Refused(`the address has an unknown part "${shortened(name)}"`);
    if (query.getAll(name).length > 1) throw new Refused(`the address has "${name}" twice`);
  }
  return query;
}

/** What `read` makes of an address, in which a text that is no number is refused. */
export function withNumbers<T>(read: () => T): T {
  try {
    return read();
  } catch (error) {
    if (error instanceof NotANumber) throw new Refused(error.message);
    throw error;
  }
}

export function list(query: URLSearchParams, name: string, length: number): string[] | null {
  const text = query.get(name);
  if (text === null) return null;
  const parts = text.split(",");
  if (parts.length !== length) throw new Refused(`"${name}" must be ${length} values; got ${parts.length}`);
  return parts;
}

/** Exact numbers, each of which has a name. */
export function exacts(query: URLSearchParams, name: string, of: readonly string[]): Exact[] {
  const texts = list(query, name, of.length) ?? [];
  return texts.map((text, index) => {
    try {
      return exact(text);
    } catch (error) {
      throw new Refused(`${of[index]}: ${(error as Error).message}`);
    }
  });
}

export function number(query: URLSearchParams, name: string, least: number, most: number): number | null {
  const text = query.get(name);
  if (text === null) return null;
  const value = valueOf(text.trim()) ?? Number.NaN;
  if (!(value >= least && value <= most)) throw new Refused(`"${name}" lies between ${least} and ${most}; got ${shortened(text)}`);
  return value;
}

export function oneOf<T extends string>(query: URLSearchParams, name: string, choices: readonly T[]): T | null {
  const text = query.get(name);
  if (text === null) return null;
  const found = choices.find((choice) => choice === text);
  if (!found) throw new Refused(`"${name}" is one of ${choices.join(", ")}; got "${shortened(text)}"`);
  return found;
}

/** Points of a section, one after the other. */
export function points(query: URLSearchParams, name: string): Everyday["added"] {
  const text = query.get(name);
  if (text === null) return [];
  const values = text.split(",").map((one) => valueOf(one.trim()) ?? Number.NaN);
  if (values.length % 2 || !values.every(Number.isFinite)) throw new Refused(`"${name}" must be pairs of numbers`);
  return values.flatMap((value, k) => (k % 2 ? [] : [[value, values[k + 1]] as const]));
}

/** A text of at most so many letters. */
export function shortened(text: string, most = 41): string {
  return text.length > most ? `${text.slice(0, most - 1).trimEnd()}…` : text;
}

/** The text of an address; commas and strokes stay what they are. */
export function textOf(query: URLSearchParams): string {
  return query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
}
