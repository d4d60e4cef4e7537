/** What is said of Hamiltonians that depend on time: what is conserved, and what does not apply. */

import { withoutTime, type SystemDescription } from "./description";

/** Whether time is a point of a circle: the Hamiltonian repeats itself. */
function isPeriodic({ clock, turns }: SystemDescription): boolean {
  return clock !== null && turns[clock] !== null;
}

/** Whether a section is the stroboscopic map. */
export function isStroboscopic(system: SystemDescription, surface: number): boolean {
  return surface === system.clock && isPeriodic(system);
}

/** Why a section says little; null where it does not. */
export function aboutSurface(system: SystemDescription, surface: number): string | null {
  if (surface !== system.clock || isPeriodic(system)) return null;
  return "Time has no period here, so there is no stroboscopic map: t = 0 is one moment. Choose another surface.";
}

/** What the energy does; null where it is conserved. */
export function aboutEnergy({ clock }: SystemDescription): string | null {
  return clock === null ? null : "H depends on time and is not conserved; its sum with the momentum of time is. That momentum falls by the energy that the drive gives.";
}

/** How many components there are, and how the system is driven. */
export function counted(system: SystemDescription): string {
  const n = withoutTime(system).length;
  const count = `${n} component${n > 1 ? "s" : ""}`;
  if (system.clock === null) return count;
  return isPeriodic(system) ? `${count}, driven with the period ${system.surfaces[system.clock].modulus}` : `${count}, driven`;
}
