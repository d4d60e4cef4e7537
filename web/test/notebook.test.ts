import { afterEach, describe, expect, test, vi } from "vitest";
import { isInNotebook, Notebook, opened, type Frame } from "../src/notebook/notebook";
import { isOpening, isSaid, LONGEST_MESSAGE, type Opening } from "../src/notebook/protocol";
import { connection } from "../src/notebook/widget.js";
import { withPartsOf } from "../src/state/place";
import { begun, changed, sameRun } from "../src/state/laboratory";
import { read, written } from "../src/state/url";

const NAME = "liepoisson:00ff";
const opening: Opening = { liepoisson: 1, name: NAME, carried: "", address: "v=1&t=2", playing: true, message: "", options: "embed=1" };
const soon = () => new Promise((resolve) => setTimeout(resolve, 20));

/** A window in a frame, which hears what is posted to it. */
class Window extends EventTarget {
  readonly parent = {};
  constructor(readonly name: string) {
    super();
  }
  say(data: unknown, source: unknown = this.parent, ports: readonly MessagePort[] = [new MessageChannel().port1]) {
    this.dispatchEvent(Object.assign(new Event("message"), { data, source, ports }));
  }
}
const framed = (name = NAME) => new Window(name) as Window & Frame;

/** A model as anywidget has it, of which Python has the other end. */
class Model {
  readonly saved: object[] = [];
  private readonly listeners = new Map<string, Set<() => void>>();
  constructor(private values: Record<string, unknown>) {}
  get = (name: string) => this.values[name];
  set = (name: string, value: unknown) => {
    if (this.values[name] === value) return;
    this.values = { ...this.values, [name]: value };
    this.listeners.get(`change:${name}`)?.forEach((does) => does());
  };
  save_changes = () => void this.saved.push({ address: this.get("address"), playing: this.get("playing"), message: this.get("message") });
  on = (name: string, does: () => void) => void (this.listeners.get(name) ?? this.listeners.set(name, new Set()).get(name))?.add(does);
  off = (name: string, does: () => void) => void this.listeners.get(name)?.delete(does);
  get count() {
    return [...this.listeners.values()].reduce((sum, all) => sum + all.size, 0);
  }
}
const model = () => new Model({ address: "v=1&t=2", playing: true, message: "", _carried: "", _options: "embed=1", height: 460 });

const open: MessagePort[] = [];
afterEach(() => open.splice(0).forEach((port) => port.close()));

/** Both ends, connected as a frame connects them when it has loaded. */
async function connected() {
  const [python, window] = [model(), framed()];
  const heard: unknown[][] = [];
  const told: string[] = [];
  const end = connection(python, NAME);
  const page = opened(window);
  end.open({
    postMessage: (data: unknown, _: unknown, ports: readonly MessagePort[]) => {
      open.push(...ports);
      window.say(structuredClone(data), window.parent, ports);
    },
  } as never);
  const notebook = await page;
  notebook.follow({
    adopt: (...said) => void heard.push(said),
    tell: (message) => (told.push(message), notebook.report(message)),
  });
  return { python, window, end, notebook, heard, told };
}

describe("the first message", () => {
  test("is waited for in a frame of the widget only", () => {
    expect(isInNotebook(framed(), "about:")).toBe(true);
    expect(isInNotebook(framed(), "http:")).toBe(false);
    expect(isInNotebook(framed("other"), "about:")).toBe(false);
    const alone = { name: NAME } as { parent?: unknown };
    alone.parent = alone;
    expect(isInNotebook(alone as Frame, "about:")).toBe(false);
  });

  test.each([
    ["from another window", opening, {}],
    ["with another name", { ...opening, name: "liepoisson:00fe" }, null],
    ["of another kind", { ...opening, liepoisson: 2 }, null],
    ["without a state", { ...opening, address: 3 }, null],
    ["that is none", null, null],
  ])("%s is left alone", async (_, data, source) => {
    const window = framed();
    const then = vi.fn();
    void opened(window).then(then);
    window.say(data, source ?? window.parent);
    window.say(opening, window.parent, []);
    await soon();
    expect(then).not.toHaveBeenCalled();
    window.say(opening);
    await soon();
    expect(then).toHaveBeenCalledOnce();
    window.say({ ...opening, address: "v=1&t=9" });
    await soon();
    expect((then.mock.calls[0][0] as Notebook).address).toBe("v=1&t=2");
  });

  test("has options, the state and what is carried", async () => {
    const { notebook } = await connected();
    expect([notebook.address, notebook.playing, notebook.carried, notebook.query.get("embed")]).toEqual(["v=1&t=2", true, "", "1"]);
  });

  test("is looked at before it is used", () => {
    expect(isOpening(opening, NAME)).toBe(true);
    for (const wrong of [{ carried: 1 }, { options: null }, { playing: "yes" }, { address: undefined }, { message: 1 }]) expect(isOpening({ ...opening, ...wrong }, NAME)).toBe(false);
    for (const wrong of [null, undefined, 3, "v=1", [], { address: "v=1" }, { playing: true }, { address: "v=1", playing: true }, { ...opening, message: "x".repeat(LONGEST_MESSAGE + 1) }]) expect(isSaid(wrong)).toBe(false);
  });
});

