/** The fields in which a system is typed, and what the core derives from it: parameters, equations, tensor, Casimirs. */

import { exact } from "../../state/exact";
import { stepsByArrows } from "../../panels/entry";
import { element, plain } from "../../symbols";
import { BRACKETS, draftOf, EXAMPLES, KINDS, numbersOf, rangeOf, withNumber, type Draft, type Given } from "./draft";
import { expression, math, name as symbolOf, pair, rate, sign } from "./mathml";
import { words, type Made, type NotMade } from "./made";

/** Letters of the formula that are shown around the wrong one. */
const AROUND = 16;
/** Entries of a tensor that are listed. */
const MOST_LISTED = 60;

interface Row {
  readonly name: string;
  readonly slider: HTMLInputElement;
  readonly input: HTMLInputElement;
  readonly ends: readonly HTMLInputElement[];
}

type Change = (draft: Draft) => void;

export class Editor {
  readonly element = document.createElement("div");
  private readonly example: HTMLSelectElement;
  private readonly kind: HTMLSelectElement;
  private readonly fields: Record<"coordinates" | "momenta" | "angles", HTMLInputElement>;
  private readonly rows: Record<"coordinates" | "momenta" | "angles" | "entries", HTMLElement>;
  private readonly entries = document.createElement("textarea");
  private readonly formula = document.createElement("textarea");
  private readonly wrongs: Record<NotMade["field"], HTMLElement>;
  private readonly parameters = document.createElement("div");
  private readonly derived = document.createElement("div");
  private numbers: readonly Row[] = [];
  private listed = "";
  private shownEquations = "";
  /** What was typed for each bracket, so that a look at another one loses nothing. */
  private readonly left = new Map<string, Draft>();

  constructor(private draft: Draft, private readonly change: Change, files: readonly HTMLElement[]) {
    this.element.id = "typing";
    this.example = select("begin with an example", [["", "begin with an example …"], ...EXAMPLES.map(({ key, words }) => [key, words] as const)]);
    this.kind = select("bracket", KINDS);
    this.fields = {
      coordinates: textInput("coordinates", "x, y   or 2 for q1, q2"),
      momenta: textInput("momenta", "p_x, p_y"),
      angles: textInput("angles", "none"),
    };
    const { coordinates, momenta, angles } = this.fields;
    area(this.entries, "entries of the bracket, one a line", 4);
    area(this.formula, "Hamiltonian", 3);
    this.formula.id = "hamiltonian";
    this.rows = {
      coordinates: labelled("coordinates", coordinates),
      momenta: labelled("momenta", momenta),
      angles: labelled("angles", angles),
      entries: this.entries,
    };
    this.wrongs = { bracket: wrong("wrong-bracket"), hamiltonian: wrong("wrong-hamiltonian") };
    this.formula.setAttribute("aria-describedby", "wrong-hamiltonian");
    this.entries.setAttribute("aria-describedby", "wrong-bracket");
    const { bracket, hamiltonian } = this.wrongs;
    const { rows } = this;
    const title = Object.assign(document.createElement("h2"), { className: "unseen", textContent: "The system" });
    this.element.append(
      title, this.example, heading("Bracket"), this.kind, rows.coordinates, rows.momenta, rows.angles, rows.entries, bracket,
      heading("Hamiltonian"), this.formula, hamiltonian, this.parameters, this.derived, row(files),
    );
    this.listen();
    this.fill();
  }

  private listen(): void {
    this.example.addEventListener("change", () => {
      if (!this.example.value) return;
      this.adopt(draftOf(this.example.value));
      this.example.value = "";
    });
    this.kind.addEventListener("change", () => this.turnTo(this.kind.value));
    for (const [name, input] of Object.entries(this.fields)) input.addEventListener("input", () => this.set({ ...this.draft, [name]: input.value, start: name === "coordinates" ? [] : this.draft.start }));
    this.entries.addEventListener("input", () => this.set({ ...this.draft, entries: this.entries.value }));
    this.formula.addEventListener("input", () => this.set({ ...this.draft, hamiltonian: this.formula.value }));
  }

