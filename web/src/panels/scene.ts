/**
 * The moving top, in four views: the body in space, the same from the body, its angular momentum, and the rod that has its
 * orbit for a shape.  The body is its ellipsoid of inertia, with half axes in the ratio of 1/sqrt(I), the
 * axes of the moments through it, and a ball at the centre of mass.
 */

import {
  ACESFilmicToneMapping, BufferGeometry, CircleGeometry, Color, ConeGeometry, CylinderGeometry,
  DirectionalLight, Float32BufferAttribute, Group, GreaterDepth, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshPhysicalMaterial,
  MeshStandardMaterial, PCFShadowMap, PMREMGenerator, Quaternion, ShadowMaterial, SphereGeometry, TorusGeometry, Vector3, type Material, type Object3D,
} from "three";
import { RoomEnvironment } from "three/examples/jsm/environments/RoomEnvironment.js";
import type { Results } from "../results";
import type { Laboratory } from "../state/laboratory";
import type { Palette } from "../style/palette";
import { element } from "../symbols";
import { MomentumView } from "./momentum";
import { ball, emptied, pictureOfView, quaternionOf, rod, stripes } from "./parts";
import { Ribbon } from "./ribbon";
import { RodView } from "./rod";
import { Stage } from "./stage";

/** Longest half axis, and longest vector, in units of the scene. */
const BODY = 0.95;
const LONGEST = 1.7;
/** Length of the head of a vector. */
const HEAD = 0.23;
/** The body is so small that the head of a vector half as long as the longest one lies outside. */
const SIZE = (LONGEST / 2 - HEAD) / BODY;
/** Time units of the trails. */
const PAST = 9;
const TRAIL_POINTS = 460;
const FLOOR = -1.6;
/** Opacity of the shadow top, and the angle to the body at which it has it. */
const GLASS = 0.22;
const APART = 0.15;
const UP = new Vector3(0, 1, 0);

const VECTORS = [
  { name: "l", at: 0, words: "angular momentum", ofRod: "moment" },
  { name: "alpha", at: 3, words: "first field", ofRod: "force, by its sources" },
  { name: "beta", at: 6, words: "second field", ofRod: "field, fixed in space" },
] as const;
/** Of the vectors at the end of a rod. */
const AT_END = 0.6;

export class ScenePanel extends Stage {
  private readonly body = new Group();
  private readonly ghost = new Group();
  private readonly arrows = VECTORS.map(() => arrow());
  private readonly trails = VECTORS.map(() => new Ribbon(TRAIL_POINTS, 3.8));
  private readonly axisTrail = new Ribbon(TRAIL_POINTS, 2.2);
  private readonly labels: HTMLElement[];
  private readonly floor = new Group();
  private momentum!: MomentumView;
  private readonly rod = new RodView();
  private readonly axisNames: HTMLElement[];
  private shown: string | null = null;
  private readonly legend: HTMLElement;
  private built: unknown = null;
  private scales = [1, 1, 1];
  private scaledFor: Results | null = null;

  constructor(panel: HTMLElement, quality: "low" | "full" | null) {
    super(panel.querySelector(".view") as HTMLElement, quality, { name: "the moving body", label: "The moving top with its vectors.", eye: 2.35, middle: -0.12 });
    this.legend = panel.querySelector(".legend") as HTMLElement;
    this.labels = VECTORS.map(({ name }) => {
      const label = element(name);
      label.classList.add("label");
      label.setAttribute("aria-hidden", "true");
      return label;
    });
    this.axisNames = ["l1", "l2", "l3"].map((name) => {
      const label = element(name);
      label.classList.add("label", "axis");
      label.setAttribute("aria-hidden", "true");
      return label;
    });
    this.body.scale.setScalar(SIZE);
    this.ghost.scale.setScalar(SIZE);
    if (!this.works) return;
    const { renderer } = this;
    renderer.toneMapping = ACESFilmicToneMapping;
    renderer.toneMappingExposure = 1.05;
    renderer.shadowMap.enabled = !this.software;
    renderer.shadowMap.type = PCFShadowMap;
    this.lights();
    this.momentum = new MomentumView(this.software);
    this.scene.add(this.body, this.ghost, this.floor, this.momentum, this.rod, this.axisTrail, ...this.trails, ...this.arrows);
    this.holder.append(...this.labels, ...this.axisNames);
    this.fits();
  }

