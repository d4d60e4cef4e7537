"""The core on an ARM processor, emulated: its tests pass there, and its results have the recorded bits."""

import os
import platform
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
TARGET = "aarch64-unknown-linux-gnu"
LINKER = "aarch64-linux-gnu-gcc"
EMULATOR = "qemu-aarch64"
LIBRARIES = Path("/usr/aarch64-linux-gnu")
NEEDED = f"""\
to run the core's tests on an emulated ARM processor, install an emulator, a linker and the C library
  (Debian, Ubuntu: apt install qemu-user gcc-aarch64-linux-gnu libc6-dev-arm64-cross)
and Rust's standard library for ARM (rustup target add {TARGET}), or its source, to be compiled
  (rustup component add rust-src; Debian: apt install rustc-web cargo-web rust-web-src)"""


def missing_tools() -> list[str]:
    """Programs and folders that are not there."""
    programs = [name for name in (LINKER, EMULATOR) if shutil.which(name) is None]
    return programs + [str(folder) for folder in (LIBRARIES,) if not folder.is_dir()]


def compiler() -> tuple[str, list[str]] | None:
    """The folder of a Rust compiler that can make programs for ARM, and what cargo must be told; the first one."""
    package = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]
    wanted = tuple(int(part) for part in package["rust-version"].split("."))
    for folder in dict.fromkeys(os.get_exec_path()):
        if not all(os.access(Path(folder, name), os.X_OK) for name in ("rustc", "cargo")):
            continue
        version = re.match(r"rustc (\d+)\.(\d+)", _answer(folder, "--version"))
        if version is None or tuple(map(int, version.groups())) < wanted:
            continue
        libraries = Path(_answer(folder, "--print", "sysroot").strip(), "lib", "rustlib")
        if (libraries / TARGET / "lib").is_dir():
            return folder, []
        if (libraries / "src" / "rust" / "library").is_dir():
            return folder, ["-Zbuild-std=std,panic_unwind,test"]
    return None


def _answer(folder: str, *question: str) -> str:
    """What the compiler prints; nothing where it fails."""
    done = subprocess.run([f"{folder}/rustc", *question], cwd=ROOT, capture_output=True, text=True, check=False)
    return "" if done.returncode else done.stdout


# A build of the standard library and of the tests, and an emulator that takes ten times as long as the processor.
@pytest.mark.slow
@pytest.mark.timeout(7200)
def test_the_tests_of_the_core_pass_on_an_emulated_arm_processor():
    if platform.machine() in ("aarch64", "arm64"):
        pytest.skip("this processor is an ARM: `make test` runs the same tests on it")
    missing, found = missing_tools(), compiler()
    if missing or found is None:
        pytest.skip(f"no {', '.join(missing or ['Rust for ARM'])}: {NEEDED}")
    folder, options = found
    name = TARGET.upper().replace("-", "_")
    environment = os.environ | {
        "PATH": folder + os.pathsep + os.environ["PATH"],
        "RUSTC": f"{folder}/rustc",
        "RUSTC_BOOTSTRAP": "1",  # `-Zbuild-std` comes with the stable compiler, its flag does not
        "CARGO_TARGET_DIR": str(ROOT / "target" / "arm"),
        f"CARGO_TARGET_{name}_LINKER": LINKER,
        f"CARGO_TARGET_{name}_RUNNER": f"{EMULATOR} -L {LIBRARIES}",
        "PROPTEST_CASES": "16",
    }
    tests = ["-p", "liepoisson-core", "--lib", "--test", "core"]
    command = [f"{folder}/cargo", "test", "--locked", "--target", TARGET, *tests, *options]
    done = subprocess.run(command, cwd=ROOT, env=environment, check=False)
    assert done.returncode == 0, f"{' '.join(command)} failed; what it printed is above"
