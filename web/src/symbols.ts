/** How components, parameters and invariants are written: ℓ₁, α₂, ε, C₁. */

const LETTERS: Readonly<Record<string, string>> = { l: "ℓ", alpha: "α", beta: "β", epsilon: "ε", gamma: "γ", theta: "θ", phi: "φ", psi: "ψ", omega: "ω" };

export interface Symbolic {
  readonly letter: string;
  readonly index: string;
}

export function symbol(name: string): Symbolic {
  const parts = /^([A-Za-z]+)(\d*)(.*)$/.exec(name);
  if (!parts) return { letter: name, index: "" };
  if (parts[3].startsWith(".")) return { letter: name.split(".").map((part) => LETTERS[part] ?? part).join("·"), index: "" };
  // what goes on after its number, as c1m1 of the mode (1, -1), keeps its order
  if (parts[2] && /^\w/.test(parts[3])) return { letter: name, index: "" };
  return { letter: (LETTERS[parts[1]] ?? parts[1]) + parts[3].replace("'", "′"), index: parts[2] };
}

const SUBSCRIPTS = "₀₁₂₃₄₅₆₇₈₉";

/** In plain text, for lists and names that are read aloud. */
export function plain(name: string): string {
  const { letter, index } = symbol(name);
  return letter + [...index].map((digit) => SUBSCRIPTS[Number(digit)]).join("");
}

/** As an element. */
export function element(name: string): HTMLElement {
  const { letter, index } = symbol(name);
  const found = document.createElement("i");
  found.className = "symbol";
  found.append(letter);
  if (index) {
    const below = document.createElement("sub");
    below.textContent = index;
    found.append(below);
  }
  return found;
}

/** On a canvas, from the left; gives the width. */
export function draw(context: CanvasRenderingContext2D, name: string, x: number, y: number, size: number): number {
  const { letter, index } = symbol(name);
  context.font = `italic ${size}px "STIX Two Text", serif`;
  context.fillText(letter, x, y);
  let width = context.measureText(letter).width;
  if (index) {
    context.font = `${size * 0.68}px "STIX Two Text", serif`;
    context.fillText(index, x + width, y + size * 0.22);
    width += context.measureText(index).width;
  }
  return width;
}
