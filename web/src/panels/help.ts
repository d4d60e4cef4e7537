/** Keys, and what the charts do not prove. */

const KEYS: readonly (readonly [string, string])[] = [
  ["space", "play or pause"],
  ["← →", "one step back or forth"],
  ["+ −", "faster, slower"],
  ["R", "start again"],
  ["1 … 8", "presets"],
  ["F", "next view: space, body, angular momentum, rod"],
  ["G", "shadow top"],
  ["T", "theme: automatic, light, dark, projector"],
  ["S", "copy the address of this state"],
  ["P", "copy the lines of Python that compute it"],
  ["shift ← → ↑ ↓", "turn the view"],
  ["H", "guided tours"],
  ["← → and Enter in the section", "choose a crossing and start there"],
];

const WORDS: readonly (readonly [string, string])[] = [
  ["Section", "Crossings of a surface, in two components. With more than two degrees of freedom this is a projection, and a projection is a cloud even where the motion is regular."],
  ["Exponent", "The growth of a small distance per unit of time, up to that time. It tends to zero for a regular orbit, as slowly as the logarithm of time over time; a finite run proves neither order nor chaos."],
  ["Drift", "Distance of each invariant from its value at the start: what rounding and the tolerance have done. A shadow that parts company says that single states are no longer known, though the invariants are."],
  ["Body", "The ellipsoid of inertia. Balls outside it show the directions of the centres of mass and charge. Vectors are drawn to fit, one scale for the angular momentum and one for both fields."],
  ["Ellipsoid", "Angular momenta in the body: those of the present kinetic energy, and those of the present length. Of a body that no field turns both stand still, and the polhode is where they meet."],
  ["Rod", "The orbit as the shape of an elastic rod, arclength for time; the view keeps the last 30 units of length. Its stripes turn with the body. It is a rod in equilibrium if both centres lie on the third axis."],
  ["Conserved", "Energy and Casimirs can be entered: the start moves to the nearest state that has them, by Newton's method, and the others keep their values."],
];

export function fillHelp(dialog: HTMLDialogElement): void {
  const heading = Object.assign(document.createElement("h2"), { id: "keys-h", textContent: "Keys and charts", tabIndex: -1 });
  const form = Object.assign(document.createElement("form"), { method: "dialog" });
  form.append(Object.assign(document.createElement("button"), { textContent: "Close" }));
  dialog.append(heading, list(KEYS, true), list(WORDS, false), form);
}

/** Opens the help at its head; a dialog that is left to itself gives the focus to its last line.  A page in a frame has no `autofocus`. */
export function openHelp(dialog: HTMLDialogElement): void {
  dialog.showModal();
  dialog.querySelector("h2")?.focus();
  dialog.scrollTop = 0;
}

function list(pairs: readonly (readonly [string, string])[], keys: boolean): HTMLElement {
  const found = document.createElement("dl");
  for (const [term, words] of pairs) {
    const name = document.createElement("dt");
    name.append(Object.assign(document.createElement(keys ? "kbd" : "b"), { textContent: term }));
    found.append(name, Object.assign(document.createElement("dd"), { textContent: words }));
  }
  return found;
}
