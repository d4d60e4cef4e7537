"""Collecting the steps of an exact check, and printing expressions as plain text with Unicode mathematics."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from liepoisson.studies.twisted_top.claims.model import Ruling, Verdict
from liepoisson.studies.twisted_top.claims.steps import Step, StepKind

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_GREEK = {
    "alpha": "α",
    "beta": "β",
    "epsilon": "ε",
    "eta": "η",
    "theta": "θ",
    "phi": "φ",
    "psi": "ψ",
    "omega": "ω",
    "kappa": "κ",
    "gamma": "γ",
    "sqrt": "√",
}
_LONGEST = 160
# Vector notation is not looked for in expressions with more operations than this.
_MOST_OPERATIONS = 300
# Of longer sums, so many terms are printed and the others counted.
_MOST_TERMS = 8


def show(expression: object) -> str:
    """An expression in one line of Unicode text, for example "2ε·l₁·β₁ + α₁²", cut when it is very long."""
    text = re.sub(r"\bc_(phi|psi|theta)\b", r"cos \1", str(expression))
    text = re.sub(r"\bs_(phi|psi|theta)\b", r"sin \1", text)
    for name, letter in _GREEK.items():
        text = re.sub(rf"(?<![A-Za-z]){name}(?![a-z])", letter, text)
    text = re.sub(r"\*\*(?:(\d+)|\((-?\d+)\))", lambda m: (m[1] or m[2]).translate(_SUPERSCRIPTS), text)
    text = re.sub(r"(?<=[A-Za-zα-ω])(\d+)", lambda match: match[1].translate(_SUBSCRIPTS), text)
    text = re.sub(r"√\((\d+)\)", r"√\1", text)
    text = text.replace("**", "^").replace("*", "·").replace("-", "−")
    return text if len(text) <= _LONGEST else text[: _LONGEST - 2] + " …"


def written(expression: Any, bracket: Bracket) -> str:
    """A function on the phase space of a bracket in vector notation, for example "2ε a·(α × β)"."""
    from liepoisson.formula.styles import UNICODE
    from liepoisson.report.vector_notation import VectorNotation

    expanded, notation = expression.expand(), VectorNotation(bracket)
    write = notation.formula if expanded.count_ops() < _MOST_OPERATIONS else notation.components
    return write(expanded).write(UNICODE, _MOST_TERMS).replace("-", "−")


def names(variables: Iterable[Any]) -> str:
    """Coordinates, separated by commas."""
    return ", ".join(show(v) for v in variables)


def state(bracket: Bracket, point: Sequence[Any]) -> str:
    """A point of the phase space, field by field: "l = (1, 2, −1), α = (3, 1, 2), …"."""
    n = bracket.algebra.dimension
    blocks = (tuple(point[k : k + n]) for k in range(0, len(point), n))
    return ", ".join(
        f"{show(name)} = ({', '.join(show(v) for v in block)})"
        for name, block in zip(bracket.field_names, blocks, strict=True)
    )


class Evidence:
    """The steps of a check.  Each step states a fact and records whether the computation bears it out."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.data: dict[str, Any] = {}

    def note(self, text: str) -> None:
        """A line of explanation, without a computation."""
        self.steps.append(Step("note", text))

    def zero(self, what: str, residual: Any, computed: Sequence[str] = (), *, decisive: bool = False) -> bool:
        """State that `what` (a text with its reason) holds because `residual` vanishes identically.

        Args:
            what: The fact.
            residual: An expression, a matrix or an iterable of expressions.
            computed: What to show of the computation.
            decisive: Whether the verdict turns on it.
        """
        entries = list(_entries(residual))
        left = [value for value in entries if not _vanishes(value)]
        remark = f"residual {show(_readable(left[0]))}" if left else ""
        step = Step("identity", what, not left, remark, tuple(computed), (), len(entries), decisive)
        return self._record(step)

    def identity(self, what: str, left: Any, right: Any, bracket: Bracket, *, decisive: bool = False) -> bool:
        """State that two functions on the phase space are the same, and show the first as it was computed."""
        return self.zero(what, left - right, [f"computed: {written(left, bracket)}"], decisive=decisive)

    def nonzero(self, what: str, value: Any, *, decisive: bool = False) -> bool:
        """State that `what` holds because `value` (or one entry of it) does not vanish identically."""
        left = [entry for entry in _entries(value) if not _vanishes(entry)]
        computed = (f"computed: {show(_readable(left[0]))}",) if left else ()
        return self._record(
            Step("value", what, bool(left), "" if left else "the value is 0", computed, decisive=decisive)
        )

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
        remark = "" if got == wanted else f"computed {show(got)}"
        text = f"{what}: {show(wanted)}"
        return self._record(Step(kind, text, got == wanted, remark, tuple(computed), decisive=decisive))

    def counterexample(
        self, what: str, values: Mapping[str, tuple[object, object]], at: str, *, decisive: bool = True
    ) -> bool:
        """State what happens at one point, in exact numbers.

        Args:
            what: The fact.
            values: For each quantity, what was computed and what is stated.
            at: The point.
            decisive: Whether the verdict turns on it.
        """
        wrong = [f"{name} is {show(got)}" for name, (got, wanted) in values.items() if got != wanted]
        computed = (f"at {at}", *(f"{name} = {show(got)}" for name, (got, _) in values.items()))
        return self._record(Step("counterexample", what, not wrong, "; ".join(wrong), computed, decisive=decisive))

    def rank(self, what: str, bracket: Bracket, point: Sequence[Any], wanted: int, *, decisive: bool = False) -> int:
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
        bracket: Bracket,
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
        """State how many solutions an exhaustive search found beyond the known ones, with the sizes of the search.

        Args:
            what: The fact.
            table: The sizes, the heading first.
            excess: How many were found beyond the known ones.
            wanted: How many are stated.
            decisive: Whether the verdict turns on it.
        """
        rows = tuple(tuple(show(cell) for cell in row) for row in table)
        remark = "" if excess == wanted else f"computed {excess}"
        return self._record(Step("search", f"{what}: {wanted}", excess == wanted, remark, (), rows, decisive=decisive))

    def enclosures(self, what: str, table: Sequence[Sequence[object]], computed: Sequence[str] = ()) -> bool:
        """State what rigorous enclosures have proved just now; the table has a column for each arithmetic."""
        rows = tuple(tuple(map(str, row)) for row in table)
        return self._record(Step("enclosure", what, True, "", tuple(computed), rows))

    def proof(
        self, kind: StepKind, what: str, succeeded: bool, computed: Sequence[str], *, decisive: bool = False
    ) -> bool:
        """State what another part of the library has proved just now; `computed` is its certificate."""
        remark = "" if succeeded else "not proved"
        return self._record(Step(kind, what, succeeded, remark, tuple(computed), decisive=decisive))

    def conclude(self, verdict: Ruling, correct_statement: str = "", otherwise: Ruling | None = None) -> Verdict:
        """The verdict if all steps are borne out, else `otherwise` with the failing steps as the reason.

        Args:
            verdict: What follows from the steps.
            correct_statement: What is true instead, or the condition.
            otherwise: Verdict when a step fails: by default "wrong" for a claim that should hold, and "not settled" for
                one whose refutation fails.
        """
        steps = tuple(self.steps)
        failed = [f"{step.text} ({step.remark})" for step in steps if step.succeeded is False]
        if not failed:
            return Verdict(verdict, "exact", steps, correct_statement, self.data)
        fallback: Ruling = "wrong" if verdict.startswith("holds") else "not settled"
        reason = "The computation does not bear it out: " + "; ".join(failed) + "."
        return Verdict(otherwise or fallback, "exact", steps, reason, self.data)

    def _record(self, step: Step) -> bool:
        self.steps.append(step)
        return bool(step.succeeded)


def _entries(value: Any) -> Iterable[Any]:
    from sympy.matrices import MatrixBase

    from liepoisson.algebra.exact_numbers import as_expression

    if isinstance(value, MatrixBase):
        return list(value.flat())
    return [as_expression(v, "a value") for v in (value if isinstance(value, (list, tuple)) else [value])]


def _readable(value: Any) -> Any:
    """Factored when that is quick; a large expression is cut by `show` anyway."""
    return value.factor() if value.count_ops() < 100 else value


def _vanishes(value: Any) -> bool:
    from sympy import cancel, together

    expanded = value.expand()
    return bool(expanded == 0 or cancel(together(expanded)) == 0)
