import { describe, expect, test } from "vitest";
import { components, presets } from "../src/data/tops";
import { exact, NotANumber, shortest } from "../src/state/exact";
import { begun, changed, Refused, sameRun, type Laboratory } from "../src/state/laboratory";
import { read, written } from "../src/state/url";

describe("exact numbers", () => {
  test.each([["1/3", 1 / 3], ["-0.25", -0.25], ["1e-3", 1e-3], [" .5 ", 0.5], ["−2", -2]])("%s is read", (text, value) => {
    expect(exact(text).value).toBe(value);
  });
  test.each(["", "one", "1/0", "0x10", "1e999", "1e7", "NaN", "1//2", "<b>1</b>", "1".repeat(80), "1/99999999999999999"])(
    "%s is refused", (text) => expect(() => exact(text)).toThrow(NotANumber),
  );
  test("a double is written with all of its digits", () => {
    for (const value of [0.1, 1 / 3, -(2 ** -40), 123456.789]) expect(exact(shortest(value).text).value).toBe(value);
  });
});

describe("the reducer", () => {
  const lab = begun("kovalevskaya");
  test("a new parameter begins the time again and leaves the preset", () => {
    const next = changed({ ...lab, time: 5 }, { do: "parameter", index: 9, to: exact("1/3") });
    expect([next.preset, next.time, next.parameters[9].text]).toEqual([null, 0, "1/3"]);
    expect(lab.parameters[9].text).toBe("0");
    expect(sameRun(lab, next)).toBe(false);
  });
  test("a view computes nothing new", () => {
    const next = changed(lab, { do: "view", view: { frame: "body" } });
    expect(sameRun(lab, next)).toBe(true);
  });
  test("a preset keeps view and theme", () => {
    const next = changed(changed(lab, { do: "theme", theme: "dark" }), { do: "preset", key: "lagrange" });
    expect([next.theme, next.preset]).toEqual(["dark", "lagrange"]);
  });
  test("a moment of inertia is positive", () => {
    expect(() => changed(lab, { do: "parameter", index: 0, to: exact("0") })).toThrow(Refused);
  });
  test("time stays on the orbit that is computed", () => {
    expect(changed(lab, { do: "time", time: -1 }).time).toBe(0);
  });
});

describe("the address", () => {
  const again = (lab: Laboratory) => read(written(lab));
  test.each(presets.map((preset) => preset.key))("%s comes back", (key) => {
    expect(again(begun(key))).toEqual(begun(key));
  });
  test("parameters come back as they were written, and starts bit for bit", () => {
    let lab = changed(begun("kovalevskaya"), { do: "parameter", index: 9, to: exact("1/3") });
    lab = changed(lab, { do: "start at", state: components.map((_, k) => shortest(Math.sin(k + 1))) });
    lab = changed(lab, { do: "method", method: { kind: "taylor", tol: exact("1e-9") } });
    lab = { ...changed(lab, { do: "time", time: 12.345678901234567 }), speed: 0.5 };
    expect(again(lab)).toEqual(lab);
  });
  test.each([
    ["", "version none"],
    ["v=2", "version 2"],
    ["v=1&preset=nothing", "no preset"],
    ["v=1&preset=__proto__", "no preset"],
    ["v=1&top=1,2", "10 values"],
    ["v=1&top=1,1,0,0,0,0,0,0,0,0", "moment of inertia"],
    ["v=1&start=1,2,3,4,5,6,7,8,x", "beta3"],
    ["v=1&start=1e300,2,3,4,5,6,7,8,9", "too large"],
    ["v=1&section=l9,1", "no component"],
    ["v=1&section=l3,2", "direction"],
    ["v=1&method=euler,1", "method"],
    ["v=1&method=taylor,1e-40", "tolerance"],
    ["v=1&t=1e5", "between"],
    ["v=1&theme=pink", "one of"],
    ["v=1&v=1", "twice"],
    ["v=1&html=<script>alert(1)</script>", "unknown part"],
    [`v=1&top=${"1".repeat(5000)}`, "too long"],
  ])("%s gives a message", (address, message) => {
    expect(() => read(address)).toThrow(Refused);
    expect(() => read(address)).toThrow(message);
  });
  test("a message does not repeat what is long", () => {
    try {
      read(`v=1&theme=${"x".repeat(3000)}`);
    } catch (error) {
      expect((error as Error).message.length).toBeLessThan(200);
    }
  });
});
