/** Numbers as they were written, so that 1/3 stays 1/3, with the double nearest to them. */

export interface Exact {
  readonly text: string;
  readonly value: number;
}

/** No parameter of a top is larger, and no text longer: what is beyond is a mistake. */
export const LARGEST = 1e6;
const LONGEST = 64;

const DECIMAL = /^[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?$/;
const FRACTION = /^([+-]?\d+)\/(\d+)$/;

/** A text that is no number, or none that is allowed. */
export class NotANumber extends Error {}

/**
 * Reads "2", "-0.25", "1e-3", "1/3"; a minus sign may be the typographical one.
 *
 * A fraction is divided in doubles, which is its nearest double as long as numerator and denominator are exact; others
 * are refused.
 */
export function exact(written: string): Exact {
  const text = written.trim().replaceAll("−", "-");
  if (text.length > LONGEST) throw new NotANumber(`a number has at most ${LONGEST} characters`);
  const value = valueOf(text);
  if (value === null) throw new NotANumber(`"${text}" is not a number; write for example 2, 0.5 or 1/3`);
  if (!(Math.abs(value) <= LARGEST)) throw new NotANumber(`"${text}" is too large; at most ${LARGEST}`);
  return { text, value };
}

/** The double that a text says; null where it is no number. */
export function valueOf(text: string): number | null {
  if (DECIMAL.test(text)) return Number(text);
  const parts = FRACTION.exec(text);
  if (!parts) return null;
  const [above, below] = [Number(parts[1]), Number(parts[2])];
  if (!Number.isSafeInteger(above) || !Number.isSafeInteger(below)) throw new NotANumber(`"${text}" has too many digits`);
  if (below === 0) throw new NotANumber(`"${text}" divides by zero`);
  return above / below;
}

/** A double with the shortest text that gives it back. */
export function shortest(value: number): Exact {
  return exact(String(Object.is(value, -0) ? 0 : value));
}

/** A decimal text with its last digit so much higher, or a fraction with its numerator; null where it is none. */
export function nudged(written: string, by: number): string | null {
  const text = written.trim().replaceAll("−", "-");
  const fraction = /^(-?\d{1,9})(\/\d{1,9})$/.exec(text);
  if (fraction) return `${Number(fraction[1]) + by}${fraction[2]}`.replace("-", "−");
  const digits = /^-?\d*(?:\.(\d*))?$/.exec(text);
  if (!digits || !/\d/.test(text) || text.length > 12) return null;
  const places = digits[1]?.length ?? 0;
  const next = (Number(text) + by * 10 ** -places).toFixed(places);
  return (Number(next) === 0 ? next.replace("-", "") : next).replace("-", "−");
}
