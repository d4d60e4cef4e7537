/**
 * Kirchhoff's analogy: the orbit as the shape of an elastic rod.  Time is arclength, the third axis of the body the tangent,
 * and the moments of inertia are the stiffnesses, so that the rod is thick where it is hard to bend.
 */

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, Mesh, MeshStandardMaterial, Quaternion, Vector3 } from "three";
import { POSITION } from "../data/tops";
import type { Results } from "../results";
import type { Palette } from "../style/palette";
import { quaternionOf, stripes } from "./parts";

/** Arclength that is seen, and between cross sections. */
export const LENGTH = 30;
const BETWEEN = LENGTH / 480;
const SIDES = 20;
/** Largest distance from the middle, and half of the thickness, in units of the scene. */
const REACH = 2.1;
const THICK = 0.05;

export class RodView extends Group {
  private readonly geometry = new BufferGeometry();
  private readonly material = new MeshStandardMaterial({ roughness: 0.4, metalness: 0.1 });
  private readonly most = Math.ceil(LENGTH / BETWEEN) + 2;
  private widths: readonly [number, number] = [THICK, THICK];
  private scaledFor: Results | null = null;
  private factor = 1;
  /** Where the rod ends, in the scene, and how it is turned there. */
  readonly tip = new Vector3();

  constructor() {
    super();
    const count = this.most * (SIDES + 1);
    for (const [name, items] of [["position", 3], ["normal", 3], ["uv", 2]] as const) {
      const attribute = new BufferAttribute(new Float32Array(count * items), items);
      attribute.setUsage(DynamicDrawUsage);
      this.geometry.setAttribute(name, attribute);
    }
    const uv = this.geometry.getAttribute("uv").array as Float32Array;
    for (let k = 0; k < count; k++) uv[2 * k] = (k % (SIDES + 1)) / SIDES;
    const index: number[] = [];
    for (let ring = 0; ring < this.most - 1; ring++) {
      for (let side = 0; side < SIDES; side++) {
        const [here, next] = [ring * (SIDES + 1) + side, (ring + 1) * (SIDES + 1) + side];
        index.push(here, here + 1, next, here + 1, next + 1, next);
      }
    }
    this.geometry.setIndex(index);
    const mesh = new Mesh(this.geometry, this.material);
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    this.add(mesh);
  }

  /** The stiffer against bending about an axis, the thicker across it. */
  build(inertia: readonly number[], palette: Palette): void {
    const ratio = (inertia[0] / inertia[1]) ** 0.25;
    this.widths = [THICK / ratio, THICK * ratio];
    this.material.map?.dispose();
    this.material.map = stripes(palette, 4);
    this.material.needsUpdate = true;
  }

  /** One scale for an orbit: the rods that end at ten places of its first part fit. */
  private fitted(results: Results): number {
    if (this.scaledFor === results) return this.factor;
    const { end } = results.top;
    let most = 0;
    for (let part = 1; part <= 10; part++) {
      const places = placesOf(results, (part * Math.min(end, 2 * LENGTH)) / 10);
      const middle = middleOf(places.map(({ at }) => at));
      for (const { at } of places) most = Math.max(most, at.distanceTo(middle));
    }
    if (most > 0) this.factor = REACH / most;
    if (end >= 35 || results.finished) this.scaledFor = results;
    return this.factor;
  }

  move(time: number, results: Results): void {
    const factor = this.fitted(results);
    const places = placesOf(results, time);
    if (places.length < 2) {
      // the rod begins: what an earlier orbit left is gone
      this.geometry.setDrawRange(0, 0);
      this.tip.set(0, 0, 0);
      return;
    }
    const middle = middleOf(places.map(({ at }) => at));
    const [position, normal] = ["position", "normal"].map((name) => this.geometry.getAttribute(name));
    const [points, normals] = [position.array as Float32Array, normal.array as Float32Array];
    const [first, second] = [new Vector3(), new Vector3()];
    places.forEach(({ at, turn }, ring) => {
      at.sub(middle).multiplyScalar(factor);
      first.set(1, 0, 0).applyQuaternion(turn);
      second.set(0, 1, 0).applyQuaternion(turn);
      for (let side = 0; side <= SIDES; side++) {
        const angle = (2 * Math.PI * side) / SIDES;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        const [wide, high] = this.widths;
        const k = 3 * (ring * (SIDES + 1) + side);
        for (let i = 0; i < 3; i++) {
          const [one, two] = [first.getComponent(i), second.getComponent(i)];
          points[k + i] = at.getComponent(i) + wide * c * one + high * s * two;
          normals[k + i] = (c / wide) * one + (s / high) * two;
        }
        const length = Math.hypot(normals[k], normals[k + 1], normals[k + 2]);
        for (let i = 0; i < 3; i++) normals[k + i] /= length;
      }
    });
    position.needsUpdate = normal.needsUpdate = true;
    this.geometry.setDrawRange(0, 6 * SIDES * (places.length - 1));
    this.tip.copy(places[places.length - 1].at);
  }
}

interface Place {
  readonly at: Vector3;
  readonly turn: Quaternion;
}

/** Cross sections at the same places of the rod however far it has grown, and the one at its end. */
function placesOf(results: Results, time: number): Place[] {
  const places: Place[] = [];
  const add = (at: number) => {
    const state = results.top.at(at);
    if (state) places.push({ at: new Vector3(state[POSITION], state[POSITION + 1], state[POSITION + 2]), turn: quaternionOf(state, 0) });
  };
  for (let k = Math.max(Math.ceil((time - LENGTH) / BETWEEN), 0); k * BETWEEN < time; k++) add(k * BETWEEN);
  add(time);
  return places;
}

/** The middle of a box around the points would jump; their mean does not. */
function middleOf(points: readonly Vector3[]): Vector3 {
  const sum = points.reduce((total, point) => total.add(point), new Vector3());
  return sum.divideScalar(Math.max(points.length, 1));
}
