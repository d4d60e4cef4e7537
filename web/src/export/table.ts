/** What a chart shows, as comma-separated values: lines that begin with # say what it is of. */

export interface Table {
  /** What the rows are. */
  readonly what: string;
  readonly columns: readonly string[];
  /** A number that is not known is NaN, and left empty. */
  readonly rows: readonly (readonly (number | string)[])[];
}

/** `facts` are lines that say of what the table is. */
export function csv(facts: readonly string[], { what, columns, rows }: Table): string {
  const head = [what, ...facts].flatMap((text) => text.split(/\r?\n/)).map((line) => `# ${line}`);
  return [...head, columns.map(cell).join(","), ...rows.map((row) => row.map(cell).join(",")), ""].join("\n");
}

/** A name may hold any character. */
function cell(value: number | string): string {
  if (typeof value === "number") return Number.isNaN(value) ? "" : String(value);
  return /[",\r\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value;
}
