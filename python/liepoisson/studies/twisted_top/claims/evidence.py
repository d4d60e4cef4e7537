"""What a check works with and what it comes to: the steps that it states, one by one, and the verdict.

A check of a claim gets an `Evidence` and records in it what was stated, what was computed, and whether the one bears
out the other; the verdict of the claim holds if all its steps are borne out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial, wraps
from typing import Any, Literal, TypeAlias

import liepoisson as lp
from liepoisson.studies.twisted_top.typography import show

Ruling: TypeAlias = Literal[
    "holds", "holds with a condition", "incomplete", "misprint", "wrong", "underspecified", "not settled", "not run"
]
Method: TypeAlias = Literal["exact", "enclosed", "numerical"]
StepKind: TypeAlias = Literal[
    "note", "identity", "value", "counterexample", "rank", "search", "enclosure", "measurement", "computation"
]

# How the kinds are named where a verdict says what it rests on, singular and plural, the most telling first.  What is
# computed in floating-point numbers beside a proof is no part of it.
_NAMES: dict[StepKind, tuple[str, str]] = {
    "counterexample": ("counter-example", "counter-examples"),
    "rank": ("rank certificate", "rank certificates"),
    "search": ("exhaustive search", "exhaustive searches"),
    "enclosure": ("check in rigorous arithmetic", "checks in rigorous arithmetic"),
    "identity": ("identity", "identities"),
    "value": ("exact value", "exact values"),
    "measurement": ("measurement", "measurements"),
}
# Vector notation is not looked for in expressions with more operations than this.
_MOST_OPERATIONS = 300
# Of longer sums, so many terms are printed and the others counted.
_MOST_TERMS = 8


@dataclass(frozen=True)
class Step:
    """One step of a proof."""

    kind: StepKind  # what sort of fact it is; a note states none
    text: str  # the fact, with its reason
    succeeded: bool | None = None  # whether the computation bears it out; None for a note
    remark: str = ""  # what came out instead, where it does not
    computed: tuple[str, ...] = ()  # what the computation gave, line by line: formulas, points, ranks, sizes
    table: tuple[tuple[str, ...], ...] = ()  # rows of a table, the first one the heading; empty if there is none
    components: int = 1  # how many expressions were compared
    decisive: bool = False  # whether the verdict turns on it

    @property
    def lines(self) -> list[str]:
        """The whole step as plain text: the fact with its mark, and below it what was computed."""
        mark = {None: " ", True: "✓", False: "✗"}[self.succeeded]
        remark = f" — {self.remark}" if self.remark and self.succeeded is not None else ""
        widths = [max(len(cell) for cell in column) for column in zip(*self.table, strict=True)]
        rows = ["  ".join(cell.rjust(n) for cell, n in zip(row, widths, strict=True)) for row in self.table]
        return [f"{mark} {self.text}{remark}", *(f"    {text}" for text in (*self.computed, *rows))]

    def to_json(self) -> dict[str, Any]:
        """The step as plain data."""
        return {**vars(self), "computed": list(self.computed), "table": [list(row) for row in self.table]}


def summary_of(steps: tuple[Step, ...]) -> str:
    """What a proof consists of, for example "1 counter-example, 3 identities"."""
    counts = [sum(step.kind == kind for step in steps) for kind in _NAMES]
    return ", ".join(f"{n} {words[n > 1]}" for words, n in zip(_NAMES.values(), counts, strict=True) if n)


@dataclass(frozen=True)
class Verdict:
    """What a check found."""

    # whether the claim holds; "incomplete" when it is right as far as it goes and more is proved here; "underspecified"
    # when the paper only implies it, or leaves open what decides it; "not run" when the measurements that it needs are
    # absent
    verdict: Ruling
    # "exact" for identities and counterexamples in exact arithmetic, "enclosed" for strict inequalities between
    # rigorous enclosures, "numerical" for measured numbers
    method: Method
    steps: tuple[Step, ...]  # the computation, step by step
    correct_statement: str = ""  # what is true instead, or the condition; empty when the claim holds as it stands
    # numbers and expressions (as text) behind the verdict, ready for JSON
    data: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def certificate(self) -> str:
        """The computation as text, one step per line, each marked ✓ or ✗, with what was computed below."""
        return "\n".join(line for step in self.steps for line in step.lines)


def extended_rotations(extension: lp.Extension) -> lp.Bracket:
    """The bracket of so(3) extended by a commutative algebra."""
    return lp.so(3) @ extension


def twisted_bracket(epsilon: Any) -> lp.Bracket:
    """The paper's bracket: so(3) with the Leibniz extension of order three, semidirect when epsilon = 0."""
    return lp.so(3) @ lp.leibniz(3, epsilon)


