/** Keys of the page of a system, and what the charts do not prove. */

const KEYS: readonly (readonly [string, string])[] = [
  ["space", "play or pause"],
  ["← →", "one step back or forth"],
  ["+ −", "faster, slower"],
  ["R", "start again"],
  ["1 … 4", "views"],
  ["T", "theme: automatic, light, dark, projector"],
  ["S", "copy the address of this state"],
  ["H", "guided tours"],
  ["shift ← → ↑ ↓", "turn the view"],
  ["← → and Enter in the section", "choose an orbit and follow it; of one orbit, a crossing"],
];

const WORDS: readonly (readonly [string, string])[] = [
  ["Section", "Crossings of a surface, in two components. With more than two degrees of freedom this is a projection, and a projection is a cloud even where the motion is regular."],
  ["Many orbits", "They have the energy and the Casimirs of the start. Dots are regular, crosses chaotic, squares undecided: the rule of the Python function decide, after a thousand natural times. It errs, most of all on orbits that have hardly begun to be chaotic by then."],
  ["Exponent", "The growth of a small distance per unit of time, up to that time. It tends to zero for a regular orbit, as slowly as the logarithm of time over time; a finite run proves neither order nor chaos. The band is that of starts along this orbit."],
  ["Drift", "Distance of each invariant from its value at the start: what rounding and the tolerance have done."],
  ["Angles", "They are kept as they grow, and drawn within one turn: a line ends at its end and goes on at its beginning. A section by an angle is taken modulo a turn."],
  ["Time", "Of a Hamiltonian that repeats itself in time, t is drawn within a period, and its section is the stroboscopic map. The energy is not conserved; its sum with the momentum of time is."],
  ["Scales", "Vectors are drawn to fit, each with one scale for the orbit. In a projection, components that vary much less than the others are stretched."],
];

export function fillHelp(dialog: HTMLDialogElement): void {
  const heading = Object.assign(document.createElement("h2"), { id: "keys-h", textContent: "Keys and charts", tabIndex: -1 });
  const form = Object.assign(document.createElement("form"), { method: "dialog" });
  form.append(Object.assign(document.createElement("button"), { textContent: "Close" }));
  dialog.append(heading, list(KEYS, "kbd"), list(WORDS, "b"), form);
}

function list(pairs: readonly (readonly [string, string])[], tag: string): HTMLElement {
  const found = document.createElement("dl");
  for (const [term, words] of pairs) {
    const name = document.createElement("dt");
    name.append(Object.assign(document.createElement(tag), { textContent: term }));
    found.append(name, Object.assign(document.createElement("dd"), { textContent: words }));
  }
  return found;
}
