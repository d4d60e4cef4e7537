/** Keys, and what the charts do not prove. */

type Pairs = readonly (readonly [string, string])[];

export interface Help {
  readonly keys: Pairs;
  /** Charts, and what is said of them. */
  readonly words: Pairs;
}

/** What is said of a section of many orbits. */
export const MANY_ORBITS: Pairs[number] = ["Many orbits", "They have the energy and the Casimirs of the start, and are a sample: another start of the same energy leads to others, and to other numbers of them. Dots are regular, crosses chaotic, squares undecided: the rule of the Python function decide, after a thousand natural times. It errs, most of all on orbits that have hardly begun to be chaotic by then."];

/** Keys of a chart that has the focus. */
export const ZOOM: Pairs[number] = ["+ − 0 in the section", "see less or more of it, or all; so do the wheel and two fingers, and a drag moves what is seen"];

export function fillHelp(dialog: HTMLDialogElement, { keys, words }: Help): void {
  const heading = Object.assign(document.createElement("h2"), { id: "keys-h", textContent: "Keys and charts", tabIndex: -1 });
  const form = Object.assign(document.createElement("form"), { method: "dialog" });
  form.append(Object.assign(document.createElement("button"), { textContent: "Close" }));
  dialog.replaceChildren(heading, list(keys, true), list(words, false), form);
}

/** Opens the help at its head; a dialog that is left to itself gives the focus to its last line.  A page in a frame has no `autofocus`. */
export function openHelp(dialog: HTMLDialogElement): void {
  dialog.showModal();
  dialog.querySelector("h2")?.focus();
  dialog.scrollTop = 0;
}

function list(pairs: Pairs, keys: boolean): HTMLElement {
  const found = document.createElement("dl");
  for (const [term, words] of pairs) {
    const name = document.createElement("dt");
    name.append(Object.assign(document.createElement(keys ? "kbd" : "b"), { textContent: term }));
    found.append(name, Object.assign(document.createElement("dd"), { textContent: words }));
  }
  return found;
}
