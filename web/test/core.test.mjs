// The core in WebAssembly against numbers that Python writes (tests/web/test_core_in_wasm.py): LIEPOISSON_CASES names their file.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { Core, CoreStopped, Refusal } from "../src/core/core.js";

const program = new WebAssembly.Module(readFileSync(process.env.LIEPOISSON_CORE));
const cases = JSON.parse(readFileSync(process.env.LIEPOISSON_CASES, "utf8"));

/** Compares arrays of rows, each row within a bound of its own. */
function assertClose(got, wanted, bounds, what) {
  assert.equal(got.length, wanted.length, `${what}: number of values`);
  const width = wanted.length / bounds.length;
  for (let i = 0; i < wanted.length; i++) {
    const [distance, bound] = [Math.abs(got[i] - wanted[i]), bounds[Math.floor(i / width)]];
    assert.ok(distance <= bound, `${what} ${i}: ${got[i]} for ${wanted[i]}, off by ${distance}, bound ${bound}`);
  }
}

for (const { name, field, method, start, times, state, bounds, dense } of cases.orbits) {
  test(`orbit: ${name}`, async () => {
    const core = await Core.start(program);
    const [f, m] = [core.field(field), core.method(method)];
    const run = core.orbits(f, m, start, times);
    assert.deepEqual(run.outcome, ["finished"]);
    assertClose(run.state, state.flat(), bounds, "state");
    if (dense) {
      const orbit = core.orbit(f, m, start, times[0], times.at(-1));
      assertClose(orbit.at(times), state.flat(), bounds, "dense output");
      assert.ok(Number.isNaN(orbit.at([times.at(-1) + Math.sign(times.at(-1))])[0]), "beyond the end there is no state");
      orbit.free();
    }
    // each member has the bits that it has alone
    const three = core.orbits(f, m, [...start, ...start, ...start], times);
    for (let k = 0; k < 3; k++) assert.deepEqual(three.state.slice(k * run.state.length, (k + 1) * run.state.length), run.state);
  });
}

for (const { name, field, surface, starts, end, direction, count, time, sign, state, bounds } of cases.sections) {
  test(`section: ${name}`, async () => {
    const core = await Core.start(program);
    const [f, m, s] = [core.field(field), core.method({ kind: "taylor" }), core.functions(surface)];
    const found = core.section(f, m, s, starts.flat(), { to: end, direction });
    assert.deepEqual([...found.crossings.count], count);
    assert.deepEqual([...found.crossings.sign], sign);
    assertClose(found.crossings.time, time, bounds, "time");
    assertClose(found.crossings.state, state.flat(), bounds, "state");
    assert.ok(found.unseenSteps.every((steps) => steps === 0));
    // in two parts, the second from where the first has ended
    const half = core.section(f, m, s, starts.flat(), { to: end / 2, direction });
    const rest = core.section(f, m, s, half.endState, { from: end / 2, to: end, direction, sides: half.side });
    const total = half.crossings.count.map((n, k) => n + rest.crossings.count[k]);
    assert.deepEqual([...total], count);
  });
}

for (const { name, field, starts, tangents, times, exponent, bounds } of cases.exponents) {
  test(`exponents: ${name}`, async () => {
    const core = await Core.start(program);
    const [f, m] = [core.field(field), core.method({ kind: "taylor" })];
    const run = core.exponents(f, m, starts.flat(), tangents.flat(), times);
    assertClose(run.exponent, exponent.flat(), bounds, "exponent");
    const n = f.nComponents;
    const ones = tangents.map((v) => v.map((x) => x / Math.hypot(...v))).flat();
    const course = { nVectors: 1, duration: times.at(-1) / 8, nIntervals: 4 };
    const first = core.frames(f, m, starts.flat(), ones, { ...course, elapsed: starts.map(() => 0) });
    const last = core.frames(f, m, first.endState, first.frame, { ...course, elapsed: first.endTime });
    const whole = core.frames(f, m, starts.flat(), ones, { ...course, nIntervals: 8, elapsed: starts.map(() => 0) });
    assert.equal(first.endState.length, n * starts.length);
    assert.deepEqual(last.endState, whole.endState);
    assert.deepEqual(last.frame, whole.frame);
    assert.deepEqual(last.endTime, whole.endTime);
    const grown = starts.map((_, k) => whole.growth.slice(8 * k, 8 * k + 8).reduce((sum, g) => sum + g, 0));
    const wanted = exponent.map((row) => row.at(-1) * times.at(-1));
    assertClose(grown, wanted, bounds.filter((_, k) => (k + 1) % (times.length - 1) === 0).map((b) => b * times.at(-1)), "growth");
  });
}

