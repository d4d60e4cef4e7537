/** The motion in three dimensions: vectors of three components as arrows with their trails, or a path in three components. */

import {
  BufferGeometry, DirectionalLight, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, SphereGeometry, Vector3,
} from "three";
import { Ribbon } from "../panels/ribbon";
import { emptied, pictureOfView } from "../panels/parts";
import { arrow, floorOf, point } from "../panels/scene";
import { Stage } from "../panels/stage";
import type { Results } from "../results";
import type { Clock } from "../state/charted";
import { trace, within, type Turn } from "../state/turn";
import type { Palette } from "../style/palette";
import { element } from "../symbols";
import { PAST, seriesColours, type Ranges } from "./flat";
import { withoutTime, type SystemDescription } from "./description";
import type { SystemState } from "./state";
import { vectorNames } from "./vectors";

const LONGEST = 1.7;
/** Half of the longest edge of the box of a path. */
const HALF = 1.35;
/** Units of time of the trails of arrows. */
const TRAIL = 9;
const TRAIL_POINTS = 460;
const PATH_POINTS = 2001;

export class SpaceView extends Stage {
  private readonly floor = new Group();
  private readonly box = new Group();
  private readonly arrows: Group[];
  private readonly trails: Ribbon[];
  private readonly path = new Ribbon(PATH_POINTS, 3);
  private readonly tip = new Mesh(new SphereGeometry(0.055, 24, 16), new MeshStandardMaterial({ roughness: 0.35 }));
  private labels: (readonly [label: HTMLElement, name: string])[] = [];
  private labelled = "";
  private built = "";
  private scales: { of: Results | null; all: readonly number[] } = { of: null, all: [] };
  readonly names: readonly string[];
  private readonly turns: readonly (Turn | null)[];

  constructor(holder: HTMLElement, system: SystemDescription, private readonly clock: Clock, quality: "low" | "full" | null, vectors: boolean) {
    super(holder, quality, { name: "the view in three dimensions", label: "The motion in three dimensions.", eye: 2.9, middle: -0.1 });
    this.names = vectors ? vectorNames(withoutTime(system)) : [];
    this.turns = system.turns;
    this.arrows = this.names.map(() => arrow());
    this.trails = this.names.map(() => new Ribbon(TRAIL_POINTS, 3.6));
    if (!this.works) return;
    this.light(new DirectionalLight(0xffffff, 2.2), 1.6, 0.2);
    this.scene.add(this.floor, this.box, this.path, this.tip, ...this.arrows, ...this.trails);
    this.fits();
  }

  protected ribbons(): readonly Ribbon[] {
    return [...this.trails, this.path];
  }

  show(shown: boolean): void {
    this.holder.hidden = !shown;
    if (shown) this.resize();
  }

  draw(state: SystemState, results: Results, ranges: Ranges, system: SystemDescription, palette: Palette): void {
    if (!this.works || !this.height) return;
    const space = state.view === "projection" ? state.space : null;
    this.build(space, ranges, palette);
    const names = space ? space.flatMap((k) => (k === null ? [] : [system.components[k]])) : this.names;
    this.label(names, space ? names.map(() => palette.faint) : seriesColours(palette));
    const now = results.top.at(state.time);
    if (now && space) this.follow(space as [number, number, number], state.time, now, results, ranges);
    else if (now) this.move(state.time, now, results);
    this.renderer.render(this.scene, this.camera);
    this.place(space !== null);
    this.dirty = false;
  }

  /** The view as it is, with the names of what is in it. */
  picture(palette: Palette, title: string): HTMLCanvasElement {
    return pictureOfView(this.works ? this.renderer : null, this.holder, this.labels, palette, title);
  }

  private build(space: SystemState["space"] | null, ranges: Ranges, palette: Palette): void {
    const key = `${space?.join()} ${palette.panel} ${palette.dark}`;
    for (const group of [...this.arrows, ...this.trails, this.floor]) group.visible = space === null;
    for (const group of [this.path, this.tip, this.box]) group.visible = space !== null;
    if (space) this.edges(space as [number, number, number], ranges, palette);
    if (key === this.built) return;
    this.built = key;
    emptied(this.floor);
    this.floor.add(...floorOf(palette));
    const colours = seriesColours(palette);
    this.arrows.forEach((one, k) => one.traverse((part) => part instanceof Mesh && (part.material as MeshStandardMaterial).color.set(colours[k % colours.length])));
    this.trails.forEach((trail, k) => trail.material.uniforms.colour.value.set(colours[k % colours.length]));
    this.path.material.uniforms.colour.value.set(palette.accent);
    this.tip.material.color.set(palette.l);
  }

  private edged = "";