@dataclass(frozen=True)
class Context:
    """What the checks work with."""

    # makes the paper's bracket of three fields for a given epsilon.  A test can inject a wrong one
    bracket: Callable[[Any], lp.Bracket] = twisted_bracket
    # makes the bracket of so(3) with any extension, for claims about other extensions
    extended: Callable[[lp.Extension], lp.Bracket] = extended_rotations
    # results of the numerical study as `liepoisson.studies.twisted_top.measurements` writes them, or None; which keys
    # the claims use is said in `liepoisson.studies.twisted_top.claims.numerics`
    measurements: Mapping[str, Any] | None = None
    arithmetics: tuple[str, ...] = ("intervals", "balls")  # those that check the certificate of chaos


Check: TypeAlias = "Callable[[Evidence, Context], Verdict | None]"

CHECKS: dict[str, Check] = {}
"""The check of each claim by the id of the claim; one that returns no verdict leaves it to its evidence."""


def checks(claim: str, **options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Register the check of a claim; one that several claims share is called with the options of each."""

    def register(check: Callable[..., Any]) -> Callable[..., Any]:
        CHECKS[claim] = wraps(check)(partial(check, **options)) if options else check
        return check

    return register


def written(expression: Any, bracket: lp.Bracket) -> str:
    """A function on the phase space of a bracket in vector notation, for example "2ε a·(α × β)"."""
    expanded = expression.expand()
    in_vectors = expanded.count_ops() < _MOST_OPERATIONS
    text = lp.systems.vector_notation(expanded, bracket, in_vectors=in_vectors, most_terms=_MOST_TERMS)
    return text.replace("-", "−")


def names(variables: Iterable[Any]) -> str:
    """Coordinates, separated by commas."""
    return ", ".join(show(v) for v in variables)


def state(bracket: lp.Bracket, point: Sequence[Any]) -> str:
    """A point of the phase space, field by field: "l = (1, 2, −1), α = (3, 1, 2), …"."""
    n = bracket.algebra.dimension
    blocks = (tuple(point[k : k + n]) for k in range(0, len(point), n))
    return ", ".join(
        f"{show(name)} = ({names(block)})" for name, block in zip(bracket.field_names, blocks, strict=True)
    )


class Evidence:
    """The steps of a check, each a fact and whether it is borne out, and what follows if all of them are."""

    def __init__(self, verdict: Ruling = "holds", correct_statement: str = "") -> None:
        self.verdict: Ruling = verdict
        self.correct_statement = correct_statement
        self.steps: list[Step] = []
        self.data: dict[str, Any] = {}

    def note(self, text: str) -> None:
        """A line of explanation, without a computation."""
        self.steps.append(Step("note", text))

    def zero(self, what: str, residual: Any, computed: Sequence[str] = (), *, decisive: bool = False) -> bool:
        """State that `what` (a text with its reason) holds because `residual` vanishes identically.

        The residual is an expression, a matrix or an iterable of expressions; `computed` is shown of the computation;
        `decisive` says that the verdict turns on it, here and below.
        """
        entries = list(_entries(residual))
        left = [value for value in entries if not _vanishes(value)]
        remark = f"residual {show(_readable(left[0]))}" if left else ""
        step = Step("identity", what, not left, remark, tuple(computed), (), len(entries), decisive)
        return self._record(step)

    def identity(self, what: str, left: Any, right: Any, bracket: lp.Bracket, *, decisive: bool = False) -> bool:
        """State that two functions on the phase space are the same, and show the first as it was computed."""
        return self.zero(what, left - right, [f"computed: {written(left, bracket)}"], decisive=decisive)

    def nonzero(self, what: str, value: Any, *, decisive: bool = False) -> bool:
        """State that `what` holds because `value` (or one entry of it) does not vanish identically."""
        left = [entry for entry in _entries(value) if not _vanishes(entry)]
        computed = [f"computed: {show(_readable(left[0]))}"] if left else []
        return self.proof("value", what, bool(left), computed, decisive=decisive, otherwise="the value is 0")

    def equal(
        self,
        what: str,
        got: object,
        wanted: object,
        computed: Sequence[str] = (),
        *,
        kind: StepKind = "value",
        decisive: bool = False,
    ) -> bool:
        """State that the computed `got` is `wanted`."""
        text, otherwise = f"{what}: {show(wanted)}", f"computed {show(got)}"
        return self.proof(kind, text, got == wanted, computed, decisive=decisive, otherwise=otherwise)

    def counterexample(
        self, what: str, values: Mapping[str, tuple[object, object]], at: str, *, decisive: bool = True
    ) -> bool:
        """State what happens at one point, in exact numbers: of each quantity what was computed, and what is stated."""
        wrong = [f"{name} is {show(got)}" for name, (got, wanted) in values.items() if got != wanted]
        computed = (f"at {at}", *(f"{name} = {show(got)}" for name, (got, _) in values.items()))
        return self._record(Step("counterexample", what, not wrong, "; ".join(wrong), computed, decisive=decisive))

    def rank(self, what: str, bracket: lp.Bracket, point: Sequence[Any], wanted: int, *, decisive: bool = False) -> int:
        """State the rank of the Poisson tensor at a point, with a minor that does not vanish.

        An antisymmetric matrix of rank r has a principal minor of size r that is not zero: that of r independent rows.
        """
        tensor: Any = bracket.poisson_tensor()
        J = tensor.subs(dict(zip(bracket.variables, point, strict=True)))
        _, rows = J.T.rref()
        minor = J.extract(list(rows), list(rows)).det()
        chosen = names(bracket.variables[k] for k in rows)
        computed = (
            f"at {state(bracket, point)}",
            f"the minor of J with rows and columns {chosen} is {show(minor)}, all larger minors vanish",
        )
        self.equal(what, len(rows), wanted, computed, kind="rank", decisive=decisive)
        return len(rows)

    def independent(
        self,
        what: str,
        functions: Sequence[Any],
        bracket: lp.Bracket,
        point: Sequence[Any],
        computed: Sequence[str] = (),
    ) -> bool:
        """State that the differentials of the functions are independent at a point, with a minor of the matrix."""
        from sympy import Matrix

        at = dict(zip(bracket.variables, point, strict=True))
        slopes: Any = Matrix([[f.diff(x).subs(at) for x in bracket.variables] for f in functions])
        _, columns = slopes.rref()
        computed = [*computed, f"at {state(bracket, point)}"]
        if len(columns) == len(functions):
            minor = slopes.extract(list(range(len(functions))), list(columns)).det()
            chosen = names(bracket.variables[k] for k in columns)
            computed.append(f"the minor of the derivatives along {chosen} is {show(minor)}")
        return self.equal(what, len(columns), len(functions), computed, kind="rank")

    def search(
        self, what: str, table: Sequence[Sequence[object]], excess: int, wanted: int, *, decisive: bool = False
    ) -> bool:
        """State how many solutions an exhaustive search found beyond the known ones, with a table of its sizes."""
        rows = tuple(tuple(show(cell) for cell in row) for row in table)
        remark = "" if excess == wanted else f"computed {excess}"
        return self._record(Step("search", f"{what}: {wanted}", excess == wanted, remark, (), rows, decisive=decisive))

    def enclosures(self, what: str, table: Sequence[Sequence[object]], computed: Sequence[str] = ()) -> bool:
        """State what rigorous enclosures have proved just now; the table has a column for each arithmetic."""
        rows = tuple(tuple(map(str, row)) for row in table)
        return self._record(Step("enclosure", what, True, "", tuple(computed), rows))

    def computation(
        self, what: str, succeeded: bool, computed: Sequence[str] = (), table: Sequence[Sequence[object]] = ()
    ) -> bool:
        """State what was computed in floating-point numbers, with errors, beside what is proved."""
        rows = tuple(tuple(map(show, row)) for row in table)
        remark = "" if succeeded else "not borne out"
        return self._record(Step("computation", f"In floating point: {what}", succeeded, remark, tuple(computed), rows))

    def proof(
        self,
        kind: StepKind,
        what: str,
        succeeded: bool,
        computed: Sequence[str],
        *,
        decisive: bool = False,
        otherwise: str = "not proved",
    ) -> bool:
        """State what was proved just now; `computed` is its certificate, `otherwise` the remark where it was not."""
        remark = "" if succeeded else otherwise
        return self._record(Step(kind, what, succeeded, remark, tuple(computed), decisive=decisive))

    def conclude(self) -> Verdict:
        """The verdict if all steps are borne out, else another one with the failing steps as the reason.

        That is "wrong" for a claim that should hold, and "not settled" for one whose refutation fails.
        """
        steps = tuple(self.steps)
        failed = [f"{step.text} ({step.remark})" for step in steps if step.succeeded is False]
        if not failed:
            return Verdict(self.verdict, "exact", steps, self.correct_statement, self.data)
        fallback: Ruling = "wrong" if self.verdict.startswith("holds") else "not settled"
        reason = "The computation does not bear it out: " + "; ".join(failed) + "."
        return Verdict(fallback, "exact", steps, reason, self.data)

    def _record(self, step: Step) -> bool:
        self.steps.append(step)
        return bool(step.succeeded)


def _entries(value: Any) -> Iterable[Any]:
    from sympy import S
    from sympy.matrices import MatrixBase

    entries = value.flat() if isinstance(value, MatrixBase) else value if isinstance(value, (list, tuple)) else [value]
    return [S.Zero + entry for entry in entries]


def _readable(value: Any) -> Any:
    """Factored when that is quick; a large expression is cut by `show` anyway."""
    return value.factor() if value.count_ops() < 100 else value


def _vanishes(value: Any) -> bool:
    from sympy import cancel, together

    expanded = value.expand()
    return bool(expanded == 0 or cancel(together(expanded)) == 0)
