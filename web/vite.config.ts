/// <reference types="vitest/config" />
import { createHash } from "node:crypto";
import { readdirSync, readFileSync } from "node:fs";
import { resolve } from "node:path";
import { gzipSync } from "node:zlib";
import subsetFont from "subset-font";
import { defineConfig, runnerImport, type Plugin } from "vite";
import { packed } from "./src/worker/packed.ts";

const PROGRAM = resolve(import.meta.dirname, "../python/liepoisson/laboratory/page/core.wasm");

/** `virtual:core`: the built core, compressed, as text. */
function core(): Plugin {
  const name = "virtual:core";
  return {
    name: "core",
    resolveId: (id) => (id === name ? `\0${name}` : undefined),
    load: (id) => {
      if (id !== `\0${name}`) return undefined;
      return `export default ${JSON.stringify(packed(gzipSync(readFileSync(PROGRAM), { level: 9 })))};`;
    },
  };
}

/** Reads each tour as the page would: a wrong one ends the build.  States of systems are read where the system is known. */
function tours(): Plugin {
  const folder = resolve(import.meta.dirname, "src/data/tours");
  return {
    name: "tours",
    async buildStart() {
      const { checkSteps, tourOf } = (await runnerImport<typeof import("./src/data/tour")>("./src/data/tour.ts")).module;
      const { read } = (await runnerImport<typeof import("./src/state/url")>("./src/state/url.ts")).module;
      for (const file of readdirSync(folder)) {
        try {
          const tour = tourOf(readFileSync(resolve(folder, file), "utf8"));
          if (!tour.system) checkSteps(tour, read);
        } catch (error) {
          throw new Error(`${file}: ${(error as Error).message}`);
        }
      }
    },
  };
}

/** Of this font the page needs one letter, ℓ, for which the rest of it would be 44 kB. */
const ONE_LETTER = resolve(import.meta.dirname, "node_modules/@fontsource/stix-two-text/files/stix-two-text-latin-ext-400-italic.woff2");

async function withOneLetter(styles: string): Promise<string> {
  const font = readFileSync(ONE_LETTER);
  const whole = font.toString("base64");
  if (!styles.includes(whole)) throw new Error("the style has no longer the font of which it needs one letter");
  return styles.replace(whole, (await subsetFont(font, "ℓ", { targetFormat: "woff2" })).toString("base64"));
}

/** Puts script and style into the page, and the hash of the script into its policy: nothing else can run in it. */
function oneFile(): Plugin {
  return {
    name: "one-file",
    apply: "build",
    enforce: "post",
    async generateBundle(_, bundle) {
      const page = bundle["index.html"];
      if (page?.type !== "asset") return;
      let [html, scripts, styles] = [String(page.source), "", ""];
      for (const [name, file] of Object.entries(bundle)) {
        if (name === "index.html") continue;
        if (file.type === "chunk") scripts += file.code;
        else if (name.endsWith(".css")) styles += String(file.source);
        else throw new Error(`${name} would be a second file`);
        delete bundle[name];
      }
      // what would end the element early is written in another way, which a script reads as the same text
      // there is no other file that an import could load before
      const script = scripts.replaceAll("</script", "<\\/script").replaceAll("__VITE_PRELOAD__", "[]");
      const hash = createHash("sha256").update(script).digest("base64");
      html = html.replace(/\s*<script type="module"[^>]*><\/script>/, "").replace(/\s*<link rel="stylesheet"[^>]*>/, "");
      styles = await withOneLetter(styles);
      html = html.replace("</head>", () => `<style>${styles}</style>\n</head>`);
      html = html.replace("</body>", () => `<script type="module">${script}</script>\n</body>`);
      page.source = html.replace("script-src 'self'", `script-src 'sha256-${hash}'`);
    },
  };
}

export default defineConfig({
  base: "./",
  plugins: [core(), tours(), oneFile()],
  worker: { format: "iife", plugins: () => [core()] },
  build: { rolldownOptions: { output: { codeSplitting: false } }, assetsInlineLimit: 1e8, cssCodeSplit: false, modulePreload: false, target: "es2022", reportCompressedSize: false },
  test: { include: ["test/**/*.test.ts"] },
});
