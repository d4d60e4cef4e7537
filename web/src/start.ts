/** The page of tops; where the page carries a system, that of this system; where one is typed, that; in a window or in a notebook. */

import "./state/pristine";
import { isInNotebook, opened } from "./notebook/notebook";
import { place, standIn } from "./state/place";
import { CARRIED } from "./systems/description";
import { isTyped } from "./systems/typing/draft";

async function start(): Promise<void> {
  if (isInNotebook(window, location.protocol)) {
    document.documentElement.dataset.notebook = "1";
    const notebook = await opened(window);
    standIn(notebook);
    if (notebook.carried && !isTyped(notebook.address)) carry(notebook.carried);
  } else {
    // an exported page of a top carries its address
    const address = document.getElementById("address")?.textContent;
    if (address && location.hash.length < 2) history.replaceState(null, "", `#${address}`);
  }
  if (place().query.get("embed") === "1") document.documentElement.dataset.embed = "1";
  if (document.getElementById(CARRIED)) (await import("./systems/page")).start();
  else if (isTyped(place().address)) await typed();
  else {
    addEventListener("hashchange", () => isTyped(location.hash) && location.reload());
    await new (await import("./tops/page")).TopPage().begin();
  }
}

/** The page of a system that is typed; another page has another address. */
async function typed(): Promise<void> {
  const { TypedPage } = await import("./systems/typing/typed");
  addEventListener("hashchange", () => location.reload());
  const page = new TypedPage();
  Object.assign(window, { typed: page });
  await page.begin();
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
