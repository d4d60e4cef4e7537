"""Mutation testing by sample: how many small, random errors in the code do the tests notice?

Functions of the package are drawn with a fixed seed, and of each of them one of the mutants that cosmic-ray can make:
another operator, comparison, number, truth value or exception.  Each mutant is tried with the tests that run its line,
those first that enter the fewest files of the package.  Which tests these are, coverage has written before:

    python -m pip install cosmic-ray pytest-cov
    python -m pytest -n 0 -m "not slow" --cov=liepoisson --cov-context=test --cov-report=
    python verification/mutants.py --count 150 --seed 1

With `--before FOLDER`, a clone of an older version with its own `.coverage`, functions are drawn from those that both
have, and only lines that both have; each mutant that survives here is tried there.

It changes one source file at a time and puts it back, so run it in a clone of its own.  Survivors are printed with what
was changed.  Reference: DeMillo, Lipton and Sayward, Computer 11 (1978) 34.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
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


class Function(NamedTuple):
    """A function where it stands: its lines are numbers `first` to `last` of the file."""

    module: Path
    name: str
    first: int
    last: int
    lines: tuple[str, ...]

    def place(self, line: str) -> int | None:
        """The number of a line that the function has once."""
        return self.first + self.lines.index(line) if self.lines.count(line) == 1 else None


def functions(root: Path) -> Iterator[Function]:
    """All functions of the package, without their headers and docstrings."""
    for module in sorted((root / "python" / "liepoisson").rglob("*.py")):
        text = module.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef) and (body := node.body[ast.get_docstring(node) is not None :]):
                first, last = body[0].lineno, body[-1].end_lineno or body[-1].lineno
                lines = tuple(line.strip() for line in text.splitlines()[first - 1 : last])
                yield Function(module, node.name, first, last, lines)


def in_both(before: Path) -> dict[Function, Function]:
    """Functions, and those of the older version that have the same name and at least half of their lines."""
    older: dict[str, list[Function]] = defaultdict(list)
    for function in functions(before):
        older[function.name].append(function)
    pairs = dict[Function, Function]()
    for function in functions(ROOT):
        common = {old: (Counter(old.lines) & Counter(function.lines)).total() for old in older[function.name]}
        best = max(common, key=common.__getitem__, default=None)
        if best and 2 * common[best] >= max(len(function.lines), len(best.lines)):
            pairs[function] = best
    return pairs


@cache
def mutants(module: Path) -> list[tuple[str, int, int]]:
    """(operator, occurrence, line) of all mutants of a module."""
    import cosmic_ray.plugins
    from cosmic_ray.ast import ast_nodes, get_ast_from_path

    tree, found = get_ast_from_path(module), list[tuple[str, int, int]]()
    for name in OPERATORS:
        operator = cosmic_ray.plugins.get_operator(name)()
        positions = [position for node in ast_nodes(tree) for position in operator.mutation_positions(node)]
        found += [(name, occurrence, start[0]) for occurrence, (start, _) in enumerate(positions)]
    return found


def mutation(module: Path, name: str, occurrence: int) -> tuple[str, str] | None:
    """The line that a mutation changes, before and after; None if it is not one line, no Python, or only `strict=`."""
    import cosmic_ray.plugins
    from cosmic_ray.mutating import mutate_code

    text = module.read_text(encoding="utf-8")
    code = mutate_code(text, cosmic_ray.plugins.get_operator(name)(), occurrence) or text
    try:
        ast.parse(code)
    except SyntaxError:
        return None
    pairs = zip(text.splitlines(), code.splitlines(), strict=False)
    changed = [(old.strip(), new.strip()) for old, new in pairs if old != new]
    if len(changed) != 1 or changed[0][0] == changed[0][1].replace("strict=False", "strict=True"):
        return None
    return changed[0]


def sample(pairs: dict[Function, Function], seed: int) -> Iterator[tuple[Function, str, str, str]]:
    """One mutant of each function, in an order drawn with the seed: function, operator, line before and after."""
    draw = random.Random(seed)
    for function in draw.sample(list(pairs), len(pairs)):
        own = [row for row in mutants(function.module) if function.first <= row[2] <= function.last]
        for name, occurrence, _ in draw.sample(own, len(own)):
            change = mutation(function.module, name, occurrence)
            if change and function.place(change[0]) and pairs[function].place(change[0]):
                yield function, name, *change
                break


def tests_of(root: Path, module: Path, line: int) -> list[str]:
    """The tests that run a statement, or else its module; first those that run much of it and enter few other files."""
    from coverage.numbits import numbits_to_nums

    heads = [node for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))) if isinstance(node, ast.stmt)]
    statement = {line, max(node.lineno for node in heads if node.lineno <= line)}
    with sqlite3.connect(root / ".coverage") as data:
        entered: dict[int, int] = dict(data.execute("select context_id, count(*) from line_bits group by context_id"))
        found = data.execute(
            "select context, context_id, numbits from line_bits join context on context.id = context_id"
            " join file on file.id = file_id where path = ? and context != ''",
            (str(module),),
        )
        rows = [(context, entered[number], set(numbits_to_nums(bits))) for context, number, bits in found]
    running = [row for row in rows if statement & row[2]] or rows
    running.sort(key=lambda row: row[1] / len(row[2]))
    return list(dict.fromkeys(context.rpartition("|")[0] for context, *_ in running))


def noticed_by(root: Path, function: Function, before: str, after: str, seconds: float) -> str:
    """The test that notices a changed line, or a word of SURVIVED."""
    place = function.place(before)
    assert place is not None
    tests = tests_of(root, function.module, place)
    if not tests:
        return "no test"
    original = function.module.read_text(encoding="utf-8")
    lines = original.splitlines(keepends=True)
    lines[place - 1] = lines[place - 1].replace(before, after)
    environment = os.environ | {"PYTHONPATH": str(root / "python"), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "Agg"}
    command = [sys.executable, "-m", "pytest", "-x", "-n", "0", "-p", "no:cacheprovider", "--tb=no", "--no-header"]
    ends = time.monotonic() + seconds
    try:
        function.module.write_text("".join(lines), encoding="utf-8")
        for batch in filter(None, (tests[:20], tests[20:200], tests[200:])):
            with tempfile.NamedTemporaryFile("w", suffix=".txt") as names:
                names.write("\n".join(batch))
                names.flush()
                run, left = [*command, f"@{names.name}"], ends - time.monotonic()
                done = subprocess.run(run, cwd=root, env=environment, timeout=left, capture_output=True, check=False)
            failed = [line for line in done.stdout.decode().splitlines() if line.startswith(("FAILED", "ERROR"))]
            if done.returncode:
                return " ".join(failed) or done.stderr.decode().strip() or "stopped"
    except subprocess.TimeoutExpired:
        return "no time"
    finally:
        function.module.write_text(original, encoding="utf-8")
    return ""


SURVIVES = ("", "no time", "no test")


def main() -> None:
    """Try the sample, print what survives, and keep the results in a file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=150, help="of mutants")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=300.0, help="of tests for one mutant")
    parser.add_argument("--before", type=Path, help="a clone of an older version")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "mutants.json")
    options = parser.parse_args()
    done = json.loads(options.out.read_text()) if options.out.exists() else {}
    pairs = in_both(options.before.resolve()) if options.before else {each: each for each in functions(ROOT)}
    for function, name, *change in islice(sample(pairs, options.seed), options.count):
        key = f"{function.module.relative_to(ROOT).as_posix()}:{function.place(change[0])} {name}"
        if key in done:
            continue
        row = {"change": change, "noticed": noticed_by(ROOT, function, *change, options.seconds)}
        if options.before and row["noticed"] in SURVIVES:
            row["before"] = noticed_by(options.before.resolve(), pairs[function], *change, options.seconds)
        done[key] = row
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps(done, indent=1))
        if row["noticed"] in SURVIVES:
            print(f"SURVIVED ({row['noticed'] or 'all pass'})", key, *change, sep="\n", flush=True)
    print(f"{sum(row['noticed'] not in SURVIVES for row in done.values())} of {len(done)} mutants were noticed")


if __name__ == "__main__":
    main()
