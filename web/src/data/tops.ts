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
  readonly components: readonly string[];
  readonly parameters: readonly string[];
  readonly attitude: readonly string[];
  readonly moving: OtherDescription;
  readonly families: readonly Family[];
  readonly presets: readonly Preset[];
}

const tops = written as unknown as Tops;
if (tops.version !== 1) throw new Error(`the description of tops has version ${tops.version}; wanted 1`);

export const { components, parameters, attitude, moving, families, presets } = tops;

export const N = components.length;
export const N_PARAMETERS = parameters.length;
export const N_ATTITUDE = attitude.length;

export function presetOf(key: string | null): Preset | null {
  return presets.find((preset) => preset.key === key) ?? null;
}