  /** Another bracket, with what was typed for it before, or with its first example. */
  private turnTo(kind: string): void {
    this.left.set(this.draft.bracket, this.draft);
    const example = EXAMPLES.find(({ bracket }) => bracket === kind);
    const first = BRACKETS[kind];
    const vector = first && Object.keys(first.fields)[0];
    const before = this.left.get(kind) ?? (example ? draftOf(example.key) : { ...draftOf(""), bracket: kind, coordinates: "", hamiltonian: `dot(${vector}, inv(I)*${vector})/2`, parameters: { I: ["1", "2", "3"] }, start: [], name: "", unit: 1 });
    this.adopt(before);
  }

  private adopt(draft: Draft): void {
    this.open(draft);
    this.change(draft);
  }

  /** Shows what somebody else has typed. */
  open(draft: Draft): void {
    this.draft = draft;
    this.fill();
  }

  /** What is typed is no longer what an example is called; with other numbers it still is. */
  private set(draft: Draft, name = ""): void {
    this.draft = { ...draft, name };
    this.change(this.draft);
  }

  private fill(): void {
    const { draft, rows } = this;
    this.kind.value = draft.bracket;
    for (const [name, input] of Object.entries(this.fields)) input.value = draft[name as keyof typeof this.fields];
    this.entries.value = draft.entries;
    this.formula.value = draft.hamiltonian;
    this.fields.momenta.placeholder = words(draft.coordinates).map((name) => `p_${name}`).join(", ");
    rows.coordinates.hidden = draft.bracket in BRACKETS;
    rows.momenta.hidden = rows.angles.hidden = draft.bracket !== "canonical";
    rows.entries.hidden = draft.bracket !== "tensor";
  }

  /** What is wrong, below the letter where it is. */
  wrong(found: NotMade): void {
    for (const [field, box] of Object.entries(this.wrongs)) {
      const here = field === found.field;
      const inputs = field === "hamiltonian" ? [this.formula] : [this.entries, this.fields.coordinates, this.fields.angles];
      inputs.forEach((input) => (here ? input.setAttribute("aria-invalid", "true") : input.removeAttribute("aria-invalid")));
      box.hidden = !here;
      if (!here) continue;
      const content: (Node | string)[] = [];
      if (found.place >= 0) content.push(excerpt(found.text, found.place));
      content.push(found.message);
      if (found.offered !== null) content.push(" ", this.offer(found.offered));
      box.replaceChildren(...content);
    }
    this.derived.classList.add("old");
  }

