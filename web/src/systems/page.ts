/** The page of a system that it carries or that is typed: its views, starts by number, and what a file has saved. */

import "./systems.css";
import { VERSION } from "../data/tops";
import { find, Page, quality, tell } from "../page";
import { entry } from "../panels/scene";
import type { Charted } from "../state/charted";
import type { EverydayAction } from "../state/everyday";
import { shortened } from "../state/query";
import type { Exact } from "../state/exact";
import { inWords } from "./comparison";
import { SystemControls } from "./controls";
import { CARRIED, described, targetsOf, type SystemDescription } from "./description";
import type { FanJob } from "../fan/computation";
import { FlatView, Ranges, seriesColours } from "./flat";
import { HELP } from "./help";
import { SpaceView } from "./space";
import { begun, changed, clockOf, sameRun, timeText, viewsOf, type SystemAction, type SystemState, type View } from "./state";
import { aboutSurface, counted, isStroboscopic } from "./time";
import { read, written } from "./url";
import type { SystemJob } from "../worker/messages";

/** Saved states that are drawn around the time of the cursor, in units of time. */
const SAVED_PAST = 10;
/** Letters of the name of a surface, which leave room for the number of crossings beside it. */
const MOST_LETTERS = 20;

/** What a page knows of a system that is typed. */
export interface Typed {
  /** The whole address, of which that of the state is a part. */
  address(): string;
  /** The lines of Python that compute the orbit. */
  lines(): string;
  /** What was typed, in lines. */
  facts(): readonly string[];
  /** The example that it is; none where something was changed. */
  example(): string | undefined;
}

export class SystemPage extends Page<SystemState, SystemAction> {
  private readonly ranges: Ranges;
  private readonly controls: SystemControls;
  private readonly space: SpaceView;
  private readonly flat: FlatView;
  private readonly views: readonly View[];
  protected readonly instead = "the start that it carries";

  constructor(private system: SystemDescription, private readonly typed: Typed | null = null) {
    document.documentElement.dataset.page = "system";
    const clock = clockOf(system);
    super(begun(system), { system, coordinates: system, clock, width: system.components.length, conserved: targetsOf(system), help: HELP });
    this.ranges = new Ranges(system.turns);
    this.views = viewsOf(system);
    const panel = find("scene");
    panel.setAttribute("aria-label", "The motion");
    (document.querySelector(".skip") as HTMLElement).textContent = "Skip to the motion";
    this.controls = new SystemControls(find("controls"), system, (action) => this.act(action), tell, (entered) => void this.startOn(entered));
    this.space = new SpaceView(panel.querySelector(".view") as HTMLElement, system, clock, quality, this.views.includes("vectors"));
    this.flat = new FlatView(panel, system, clock);
    if (typed) this.startsByClick();
    const words: Record<View, readonly [string, string]> = {
      vectors: ["Vectors", "arrows with trails"],
      picture: [system.picture?.name ?? "Picture", "on the plane"],
      projection: ["Projection", "on two or three axes"],
      series: ["Time series", "of components"],
    };
    this.buttons("Views", this.views.map((view) => [view, ...words[view], () => this.act({ do: "view", view })]));
    this.name();
  }

  protected override ofTours(): string {
    return this.typed ? (this.typed.example() ?? "a system of your own") : this.system.name;
  }

  protected changed(state: SystemState, action: SystemAction | EverydayAction): SystemState {
    return changed(this.system, state, action);
  }

  protected sameRun(one: SystemState, other: SystemState): boolean {
    return sameRun(one, other);
  }

  protected get view(): SpaceView {
    return this.space;
  }

  protected job(): SystemJob {
    const { system, state: { start, surface, direction, tol } } = this;
    return { system, start: start.map((one) => one.value), surface, direction, tol: tol.value, horizon: this.kind.clock.horizon, saved: system.saved };
  }

  protected fanJob(): FanJob {
    const { system, state: { start, surface, direction, axes, tol, fan, added } } = this;
    return { system, start: start.map((one) => one.value), surface, direction, axes, tol: tol.value, count: fan, added };
  }

  protected charted(): Charted {
    const { system, state } = this;
    const { name, modulus } = system.surfaces[state.surface];
    return {
      axes: [system.components[state.axes[0]], system.components[state.axes[1]]],
      surface: shortened(name, MOST_LETTERS),
      modulus,
      remark: aboutSurface(system, state.surface),
      direction: state.direction,
      time: state.time,
    };
  }

  /** Another system with the same components, in a state of its own or in that of the last one, perhaps with another start. */
  replace(system: SystemDescription, start: readonly Exact[] | null, state: SystemState | null = null): void {
    this.system = system;
    this.state = state ?? { ...this.state, time: 0, start: start ?? this.state.start };
    this.name();
    this.run();
    this.show();
  }

  override leave(): void {
    super.leave();
    this.space.free();
  }

  /** A click into the portrait starts an orbit with these two components. */
  private startsByClick(): void {
    const { plot } = this.portrait;
    plot.canvas.classList.add("starts");
    plot.canvas.addEventListener("click", (event) => {
      const point = plot.point(event.offsetX, event.offsetY);
      if (!point) return;
      const start = this.state.start.map((one) => one.value);
      this.state.axes.forEach((axis, k) => (start[axis] = point[k]));
      this.startAt(start, "a new orbit starts at this point");
    });
  }

