/** What charts need of a state, whatever moves. */

import { HORIZON, type Direction } from "./laboratory";

export interface Charted {
  /** Names of components, and of the surface. */
  readonly axes: readonly [string, string];
  readonly surface: string;
  readonly direction: Direction;
  readonly time: number;
}

/** The time in which something moves, and how far it is followed. */
export interface Clock {
  readonly unit: number;
  readonly horizon: number;
}

export const OF_TOPS: Clock = { unit: 1, horizon: HORIZON };

/** So many units, as a short text. */
export function inUnits(count: number, clock: Clock): string {
  return String(Number((count * clock.unit).toPrecision(3)));
}
