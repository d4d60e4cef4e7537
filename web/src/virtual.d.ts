declare module "virtual:core" {
  /** The built core: gzip, in base64. */
  const packed: string;
  export default packed;
}
