/** The state of the page of a system: one value, never changed in place, from which everything that is seen follows. */

import { exact, shortest, type Exact } from "../state/exact";
import { checkedFan, everyday, FANS, Refused, type Direction, type Everyday, type EverydayAction } from "../state/everyday";
import { inUnits, type Clock } from "../state/charted";
import { within as withinTurn, type Turn } from "../state/turn";
import { withoutFan } from "../fan/computation";
import { surfaceNames, withoutTime, type SystemDescription } from "./description";

export const VIEWS = ["vectors", "picture", "projection", "series"] as const;
export type View = (typeof VIEWS)[number];

export interface SystemState extends Everyday {
  readonly surface: number;
  readonly direction: Direction;
  /** Components of section and portrait. */
  readonly axes: readonly [number, number];
  readonly view: View;
  /** Components of the projection; the third is null in the plane. */
  readonly space: readonly [number, number, number | null];
  /** Components drawn over time, in order. */
  readonly series: readonly number[];
  readonly tol: Exact;
}

export type SystemAction =
  | EverydayAction
  | { readonly do: "start"; readonly index: number; readonly to: Exact }
  | { readonly do: "surface"; readonly surface: number; readonly direction: Direction }
  | { readonly do: "axes"; readonly axes: readonly [number, number] }
  | { readonly do: "view"; readonly view: View }
  | { readonly do: "space"; readonly space: readonly [number, number, number | null] }
  | { readonly do: "series"; readonly component: number; readonly shown: boolean }
  | { readonly do: "tol"; readonly tol: Exact };

/** Curves that can be told apart. */
export const MOST_SERIES = 8;
/** How far the page computes, in units of time. */
const UNITS = 1e4;

export function clockOf({ unit }: SystemDescription): Clock {
  return { unit, horizon: UNITS * unit };
}

/** The views that a system has. */
export function viewsOf(system: SystemDescription): readonly View[] {
  const { components, vector_length, turns, picture } = system;
  const [n, own] = [components.length, withoutTime(system).length];
  const has: Record<View, boolean> = {
    vectors: vector_length === 3 && own % 3 === 0 && own <= 27 && !turns.some((turn, k) => turn && k < own),
    picture: picture !== null,
    projection: n > 1,
    series: true,
  };
  return VIEWS.filter((view) => has[view]);
}

/** The state in which the page begins. */
export function begun(system: SystemDescription): SystemState {
  const { clock, turns } = system;
  const own = withoutTime(system).map((_, k) => k);
  // time goes on and on, unless it is a point of a circle
  const others = clock === null || !turns[clock] ? own : [...own, clock];
  return {
    start: system.start.map(exact),
    surface: system.surface,
    direction: system.direction,
    axes: system.axes,
    view: viewsOf(system)[0],
    space: [0, others[1] ?? 0, others[2] ?? null],
    series: own.slice(0, 4),
    fan: withoutFan(system) === null ? FANS[1] : 0,
    added: [],
    tol: exact("1e-15"),
    theme: "auto",
    time: 0,
    speed: 1,
    playing: true,
  };
}

/** What follows a change.  Another start begins the time again. */
export function changed(system: SystemDescription, state: SystemState, action: SystemAction): SystemState {
  switch (action.do) {
    case "start":
      return { ...state, start: state.start.with(action.index, action.to), time: 0 };
    case "start at":
      return { ...state, start: action.state.map((one, k) => inTurn(one, system.turns[k])), time: 0 };
    case "surface":
      return { ...state, surface: within(action.surface, surfaceNames(system).length, "a surface"), direction: action.direction, added: [] };
    case "axes":
      return { ...state, axes: [component(system, action.axes[0]), component(system, action.axes[1])], added: [] };
    case "view":
      if (!viewsOf(system).includes(action.view)) throw new Refused(`${system.name} has no view "${action.view}"`);
      return { ...state, view: action.view };
    case "space": {
      const [x, y, z] = action.space;
      return { ...state, space: [component(system, x), component(system, y), z === null ? null : component(system, z)] };
    }
    case "series": {
      const rest = state.series.filter((one) => one !== component(system, action.component));
      if (action.shown && rest.length >= MOST_SERIES) throw new Refused(`at most ${MOST_SERIES} components are drawn over time; take one out first`);
      return { ...state, series: action.shown ? [...rest, action.component].sort((a, b) => a - b) : rest };
    }
    case "fan":
      return { ...state, fan: fanOf(system, action.count) };
    case "tol":
      return { ...state, tol: checkedTolerance(action.tol) };
    default:
      return everyday(state, action, clockOf(system).horizon);
  }
}

/** The same point of a circle, within its turn. */
function inTurn(one: Exact, turn: Turn | null): Exact {
  const value = withinTurn(one.value, turn);
  return value === one.value ? one : shortest(value);
}

/** Whether the same orbit and crossings are computed. */
export function sameRun(one: SystemState, other: SystemState): boolean {
  return one.start === other.start && one.surface === other.surface && one.direction === other.direction && one.tol === other.tol;
}

export function component(system: SystemDescription, index: number): number {
  return within(index, system.components.length, "a component");
}

export function within(index: number, count: number, what: string): number {
  if (!Number.isInteger(index) || index < 0 || index >= count) throw new Refused(`${what} has a number from 1 to ${count}; got ${index + 1}`);
  return index;
}

/** So many orbits, or none where a system has no fan. */
export function fanOf(system: SystemDescription, count: number): number {
  const checked = checkedFan(count);
  return withoutFan(system) === null ? checked : 0;
}

export function checkedTolerance(tol: Exact): Exact {
  if (!(tol.value >= 1e-16 && tol.value <= 1e-3)) throw new Refused(`a tolerance lies between 1e-16 and 1e-3; got ${tol.text}`);
  return tol;
}

/** A time with as many decimals as its unit asks for. */
export function timeText(time: number, clock: Clock): string {
  const digits = Math.min(Math.max(2 - Math.floor(Math.log10(clock.unit) + 1e-9), 0), 9);
  return time.toFixed(digits);
}

export { inUnits };
