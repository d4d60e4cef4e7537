/** The page's side of a worker that reads what is typed: one question at a time, the newest next, each with a limit of time. */

import type { FromWorker, ToWorker } from "../../worker/messages";
import Worker from "../../worker/worker?worker&inline";
import { BRACKETS, type Draft } from "./draft";
import type { Begun, Made, NotMade, Question } from "./made";

/** Milliseconds that somebody waits for a formula. */
const LONGEST = 3_000;

type Asked = Question & { readonly answer: (found: Made | NotMade) => void };

export class Compiler {
  private worker: Worker | null = null;
  private asked: Asked | null = null;
  private next: Asked | null = null;
  private number = 0;
  private limit = 0;

  /** `program` gives the bytes of the core anew for each worker. */
  constructor(private readonly program: () => Promise<ArrayBuffer>) {}

  /** Whether everything has been answered. */
  get rests(): boolean {
    return this.asked === null;
  }

  /** Asks for the system of a draft; only the newest question waits, and an older one is never answered. */
  async ask(draft: Draft, start: Begun | null, answer: (found: Made | NotMade) => void): Promise<void> {
    this.next = { draft, listed: BRACKETS[draft.bracket] ?? null, start, answer };
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
    const { draft, listed, start } = question;
    this.say({ say: "typed", number: this.number, question: { draft, listed, start } });
  }

  private async started(): Promise<void> {
    if (this.worker) return;
    const [worker, program] = [new Worker(), await this.program()];
    await new Promise<void>((ready, fail) => {
      worker.onmessage = () => ready();
      worker.onerror = (event) => fail(new Error(event.message || "its worker stopped"));
      worker.postMessage({ say: "core", program } satisfies ToWorker, [program]);
    });
    this.worker = worker;
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (data.say !== "made" || data.number !== this.number || !this.asked) return;
      // a core that has stopped is started anew
      if (data.found === null) this.stop();
      this.end(data.found ?? refused(this.asked, "The core cannot read this formula. Write it in another way."));
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

  private say(message: ToWorker): void {
    this.worker?.postMessage(message);
  }
}

function refused({ draft }: Asked, message: string): NotMade {
  return { made: false, field: "hamiltonian", message, text: draft.hamiltonian, place: -1, offered: null };
}
