/** A tour: plain data that a teacher writes.  A text is read by the schema and never run; what it says is shown as text. */

import { Refused } from "../state/everyday";
import { mismatch, type Schema } from "./schema";
import schema from "./tour.schema.json";

export interface Step {
  readonly title: string;
  readonly words: string;
  /** The panel at which it points. */
  readonly at: string;
  /** The state of the laboratory, as an address has it. */
  readonly state: string;
}

export interface Tour {
  readonly title: string;
  readonly about: string;
  /** The system whose page it is for; that of tops where there is none. */
  readonly system?: string;
  readonly steps: readonly Step[];
}

export const LONGEST = 64_000;

/** Throws `Refused` with a message that says what is wrong. */
export function tourOf(text: string): Tour {
  if (text.length > LONGEST) throw new Refused(`it is too long: ${text.length} characters, at most ${LONGEST}`);
  let data: unknown;
  try {
    data = JSON.parse(text);
  } catch (error) {
    throw new Refused(`it is no JSON: ${(error as Error).message.slice(0, 120)}`);
  }
  const wrong = mismatch(data, schema as unknown as Schema, "the tour");
  if (wrong) throw new Refused(wrong);
  return data as Tour;
}

/** The state of a step, without what stands before the `#` of an address. */
export function addressOf({ state }: Step): string {
  return state.slice(state.indexOf("#") + 1);
}

/** Calls a reader with the address of each step; throws `Refused` with the number of the one that it refuses. */
export function checkSteps({ steps }: Tour, read: (address: string) => unknown): void {
  steps.forEach((step, k) => {
    try {
      read(addressOf(step));
    } catch (error) {
      throw new Refused(`the state of step ${k + 1} cannot be shown: ${(error as Error).message}`);
    }
  });
}
