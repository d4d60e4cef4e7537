import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { presets } from "../src/data/tops";
import { checkSteps, LONGEST, tourOf } from "../src/data/tour";
import { tours } from "../src/data/tours";
import { ticks } from "../src/panels/plot";
import { Refused } from "../src/state/everyday";
import { read } from "../src/state/url";

const STEP = { title: "a", words: "b", at: "scene", state: "v=1&preset=lagrange" };
const TOUR = { tour: 1, title: "a", about: "b", steps: [STEP, STEP] };

describe("tours", () => {
  test("there are six, of five steps each, and those of tops are read", () => {
    expect(tours.map(({ steps }) => steps.length)).toEqual([5, 5, 5, 5, 5, 5]);
    expect(new Set(tours.map(({ title }) => title)).size).toBe(6);
    for (const tour of tours.filter(({ system }) => !system)) checkSteps(tour, read);
  });
  test("that of the guide is read", () => {
    const guide = readFileSync(resolve(import.meta.dirname, "../../docs/laboratory.md"), "utf8");
    const [, text] = /```json\n(.*?)```/s.exec(guide) ?? [];
    const tour = tourOf(text);
    checkSteps(tour, read);
    expect(tour.steps.length).toBe(2);
  });
  test("an address with what stands before the # is one", () => {
    checkSteps(tourOf(JSON.stringify({ ...TOUR, steps: [{ ...STEP, state: "https://example.org/lab.html?still=1#v=1&preset=sticky" }] })), read);
  });
  test("each part is needed, and of one type", () => {
    for (const name of Object.keys(TOUR)) {
      expect(() => tourOf(JSON.stringify({ ...TOUR, [name]: undefined }))).toThrow(`the tour has no "${name}"`);
      for (const other of [null, true, 2, {}, [[]]]) expect(() => tourOf(JSON.stringify({ ...TOUR, [name]: other })), `${name} ${JSON.stringify(other)}`).toThrow(Refused);
    }
    for (const name of Object.keys(STEP)) {
      const of = (step: object) => JSON.stringify({ ...TOUR, steps: [STEP, step] });
      expect(() => tourOf(of({ ...STEP, [name]: undefined }))).toThrow(`step 2 has no "${name}"`);
      for (const other of [null, true, 2, {}, [[]], ""]) expect(() => tourOf(of({ ...STEP, [name]: other })), `${name} ${JSON.stringify(other)}`).toThrow(`"${name}" of step 2`);
    }
  });
  test.each([
    ["{", /it is no JSON/],
    ["[]", /the tour must be an object \{ … \}; got a list/],
    [`"${"x".repeat(LONGEST)}"`, /it is too long: 64002 characters, at most 64000/],
    ["[".repeat(LONGEST), /it is no JSON/],
    [JSON.stringify({ ...TOUR, tour: 2 }), /"tour" of the tour must be 1; got 2/],
    [JSON.stringify({ ...TOUR, script: "x".repeat(100) }), /unknown part "script"; known are/],
    [JSON.stringify(TOUR).replace('"tour"', '"__proto__":{"tour":1},"tour"'), /unknown part "__proto__"/],
    [JSON.stringify({ ...TOUR, steps: [] }), /"steps" of the tour must be a list of 1 to 12; got 0/],
    [JSON.stringify({ ...TOUR, steps: Array(13).fill(STEP) }), /"steps" of the tour must be a list of 1 to 12; got 13/],
    [JSON.stringify({ ...TOUR, steps: [{ ...STEP, words: "x".repeat(712) }] }), /"words" of step 1 must have 1 to 600 characters; got 712/],
    [JSON.stringify({ ...TOUR, steps: [{ ...STEP, words: "a\nb" }] }), /"words" of step 1 has a control character/],
    [JSON.stringify({ ...TOUR, steps: [{ ...STEP, at: "keys" }] }), /"at" of step 1 is one of scene, .*; got "keys"/],
  ])("%# is refused in a sentence", (text, why) => {
    expect(() => tourOf(text)).toThrow(why);
    expect(() => tourOf(text)).toThrow(Refused);
  });
  test("a state that cannot be shown is told with its step", () => {
    const steps = [STEP, { ...STEP, state: `v=1&preset=${presets[0].key}&theme=red` }];
    expect(() => checkSteps(tourOf(JSON.stringify({ ...TOUR, steps })), read)).toThrow(/the state of step 2 cannot be shown: "theme" is one of/);
  });
});

/** Numbers of a fixed sequence, between 0 and 1. */
function* numbers(): Generator<number> {
  for (let seed = 1; ; seed = (seed * 48271) % 2147483647) yield seed / 2147483647;
}

test("an axis has at least two numbers, also where its name takes a place", () => {
  const next = numbers();
  const one = () => next.next().value as number;
  for (let k = 0; k < 2000; k++) {
    const low = (one() - 0.5) * 10 ** (6 * one() - 3);
    const high = low + 10 ** (6 * one() - 4) * (Math.abs(low) + 0.1);
    const log = k % 3 === 0;
    const range = log ? [Math.abs(low) + 1e-9, (Math.abs(low) + 1e-9) * (1.3 + 10 ** (8 * one()))] as const : [low, high] as const;
    const most = range[1] - 0.1 * (range[1] - range[0]);
    const found = ticks({ range, log, name: "" }, 9 * one(), (value) => value < most).filter(({ value }) => value >= range[0] - 1e-9 * (range[1] - range[0]) && value < most);
    expect(found.length, `${range}`).toBeGreaterThanOrEqual(2);
    expect(new Set(found.map(({ text }) => text)).size, `${range}: ${found.map(({ text }) => text)}`).toBe(found.length);
  }
});
