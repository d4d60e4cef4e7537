/** The page's side of the worker that computes a fan: the newest question alone counts. */

import { program } from "../worker/client";
import type { FromWorker, ToWorker } from "../worker/messages";
import Worker from "../worker/worker?worker&inline";
import type { FanJob, FanUpdate } from "./computation";

export class FanClient {
  private worker: Promise<Worker> | null = null;
  private generation = 0;

  constructor(private readonly take: (update: FanUpdate) => void, private readonly refuse: (message: string) => void) {}

  /** Asks for the fan of a job, and no more for that of an earlier one; null asks for none. */
  ask(job: FanJob | null): void {
    const generation = ++this.generation;
    if (job === null && !this.worker) return;
    this.worker ??= this.started();
    this.worker.then(
      (worker) => generation === this.generation && worker.postMessage({ say: "fan", generation, job } satisfies ToWorker),
      (error: Error) => this.refuse(error.message),
    );
  }

  /** Ends the worker. */
  free(): void {
    this.generation += 1;
    void this.worker?.then((worker) => worker.terminate());
    this.worker = null;
  }

  private async started(): Promise<Worker> {
    const [worker, bytes] = [new Worker(), await program()];
    await new Promise<void>((ready, fail) => {
      worker.onmessage = () => ready();
      worker.onerror = (event) => fail(new Error(event.message || "its worker did not start"));
      worker.postMessage({ say: "core", program: bytes } satisfies ToWorker, [bytes]);
    });
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (data.say === "fan" && data.generation === this.generation) this.take(data.update);
      if (data.say === "refused" && data.generation === this.generation) this.refuse(data.message);
    };
    worker.onerror = (event) => this.refuse(event.message);
    return worker;
  }
}