describe("the state", () => {
  test("of the page arrives in the model, once and at rest", async () => {
    const { python, notebook, heard } = await connected();
    for (let k = 0; k < 5; k++) notebook.keep(() => `v=1&t=${k}`, k < 4);
    await vi.waitFor(() => expect(python.saved).toEqual([{ address: "v=1&t=4", playing: false, message: "" }]));
    notebook.keep(() => "v=1&t=4", false);
    await new Promise((resolve) => setTimeout(resolve, 200));
    expect(python.saved).toHaveLength(1);
    expect(heard).toEqual([]);
  });

  test("of the model arrives in the page, and says whether its time is another", async () => {
    const { python, heard } = await connected();
    python.set("address", "v=1&t=2&theme=dark");
    await vi.waitFor(() => expect(heard).toEqual([["v=1&t=2&theme=dark", true, true]]));
    python.set("playing", false);
    python.set("address", "v=1&t=5");
    await vi.waitFor(() => expect(heard.at(-1)).toEqual(["v=1&t=5", false, false]));
    expect(python.saved).toEqual([]);
  });

  test("that is no state is left alone on both sides", async () => {
    const { python, heard, window } = await connected();
    for (const port of open) for (const data of [null, 3, { address: 1, playing: true, message: "" }, { address: "v=1" }, { address: "v=1", playing: true }]) port.postMessage(data);
    await soon();
    expect([python.saved, heard]).toEqual([[], []]);
    expect(window.name).toBe(NAME);
  });

  test.each([
    ["of a system", "{}", "v=1&system=abc"],
    ["on which a system is typed", "", "own=1&bracket=so3"],
  ])("of a page that is to give way to one %s is neither told nor heard", async (_, carried, address) => {
    const { python, notebook, heard } = await connected();
    python.set("_carried", carried);
    python.set("address", address);
    notebook.keep(() => "v=1&t=8", true);
    await new Promise((resolve) => setTimeout(resolve, 200));
    expect([python.saved, python.get("address"), heard]).toEqual([[], address, []]);
  });

  test("goes on when the frame loads again, and ends with the cell", async () => {
    const { python, end, heard } = await connected();
    const again = framed();
    const page = opened(again);
    python.set("address", "v=1&t=3");
    end.open({ postMessage: (data: unknown, _: unknown, ports: readonly MessagePort[]) => (open.push(...ports), again.say(data, again.parent, ports)) } as never);
    const other = await page;
    expect(other.address).toBe("v=1&t=3");
    other.keep(() => "v=1&t=8", true);
    await vi.waitFor(() => expect(python.get("address")).toBe("v=1&t=8"));
    expect(python.count).toBe(3);
    end.end();
    expect(python.count).toBe(0);
    expect(heard.length).toBeLessThan(2);
  });
});

describe("a message", () => {
  test("of the page arrives in the model, with the state that it keeps, and goes when it is closed", async () => {
    const { python, notebook } = await connected();
    notebook.report("This state cannot be shown: no.");
    notebook.keep(() => "v=1&t=2", true);
    await vi.waitFor(() => expect(python.saved.at(-1)).toEqual({ address: "v=1&t=2", playing: true, message: "This state cannot be shown: no." }));
    notebook.report("");
    await vi.waitFor(() => expect(python.get("message")).toBe(""));
    notebook.report("x".repeat(2 * LONGEST_MESSAGE));
    await vi.waitFor(() => expect(python.get("message")).toHaveLength(LONGEST_MESSAGE));
  });

  test("of the model is told in the page, once, and with the next state is gone", async () => {
    const { python, told } = await connected();
    python.set("message", "the state was refused");
    await vi.waitFor(() => expect(told).toEqual(["the state was refused"]));
    python.set("address", "v=1&t=3");
    await soon();
    expect(told).toHaveLength(1);
    python.set("message", "");
    await vi.waitFor(() => expect(told).toEqual(["the state was refused", ""]));
    await new Promise((resolve) => setTimeout(resolve, 200));
    expect(python.saved).toEqual([]);
  });

  test("that the model has from before is told when the page opens, unless the page has another", async () => {
    for (const [own, seen] of [["", ["before"]], ["the page's", []]] as const) {
      const notebook = new Notebook({ ...opening, message: "before" }, new MessageChannel().port1);
      const told: string[] = [];
      if (own) notebook.report(own);
      notebook.follow({ adopt: () => undefined, tell: (message) => told.push(message) });
      expect(told).toEqual(seen);
    }
  });
});

test("what another state leaves as it was is the same object, so that no new orbit is computed", () => {
  const lab = changed(begun("sticky"), { do: "start at", state: begun("lagrange").start });
  const themed = withPartsOf(lab, { ...read(written({ ...lab, theme: "dark" })), playing: false });
  expect(themed).toEqual({ ...lab, theme: "dark", playing: false });
  expect(sameRun(lab, themed)).toBe(true);
  const moved = withPartsOf(lab, read(written({ ...lab, start: begun("charged").start })));
  expect(sameRun(lab, moved)).toBe(false);
  expect(moved.parameters).toBe(lab.parameters);
});
