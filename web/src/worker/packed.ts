/**
 * Bytes as text, four of them in five letters: a sixteenth shorter than in base 64.  None of the letters means anything
 * within quotes of a script or in a page.
 */

const LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#%()*+,-.:;=?@[]^_{|}~";

export function packed(bytes: Uint8Array): string {
  let text = "";
  for (let at = 0; at < bytes.length; at += 4) {
    let number = 0;
    for (let k = 0; k < 4; k++) number = number * 256 + (bytes[at + k] ?? 0);
    let five = "";
    for (let k = 0; k < 5; k++, number = Math.floor(number / 85)) five = LETTERS[number % 85] + five;
    text += five.slice(0, Math.min(bytes.length - at, 4) + 1);
  }
  return text;
}

export function unpacked(text: string): Uint8Array<ArrayBuffer> {
  const numbers = new Uint8Array(128);
  for (let k = 0; k < LETTERS.length; k++) numbers[LETTERS.charCodeAt(k)] = k;
  const full = Math.floor(text.length / 5);
  const rest = text.length - 5 * full;
  const bytes = new Uint8Array(4 * full + Math.max(rest - 1, 0));
  for (let at = 0, from = 0; from < text.length; from += 5, at += 4) {
    let number = 0;
    // what is missing at the end counts as much as it can, so that the first bytes are right
    for (let k = 0; k < 5; k++) number = number * 85 + (from + k < text.length ? numbers[text.charCodeAt(from + k)] : 84);
    for (let k = 0; k < 4 && at + k < bytes.length; k++) bytes[at + k] = Math.floor(number / 256 ** (3 - k)) % 256;
  }
  return bytes;
}
