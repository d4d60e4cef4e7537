/** What Python knows of tops: equations with open parameters, invariants, presets.  Written by `build_tops.py`. */

import type { FunctionsDescription, OtherDescription } from "../core/core.js";
import written from "./tops.json";

export interface Family {
  readonly name: string;
  readonly conditions: FunctionsDescription | null;
  readonly names: readonly string[];
  readonly functions: FunctionsDescription;
}

export interface Preset {
  readonly key: string;
  readonly title: string;
  readonly kind: string;
  readonly story: string;
  readonly parameters: readonly string[];
  readonly start: readonly string[];
  readonly surface: string;
  readonly axes: readonly string[];
}

interface Tops {
  readonly version: number;
  /** Version of liepoisson that wrote it. */
  readonly package: string;
  readonly components: readonly string[];
  readonly parameters: readonly string[];
  readonly attitude: readonly string[];
  readonly position: readonly string[];
  readonly moving: OtherDescription;
  /** Squares of the half axes of the ellipsoid of the present kinetic energy, and of the angular momentum. */
  readonly ellipsoid: FunctionsDescription;
  readonly families: readonly Family[];
  readonly presets: readonly Preset[];
}

const tops = written as unknown as Tops;
if (tops.version !== 2) throw new Error(`the description of tops has version ${tops.version}; wanted 2`);

export const { components, parameters, attitude, position, moving, ellipsoid, families, presets } = tops;
export const VERSION = tops.package;

export const N = components.length;
export const N_PARAMETERS = parameters.length;
export const N_ATTITUDE = attitude.length;
export const N_ELLIPSOID = ellipsoid.outputs.length;
/** Numbers of a row of the motion: state, attitude, position. */
export const WIDTH = N + N_ATTITUDE + position.length;
/** Where the position begins in it. */
export const POSITION = N + N_ATTITUDE;

export function presetOf(key: string | null): Preset | null {
  return presets.find((preset) => preset.key === key) ?? null;
}
