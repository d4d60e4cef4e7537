import { readFileSync } from "node:fs";
import { beforeAll, describe, expect, test } from "vitest";
import { Core } from "../src/core/core.js";
import { exact, shortest } from "../src/state/exact";
import { Refused } from "../src/state/everyday";
import { compared, comparison, inWords } from "../src/systems/comparison";
import { described, Malformed, MOST_COMPONENTS, surfaceNames, type Saved, type SystemDescription } from "../src/systems/description";
import { pictured } from "../src/systems/flat";
import { begun, changed, clockOf, MOST_SERIES, sameRun, timeText, viewsOf } from "../src/systems/state";
import { read, written } from "../src/systems/url";
import { vectorNames } from "../src/systems/vectors";
import { Computation } from "../src/worker/computation";
import type { SystemJob, Update } from "../src/worker/messages";

/** The plane x' = y, y' = -x, with its energy; its orbits are circles of period 2 pi. */
const circle: SystemDescription = {
  version: 2,
  id: "0123456789ab",
  name: "circle",
  words: "",
  components: ["x", "y,1"],
  vector_length: 2,
  turns: [null, null],
  clock: null,
  field: { kind: "quadratic", n_components: 2, constant: [], linear: [[0, 1, 1], [1, 0, -1]], quadratic: [] } as never,
  invariants: { names: ["H"], functions: { n_components: 2, instructions: [["product", [0, 0], []], ["product", [1, 1], []], ["linear", [2, 3], [0.5, 0.5, 0]]], outputs: [4] } },
  surfaces: [
    { name: "x", functions: { n_components: 2, instructions: [], outputs: [0] }, modulus: null },
    { name: "y,1", functions: { n_components: 2, instructions: [], outputs: [1] }, modulus: null },
    { name: "x - y", functions: { n_components: 2, instructions: [["linear", [0, 1], [1, -1, 0]]], outputs: [2] }, modulus: null },
  ],
  start: ["1", "0"],
  unit: 0.5,
  surface: 0,
  direction: 1,
  axes: [0, 1],
  picture: null,
  saved: null,
};
const text = (more: object) => JSON.stringify({ ...circle, ...more });

let core: Core;
beforeAll(async () => {
  core = await Core.start(readFileSync(new URL("../../python/liepoisson/laboratory/page/core.wasm", import.meta.url)));
});

function all(job: SystemJob): Update[] {
  const computation = new Computation(core, job);
  computation.until(job.horizon);
  const updates: Update[] = [];
  for (let update = computation.advance(); update; update = computation.advance()) updates.push(update);
  computation.free();
  return updates;
}
const job = (more: Partial<SystemJob> = {}): SystemJob => ({ system: circle, start: [1, 0], surface: 0, direction: 1, tol: 1e-15, horizon: 50, saved: null, ...more });

describe("a description", () => {
  test("is read as it was written", () => expect(described(text({}))).toEqual(circle));
  test.each([
    ["", "no JSON"],
    ["[]", "no object"],
    [text({ version: 1 }), "version 1"],
    [text({ components: [] }), "no components"],
    [text({ components: Array(MOST_COMPONENTS + 1).fill("x") }), "at most"],
    [text({ field: { kind: "euler" } }), "does not know"],
    [text({ field: { ...circle.field, n_components: 3 } }), "3 components"],
    [text({ field: { ...circle.field, linear: Array(60_000).fill([[0, 1], 1]) } }), "terms"],
    [text({ start: ["1"] }), "1 numbers"],
    [text({ unit: 0 }), "unit"],
    [text({ surface: 3 }), "surface"],
    [text({ axes: [0, 5] }), "axes"],
    [text({ turns: [null] }), "turns"],
    [text({ turns: [null, [1, 1]] }), "turn"],
    [text({ clock: 1 }), "clock"],
    [text({ surfaces: circle.surfaces.slice(2) }), "one for each of its 2 components"],
    [text({ surfaces: [...circle.surfaces, { ...circle.surfaces[0], functions: { n_components: 3, instructions: [], outputs: [0] } }] }), "does not fit"],
    [text({ invariants: { names: ["H", "K"], functions: circle.invariants!.functions } }), "do not fit"],
    [text({ picture: { name: "w", across: [[1, 2]], up: [[1], [1, 2]], terms: [] } }), "different lengths"],
    [text({ picture: { name: "w", across: [[1]], up: [[1]], terms: [[2, 0, 0, 1]] } }), "component"],
    [text({ saved: { kind: "sweep" } }), "kind"],
  ])("%# that is malformed gives a message", (wrong, message) => {
    expect(() => described(wrong)).toThrow(Malformed);
    expect(() => described(wrong)).toThrow(message);
  });
  test("surfaces have their names", () => expect(surfaceNames(circle)).toEqual(["x", "y,1", "x - y"]));
});

