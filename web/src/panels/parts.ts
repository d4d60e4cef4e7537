/** What the views of the scene are made of. */

import {
  CanvasTexture, CylinderGeometry, Mesh, Quaternion, RepeatWrapping, SphereGeometry, SRGBColorSpace, Vector3, type Group, type Material,
  type MeshStandardMaterial, LineSegments, type WebGLRenderer,
} from "three";
import { N } from "../data/tops";
import type { Palette } from "../style/palette";
import { draw } from "../symbols";

const UP = new Vector3(0, 1, 0);
const scratch = new Quaternion();

/** How the body is turned, of a row of states that begins at a place. */
export function quaternionOf(states: Float64Array, at: number): Quaternion {
  const [w, x, y, z] = states.subarray(at + N, at + N + 4);
  return scratch.clone().set(x, y, z, w).normalize();
}

export function rod(from: Vector3, to: Vector3, radius: number, material: Material): Mesh {
  const along = to.clone().sub(from);
  const found = new Mesh(new CylinderGeometry(radius, radius, along.length(), 18), material);
  found.position.copy(from).addScaledVector(along, 0.5);
  found.quaternion.setFromUnitVectors(UP, along.normalize());
  return found;
}

export function ball(at: Vector3, radius: number, material: Material): Mesh {
  const found = new Mesh(new SphereGeometry(radius, 28, 20), material);
  found.position.copy(at);
  return found;
}

/** Stripes from pole to pole, an even number of them. */
export function stripes(palette: Palette, count = 8): CanvasTexture {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [1024, 4];
  const c = canvas.getContext("2d") as CanvasRenderingContext2D;
  const wide = canvas.width / count;
  for (let k = 0; k < count; k++) {
    c.fillStyle = k % 2 ? palette.body2 : palette.body;
    c.fillRect(k * wide, 0, wide, 4);
  }
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  texture.anisotropy = 8;
  texture.wrapS = RepeatWrapping;
  return texture;
}

/** Gives the memory of the graphics card back. */
export function emptied(group: Group): void {
  group.traverse((part) => {
    if (!(part instanceof Mesh || part instanceof LineSegments)) return;
    part.geometry.dispose();
    const material = part.material as MeshStandardMaterial;
    material.map?.dispose();
    material.dispose();
  });
  group.clear();
}

/** A view as it is, with the names that stand over it and a line of words; empty where nothing can be drawn. */
export function pictureOfView(renderer: WebGLRenderer | null, holder: HTMLElement, names: readonly (readonly [label: HTMLElement, name: string])[], palette: Palette, title: string): HTMLCanvasElement {
  const { width, height } = renderer?.domElement ?? { width: 1, height: 1 };
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  const c = canvas.getContext("2d") as CanvasRenderingContext2D;
  c.fillStyle = palette.panel;
  c.fillRect(0, 0, width, height);
  if (!renderer) return canvas;
  c.drawImage(renderer.domElement, 0, 0);
  const scale = width / holder.clientWidth;
  c.scale(scale, scale);
  const place = holder.getBoundingClientRect();
  for (const [label, name] of names) {
    if (label.hidden) continue;
    const box = label.getBoundingClientRect();
    c.fillStyle = getComputedStyle(label).color;
    draw(c, name, box.left - place.left, box.bottom - place.top - 0.25 * box.height, parseFloat(getComputedStyle(label).fontSize));
  }
  c.fillStyle = palette.ink;
  c.font = `14px "Inter Variable", sans-serif`;
  c.fillText(title, 16, holder.clientHeight - 14);
  return canvas;
}
