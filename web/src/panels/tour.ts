/** A tour of six steps.  Each sets a state of the laboratory and points at a panel; leaving early brings the old state back. */

import { begun, changed, type Action, type Laboratory } from "../state/laboratory";

interface Step {
  readonly at: string;
  readonly title: string;
  readonly words: string;
  /** Begins with a preset, then changes it. */
  readonly preset: string;
  readonly then?: readonly Action[];
}

const STEPS: readonly Step[] = [
  {
    at: "scene",
    title: "A top, and how it turns",
    words: "This is Lagrange's top: a body with an axis, and gravity α, which stays upright in space. The orange vector is the angular momentum. Drag to turn the view; the lines behind the vectors are their past.",
    preset: "lagrange",
  },
  {
    at: "section",
    title: "A section",
    words: "Each time the orbit of the Kovalevskaya top crosses a surface, a point is drawn. This top has a hidden integral, K, and the points keep to curves. Click a point, and a new orbit starts there.",
    preset: "kovalevskaya",
  },
  {
    at: "controls",
    title: "The twist",
    words: "With ε = 1 the first field moves in space, and the hidden integral is gone: the points scatter. The glass shadow started 0.001 away, and leaves. Every number on the left takes exact entries such as 1/3.",
    preset: "twisted-kovalevskaya",
  },
  {
    at: "lyapunov",
    title: "How fast neighbours part",
    words: "The exponent is the growth of a small distance per unit of time. This orbit stays beside a torus for a thousand time units, and its exponent falls as that of a regular orbit does. Then it leaves. A finite run proves neither order nor chaos.",
    preset: "sticky",
  },
  {
    at: "scene",
    title: "The energy ellipsoid",
    words: "Seen from the body, the angular momentum lies on the ellipsoid of its kinetic energy and on the sphere of its length, so on the golden curve where they meet. Gravity moves both; without it the curve would stand still.",
    preset: "lagrange",
    then: [{ do: "view", view: { frame: "momentum" } }],
  },
  {
    at: "scene",
    title: "An elastic rod",
    words: "Kirchhoff saw that a top in time is a rod in space. The twisted top is a rod that carries a current in a magnetic field. Press S to share any state by its address, P to compute it in Python, and ? for all keys.",
    preset: "twisted-lagrange",
    then: [{ do: "view", view: { frame: "rod" } }],
  },
];

export class Tour {
  private at = 0;
  private before: Laboratory | null = null;
  private focused: Element | null = null;
  private readonly title = document.createElement("h2");
  private readonly words = document.createElement("p");
  private readonly back = button("Back", () => this.go(this.at - 1));
  private readonly next = button("Next", () => this.go(this.at + 1));
  private readonly leave = button("Skip", () => this.end(true));

  constructor(private readonly box: HTMLDialogElement, private readonly lab: () => Laboratory, private readonly set: (lab: Laboratory) => void) {
    this.title.id = "tour-h";
    const row = document.createElement("div");
    this.leave.className = this.back.className = "plain";
    row.append(this.leave, this.back, this.next);
    box.append(this.title, this.words, row);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.end(true);
      else if (event.key === "ArrowRight") this.go(this.at + 1);
      else if (event.key === "ArrowLeft") this.go(this.at - 1);
      else return;
      event.preventDefault();
    });
  }

  begin(): void {
    if (this.box.open) return;
    [this.before, this.focused] = [this.lab(), document.activeElement];
    this.box.show();
    this.go(0);
  }

  private go(to: number): void {
    if (to < 0) return;
    if (to >= STEPS.length) return this.end(false);
    this.at = to;
    const { at, title, words, preset, then = [] } = STEPS[to];
    this.title.textContent = `${to + 1} of ${STEPS.length}: ${title}`;
    this.words.textContent = words;
    this.back.disabled = to === 0;
    this.next.textContent = to === STEPS.length - 1 ? "Done" : "Next";
    this.next.focus();
    point(at);
    const { theme, playing } = this.lab();
    this.set(then.reduce(changed, { ...begun(preset), theme, playing }));
  }

  private end(early: boolean): void {
    point(null);
    this.box.close();
    // what is hidden must not keep the focus
    if (this.box.contains(document.activeElement)) (document.activeElement as HTMLElement).blur();
    if (early && this.before) this.set(this.before);
    if (this.focused instanceof HTMLElement) this.focused.focus();
  }
}

function point(at: string | null): void {
  document.querySelectorAll(".pointed").forEach((one) => one.classList.remove("pointed"));
  const panel = at && document.getElementById(at);
  if (!panel) return;
  panel.classList.add("pointed");
  panel.scrollIntoView({ block: "nearest" });
}

function button(text: string, act: () => void): HTMLButtonElement {
  const found = Object.assign(document.createElement("button"), { type: "button", textContent: text });
  found.addEventListener("click", act);
  return found;
}
