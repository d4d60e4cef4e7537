/** How a state is handed on: its address and the code of it, a line for another page, and this page as one file. */

import encodeQR from "qr";
import { save } from "../export/menu";

/** This page before anything was changed in it, with the state that it is to open with. */
export function pageWith(pristine: string, address: string): string {
  const without = pristine.replace(/<script type="text\/plain" id="address">[^<]*<\/script>/, "");
  const at = without.lastIndexOf("</body>");
  const carried = `<script type="text/plain" id="address">${address.replaceAll("<", "%3C")}</script>`;
  return `<!doctype html>\n${without.slice(0, at)}${carried}\n${without.slice(at)}`;
}

/** The line that shows a state in another page. */
export function frameLine(url: string, title: string): string {
  const text = (value: string) => value.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");
  return `<iframe src="${text(url)}" title="${text(title)}" width="100%" height="420" style="border:0" allow="fullscreen"></iframe>`;
}

/** The code of a text as the path of its dark squares, in a square of so many; null where it is too long. */
export function codeOf(text: string): { size: number; path: string } | null {
  try {
    const rows = encodeQR(text, "raw", { ecc: "low", border: 4 });
    const path = rows.flatMap((row, y) => row.flatMap((dark, x) => (dark ? [`M${x} ${y}h1v1h-1Z`] : []))).join("");
    return { size: rows.length, path };
  } catch {
    return null;
  }
}

export interface Shared {
  /** Where the page is, without its state. */
  readonly base: string;
  readonly address: string;
  readonly title: string;
  /** With which the name of a file begins. */
  readonly file: string;
  readonly pristine: string;
  /** Whether it moves: then another page begins at its start. */
  readonly moves: boolean;
  /** Whether what is typed cannot be read. */
  readonly isStale: boolean;
}

/** An address that begins at the start of its orbit. */
export function fromStart(address: string): string {
  return address.replace(/(^|&)t=[^&]*/, "$1t=0");
}

/** Whether nobody else can open an address: it is that of a file, or of this machine. */
export function isLocal(base: string): boolean {
  const { protocol, hostname } = new URL(base);
  return !protocol.startsWith("http") || /^(localhost|127\.|\[::1\])/.test(hostname);
}

export class ShareDialog {
  private shared: Shared | null = null;
  private readonly link = lines("Address of this state", 2);
  private readonly line = lines("Line for another page", 3);
  private readonly code = document.createElementNS(SVG, "svg");
  private readonly note = document.createElement("p");
  private readonly none = document.createElement("p");

  constructor(private readonly dialog: HTMLDialogElement, private readonly said: (text: string) => void) {
    const head = Object.assign(document.createElement("h2"), { id: "share-h", textContent: "Hand this state on", tabIndex: -1 });
    const form = Object.assign(document.createElement("form"), { method: "dialog" });
    form.append(Object.assign(document.createElement("button"), { textContent: "Close" }));
    this.code.setAttribute("role", "img");
    this.code.setAttribute("aria-label", "Code of the address, for the camera of a phone");
    this.none.textContent = "The address is too long for a code.";
    const [left, right] = [document.createElement("div"), document.createElement("div")];
    left.append(part("Address", this.link, this.copy("Copy the address", this.link)), part("A line for another page", this.line, this.copy("Copy the line", this.line)));
    right.append(this.code, this.none);
    const columns = Object.assign(document.createElement("div"), { className: "columns" });
    columns.append(left, right);
    const file = Object.assign(document.createElement("button"), { type: "button", textContent: "Save this page as one file" });
    file.addEventListener("click", () => this.save());
    const words = Object.assign(document.createElement("p"), { textContent: "It opens with this state on any machine, without a network." });
    dialog.replaceChildren(head, this.note, columns, part("A file", words, file), form);
  }

  open(shared: Shared): void {
    const { base, address, title, moves, isStale } = (this.shared = shared);
    const url = `${base}#${address}`;
    this.link.value = url;
    this.line.value = frameLine(`${base}?embed=1#${moves ? fromStart(address) : address}`, title);
    const local = isLocal(base);
    const notes = [
      ...(isStale ? ["What is typed cannot be read: whoever opens this sees it with the same message."] : []),
      ...(local ? ["This page is on your machine, so others cannot open its address, nor the line: send them the file, or put the page on a server."] : []),
    ];
    this.note.hidden = notes.length === 0;
    this.note.textContent = notes.join(" ");
    const code = local ? null : codeOf(url);
    this.code.toggleAttribute("hidden", code === null);
    this.none.hidden = code !== null || local;
    if (code) {
      this.code.setAttribute("viewBox", `0 0 ${code.size} ${code.size}`);
      const [paper, squares] = [document.createElementNS(SVG, "rect"), document.createElementNS(SVG, "path")];
      for (const side of ["width", "height"]) paper.setAttribute(side, String(code.size));
      paper.setAttribute("fill", "#fff");
      squares.setAttribute("d", code.path);
      this.code.replaceChildren(paper, squares);
    }
    this.dialog.showModal();
    this.dialog.querySelector("h2")?.focus();
    this.dialog.scrollTop = 0;
  }

  private copy(words: string, from: HTMLTextAreaElement): HTMLButtonElement {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: words });
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(from.value);
        this.said("It is copied.");
        button.textContent = "Copied";
        setTimeout(() => (button.textContent = words), 1500);
      } catch {
        from.select();
        this.said("It is selected; copy it by the keys of your browser.");
      }
    });
    return button;
  }

  private save(): void {
    if (!this.shared) return;
    const { file, pristine, address } = this.shared;
    save(`${file}.html`, new Blob([pageWith(pristine, address)], { type: "text/html" }));
  }
}

const SVG = "http://www.w3.org/2000/svg";

function lines(label: string, rows: number): HTMLTextAreaElement {
  const text = Object.assign(document.createElement("textarea"), { readOnly: true, rows, spellcheck: false });
  text.setAttribute("aria-label", label);
  return text;
}

function part(title: string, ...inside: HTMLElement[]): HTMLElement {
  const found = document.createElement("section");
  found.append(Object.assign(document.createElement("h3"), { textContent: title }), ...inside);
  return found;
}
