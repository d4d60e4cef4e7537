import { readFileSync } from "node:fs";
import { beforeAll, describe, expect, test } from "vitest";
import { Core } from "../src/core/core.js";
import { exact } from "../src/state/exact";
import { fan, withoutFan, type FanJob, type FanUpdate } from "../src/fan/computation";
import { begun, changed } from "../src/systems/state";
import { BRACKETS, draftOf } from "../src/systems/typing/draft";
import { made, type Made } from "../src/systems/typing/made";
import { read, written } from "../src/systems/url";
import { projected } from "../src/worker/projection";

let core: Core;
beforeAll(async () => {
  core = await Core.start(readFileSync(new URL("../../python/liepoisson/laboratory/page/core.wasm", import.meta.url)));
});

function example(key: string) {
  const draft = draftOf(key);
  return (made(core, { draft, listed: BRACKETS[draft.bracket] ?? null, start: null }) as Made).system;
}

function job(key: string, more: Partial<FanJob> = {}): FanJob {
  const system = example(key);
  const { start, surface, direction, axes } = begun(system);
  return { system, start: start.map(({ value }) => value), surface, direction, axes, tol: 1e-13, count: 10, added: [], ...more };
}

type Said<T extends FanUpdate["say"]> = Extract<FanUpdate, { say: T }>;

/** All that is said up to the verdicts. */
function filled(of: FanJob) {
  const updates: FanUpdate[] = [];
  for (const update of fan(core, of)) {
    updates.push(update);
    if (update.say === "nothing" || (update.say === "filled" && updates.some(({ say }) => say === "orbit"))) break;
  }
  const said = <T extends FanUpdate["say"]>(what: T) => updates.filter((one): one is Said<T> => one.say === what);
  return { orbits: said("orbit"), starts: said("starts")[0], nothing: said("nothing")[0] };
}

describe.each(["henon-heiles", "heavy-top", "twisted-kovalevskaya"])("the fan of %s", (key) => {
  test("has starts on the energy and the Casimirs, which differ, and the same ones again", () => {
    const of = job(key);
    const { orbits } = filled(of);
    expect(orbits).toHaveLength(10);
    const functions = core.functions(of.system.invariants!.functions);
    const wanted = functions.values(of.start);
    const n = of.start.length;
    for (const { crossings } of orbits) {
      functions.values(crossings.slice(0, n)).forEach((value, k) => expect(Math.abs(value - wanted[k])).toBeLessThan(1e-10 * Math.max(1, Math.abs(wanted[k]))));
      expect(Math.abs(crossings[of.surface])).toBeLessThan(1e-10);
    }
    expect(new Set(orbits.map(({ crossings }) => String(crossings.slice(0, n)))).size).toBe(10);
    expect(filled(of).orbits.map(({ crossings }) => [...crossings])).toEqual(orbits.map(({ crossings }) => [...crossings]));
    functions.free();
  });
});

test.each([["henon-heiles", { H: 0.1 }], ["heavy-top", { H: 1, C1: 1.5 }]] as const)("a start of %s is moved to other values, and keeps the rest", (key, wanted) => {
  const system = example(key);
  const start = begun(system).start.map(({ value }) => value);
  const functions = core.functions(system.invariants!.functions);
  const { names } = system.invariants!;
  const before = Object.fromEntries(Array.from(functions.values(start), (value, k) => [names[k], value]));
  const all: Record<string, number> = { ...before, ...wanted };
  const { state, residuals } = projected(core, { system, start, surface: 0, direction: 1, tol: 1e-13, horizon: 100, saved: null }, all);
  expect(Object.keys(residuals)).toEqual(names);
  functions.values(state).forEach((value, k) => expect(Math.abs(value - all[names[k]])).toBeLessThan(1e-13));
  expect(Object.values(wanted)).not.toContain(before.H);
  functions.free();
});

test("a name that was a parameter, and is that of a coordinate by now, is no parameter", () => {
  const draft = { ...draftOf("henon-heiles"), coordinates: "q", momenta: "p", hamiltonian: "p^2/2 - g*cos(q)", parameters: { p: "1", g: "2" }, start: [] };
  const found = made(core, { draft, listed: null, start: null });
  expect(found).toMatchObject({ made: true, parameters: { g: "2" } });
  expect((found as Made).parameters).not.toHaveProperty("p");
});

test("an orbit goes through a point that is added; one that no orbit reaches is said", () => {
  const of = job("henon-heiles", { added: [[0.1, 0.2], [-0.9, 0]] });
  const { orbits, starts } = filled(of);
  expect(starts.missed).toEqual([1]);
  const { crossings, added } = orbits.at(-1)!;
  expect(added).toBe(0);
  expect([...crossings.slice(0, 4)]).toEqual([expect.closeTo(0, 12), expect.closeTo(0.1, 12), expect.any(Number), expect.closeTo(0.2, 12)]);
  // rising: x' = p_x > 0
  expect(crossings[2]).toBeGreaterThan(0);
  const h = (x: number, y: number, px: number, py: number) => (px ** 2 + py ** 2 + x ** 2 + y ** 2) / 2 + x ** 2 * y - y ** 3 / 3;
  const [x, y, px, py] = of.start;
  expect(h(crossings[0], crossings[1], crossings[2], crossings[3])).toBeCloseTo(h(x, y, px, py), 12);
});

test("where no orbit crosses the surface, that is said", () => {
  // the energy of the equilibrium, at which there is but one state
  const { nothing, orbits } = filled(job("henon-heiles", { start: [0, 0, 0, 0] }));
  expect(orbits).toHaveLength(0);
  expect(nothing.why).toMatch(/No orbit|runs away/);
});

test("a system in which an orbit is an energy surface on a leaf has no fan", () => {
  expect(withoutFan(example("free-rigid-body"))).toMatch(/one orbit/);
  expect(withoutFan(example("henon-heiles"))).toBeNull();
  expect(begun(example("free-rigid-body")).fan).toBe(0);
});

test("the address has the fan and the points, and other axes have other points", () => {
  const system = { ...example("henon-heiles"), id: "1" };
  const state = changed(system, changed(system, begun(system), { do: "fan", count: 40 }), { do: "orbits", added: [[0.1, -0.25]] });
  const again = read(system, written(system, state));
  expect([again.fan, again.added]).toEqual([40, [[0.1, -0.25]]]);
  expect(changed(system, state, { do: "axes", axes: [1, 2] }).added).toEqual([]);
  expect(() => read(system, "v=1&system=1&fan=7")).toThrow(/10 to 40/);
  expect(() => read(system, "v=1&system=1&orbits=1,2,3")).toThrow(/pairs/);
  expect(exact("0.1").value).toBe(0.1);
});
