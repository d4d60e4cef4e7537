/** Keys of the page of a system, and what the charts do not prove. */

import { MANY_ORBITS, ZOOM, type Help } from "../panels/help";

const KEYS: Help["keys"] = [
  ["space", "play or pause"],
  ["← →", "one step back or forth"],
  ["+ −", "faster, slower"],
  ["R", "start again"],
  ["1 … 4", "views"],
  ["T", "theme: automatic, light, dark, projector"],
  ["S", "copy the address of this state"],
  ["E", "hand this state on: address, code, a line for another page, a file"],
  ["P", "of a system that is typed, copy the lines of Python that compute it"],
  ["H", "guided tours"],
  ["shift ← → ↑ ↓", "turn the view"],
  ["← → and Enter in the section", "choose an orbit and follow it; of one orbit, a crossing"],
  ZOOM,
  ["↑ ↓ in an entry", "change its last digit"],
];

const WORDS: Help["words"] = [
  ["Section", "Crossings of a surface, in two components. With more than two degrees of freedom this is a projection, and a projection is a cloud even where the motion is regular."],
  MANY_ORBITS,
  ["Exponent", "The growth of a small distance per unit of time, up to that time. It tends to zero for a regular orbit, as slowly as the logarithm of time over time; a finite run proves neither order nor chaos. The band is that of starts along this orbit."],
  ["Drift", "Distance of each invariant from its value at the start: what rounding and the tolerance have done."],
  ["Angles", "They are kept as they grow, and drawn within one turn: a line ends at its end and goes on at its beginning. A section by an angle is taken modulo a turn."],
  ["Time", "Of a Hamiltonian that repeats itself in time, t is drawn within a period, and its section is the stroboscopic map. The energy is not conserved; its sum with the momentum of time is."],
  ["Scales", "Vectors are drawn to fit, each with one scale for the orbit. In a projection, components that vary much less than the others are stretched."],
];

export const HELP: Help = { keys: KEYS, words: WORDS };
