/** The state of the laboratory: one value, never changed in place, from which everything that is seen follows. */

import { components, parameters, presetOf, presets } from "../data/tops";
import { plain } from "../symbols";
import { everyday, Refused, type Direction, type Everyday, type EverydayAction } from "./everyday";
import { exact, type Exact } from "./exact";

export const FRAMES = ["space", "body", "momentum", "rod"] as const;
export type Frame = (typeof FRAMES)[number];

/** The Taylor method, by its tolerance for each step. */
export interface Method {
  readonly kind: "taylor";
  readonly tol: Exact;
}

export interface View {
  readonly frame: Frame;
  readonly shadow: boolean;
}

export interface Laboratory extends Everyday {
  readonly preset: string | null;
  readonly parameters: readonly Exact[];
  readonly surface: string;
  readonly direction: Direction;
  readonly axes: readonly [string, string];
  readonly method: Method;
  readonly view: View;
}

export type Action =
  | EverydayAction
  | { readonly do: "preset"; readonly key: string }
  | { readonly do: "parameter"; readonly index: number; readonly to: Exact }
  | { readonly do: "start"; readonly index: number; readonly to: Exact }
  | { readonly do: "surface"; readonly surface: string; readonly direction: Direction }
  | { readonly do: "axes"; readonly axes: readonly [string, string] }
  | { readonly do: "method"; readonly method: Method }
  | { readonly do: "view"; readonly view: Partial<View> };

/** How far the page computes, in time units. */
export const HORIZON = 1e4;

const TAYLOR: Method = { kind: "taylor", tol: exact("1e-15") };

/** The laboratory as a preset begins it. */
export function begun(key: string): Laboratory {
  const preset = presetOf(key);
  if (!preset) throw new Refused(`there is no preset "${key}"; known are ${presets.map((one) => one.key).join(", ")}`);
  return {
    preset: key,
    parameters: preset.parameters.map(exact),
    start: preset.start.map(exact),
    surface: preset.surface,
    direction: 1,
    axes: [preset.axes[0], preset.axes[1]],
    method: TAYLOR,
    view: { frame: "space", shadow: true },
    fan: 0,
    added: [],
    theme: "auto",
    time: 0,
    speed: 1,
    playing: true,
  };
}

/** What follows a change.  A change of the system or of its start begins the time again. */
export function changed(lab: Laboratory, action: Action): Laboratory {
  switch (action.do) {
    case "preset": {
      const { view, fan, theme, method, speed, playing } = lab;
      return { ...begun(action.key), view, fan, theme, method, speed, playing };
    }
    case "parameter":
      checkParameter(action.index, action.to);
      return { ...lab, preset: null, parameters: lab.parameters.with(action.index, action.to), time: 0 };
    case "start":
      return { ...lab, preset: null, start: lab.start.with(action.index, action.to), time: 0 };
    case "start at":
      return { ...lab, preset: null, start: [...action.state], time: 0 };
    case "surface":
      return { ...lab, surface: component(action.surface), direction: action.direction, added: [] };
    case "axes":
      return { ...lab, axes: [component(action.axes[0]), component(action.axes[1])], added: [] };
    case "method":
      return { ...lab, method: checkedMethod(action.method) };
    case "view":
      return { ...lab, view: { ...lab.view, ...action.view } };
    default:
      return everyday(lab, action, HORIZON);
  }
}

/** Whether the same orbit is computed: what is only shown differently needs no new one. */
export function sameRun(one: Laboratory, other: Laboratory): boolean {
  return (
    one.parameters === other.parameters &&
    one.start === other.start &&
    one.surface === other.surface &&
    one.direction === other.direction &&
    one.method === other.method
  );
}

export function checkParameter(index: number, to: Exact): void {
  if (index < 3 && !(to.value >= 0.01)) {
    throw new Refused(`${plain(parameters[index])} is a moment of inertia, at least 0.01; got ${to.text}`);
  }
}

export function component(name: string): string {
  if (!components.includes(name)) throw new Refused(`"${name}" is no component; known are ${components.join(", ")}`);
  return name;
}

export function checkedMethod(method: Method): Method {
  if (!(method.tol.value >= 1e-16 && method.tol.value <= 1e-3)) {
    throw new Refused(`a tolerance lies between 1e-16 and 1e-3; got ${method.tol.text}`);
  }
  return method;
}
