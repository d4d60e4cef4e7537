/** A small menu in the corner of a panel: pictures and numbers of what it shows. */

/** Name of a choice, and what it does. */
export type Choices = readonly (readonly [string, () => void])[];

export function menu(panel: HTMLElement, of: string, choices: Choices): void {
  const details = document.createElement("details");
  details.className = "menu";
  const summary = document.createElement("summary");
  summary.textContent = "⤓";
  summary.setAttribute("aria-label", `Save: ${of}`);
  summary.title = "Save";
  const list = document.createElement("div");
  for (const [name, act] of choices) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: name });
    button.addEventListener("click", () => {
      details.open = false;
      summary.focus();
      act();
    });
    list.append(button);
  }
  details.append(summary, list);
  details.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !details.open) return;
    details.open = false;
    summary.focus();
    event.stopPropagation();
  });
  details.addEventListener("focusout", (event) => {
    if (!details.contains(event.relatedTarget as Node | null)) details.open = false;
  });
  panel.querySelector("h3, .title")?.after(details);
}

/** Hands a file to the browser. */
export function save(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export function savePicture(name: string, canvas: HTMLCanvasElement): void {
  canvas.toBlob((blob) => blob && save(name, blob), "image/png");
}
