declare module "virtual:core" {
  /** The built core: gzip, as `packed` writes it. */
  const packed: string;
  export default packed;
}

declare module "subset-font" {
  /** The letters of a text alone, of a font. */
  export default function subsetFont(font: Uint8Array, text: string, options: { targetFormat: "woff2" }): Promise<Buffer>;
}