describe("the state", () => {
  const state = begun(circle);
  test("another start begins the time again and is another run", () => {
    const next = changed(circle, { ...state, time: 3 }, { do: "start", index: 1, to: exact("1/3") });
    expect([next.time, next.start[1].text, sameRun(state, next)]).toEqual([0, "1/3", false]);
  });
  test("what is only seen otherwise is the same run", () => {
    const next = changed(circle, changed(circle, state, { do: "axes", axes: [1, 0] }), { do: "view", view: "series" });
    expect(sameRun(state, next)).toBe(true);
  });
  test("components over time are added and taken out, in order and not too many", () => {
    const none = changed(circle, state, { do: "series", component: 0, shown: false });
    expect(none.series).toEqual([1]);
    expect(changed(circle, none, { do: "series", component: 0, shown: true }).series).toEqual([0, 1]);
    const wide = { ...circle, components: Array.from({ length: 12 }, (_, k) => `x${k}`) };
    expect(() => changed(wide, { ...state, series: Array.from({ length: MOST_SERIES }, (_, k) => k) }, { do: "series", component: 11, shown: true })).toThrow(Refused);
  });
  test("views follow from what a system has", () => {
    expect(viewsOf(circle)).toEqual(["projection", "series"]);
    expect(viewsOf({ ...circle, vector_length: 3, components: ["a", "b", "c"] })).toEqual(["vectors", "projection", "series"]);
    expect(viewsOf({ ...circle, components: ["x"] })).toEqual(["series"]);
    expect(() => changed(circle, state, { do: "view", view: "vectors" })).toThrow(Refused);
  });
  test("a clock has the decimals of its unit", () => {
    const texts = [0.001, 0.5, 1, 20].map((unit) => timeText(1.23456, clockOf({ ...circle, unit })));
    expect(texts).toEqual(["1.23456", "1.235", "1.23", "1.2"]);
  });
  test("vectors are called by what their components have in common", () => {
    expect(vectorNames(["m1", "m2", "m3", "p1", "p2", "p3"])).toEqual(["m", "p"]);
    expect(vectorNames(["u", "v", "w"])).toEqual(["u, v, w"]);
  });
});

describe("the address", () => {
  test("brings everything back, whatever the names are", () => {
    let state = changed(circle, begun(circle), { do: "start at", state: [shortest(Math.PI), exact("-1/3")] });
    state = changed(circle, state, { do: "surface", surface: 2, direction: -1 });
    state = changed(circle, state, { do: "axes", axes: [1, 0] });
    state = changed(circle, state, { do: "space", space: [1, 0, null] });
    state = changed(circle, state, { do: "series", component: 0, shown: false });
    state = { ...changed(circle, state, { do: "time", time: 12.345678901234567 }), speed: 0.25, view: "series", theme: "dark", tol: exact("1e-9") };
    expect(read(circle, written(circle, state))).toEqual(state);
    expect(read(circle, written(circle, { ...state, series: [] })).series).toEqual([]);
  });
  test.each([
    ["v=1", "another system"],
    ["v=1&system=ffff", "another system"],
    ["v=2&system=0123456789ab", "version 2"],
    ["start=1", "2 values"],
    ["start=1,x", "y,1"],
    ["start=1,1e9", "too large"],
    ["section=4,1", "from 1 to 3"],
    ["section=0,1", "from 1 to 3"],
    ["section=1,2", "direction"],
    ["axes=1,3", "from 1 to 2"],
    ["space=0,1,2", "at least two"],
    ["series=1,9", "from 1 to 2"],
    ["view=vectors", "no view"],
    ["tol=1", "tolerance"],
    ["t=1e9", "between"],
    ["t=", "between"],
    ["theme=pink", "one of"],
    ["t=1&t=2", "twice"],
    ["html=<b>", "unknown part"],
    [`start=${"1".repeat(20_000)}`, "too long"],
  ])("%s gives a message", (address, message) => {
    const whole = address.startsWith("v=") ? address : `v=1&system=0123456789ab&${address}`;
    expect(() => read(circle, whole)).toThrow(Refused);
    expect(() => read(circle, whole)).toThrow(message);
  });
});

