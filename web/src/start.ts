/** The page of tops, or where the page carries a system, that of this system. */

import { CARRIED } from "./systems/description";

/** An exported page of a top carries its address. */
const address = document.getElementById("address")?.textContent;
if (address && location.hash.length < 2) history.replaceState(null, "", `#${address}`);

if (document.getElementById(CARRIED)) void import("./systems/page");
else void import("./main");
