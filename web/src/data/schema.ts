/** Data from a file against a schema, in the part of JSON Schema that `tour.schema.json` is written in. */

export interface Schema {
  /** What one of it is called. */
  readonly title?: string;
  readonly type?: string;
  readonly const?: unknown;
  readonly enum?: readonly unknown[];
  readonly required?: readonly string[];
  readonly properties?: Readonly<Record<string, Schema>>;
  readonly items?: Schema;
  readonly minLength?: number;
  readonly maxLength?: number;
  readonly minItems?: number;
  readonly maxItems?: number;
}

/** Characters that would draw a text in another order or place than it is written. */
const UNSEEN = /[\u0000-\u001f\u007f-\u009f\u202a-\u202e\u2066-\u2069]/;

/** What is wrong with a value, as a sentence; null where nothing is.  `where` names it. */
export function mismatch(value: unknown, schema: Schema, where: string): string | null {
  if (schema.const !== undefined) return value === schema.const ? null : `${where} must be ${schema.const}; got ${shown(value)}`;
  if (schema.enum) return schema.enum.includes(value) ? null : `${where} is one of ${schema.enum.join(", ")}; got ${shown(value)}`;
  if (schema.type === "string") return ofText(value, schema, where);
  if (schema.type === "array") return ofList(value, schema, where);
  return ofObject(value, schema, where);
}

function ofText(value: unknown, { minLength = 0, maxLength = Infinity }: Schema, where: string): string | null {
  if (typeof value !== "string") return `${where} must be a text; got ${shown(value)}`;
  if (value.length < minLength || value.length > maxLength) return `${where} must have ${minLength} to ${maxLength} characters; got ${value.length}`;
  return UNSEEN.test(value) ? `${where} has a control character; write the text in one line` : null;
}

function ofList(value: unknown, { items = {}, minItems = 0, maxItems = Infinity }: Schema, where: string): string | null {
  if (!Array.isArray(value)) return `${where} must be a list; got ${shown(value)}`;
  if (value.length < minItems || value.length > maxItems) return `${where} must be a list of ${minItems} to ${maxItems}; got ${value.length}`;
  return first(value.map((item, k) => () => mismatch(item, items, `${items.title ?? "item"} ${k + 1}`)));
}

function ofObject(value: unknown, { required = [], properties = {} }: Schema, where: string): string | null {
  if (typeof value !== "object" || value === null || Array.isArray(value)) return `${where} must be an object { … }; got ${shown(value)}`;
  const names = Object.keys(value);
  const unknown = names.find((name) => !Object.hasOwn(properties, name));
  if (unknown !== undefined) return `${where} has an unknown part ${shown(unknown)}; known are ${Object.keys(properties).join(", ")}`;
  const missing = required.find((name) => !names.includes(name));
  if (missing !== undefined) return `${where} has no "${missing}"`;
  return first(names.map((name) => () => mismatch((value as Record<string, unknown>)[name], properties[name], `"${name}" of ${where}`)));
}

function first(checks: readonly (() => string | null)[]): string | null {
  for (const check of checks) {
    const wrong = check();
    if (wrong) return wrong;
  }
  return null;
}

/** A value in a message, cut. */
function shown(value: unknown): string {
  if (Array.isArray(value)) return "a list";
  if (typeof value === "object" && value !== null) return "an object";
  const text = JSON.stringify(value);
  return text.length > 40 ? `${text.slice(0, 40)}…` : text;
}
