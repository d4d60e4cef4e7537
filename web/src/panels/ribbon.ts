/** A line of constant width on the screen that fades towards its past: WebGL's own lines are one pixel wide. */

import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, Mesh, ShaderMaterial, Vector2 } from "three";

const VERTEX = `
attribute vec3 before;
attribute vec3 after;
attribute float side;
attribute float part;
uniform vec2 size;
uniform float width;
varying float vPart;
varying float vSide;
void main() {
  vec4 here = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  vec4 from = projectionMatrix * modelViewMatrix * vec4(before, 1.0);
  vec4 to = projectionMatrix * modelViewMatrix * vec4(after, 1.0);
  vec2 along = (to.xy / to.w - from.xy / from.w) * size;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  here.xy += vec2(-along.y, along.x) / size * (width * mix(0.35, 1.0, part) * side * here.w);
  gl_Position = here;
  vPart = part;
  vSide = side;
}`;
const FRAGMENT = `
uniform vec3 colour;
uniform float strength;
varying float vPart;
varying float vSide;
void main() {
  float edge = smoothstep(1.0, 0.55, abs(vSide));
  gl_FragColor = vec4(colour, strength * edge * pow(vPart, 1.3));
  #include <colorspace_fragment>
}`;

/** Corners of the two triangles between a point and the next; and of what is not seen. */
const QUAD = [0, 1, 2, 1, 3, 2];
const NOTHING = [0, 0, 0, 0, 0, 0];
const NONE: ReadonlySet<number> = new Set();

export class Ribbon extends Mesh<BufferGeometry, ShaderMaterial> {
  constructor(private readonly most: number, width: number) {
    const geometry = new BufferGeometry();
    for (const [name, items] of [["position", 3], ["before", 3], ["after", 3], ["side", 1], ["part", 1]] as const) {
      const attribute = new BufferAttribute(new Float32Array(2 * most * items), items);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    const side = geometry.getAttribute("side").array as Float32Array;
    for (let k = 0; k < side.length; k++) side[k] = k % 2 ? 1 : -1;
    const index = [];
    for (let k = 0; k < most - 1; k++) index.push(...QUAD.map((corner) => 2 * k + corner));
    geometry.setIndex(index);
    (geometry.getIndex() as BufferAttribute).setUsage(DynamicDrawUsage);
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: 2,
      uniforms: { size: { value: new Vector2(1, 1) }, width: { value: width }, colour: { value: new Color() }, strength: { value: 1 } },
    });
    super(geometry, material);
    this.frustumCulled = false;
  }

  /** Joins each point with the next, unless that begins a line of its own: the triangles between the two are empty. */
  private join(count: number, isBegun: (k: number) => boolean): void {
    const index = this.geometry.getIndex() as BufferAttribute;
    let isChanged = false;
    for (let k = 0; k < count - 1; k++) {
      const corners = isBegun(k + 1) ? NOTHING : QUAD;
      if (index.getX(6 * k + 1) === 2 * k + corners[1]) continue;
      isChanged = true;
      corners.forEach((corner, i) => index.setX(6 * k + i, 2 * k + corner));
    }
    if (isChanged) index.needsUpdate = true;
  }

  /** Points (point, 3) from the past to now; the last `most` are drawn.  No line leads to a point that begins a new one. */
  through(points: readonly number[], begins: ReadonlySet<number> = NONE): void {
    const count = Math.min(points.length / 3, this.most);
    const first = points.length / 3 - count;
    const at = (k: number, i: number) => points[3 * (first + k) + i];
    const isBegun = (k: number) => k === 0 || k === count || begins.has(first + k);
    const arrays = ["position", "before", "after", "part"].map((name) => this.geometry.getAttribute(name).array as Float32Array);
    for (let k = 0; k < count; k++) {
      const [before, after] = [isBegun(k) ? k : k - 1, isBegun(k + 1) ? k : k + 1];
      for (const end of [2 * k, 2 * k + 1]) {
        for (let i = 0; i < 3; i++) {
          arrays[0][3 * end + i] = at(k, i);
          arrays[1][3 * end + i] = at(before, i);
          arrays[2][3 * end + i] = at(after, i);
        }
        arrays[3][end] = count > 1 ? k / (count - 1) : 1;
      }
    }
    for (const name of ["position", "before", "after", "part"]) this.geometry.getAttribute(name).needsUpdate = true;
    this.geometry.setDrawRange(0, Math.max(6 * (count - 1), 0));
    this.join(count, isBegun);
  }
}
