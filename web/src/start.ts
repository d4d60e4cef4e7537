/** The page of tops, or where the page carries a system, that of this system; in a window or in a notebook. */

import { isInNotebook, opened } from "./notebook/notebook";
import { place, standIn } from "./state/place";
import { CARRIED } from "./systems/description";

async function start(): Promise<void> {
  if (isInNotebook(window, location.protocol)) {
    document.documentElement.dataset.notebook = "1";
    const notebook = await opened(window);
    standIn(notebook);
    if (notebook.carried) carry(notebook.carried);
  } else {
    // an exported page of a top carries its address
    const address = document.getElementById("address")?.textContent;
    if (address && location.hash.length < 2) history.replaceState(null, "", `#${address}`);
  }
  if (place().query.get("embed") === "1") document.documentElement.dataset.embed = "1";
  if (document.getElementById(CARRIED)) await import("./systems/page");
  else await import("./main");
}

/** Puts a description where a page has it that was made with one: as text, which is never markup. */
function carry(description: string): void {
  const element = document.createElement("script");
  element.type = "application/json";
  element.id = CARRIED;
  element.textContent = description;
  document.body.append(element);
}

void start();
