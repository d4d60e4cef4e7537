/** The page's side of the worker: starts it with the core, gives it jobs, and hands on the updates of the newest. */

import core from "virtual:core";
import type { FromWorker, Job, SystemJob, ToWorker, Update } from "./messages";
import { unpacked } from "./packed";
import type { Projected } from "./projection";
import Worker from "./worker?worker&inline";

/** The core, unpacked. */
export async function program(): Promise<ArrayBuffer> {
  const stream = new Blob([unpacked(core)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

export class Client {
  private readonly worker = new Worker();
  private generation = 0;
  private readonly questions: { readonly answer: (found: Projected) => void; readonly fail: (error: Error) => void }[] = [];

  private constructor(private readonly take: (update: Update) => void, private readonly refuse: (message: string) => void) {}

  static async start(take: (update: Update) => void, refuse: (message: string) => void): Promise<Client> {
    const client = new Client(take, refuse);
    const bytes = await program();
    await new Promise<void>((ready, fail) => {
      client.worker.onerror = (event) => fail(new Error(event.message || "the worker did not start"));
      client.worker.onmessage = () => ready();
      client.worker.postMessage({ say: "core", program: bytes } satisfies ToWorker, [bytes]);
    });
    client.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => client.hear(data);
    client.worker.onerror = (event) => refuse(event.message);
    return client;
  }

  /** Starts another job; what comes of earlier ones is dropped. */
  run(job: Job | SystemJob): void {
    this.generation += 1;
    this.say({ say: "job", generation: this.generation, job });
  }

  /** The motion is wanted up to a time. */
  until(time: number): void {
    this.say({ say: "until", generation: this.generation, time });
  }

  /** The state near the start of a job at which invariants have values, and how far each is from its own. */
  project(job: Job | SystemJob, wanted: Readonly<Record<string, number>>): Promise<Projected> {
    return new Promise((answer, fail) => {
      const number = this.questions.push({ answer, fail }) - 1;
      this.say({ say: "project", number, job, wanted });
    });
  }

  private hear(message: FromWorker): void {
    if (message.say === "update") {
      this.say({ say: "seen" });
      if (message.generation === this.generation) this.take(message.update);
    } else if (message.say === "projected") {
      this.questions[message.number].answer(message);
    } else if (message.say === "not projected") {
      this.questions[message.number].fail(new Error(message.message));
    } else if (message.say === "refused" && message.generation === this.generation) {
      this.refuse(message.message);
    }
  }

  private say(message: ToWorker): void {
    this.worker.postMessage(message);
  }
}
