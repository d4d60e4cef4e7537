import { readFileSync } from "node:fs";
import { beforeAll, describe, expect, test } from "vitest";
import { Core } from "../src/core/core.js";
import { padded, ticks } from "../src/panels/plot";
import { exact } from "../src/state/exact";
import { Extent, trace, within, type Turn } from "../src/state/turn";
import { plain } from "../src/symbols";
import { described, type Saved, type SystemDescription } from "../src/systems/description";
import { comparison } from "../src/systems/comparison";
import { begun, changed, viewsOf } from "../src/systems/state";
import { aboutEnergy, aboutSurface, counted, isStroboscopic } from "../src/systems/time";
import { Computation } from "../src/worker/computation";
import type { SystemJob, Update } from "../src/worker/messages";

const TURN: Turn = [-Math.PI, Math.PI];
const PERIOD = (2 * Math.PI) / 3;

/** theta' = p, p' = 0, t' = 1, p_t' = 0: a rotor that is driven by nothing, so that all crossings are known. */
const rotor: SystemDescription = {
  version: 2,
  id: "0123456789ab",
  name: "rotor",
  words: "",
  components: ["theta", "p_theta", "t", "p_t"],
  vector_length: 4,
  turns: [TURN, null, [0, PERIOD], null],
  clock: 2,
  field: { kind: "quadratic", n_components: 4, constant: [[2, 1]], linear: [[0, 1, 1]], quadratic: [] } as never,
  invariants: null,
  surfaces: [
    { name: "theta", functions: { n_components: 4, instructions: [["sin", [0], []], ["cos", [0], []]], outputs: [4], guard: 5 }, modulus: "2π" },
    { name: "p_theta", functions: { n_components: 4, instructions: [], outputs: [1] }, modulus: null },
    { name: "t", functions: { n_components: 4, instructions: [["linear", [2], [3, 0]], ["sin", [4], []], ["cos", [4], []]], outputs: [5], guard: 6 }, modulus: "2π/3" },
    { name: "p_t", functions: { n_components: 4, instructions: [], outputs: [3] }, modulus: null },
  ],
  start: ["1", "2", "0", "0"],
  unit: 1,
  surface: 2,
  direction: 1,
  axes: [0, 1],
  picture: null,
  saved: null,
};
/** Its time has no period. */
const endless: SystemDescription = { ...rotor, turns: [TURN, null, null, null] };

let core: Core;
beforeAll(async () => {
  core = await Core.start(readFileSync(new URL("../../python/liepoisson/laboratory/page/core.wasm", import.meta.url)));
});

function updates(system: SystemDescription, more: Partial<SystemJob>): Update[] {
  const computation = new Computation(core, { system, start: [1, 2, 0, 0], surface: 0, direction: 1, tol: 1e-15, horizon: 50, saved: null, ...more });
  computation.until(50);
  const found: Update[] = [];
  for (let update = computation.advance(); update; update = computation.advance()) found.push(update);
  computation.free();
  return found;
}

const crossings = (surface: number, direction: -1 | 0 | 1, start: readonly number[]) =>
  updates(rotor, { surface, direction, start }).flatMap((one) => (one.say === "crossings" ? [...one.times] : []));

/** The pendulum, theta' = p, p' = -sin theta, with its energy. */
const pendulum: SystemDescription = {
  ...rotor,
  components: rotor.components.slice(0, 2),
  turns: [TURN, null],
  clock: null,
  field: { kind: "tape", n_components: 2, instructions: [["sin", [0], []], ["linear", [2], [-1, 0]]], outputs: [1, 3] } as never,
  invariants: { names: ["H"], functions: { n_components: 2, instructions: [["product", [1, 1], []], ["cos", [0], []], ["linear", [2, 3], [0.5, -1, 0]]], outputs: [4] } },
  surfaces: [{ name: "theta", functions: { n_components: 2, instructions: [["sin", [0], []], ["cos", [0], []]], outputs: [2], guard: 3 }, modulus: "2π" }],
  start: ["0", "3"],
};