  private lights(): void {
    const sun = new DirectionalLight(0xffffff, 2.3);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    sun.shadow.radius = 7;
    sun.shadow.bias = -0.0004;
    sun.shadow.normalBias = 0.04;
    Object.assign(sun.shadow.camera, { left: -3, right: 3, top: 3, bottom: -3, near: 1, far: 12 });
    this.light(sun, this.software ? 1.7 : 0.7, 0.15);
    if (this.software) return;
    const maker = new PMREMGenerator(this.renderer);
    this.scene.environment = maker.fromScene(new RoomEnvironment(), 0.03).texture;
    this.scene.environmentIntensity = 0.55;
    maker.dispose();
  }

  protected ribbons(): readonly Ribbon[] {
    return [...this.trails, this.axisTrail];
  }

  draw(lab: Laboratory, results: Results, palette: Palette): void {
    if (!this.works) return;
    const key = `${lab.parameters.map((one) => one.text).join()} ${palette.panel} ${palette.dark}`;
    if (key !== this.built) {
      this.built = key;
      this.build(lab, palette);
    }
    this.stage(lab, palette);
    const state = results.top.at(lab.time);
    if (state) this.move(lab, results, state);
    this.renderer.render(this.scene, this.camera);
    this.place();
    this.dirty = false;
  }

  /** The view as it is, with the names of what is in it. */
  picture(palette: Palette, title: string): HTMLCanvasElement {
    const names = [...this.labels.map((one, k) => [one, VECTORS[k].name] as const), ...this.axisNames.map((one, k) => [one, `l${k + 1}`] as const)];
    return pictureOfView(this.works ? this.renderer : null, this.holder, names, palette, title);
  }

  /** For tests: how far the body reaches, and how long the vectors are. */
  sizes(): [number, number[]] {
    return [SIZE * BODY, this.arrows.map((one) => (one.userData.tip as Vector3).length())];
  }

  private build(lab: Laboratory, palette: Palette): void {
    const numbers = lab.parameters.map((one) => one.value);
    for (const group of [this.body, this.ghost, this.floor]) emptied(group);
    this.body.add(...bodyOf(numbers, palette, this.software));
    this.ghost.add(...ghostOf(numbers, palette));
    this.floor.add(...floorOf(palette));
    const colours = [palette.l, palette.alpha, palette.beta];
    this.arrows.forEach((one, k) => one.traverse((part) => part instanceof Mesh && (part.material as MeshStandardMaterial).color.set(colours[k])));
    this.trails.forEach((trail, k) => trail.material.uniforms.colour.value.set(colours[k]));
    this.axisTrail.material.uniforms.colour.value.set(palette.axis);
    this.axisTrail.material.uniforms.strength.value = 0.7;
    this.labels.forEach((label, k) => (label.style.color = colours[k]));
    this.momentum.paint(palette);
    this.rod.build(numbers, palette);
    this.shown = null;
  }

  /** What a view shows, and what it is called. */
  private stage(lab: Laboratory, palette: Palette): void {
    const view = lab.view.frame;
    if (view === this.shown) return;
    this.shown = view;
    const [isBody, isRod, isMomentum] = [view === "space" || view === "body", view === "rod", view === "momentum"];
    [this.body.visible, this.floor.visible, this.ghost.visible, this.axisTrail.visible] = [isBody, isBody, isBody, isBody];
    [this.rod.visible, this.momentum.visible] = [isRod, isMomentum];
    this.arrows.forEach((one, k) => (one.userData.shown = !isMomentum || k === 0));
    this.trails.forEach((trail, k) => (trail.visible = isBody || (isMomentum && k === 0)));
    this.trails.forEach((trail) => (trail.renderOrder = isMomentum ? 2 : 0));
    this.arrows.forEach((one) => one.userData.origin.set(0, 0, 0));
    const numbers = lab.parameters.map((one) => one.value);
    const colours = [palette.l, palette.alpha, palette.beta];
    const of = {
      body: () => [
        ...VECTORS.map(({ name, words }, k) => entry(name, words, colours[k])),
        ...(numbers.slice(3, 6).some(Boolean) ? [entry("a", "centre of mass", palette.a)] : []),
        ...(numbers.slice(6, 9).some(Boolean) ? [entry("b", "centre of charge", palette.b)] : []),
      ],
      rod: () => VECTORS.map(({ name, ofRod }, k) => entry(name, ofRod, colours[k])),
      momentum: () => [
        entry("l", "angular momentum", palette.l),
        entry("", "sphere of its length", palette.l),
        entry("", "ellipsoid of its kinetic energy", palette.body),
        entry("", "where they meet: the polhode", palette.a),
      ],
    };
    this.legend.replaceChildren(...(isRod ? of.rod() : isMomentum ? of.momentum() : of.body()));
  }

