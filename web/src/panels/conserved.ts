/** What is conserved, now; a value that is entered moves the start to the nearest state that has it. */

import type { Results } from "../results";
import { exact, type Exact } from "../state/exact";
import { element, plain } from "../symbols";
import { stepsByArrows } from "./entry";

interface Does {
  /** Invariants to whose values the start can be moved. */
  readonly targets: readonly string[];
  readonly text: (value: number) => string;
  readonly refuse: (message: string) => void;
  readonly startOn: (wanted: Readonly<Record<string, Exact>>) => void;
}

export class Conserved {
  readonly list = document.createElement("dl");
  /** What a value is entered for; a button that moves the start, once one is. */
  readonly reach = document.createElement("span");
  private readonly hint = Object.assign(document.createElement("em"), { textContent: "enter a value", title: "The start moves to the nearest state that has it" });
  private readonly button = document.createElement("button");
  /** Values that were entered, and that the start does not have yet. */
  private wanted: Record<string, Exact> = {};
  /** Entries that the user has written into. */
  private readonly drafts = new Set<string>();
  private named: readonly string[] | null = null;
  private values: HTMLElement[] = [];
  private of: Results | null = null;

  constructor(private readonly does: Does) {
    this.list.id = "invariants";
    this.reach.className = "reach";
    this.reach.append(this.hint, this.button);
    Object.assign(this.button, { type: "button", hidden: true, textContent: "start there ⏎", title: "Move the start to the nearest state with these values (Enter)" });
    this.button.addEventListener("click", () => this.project());
  }

  /** Shows the invariants at a time. */
  show(results: Results, time: number): void {
    if (results !== this.of) {
      this.of = results;
      this.forget();
    }
    if (results.names.join("\n") !== this.named?.join("\n")) this.begin(results.names);
    results.top.values(time)?.forEach((value, k) => {
      const text = this.does.text(value);
      const shown = this.values[k];
      if (shown instanceof HTMLInputElement) {
        if (!this.drafts.has((this.named as readonly string[])[k]) && shown.value !== text) shown.value = text;
      } else if (shown && shown.textContent !== text) shown.textContent = text;
    });
  }

  private begin(names: readonly string[]): void {
    this.named = names;
    this.values = names.map((name) => (this.does.targets.includes(name) ? this.target(name) : document.createElement("dd")));
    this.list.replaceChildren(
      ...names.flatMap((name, k) => {
        const term = document.createElement("dt");
        term.append(element(name));
        const value = this.values[k];
        if (value.tagName === "DD") return [term, value];
        const description = document.createElement("dd");
        description.append(value);
        return [term, description];
      }),
    );
  }

  /** An entry for the value that an invariant is to have. */
  private target(name: string): HTMLInputElement {
    const input = document.createElement("input");
    Object.assign(input, { type: "text", autocomplete: "off", spellcheck: false, maxLength: 40 });
    input.setAttribute("aria-label", `${plain(name)}, value that the start is to have`);
    input.addEventListener("focus", () => input.select());
    input.addEventListener("input", () => this.drafts.add(name));
    stepsByArrows(input);
    input.addEventListener("change", () => this.read(name, input));
    input.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && this.read(name, input)) this.project();
      else if (event.key === "Escape") this.forget();
    });
    return input;
  }

  /** Whether what was written is a value. */
  private read(name: string, input: HTMLInputElement): boolean {
    if (!this.drafts.has(name)) return true;
    try {
      this.wanted[name] = exact(input.value);
      if (input.hasAttribute("aria-invalid")) this.does.refuse("");
      input.removeAttribute("aria-invalid");
    } catch (error) {
      delete this.wanted[name];
      input.setAttribute("aria-invalid", "true");
      this.does.refuse(`${plain(name)}: ${(error as Error).message}`);
    }
    input.classList.toggle("chosen", name in this.wanted);
    this.offer();
    return name in this.wanted;
  }

  private offer(): void {
    this.button.hidden = Object.keys(this.wanted).length === 0;
    this.hint.hidden = !this.button.hidden;
  }

  private project(): void {
    if (Object.keys(this.wanted).length) this.does.startOn(this.wanted);
  }

  /** The values that were entered are no longer wanted. */
  private forget(): void {
    this.wanted = {};
    this.drafts.clear();
    this.offer();
    for (const shown of this.values) {
      shown.classList.remove("chosen");
      shown.removeAttribute("aria-invalid");
    }
  }
}
