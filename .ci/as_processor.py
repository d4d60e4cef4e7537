"""Runs a command as it would run on another processor: without AVX-512, or without any AVX.

    python .ci/as_processor.py avx2 COMMAND ...
    python .ci/as_processor.py no-avx COMMAND ...

Four libraries choose their kernels by the processor, and each can be told to choose as on an older one: the core,
OpenBLAS, NumPy, and the system's elementary functions (glibc).
"""

from __future__ import annotations

import os
import sys

NEWER = {"avx2": ("AVX512", "X86_V4"), "no-avx": ("AVX512", "X86_V4", "X86_V3", "AVX", "FMA", "F16C")}
"""How the names of the features that the processor has not begin."""
KERNELS = {"avx2": ("avx2", "Haswell"), "no-avx": ("scalar", "Nehalem")}
"""Of the core and of OpenBLAS."""
GLIBC = {"avx2": "-AVX512F,-AVX512VL", "no-avx": "-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-FMA4"}


def environment(processor: str) -> dict[str, str]:
    """What is set for a processor of a kind; nothing for "native"."""
    if processor == "native":
        return {}
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    simd, openblas = KERNELS[processor]
    off = [name for name in __cpu_dispatch__ if __cpu_features__[name] and name.startswith(NEWER[processor])]
    return {
        "LIEPOISSON_SIMD": simd,
        "OPENBLAS_CORETYPE": openblas,
        "NPY_DISABLE_CPU_FEATURES": " ".join(off),
        "GLIBC_TUNABLES": f"glibc.cpu.hwcaps={GLIBC[processor]}",
    }


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] not in ("native", *NEWER):
        sys.exit(f"usage: as_processor.py {'|'.join(NEWER)} COMMAND ...")
    os.execvpe(sys.argv[2], sys.argv[2:], os.environ | environment(sys.argv[1]))
