"""Mutation testing by sample: how many small, random errors in the code do the tests notice?

For each folder of the package a few mutants are drawn, with a fixed seed, from those that cosmic-ray can make: another
operator, comparison, number, truth value or exception.  Each is tried against the tests that belong to its module: the
file that mirrors it, then the files that name it, then those of its folder and of the folder above.

    python -m pip install cosmic-ray
    python verification/mutants.py --per-folder 3 --seed 1

It changes one source file at a time and puts it back, so run it in a clone of its own.  Survivors are printed with what
was changed.  Reference: DeMillo, Lipton and Sayward, Computer 11 (1978) 34.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from difflib import unified_diff
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "python" / "liepoisson"
TESTS = ROOT / "tests"
REPLACED = (
    *("Binary_" + pair for pair in ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Add_Mul", "Mul_Add", "Pow_Mul")),
    *(
        "Comparison_" + pair
        for pair in ("Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt", "Lt_Gt", "Gt_Lt", "LtE_GtE", "GtE_LtE")
    ),
    *("Comparison_" + pair for pair in ("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is")),
    *("Unary_" + pair for pair in ("USub_UAdd", "Delete_USub", "Delete_Not")),
)
OTHER = ("AddNot", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd")
OTHER += ("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ExceptionReplacer", "NumberReplacer")
OTHER += ("ZeroIterationForLoop",)
OPERATORS = (
    *(f"core/Replace{name.replace('_', 'Operator_', 1)}" for name in REPLACED),
    *(f"core/{name}" for name in OTHER),
)


def mutants(module: Path) -> Iterator[tuple[str, int, int]]:
    """(operator, occurrence, first line) of all mutants of a module."""
    import cosmic_ray.plugins
    from cosmic_ray.ast import ast_nodes, get_ast_from_path

    tree = get_ast_from_path(module)
    for name in OPERATORS:
        operator = cosmic_ray.plugins.get_operator(name)()
        positions = (position for node in ast_nodes(tree) for position in operator.mutation_positions(node))
        for occurrence, (start, _) in enumerate(positions):
            yield name, occurrence, start[0]


def mutated(module: Path, name: str, occurrence: int) -> str:
    """The text of a module with one mutation."""
    import cosmic_ray.plugins
    from cosmic_ray.mutating import mutate_code

    code = mutate_code(module.read_text(encoding="utf-8"), cosmic_ray.plugins.get_operator(name)(), occurrence)
    assert code is not None
    return code


def sample(per_folder: int, seed: int) -> Iterator[tuple[Path, str, int, int]]:
    """The same mutants for the same seed and sources, of different lines, folder by folder."""
    folders: dict[Path, list[Path]] = defaultdict(list)
    for module in sorted(PACKAGE.rglob("*.py")):
        folders[module.parent].append(module)
    for folder, modules in folders.items():
        draw = random.Random(f"{seed} {folder.relative_to(PACKAGE).as_posix()}")
        pool = [(module, *mutant) for module in modules for mutant in mutants(module)]
        draw.shuffle(pool)
        seen: set[tuple[Path, int]] = set()
        for module, name, occurrence, line in pool:
            if (module, line) not in seen and len(seen) < per_folder:
                seen.add((module, line))
                yield module, name, occurrence, line


def tests_of(module: Path) -> list[list[str]]:
    """Files of tests in the order in which they are tried: the mirror, those that name the module, its folder."""
    place = module.relative_to(PACKAGE)
    mirror = TESTS / place.parent / f"test_{module.stem.removeprefix('_')}.py"
    flat = TESTS / ("test_" + "_".join((*place.parent.parts, module.stem)) + ".py")
    dotted = ".".join(("liepoisson", *place.with_suffix("").parts))
    first = [file for file in (mirror, flat) if file.exists()]
    every = sorted(TESTS.rglob("test_*.py"))
    naming = [file for file in every if file not in first and dotted in file.read_text(encoding="utf-8")]
    tried, around = [*first, *naming], list[list[Path]]()
    for folder in (mirror.parent, mirror.parent.parent):
        around.append([file for file in every if file.parent == folder and file not in tried])
        tried += around[-1]
    return [[str(file) for file in files] for files in (first, naming, *around) if files]


def is_noticed(module: Path, code: str, seconds: float) -> tuple[bool, float]:
    """Whether the tests notice, and how long they took."""
    original = module.read_text(encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": str(ROOT / "python"), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "Agg"}
    command = [sys.executable, "-m", "pytest", "-x", "-m", "not slow", "-p", "no:cacheprovider", "--no-header"]
    began = time.monotonic()
    try:
        module.write_text(code, encoding="utf-8")
        for files in tests_of(module):
            left = seconds - (time.monotonic() - began)
            if left <= 0:
                break
            run = [*command, *files]
            try:
                done = subprocess.run(run, cwd=ROOT, env=environment, timeout=left, capture_output=True, check=False)
            except subprocess.TimeoutExpired:
                break
            if done.returncode not in (0, 5):
                return True, time.monotonic() - began
    finally:
        module.write_text(original, encoding="utf-8")
    return False, time.monotonic() - began


def main() -> None:
    """Try the sample, print what survives, and keep the results in a file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--per-folder", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=300.0, help="of tests for one mutant")
    parser.add_argument("--only", default="", help="modules whose path contains this")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "mutants.json")
    options = parser.parse_args()
    done = json.loads(options.out.read_text()) if options.out.exists() else {}
    for module, name, occurrence, line in sample(options.per_folder, options.seed):
        path = module.relative_to(ROOT).as_posix()
        key = f"{path}:{line} {name} {occurrence}"
        if options.only not in path or key in done:
            continue
        code = mutated(module, name, occurrence)
        noticed, took = is_noticed(module, code, options.seconds)
        before = module.read_text(encoding="utf-8").splitlines()
        rows = list(unified_diff(before, code.splitlines(), lineterm="", n=0))
        difference = [row for row in rows[2:] if not row.startswith("@@")]
        done[key] = {"noticed": noticed, "seconds": round(took, 1), "difference": difference}
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps(done, indent=1))
        print("noticed " if noticed else "SURVIVED", key, f"{took:.0f} s", flush=True)
        if not noticed:
            print(*difference, sep="\n", flush=True)
    print(f"{sum(row['noticed'] for row in done.values())} of {len(done)} mutants were noticed")


if __name__ == "__main__":
    main()
