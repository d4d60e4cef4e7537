// Tests in a browser's Python: Pyodide, that is CPython in WebAssembly, run by node. Prints what tests/web/browser_python.py prints.
//   node browser_python.mjs REPOSITORY WHEELS FOLDER...
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { loadPyodide } from "pyodide";

const [repository, wheels, ...folders] = process.argv.slice(2);
const python = await loadPyodide();
python.FS.mkdirTree("/repository");
python.FS.mount(python.FS.filesystems.NODEFS, { root: repository }, "/repository");
for (const wheel of readdirSync(wheels)) {
  python.unpackArchive(new Uint8Array(readFileSync(join(wheels, wheel))), "zip", { extractDir: "/packages" });
}
python.globals.set("FOLDERS", python.toPy(folders));
python.runPython(readFileSync(join(repository, "tests/web/browser_python.py"), "utf8"));
