import { readFileSync } from "node:fs";
import { beforeAll, expect, test } from "vitest";
import { Core } from "../src/core/core.js";
import { components, presets, WIDTH } from "../src/data/tops";
import { exact } from "../src/state/exact";
import { Computation } from "../src/worker/computation";
import type { Job, Update } from "../src/worker/messages";
import { projected } from "../src/worker/projection";

let core: Core;
beforeAll(async () => {
  core = await Core.start(readFileSync(new URL("../../python/liepoisson/laboratory/page/core.wasm", import.meta.url)));
});

function job(key: string, more: Partial<Job> = {}): Job {
  const preset = presets.find((one) => one.key === key)!;
  return {
    parameters: preset.parameters.map((text) => exact(text).value),
    start: preset.start.map((text) => exact(text).value),
    attitude: [1, 0, 0, 0],
    surface: components.indexOf(preset.surface),
    direction: 1,
    tol: 1e-15,
    horizon: 100,
    ...more,
  };
}

function all(of: Job): Update[] {
  const computation = new Computation(core, of);
  computation.until(of.horizon);
  const updates: Update[] = [];
  for (let update = computation.advance(); update; update = computation.advance()) updates.push(update);
  computation.free();
  return updates;
}

type Said<T extends Update["say"]> = Extract<Update, { say: T }>;
const said = <T extends Update["say"]>(updates: Update[], what: T) => updates.filter((one): one is Said<T> => one.say === what);

test.each(presets.map((preset) => preset.key))("%s: everything is computed, and the invariants stay", (key) => {
  const updates = all(job(key));
  expect(updates.at(-1)).toEqual({ say: "finished" });
  expect(said(updates, "ended")).toEqual([]);
  const drift = said(updates, "drift").flatMap((one) => [...one.differences]);
  expect(drift.length).toBeGreaterThan(10);
  expect(Math.max(...drift.map(Math.abs))).toBeLessThan(1e-11);
  for (const { states } of said(updates, "crossings")) {
    for (let k = components.indexOf(presets.find((one) => one.key === key)!.surface); k < states.length; k += 9) {
      expect(Math.abs(states[k])).toBeLessThan(1e-13);
    }
  }
});

test("the drawn motion follows the orbit, and the quaternion keeps its length", () => {
  const updates = all(job("twisted-kovalevskaya"));
  const crossing = said(updates, "crossings").filter((one) => one.times.length > 0).at(-1)!;
  const motion = said(updates, "motion").filter((one) => !one.shadow);
  const chunk = motion.find((one) => one.times[0] <= crossing.times[0] && crossing.times[0] <= one.times.at(-1)!)!;
  const near = chunk.times.findIndex((time) => time >= crossing.times[0]);
  for (let k = 0; k < 9; k++) expect(Math.abs(chunk.states[near * WIDTH + k] - crossing.states[k])).toBeLessThan(0.1);
  const last = motion.at(-1)!.states.slice(-WIDTH).slice(9, 13);
  expect(Math.abs(Math.hypot(...last) - 1)).toBeLessThan(1e-12);
});

test("in space the second field stands still, for a twisted top, too", () => {
  const turned = (state: Float64Array) => {
    const [b, [w, x, y, z]] = [state.subarray(6, 9), state.subarray(9, 13)];
    const t = [2 * (y * b[2] - z * b[1]), 2 * (z * b[0] - x * b[2]), 2 * (x * b[1] - y * b[0])];
    return [b[0] + w * t[0] + y * t[2] - z * t[1], b[1] + w * t[1] + z * t[0] - x * t[2], b[2] + w * t[2] + x * t[1] - y * t[0]];
  };
  const motion = said(all(job("twisted-kovalevskaya")), "motion").filter((one) => !one.shadow);
  const start = turned(motion[0].states.subarray(0, 13));
  const end = turned(motion.at(-1)!.states.subarray(-WIDTH));
  end.forEach((value, k) => expect(Math.abs(value - start[k])).toBeLessThan(1e-11));
});

test("families have their invariants", () => {
  const names = (key: string) => said(all(job(key, { horizon: 1 })), "invariants")[0].names;
  expect(names("lagrange")).toEqual(["H", "C1", "C2", "C3", "l.alpha", "l3"]);
  expect(names("kovalevskaya")).toEqual(["H", "C1", "C2", "C3", "l.alpha", "K"]);
  expect(names("twisted-kovalevskaya")).toEqual(["H", "C1", "C2", "C3"]);
  expect(names("two-field")).toEqual(["H", "C1", "C2", "C3", "K", "G"]);
});

test("the exponent of a chaotic orbit is positive, and lies in the band of its ensemble", () => {
  const updates = all(job("twisted-kovalevskaya", { horizon: 4000 }));
  const { values: [low, , high] } = said(updates, "band").at(-1)!;
  const [exponent] = said(updates, "exponent").at(-1)!.values;
  expect(low).toBeGreaterThan(0.05);
  expect(exponent).toBeGreaterThan(low / 2);
  expect(exponent).toBeLessThan(2 * high);
});

test("a looser tolerance drifts more", () => {
  const worst = (tol: number) => Math.max(...said(all(job("kovalevskaya", { tol })), "drift").flatMap((one) => [...one.differences].map(Math.abs)));
  expect(worst(1e-6)).toBeGreaterThan(100 * worst(1e-15));
});

test("a top that the core cannot have is refused", () => {
  expect(() => new Computation(core, job("lagrange", { parameters: Array(10).fill(0) }))).toThrow();
});

test.each(presets.map((preset) => preset.key))("%s: a start is moved to another energy and another Casimir", (key) => {
  const of = job(key);
  const { values, names } = said(all({ ...of, horizon: 1 }), "invariants")[0];
  const wanted = Object.fromEntries(["H", "C1", "C2", "C3"].map((name) => [name, values[names.indexOf(name)]]));
  wanted.H += 0.05;
  wanted.C3 *= 1.1;
  const { state, residuals } = projected(core, of, wanted);
  expect(Math.max(...Object.values(residuals).map(Math.abs))).toBeLessThan(1e-13);
  const there = said(all({ ...of, start: [...state], horizon: 1 }), "invariants")[0];
  for (const [name, value] of Object.entries(wanted)) expect(Math.abs(there.values[there.names.indexOf(name)] - value)).toBeLessThan(1e-13);
});

test("values that exclude one another leave a residual", () => {
  expect(Math.abs(projected(core, job("lagrange"), { H: 0, C1: 1, C2: 0, C3: -1 }).residuals.C3)).toBeGreaterThan(1e-3);
});

test("the ellipsoid and the sphere go through the angular momentum", () => {
  const { states, ellipsoid } = said(all(job("charged", { horizon: 10 })), "motion").filter((one) => !one.shadow).at(-1)!;
  for (let k = 0; k < states.length / WIDTH; k++) {
    const squares = ellipsoid.subarray(4 * k, 4 * k + 4);
    const momenta = [...states.subarray(WIDTH * k, WIDTH * k + 3)].map((one) => one * one);
    expect(Math.abs(momenta.reduce((sum, one, i) => sum + one / squares[i], 0) - 1)).toBeLessThan(1e-13);
    expect(Math.abs(momenta[0] + momenta[1] + momenta[2] - squares[3])).toBeLessThan(1e-13);
  }
});
