/** What is written of a state: the head of a table, and the lines of Python that compute orbit, section and exponent. */

import { components, parameters, VERSION } from "../data/tops";
import { HORIZON, type Laboratory } from "../state/laboratory";
import type { Exact } from "../state/exact";
import { written } from "../state/url";
import { exponentTimes } from "../worker/times";

/** Without zeros in front, which Python does not read. */
const bare = (text: string) => text.replace(/^\+/, "").replace(/(^-?|\/)0+(?=\d)/g, "$1");

/** An exact number of a system: a whole number, or a text. */
function entry({ text }: Exact): string {
  const written = bare(text);
  return /^-?\d+$/.test(written) ? written : `"${written}"`;
}

const tuple = (values: readonly Exact[], write: (value: Exact) => string) => `(${values.map(write).join(", ")})`;

export function asPython(lab: Laboratory): string {
  const of = (from: number) => tuple(lab.parameters.slice(from, from + 3), entry);
  const start = lab.start.map(({ text }) => bare(text).replace("/", " / ")).join(", ");
  const last = exponentTimes(HORIZON).at(-1) as number;
  return `import numpy as np
import liepoisson as lp

top = lp.Top(inertia=${of(0)}, a=${of(3)}, b=${of(6)}, epsilon=${entry(lab.parameters[9])})
start = [${start}]
method = lp.Taylor(tol=${bare(lab.method.tol.text)})

orbit = lp.integrate(top, start, times=np.linspace(0, 100, 5001), method=method)
section = lp.section(top, start, surface="${lab.surface}", direction=${lab.direction}, t_end=${HORIZON}, method=method)

# times of the chart: eight in each doubling
times = np.array([2**k * (1 + part / 8) for k in range(${Math.floor(Math.log2(last)) + 1}) for part in range(8)])
growth = lp.finite_time_exponents(top, start, times=times[times <= ${last}], tangents=np.ones(9), method=method)

print({name: values[0, 0] for name, values in orbit.invariants.items()})
print(len(section.time), "crossings; the first at t =", section.time[:3])
print("exponent", growth.exponent[0, -1], "at t =", growth.time[-1])
`;
}

/** System, start and method, each as it was entered. */
export function facts(lab: Laboratory): string[] {
  const list = (names: readonly string[], values: readonly { readonly text: string }[]) => names.map((name, k) => `${name} = ${values[k].text}`).join(", ");
  return [
    `liepoisson ${VERSION}, the laboratory; core in WebAssembly`,
    `top: ${list(parameters, lab.parameters)}`,
    `start: ${list(components, lab.start)}`,
    `method: Taylor, tol = ${lab.method.tol.text}`,
    "units: dimensionless; time in the top's own unit, exponents in its inverse",
    `address: #${written(lab)}`,
  ];
}
