/** The system as a file that the package reads, and as lines of Python. */

import type { SystemState } from "../state";
import type { Made } from "./made";
import { BRACKETS, type Draft, type Given } from "./draft";
import { LINE, words } from "./made";

/** A text between quotes of TOML, which are those of JSON. */
const quoted = (text: string) => JSON.stringify(text).replaceAll("\u007f", "\\u007f");
const list = (texts: readonly string[]) => `[${texts.map(quoted).join(", ")}]`;
const value = (given: Given) => (typeof given === "string" ? quoted(bare(given)) : list(given.map(bare)));

/** A number as Python and TOML read it: with the sign that keyboards have, and without zeros in front. */
const bare = (text: string) => text.trim().replaceAll("−", "-").replace(/^\+/, "").replace(/(^-?|\/)0+(?=\d)/g, "$1");

/** The system file. */
export function systemFile(draft: Draft, { parameters }: Made): string {
  const lines = [`name = ${quoted(draft.name || "typed")}`, "", "[bracket]", ...bracket(draft)];
  const given = Object.entries(parameters);
  if (given.length) lines.push("", "[parameters]", ...given.map(([name, one]) => `${name} = ${value(one)}`));
  return `${[...lines, "", "[hamiltonian]", `expression = ${quoted(draft.hamiltonian)}`].join("\n")}\n`;
}

function bracket({ bracket: kind, coordinates, momenta, angles, entries }: Draft): string[] {
  const turning = words(angles).length ? [`angles = ${list(words(angles))}`] : [];
  if (kind in BRACKETS) {
    const { algebra, extension, fields } = BRACKETS[kind];
    return [`algebra = ${quoted(algebra)}`, `extension = ${quoted(extension)}`, `variables = ${list(Object.keys(fields))}`];
  }
  if (kind === "canonical") {
    const names = words(coordinates);
    const own = words(momenta).length ? [`momenta = ${list(words(momenta))}`] : [];
    return [names.length === 1 && /^\d$/.test(names[0]) ? `canonical = ${names[0]}` : `canonical = ${list(names)}`, ...own, ...turning];
  }
  const tensor = entries.split("\n").flatMap((line) => {
    const [, first, second, formula] = LINE.exec(line) ?? [];
    return formula === undefined ? [] : [`tensor.${first}.${second} = ${quoted(formula)}`];
  });
  return [`variables = ${list(words(coordinates))}`, ...tensor, ...turning];
}

/** Lines of Python that write the file, and compute the orbit and the section. */
export function asPython(draft: Draft, made: Made, state: SystemState): string {
  const start = state.start.map(({ text }) => bare(text).replace("/", " / ")).join(", ");
  const surface = made.system.surfaces[state.surface].name;
  const end = 100 * made.system.unit;
  // within the quotes of Python, of the signs that TOML has only the backslash and the quotes mean something else
  const file = systemFile(draft, made).replaceAll("\\", "\\\\").replaceAll('"""', '\\"\\"\\"');
  return `from pathlib import Path

import numpy as np
import liepoisson as lp

Path("typed.toml").write_text("""\\
${file}""", encoding="utf-8")
system = lp.read_system("typed.toml")
start = [${start}]
method = lp.Taylor(tol=${bare(state.tol.text)})

orbit = lp.integrate(system, start, times=np.linspace(0, ${end}, 1001), method=method)
section = lp.section(system, start, surface="${surface}", direction=${state.direction}, t_end=${end}, method=method)
print({name: values[0, 0] for name, values in orbit.invariants.items()})
print(len(section.time), "crossings; the first at t =", section.time[:3])
`;
}