  /** Vectors are drawn to fit: each kind has one scale for the orbit. */
  private scale(results: Results): void {
    if (this.scaledFor === results) return;
    const longest = [0, 0, 0];
    results.top.visit(0, 60, (_, states, at) => {
      VECTORS.forEach((vector, k) => (longest[k] = Math.max(longest[k], Math.hypot(...states.subarray(at + vector.at, at + vector.at + 3)))));
    });
    this.scales = longest.map((length) => (length > 0 ? LONGEST / length : 1));
    // both fields have one unit
    this.scales[1] = this.scales[2] = Math.min(...[1, 2].filter((k) => longest[k] > 0).map((k) => this.scales[k]), LONGEST);
    if (results.top.end >= 35 || results.finished) this.scaledFor = results;
  }

  private move(lab: Laboratory, results: Results, state: Float64Array): void {
    if (lab.view.frame === "rod") return this.moveRod(lab, results, state);
    if (lab.view.frame === "momentum") return this.moveMomentum(lab, results, state);
    this.scale(results);
    const start = results.top.chunks[0].states;
    const fixed = lab.view.frame === "body" ? quaternionOf(start, 0) : null;
    const turned = (states: Float64Array, at: number, k: number): Vector3 =>
      new Vector3(states[at + k], states[at + k + 1], states[at + k + 2]).applyQuaternion(fixed ?? quaternionOf(states, at));
    this.body.quaternion.copy(fixed ?? quaternionOf(state, 0));
    this.arrows.forEach((one, k) => point(one, turned(state, 0, VECTORS[k].at).multiplyScalar(this.scales[k])));
    const shadow = lab.view.shadow ? results.shadow.at(lab.time) : null;
    this.ghost.visible = shadow !== null && !fixed;
    if (shadow) this.part(quaternionOf(shadow, 0));
    const from = lab.time - PAST;
    const paths: number[][] = [[], [], [], []];
    const add = (states: Float64Array, at: number) => {
      VECTORS.forEach((vector, k) => paths[k].push(...turned(states, at, vector.at).multiplyScalar(this.scales[k]).toArray()));
      if (!fixed) paths[3].push(...new Vector3(0, 0, 1.3 * SIZE).applyQuaternion(quaternionOf(states, at)).toArray());
    };
    results.top.visit(from, lab.time, (_, states, at) => add(states, at));
    add(state, 0);
    this.trails.forEach((trail, k) => trail.through(paths[k]));
    this.axisTrail.visible = !fixed;
    this.axisTrail.through(paths[3]);
  }

  /** Moment and force where the rod ends. */
  private moveRod(lab: Laboratory, results: Results, state: Float64Array): void {
    this.scale(results);
    this.rod.move(lab.time, results);
    const turn = quaternionOf(state, 0);
    this.arrows.forEach((one, k) => {
      one.userData.origin.copy(this.rod.tip);
      const { at } = VECTORS[k];
      point(one, new Vector3(state[at], state[at + 1], state[at + 2]).applyQuaternion(turn).multiplyScalar(this.scales[k] * AT_END));
    });
  }