describe("a section modulo a turn", () => {
  test("has each crossing once, in the direction of the angle", () => {
    // theta = 1 + 2 t and theta = 1 - 2 t at multiples of 2 pi
    const [first, step] = [(2 * Math.PI - 1) / 2, Math.PI];
    for (const [p, direction, from] of [[2, 1, first], [2, 0, first], [-2, -1, 0.5]] as const) {
      const times = crossings(0, direction, [1, p, 0, 0]);
      expect(times.length).toBe(Math.floor((50 - from) / step) + 1);
      times.forEach((time, k) => expect(Math.abs(time - from - step * k)).toBeLessThan(1e-12));
    }
    expect(crossings(0, -1, [1, 2, 0, 0])).toEqual([]);
  });
  test("of time is once in each period", () => {
    const times = crossings(2, 1, [1, 2, 0, 0]);
    expect(times.length).toBe(Math.floor(50 / PERIOD));
    times.forEach((time, k) => expect(Math.abs(time - (k + 1) * PERIOD)).toBeLessThan(1e-12));
  });
  test("that was saved is computed again", () => {
    const times = [1, 2, 3].map((k) => k * PERIOD);
    const saved: Saved = {
      kind: "section", words: "Saved", shown_only: null, tol: 1e-15, starts: [[1, 2, 0, 0]], times, states: times.map((t) => [1 + 2 * t, 2, t, 0]),
      trajectory: [0, 0, 0], functions: rotor.surfaces[2].functions, direction: 1, n_crossings: 3, t_end: 50, has_states: true, coordinates: rotor.components,
    };
    const found = comparison(core, rotor, saved)!;
    expect([found.words, found.largest < 1e-13]).toEqual(["both find 3 crossings", true]);
  });
});

describe("an angle", () => {
  test("goes on growing, without a gap, also from a start beyond a turn", () => {
    const found = updates(rotor, { start: [101, 2, 0, 0] });
    for (const one of found) {
      if (one.say === "motion") one.times.forEach((time, k) => expect(Math.abs(one.states[4 * k] - 101 - 2 * time)).toBeLessThan(1e-12));
      if (one.say === "crossings") one.times.forEach((time, k) => expect(Math.abs(one.states[4 * k] - 101 - 2 * time)).toBeLessThan(1e-12));
    }
    expect(found.filter((one) => one.say === "motion").length).toBeGreaterThan(2);
  });
  test("that has gone round thousands of times takes little from the exactness of the energy", () => {
    const most = (found: Update[]) => Math.max(...found.flatMap((one) => (one.say === "drift" ? [...one.differences] : [])).map(Math.abs));
    const found = updates(pendulum, { start: [0, 3], horizon: 1e4 });
    const turns = found.flatMap((one) => (one.say === "crossings" ? [...one.times] : [])).length;
    expect(turns).toBe(Math.floor(1e4 / 2.412890)); // the period of docs/angles-and-forcing.md
    // measured 7e-12 and 1e-8
    expect(100 * most(found)).toBeLessThan(most(updates({ ...pendulum, turns: [null, null] }, { start: [0, 3], horizon: 1e4 })));
  });
});

