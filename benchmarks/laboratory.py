"""How fast is the laboratory?  The core in WebAssembly beside the native scalar kernels, and the page in Chromium.

`python benchmarks/laboratory.py`, with node, `npm ci` in web/ and Chromium.  The same runs of the twisted Kovalevskaya
top by both, one thread, the least of five times: an orbit (by the kernel for many orbits, as the one for a single
orbit is not scalar), a section, and the exponents of 24 starts.  The page is opened in Chromium with WebGL in software:
time to the first frame, frames a second, and the time that our own code takes for a frame.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "python" / "liepoisson" / "laboratory" / "page"
END = 10_000.0
N_STARTS, EXPONENT_TIME = 24, 1_000.0
REPEATED = 5


def main() -> None:
    """Both sides, and the table."""
    if os.environ.get("LIEPOISSON_SIMD") != "scalar":  # it is read once, when the core is loaded
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, "LIEPOISSON_SIMD": "scalar"})
    import liepoisson as lp
    from liepoisson.compile.field import record_of
    from liepoisson.numeric.sampling import sample_tangents
    from liepoisson.numeric.systems import as_field

    top = lp.Top.twisted_kovalevskaya()
    starts = lp.sample_states(top, N_STARTS, seed=0)
    tangents = sample_tangents(9, N_STARTS, seed=0)
    surface = top.function_tape("l3")
    with tempfile.TemporaryDirectory() as folder:
        cases = Path(folder) / "cases.json"
        cases.write_text(
            json.dumps(
                {
                    "field": record_of(as_field(top)),
                    "surface": asdict(surface),
                    "start": starts[0].tolist(),
                    "starts": starts.tolist(),
                    "tangents": np.asarray(tangents).tolist(),
                    "times": [0.0, EXPONENT_TIME],
                    "end": END,
                }
            )
        )
        command = [
            "node",
            str(ROOT / "web/test/speed.mjs"),
            str(PAGE / "core.wasm"),
            str(cases),
            str(PAGE / "index.html"),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr)
    browser = json.loads(done.stdout)
    native = {
        "orbit": fastest(lambda: lp.integrate(top, starts[0], times=[0, END], kernel="lanes", threads=1)),
        "section": fastest(lambda: lp.section(top, starts[0], surface=surface, t_end=END, direction=1, threads=1)),
        "exponents": fastest(
            lambda: lp.finite_time_exponents(top, starts, times=[EXPONENT_TIME], tangents=tangents, threads=1)
        ),
    }
    print("run                                native scalar   WebAssembly   WebAssembly's speed, native = 1")
    for name, words in (
        ("orbit", f"one orbit to t = {END:g}"),
        ("section", f"its section to t = {END:g}"),
        ("exponents", f"{N_STARTS} exponents to t = {EXPONENT_TIME:g}"),
    ):
        print(f"{words:<34} {native[name]:10.4f} s {browser[name]:11.4f} s   {native[name] / browser[name]:.2f}")
    for quality in ("low", "full"):
        page = browser[quality]
        print(
            f"page, WebGL in software, quality {quality}: first frame after {page['first']:.2f} s, "
            f"{page['frames']:.0f} frames a second, our own code {page['median']:.1f} ms a frame "
            f"(worst of 120: {page['worst']:.1f} ms)"
        )


def fastest(run: Callable[[], object]) -> float:
    """Seconds, the least of a few times."""
    least = float("inf")
    for _ in range(REPEATED):
        begun = time.perf_counter()
        run()
        least = min(least, time.perf_counter() - begun)
    return least


if __name__ == "__main__":
    main()
