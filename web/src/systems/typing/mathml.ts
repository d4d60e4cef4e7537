/** Expressions of the core as MathML, made element by element: no text becomes markup. */

import type { Written } from "../../core/core.js";
import { symbol } from "../../symbols";

const MATH = "http://www.w3.org/1998/Math/MathML";

function make(name: string, ...content: (Node | string)[]): Element {
  const found = document.createElementNS(MATH, name);
  found.append(...content);
  return found;
}

/** A formula; `spoken` is read aloud where there is no MathML. */
export function math(...content: Element[]): Element {
  const found = make("math", make("mrow", ...content));
  found.setAttribute("displaystyle", "true");
  return found;
}

export const sign = (text: string) => make("mo", text);

/** A name: a letter and what is below it. */
export function name(text: string): Element {
  const { letter, index } = symbol(text);
  const base = make("mi", letter);
  if (!index) return base;
  const below = make(/^\d+$/.test(index) ? "mn" : "mi", index);
  below.setAttribute("class", "small");
  return make("msub", base, below);
}

/** The rate of change of a coordinate: with a dot, on the letter alone where something is below it. */
export function rate(text: string): Element {
  const { letter, index } = symbol(text);
  const dot = sign(".");
  // that of a period has its place in every font; it is no separator here
  for (const side of ["lspace", "rspace"]) dot.setAttribute(side, "0");
  const dotted = make("mover", make("mi", letter), dot);
  if (!index) return dotted;
  const below = make(/^\d+$/.test(index) ? "mn" : "mi", index);
  below.setAttribute("class", "small");
  return make("msub", dotted, below);
}

/** {x, y}. */
export function pair(first: string, second: string): Element[] {
  return [sign("{"), name(first), sign(","), name(second), sign("}")];
}

function bracketed(inner: Element): Element {
  return make("mrow", sign("("), inner, sign(")"));
}

/** An expression. */
export function expression(written: Written): Element {
  if (typeof written === "string") return name(written);
  const [what, ...parts] = written;
  switch (what) {
    case "number":
      return number(parts[0] as string);
    case "+":
      return sum(parts[0] as [string, Written][]);
    case "/":
      return quotient(parts[0] as Written[], parts[1] as Written[]);
    case "^":
      return power(parts[0] as Written, parts[1] as Written);
    case "sqrt":
      return make("msqrt", expression(parts[0] as Written));
    default:
      return called(what, parts[0] as Written[]);
  }
}

function number(text: string): Element {
  if (text === "pi") return make("mi", "π");
  const [above, below] = text.replace(/^-/, "").split("/");
  const size = below === undefined ? make("mn", above) : make("mfrac", make("mn", above), make("mn", below));
  return text.startsWith("-") ? make("mrow", sign("−"), size) : size;
}

function sum(terms: readonly [string, Written][]): Element {
  const parts = terms.flatMap(([before, term], k) => [...(k === 0 && before === "+" ? [] : [sign(before === "-" ? "−" : "+")]), expression(term)]);
  return make("mrow", ...parts);
}

function quotient(over: readonly Written[], under: readonly Written[]): Element {
  return under.length ? make("mfrac", product(over, under.length > 0), product(under, true)) : product(over, false);
}

/** Factors beside one another; in a fraction one alone needs no brackets. */
function product(factors: readonly Written[], isAlone: boolean): Element {
  if (factors.length === 1 && isAlone) return expression(factors[0]);
  const inOrder = [...factors.filter(isNumber), ...factors.filter((factor) => !isNumber(factor))];
  const parts = inOrder.flatMap((factor, k) => {
    const inner = isSum(factor) ? bracketed(expression(factor)) : expression(factor);
    const times = k === 0 ? [] : [sign(isNumber(factor) ? "·" : "\u2062")];
    return [...times, inner];
  });
  return make("mrow", ...parts);
}

const isSum = (written: Written) => typeof written !== "string" && written[0] === "+";
const isNumber = (written: Written) => typeof written !== "string" && written[0] === "number";

function power(base: Written, exponent: Written): Element {
  const above = small(expression(exponent));
  if (typeof base !== "string" && NAMED.has(base[0])) {
    // sin² x
    return make("mrow", make("msup", make("mi", base[0]), above), sign("\u2061"), bracketed(expression((base[1] as Written[])[0])));
  }
  const isShort = typeof base === "string" || (isNumber(base) && /^\d+$/.test(base[1]));
  return make("msup", isShort ? expression(base) : bracketed(expression(base)), above);
}

const NAMED = new Set(["sin", "cos", "sinh", "cosh", "tanh"]);

/** An exponent is set small, but not too small to be read. */
function small(element: Element): Element {
  for (const one of [element, ...element.querySelectorAll("mi, mn, mo")]) one.setAttribute("class", "small");
  return element;
}

function called(what: string, inside: readonly Written[]): Element {
  const between = inside.flatMap((argument, k) => (k === 0 ? [expression(argument)] : [sign(","), expression(argument)]));
  if (what === "exp") return make("msup", make("mi", "e"), small(make("mrow", ...between)));
  return make("mrow", make("mi", what), sign("\u2061"), bracketed(make("mrow", ...between)));
}
