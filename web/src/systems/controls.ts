/** Controls of a system: exact entries of the start, what is seen, section, axes and tolerance. */

import { Conserved } from "../panels/conserved";
import { exactEntry } from "../panels/entry";
import type { Results } from "../results";
import { exact, type Exact } from "../state/exact";
import type { Direction } from "../state/everyday";
import { element, plain } from "../symbols";
import { targetsOf, withoutTime, type SystemDescription } from "./description";
import { aboutEnergy } from "./time";
import { vectorNames } from "./vectors";
import type { SystemAction, SystemState, View } from "./state";

type Do = (action: SystemAction) => void;
const TOLERANCES = ["1e-16", "1e-15", "1e-12", "1e-9", "1e-6"];
/** Names up to this length have two or three entries in a row. */
const SHORT = 6;

export class SystemControls {
  private readonly entries: { readonly input: HTMLInputElement; readonly of: (state: SystemState) => Exact }[] = [];
  private readonly selects: Record<string, HTMLSelectElement> = {};
  private readonly parts: Record<"projection" | "series", HTMLElement>;
  private readonly chips: HTMLButtonElement[];
  private readonly invariants: Conserved;
  private readonly saved = document.createElement("p");
  private readonly story = document.createElement("p");

  constructor(
    private readonly panel: HTMLElement,
    private readonly system: SystemDescription,
    private readonly act: Do,
    private readonly refuse: (message: string) => void,
    startOn: (wanted: Readonly<Record<string, Exact>>) => void,
  ) {
    this.invariants = new Conserved({ targets: targetsOf(system), text: numberText, refuse, startOn });
    const { components } = system;
    const numbered = components.map((name, k): [string, string] => [String(k), plain(name)]);
    this.heading("Start");
    this.starts();
    this.chips = components.map((name, k) => this.chip(name, k));
    this.parts = { projection: this.group("Axes of the projection"), series: this.group("Components over time") };
    const three = document.createElement("div");
    three.className = "row three";
    three.append(this.select("first axis", numbered), this.select("second axis", numbered), this.select("third axis", [["", "none"], ...numbered]));
    this.parts.projection.append(three);
    const chips = document.createElement("div");
    chips.className = "chips";
    chips.append(...this.chips);
    this.parts.series.append(chips);
    panel.append(...Object.values(this.parts));
    this.heading("Section and axes");
    const surfaces = system.surfaces.map(({ name, modulus }, k): [string, string] => [String(k), `${plain(name)} = 0${modulus ? ` mod ${modulus}` : ""}`]);
    this.pair(this.select("surface", surfaces), this.select("direction", [["1", "rising"], ["-1", "falling"], ["0", "both"]]));
    this.pair(
      this.select("horizontal axis", numbered.map(([value, text]) => [value, `→ ${text}`])),
      this.select("vertical axis", numbered.map(([value, text]) => [value, `↑ ${text}`])),
    );
    const tolerance = document.createElement("label");
    tolerance.className = "row labelled";
    tolerance.append("tolerance", this.select("tolerance", TOLERANCES.map((one) => [one, one])));
    panel.append(tolerance);
    if (system.invariants) this.heading("Conserved, now").append(this.invariants.reach);
    panel.append(this.invariants.list);
    const energy = aboutEnergy(system);
    if (energy) panel.append(Object.assign(document.createElement("p"), { className: "note", textContent: energy }));
    if (system.saved) this.heading("Saved result");
    this.saved.className = "saved";
    this.saved.setAttribute("role", "status");
    this.story.id = "story";
    this.story.textContent = system.words;
    panel.append(this.saved, this.story);
    this.listen();
  }

  private heading(text: string): HTMLElement {
    const heading = headed(text);
    this.panel.append(heading);
    return heading;
  }

  private group(title: string): HTMLElement {
    const group = document.createElement("div");
    group.className = "group";
    group.append(headed(title));
    return group;
  }

  private starts(): void {
    const { components, vector_length } = this.system;
    const own = withoutTime(this.system);
    const vectors = vector_length === 3 && own.length % 3 === 0 ? vectorNames(own) : [];
    const hasRows = vectors.length && vectors.every((name) => plain(name).length <= 2);
    if (hasRows) {
      vectors.forEach((vector, k) => {
        const row = document.createElement("div");
        row.className = "row";
        row.append(element(vector), ...[0, 1, 2].map((i) => this.input(components[3 * k + i], 3 * k + i)));
        this.panel.append(row);
      });
    }
    const rest = hasRows ? own.length : 0;
    const longest = components.slice(rest).reduce((most, name) => Math.max(most, plain(name).length), 0);
    const per = longest > SHORT ? 1 : vector_length === 3 && !rest ? 3 : 2;
    for (let first = rest; first < components.length; first += per) {
      const row = document.createElement("div");
      row.className = `row start${per}`;
      components.slice(first, first + per).forEach((name, k) => row.append(this.entry(name, first + k)));
      this.panel.append(row);
    }
  }