  protected shows(): void {
    const { state, system } = this;
    const colours = seriesColours(this.palette);
    this.controls.show(state, colours);
    this.choose(state.view);
    const isFlat = this.isFlat();
    this.space.show(!isFlat);
    this.flat.show(isFlat, state.view === "picture" ? `${system.picture?.name} of the state` : state.view === "series" ? "Components over time" : "Path in two components");
    this.legend(colours);
    find("section-h").textContent = isStroboscopic(system, state.surface) ? "Stroboscopic map" : "Poincaré section";
  }

  private isFlat(): boolean {
    const { view, space } = this.state;
    return view === "picture" || view === "series" || (view === "projection" && space[2] === null);
  }

  private legend(colours: readonly string[]): void {
    const { state, system } = this;
    const at = (k: number) => colours[k % colours.length];
    const items: Partial<Record<View, () => HTMLElement[]>> = {
      vectors: () => this.space.names.map((name, k) => entry(name, "", at(k))),
      series: () => state.series.map((component, k) => entry(system.components[component], "", at(k))),
    };
    find("scene").querySelector(".legend")?.replaceChildren(...(items[state.view]?.() ?? []));
  }

  private name(): void {
    const { system } = this;
    document.title = `${system.name} · liepoisson`;
    find("title").textContent = system.name;
    find("subtitle").textContent = `${counted(system)}${system.saved ? ", with a saved result" : ""}`;
  }

  protected draws(): void {
    const { results, state, palette, system } = this;
    this.ranges.look(results);
    if (this.isFlat()) this.flat.draw(state, results, this.ranges, palette);
    else this.space.draw(state, results, this.ranges, system, palette);
    this.space.dirty = false;
    find("clock").textContent = `t = ${timeText(state.time, this.kind.clock)}`;
    this.controls.conserved(results, state.time);
    this.savedStates("orbit");
  }

  protected override drawsSection(): void {
    this.savedStates("section");
  }

  protected override drawsSeldom(): void {
    if (this.system.saved) this.controls.compare(inWords(this.system.saved, this.results.compared));
  }

  /** Rings at the states of a saved orbit in the portrait, at those of a saved section in the section. */
  private savedStates(kind: "orbit" | "section"): void {
    const { saved } = this.system;
    if (saved?.kind !== kind || !saved.has_states || (kind === "section" && this.state.surface !== this.system.surface)) return;
    const { plot } = kind === "orbit" ? this.portrait : this.section;
    const { time, axes } = this.state;
    const c = plot.above;
    c.save();
    plot.clip(c);
    c.strokeStyle = this.palette.accent;
    c.lineWidth = 1;
    const near = (when: number) => kind === "section" || (when <= time && when >= time - SAVED_PAST * this.kind.clock.unit);
    saved.times.forEach((when, k) => {
      if (!near(when)) return;
      c.beginPath();
      c.arc(plot.px(saved.states[k][axes[0]]), plot.py(saved.states[k][axes[1]]), 3.2, 0, 7);
      c.stroke();
    });
    c.restore();
  }

  protected read(address: string): SystemState {
    return read(this.system, address);
  }

  /** That of a tour may leave out the system, whose hash another version changes. */
  protected override readStep(address: string): SystemState {
    return this.read(/(^|&)system=/.test(address) ? address : `system=${this.system.id}&${address}`);
  }

  protected written(): string {
    return this.typed?.address() ?? written(this.system, this.state);
  }

  protected lines(): string {
    return this.typed?.lines() ?? "";
  }

  protected exported() {
    const { system, state: { start, tol } } = this;
    const { components, name } = system;
    return {
      file: name.replace(/[^\w-]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 40) || "system",
      facts: [
        `liepoisson ${VERSION}, the laboratory; core in WebAssembly`,
        `system: ${name}`,
        ...(this.typed?.facts() ?? []),
        `start: ${components.map((one, k) => `${one} = ${start[k].text}`).join(", ")}`,
        `method: Taylor, tol = ${tol.text}`,
        `address: #${this.written()}`,
      ],
      columns: components,
      row: "state",
    };
  }

  protected viewName(): string {
    return this.state.view;
  }

  protected picture(title: string): HTMLCanvasElement {
    const { flat, space, state, ranges } = this;
    if (!this.isFlat()) return space.picture(this.palette, title);
    return this.flatPicture({ plot: flat.plot, draw: (_, results, palette) => flat.draw(state, results, ranges, palette) }, title);
  }

  protected readonly keys = {};

  protected numbered(number: number): (() => void) | undefined {
    const view = this.views[number - 1];
    return view && (() => this.act({ do: "view", view }));
  }
}

/** The page of the system that it carries. */
export function start(): void {
  let page: SystemPage;
  try {
    page = new SystemPage(described(document.getElementById(CARRIED)?.textContent ?? ""));
  } catch (error) {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.shown = dark ? "dark" : "light";
    document.documentElement.dataset.broken = "1";
    tell(`The system of this page cannot be shown: ${(error as Error).message}.`);
    return;
  }
  void page.begin();
}
