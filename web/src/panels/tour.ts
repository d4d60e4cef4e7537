/**
 * Guided tours: a choice of them, and a box that goes through the steps of one.  Each step sets a state of the laboratory and
 * points at a panel; leaving early brings the old state back.  The page of tops and those of systems share it.
 */

import { addressOf, checkSteps, LONGEST, tourOf, type Tour } from "../data/tour";
import { tours } from "../data/tours";
import { Refused } from "../state/everyday";
import { place } from "../state/place";
import { CARRIED } from "../systems/description";

/** What a tour does with the page in which it runs. */
export interface Stage<State> {
  /** The system of the page; none on that of tops. */
  system(): string | undefined;
  now(): State;
  set(state: State): void;
  /** The state of an address, seen as the present one is: with its theme, at rest or not.  Throws `Refused`. */
  read(address: string): State;
  tell(message: string): void;
}

/** An address that is a tour: its text, or the number of one that the page brings. */
const LINK = "tour=";
const NUMBER = /^tour=([1-9]\d?)$/;

export class Tours<State> {
  private tour: Tour | null = null;
  private at = 0;
  private before: State | null = null;
  private focused: Element | null = null;
  private readonly title = heading("tour-h");
  private readonly words = document.createElement("p");
  private readonly back = button("Back", () => this.go(this.at - 1));
  private readonly next = button("Next", () => this.go(this.at + 1));
  private readonly leave = button("Leave", () => this.end(true));
  private readonly link = button("Copy link", () => void this.share());
  /** The text of a tour from outside. */
  private text = "";

