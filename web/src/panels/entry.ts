/** Entries of exact numbers. */

import { exact, nudged, type Exact } from "../state/exact";
import { plain } from "../symbols";

/** An entry of a number that has a name; what is none is refused, and stays. */
export function exactEntry(name: string, set: (to: Exact) => void, refuse: (message: string) => void): HTMLInputElement {
  const input = document.createElement("input");
  Object.assign(input, { type: "text", autocomplete: "off", spellcheck: false, maxLength: 40 });
  input.setAttribute("aria-label", `${plain(name)}, exact value`);
  input.addEventListener("change", () => {
    try {
      set(exact(input.value));
      // a message about what was here goes with it
      if (input.hasAttribute("aria-invalid")) refuse("");
      input.removeAttribute("aria-invalid");
    } catch (error) {
      input.setAttribute("aria-invalid", "true");
      refuse(`${plain(name)}: ${(error as Error).message}`);
    }
  });
  stepsByArrows(input);
  return input;
}

/** Lets the arrow keys change the last digit of a decimal number, or the numerator of a fraction. */
export function stepsByArrows(input: HTMLInputElement): void {
  input.addEventListener("keydown", (event) => {
    const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const next = by ? nudged(input.value, by) : null;
    if (next === null) return;
    event.preventDefault();
    input.value = next;
    for (const kind of ["input", "change"]) input.dispatchEvent(new Event(kind, { bubbles: true }));
  });
}
