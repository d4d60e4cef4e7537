/**
 * The laboratory in the address, after the `#`: version 1.  Numbers are written as the user wrote them, so that the same
 * orbit comes back bit for bit.  An address is data: it is read by these rules, shown as text, and never run.
 */

import { components, parameters } from "../data/tops";
import { checkedFan, checkedOrbits, FASTEST, Refused, SLOWEST, THEMES, type Direction } from "./everyday";
import { exact } from "./exact";
import { begun, checkedMethod, checkParameter, component, FRAMES, HORIZON, type Laboratory, type Method } from "./laboratory";
import { exacts, list, number, oneOf, points, queryOf, shortened, textOf, withNumbers } from "./query";

const VERSION = "1";
const LONGEST = 4000;
const NAMES = ["v", "preset", "top", "start", "section", "axes", "method", "frame", "shadow", "fan", "orbits", "theme", "t", "speed"];

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
  if (lab.fan) query.set("fan", String(lab.fan));
  if (lab.added.length) query.set("orbits", lab.added.flat().join(","));
  query.set("theme", lab.theme);
  query.set("t", String(lab.time));
  query.set("speed", String(lab.speed));
  return textOf(query);
}

/** Throws `Refused` with a message that says what is wrong. */
export function read(address: string): Laboratory {
  const query = queryOf(address, { version: VERSION, names: NAMES, longest: LONGEST });
  return withNumbers(() => laboratory(query));
}

function laboratory(query: URLSearchParams): Laboratory {
  const key = query.get("preset");
  const from = begun(key === null ? "twisted-kovalevskaya" : shortened(key));
  const top = query.has("top") ? exacts(query, "top", parameters) : from.parameters;
  top.forEach((value, index) => checkParameter(index, value));
  const start = query.has("start") ? exacts(query, "start", components) : from.start;
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
    fan: checkedFan(number(query, "fan", 0, Infinity) ?? from.fan),
    added: checkedOrbits(points(query, "orbits")),
    theme: oneOf(query, "theme", THEMES) ?? from.theme,
    time: number(query, "t", 0, HORIZON) ?? 0,
    speed: number(query, "speed", SLOWEST, FASTEST) ?? 1,
    playing: true,
  };
}

function method(text: string): Method {
  const [kind, ...rest] = text.split(",");
  if (kind === "taylor" && rest.length === 1) return checkedMethod({ kind, tol: exact(rest[0]) });
  throw new Refused(`a method is "taylor,TOLERANCE"; got "${shortened(text)}"`);
}
