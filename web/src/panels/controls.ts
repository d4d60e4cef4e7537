/** Sliders with exact entry: one row for each vector, and one slider for the entry that was chosen last. */

import { components, families, parameters } from "../data/tops";
import type { Results } from "../results";
import { exact, shortest, type Exact } from "../state/exact";
import type { Direction } from "../state/everyday";
import type { Action, Frame, Laboratory } from "../state/laboratory";
import { element, plain } from "../symbols";
import { Conserved } from "./conserved";
import { exactEntry } from "./entry";

type Do = (action: Action) => void;
const VIEWS: readonly (readonly [Frame, string])[] = [["space", "body in space"], ["body", "from the body"], ["momentum", "energy ellipsoid"], ["rod", "elastic rod"]];
/** The energy and the Casimirs of every top: the start can be moved to values of them. */
export const PROJECTED = families[0].names;
const TOLERANCES = ["1e-16", "1e-15", "1e-12", "1e-9", "1e-6"];

/** Where a slider ends; an exact entry may go beyond. */
function reach(name: string): readonly [number, number] {
  if (name.startsWith("I")) return [0.1, 4];
  return name === "epsilon" ? [0, 2] : [-3, 3];
}

interface Entry {
  readonly name: string;
  readonly input: HTMLInputElement;
  readonly of: (lab: Laboratory) => Exact;
  readonly set: (to: Exact) => void;
}

export class ControlsPanel {
  private readonly entries: Entry[] = [];
  private readonly sliders: { readonly names: readonly string[]; chosen: string; readonly input: HTMLInputElement; readonly label: HTMLElement }[] = [];
  private readonly terms: HTMLElement[];
  private readonly invariants: Conserved;
  private readonly story = document.createElement("p");
  private readonly selects: Record<string, HTMLSelectElement> = {};
  private readonly shadow = document.createElement("input");

  constructor(
    private readonly panel: HTMLElement,
    private readonly act: Do,
    private readonly refuse: (message: string) => void,
    startOn: (wanted: Readonly<Record<string, Exact>>) => void,
  ) {
    const text = (value: number) => (Math.abs(value) < 5e-13 ? 0 : value).toFixed(6).replace("-", "−");
    this.invariants = new Conserved({ targets: PROJECTED, text, refuse, startOn });
    const equations = document.createElement("div");
    equations.className = "equations math";
    equations.append(...equationLines());
    equations.setAttribute("role", "img");
    equations.setAttribute("aria-label", "l dot = l × omega + alpha × a + beta × b; alpha dot = alpha × omega + epsilon beta × a; beta dot = beta × omega");
    this.terms = [...equations.querySelectorAll<HTMLElement>("[data-term]")];
    panel.append(equations);
    this.heading("Twist");
    this.rows(["epsilon"], parameters, "single");
    this.fold();
    this.heading("Moments and centres");
    this.rows(["I", "a", "b"], parameters);
    this.heading("Start");
    this.rows(["l", "alpha", "beta"], components);
    this.check();
    this.heading("Section and axes");
    this.pair("surface", "direction", components.map((name) => [name, `${plain(name)} = 0`]), [["1", "rising"], ["-1", "falling"], ["0", "both"]]);
    this.pair("across", "up", components.map((name) => [name, `→ ${plain(name)}`]), components.map((name) => [name, `↑ ${plain(name)}`]));
    this.labelled("tolerance", "tolerance", TOLERANCES.map((one) => [one, one]));
    this.labelled("frame", "view", VIEWS);
    this.heading("Conserved, now").append(this.invariants.reach);
    this.story.id = "story";
    panel.append(this.invariants.list, this.story);
    this.listen();
  }

  /** A narrow page shows the rest when it is asked to. */
  private fold(): void {
    const more = Object.assign(document.createElement("button"), { type: "button", className: "more" });
    const show = (folded: boolean) => {
      this.panel.classList.toggle("folded", folded);
      more.setAttribute("aria-expanded", String(!folded));
      more.textContent = folded ? "Moments, start, section …" : "Fewer entries";
    };
    more.addEventListener("click", () => show(!this.panel.classList.contains("folded")));
    show(true);
    this.panel.append(more);
  }

  private heading(text: string): HTMLElement {
    const heading = document.createElement("h2");
    heading.textContent = text;
    this.panel.append(heading);
    return heading;
  }

  /** Vectors with their entries, then the slider that they share. */
  private rows(vectors: readonly string[], among: readonly string[], kind = ""): void {
    const names = vectors.flatMap((vector) => among.filter((name) => name === vector || name.replace(/\d$/, "") === vector));
    const label = element(names[0]);
    const input = document.createElement("input");
    Object.assign(input, { type: "range", step: "0.01" });
    const slider = { names, chosen: names[0], input, label };
    this.sliders.push(slider);
    input.addEventListener("input", () => this.entries.find((one) => one.name === slider.chosen)?.set(shortest(Number(Number(input.value).toFixed(2)))));
    for (const vector of vectors) {
      const row = document.createElement("div");
      row.className = `row ${kind}`;
      row.append(element(vector));
      for (const name of names.filter((one) => one === vector || one.replace(/\d$/, "") === vector)) {
        if (kind === "single") row.append(input);
        row.append(this.entry(name, among, slider));
      }
      this.panel.append(row);
    }
    if (kind === "single") return;
    const line = document.createElement("div");
    line.className = "slide";
    line.append(label, input);
    this.panel.append(line);
  }

