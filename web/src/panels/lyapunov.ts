/** The finite-time exponent over the logarithm of time, with the band of an ensemble. */

import type { Results } from "../results";
import { OF_TOPS, type Charted, type Clock } from "../state/charted";
import type { Palette } from "../style/palette";
import { element } from "../symbols";
import { Plot } from "./plot";

const LABEL = "Finite-time Lyapunov exponent";
/** Left of this the numbers of the axis stand. */
const LEAST = 60;

export class LyapunovPanel {
  readonly plot: Plot;
  private readonly head: HTMLElement;
  private drawn = "";
  private results: Results | null = null;

  constructor(panel: HTMLElement, private readonly clock: Clock = OF_TOPS) {
    this.plot = new Plot(panel, LABEL);
    this.head = panel.querySelector("p") as HTMLElement;
  }

  draw(lab: Charted, results: Results, palette: Palette): void {
    const { plot } = this;
    const { exponent, band } = results;
    const key = `${exponent.length} ${band.length} ${palette.dark} ${palette.panel}`;
    if (plot.measure() || key !== this.drawn || results !== this.results) {
      [this.drawn, this.results] = [key, results];
      const seen = [...exponent.rows.flatMap((row, k) => (exponent.times[k] >= this.clock.unit ? [row[0]] : [])), ...band.rows.flatMap((row, k) => (band.times[k] >= 2 * this.clock.unit ? [row[2], row[0]] : []))];
      const [low, high] = seen.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [0, 0.02]);
      plot.x = { range: [this.clock.unit, this.clock.horizon], log: true, name: "t" };
      plot.y = { range: [low - 0.12 * (high - low), high + 0.1 * (high - low)], name: "λ" };
      plot.axes(palette);
      this.curves(results, palette);
      this.heading(results);
    }
    plot.clearAbove();
    plot.cursor(lab.time, palette);
  }

  private curves({ exponent, band, members }: Results, palette: Palette): void {
    const { plot } = this;
    const c = plot.below;
    c.save();
    plot.clip(c);
    if (band.length) {
      c.fillStyle = palette.accent;
      c.globalAlpha = 0.18;
      c.beginPath();
      band.rows.forEach((row, k) => c.lineTo(plot.px(band.times[k]), plot.py(row[0])));
      for (let k = band.length - 1; k >= 0; k--) c.lineTo(plot.px(band.times[k]), plot.py(band.rows[k][2]));
      c.fill();
      c.globalAlpha = 1;
      c.strokeStyle = palette.accent;
      c.setLineDash([5, 4]);
      c.beginPath();
      band.rows.forEach((row, k) => c.lineTo(plot.px(band.times[k]), plot.py(row[1])));
      c.stroke();
      c.setLineDash([]);
    }
    c.strokeStyle = palette.l;
    c.lineWidth = 2;
    c.lineJoin = "round";
    c.beginPath();
    exponent.rows.forEach((row, k) => c.lineTo(plot.px(exponent.times[k]), plot.py(row[0])));
    c.stroke();
    c.restore();
    if (members) this.legend(members, palette);
  }

  private legend(members: number, palette: Palette): void {
    const { below: c, width } = this.plot;
    const text = `80 % of ${members} starts, median`;
    c.font = `11px "Inter Variable", sans-serif`;
    const left = width - 22 - c.measureText(text).width - 32;
    if (left < LEAST) return;
    c.textAlign = "right";
    c.fillStyle = palette.faint;
    c.fillText(text, width - 22, 28);
    c.globalAlpha = 0.18;
    c.fillStyle = palette.accent;
    c.fillRect(left, 18, 26, 12);
    c.globalAlpha = 1;
    c.strokeStyle = palette.accent;
    c.lineWidth = 1;
    c.setLineDash([5, 4]);
    c.beginPath();
    c.moveTo(left, 24);
    c.lineTo(left + 26, 24);
    c.stroke();
    c.setLineDash([]);
  }

  private heading({ exponent, members }: Results): void {
    const last = exponent.length - 1;
    if (last < 0) return this.head.replaceChildren();
    const value = document.createElement("b");
    const lambda = exponent.rows[last][0];
    value.textContent = lambda.toFixed(Math.abs(lambda) < 0.01 ? 4 : 3).replace(/^-(?=0\.0+$)/, "").replace("-", "−");
    const time = Math.round(exponent.times[last]).toLocaleString("en");
    const when = Object.assign(document.createElement("span"), { className: "words" });
    when.append(" at ", element("t"), ` = ${time}`);
    this.head.replaceChildren(element("λ"), " = ", value, when);
    this.plot.canvas.setAttribute("aria-label", `${LABEL}, ${value.textContent} at t = ${time}`);
    this.head.title = members ? `Band: 80 % of ${members} starts along this orbit; dashed: their median.` : "";
  }
}
