/** A sentence in a chart, where there is nothing to draw or what is drawn says little. */

export function remarkIn(panel: HTMLElement): HTMLElement {
  const remark = document.createElement("p");
  remark.className = "remark";
  remark.setAttribute("role", "note");
  remark.hidden = true;
  panel.append(remark);
  return remark;
}

export function setText(remark: HTMLElement, text: string): void {
  if (remark.textContent === text) return;
  remark.textContent = text;
  remark.hidden = text === "";
}