  private offer(name: string): HTMLElement {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: `${name} is a parameter` });
    button.addEventListener("click", () => {
      this.formula.focus();
      this.set({ ...this.draft, parameters: { ...this.draft.parameters, [name]: "1" } });
    });
    return button;
  }

  /** What follows from a draft that can be read; gives the draft with the parameters that it has made. */
  right(found: Made): Draft {
    for (const box of Object.values(this.wrongs)) box.hidden = true;
    for (const input of [this.formula, this.entries, ...Object.values(this.fields)]) input.removeAttribute("aria-invalid");
    this.draft = { ...this.draft, parameters: { ...this.draft.parameters, ...found.parameters } };
    this.derived.classList.remove("old");
    this.sliders(found.parameters);
    this.equations(found);
    return this.draft;
  }

  private sliders(parameters: Readonly<Record<string, Given>>): void {
    const numbers = numbersOf(parameters);
    const names = numbers.map(({ name }) => name).join();
    if (names !== this.listed) {
      this.listed = names;
      this.numbers = numbers.map(({ name, of, place }) => this.number(name, of, place));
      const rows = this.numbers.map(({ name, slider, input, ends }) => parameterRow(name, slider, input, ends));
      this.parameters.replaceChildren(...(rows.length ? [heading("Parameters"), ...rows] : []));
    }
    this.numbers.forEach(({ name, slider, input, ends }, k) => {
      const { text } = numbers[k];
      if (document.activeElement !== input) input.value = text.replace("-", "−");
      this.show(name, text, slider, ends);
    });
  }

  private show(name: string, text: string, slider: HTMLInputElement, ends: readonly HTMLInputElement[]): void {
    const range = slider.dataset.moving ? ends.map(({ value }) => value.replace("−", "-")) : rangeOf(this.draft, name, text);
    ends.forEach((end, k) => document.activeElement !== end && (end.value = range[k].replace("-", "−")));
    const [low, high, step] = range.map((one) => exact(one).value);
    Object.assign(slider, { min: String(low), max: String(high), step: String(step) });
    const value = exact(text).value;
    if (!slider.dataset.moving) slider.value = String(value);
    slider.style.setProperty("--fill", `${Math.min(Math.max((value - low) / (high - low), 0), 1) * 100}%`);
    slider.setAttribute("aria-valuetext", text);
  }

  private number(name: string, of: string, place: number | null): Row {
    const slider = document.createElement("input");
    slider.type = "range";
    slider.setAttribute("aria-label", plain(name));
    const input = textInput(`${plain(name)}, exact value`, "");
    const ends = ["from", "to", "step"].map((word) => textInput(`${plain(name)}, slider ${word}`, word));
    const set = (text: string) => this.set(withNumber(this.draft, of, place, text), this.draft.name);
    // the range stays while the slider moves, and after that as it was
    const keepRange = () => {
      if (name in this.draft.ranges) return;
      const texts = ends.map(({ value }) => value.replace("−", "-"));
      this.draft = { ...this.draft, ranges: { ...this.draft.ranges, [name]: [texts[0], texts[1], texts[2]] } };
    };
    slider.addEventListener("input", () => {
      keepRange();
      const digits = Math.max(0, -Math.floor(Math.log10(Number(slider.step)) + 1e-9)) + 1;
      const text = String(Number(Number(slider.value).toFixed(Math.min(digits, 12))));
      input.value = text.replace("-", "−");
      set(text);
    });
    readNumber(input, (text) => set(text));
    ends.forEach((end, k) =>
      readNumber(end, (text) => {
        keepRange();
        const range = this.draft.ranges[name].with(k, text);
        const [low, high, step] = range.map((one) => exact(one).value);
        if (!(low < high && step > 0)) throw new Error("a slider goes from one number to a larger one, by steps above 0");
        this.set({ ...this.draft, ranges: { ...this.draft.ranges, [name]: [range[0], range[1], range[2]] } }, this.draft.name);
      }),
    );
    return { name, slider, input, ends };
  }

  private equations({ written, casimirs, system }: Made): void {
    const { names, energy, rates, tensor } = written;
    const key = JSON.stringify([written, casimirs, system.invariants?.names]);
    if (key === this.shownEquations) return;
    this.shownEquations = key;
    const parts: HTMLElement[] = [heading("Equations of motion")];
    if (!energy || !rates || !tensor) {
      parts.push(note("The equations are too long to be read here. The orbit is computed all the same."));
    } else {
      parts.push(formulas("Equations of motion", rates.map((one, k) => math(rate(names[k]), sign("="), expression(one)))));
      const entries = tensor.slice(0, MOST_LISTED).map(([i, j, entry]) => math(...pair(names[i], names[j]), sign("="), expression(entry)));
      const rest = tensor.length > MOST_LISTED ? ` (the first ${MOST_LISTED} of ${tensor.length})` : "";
      parts.push(unfolded(`Poisson tensor, all other pairs are 0${rest}`, formulas("Poisson tensor", entries)));
    }
    parts.push(heading("Casimirs"));
    if (casimirs === null) parts.push(note("Not searched. The Python package looks for them: system.bracket.casimirs()."));
    else if (casimirs.length === 0) parts.push(note("None: a canonical bracket has none."));
    else parts.push(formulas("Casimirs", casimirs.map((one, k) => math(symbolOf(`C${k + 1}`), sign("="), ...polynomial(one)))));
    this.derived.replaceChildren(...parts);
  }
}

/** A polynomial with whole coefficients, as the data of brackets have Casimirs: 2*alpha1*l2^2 - ... */
function polynomial(text: string): Element[] {
  const terms = [...text.matchAll(/([+-]?)([^+-]+)/g)];
  return terms.flatMap(([, before, term], k) => {
    const factors = term.split("*").map((factor) => {
      const [base, power] = factor.split("^");
      const written = /^\d+$/.test(base) ? (["number", base] as [string, string]) : base;
      return power === undefined ? written : (["^", written, ["number", power]] as [string, ...unknown[]]);
    });
    const opening = k === 0 && before !== "-" ? [] : [sign(before === "-" ? "−" : "+")];
    return [...opening, expression(["/", factors, []])];
  });
}

