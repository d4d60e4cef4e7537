/** Reads systems that are typed, beside the page: a formula that takes long never stops it. */

import { Core } from "../../core/core.js";
import type { Draft } from "./draft";
import { made, type Begun } from "./made";

export type ToCompiler = { readonly say: "core"; readonly program: ArrayBuffer } | { readonly say: "draft"; readonly number: number; readonly draft: Draft; readonly start: Begun | null };

let core: Core | null = null;

self.onmessage = async ({ data }: MessageEvent<ToCompiler>) => {
  if (data.say === "core") {
    core = await Core.start(data.program);
    postMessage({ number: -1 });
    return;
  }
  try {
    postMessage({ number: data.number, found: made(core as Core, data.draft, data.start) });
  } catch (error) {
    postMessage({ number: data.number, failed: error instanceof Error ? error.message : String(error) });
  }
};
