/** Level curves of a function that is known on a grid, as short lines: marching squares, with the middle of a square to decide. */

export interface Levels {
  /** What the grid covers, of the first and of the second component. */
  readonly ranges: readonly (readonly [number, number])[];
  /** Points of the grid in each direction. */
  readonly size: number;
  /** (second component, first component). */
  readonly values: Float64Array;
}

/** Curves between which there is as much of the plane. */
const CURVES = 16;

export function chosenLevels({ values }: Levels): number[] {
  const known = values.filter(Number.isFinite).sort();
  const chosen = Array.from({ length: CURVES }, (_, k) => known[Math.floor(((k + 0.5) / CURVES) * known.length)]);
  return known.length ? [...new Set(chosen)] : [];
}

/** Ends of the lines of one level, x, y, x, y, ..., as values of the two components. */
export function curveOf({ ranges, size, values }: Levels, level: number): number[] {
  const found: number[] = [];
  const place = (k: number, at: number) => ranges[k][0] + ((ranges[k][1] - ranges[k][0]) * at) / (size - 1);
  for (let row = 0; row + 1 < size; row++) {
    for (let column = 0; column + 1 < size; column++) {
      // around the square
      const corners = [values[row * size + column], values[row * size + column + 1], values[(row + 1) * size + column + 1], values[(row + 1) * size + column]];
      if (!corners.every(Number.isFinite)) continue;
      const points: [number, number][] = [];
      corners.forEach((value, k) => {
        const next = corners[(k + 1) % 4];
        if (value < level === next < level) return;
        const part = (level - value) / (next - value);
        points.push([[column + part, row], [column + 1, row + part], [column + 1 - part, row + 1], [column, row + 1 - part]][k] as [number, number]);
      });
      // of four points neighbours belong together, those around the corners that the middle is not like
      const middle = corners.reduce((sum, value) => sum + value, 0) / 4;
      if (points.length === 4 && middle < level !== corners[0] < level) points.push(points.shift() as [number, number]);
      for (let k = 0; k + 1 < points.length; k += 2) found.push(...[points[k], points[k + 1]].flatMap(([x, y]) => [place(0, x), place(1, y)]));
    }
  }
  return found;
}
