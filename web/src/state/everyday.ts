/** The part of a state that every page has: what is seen of time, and the orbits of the section. */

import type { Exact } from "./exact";

export const THEMES = ["auto", "light", "dark", "projector"] as const;
export type Theme = (typeof THEMES)[number];
export type Direction = -1 | 0 | 1;

export interface Everyday {
  readonly start: readonly Exact[];
  /** Orbits that fill the section; 0 where it has that of the motion alone. */
  readonly fan: number;
  /** Points of the section through which others go. */
  readonly added: readonly (readonly [number, number])[];
  readonly theme: Theme;
  readonly time: number;
  readonly speed: number;
  readonly playing: boolean;
}

export type EverydayAction =
  | { readonly do: "start at"; readonly state: readonly Exact[] }
  | { readonly do: "fan"; readonly count: number }
  | { readonly do: "orbits"; readonly added: Everyday["added"] }
  | { readonly do: "theme"; readonly theme: Theme }
  | { readonly do: "time"; readonly time: number }
  | { readonly do: "speed"; readonly speed: number }
  | { readonly do: "play"; readonly playing: boolean };

export const SLOWEST = 1 / 16;
export const FASTEST = 16;
/** Numbers of orbits that fill a section. */
export const FANS = [10, 20, 40] as const;
/** Orbits that are added by clicks. */
const MOST_ADDED = 40;

/** A state that cannot be: which part of it, and why. */
export class Refused extends Error {}

/** What follows a change that every page knows, but for another start; times lie before the horizon. */
export function everyday<State extends Everyday>(state: State, action: Exclude<EverydayAction, { do: "start at" }>, horizon: number): State {
  switch (action.do) {
    case "fan":
      return { ...state, fan: checkedFan(action.count) };
    case "orbits":
      return { ...state, added: checkedOrbits(action.added) };
    case "theme":
      return { ...state, theme: action.theme };
    case "time":
      return { ...state, time: Math.min(Math.max(action.time, 0), horizon) };
    case "speed":
      return { ...state, speed: Math.min(Math.max(action.speed, SLOWEST), FASTEST) };
    case "play":
      return { ...state, playing: action.playing };
  }
}

export function checkedFan(count: number): number {
  const [least, most] = [FANS[0], FANS[FANS.length - 1]];
  if (count !== 0 && !(Number.isInteger(count) && count >= least && count <= most)) throw new Refused(`a fan has ${least} to ${most} orbits, or 0; got ${count}`);
  return count;
}

export function checkedOrbits(added: Everyday["added"]): Everyday["added"] {
  if (added.length > MOST_ADDED) throw new Refused(`at most ${MOST_ADDED} orbits are added to a fan; remove some`);
  return added;
}
