/** The worker: takes jobs, works in slices, and waits when the page has not yet seen what it was sent. */

import { Core, Refusal } from "../core/core.js";
import { fan, type FanUpdate } from "../fan/computation";
import { made } from "../systems/typing/made";
import { Computation } from "./computation";
import { projected } from "./projection";
import type { FromWorker, ToWorker } from "./messages";

/** Updates on the way that the page has not seen. */
const MOST_UNSEEN = 64;
/** Milliseconds between looks at the messages. */
const SLICE = 12;

let program: ArrayBuffer | null = null;
let core: Core | null = null;
let computation: Computation | null = null;
let generation = -1;
let unseen = 0;
let awake = false;

let orbits: Generator<FanUpdate> | null = null;

const turn = new MessageChannel();
turn.port1.onmessage = slice;
const next = new MessageChannel();
next.port1.onmessage = orbit;

function say(message: FromWorker): void {
  postMessage(message);
}

self.onmessage = async ({ data }: MessageEvent<ToWorker>) => {
  switch (data.say) {
    case "core":
      program = data.program;
      core = await Core.start(program);
      say({ say: "ready" });
      break;
    case "job":
      generation = data.generation;
      computation?.free();
      computation = null;
      await begin(() => (computation = new Computation(core as Core, data.job)));
      break;
    case "until":
      if (data.generation === generation) computation?.until(data.time);
      break;
    case "project":
      project(data);
      break;
    case "typed":
      read(data);
      break;
    case "fan":
      generation = data.generation;
      orbits?.return(undefined);
      orbits = null;
      await begin(() => (orbits = data.job && fan(core as Core, data.job)));
      next.port2.postMessage(null);
      break;
    case "seen":
      unseen -= 1;
      break;
  }
  wake();
};

/** What was refused is said; a core that has stopped is started anew. */
async function begin(attempt: () => void): Promise<void> {
  try {
    if (core?.stopped && program) core = await Core.start(program);
    attempt();
  } catch (error) {
    refuse(error);
  }
}

function refuse(error: unknown): void {
  computation = null;
  const kind = error instanceof Refusal ? error.kind : "Error";
  say({ say: "refused", generation, kind, message: error instanceof Error ? error.message : String(error) });
}

function project({ number, job, wanted }: Extract<ToWorker, { say: "project" }>): void {
  try {
    say({ say: "projected", number, ...projected(core as Core, job, wanted) });
  } catch (error) {
    say({ say: "not projected", number, message: error instanceof Error ? error.message : String(error) });
  }
}

/** What is wrong with a formula is an answer; anything else is a mistake in the core. */
function read({ number, question }: Extract<ToWorker, { say: "typed" }>): void {
  try {
    say({ say: "made", number, found: made(core as Core, question) });
  } catch {
    say({ say: "made", number, found: null });
  }
}

/** The next piece of a fan; a job that has come since is heard before. */
function orbit(): void {
  try {
    const { value, done } = orbits?.next() ?? { value: undefined, done: true };
    if (done || !value) return;
    say({ say: "fan", generation, update: value });
    next.port2.postMessage(null);
  } catch (error) {
    orbits = null;
    refuse(error);
  }
}

function wake(): void {
  if (awake || !computation) return;
  awake = true;
  turn.port2.postMessage(null);
}

function slice(): void {
  awake = false;
  const end = performance.now() + SLICE;
  while (computation && unseen < MOST_UNSEEN && performance.now() < end) {
    try {
      const update = computation.advance();
      if (!update) return;
      unseen += 1;
      say({ say: "update", generation, update });
    } catch (error) {
      refuse(error);
    }
  }
  if (unseen < MOST_UNSEEN) wake();
}