  private entry(name: string, index: number): HTMLElement {
    const label = document.createElement("label");
    label.className = "entry";
    label.append(element(name), this.input(name, index));
    return label;
  }

  private input(name: string, index: number): HTMLInputElement {
    const input = exactEntry(name, (to) => this.act({ do: "start", index, to }), this.refuse);
    this.entries.push({ input, of: (state) => state.start[index] });
    return input;
  }

  private chip(name: string, index: number): HTMLButtonElement {
    const chip = document.createElement("button");
    chip.type = "button";
    chip.append(element(name));
    chip.setAttribute("aria-label", `${plain(name)} over time`);
    chip.addEventListener("click", () => this.act({ do: "series", component: index, shown: chip.getAttribute("aria-pressed") !== "true" }));
    return chip;
  }

  private pair(one: HTMLElement, other: HTMLElement): void {
    const row = document.createElement("div");
    row.className = "row two";
    row.append(one, other);
    this.panel.append(row);
  }

  private select(name: string, choices: readonly (readonly [string, string])[]): HTMLSelectElement {
    const select = document.createElement("select");
    select.setAttribute("aria-label", name);
    select.append(...choices.map(([value, text]) => new Option(text, value)));
    this.selects[name] = select;
    return select;
  }

  private listen(): void {
    const at = (name: string) => Number(this.selects[name].value);
    const on = (names: readonly string[], does: () => void) => names.forEach((name) => this.selects[name].addEventListener("change", does));
    on(["surface", "direction"], () => this.act({ do: "surface", surface: at("surface"), direction: at("direction") as Direction }));
    on(["horizontal axis", "vertical axis"], () => this.act({ do: "axes", axes: [at("horizontal axis"), at("vertical axis")] }));
    on(["first axis", "second axis", "third axis"], () => {
      const third = this.selects["third axis"].value === "" ? null : at("third axis");
      this.act({ do: "space", space: [at("first axis"), at("second axis"), third] });
    });
    on(["tolerance"], () => this.act({ do: "tol", tol: exact(this.selects.tolerance.value) }));
  }

  show(state: SystemState, colours: readonly string[]): void {
    for (const { input, of } of this.entries) if (document.activeElement !== input) input.value = of(state).text.replace("-", "−");
    const set = (name: string, value: string) => (this.selects[name].value = value);
    set("surface", String(state.surface));
    set("direction", String(state.direction));
    set("horizontal axis", String(state.axes[0]));
    set("vertical axis", String(state.axes[1]));
    set("first axis", String(state.space[0]));
    set("second axis", String(state.space[1]));
    set("third axis", state.space[2] === null ? "" : String(state.space[2]));
    const tol = state.tol.text;
    const { tolerance } = this.selects;
    if (![...tolerance.options].some((option) => option.value === tol)) tolerance.append(new Option(tol, tol));
    tolerance.value = tol;
    for (const [view, part] of Object.entries(this.parts)) part.hidden = state.view !== (view as View);
    this.chips.forEach((chip, k) => {
      const place = state.series.indexOf(k);
      chip.setAttribute("aria-pressed", String(place >= 0));
      chip.style.setProperty("--colour", place >= 0 ? colours[place % colours.length] : "transparent");
    });
  }

  /** What is said of a saved result. */
  compare(words: string): void {
    if (this.saved.textContent !== words) this.saved.textContent = words;
  }

  /** Shows the invariants at a time. */
  conserved(results: Results, time: number): void {
    this.invariants.show(results, time);
  }
}

/** Six decimals, or an exponent where they would say nothing. */
export function numberText(value: number): string {
  const size = Math.abs(value);
  const text = size >= 1e5 || (size > 5e-13 && size < 1e-3) ? value.toExponential(4) : (size < 5e-13 ? 0 : value).toFixed(6);
  return text.replaceAll("-", "−");
}

function headed(text: string): HTMLElement {
  const heading = document.createElement("h3");
  heading.textContent = text;
  return heading;
}
