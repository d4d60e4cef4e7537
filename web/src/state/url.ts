/**
 * The laboratory in the address, after the `#`: version 1.  Numbers are written as the user wrote them, so that the same
 * orbit comes back bit for bit.  An address is data: it is read by these rules, shown as text, and never run.
 */

import { components, parameters } from "../data/tops";
import { exact, NotANumber, type Exact } from "./exact";
import {
  begun, checkedMethod, checkParameter, component, FASTEST, FRAMES, HORIZON, Refused, SLOWEST, THEMES,
  type Direction, type Laboratory, type Method,
} from "./laboratory";

const VERSION = "1";
const LONGEST = 4000;
const NAMES = ["v", "preset", "top", "start", "section", "axes", "method", "frame", "shadow", "theme", "t", "speed"];

export function written(lab: Laboratory): string {
  const query = new URLSearchParams({ v: VERSION });
  if (lab.preset) query.set("preset", lab.preset);
  else {
    query.set("top", lab.parameters.map((one) => one.text).join(","));
    query.set("start", lab.start.map((one) => one.text).join(","));
  }
  query.set("section", `${lab.surface},${lab.direction}`);
  query.set("axes", lab.axes.join(","));
  query.set("method", `taylor,${lab.method.tol.text}`);
  query.set("frame", lab.view.frame);
  query.set("shadow", lab.view.shadow ? "1" : "0");
  query.set("theme", lab.theme);
  query.set("t", String(lab.time));
  query.set("speed", String(lab.speed));
  return query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
}

/** Throws `Refused` with a message that says what is wrong. */
export function read(address: string): Laboratory {
  const text = address.replace(/^#/, "");
  if (text.length > LONGEST) throw new Refused(`the address is too long: ${text.length} characters, at most ${LONGEST}`);
  const query = new URLSearchParams(text);
  for (const name of query.keys()) {
    if (!NAMES.includes(name)) throw new Refused(`the address has an unknown part "${shortened(name)}"`);
    if (query.getAll(name).length > 1) throw new Refused(`the address has "${name}" twice`);
  }
  const version = query.get("v");
  if (version !== VERSION) {
    throw new Refused(`the address has version ${shortened(version ?? "none")}; this page reads version ${VERSION}`);
  }
  try {
    return laboratory(query);
  } catch (error) {
    if (error instanceof NotANumber) throw new Refused(error.message);
    throw error;
  }
}

function laboratory(query: URLSearchParams): Laboratory {
  const key = query.get("preset");
  const from = begun(key === null ? "twisted-kovalevskaya" : shortened(key));
  const top = query.has("top") ? numbers(query, "top", parameters) : from.parameters;
  top.forEach((value, index) => checkParameter(index, value));
  const start = query.has("start") ? numbers(query, "start", components) : from.start;
  const moved = query.has("top") || query.has("start");
  const [surface, direction] = list(query, "section", 2) ?? [from.surface, String(from.direction)];
  if (!["-1", "0", "1"].includes(direction)) throw new Refused("the direction of a section is -1, 0 or 1");
  const [across, up] = list(query, "axes", 2) ?? from.axes;
  return {
    preset: moved ? null : from.preset,
    parameters: top,
    start,
    surface: component(surface),
    direction: Number(direction) as Direction,
    axes: [component(across), component(up)],
    method: query.has("method") ? method(query.get("method") ?? "") : from.method,
    view: {
      frame: oneOf(query, "frame", FRAMES) ?? from.view.frame,
      shadow: (oneOf(query, "shadow", ["0", "1"] as const) ?? "1") === "1",
    },
    theme: oneOf(query, "theme", THEMES) ?? from.theme,
    time: within(query, "t", 0, HORIZON) ?? 0,
    speed: within(query, "speed", SLOWEST, FASTEST) ?? 1,
    playing: true,
  };
}

function method(text: string): Method {
  const [kind, ...rest] = text.split(",");
  if (kind === "taylor" && rest.length === 1) return checkedMethod({ kind, tol: exact(rest[0]) });
  throw new Refused(`a method is "taylor,TOLERANCE"; got "${shortened(text)}"`);
}

function numbers(query: URLSearchParams, name: string, of: readonly string[]): Exact[] {
  const texts = list(query, name, of.length) ?? [];
  return texts.map((text, index) => {
    try {
      return exact(text);
    } catch (error) {
      throw new Refused(`${of[index]}: ${(error as Error).message}`);
    }
  });
}

function list(query: URLSearchParams, name: string, length: number): string[] | null {
  const text = query.get(name);
  if (text === null) return null;
  const parts = text.split(",");
  if (parts.length !== length) throw new Refused(`"${name}" must be ${length} values; got ${parts.length}`);
  return parts;
}

function within(query: URLSearchParams, name: string, least: number, most: number): number | null {
  const text = query.get(name);
  if (text === null) return null;
  const { value } = exact(text);
  if (!(value >= least && value <= most)) throw new Refused(`"${name}" lies between ${least} and ${most}; got ${shortened(text)}`);
  return value;
}

function oneOf<T extends string>(query: URLSearchParams, name: string, choices: readonly T[]): T | null {
  const text = query.get(name);
  if (text === null) return null;
  const found = choices.find((choice) => choice === text);
  if (!found) throw new Refused(`"${name}" is one of ${choices.join(", ")}; got "${shortened(text)}"`);
  return found;
}

function shortened(text: string): string {
  return text.length > 40 ? `${text.slice(0, 40)}…` : text;
}