describe("a turn", () => {
  test("has every value that differs by whole turns, and the value itself where it is within", () => {
    expect([within(1, TURN), within(-Math.PI, TURN), within(Math.PI, TURN), within(70, null)]).toEqual([1, -Math.PI, Math.PI, 70]);
    for (const turns of [-3, -1, 2, 1000]) expect(Math.abs(within(1 + 2 * Math.PI * turns, TURN) - 1)).toBeLessThan(1e-12);
  });
  test("begins where rounding cannot tell its end from its beginning", () => {
    for (let k = 2; k < 500; k++) expect(within(k * PERIOD * (1 - Number.EPSILON), [0, PERIOD])).toBe(0);
    expect(within(100 * PERIOD - 1e-9, [0, PERIOD])).toBeGreaterThan(PERIOD - 2e-9);
  });
  test("breaks a line at its end, and the line goes on at its beginning", () => {
    const drawn: [string, readonly number[]][] = [];
    trace([3, 0, 4, 1, 5, 2], [TURN, null], (to) => drawn.push(["move", to]), (to) => drawn.push(["line", to]));
    const part = Math.PI - 3;
    expect(drawn.map(([what]) => what)).toEqual(["move", "line", "move", "line", "line"]);
    const wanted = [[3, 0], [Math.PI, part], [-Math.PI, part], [4 - 2 * Math.PI, 1], [5 - 2 * Math.PI, 2]];
    drawn.forEach(([, to], k) => to.forEach((value, i) => expect(value).toBeCloseTo(wanted[k][i], 12)));
  });
  test("is broken backwards, and twice where two coordinates end between two points", () => {
    const drawn: (readonly number[])[] = [];
    trace([-3, 3, -3.4, 3.2], [TURN, TURN], (to) => drawn.push(to), (to) => drawn.push(to));
    const [first, second] = [(Math.PI - 3) / 0.4, (Math.PI - 3) / 0.2];
    const wanted = [
      [-3, 3], [-Math.PI, 3 + 0.2 * first], [Math.PI, 3 + 0.2 * first],
      [-3 - 0.4 * second + 2 * Math.PI, Math.PI], [-3 - 0.4 * second + 2 * Math.PI, -Math.PI], [-3.4 + 2 * Math.PI, 3.2 - 2 * Math.PI],
    ];
    expect(drawn.length).toBe(wanted.length);
    drawn.forEach((to, k) => to.forEach((value, i) => expect(value).toBeCloseTo(wanted[k][i], 12)));
  });
  test("is the range of what has gone round, and of no other", () => {
    const [still, round] = [new Extent(), new Extent()];
    for (let k = 0; k <= 100; k++) [still.add(Math.sin(k), TURN), round.add(k / 10, TURN)];
    expect(round.range).toEqual(TURN);
    expect(Math.abs(still.range![1])).toBeLessThanOrEqual(1);
    expect(padded(round.range!, TURN)).toEqual(TURN);
  });
  test("has the marks of an angle, of a libration those of numbers", () => {
    expect(ticks({ range: TURN, name: "theta", turn: TURN }, 8).map(({ text }) => text)).toEqual(["−π", "−π/2", "0", "π/2", "π"]);
    expect(ticks({ range: [-0.1, 0.1], name: "theta", turn: TURN }, 4).map(({ text }) => text)).toContain("0.05");
    expect(ticks({ range: [0, PERIOD], name: "t", turn: [0, PERIOD] }, 3).map(({ text }) => text)).toEqual(["0", "1", "2"]);
  });
});

describe("a start at a crossing", () => {
  test("is the same point of the circles, within a turn", () => {
    const state = ["101", "2", String(100 * PERIOD), "-3"].map(exact);
    const next = changed(rotor, begun(rotor), { do: "start at", state });
    expect(next.start.map(({ value }) => value)).toEqual([101 - 32 * Math.PI, 2, 0, -3].map((value) => expect.closeTo(value, 12)));
    expect(changed(endless, begun(endless), { do: "start at", state }).start[2].text).toBe(state[2].text);
  });
});

describe("time", () => {
  test("is a coordinate of the projection where it repeats itself", () => {
    expect([begun(rotor).space, begun(rotor).series]).toEqual([[0, 1, 2], [0, 1]]);
    expect(begun(endless).space).toEqual([0, 1, null]);
  });
  test("is no part of a vector", () => {
    const components = ["l1", "l2", "l3", "t", "p_t"];
    const top = { ...rotor, components, vector_length: 3, turns: [null, null, null, [0, PERIOD] as const, null], clock: 3 };
    expect(viewsOf(top)).toEqual(["vectors", "projection", "series"]);
    expect(viewsOf({ ...top, turns: [TURN, ...top.turns.slice(1)] })).toEqual(["projection", "series"]);
  });
  test("without a period makes no section, and that is said", () => {
    expect([isStroboscopic(rotor, 2), isStroboscopic(rotor, 0), isStroboscopic(endless, 2)]).toEqual([true, false, false]);
    expect(aboutSurface(endless, 2)).toMatch(/no period.*one moment/);
    expect([aboutSurface(rotor, 2), aboutSurface(endless, 0)]).toEqual([null, null]);
    expect([counted(rotor), counted(endless)]).toEqual(["2 components, driven with the period 2π/3", "2 components, driven"]);
  });
  test("takes the energy from the invariants, and that is said", () => {
    expect(aboutEnergy(rotor)).toMatch(/not conserved/);
    expect(aboutEnergy({ ...rotor, clock: null })).toBe(null);
  });
  test("is read with its turns", () => expect(described(JSON.stringify(rotor))).toEqual(rotor));
});

test("a momentum is written below the line, also within words", () => {
  expect(["p_theta", "p_t", "H + p_t", "rate of p_x1", "l3"].map(plain)).toEqual(["p_θ", "p_t", "H + p_t", "rate of p_x1", "ℓ₃"]);
});