for (const { name, field, starts, tangents, times, units, end, kinds, indicators, distance } of cases.verdicts) {
  test(`verdicts: ${name}`, async () => {
    const core = await Core.start(program);
    const [f, m] = [core.field(field), core.method({ kind: "taylor", tol: 1e-13 })];
    const periods = starts[0].map(() => Infinity);
    const own = core.units(f, m, starts.flat(), periods);
    // the derivative of the field has errors of 1e-8 from round-off
    const near = (got, wanted, relative, what) => wanted.forEach((value, k) => assert.ok(Math.abs(got[k] - value) <= relative * Math.abs(value), `${what} ${k}: ${got[k]} for ${value}`));
    near(own.time, times, 1e-6, "time");
    near(own.component, units.flat(), 1e-6, "unit");
    const course = { tangents: tangents.flat(2), units: units.flat(), periods, naturalTimes: times.map((time) => end / time), end, isPlane: false };
    const said = core.decide(f, m, starts.flat(), course);
    assert.deepEqual([...said.kind], kinds);
    assert.ok(said.outcome.every((outcome) => outcome === "finished"));
    kinds.forEach((kind, k) => kind === -1 && near(said.indicators.slice(4 * k, 4 * k + 4), indicators[k], distance, "indicator"));
    assert.throws(() => core.decide(f, m, starts.flat(), { ...course, units: [1] }), Refusal);
  });
}

for (const { name, description, equations, start, times, state, bounds, section, exponent } of cases.typed) {
  test(`typed: ${name}`, async () => {
    const core = await Core.start(program);
    const [system, method] = [core.system(description), core.method({ kind: "taylor" })];
    const field = system.field();
    assert.equal(field.nComponents, start.length);
    assert.deepEqual(system.equations.slice(0, equations.length), equations);
    const run = core.orbits(field, method, start, times);
    assert.deepEqual(run.outcome, ["finished"]);
    assertClose(run.state, state.flat(), bounds, "state");
    const again = core.orbits(core.field(system.fieldRecord), method, start, times);
    assert.deepEqual(again.state, run.state);
    const surface = system.functions(section.surface);
    assert.deepEqual(core.functions(system.functionsRecord(section.surface)).values(state.flat()), surface.values(state.flat()));
    const found = core.section(field, method, surface, start, { to: section.end, direction: 1 });
    assert.deepEqual([...found.crossings.count], section.count);
    assertClose(found.crossings.time, section.time, section.bounds, "time");
    assertClose(found.crossings.state, section.state.flat(), section.bounds, "state");
    const grown = core.exponents(field, method, start, exponent.tangent, exponent.times);
    assertClose(grown.exponent, exponent.value, exponent.bounds, "exponent");
  });
}

test("a system is written as trees that the core derives", async () => {
  const core = await Core.start(program);
  const bracket = { name: "tensor", coordinates: ["x", "y", "z"], entries: [[0, 1, "x*y"], [1, 2, "y*z"], [0, 2, "-(z*x)"]] };
  const species = core.system({ bracket, hamiltonian: "x + y + z/(2*a)", parameters: { a: "3" } });
  const { names, energy, rates, tensor } = species.written;
  assert.deepEqual(names, ["x", "y", "z"]);
  assert.deepEqual(energy, ["+", [["+", "x"], ["+", "y"], ["+", ["/", ["z"], ["a", ["number", "2"]]]]]]);
  assert.deepEqual(rates[0], ["+", [["+", ["/", ["x", "y"], []]], ["-", ["/", ["x", "z"], ["a", ["number", "2"]]]]]]);
  assert.deepEqual(tensor[0], [0, 1, ["/", ["x", "y"], []]]);
  assert.deepEqual(core.names("dot(l, inv(I)*l)/2 + pi*a[1]*cos(theta)"), ["l", "I", "a", "theta"]);
  const broken = { ...bracket, entries: [[0, 1, "x^2"], [1, 2, "y*z"]] };
  assert.throws(() => core.system({ bracket: broken, hamiltonian: "x" }), (error) => /Jacobi/.test(error.message) && error.place === -1);
});

