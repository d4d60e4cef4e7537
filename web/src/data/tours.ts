/** The tours that the page brings, in the order of their files. */

import { tourOf, type Tour } from "./tour";

const files = import.meta.glob<string>("./tours/*.json", { eager: true, query: "?raw", import: "default" });

export const tours: readonly Tour[] = Object.keys(files).sort().map((file) => tourOf(files[file]));
