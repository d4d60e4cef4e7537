/** Draws what a chart draws on a canvas as SVG: the part of a canvas that charts use, and nothing else. */

interface State {
  strokeStyle: string;
  fillStyle: string;
  lineWidth: number;
  lineJoin: string;
  globalAlpha: number;
  font: string;
  textAlign: string;
  dash: readonly number[];
  clipped: string;
}

const ANCHORS: Readonly<Record<string, string>> = { left: "start", center: "middle", right: "end" };
const FONT = /^(italic )?([\d.]+)px (.*)$/;

const short = (value: number) => String(Number(value.toFixed(2)));
export const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

export class SvgContext implements State {
  strokeStyle = "#000";
  fillStyle = "#000";
  lineWidth = 1;
  lineJoin = "miter";
  globalAlpha = 1;
  font = "10px sans-serif";
  textAlign = "left";
  dash: readonly number[] = [];
  clipped = "";
  private readonly parts: string[] = [];
  private readonly kept: State[] = [];
  private path = "";
  private clips = 0;

  /** `measure` is a canvas, which knows how wide letters are. */
  constructor(private readonly measure: CanvasRenderingContext2D) {}

  save(): void {
    const { strokeStyle, fillStyle, lineWidth, lineJoin, globalAlpha, font, textAlign, dash, clipped } = this;
    this.kept.push({ strokeStyle, fillStyle, lineWidth, lineJoin, globalAlpha, font, textAlign, dash, clipped });
  }

  restore(): void {
    Object.assign(this, this.kept.pop());
  }

  setLineDash(dash: readonly number[]): void {
    this.dash = [...dash];
  }

  beginPath(): void {
    this.path = "";
  }

  moveTo(x: number, y: number): void {
    this.path += `M${short(x)} ${short(y)}`;
  }

  lineTo(x: number, y: number): void {
    this.path += `${this.path ? "L" : "M"}${short(x)} ${short(y)}`;
  }

  rect(x: number, y: number, width: number, height: number): void {
    this.path += `M${short(x)} ${short(y)}h${short(width)}v${short(height)}h${short(-width)}Z`;
  }

  roundRect(x: number, y: number, width: number, height: number): void {
    this.rect(x, y, width, height);
  }

  /** Charts draw whole circles only. */
  arc(x: number, y: number, radius: number): void {
    const r = short(radius);
    this.path += `M${short(x + radius)} ${short(y)}A${r} ${r} 0 1 0 ${short(x - radius)} ${short(y)}A${r} ${r} 0 1 0 ${short(x + radius)} ${short(y)}Z`;
  }

  stroke(): void {
    if (!this.path) return;
    const dash = this.dash.length ? ` stroke-dasharray="${this.dash.join(" ")}"` : "";
    this.add(`<path d="${this.path}" fill="none" stroke="${escaped(this.strokeStyle)}" stroke-width="${short(this.lineWidth)}" stroke-linejoin="${this.lineJoin}"${dash}${this.opacity()}/>`);
  }

  fill(): void {
    if (this.path) this.add(`<path d="${this.path}" fill="${escaped(this.fillStyle)}"${this.opacity()}/>`);
  }

  fillRect(x: number, y: number, width: number, height: number): void {
    this.add(`<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" fill="${escaped(this.fillStyle)}"${this.opacity()}/>`);
  }

  /** Nothing is drawn twice here. */
  clearRect(): void {}

  fillText(text: string, x: number, y: number): void {
    const [, italic, size, family] = FONT.exec(this.font) ?? ["", "", "10", "sans-serif"];
    const style = italic ? ' font-style="italic"' : "";
    const anchor = ANCHORS[this.textAlign] ?? "start";
    this.add(`<text x="${short(x)}" y="${short(y)}" font-family="${escaped(family)}" font-size="${size}"${style} text-anchor="${anchor}" fill="${escaped(this.fillStyle)}"${this.opacity()}>${escaped(text)}</text>`);
  }

  measureText(text: string): TextMetrics {
    this.measure.font = this.font;
    return this.measure.measureText(text);
  }

  /** The document: a background, and what was drawn. */
  document(width: number, height: number, background: string, title: string, description: string): string {
    return [
      `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`,
      `<title>${escaped(title)}</title>`,
      `<desc>${escaped(description)}</desc>`,
      `<rect width="${width}" height="${height}" fill="${escaped(background)}"/>`,
      ...this.parts,
      "</svg>",
      "",
    ].join("\n");
  }

  clip(): void {
    this.clips += 1;
    const name = `clip${this.clips}`;
    this.parts.push(`<clipPath id="${name}"><path d="${this.path}"/></clipPath>`);
    this.clipped = name;
  }

  private add(element: string): void {
    this.parts.push(this.clipped ? `<g clip-path="url(#${this.clipped})">${element}</g>` : element);
  }

  private opacity(): string {
    return this.globalAlpha === 1 ? "" : ` opacity="${short(this.globalAlpha)}"`;
  }
}
