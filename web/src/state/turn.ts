/** Coordinates that are points of a circle: they are kept as they grow, and drawn within one turn. */

/** Where a turn begins and where it ends. */
export type Turn = readonly [number, number];

/** Rounding, in units of the last place, up to which the end of a turn is its beginning. */
const UNITS = 8;

/** The coordinate within its turn; one without a turn stays. */
export function within(value: number, turn: Turn | null): number {
  if (!turn || (value >= turn[0] && value <= turn[1])) return value;
  const [begin, end] = turn;
  const length = end - begin;
  const turns = (value - begin) / length;
  const nearest = Math.round(turns);
  if (Math.abs(turns - nearest) * length <= UNITS * Number.EPSILON * Math.abs(value)) return begin;
  return value - length * Math.floor(turns);
}

/**
 * Draws a path of points, `turns.length` numbers each, within the turns: it ends where a coordinate comes to the end of its
 * turn, and goes on at the other end.
 */
export function trace(
  points: readonly number[], turns: readonly (Turn | null)[], move: (point: readonly number[]) => void, line: (point: readonly number[]) => void,
  from = 0, to = points.length / turns.length - 1,
): void {
  const width = turns.length;
  const at = (k: number) => points.slice(k * width, (k + 1) * width);
  const moved = (point: readonly number[]) => point.map((value, i) => within(value, turns[i]) - value);
  const sum = (point: readonly number[], shift: readonly number[]) => point.map((value, i) => value + shift[i]);
  let before = at(from);
  let shift = moved(before);
  move(sum(before, shift));
  for (let k = from + 1; k <= to; k++) {
    const [point, next] = [at(k), moved(at(k))];
    for (const { part, axis } of ends(before, point, shift, next, turns)) {
      const cut = before.map((value, i) => value + part * (point[i] - value));
      line(sum(cut, shift));
      shift = shift.with(axis, next[axis]);
      move(sum(cut, shift));
    }
    shift = next;
    line(sum(point, shift));
    before = point;
  }
}

/** Where coordinates come to the end of their turns between two points, in order. */
function ends(before: readonly number[], point: readonly number[], shift: readonly number[], next: readonly number[], turns: readonly (Turn | null)[]) {
  const found: { part: number; axis: number }[] = [];
  turns.forEach((turn, axis) => {
    if (!turn || Math.abs(next[axis] - shift[axis]) < (turn[1] - turn[0]) / 2) return;
    const step = point[axis] - before[axis];
    const end = turn[step > 0 ? 1 : 0] - shift[axis];
    found.push({ axis, part: Math.min(Math.max((end - before[axis]) / step, 0), 1) });
  });
  return found.sort((a, b) => a.part - b.part);
}

/** The range of a coordinate along an orbit; where it has passed the end of its turn, the whole turn. */
export class Extent {
  low = Infinity;
  high = -Infinity;
  private shift: number | null = null;

  /** True if it has grown. */
  add(value: number, turn: Turn | null): boolean {
    const { low, high } = this;
    const here = within(value, turn);
    [this.low, this.high] = [Math.min(low, here), Math.max(high, here)];
    if (turn) {
      const shift = here - value;
      if (this.shift !== null && Math.abs(shift - this.shift) > (turn[1] - turn[0]) / 2) [this.low, this.high] = turn;
      this.shift = shift;
    }
    return this.low < low || this.high > high;
  }

  get range(): Turn | null {
    return this.low <= this.high ? [this.low, this.high] : null;
  }
}