test("a formula that is refused says where", async () => {
  const core = await Core.start(program);
  const bracket = { name: "canonical", n: 1 };
  const refused = (description, kind, place, pattern) =>
    assert.throws(
      () => core.system({ bracket, ...description }).field(),
      (error) => error.kind === kind && error.place === place && pattern.test(error.message),
    );
  refused({ hamiltonian: "p1^2/2 - cos(q2)" }, "ExpressionError", 13, /q has 1 components/);
  refused({ hamiltonian: "p1^2/2 +\n  2*α" }, "ExpressionError", 13, /alpha \(line 2, column 5\)/);
  refused({ hamiltonian: "p1^2/(2*m)", declared: ["m"] }, "ParameterError", -1, /none for m/);
  refused({ hamiltonian: "p1^2/(2*m)", parameters: { m: "0" } }, "ExpressionError", 4, /must not vanish/);
  refused({ hamiltonian: "p1^2/(2*m)", parameters: { m: "1; alert(1)" } }, "ParameterError", -1, /m must be a number/);
  refused({ hamiltonian: "p1^2/2", bracket: { name: "<img>" } }, "UnknownNameError", -1, /kind of bracket/);
  refused({ hamiltonian: "x1", bracket: { name: "lie_poisson", fields: { x: ["1", "2", "3"] }, constants: [[0, 1, 0, 1], [1, 2, 1, 1]] } }, "ParameterError", -1, /Jacobi/);
  refused({}, "DescriptionError", -1, /"hamiltonian"/);
  refused({ hamiltonian: `q1^${"9".repeat(1e6)}` }, "ExpressionError", 0, /at most 20000 characters/);
  const pendulum = core.system({ bracket: { name: "canonical", coordinates: ["q"], momenta: ["p"] }, hamiltonian: "p^2/2 - w^2*cos(q)", parameters: { w: 0.5 } });
  assert.deepEqual(pendulum.equations, [{ name: "q", rate: "p" }, { name: "p", rate: "-w^2*sin(q)" }]);
  assert.throws(() => pendulum.functions("q +"), (error) => error.place === 3);
  assert.deepEqual([...pendulum.functions("atan2(p, q)", "w").values([0, 2])], [Math.PI / 2, 0.5]);
});

for (const { name, functions, states, values, bounds } of cases.values) {
  test(`values: ${name}`, async () => {
    const core = await Core.start(program);
    assertClose(core.functions(functions).values(states.flat()), values.flat(), bounds, "value");
  });
}

for (const { name, field, states, rates, bounds } of cases.rates) {
  test(`rates: ${name}`, async () => {
    const core = await Core.start(program);
    assertClose(core.rates(core.field(field), core.method({ kind: "taylor" }), states.flat()), rates.flat(), bounds, "rate");
  });
}

for (const { name, functions, start, values, units, state, bound } of cases.projections) {
  test(`projection: ${name}`, async () => {
    const core = await Core.start(program);
    const found = core.project(core.functions(functions), start, values, units);
    const size = Math.max(...state.map((x, k) => Math.abs(x / units[k])));
    for (let k = 0; k < state.length; k++) {
      const distance = Math.abs(found.state[k] - state[k]) / units[k] / size;
      assert.ok(distance <= bound, `component ${k}: ${found.state[k]} for ${state[k]}, off by ${distance}, bound ${bound}`);
    }
    assert.ok(found.residual.every((one) => Math.abs(one) <= 1e-15), `residuals ${found.residual}`);
    const far = Math.max(...start.map((x, k) => Math.abs(x - state[k])));
    assert.ok(far > 0.01, "the start is not where it ends");
  });
}

