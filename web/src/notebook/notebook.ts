/** The page in a cell of a notebook: the state goes through a port to the widget, and comes from there. */

import type { Outside, Place } from "../state/place";
import { isOpening, isSaid, LONGEST_MESSAGE, NAMED, same, type Opening, type Said } from "./protocol";

/** What is needed of a window. */
export interface Frame {
  readonly name: string;
  readonly parent: unknown;
  addEventListener(type: "message", listener: (event: MessageEvent) => void): void;
  removeEventListener(type: "message", listener: (event: MessageEvent) => void): void;
}

/** Milliseconds of rest before the state is told: a slider that is drawn sends many. */
const REST = 120;

/** Whether a widget has made this window: a frame without an address, with a name that only the widget gives. */
export function isInNotebook(frame: Frame, protocol: string): boolean {
  return frame.parent !== frame && protocol === "about:" && frame.name.startsWith(NAMED);
}

/** The first message of the widget, from the window around this one; all others are left alone. */
export function opened(frame: Frame): Promise<Notebook> {
  return new Promise((resolve) => {
    const listen = (event: MessageEvent) => {
      const [port] = event.ports;
      if (event.source !== frame.parent || !port || !isOpening(event.data, frame.name)) return;
      frame.removeEventListener("message", listen);
      resolve(new Notebook(event.data, port));
    };
    frame.addEventListener("message", listen);
  });
}

export class Notebook implements Place {
  readonly query: URLSearchParams;
  readonly address: string;
  readonly playing: boolean;
  readonly carried: string;
  /** Python has the last system that could be made, and the message that says what is wrong with the next. */
  readonly keepsMistakes = false;
  /** What both sides have last agreed on. */
  private agreed: Said;
  /** What the page has to tell, once it rests. */
  private readonly now: { address: () => string; playing: boolean; message: string };
  private waiting: ReturnType<typeof setTimeout> | undefined;

  constructor({ carried, address, playing, message, options }: Opening, private readonly port: MessagePort) {
    [this.carried, this.address, this.playing] = [carried, address, playing];
    this.query = new URLSearchParams(options);
    this.agreed = { address, playing, message };
    this.now = { address: () => address, playing, message };
  }

  keep(address: () => string, playing: boolean): void {
    Object.assign(this.now, { address, playing });
    this.soon();
  }

  report(message: string): void {
    this.now.message = message.slice(0, LONGEST_MESSAGE);
    this.soon();
  }

  private soon(): void {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.tell(), REST);
  }

  private tell(): void {
    const said: Said = { ...this.now, address: this.now.address() };
    if (same(said, this.agreed)) return;
    this.agreed = said;
    this.port.postMessage(said);
  }

  async share(): Promise<string> {
    return "In a notebook the state is the widget's: widget.state, or widget.address as text.";
  }

  follow(outside: Outside): void {
    // what the page has refused since is told instead
    if (this.agreed.message && this.now.message === this.agreed.message) outside.tell(this.agreed.message);
    this.port.onmessage = ({ data }: MessageEvent) => {
      if (!isSaid(data)) return;
      const time = ({ address }: Said) => new URLSearchParams(address).get("t") ?? "0";
      const sameTime = time(data) === time(this.agreed);
      const { address, playing, message } = data;
      // what the page makes of it may be written in another way, and is then told
      this.agreed = { address, playing, message };
      Object.assign(this.now, { address: () => address, playing });
      if (message !== this.now.message) outside.tell(message);
      outside.adopt(address, playing, sameTime);
    };
  }
}
