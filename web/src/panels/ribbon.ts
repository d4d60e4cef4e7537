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
    for (let k = 0; k < most - 1; k++) index.push(2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 1, 2 * k + 3, 2 * k + 2);
    geometry.setIndex(index);
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

  /** Points (point, 3) from the past to now; the last `most` are drawn. */
  through(points: readonly number[]): void {
    const count = Math.min(points.length / 3, this.most);
    const first = points.length / 3 - count;
    const at = (k: number, i: number) => points[3 * (first + Math.min(Math.max(k, 0), count - 1)) + i];
    const arrays = ["position", "before", "after", "part"].map((name) => this.geometry.getAttribute(name).array as Float32Array);
    for (let k = 0; k < count; k++) {
      for (const end of [2 * k, 2 * k + 1]) {
        for (let i = 0; i < 3; i++) {
          arrays[0][3 * end + i] = at(k, i);
          arrays[1][3 * end + i] = at(k - 1, i);
          arrays[2][3 * end + i] = at(k + 1, i);
        }
        arrays[3][end] = count > 1 ? k / (count - 1) : 1;
      }
    }
    for (const name of ["position", "before", "after", "part"]) this.geometry.getAttribute(name).needsUpdate = true;
    this.geometry.setDrawRange(0, Math.max(6 * (count - 1), 0));
  }
}
