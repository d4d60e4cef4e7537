"""Builds the core for the browser, `core.wasm`, with whatever Rust for WebAssembly the machine has.

    python web/build_core.py

Beside the program it writes the hash of its sources, which `tests/web/test_core_in_wasm.py` compares with the sources.
The same compiler makes the same bytes again.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "python" / "liepoisson" / "laboratory" / "page"
PROGRAM, RECORD = PAGE / "core.wasm", PAGE / "core.json"
TARGET = "wasm32-unknown-unknown"
FLAGS = ("-Ctarget-feature=+simd128", "-Clink-arg=-zstack-size=1048576")
NEEDED = """\
to build the core for the browser, install Rust for WebAssembly:
  rustup target add wasm32-unknown-unknown
or, on Debian: apt install rustc-web cargo-web rust-web-src lld-22"""


def sources() -> list[Path]:
    """What the program is made from."""
    crates = [ROOT / "crates" / name for name in ("liepoisson-core", "liepoisson-formula", "liepoisson-wasm")]
    files = [file for crate in crates for file in (crate / "Cargo.toml", *(crate / "src").rglob("*.rs"))]
    return sorted(files, key=lambda file: file.relative_to(ROOT).as_posix())


def hash_of_sources() -> str:
    """One hash of names and of what is compiled: not of tests at the end of a file, empty lines, lines of comment."""
    total = hashlib.sha256()
    for file in sources():
        code = file.read_text(encoding="utf-8").partition("\n#[cfg(test)]\nmod tests {")[0]
        lines = [line for line in map(str.strip, code.splitlines()) if line and not line.startswith("//")]
        total.update("\n".join([file.relative_to(ROOT).as_posix(), *lines, ""]).encode())
    return total.hexdigest()


def hash_of(file: Path) -> str:
    """The hash of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _answer(folder: Path, *question: str) -> str:
    """What the compiler prints; nothing where it fails."""
    done = subprocess.run([folder / "rustc", *question], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def _linkers() -> list[str]:
    """Programs that link WebAssembly, the newest first."""
    names = ["wasm-ld", *(f"wasm-ld-{version}" for version in range(30, 15, -1))]
    return [name for name in names if shutil.which(name)]


def toolchain() -> tuple[Path, list[str], dict[str, str]] | None:
    """The folder of a Rust compiler that can make it, what cargo must be told, and its environment; the first one."""
    for folder in map(Path, dict.fromkeys(os.get_exec_path())):
        if not all(os.access(folder / name, os.X_OK) for name in ("rustc", "cargo")):
            continue
        libraries = Path(_answer(folder, "--print", "sysroot"), "lib", "rustlib")
        if (libraries / TARGET / "lib").is_dir():
            return folder, [], {}
        linkers = _linkers()
        if (libraries / "src" / "rust" / "library").is_dir() and linkers:
            linker = {"CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER": linkers[0], "RUSTC_BOOTSTRAP": "1"}
            return folder, ["-Zbuild-std=std,panic_abort"], linker
    return None


def build() -> None:
    """Builds the program and writes it with its record.

    Raises:
        SystemExit: no compiler for WebAssembly, or it failed.
    """
    found = toolchain()
    if found is None:
        raise SystemExit(NEEDED)
    folder, arguments, environment = found
    made_from = hash_of_sources()
    # texts of panics contain paths, which must not depend on where this is built
    cargo_home = os.environ.get("CARGO_HOME", str(Path.home() / ".cargo"))
    remapped = [f"--remap-path-prefix={path}={name}" for path, name in ((cargo_home, "cargo"), (ROOT, "liepoisson"))]
    # a separate folder: the flags of this build would make cargo compile everything else anew
    target_folder = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "wasm"
    environment |= {
        "PATH": os.pathsep.join([str(folder), os.environ["PATH"]]),
        "RUSTC": str(folder / "rustc"),
        "CARGO_TARGET_DIR": str(target_folder),
        "CARGO_ENCODED_RUSTFLAGS": "\x1f".join([*FLAGS, *remapped]),
    }
    command = [folder / "cargo", "build", "--profile", "wasm", "--locked", "--target", TARGET, *arguments]
    done = subprocess.run([*command, "-p", "liepoisson-wasm"], cwd=ROOT, env={**os.environ, **environment}, check=False)
    if done.returncode:
        raise SystemExit("cargo failed")
    if hash_of_sources() != made_from:
        raise SystemExit("sources were changed meanwhile; build again")
    PAGE.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target_folder / TARGET / "wasm" / "liepoisson_wasm.wasm", PROGRAM)
    record = {"sources": made_from, "program": hash_of(PROGRAM), "compiler": _answer(folder, "--version")}
    RECORD.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    print(f"{PROGRAM.relative_to(ROOT)}: {PROGRAM.stat().st_size} bytes, by {record['compiler']}")


if __name__ == "__main__":
    sys.exit(build())
