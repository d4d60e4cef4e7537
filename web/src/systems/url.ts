/**
 * The state in the address, after the `#`: version 1, and the short hash of the description, so that an address of another
 * system is refused.  Components and surfaces have their numbers, from 1 on, since names may hold any character.
 */

import { checkedOrbits, FASTEST, Refused, SLOWEST, THEMES, type Direction } from "../state/everyday";
import { exact } from "../state/exact";
import { exacts, list, number, oneOf, points, queryOf, shortened, textOf, withNumbers } from "../state/query";
import { surfaceNames, type SystemDescription } from "./description";
import { begun, checkedTolerance, clockOf, component, fanOf, MOST_SERIES, VIEWS, viewsOf, within, type SystemState } from "./state";

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
  return textOf(query);
}

/** Throws `Refused` with a message that says what is wrong. */
export function read(system: SystemDescription, address: string): SystemState {
  const query = queryOf(address, { version: VERSION, names: NAMES, longest: LONGEST });
  if (query.get("system") !== system.id) throw new Refused("the address is for another system, or for another version of this one");
  return withNumbers(() => state(system, query));
}

function state(system: SystemDescription, query: URLSearchParams): SystemState {
  const from = begun(system);
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
    start: query.has("start") ? exacts(query, "start", system.components) : from.start,
    surface: within(index(surface), surfaceNames(system).length, "a surface"),
    direction: Number(direction) as Direction,
    axes: [component(system, x), component(system, y)],
    view,
    space: [space[0], space[1], space[2] ?? null],
    series: [...new Set(series)].sort((a, b) => a - b),
    fan: fanOf(system, number(query, "fan", 0, Infinity) ?? from.fan),
    added: checkedOrbits(points(query, "orbits")),
    tol: query.has("tol") ? checkedTolerance(exact(query.get("tol") ?? "")) : from.tol,
    theme: oneOf(query, "theme", THEMES) ?? from.theme,
    time: number(query, "t", 0, horizon) ?? 0,
    speed: number(query, "speed", SLOWEST, FASTEST) ?? 1,
    playing: true,
  };
}

/** A number that counts from 1, as one that counts from 0; what is none is refused where it is used. */
function index(text: string): number {
  return /^\d{1,6}$/.test(text) ? Number(text) - 1 : -1;
}