  constructor(private readonly choice: HTMLDialogElement, private readonly box: HTMLDialogElement, private readonly stage: Stage<State>) {
    const [said, row] = [document.createElement("div"), document.createElement("div")];
    said.setAttribute("aria-live", "polite");
    said.append(this.title, this.words);
    row.className = "row-of-buttons";
    this.leave.className = this.back.className = this.link.className = "plain";
    row.append(this.leave, this.link, this.back, this.next);
    box.append(said, row);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.end(true);
      else if (event.key === "ArrowRight") this.go(this.at + 1);
      else if (event.key === "ArrowLeft") this.go(this.at - 1);
      else return;
      event.preventDefault();
    });
  }

  /** Shows the choice. */
  choose(): void {
    if (this.box.open) return;
    this.fill();
    this.choice.showModal();
  }

  isLink(address: string): boolean {
    return address.startsWith(LINK);
  }

  /** Begins the tour that an address is. */
  follow(address: string): void {
    const number = NUMBER.exec(address)?.[1];
    if (number !== undefined) {
      const tour = tours[Number(number) - 1];
      if (tour && tour.system === this.stage.system()) this.begin(tour);
      else this.refuse("link", tour ? `it is for the page of ${tour.system ?? "tops"}, where Tours leads` : `the page has tours 1 to ${tours.length}`);
      return;
    }
    // a text has at most twelve characters of a link for one of its own
    if (address.length > 12 * LONGEST) this.refuse("link", "it is too long");
    else this.open("link", () => decodeURIComponent(address.slice(LINK.length)));
  }

  private fill(): void {
    const list = document.createElement("ul");
    const here = tours.filter(({ system }) => system === this.stage.system());
    for (const tour of here) {
      const item = document.createElement("li");
      const choose = button(tour.title, () => this.begin(tour));
      choose.append(small(tour.about));
      item.append(choose);
      list.append(item);
    }
    for (const tour of tours) if (!here.includes(tour)) list.append(elsewhere(tour));
    const file = Object.assign(document.createElement("input"), { type: "file", accept: ".json,application/json" });
    file.addEventListener("change", () => void this.readFile(file));
    const label = document.createElement("label");
    label.append("A tour from a file ", file);
    const form = Object.assign(document.createElement("form"), { method: "dialog" });
    form.append(Object.assign(document.createElement("button"), { textContent: "Close" }));
    this.choice.replaceChildren(Object.assign(heading("tours-h"), { textContent: "Guided tours" }), list, label, form);
  }

  private async readFile(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    if (!file) return;
    // a character has at most four bytes
    if (file.size > 4 * LONGEST) this.refuse("file", `it is too long: ${file.size} bytes`);
    else {
      const text = await file.text();
      this.open("file", () => text);
    }
    input.value = "";
  }

  /** Begins a tour from outside, if each of its steps can be shown. */
  private open(what: string, given: () => string): void {
    try {
      const text = given();
      const tour = tourOf(text);
      if (tour.system !== this.stage.system()) throw new Refused(`it is for the page of ${tour.system ?? "tops"}`);
      checkSteps(tour, this.stage.read);
      this.begin(tour, text);
    } catch (error) {
      this.refuse(what, error instanceof URIError ? "the link is broken" : (error as Error).message);
    }
  }

  private refuse(what: string, why: string): void {
    this.choice.close();
    this.stage.tell(`The tour of this ${what} cannot be shown: ${why}.`);
  }

  private begin(tour: Tour, text = ""): void {
    this.choice.close();
    [this.tour, this.text, this.before, this.focused] = [tour, text, this.stage.now(), document.activeElement];
    this.link.hidden = text === "";
    this.box.show();
    this.go(0);
  }

  private async share(): Promise<void> {
    this.stage.tell(await place().share(`${LINK}${encodeURIComponent(this.text)}`));
  }

  private go(to: number): void {
    if (!this.tour || to < 0) return;
    const { steps } = this.tour;
    if (to >= steps.length) return this.end(false);
    this.at = to;
    const { at, title, words } = steps[to];
    this.title.textContent = `${to + 1} of ${steps.length}: ${title}`;
    this.words.textContent = words;
    this.back.disabled = to === 0;
    this.next.textContent = to === steps.length - 1 ? "Done" : "Next";
    this.next.focus();
    point(at);
    this.stage.set(this.stage.read(addressOf(steps[to])));
  }

  private end(early: boolean): void {
    point(null);
    this.box.close();
    // what is hidden must not keep the focus
    if (this.box.contains(document.activeElement)) (document.activeElement as HTMLElement).blur();
    if (early && this.before) this.stage.set(this.before);
    if (this.focused instanceof HTMLElement) this.focused.focus();
  }
}

/** A tour of another page: a link to it, where pages of tops and of typed systems are one; else its name with the command. */
function elsewhere(tour: Tour): HTMLElement {
  const item = document.createElement("li");
  const isOne = !document.getElementById(CARRIED) && !document.documentElement.dataset.notebook;
  if (isOne) {
    const link = document.createElement("a");
    const page = tour.system === undefined ? "" : `own=1&example=${tour.system}&`;
    link.href = `#${page}${LINK}${tours.indexOf(tour) + 1}`;
    link.append(tour.title, small(`${tour.about} It opens another page; the browser goes back to this one.`));
    item.append(link);
  } else {
    const command = document.createElement("code");
    command.textContent = ["liepoisson lab", tour.system].filter(Boolean).join(" ");
    item.append(`${tour.title}: on the page that `, command, " opens.");
  }
  return item;
}

function point(at: string | null): void {
  document.querySelectorAll(".pointed").forEach((one) => one.classList.remove("pointed"));
  const panel = at && document.getElementById(at);
  if (!panel) return;
  panel.classList.add("pointed");
  panel.scrollIntoView({ block: "nearest" });
}

function heading(id: string): HTMLHeadingElement {
  return Object.assign(document.createElement("h2"), { id });
}

function small(text: string): HTMLElement {
  return Object.assign(document.createElement("small"), { textContent: text });
}

function button(text: string, act: () => void): HTMLButtonElement {
  const found = Object.assign(document.createElement("button"), { type: "button", textContent: text });
  found.addEventListener("click", act);
  return found;
}
