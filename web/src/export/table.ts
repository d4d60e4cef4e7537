/** What a chart shows, as comma-separated values: lines that begin with # say what it is of. */

import { components, parameters, VERSION } from "../data/tops";
import type { Laboratory } from "../state/laboratory";
import { written } from "../state/url";

export interface Table {
  /** What the rows are. */
  readonly what: string;
  readonly columns: readonly string[];
  /** A number that is not known at a time is NaN, and left empty. */
  readonly rows: readonly (readonly number[])[];
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

export function csv(lab: Laboratory, { what, columns, rows }: Table): string {
  const number = (value: number) => (Number.isNaN(value) ? "" : String(value));
  const head = [what, ...facts(lab)].map((line) => `# ${line}`);
  return [...head, columns.join(","), ...rows.map((row) => row.map(number).join(",")), ""].join("\n");
}