describe("the computation", () => {
  test("crossings of a component and of a function come at their times", () => {
    for (const [surface, first] of [[0, 1.5 * Math.PI], [2, 1.75 * Math.PI]] as const) {
      const times = all(job({ surface })).flatMap((one) => (one.say === "crossings" ? [...one.times] : []));
      expect(times.length).toBe(Math.floor((50 - first) / (2 * Math.PI)) + 1);
      times.forEach((time, k) => expect(Math.abs(time - first - 2 * Math.PI * k)).toBeLessThan(1e-12));
    }
  });
  test("the energy is kept, and the motion has the state alone", () => {
    const updates = all(job());
    const drift = updates.flatMap((one) => (one.say === "drift" ? [...one.differences] : []));
    expect(drift.length).toBeGreaterThan(10);
    expect(Math.max(...drift.map(Math.abs))).toBeLessThan(1e-14);
    const motion = updates.filter((one) => one.say === "motion");
    for (const { times, states } of motion) {
      expect(states.length).toBe(2 * times.length);
      times.forEach((time, k) => expect(Math.abs(states[2 * k] - Math.cos(time))).toBeLessThan(1e-13));
    }
    expect(motion.some((one) => one.shadow)).toBe(false);
    expect(updates.at(-1)).toEqual({ say: "finished" });
  });
  test("a system without invariants has no drift", () => {
    const updates = all(job({ system: { ...circle, invariants: null } }));
    expect(updates.find((one) => one.say === "invariants")).toMatchObject({ names: [], values: [] });
  });
});

describe("a saved result", () => {
  const times = Array.from({ length: 21 }, (_, k) => k / 2);
  const saved: Saved = {
    kind: "orbit", words: "Saved: an orbit", shown_only: null, tol: 1e-15, starts: [[1, 0]], times,
    states: times.map((t) => [Math.cos(t), -Math.sin(t)]), trajectory: [], functions: null, direction: 1, n_crossings: 0, t_end: 10,
    has_states: true, coordinates: ["x", "y,1"],
  };
  test("is computed again and compared", () => {
    const found = comparison(core, circle, saved)!;
    expect(found.largest).toBeLessThan(1e-14);
    expect([found.count, found.until]).toEqual([42, Infinity]);
  });
  test("a wrong number is found where it is", () => {
    const states = saved.states.map((state, k) => (k === 12 ? [state[0], state[1] + 1e-3] : state));
    const found = comparison(core, circle, { ...saved, states })!;
    expect(Math.abs(found.largest - 1e-3)).toBeLessThan(1e-12);
    expect([found.at, found.component, found.until]).toEqual([6, "y,1", 5.5]);
    expect(inWords(saved, found)).toMatch(/1\.0 · 10⁻³ \(in y,1 at t = 6\).*Up to t = 5\.5/);
  });
  test("crossings are compared one by one, and another number of them is said", () => {
    const functions = { n_components: 2, instructions: [] as [], outputs: [0, 0, 1] };
    const section: Saved = { ...saved, kind: "section", functions, times: [1.5 * Math.PI, 3.5 * Math.PI], states: [[0, 1], [0, 1]], trajectory: [0, 0], t_end: 12, coordinates: ["x", "y,1"] };
    const found = comparison(core, circle, section)!;
    expect(found.largest).toBeLessThan(1e-13);
    expect(found.words).toBe("both find 2 crossings");
    expect(comparison(core, circle, { ...section, t_end: 20 })!.words).toMatch(/the file has 2 crossings, this page finds 3/);
  });
  test("a large difference is written without a power of ten", () => {
    const far = saved.states.map(([x, y], k) => (k === 20 ? [x + 1.25, y] : [x, y]));
    expect(inWords(saved, comparison(core, circle, { ...saved, states: far })!)).toMatch(/numbers is 1\.3 \(in x at t = 10\)|numbers is 1\.2 \(in x/);
  });
  test("what cannot be computed again is only shown", () => {
    const shown = { ...saved, shown_only: "it was made by another method" };
    expect(comparison(core, circle, shown)).toBe(null);
    expect(inWords(shown, null)).toMatch(/only shown: it was made by another method/);
  });
  test("no difference is said so, and NaN is no small one", () => {
    expect(inWords(saved, compared(saved, Float64Array.from(saved.states.flat()), times, ""))).toMatch(/all 42 numbers are the same/);
    expect(compared(saved, new Float64Array(42).fill(NaN), times, "").largest).toBe(Infinity);
  });
});

test("a picture is the sum of its terms", () => {
  const picture = { name: "w", across: [[1, 2, 3], [0, 1, 0]], up: [[1, -1]], terms: [[0, 0, 0, 2], [1, 1, 0, -1]] as [number, number, number, number][] };
  expect([...pictured(picture, [5, 7])]).toEqual([10, 13, 30, -10, -13, -30]);
});