test("a projection that has no solution says how far it is", async () => {
  const core = await Core.start(program);
  const [{ functions, start, units }] = cases.projections;
  const tape = core.functions(functions);
  const values = tape.values(start);
  // |beta|^2 = -1
  const { residual } = core.project(tape, start, [...values.slice(0, 3), -1], units);
  assert.ok(Math.max(...residual.map(Math.abs)) > 1e-3, `residuals ${residual}`);
  for (const wrong of [[start.slice(1), values, units], [start, values.slice(1), units], [start, values, []]]) {
    assert.throws(() => core.project(tape, ...wrong), (error) => error instanceof Refusal && error.kind === "ShapeError");
  }
  assert.throws(() => core.project(tape, start, values, units.map(() => 0)), (error) => error.kind === "ParameterError");
});

test("coefficients are divided by their order as IEEE 754 divides", async () => {
  // u = v t; x' = u u, x' = u x, ...: single products, whose quotients by 3, 5, 7 and 6 are the states at time 1
  const core = await Core.start(program);
  const quadratic = [[2, 1, 1, 1], [3, 1, 2, 1], [4, 1, 3, 1], [6, 1, 5, 1], [7, 1, 6, 1]];
  const field = core.field({ kind: "quadratic", n_components: 8, constant: [], linear: [[1, 0, 1], [5, 1, 1]], quadratic });
  const numbers = Array.from({ length: 500 }, (_, k) => 1 + ((k * 0.6180339887498949) % 1));
  const starts = numbers.flatMap((v) => [v, 0, 0, 0, 0, 0, 0, 0]);
  const { state, nSteps } = core.orbits(field, core.method({ kind: "taylor" }), starts, [0, 1]);
  assert.ok(nSteps.every((n) => n === 1));
  numbers.forEach((v, k) => {
    const third = (v * v) / 3;
    const fifth = (v * third) / 5;
    const fourth = (v * (v / 2)) / 4;
    const wanted = [v, v, third, fifth, (v * fifth) / 7, v / 2, fourth, (v * fourth) / 6];
    assert.deepEqual([...state.slice(16 * k + 8, 16 * k + 16)], wanted, `v = ${v}`);
  });
});

test("errors of Casimirs grow as the square root of time", async () => {
  const { field, invariants, index, starts, short, long, limits } = cases.drift;
  const core = await Core.start(program);
  const [f, m, g] = [core.field(field), core.method({ kind: "taylor" }), core.functions(invariants)];
  const run = core.orbits(f, m, starts.flat(), [0, short, long]);
  const all = g.values(run.state);
  const value = (k, time) => all[(3 * k + time) * g.nFunctions + index];
  const square = (from, to) => starts.reduce((sum, _, k) => sum + (value(k, to) - value(k, from)) ** 2, 0);
  const ratio = square(1, 2) / square(0, 1) / ((long - short) / short);
  assert.ok(limits[0] < ratio && ratio < limits[1], `variances in time: ${ratio}, wanted within ${limits}`);
  const errors = starts.map((_, k) => value(k, 2) - value(k, 0));
  const mean = errors.reduce((sum, error) => sum + error, 0) / Math.sqrt(errors.reduce((sum, error) => sum + error * error, 0));
  assert.ok(Math.abs(mean) < limits[2], `the errors have a sign: ${mean} standard errors, wanted at most ${limits[2]}`);
});