  /** The box of the ranges. */
  private edges(space: [number, number, number], ranges: Ranges, palette: Palette): void {
    const place = placing(space, ranges);
    const [low, high] = [0, 1].map((end) => place((k) => ranges.of(k)[end]));
    const key = `${low.join()} ${high.join()} ${palette.zero}`;
    if (key === this.edged) return;
    this.edged = key;
    emptied(this.box);
    const points: number[] = [];
    for (let axis = 0; axis < 3; axis++) {
      for (let corner = 0; corner < 4; corner++) {
        const from = [0, 1, 2].map((i) => (i === axis ? low[i] : (corner >> ((i + 2 - axis) % 3)) & 1 ? high[i] : low[i]));
        points.push(...from, ...from.map((value, i) => (i === axis ? high[i] : value)));
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    this.box.add(new LineSegments(geometry, new LineBasicMaterial({ color: palette.zero, transparent: true, opacity: 0.55 })));
    // beside the edges that are in front as the view begins
    const middle = low.map((value, i) => (value + high[i]) / 2);
    this.box.userData.ends = [
      new Vector3(middle[0], low[1] - 0.18, low[2]),
      new Vector3(high[0] + 0.18, middle[1], low[2]),
      new Vector3(low[0] - 0.12, low[1] - 0.12, middle[2]),
    ];
  }

  private follow(space: [number, number, number], time: number, now: Float64Array, results: Results, ranges: Ranges): void {
    const place = placing(space, ranges);
    const turns = space.map((k) => this.turns[k]);
    const states: number[] = [];
    results.top.visit(Math.max(0, time - PAST * this.clock.unit), time, (_, all, at) => states.push(...space.map((k) => all[at + k])));
    states.push(...space.map((k) => now[k]));
    const [points, begins]: [number[], Set<number>] = [[], new Set()];
    const add = (point: readonly number[]) => points.push(...place((k) => point[space.indexOf(k)]));
    trace(states, turns, (point) => {
      begins.add(points.length / 3);
      add(point);
    }, add);
    this.path.through(points, begins);
    this.tip.position.set(...place((k) => within(now[k], this.turns[k])));
  }

  private move(time: number, now: Float64Array, results: Results): void {
    const scales = this.scale(results);
    const points = (states: Float64Array, at: number, k: number) => [0, 1, 2].map((i) => states[at + 3 * k + i] * scales[k]);
    this.arrows.forEach((one, k) => point(one, new Vector3(...(points(now, 0, k) as [number, number, number]))));
    const paths: number[][] = this.names.map(() => []);
    results.top.visit(time - TRAIL * this.clock.unit, time, (_, states, at) => paths.forEach((path, k) => path.push(...points(states, at, k))));
    this.trails.forEach((trail, k) => trail.through([...paths[k], ...points(now, 0, k)]));
  }

  /** Each vector has one scale for the orbit. */
  private scale(results: Results): readonly number[] {
    if (this.scales.of === results) return this.scales.all;
    const longest = this.names.map(() => 0);
    results.top.visit(0, PAST * this.clock.unit, (_, states, at) => {
      longest.forEach((length, k) => (longest[k] = Math.max(length, Math.hypot(...states.subarray(at + 3 * k, at + 3 * k + 3)))));
    });
    const all = longest.map((length) => (length > 0 ? LONGEST / length : 1));
    if (results.top.end >= 35 * this.clock.unit || results.finished) this.scales = { of: results, all };
    return all;
  }

  private label(names: readonly string[], colours: readonly string[]): void {
    const key = `${names.join("\n")} ${colours.join()}`;
    if (key === this.labelled) return;
    this.labelled = key;
    for (const [label] of this.labels) label.remove();
    this.labels = names.map((name, k) => {
      const label = element(name);
      label.classList.add("label");
      label.setAttribute("aria-hidden", "true");
      label.style.color = colours[k % colours.length];
      return [label, name] as const;
    });
    this.holder.append(...this.labels.map(([label]) => label));
  }

  private place(isPath: boolean): void {
    const { clientWidth: width } = this.holder;
    this.labels.forEach(([label], k) => {
      const end: Vector3 | undefined = isPath ? this.box.userData.ends?.[k] : this.arrows[k]?.userData.tip;
      label.hidden = !end || (!isPath && end.length() < 0.05);
      if (!end) return;
      const at = (isPath ? end.clone() : end.clone().setLength(end.length() + 0.16)).project(this.camera);
      label.style.transform = `translate(${((at.x + 1) / 2) * width}px, ${((1 - at.y) / 2) * this.height}px) translate(-50%, -50%)`;
    });
  }
}

/** Three components of a state as a place in a box around the origin; components of one kind of size keep their ratio. */
function placing(space: [number, number, number], ranges: Ranges): (of: (component: number) => number) => [number, number, number] {
  const bounds = space.map((k) => ranges.of(k));
  const spans = bounds.map(([low, high]) => high - low);
  const largest = Math.max(...spans) || 1;
  // what is less than a fifth of the largest is stretched, so that it is seen
  const factors = spans.map((span) => (2 * HALF) / (span > largest / 5 ? largest : span > 0 ? 2 * span : 1));
  return (of) => space.map((k, i) => (of(k) - (bounds[i][0] + bounds[i][1]) / 2) * factors[i]) as [number, number, number];
}
