// @ts-check
// The widget of a notebook (anywidget): the page of the laboratory in a frame of its own, which shares nothing with the
// notebook but a port.  Python puts the page, the one of the wheel, in place of the empty text.
const PAGE = "";

/** @typedef {{get(name: string): any, set(name: string, value: any): void, save_changes(): void, on(names: string, does: () => void): void, off(names: string, does: () => void): void}} Model */

/** What travels, in both directions. */
const SAID = ["address", "playing", "message"];

/** A name that nobody can guess; `crypto.randomUUID` is not there at every address of a notebook. */
function secret() {
  return `liepoisson:${Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}

/**
 * Which page shows this: that of a carried system, that of tops, or that on which a system is typed.
 *
 * @param {Model} model
 */
const pageOf = (model) => (/(^|&)own=/.test(String(model.get("address"))) ? "typed" : String(model.get("_carried")));

/**
 * Connects a model with the page in a window each time that it is loaded; notebooks move cells, and frames load again.
 * The page has no origin, so that a message cannot be addressed to it by one: the name of its frame is checked instead.
 *
 * @param {Model} model
 * @param {string} name of the frame
 */
export function connection(model, name) {
  /** @type {MessagePort | null} */
  let port = null;
  let agreed = "";
  /** The page that was opened: another one is opened anew. */
  let page = "";
  let hearing = false;
  const said = () => ({ address: String(model.get("address")), playing: Boolean(model.get("playing")), message: String(model.get("message")) });
  const tell = () => {
    const now = said();
    if (!port || hearing || pageOf(model) !== page || JSON.stringify(now) === agreed) return;
    agreed = JSON.stringify(now);
    port.postMessage(now);
  };
  /** @param {MessageEvent} event */
  const hear = ({ data }) => {
    if (pageOf(model) !== page || typeof data?.address !== "string" || typeof data.playing !== "boolean" || typeof data.message !== "string") return;
    agreed = JSON.stringify({ address: data.address, playing: data.playing, message: data.message });
    hearing = true; // the first of the three alone is a state that nobody has set
    for (const name of SAID) model.set(name, data[name]);
    hearing = false;
    model.save_changes();
  };
  const close = () => {
    port?.close();
    port = null;
  };
  for (const name of SAID) model.on(`change:${name}`, tell);
  return {
    /** @param {Pick<Window, "postMessage"> | null} window */
    open(window) {
      close();
      if (!window) return;
      const { port1, port2 } = new MessageChannel();
      port = port1;
      port.onmessage = hear;
      agreed = JSON.stringify(said());
      page = pageOf(model);
      const opening = { liepoisson: 1, name, carried: model.get("_carried"), options: model.get("_options"), ...said() };
      window.postMessage(opening, "*", [port2]);
    },
    end() {
      for (const name of SAID) model.off(`change:${name}`, tell);
      close();
    },
  };
}

/** @param {{model: Model, el: HTMLElement}} cell */
function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.name = secret();
  frame.title = "The laboratory of liepoisson";
  frame.setAttribute("sandbox", "allow-scripts allow-downloads");
  frame.setAttribute("allow", "clipboard-write");
  const size = () => (frame.style.cssText = `display: block; width: 100%; height: ${Number(model.get("height"))}px; border: 0; border-radius: 12px`);
  size();
  const { open, end } = connection(model, frame.name);
  frame.addEventListener("load", () => open(frame.contentWindow));
  let page = pageOf(model);
  const again = () => {
    if (page === pageOf(model)) return;
    page = pageOf(model);
    el.append(frame); // a frame that is moved loads again
  };
  model.on("change:height", size);
  model.on("change:_carried", again);
  model.on("change:address", again);
  frame.srcdoc = PAGE;
  el.append(frame);
  return () => {
    model.off("change:height", size);
    model.off("change:_carried", again);
    model.off("change:address", again);
    end();
    frame.remove();
  };
}

export default { render };
