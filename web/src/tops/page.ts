/** The page of tops: the body in its views, parameters and start with sliders, presets. */

import { attitudeOf } from "../panels/attitude";
import { ControlsPanel, PROJECTED } from "../panels/controls";
import { ScenePanel } from "../panels/scene";
import { find, Page, quality, tell } from "../page";
import { attitude, components, N, position, presetOf, presets, WIDTH } from "../data/tops";
import { COORDINATES_OF_TOPS, OF_TOPS, type Charted } from "../state/charted";
import type { EverydayAction } from "../state/everyday";
import { begun, changed, FRAMES, HORIZON, sameRun, type Action, type Laboratory } from "../state/laboratory";
import { read, written } from "../state/url";
import type { FanJob } from "../fan/computation";
import type { Job } from "../worker/messages";
import { asPython, facts } from "./export";
import { HELP } from "./help";
import { systemOf } from "./system";

const MESSAGE = "A projection of the section is a cloud even where the motion is regular: look at the exponent, too.";

export class TopPage extends Page<Laboratory, Action> {
  private readonly controls: ControlsPanel;
  private readonly scene: ScenePanel;
  protected readonly instead = "the twisted Kovalevskaya top";

  constructor() {
    const lab = begun("twisted-kovalevskaya");
    super(lab, { system: systemOf(numbers(lab)), coordinates: COORDINATES_OF_TOPS, clock: OF_TOPS, width: WIDTH, conserved: PROJECTED, help: HELP });
    this.controls = new ControlsPanel(find("controls"), (action) => this.act(action), tell, (entered) => void this.startOn(entered));
    this.scene = new ScenePanel(find("scene"), quality);
    this.buttons("Presets", presets.map(({ key, title, kind }) => [key, title, kind, () => this.act({ do: "preset", key })]));
  }

  protected changed(lab: Laboratory, action: Action | EverydayAction): Laboratory {
    return changed(lab, action);
  }

  protected sameRun(one: Laboratory, other: Laboratory): boolean {
    return sameRun(one, other);
  }

  protected override sameMotion(one: Laboratory, other: Laboratory): boolean {
    return one.parameters === other.parameters && one.start === other.start;
  }

  protected get view(): ScenePanel {
    return this.scene;
  }

  protected job(): Job {
    const { start, surface, direction, method } = this.state;
    const values = start.map((one) => one.value);
    return {
      parameters: numbers(this.state),
      start: values,
      attitude: attitudeOf(values),
      surface: components.indexOf(surface),
      direction,
      tol: method.tol.value,
      horizon: HORIZON,
    };
  }

  protected fanJob(): FanJob {
    const { start, surface, direction, axes, method, fan, added } = this.state;
    const [x, y] = axes.map((name) => components.indexOf(name));
    return {
      system: systemOf(numbers(this.state)),
      start: start.map((one) => one.value),
      surface: components.indexOf(surface),
      direction,
      axes: [x, y],
      tol: method.tol.value,
      count: fan,
      added,
    };
  }

  protected charted(): Charted {
    return this.state;
  }

  protected shows(): void {
    const lab = this.state;
    const preset = presetOf(lab.preset);
    find("title").textContent = preset?.title ?? "A top of your own";
    const epsilon = lab.parameters[9].text.replace("-", "−");
    const isRod = lab.parameters.slice(3, 9).every(({ value }, k) => k % 3 === 2 || value === 0);
    const remark = lab.view.frame === "rod" && !isRod ? " · a or b is not along the third axis: a curve, but no rod in equilibrium" : "";
    find("subtitle").textContent = `ε = ${epsilon}${preset ? ` · ${preset.kind}` : ""}${remark}`;
    this.controls.show(lab, preset?.story ?? MESSAGE);
    this.choose(lab.preset);
  }

  protected draws(): void {
    const { state: lab, results, palette } = this;
    this.scene.draw(lab, results, palette);
    find("clock").textContent = `${lab.view.frame === "rod" ? "s" : "t"} = ${lab.time.toFixed(2)}`;
    const apart = this.distance();
    find("apart").hidden = !lab.view.shadow || !apart;
    (find("apart").lastElementChild as HTMLElement).textContent = apart;
    this.controls.conserved(results, lab.time);
    if (!lab.playing) find("numbers").textContent = this.inNumbers();
  }

  /** Distance of the two states, which is no longer small when the orbits have parted. */
  private distance(): string {
    const { state: { time }, results } = this;
    const [one, other] = [results.top.at(time), results.shadow.at(time)];
    if (!one || !other || results.shadow.end < time) return "";
    let sum = 0;
    for (let k = 0; k < N; k++) sum += (one[k] - other[k]) ** 2;
    return Math.sqrt(sum) < 0.01 ? Math.sqrt(sum).toPrecision(2) : Math.sqrt(sum).toFixed(2);
  }

  /** The state at rest, for those who do not see the scene. */
  private inNumbers(): string {
    const state = this.results.top.at(this.state.time);
    if (!state) return "";
    const vector = (words: string, at: number) => `${words} ${Array.from(state.subarray(at, at + 3), (value) => value.toFixed(3).replace("-", "−")).join(", ")}`;
    return `${find("clock").textContent}: ${vector("angular momentum", 0)}; ${vector("first field", 3)}; ${vector("second field", 6)}`;
  }

  protected read(address: string): Laboratory {
    return read(address);
  }

  protected written(): string {
    return written(this.state);
  }

  protected lines(): string {
    return asPython(this.state);
  }

  protected exported() {
    return {
      file: this.state.preset ?? "top",
      facts: facts(this.state),
      columns: [...components, ...attitude, ...position],
      row: "state, attitude (quaternion from body to space), centre line of the rod",
    };
  }

  protected viewName(): string {
    return this.state.view.frame;
  }

  protected picture(title: string): HTMLCanvasElement {
    return this.scene.picture(this.palette, title);
  }

  protected readonly keys = {
    f: () => this.act({ do: "view", view: { frame: FRAMES[(FRAMES.indexOf(this.state.view.frame) + 1) % FRAMES.length] } }),
    g: () => this.act({ do: "view", view: { shadow: !this.state.view.shadow } }),
  };

  protected numbered(number: number): (() => void) | undefined {
    const preset = presets.at(number - 1);
    return preset && (() => this.act({ do: "preset", key: preset.key }));
  }

  protected override forTests(): object {
    return { sizes: () => this.scene.sizes() };
  }
}

/** Parameters of a state. */
function numbers(lab: Laboratory): number[] {
  return lab.parameters.map((one) => one.value);
}