test("what is refused has a kind and a message, and the core goes on", async () => {
  const core = await Core.start(program);
  const top = { kind: "top", inertia: [2, 2, 1], a: [-1, 0, 0], b: [0, 0, 0], epsilon: 1 };
  const [field, method] = [core.field(top), core.method({ kind: "taylor" })];
  const x = [0.3, 0.2, 0.5, 1, 0, 0, 0, 1, 0];
  const refused = (kind, pattern, run) =>
    assert.throws(run, (error) => error instanceof Refusal && error.kind === kind && pattern.test(error.message));
  refused("ParameterError", /inertia/, () => core.field({ ...top, inertia: [2, 2, 0] }));
  refused("DescriptionError", /wanted an entry "epsilon"/, () => core.field({ ...top, epsilon: undefined }));
  refused("DescriptionError", /a number/, () => core.field({ ...top, epsilon: "1; alert(1)" }));
  refused("DescriptionError", /finite number at character/, () => core.field('{"kind": "top", "epsilon": 1e999}'));
  refused("DescriptionError", /within one another/, () => core.field("[".repeat(100000)));
  refused("DescriptionError", /the text ends/, () => core.field('{"kind": "to'));
  refused("DescriptionError", /nothing more/, () => core.field("{} {}"));
  refused("DescriptionError", /whole number/, () => core.functions({ n_components: -1, instructions: [], outputs: [] }));
  refused("UnknownNameError", /kind of field/, () => core.field({ kind: "<img onerror=alert(1)>" }));
  refused("UnknownNameError", /instruction/, () => core.functions({ n_components: 1, instructions: [["eval", [0], []]], outputs: [1] }));
  refused("ParameterError", /registers below/, () => core.functions({ n_components: 1, instructions: [["exp", [7], []]], outputs: [1] }));
  refused("ParameterError", /components/, () => core.functions({ n_components: 4e9, instructions: [], outputs: [0] }));
  refused("ParameterError", /components/, () => core.field({ kind: "quadratic", n_components: 4e9, constant: [], linear: [], quadratic: [] }));
  refused("ParameterError", /tol/, () => core.method({ kind: "taylor", tol: 7 }));
  refused("ParameterError", /times/, () => core.orbits(field, method, x, [0, NaN]));
  refused("ParameterError", /times/, () => core.orbits(field, method, x, [1]));
  refused("ShapeError", /states/, () => core.orbits(field, method, x.slice(1), [0, 1]));
  refused("ShapeError", /tangents/, () => core.orbits(field, method, x, [0, 1], { nTangents: 1 }));
  refused("MemoryLimitError", /vectors/, () => core.orbits(field, method, x, [0, 1], { nTangents: 1e9 }));
  refused("MemoryLimitError", /vectors|memory/, () => core.frames(field, method, x, [], { nVectors: 4e9, elapsed: [0], duration: 1, nIntervals: 1 }));
  refused("MemoryLimitError", /memory/, () => core.call("lp_numbers", 0xffffffff));
  refused("UnsupportedFieldError", /method/, () => core.section(field, core.method({ kind: "splitting", step: 0.1 }), core.functions({ n_components: 9, instructions: [], outputs: [2] }), x, { to: 1 }));
  refused("HandleError", /a field/, () => core.orbits({ handle: 12345 }, method, x, [0, 1]));
  refused("HandleError", /a method/, () => core.orbits(field, { handle: field.handle }, x, [0, 1]));
  field.free();
  refused("HandleError", /freed/, () => core.orbits(field, method, x, [0, 1]));
  const long = core.orbits(core.field(top), core.method({ kind: "taylor", max_steps: 50 }), x, [0, 1e300]);
  assert.deepEqual(long.outcome, ["max steps"]);
  const far = core.orbits(core.field(top), method, x.map(() => 1e300), [0, 1]);
  assert.deepEqual(far.outcome, ["not finite"]);
});

test("memory is given back", async () => {
  const core = await Core.start(program);
  const field = core.field({ kind: "top", inertia: [2, 2, 1], a: [-1, 0, 0], b: [0, 0, 0], epsilon: 1 });
  const method = core.method({ kind: "taylor" });
  const x = [0.3, 0.2, 0.5, 1, 0, 0, 0, 1, 0];
  const times = Float64Array.from({ length: 1001 }, (_, k) => 0.01 * k);
  let pages = 0;
  for (let k = 0; k < 60; k++) {
    core.orbits(field, method, x, times);
    core.orbit(field, method, x, 0, 10).free();
    assert.throws(() => core.field("{"), Refusal);
    if (k === 9) pages = core.exports.memory.buffer.byteLength;
  }
  assert.equal(core.exports.memory.buffer.byteLength, pages);
});

test("a core that has stopped says so, and a new one starts", async () => {
  const core = await Core.start(program);
  assert.throws(() => core.call("lp_no_such_export"), CoreStopped);
  assert.throws(() => core.method({ kind: "taylor" }), CoreStopped);
  const other = await Core.start(program);
  other.method({ kind: "taylor" });
});
