declare module "virtual:core" {
  /** The built core: gzip, as `packed` writes it. */
  const packed: string;
  export default packed;
}
