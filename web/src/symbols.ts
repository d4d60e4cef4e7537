/** How components, parameters and invariants are written: ℓ₁, α₂, ε, C₁. */

const LETTERS: Readonly<Record<string, string>> = { l: "ℓ", alpha: "α", beta: "β", epsilon: "ε", gamma: "γ", theta: "θ", phi: "φ", psi: "ψ", omega: "ω" };

export interface Symbolic {
  readonly letter: string;
  readonly index: string;
}

export function symbol(name: string): Symbolic {
  // the momentum of theta is p_theta
  const below = /^([A-Za-z]+)_([A-Za-z]+)(\d*)$/.exec(name);
  if (below) return { letter: LETTERS[below[1]] ?? below[1], index: (LETTERS[below[2]] ?? below[2]) + below[3] };
  const parts = /^([A-Za-z]+)(\d*)(.*)$/.exec(name);
  if (!parts) return { letter: name, index: "" };
  if (parts[3].startsWith(".")) return { letter: name.split(".").map((part) => LETTERS[part] ?? part).join("·"), index: "" };
  // what goes on after its number, as c1m1 of the mode (1, -1), keeps its order
  if (parts[2] && /^\w/.test(parts[3])) return { letter: name, index: "" };
  return { letter: (LETTERS[parts[1]] ?? parts[1]) + parts[3].replace("'", "′"), index: parts[2] };
}

/** Names within a text, such as H + p_t and rate of p_x, and the words between them. */
function symbols(name: string): Symbolic[] {
  const parts = name.split(/(^rate of | \+ )/).filter(Boolean);
  return parts.map((part) => (part.endsWith(" ") ? { letter: part, index: "" } : symbol(part)));
}

const SUBSCRIPTS = "₀₁₂₃₄₅₆₇₈₉";

/** In plain text, for lists and names that are read aloud. */
export function plain(name: string): string {
  const below = (index: string) => (/^\d*$/.test(index) ? [...index].map((digit) => SUBSCRIPTS[Number(digit)]).join("") : `_${index}`);
  return symbols(name).map(({ letter, index }) => letter + below(index)).join("");
}

/** As an element. */
export function element(name: string): HTMLElement {
  const found = document.createElement("i");
  found.className = "symbol";
  for (const { letter, index } of symbols(name)) {
    found.append(letter);
    if (!index) continue;
    const below = document.createElement("sub");
    below.textContent = index;
    found.append(below);
  }
  return found;
}

/** Least size of a subscript, in pixels. */
const SMALLEST = 11;

/** On a canvas, from the left; gives the width. */
export function draw(context: CanvasRenderingContext2D, name: string, x: number, y: number, size: number): number {
  let width = 0;
  for (const { letter, index } of symbols(name)) {
    context.font = `italic ${size}px "STIX Two Text", serif`;
    context.fillText(letter, x + width, y);
    width += context.measureText(letter).width;
    if (!index) continue;
    context.font = `${Math.max(size * 0.68, SMALLEST)}px "STIX Two Text", serif`;
    context.fillText(index, x + width, y + size * 0.22);
    width += context.measureText(index).width;
  }
  return width;
}