  private moveMomentum(lab: Laboratory, results: Results, state: Float64Array): void {
    const squares = results.top.ellipsoid(lab.time);
    if (!squares) return;
    this.momentum.move(squares, results);
    const factor = this.momentum.fitted(results);
    const at = (states: Float64Array, from: number) => new Vector3(states[from], states[from + 1], states[from + 2]).multiplyScalar(factor);
    point(this.arrows[0], at(state, 0));
    const path: number[] = [];
    results.top.visit(lab.time - PAST, lab.time, (_, states, from) => path.push(...at(states, from).toArray()));
    this.trails[0].through([...path, ...at(state, 0).toArray()]);
    for (const one of this.arrows.slice(1)) one.visible = false;
  }

  /** Puts the shadow in its place: the farther from the body, the better it is seen. */
  private part(shadow: Quaternion): void {
    this.ghost.quaternion.copy(shadow);
    const opacity = GLASS * Math.min(shadow.angleTo(this.body.quaternion) / APART, 1);
    this.ghost.traverse((one) => one instanceof Mesh && ((one.material as Material).opacity = opacity));
  }

  private place(): void {
    const { clientWidth: width } = this.holder;
    const put = (label: HTMLElement, point: Vector3) => {
      const at = point.project(this.camera);
      label.style.transform = `translate(${((at.x + 1) / 2) * width}px, ${((1 - at.y) / 2) * this.height}px) translate(-50%, -50%)`;
    };
    this.labels.forEach((label, k) => {
      const { tip, origin, shown } = this.arrows[k].userData as { tip: Vector3; origin: Vector3; shown: boolean };
      label.hidden = !shown || tip.length() < 0.05;
      put(label, tip.clone().setLength(tip.length() + 0.16).add(origin));
    });
    this.axisNames.forEach((label, k) => {
      label.hidden = !this.momentum.visible;
      if (this.momentum.visible) put(label, this.momentum.ends()[k].multiplyScalar(1.06));
    });
  }
}

export function entry(name: string, words: string, colour: string): HTMLElement {
  const item = document.createElement("li");
  const letter = element(name || "●");
  letter.style.color = colour;
  item.append(letter, words);
  return item;
}

/** An arrow along the second axis, of length one; its material is its own. */
export function arrow(): Group {
  const group = new Group();
  const material = new MeshStandardMaterial({ roughness: 0.35, metalness: 0.15 });
  const shaft = new Mesh(new CylinderGeometry(0.026, 0.026, 1, 20), material);
  shaft.geometry.translate(0, 0.5, 0);
  const head = new Mesh(new ConeGeometry(0.078, HEAD, 28), material);
  head.geometry.translate(0, -HEAD / 2, 0);
  group.add(shaft, head);
  // what the body hides shines through it
  const through = new MeshBasicMaterial({ transparent: true, opacity: 0.55, depthFunc: GreaterDepth, depthWrite: false });
  for (const part of [shaft, head]) {
    part.castShadow = true;
    part.add(new Mesh(part.geometry, through));
  }
  Object.assign(group.userData, { tip: new Vector3(), origin: new Vector3(), shown: true });
  return group;
}

export function point(one: Group, to: Vector3): void {
  const length = to.length();
  one.userData.tip = to;
  one.position.copy(one.userData.origin as Vector3);
  one.visible = length > 1e-3;
  one.quaternion.setFromUnitVectors(UP, to.clone().normalize());
  const [shaft, head] = one.children;
  const small = Math.min(length / 0.4, 1);
  shaft.scale.set(small, Math.max(length - 0.2 * small, 1e-3), small);
  head.position.y = length;
  head.scale.setScalar(small);
}

/** Half axes of the ellipsoid of inertia, the longest one of length `BODY`. */
function halfAxes(inertia: readonly number[]): Vector3 {
  const axes = new Vector3(...(inertia.map((moment) => 1 / Math.sqrt(moment)) as [number, number, number]));
  return axes.multiplyScalar(BODY / Math.max(...axes.toArray()));
}