  private entry(name: string, among: readonly string[], slider: { chosen: string }): HTMLInputElement {
    const index = among.indexOf(name);
    const parameter = among === parameters;
    const set = (to: Exact) => this.act({ do: parameter ? "parameter" : "start", index, to });
    const input = exactEntry(name, set, this.refuse);
    input.addEventListener("focus", () => {
      slider.chosen = name;
      this.choose();
    });
    this.entries.push({ name, input, of: (lab) => (parameter ? lab.parameters : lab.start)[index], set });
    return input;
  }

  private check(): void {
    const label = document.createElement("label");
    label.className = "check";
    Object.assign(this.shadow, { type: "checkbox" });
    const key = document.createElement("kbd");
    key.textContent = "G";
    label.append(this.shadow, "Shadow top, 10⁻³ away", key);
    this.panel.append(label);
    this.shadow.addEventListener("change", () => this.act({ do: "view", view: { shadow: this.shadow.checked } }));
  }

  private pair(one: string, other: string, ofOne: [string, string][], ofOther: [string, string][]): void {
    const row = document.createElement("div");
    row.className = "row two";
    row.append(this.select(one, ofOne), this.select(other, ofOther));
    this.panel.append(row);
  }

  private labelled(name: string, words: string, choices: readonly (readonly [string, string])[]): void {
    const row = document.createElement("label");
    row.className = "row labelled";
    row.append(words, this.select(name, choices));
    this.panel.append(row);
  }

  private select(name: string, choices: readonly (readonly [string, string])[]): HTMLSelectElement {
    const select = document.createElement("select");
    select.setAttribute("aria-label", { across: "horizontal axis", up: "vertical axis" }[name] ?? name);
    select.append(...choices.map(([value, text]) => new Option(text, value)));
    this.selects[name] = select;
    return select;
  }

  private listen(): void {
    const { surface, direction, across, up, tolerance, frame } = this.selects;
    const section = () => this.act({ do: "surface", surface: surface.value, direction: Number(direction.value) as Direction });
    const axes = () => this.act({ do: "axes", axes: [across.value, up.value] });
    [surface, direction].forEach((select) => select.addEventListener("change", section));
    [across, up].forEach((select) => select.addEventListener("change", axes));
    tolerance.addEventListener("change", () => this.act({ do: "method", method: { kind: "taylor", tol: exact(tolerance.value) } }));
    frame.addEventListener("change", () => this.act({ do: "view", view: { frame: frame.value as Frame } }));
  }

  private lab: Laboratory | null = null;

  /** Shows a state. */
  show(lab: Laboratory, story: string): void {
    this.lab = lab;
    for (const { input, of } of this.entries) if (document.activeElement !== input || lab.preset) input.value = of(lab).text.replace("-", "−");
    const { surface, direction, across, up, tolerance, frame } = this.selects;
    [surface.value, direction.value, across.value, up.value, frame.value] = [lab.surface, String(lab.direction), ...lab.axes, lab.view.frame];
    const tol = lab.method.tol.text;
    if (![...tolerance.options].some((option) => option.value === tol)) tolerance.append(new Option(tol, tol));
    tolerance.value = tol;
    this.shadow.checked = lab.view.shadow;
    this.story.textContent = story;
    this.choose();
    const numbers = lab.parameters.map((one) => one.value);
    const on: Record<string, boolean> = { a: numbers.slice(3, 6).some(Boolean), b: numbers.slice(6, 9).some(Boolean), twist: numbers[9] !== 0 && numbers.slice(3, 6).some(Boolean) };
    for (const term of this.terms) {
      const active = on[term.dataset.term as string];
      term.classList.toggle("off", !active);
      term.classList.toggle("lit", active && term.dataset.term === "twist");
    }
  }

  private choose(): void {
    for (const { names, chosen, input, label } of this.sliders) {
      const value = this.lab && this.entries.find((one) => one.name === chosen)?.of(this.lab).value;
      const [low, high] = reach(chosen);
      Object.assign(input, { min: String(low), max: String(high), value: String(value ?? 0) });
      input.style.setProperty("--fill", `${((Math.min(Math.max(value ?? 0, low), high) - low) / (high - low)) * 100}%`);
      input.setAttribute("aria-label", plain(chosen));
      label.replaceChildren(...element(chosen).childNodes);
      for (const { name, input: entry } of this.entries) if (names.includes(name)) entry.classList.toggle("chosen", name === chosen && names.length > 1);
    }
  }

  /** Shows the invariants at a time. */
  conserved(results: Results, time: number): void {
    this.invariants.show(results, time);
  }
}

/** The equations of motion, by spans: class for the colour, data-term for what can be absent. */
function equationLines(): HTMLElement[] {
  const vector = (name: string, letter: string, dot = false) => {
    const found = document.createElement("span");
    found.className = `${name}${dot ? " dot" : ""}`;
    found.textContent = letter;
    return found;
  };
  const term = (name: string, ...parts: (string | Node)[]) => {
    const found = document.createElement("span");
    found.className = "term";
    found.dataset.term = name;
    found.append(...parts);
    return found;
  };
  const line = (...parts: (string | Node)[]) => {
    const found = document.createElement("div");
    found.append(...parts);
    return found;
  };
  const small = document.createElement("small");
  small.textContent = "ω = I⁻¹ℓ";
  return [
    line(vector("l", "ℓ", true), " = ", vector("l", "ℓ"), " × ω", term("a", "+ ", vector("alpha", "α"), " × ", vector("a", "a")), term("b", "+ ", vector("beta", "β"), " × ", vector("b", "b"))),
    line(vector("alpha", "α", true), " = ", vector("alpha", "α"), " × ω ", term("twist", "+ ε ", vector("beta", "β"), " × ", vector("a", "a"))),
    line(vector("beta", "β", true), " = ", vector("beta", "β"), " × ω, ", small),
  ];
}

