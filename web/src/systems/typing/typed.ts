/** The page of a system that is typed: a draft, the last system that could be made of it, and the page that shows this. */

import { exact } from "../../state/exact";
import { place } from "../../state/place";
import { save } from "../../export/menu";
import { Client, program } from "../../worker/client";
import { notStarted, tell } from "../../page";
import { SystemPage } from "../page";
import { begun, type SystemState } from "../state";
import { read, written } from "../url";
import { Compiler } from "./compiler";
import { checksum, draftOf, draftRead, draftWritten, exampleOf, isTyped, type Draft } from "./draft";
import { Editor } from "./editor";
import { asPython, systemFile } from "./files";
import type { Made, NotMade } from "./made";

export class TypedPage {
  private draft: Draft;
  /** The last system that could be made, and what was typed for it. */
  private made: Made | null = null;
  private good: Draft;
  private page: SystemPage | null = null;
  private client: Client | null = null;
  private readonly compiler = new Compiler(program);
  private readonly editor: Editor;
  /** The empty panels, from which those of another system are made. */
  private readonly empty = document.querySelector("main") as HTMLElement;
  /** What an address says of the state of the next system, and whether that is to play where somebody outside says so. */
  private rest = "";
  private playing: boolean | null = null;
  /** The number of a tour with which it begins. */
  private tour = new URLSearchParams(place().address).get("tour");
  /** What is wrong with what is typed, as it was last reported. */
  private wrong = "";

  constructor() {
    document.documentElement.dataset.typed = "1";
    this.draft = draftOf("");
    try {
      ({ draft: this.draft, rest: this.rest } = draftRead(place().address));
    } catch (error) {
      tell(`This address cannot be read: ${(error as Error).message}. The page begins with an example instead.`);
    }
    this.good = this.draft;
    const file = button("System file", "Save as a file that the Python package reads", () => this.save());
    this.editor = new Editor(this.draft, (draft) => this.change(draft), [file]);
    addEventListener("pagehide", () => {
      if (isTyped(location.hash)) history.replaceState(null, "", `#${this.address()}`);
    });
  }

  async begin(): Promise<void> {
    place().follow({ adopt: (...said) => this.adopt(...said), tell });
    void this.compiler.ask(this.draft, null, (found) => this.take(found));
    try {
      this.client = await Client.start((update) => this.page?.take(update), (message) => this.page?.refuse(message));
      this.page?.follow(this.client);
    } catch (error) {
      notStarted(error as Error);
    }
  }

  /** A picture there is, even where nothing can be made of what an address has. */
  private showExample(): void {
    const draft = draftOf("");
    void this.compiler.ask(draft, null, (found) => {
      if (!found.made || this.page) return;
      this.good = draft;
      this.show({ ...found, system: { ...found.system, id: checksum(draft) } }, null);
    });
  }

  private start() {
    const state = this.page?.now;
    return state && this.made ? { names: this.made.system.components, values: state.start.map(({ value }) => value) } : null;
  }

  private change(draft: Draft): void {
    this.draft = draft;
    void this.compiler.ask(draft, this.start(), (found) => this.take(found));
    this.keep();
  }

  private keep(): void {
    place().keep(() => this.address(), this.page?.now.playing ?? false);
  }

  /** What was typed, and its state, as somebody outside set them; where it is the same system, what is wrong in a field stays. */
  private adopt(address: string, playing: boolean, sameTime: boolean): void {
    this.wrong = "";
    try {
      const { draft, rest } = draftRead(address);
      if (this.page && checksum(draft) === this.made?.system.id) {
        this.page.adopt(rest || written(this.made.system, this.page.now), playing, sameTime);
        return;
      }
      [this.rest, this.playing] = [rest, playing];
      this.draft = draft;
      this.editor.open(draft);
      // what the page has is told once this is read
      void this.compiler.ask(draft, this.start(), (found) => this.take(found));
    } catch (error) {
      tell(`This state cannot be shown: ${(error as Error).message}.`);
      this.keep();
    }
  }

