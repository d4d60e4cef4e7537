/**
 * The state in the address, after the `#`: version 1, and the short hash of the description, so that an address of another
 * system is refused.  Components and surfaces have their numbers, from 1 on, since names may hold any character.
 */

import { exact, NotANumber } from "../state/exact";
import { FASTEST, Refused, SLOWEST, THEMES, type Direction } from "../state/laboratory";
import { surfaceNames, type SystemDescription } from "./description";
import { begun, checkedFan, checkedOrbits, checkedTolerance, clockOf, component, MOST_SERIES, VIEWS, viewsOf, within, type SystemState } from "./state";

const VERSION = "1";
const LONGEST = 16_000;
const NAMES = ["v", "system", "start", "section", "axes", "view", "space", "series", "fan", "orbits", "tol", "theme", "t", "speed"];

export function written(system: SystemDescription, state: SystemState): string {
  const number = (index: number | null) => (index === null ? 0 : index + 1);
  const query = new URLSearchParams({ v: VERSION, system: system.id });
  query.set("start", state.start.map((one) => one.text).join(","));
  query.set("section", `${number(state.surface)},${state.direction}`);
  query.set("axes", state.axes.map(number).join(","));
  query.set("view", state.view);
  query.set("space", state.space.map(number).join(","));
  query.set("series", state.series.map(number).join(","));
  query.set("fan", String(state.fan));
  if (state.added.length) query.set("orbits", state.added.flat().join(","));
  query.set("tol", state.tol.text);
  query.set("theme", state.theme);
  query.set("t", String(state.time));
  query.set("speed", String(state.speed));
  return query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
}

/** Throws `Refused` with a message that says what is wrong. */
export function read(system: SystemDescription, address: string): SystemState {
  const text = address.replace(/^#/, "");
  if (text.length > LONGEST) throw new Refused(`the address is too long: ${text.length} characters, at most ${LONGEST}`);
  const query = new URLSearchParams(text);
  const version = query.get("v");
  if (version !== VERSION) throw new Refused(`the address has version ${shortened(version ?? "none")}; this page reads version ${VERSION}`);
  if (query.get("system") !== system.id) throw new Refused("the address is for another system, or for another version of this one");
  for (const name of query.keys()) {
    if (!NAMES.includes(name)) throw new Refused(`the address has an unknown part "${shortened(name)}"`);
    if (query.getAll(name).length > 1) throw new Refused(`the address has "${name}" twice`);
  }
  try {
    return state(system, query);
  } catch (error) {
    if (error instanceof NotANumber) throw new Refused(error.message);
    throw error;
  }
}

function state(system: SystemDescription, query: URLSearchParams): SystemState {
  const from = begun(system);
  const n = system.components.length;
  const { horizon } = clockOf(system);
  const [surface, direction] = list(query, "section", 2) ?? [String(from.surface + 1), String(from.direction)];
  if (!["-1", "0", "1"].includes(direction)) throw new Refused("the direction of a section is -1, 0 or 1");
  const [x, y] = list(query, "axes", 2)?.map(index) ?? from.axes;
  const space = list(query, "space", 3)?.map((text) => (text === "0" ? null : component(system, index(text)))) ?? from.space;
  if (space[0] === null || space[1] === null) throw new Refused("a projection has at least two components");
  const series = query.get("series") === "" ? [] : (query.get("series")?.split(",").map((text) => component(system, index(text))) ?? from.series);
  if (series.length > MOST_SERIES) throw new Refused(`at most ${MOST_SERIES} components are drawn over time; got ${series.length}`);
  const view = oneOf(query, "view", VIEWS) ?? from.view;
  if (!viewsOf(system).includes(view)) throw new Refused(`${shortened(system.name)} has no view "${view}"`);
  return {
    start: query.has("start") ? starts(system, list(query, "start", n) ?? []) : from.start,
    surface: within(index(surface), surfaceNames(system).length, "a surface"),
    direction: Number(direction) as Direction,
    axes: [component(system, x), component(system, y)],
    view,
    space: [space[0], space[1], space[2] ?? null],
    series: [...new Set(series)].sort((a, b) => a - b),
    fan: checkedFan(system, number(query, "fan", 0, Infinity) ?? from.fan),
    added: checkedOrbits(points(query.get("orbits"))),
    tol: query.has("tol") ? checkedTolerance(exact(query.get("tol") ?? "")) : from.tol,
    theme: oneOf(query, "theme", THEMES) ?? from.theme,
    time: number(query, "t", 0, horizon) ?? 0,
    speed: number(query, "speed", SLOWEST, FASTEST) ?? 1,
    playing: true,
  };
}

function points(text: string | null): SystemState["added"] {
  if (text === null) return [];
  const values = text.split(",").map((one) => (one.trim() === "" ? Number.NaN : Number(one)));
  if (values.length % 2 || !values.every(Number.isFinite)) throw new Refused('"orbits" must be pairs of numbers');
  return values.flatMap((value, k) => (k % 2 ? [] : [[value, values[k + 1]] as const]));
}

function starts(system: SystemDescription, texts: readonly string[]) {
  return texts.map((text, k) => {
    try {
      return exact(text);
    } catch (error) {
      throw new Refused(`${system.components[k]}: ${(error as Error).message}`);
    }
  });
}

/** A number that counts from 1, as one that counts from 0; what is none is refused where it is used. */
function index(text: string): number {
  return /^\d{1,6}$/.test(text) ? Number(text) - 1 : -1;
}

function list(query: URLSearchParams, name: string, length: number): string[] | null {
  const text = query.get(name);
  if (text === null) return null;
  const parts = text.split(",");
  if (parts.length !== length) throw new Refused(`"${name}" must be ${length} values; got ${parts.length}`);
  return parts;
}

function number(query: URLSearchParams, name: string, least: number, most: number): number | null {
  const text = query.get(name);
  if (text === null) return null;
  const value = text.trim() === "" ? Number.NaN : Number(text);
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
