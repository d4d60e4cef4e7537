/** Where a page stands: in a window of its own, whose address has the state, or in a cell of a notebook. */

export interface Place {
  /** Options of the page, which are no part of the state: `still`, `quality`, `embed`. */
  readonly query: URLSearchParams;
  /** The state in which the page begins, or "". */
  readonly address: string;
  /** Whether it begins with moving; null where nobody says. */
  readonly playing: boolean | null;
  /** Whether a text that is wrong is kept, too, and not only the last right one. */
  readonly keepsMistakes: boolean;
  /** Keeps the state, at rest only. */
  keep(address: () => string, playing: boolean): void;
  /** Hands the state to somebody else; what the page says of it. */
  share(address: string): Promise<string>;
  /** Passes on what the page tells the reader: "" where that has gone. */
  report(message: string): void;
  /** Listens to what comes from outside. */
  follow(outside: Outside): void;
}

/** What the page does where somebody outside sets its state or has a message. */
export interface Outside {
  /** `sameTime` says that the time is not another one. */
  adopt(address: string, playing: boolean, sameTime: boolean): void;
  /** Shows a message as text; none, where it is "". */
  tell(message: string): void;
}

/** Browsers limit how often an address may change. */
const REST = 400;

/** The window of a browser. */
export class AddressLine implements Place {
  readonly query = new URLSearchParams(location.search);
  readonly playing = null;
  readonly keepsMistakes = true;
  private waiting = 0;

  get address(): string {
    return location.hash.slice(1);
  }

  keep(address: () => string): void {
    clearTimeout(this.waiting);
    this.waiting = window.setTimeout(() => history.replaceState(null, "", `#${address()}`), REST);
  }

  async share(address: string): Promise<string> {
    try {
      await navigator.clipboard.writeText(`${location.href.split("#")[0]}#${address}`);
      return "The address is copied.";
    } catch {
      history.replaceState(null, "", `#${address}`);
      return "The address line now has this state; copy it from there.";
    }
  }

  report(): void {}

  follow(): void {}
}

let chosen: Place | null = null;

/** That of this page; a window of its own, if nothing else was said before. */
export function place(): Place {
  return (chosen ??= new AddressLine());
}

export function standIn(other: Place): void {
  chosen = other;
}

/** A state with the parts of the one before wherever they say the same, so that what has not changed is the same object. */
export function withPartsOf<State extends object>(before: State, next: State): State {
  const parts = Object.entries(next).map(([name, part]) => {
    const old = (before as Record<string, unknown>)[name];
    return [name, JSON.stringify(old) === JSON.stringify(part) ? old : part];
  });
  return Object.fromEntries(parts) as State;
}
