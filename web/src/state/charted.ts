/** What charts need of a state, whatever moves. */

import { components } from "../data/tops";
import type { Direction } from "./everyday";
import { HORIZON } from "./laboratory";
import type { Turn } from "./turn";

export interface Charted {
  /** Names of components, and of the surface. */
  readonly axes: readonly [string, string];
  readonly surface: string;
  /** The number modulo which the surface is given, as text. */
  readonly modulus?: string | null;
  /** Why its section says little. */
  readonly remark?: string | null;
  readonly direction: Direction;
  readonly time: number;
}

/** The time in which something moves, and how far it is followed. */
export interface Clock {
  readonly unit: number;
  readonly horizon: number;
}

export const OF_TOPS: Clock = { unit: 1, horizon: HORIZON };

/** The components of a state, and the turns of those that are points of circles. */
export interface Coordinates {
  readonly components: readonly string[];
  readonly turns: readonly (Turn | null)[];
}

export const COORDINATES_OF_TOPS: Coordinates = { components, turns: components.map(() => null) };

/** So many units, as a short text. */
export function inUnits(count: number, clock: Clock): string {
  return String(Number((count * clock.unit).toPrecision(3)));
}
