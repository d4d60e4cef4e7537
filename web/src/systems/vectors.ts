/** Vectors of three components. */

/** Names of the vectors: what their components have in common. */
export function vectorNames(components: readonly string[]): readonly string[] {
  return components.flatMap((name, k) => {
    if (k % 3) return [];
    const others = components.slice(k, k + 3);
    let length = 0;
    while (length < name.length && others.every((other) => other[length] === name[length])) length += 1;
    return [name.slice(0, length).replace(/[._]$/, "") || `${others.join(", ")}`];
  });
}
