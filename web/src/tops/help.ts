/** Keys of the page of tops, and what its charts do not prove. */

import { MANY_ORBITS, ZOOM, type Help } from "../panels/help";

const KEYS: Help["keys"] = [
  ["space", "play or pause"],
  ["← →", "one step back or forth"],
  ["+ −", "faster, slower"],
  ["R", "start again"],
  ["1 … 8", "presets"],
  ["F", "next view: space, body, angular momentum, rod"],
  ["G", "shadow top"],
  ["T", "theme: automatic, light, dark, projector"],
  ["S", "copy the address of this state"],
  ["E", "hand this state on: address, code, a line for another page, a file"],
  ["P", "copy the lines of Python that compute it"],
  ["shift ← → ↑ ↓", "turn the view"],
  ["H", "guided tours"],
  ["← → and Enter in the section", "choose a crossing and start there; of many orbits, one to follow"],
  ZOOM,
  ["↑ ↓ in an entry", "change its last digit"],
];

const WORDS: Help["words"] = [
  ["Section", "Crossings of a surface, in two components. With more than two degrees of freedom this is a projection, and a projection is a cloud even where the motion is regular."],
  MANY_ORBITS,
  ["Exponent", "The growth of a small distance per unit of time, up to that time. It tends to zero for a regular orbit, as slowly as the logarithm of time over time; a finite run proves neither order nor chaos."],
  ["Drift", "Distance of each invariant from its value at the start: what rounding and the tolerance have done. A shadow that parts company says that single states are no longer known, though the invariants are."],
  ["Body", "The ellipsoid of inertia. Balls outside it show the directions of the centres of mass and charge. Vectors are drawn to fit, one scale for the angular momentum and one for both fields."],
  ["Ellipsoid", "Angular momenta in the body: those of the present kinetic energy, and those of the present length. Of a body that no field turns both stand still, and the polhode is where they meet."],
  ["Rod", "The orbit as the shape of an elastic rod, arclength for time; the view keeps the last 30 units of length. Its stripes turn with the body. It is a rod in equilibrium if both centres lie on the third axis."],
  ["Conserved", "Energy and Casimirs can be entered: the start moves to the nearest state that has them, by Newton's method, and the others keep their values."],
];

export const HELP: Help = { keys: KEYS, words: WORDS };
