/**
 * What the page and the widget of a notebook say to one another.
 *
 * The widget opens with one message to the window of its frame, which has the name of the frame as a secret, and a port.
 * Everything else goes through the port, which nobody else has.  What comes is data: it is looked at before it is used.
 */

/** The name of a frame in which the page waits for a widget begins so; what follows is random. */
export const NAMED = "liepoisson:";

/** The first message of the widget. */
export interface Opening extends Said {
  readonly liepoisson: 1;
  /** That of the frame. */
  readonly name: string;
  /** The description of a system, as the page reads it, or "" for the page of tops; an address of a system that is typed needs none. */
  readonly carried: string;
  /** As after the `?` of an address. */
  readonly options: string;
}

/** The widget sets the state, and the page tells its own: with the same words. */
export interface Said {
  readonly address: string;
  readonly playing: boolean;
  /** Why a state was refused, or what else somebody should read; "" where there is nothing.  Text, and never markup. */
  readonly message: string;
}

/** Characters of a message. */
export const LONGEST_MESSAGE = 1000;

export function isSaid(data: unknown): data is Said {
  const { address, playing, message } = (data ?? {}) as Partial<Said>;
  return typeof address === "string" && typeof playing === "boolean" && typeof message === "string" && message.length <= LONGEST_MESSAGE;
}

export function same(one: Said, other: Said): boolean {
  return one.address === other.address && one.playing === other.playing && one.message === other.message;
}

export function isOpening(data: unknown, name: string): data is Opening {
  const { liepoisson, name: named, carried, options } = (data ?? {}) as Partial<Opening>;
  return liepoisson === 1 && named === name && typeof carried === "string" && typeof options === "string" && isSaid(data);
}
