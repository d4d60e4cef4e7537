import { readFileSync } from "node:fs";
import decodeQR from "qr/decode.js";
import { describe, expect, test } from "vitest";
import { components, presets } from "../src/data/tops";
import { asPython, facts } from "../src/tops/export";
import { SvgContext } from "../src/export/svg";
import { csv } from "../src/export/table";
import { curveOf, type Levels } from "../src/panels/levels";
import { codeOf, frameLine, fromStart, pageWith } from "../src/panels/share";
import { exact, NotANumber, nudged, shortest } from "../src/state/exact";
import { Refused } from "../src/state/everyday";
import { begun, changed, sameRun, type Laboratory } from "../src/state/laboratory";
import { read, written } from "../src/state/url";
import { packed, unpacked } from "../src/worker/packed";
import { exponentTimes } from "../src/worker/times";

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

test.each([
  ["0.30", 1, "0.31"], ["0.30", -1, "0.29"], ["−0.01", 1, "0.00"], ["0.0", -1, "−0.1"], ["9", 1, "10"], [".5", 1, "0.6"], ["1.", 1, "2"],
  ["1/3", 1, "2/3"], ["0/2", -1, "−1/2"], ["−1/2", 1, "0/2"], ["1/", 1, null], ["1e-3", 1, null], ["", 1, null], ["-", 1, null], [".", 1, null], ["0.1234567890123", 1, null],
])("the last digit of %j moved by %i is %j", (text, by, wanted) => {
  expect(nudged(text, by)).toBe(wanted);
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

describe("the lines of Python", () => {
  test("those of the guide are those of the page", () => {
    const guide = readFileSync(new URL("../../docs/laboratory.md", import.meta.url), "utf8");
    expect(guide).toContain(`\`\`\`python\n${asPython(begun("kovalevskaya"))}\`\`\``);
  });
  test("fractions stay exact, and what Python would not read is written otherwise", () => {
    let lab = changed(begun("sticky"), { do: "parameter", index: 9, to: exact("+01/03") });
    lab = changed(lab, { do: "start", index: 0, to: exact("-007/010") });
    lab = changed(lab, { do: "start", index: 1, to: exact("0.50") });
    expect(asPython(lab)).toContain('epsilon="1/3"');
    expect(asPython(lab)).toContain("start = [-7 / 10, 0.50, ");
    expect(asPython(lab)).toContain('inertia=(2, 2, "6/5")');
  });
  test("times are those of the chart", () => {
    const times = exponentTimes(1e4);
    const inPython = Array.from({ length: 14 }, (_, k) => Array.from({ length: 8 }, (_, part) => 2 ** k * (1 + part / 8))).flat();
    expect(times.filter((time) => time >= 1)).toEqual(inPython.filter((time) => time <= times.at(-1)!));
  });
});

describe("bytes as text", () => {
  test("come back, whatever their number", () => {
    for (const count of [0, 1, 2, 3, 4, 5, 63, 64, 1000]) {
      for (const fill of [(k: number) => (k * 167 + 13) % 256, () => 255, () => 0]) {
        const bytes = Uint8Array.from({ length: count }, (_, k) => fill(k));
        expect([...unpacked(packed(bytes))]).toEqual([...bytes]);
      }
    }
  });
  test("mean nothing in a script or in a page", () => expect(packed(Uint8Array.from({ length: 4000 }, (_, k) => (k * k) % 251))).not.toMatch(/["'`\\<>&$/\s]/));
});

describe("level curves", () => {
  const grid = (size: number, f: (x: number, y: number) => number): Levels => {
    const at = (k: number) => -2 + (4 * k) / (size - 1);
    return { ranges: [[-2, 2], [-2, 2]], size, values: Float64Array.from({ length: size * size }, (_, k) => f(at(k % size), at(Math.floor(k / size)))) };
  };
  test("lie where the function has the level, all around", () => {
    const ends = curveOf(grid(81, (x, y) => x * x / 4 + y * y), 0.5);
    const off = ends.flatMap((x, k) => (k % 2 ? [] : [Math.abs(x * x / 4 + ends[k + 1] ** 2 - 0.5)]));
    // a chord is off by the second derivative times the square of the step over eight
    expect(Math.max(...off)).toBeLessThan((2 * 0.05 ** 2) / 8);
    const angles = ends.flatMap((x, k) => (k % 2 ? [] : [Math.atan2(2 * ends[k + 1], x)])).sort((a, b) => a - b);
    expect(Math.max(...angles.map((angle, k) => angle - (angles[k - 1] ?? -Math.PI)))).toBeLessThan(0.1);
  });
  test("pass a saddle on the side of its level", () => {
    const saddle = grid(2, (x, y) => x * y);
    // above the saddle the curve goes around the corners where x and y have one sign
    for (const [level, sign] of [[0.1, 1], [-0.1, -1]]) {
      const ends = curveOf(saddle, level);
      expect(ends).toHaveLength(8);
      for (const k of [0, 4]) expect(Math.sign((ends[k] + ends[k + 2]) * (ends[k + 1] + ends[k + 3]))).toBe(sign);
    }
  });
  test("leave out where there is no number", () => expect(curveOf(grid(9, () => NaN), 0)).toEqual([]));
});

describe("what is handed on", () => {
  const page = `<html><body><p>one</p><script>"</body>"</script></body></html>`;
  test("a page as one file opens with the state, however often it is saved", () => {
    const once = pageWith(page, "v=1&name=</script><b>");
    expect(once).toContain('<script type="text/plain" id="address">v=1&name=%3C/script>%3Cb></script>\n</body></html>');
    expect(pageWith(once.replace("<!doctype html>\n", ""), "v=2").match(/id="address"/g)).toHaveLength(1);
  });
  test("a line for another page is no markup but its own", () => {
    expect(fromStart("v=1&preset=sticky&t=12.5&speed=2")).toBe("v=1&preset=sticky&t=0&speed=2");
    expect(fromStart("v=1&start=1,2")).toBe("v=1&start=1,2");
    expect(frameLine('https://a.b/?embed=1#v=1&x="<b>', '"><script>')).toMatch(/^<iframe src="https:\/\/a\.b\/\?embed=1#v=1&amp;x=&quot;&lt;b>" title="&quot;>&lt;script>" width="100%" /);
  });
  test("the code of an address is read back", () => {
    const text = "https://example.org/laboratory/#v=1&own=1&bracket=canonical&H=p_x^2/2";
    const { size, path } = codeOf(text)!;
    const pixels = new Uint8Array((4 * size) ** 2 * 4).fill(255);
    for (const [, x, y] of path.matchAll(/M(\d+) (\d+)/g)) {
      for (let i = 0; i < 16; i++) pixels.fill(0, 4 * ((4 * Number(y) + (i >> 2)) * 4 * size + 4 * Number(x) + (i & 3)), 4 * ((4 * Number(y) + (i >> 2)) * 4 * size + 4 * Number(x) + (i & 3)) + 3);
    }
    expect(decodeQR({ width: 4 * size, height: 4 * size, data: pixels })).toBe(text);
    expect(codeOf("x".repeat(3000))).toBeNull();
  });
});

describe("tables and pictures", () => {
  test("a table says what it is of, and leaves out what is not known", () => {
    const text = csv(facts(begun("charged")), { what: "of a test", columns: ["t", "x"], rows: [[1, 2.5], [2, NaN]] });
    expect(text).toMatch(/^# of a test\n# liepoisson \d/);
    expect(text).toContain("I2 = 3/2");
    expect(text.endsWith("\nt,x\n1,2.5\n2,\n")).toBe(true);
  });
  test("names and words of a table may hold any character", () => {
    const text = csv(["system: one\ntwo"], { what: "w", columns: ["a,b", 'say "x"'], rows: [["chaotic", 1]] });
    expect(text).toBe('# w\n# system: one\n# two\n"a,b","say ""x"""\nchaotic,1\n');
  });
  test("text in a picture is never markup", () => {
    const context = new SvgContext({} as CanvasRenderingContext2D);
    context.fillText("<b>&", 1, 2);
    expect(context.document(1, 1, "#fff", '"<', "&")).toContain(">&lt;b&gt;&amp;</text>");
    expect(context.document(1, 1, "#fff", '"<', "&")).toContain("<title>&quot;&lt;</title>");
  });
  test("what is clipped is clipped until it is restored", () => {
    const context = new SvgContext({} as CanvasRenderingContext2D);
    context.save();
    context.rect(0, 0, 5, 5);
    context.clip();
    context.fillRect(1, 1, 2, 2);
    context.restore();
    context.fillRect(3, 3, 4, 4);
    const lines = context.document(9, 9, "#fff", "", "").split("\n");
    expect(lines.find((line) => line.includes('x="1"'))).toContain("clip-path");
    expect(lines.find((line) => line.includes('x="3"'))).not.toContain("clip-path");
  });
});