function excerpt(text: string, place: number): HTMLElement {
  const from = Math.max(0, place - AROUND);
  const piece = text.slice(from, place + AROUND + 1).replaceAll("\n", " ");
  const [before, after] = [from > 0 ? "…" : "", text.length > place + AROUND + 1 ? "…" : ""];
  const shown = document.createElement("pre");
  shown.textContent = `${before}${piece}${after}\n${" ".repeat(before.length + place - from)}^`;
  shown.setAttribute("role", "img");
  shown.setAttribute("aria-label", `at letter ${place + 1}`);
  return shown;
}

/** Reads an exact number when it was entered; what is none stays in its field. */
function readNumber(input: HTMLInputElement, set: (text: string) => void): void {
  stepsByArrows(input);
  input.addEventListener("change", () => {
    try {
      set(exact(input.value).text);
      input.removeAttribute("aria-invalid");
      input.setCustomValidity("");
    } catch (error) {
      input.setAttribute("aria-invalid", "true");
      input.setCustomValidity((error as Error).message);
      input.reportValidity();
    }
  });
}

function parameterRow(name: string, slider: HTMLInputElement, input: HTMLInputElement, ends: readonly HTMLInputElement[]): HTMLElement {
  const found = document.createElement("div");
  found.className = "parameter";
  const more = document.createElement("button");
  Object.assign(more, { type: "button", textContent: "⋯", title: "Range and step of the slider" });
  more.setAttribute("aria-label", `range of ${plain(name)}`);
  more.setAttribute("aria-expanded", "false");
  const range = document.createElement("div");
  const words = ["from", "to", "step"].map((word, k) => {
    const label = document.createElement("label");
    label.append(word, ends[k]);
    return label;
  });
  range.append(...words);
  range.hidden = true;
  more.addEventListener("click", () => {
    range.hidden = !range.hidden;
    more.setAttribute("aria-expanded", String(!range.hidden));
  });
  found.append(element(name), slider, input, more, range);
  return found;
}

function heading(text: string): HTMLElement {
  return Object.assign(document.createElement("h3"), { textContent: text });
}

function note(text: string): HTMLElement {
  return Object.assign(document.createElement("p"), { className: "note", textContent: text });
}

function wrong(id: string): HTMLElement {
  const box = Object.assign(document.createElement("div"), { id, className: "wrong", hidden: true });
  box.setAttribute("role", "status");
  return box;
}

function row(items: readonly HTMLElement[]): HTMLElement {
  const found = document.createElement("div");
  found.className = "row files";
  found.append(...items);
  return found;
}

function formulas(label: string, lines: readonly Element[]): HTMLElement {
  const found = document.createElement("div");
  found.className = "formulas";
  found.tabIndex = 0;
  found.setAttribute("role", "group");
  found.setAttribute("aria-label", label);
  found.append(
    ...lines.map((line) => {
      const one = document.createElement("div");
      one.append(line);
      return one;
    }),
  );
  return found;
}

function unfolded(title: string, content: HTMLElement): HTMLElement {
  const details = document.createElement("details");
  details.className = "unfolded";
  details.append(Object.assign(document.createElement("summary"), { textContent: title }), content);
  return details;
}

function labelled(text: string, input: HTMLInputElement): HTMLElement {
  const label = document.createElement("label");
  label.className = "row labelled";
  label.append(text, input);
  return label;
}

function textInput(label: string, placeholder: string): HTMLInputElement {
  const input = document.createElement("input");
  Object.assign(input, { type: "text", autocomplete: "off", spellcheck: false, maxLength: 200, placeholder, autocapitalize: "off" });
  input.setAttribute("aria-label", label);
  return input;
}

function area(input: HTMLTextAreaElement, label: string, rows: number): void {
  Object.assign(input, { rows, spellcheck: false, maxLength: 4000, autocapitalize: "off", autocomplete: "off" });
  input.setAttribute("aria-label", label);
}

function select(label: string, choices: readonly (readonly [string, string])[]): HTMLSelectElement {
  const found = document.createElement("select");
  found.setAttribute("aria-label", label);
  found.append(...choices.map(([value, text]) => new Option(text, value)));
  return found;
}