  private report(wrong: string): void {
    if (wrong !== this.wrong) place().report((this.wrong = wrong));
  }

  private take(found: Made | NotMade): void {
    document.documentElement.toggleAttribute("data-stale", !found.made);
    if (!found.made) {
      this.editor.wrong(found);
      this.report(found.message);
      this.keep();
      if (!this.page) this.showExample();
      return;
    }
    this.report("");
    this.draft = this.good = this.editor.right(found);
    const system = { ...found.system, id: checksum(this.draft) };
    const made = { ...found, system };
    let state: SystemState | null = null;
    if (this.rest) {
      try {
        const query = new URLSearchParams(this.rest);
        // the formula may have been mended since, of the draft that the address has
        query.set("system", system.id);
        state = read(system, query.toString());
        if (this.playing !== null) state = { ...state, playing: this.playing };
      } catch (error) {
        tell(`The state in this address cannot be read: ${(error as Error).message}. The system is shown from its own start.`);
      }
    }
    [this.rest, this.playing] = ["", null];
    this.show(made, state);
    if (this.tour !== null) this.page?.guide(this.tour);
    this.tour = null;
  }

  /** Shows a system: with the same components in the same panels, else in new ones. */
  private show(made: Made, state: SystemState | null): void {
    const before = this.made?.system;
    const { system } = made;
    const shape = (one: typeof system) => JSON.stringify([one.components, one.turns, one.vector_length, one.unit, one.invariants?.names]);
    const isSame = before !== undefined && shape(before) === shape(system);
    this.made = made;
    if (this.page && isSame) {
      // an example begins where it begins
      const own = before.start.join() !== system.start.join() ? system.start.map(exact) : null;
      this.page.replace(system, own, state);
    } else {
      this.anew(made, state);
    }
  }

  private anew({ system }: Made, state: SystemState | null): void {
    const focused = document.activeElement as HTMLElement | null;
    const { theme, playing, speed } = this.page?.now ?? begun(system);
    this.page?.leave();
    const panels = this.page ? (this.template.cloneNode(true) as HTMLElement) : this.empty;
    if (this.page) document.querySelector("main")?.replaceWith(panels);
    else this.template = this.empty.cloneNode(true) as HTMLElement;
    panels.querySelector("#controls")?.append(this.editor.element);
    this.page = new SystemPage(system, {
      address: () => this.address(),
      lines: () => this.lines(),
      facts: () => this.file().trim().split("\n"),
      example: () => exampleOf(this.draft),
    });
    this.page.open(state ?? { ...begun(system), theme, playing, speed });
    if (this.client) this.page.follow(this.client);
    if (focused && this.editor.element.contains(focused)) focused.focus();
  }

  private template!: HTMLElement;

  /** The draft and the state, as they are now. */
  private address(): string {
    const kept = place().keepsMistakes || !this.made ? this.draft : this.good;
    const draft = draftWritten(kept).toString();
    if (!this.page || !this.made) return draft;
    const state = new URLSearchParams(written(this.made.system, this.page.now));
    state.set("system", checksum(kept));
    return `${draft}&${state}`.replaceAll("%2C", ",").replaceAll("%2F", "/").replaceAll("%3A", ":").replaceAll("%3B", ";").replaceAll("%5E", "^").replaceAll("%28", "(").replaceAll("%29", ")");
  }

  private save(): void {
    if (this.made) save("system.toml", new Blob([this.file()], { type: "application/toml" }));
  }

  /** Whether all that was typed has been read. */
  rests(): boolean {
    return this.compiler.rests;
  }

  lines(): string {
    return this.made && this.page ? asPython(this.good, this.made, this.page.now) : "";
  }

  file(): string {
    return this.made ? systemFile(this.good, this.made) : "";
  }
}

function button(text: string, title: string, act: () => void): HTMLButtonElement {
  const found = document.createElement("button");
  Object.assign(found, { type: "button", textContent: text, title });
  found.addEventListener("click", act);
  return found;
}
