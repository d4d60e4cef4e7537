/** The page's side of the worker that reads what is typed: one question at a time, the newest next, each with a limit of time. */

import type { Draft } from "./draft";
import Worker from "./compiler.worker?worker&inline";
import type { Begun, Made, NotMade } from "./made";
import type { ToCompiler } from "./compiler.worker";

/** Milliseconds that somebody waits for a formula. */
const LONGEST = 3_000;

interface Question {
  readonly draft: Draft;
  readonly start: Begun | null;
  readonly answer: (found: Made | NotMade) => void;
}

export class Compiler {
  private worker: Worker | null = null;
  private asked: Question | null = null;
  private next: Question | null = null;
  private number = 0;
  private limit = 0;

  /** `program` gives the bytes of the core anew for each worker. */
  constructor(private readonly program: () => Promise<ArrayBuffer>) {}

  /** Asks for the system of a draft; only the newest question waits, and an older one is never answered. */
  async ask(draft: Draft, start: Begun | null, answer: (found: Made | NotMade) => void): Promise<void> {
    this.next = { draft, start, answer };
    if (!this.asked) await this.begin();
  }

  private async begin(): Promise<void> {
    const question = (this.asked = this.next);
    this.next = null;
    if (!question) return;
    try {
      await this.started();
    } catch (error) {
      this.end(refused(question, `The core did not start: ${(error as Error).message}.`));
      return;
    }
    this.number += 1;
    this.limit = window.setTimeout(() => {
      this.stop();
      this.end(refused(question, `The formula took longer than ${LONGEST / 1000} seconds to read, and was given up. Write it shorter.`));
    }, LONGEST);
    this.say({ say: "draft", number: this.number, draft: question.draft, start: question.start });
  }

  private async started(): Promise<void> {
    if (this.worker) return;
    const [worker, program] = [new Worker(), await this.program()];
    await new Promise<void>((ready, fail) => {
      worker.onmessage = () => ready();
      worker.onerror = (event) => fail(new Error(event.message || "its worker stopped"));
      worker.postMessage({ say: "core", program } satisfies ToCompiler, [program]);
    });
    this.worker = worker;
    worker.onmessage = ({ data }: MessageEvent<{ number: number; found?: Made | NotMade; failed?: string }>) => {
      if (data.number !== this.number || !this.asked) return;
      if (data.failed !== undefined) this.stop();
      this.end(data.found ?? refused(this.asked, `The core cannot read this: ${data.failed}.`));
    };
  }

  private end(found: Made | NotMade): void {
    clearTimeout(this.limit);
    const question = this.asked;
    this.asked = null;
    if (!this.next) question?.answer(found);
    else void this.begin();
  }

  private stop(): void {
    this.worker?.terminate();
    this.worker = null;
  }

  private say(message: ToCompiler): void {
    this.worker?.postMessage(message);
  }
}

function refused({ draft }: Question, message: string): NotMade {
  return { made: false, field: "hamiltonian", message, text: draft.hamiltonian, place: -1, offered: null };
}
