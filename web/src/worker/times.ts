/** When exponents are known: eight times in each doubling. */

const PER_DOUBLING = 8;

/** The length of an interval, after so many of them. */
export function interval(done: number): number {
  const doubling = Math.floor(done / PER_DOUBLING);
  return (doubling === 0 ? 1 : 2 ** (doubling - 1)) / PER_DOUBLING;
}

/** All times up to the first that reaches the horizon. */
export function exponentTimes(horizon: number): number[] {
  const times: number[] = [];
  for (let time = 0; time < horizon; times.push(time)) time += interval(times.length);
  return times;
}