function bodyOf(numbers: readonly number[], palette: Palette, simple: boolean): Object3D[] {
  const axes = halfAxes(numbers.slice(0, 3));
  const shell = new SphereGeometry(1, simple ? 48 : 96, simple ? 32 : 64);
  shell.rotateX(Math.PI / 2);
  const looks = { map: stripes(palette), roughness: 0.32, metalness: 0.05 };
  const surface = simple ? new MeshStandardMaterial(looks) : new MeshPhysicalMaterial({ ...looks, clearcoat: 0.6, clearcoatRoughness: 0.4 });
  const ellipsoid = new Mesh(shell, surface);
  ellipsoid.scale.copy(axes);
  const gold = new MeshStandardMaterial({ color: palette.a, roughness: 0.25, metalness: 0.75 });
  const steel = new MeshStandardMaterial({ color: 0xb9c0ca, roughness: 0.3, metalness: 0.75 });
  const band = new Mesh(new TorusGeometry(1, 0.028, 16, 128), gold);
  band.scale.set(axes.x * 1.004, axes.y * 1.004, 1);
  const parts: Object3D[] = [ellipsoid, band];
  for (const [k, axis] of [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].entries()) {
    const reach = axes.getComponent(k) + (k === 2 ? 0.28 : 0.16);
    const thick = k === 2 ? 0.03 : 0.018;
    parts.push(rod(axis.clone().multiplyScalar(-reach), axis.clone().multiplyScalar(reach), thick, steel));
    for (const sign of [-1, 1]) parts.push(ball(axis.clone().multiplyScalar(sign * reach), k === 2 ? 0.062 : 0.036, k === 2 && sign > 0 ? gold : steel));
  }
  const [a, b] = [3, 6].map((k) => new Vector3(numbers[k], numbers[k + 1], numbers[k + 2]));
  for (const [centre, colour] of [[a, palette.a], [b, palette.b]] as const) {
    if (centre.length() === 0) continue;
    const metal = new MeshStandardMaterial({ color: colour, roughness: 0.25, metalness: 0.7 });
    const along = centre.clone().normalize();
    // outside the shell, so that it is seen; its direction is what matters
    const out = along.multiplyScalar(1 / Math.hypot(along.x / axes.x, along.y / axes.y, along.z / axes.z) + 0.3);
    parts.push(rod(new Vector3(), out, 0.024, metal), ball(out, 0.115, metal));
  }
  for (const part of parts) part.castShadow = true;
  return parts;
}

function ghostOf(numbers: readonly number[], palette: Palette): Object3D[] {
  const axes = halfAxes(numbers.slice(0, 3));
  const glass = new MeshStandardMaterial({ color: palette.dark ? 0x9fb4cc : 0x66707c, transparent: true, opacity: GLASS, depthWrite: false, roughness: 0.6 });
  const shell = new Mesh(new SphereGeometry(1, 48, 32), glass);
  shell.scale.copy(axes);
  const reach = axes.z + 0.28;
  const stick = rod(new Vector3(0, 0, -reach), new Vector3(0, 0, reach), 0.026, glass);
  return [shell, stick, ball(new Vector3(0, 0, reach), 0.056, glass), ball(new Vector3(0, 0, -reach), 0.056, glass)];
}

export function floorOf(palette: Palette): Object3D[] {
  const points: number[] = [];
  const colours: number[] = [];
  const colour = new Color(palette.floor);
  const add = (radius: number, angle: number) => {
    points.push(radius * Math.cos(angle), radius * Math.sin(angle), FLOOR);
    colours.push(colour.r, colour.g, colour.b, Math.max(0, 1 - radius / 4.2) * 0.75);
  };
  for (const radius of [0.6, 1.2, 1.8, 2.4, 3, 3.6]) {
    for (let k = 0; k < 128; k++) [k, k + 1].forEach((end) => add(radius, (end * Math.PI) / 64));
  }
  for (let k = 0; k < 16; k++) for (let r = 0.6; r < 3.9; r += 0.3) [r, r + 0.3].forEach((radius) => add(radius, (k * Math.PI) / 8));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 4));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
  const ground = new Mesh(new CircleGeometry(5, 48), new ShadowMaterial({ opacity: palette.dark ? 0.5 : 0.2 }));
  ground.position.z = FLOOR - 0.002;
  ground.receiveShadow = true;
  return [ground, lines];
}
