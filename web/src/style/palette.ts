/** The colours of the theme, which the style sheet holds, for canvases and the scene. */

export interface Palette {
  readonly dark: boolean;
  readonly ink: string;
  readonly faint: string;
  readonly grid: string;
  readonly zero: string;
  readonly panel: string;
  readonly accent: string;
  readonly l: string;
  readonly alpha: string;
  readonly beta: string;
  readonly a: string;
  readonly b: string;
  readonly axis: string;
  readonly body: string;
  readonly body2: string;
  readonly floor: string;
}

const NAMES = ["ink", "faint", "grid", "zero", "panel", "accent", "l", "alpha", "beta", "a", "b", "axis", "body", "body2", "floor"] as const;

export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const entries = NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]);
  return { ...Object.fromEntries(entries), dark: style.getPropertyValue("--dark").trim() === "1" } as Palette;
}

/** Violet to yellow, in steps of even lightness; the light theme ends before it fades into the paper. */
const DARK = ["#7a5cd6", "#5b7fe8", "#3fa7d6", "#35c5a5", "#8fd14f", "#f4e04d"];
const LIGHT = ["#3b0f70", "#31508e", "#26788e", "#1fa187", "#62b03a", "#b5a50f"];

/** A colour for a part of the time, 0 to 1. */
export function timeColour(part: number, dark: boolean): string {
  const stops = dark ? DARK : LIGHT;
  const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(at), stops.length - 2);
  return mixed(stops[k], stops[k + 1], at - k);
}

function mixed(one: string, other: string, part: number): string {
  const channel = (hex: string, k: number) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);
  const parts = [0, 1, 2].map((k) => Math.round(channel(one, k) * (1 - part) + channel(other, k) * part));
  return `rgb(${parts.join(" ")})`;
}
