"""Systems as text, LaTeX or data: the report behind `liepoisson inspect`, and the short one behind `describe`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from liepoisson.formula.styles import LATEX, LETTERS, NAMES, UNICODE, Style
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.refusals import not_a_system
from liepoisson.io.display import as_text
from liepoisson.report.bracket_facts import algebra_topic, extension_topic, jacobi_topic
from liepoisson.report.damping_and_noise import HasNoise, damping_topic, noise_topic
from liepoisson.report.integral_facts import integral_topic
from liepoisson.report.leaf_facts import Casimirs, rank_topic, strata_topic, symmetry_topic
from liepoisson.report.lines import Equation, Line, Name, Sign, wrapped, write_line
from liepoisson.report.motion_facts import Motion, kernel_topic
from liepoisson.report.printing import Gradient
from liepoisson.report.topics import Topic, not_computed, too_large, unless_too_large
from liepoisson.report.vector_notation import VectorNotation
from liepoisson.structure.casimirs import shortage

MOST_SHOWN = 12
"""Coordinates of a bracket, or brackets of a Lie algebra, that a notebook shows."""

if TYPE_CHECKING:
    from liepoisson.damping.damped_system import DampedSystem
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.lie_algebra import LieAlgebra

_TITLE_WIDTH = 17
_TEXT_WIDTH = 100
_DISPLAY_WIDTH = 70
_MATH = re.compile(
    r"\b(?P<algebra>so|su|sl|gl|se|sp)(?P<size>\(\d[\d, ]*\))|(?P<casimir>J grad C = 0)|"
    r"\b(?P<name>[A-Za-z]+\d+|[JHCl]|" + "|".join(sorted(LETTERS, key=len, reverse=True)) + r")\b(?!\()"
)
"""What is mathematics among the words of a report: so(3), l1, epsilon, J."""


@explains_its_methods
@dataclass(frozen=True)
class Report:
    r"""What is known about a system, computed when the report was made.

    Example:
        >>> report = lp.inspect(lp.catalog.system("lagrange"))
        >>> report.failed  # nothing that was claimed is wrong
        ()
        >>> print(*(line.strip() for line in str(report).splitlines() if line.strip().startswith("complete")))
        complete: 2 independent, as many as the corank of J allows

    Attributes:
        name: Of the system.
        source: Where it is described, if that was said.
        topics: The parts, in the order of printing.
        failed: What was claimed and is not so, one sentence each: the Jacobi identity, integrals that were given.
    """

    name: str
    source: str | None
    topics: tuple[Topic, ...]
    failed: tuple[str, ...]

    def __str__(self) -> str:
        return self.text(UNICODE)

    def _repr_html_(self) -> str:
        """What a notebook shows: the report."""
        return as_text(str(self))

    def text(self, style: Style) -> str:
        """The report for a terminal."""
        rows = [style.words(self.name)]
        rows += _indented("Source", [(self.source,)], style) if self.source else []
        for topic in self.topics:
            rows += _indented(topic.title, topic.lines, style)
        return "\n".join(rows)

    def latex(self) -> str:
        """The report as a fragment for a paper, which needs amsmath and amssymb: paragraphs, and aligned equations."""
        parts = [
            "% needs amsmath, amssymb",
            rf"\subsection*{{{LATEX.words(self.name)}}}",
            LATEX.words(self.source or ""),
        ]
        for topic in self.topics:
            parts.append(rf"\paragraph{{{topic.title}.}}")
            parts += _paragraphs(topic.lines)
        return "\n\n".join(part for part in parts if part)

    def record(self) -> dict[str, Any]:
        """The report as data that JSON can write.

        `name`, `source` and one entry per topic: `damping` or `noise` where there is some, `algebra`, `extension`,
        `bracket` (with `jacobi`), `casimirs`, `rank`, `strata`, `symmetries`, `hamiltonian`, `equations`, `integrals`,
        `kernel`.  A formula is an object with `text` (ASCII), `unicode`, `latex` and, where it is a function on phase
        space, `expression`: the same in components, in the grammar of system files.  A proof is a Boolean (`proved`,
        `verified`, `complete`) beside what was proved.
        Where the Jacobi identity fails, there is no `casimirs`, `rank`, `strata`, `symmetries`.  Where a stratum is not
        proved, sets of lower rank may be missing among the `strata`.  `definitions` say what signs in the formulas
        beside them mean where this is not usual, as the scalar product of so(2,1).  A part that was left out for
        the size of the system is an object `not_computed` that says so.  `failed` lists what was claimed and
        is refuted.
        """
        topics = {topic.key: topic.record() for topic in self.topics}
        return {"name": self.name, "source": self.source, **topics, "failed": list(self.failed)}


@explains_its_arguments
def inspect(system: System | DampedSystem | HasNoise) -> Report:
    """Everything that the exact algebra finds out about a system; each proof is computed now.

    Of a damped system, or one with noise, it begins with the damping or the noise, and what stays constant with it; all
    else is about the system without.

    Example:
        >>> report = lp.inspect(lp.catalog.system("free-rigid-body"))
        >>> report.name, report.failed
        ('free-rigid-body', ())

    Args:
        system: Any system, with or without values for its parameters; a `DampedSystem`; a `NoisySystem`.

    Raises:
        ParameterError: it is no system.
    """
    from liepoisson.model.system import System

    name: str = getattr(system, "name", "")
    # a system is asked for no attribute which it has not: NumPy would be loaded
    itself, topics = (system, []) if isinstance(system, System) else _beneath(system)
    bracket, notation = itself.bracket, VectorNotation(itself.bracket)
    # else nothing of g and A is left in the bracket, or it has none
    if bracket.has_algebra and (bracket.entries() or not bracket.constant):
        topics += [
            unless_too_large("algebra", itself, lambda: algebra_topic(bracket)),
            unless_too_large("extension", itself, lambda: extension_topic(bracket)),
        ]
    bracket_topics, failures = _bracket_topics(itself, notation)
    motion, (integrals, refuted) = Motion(itself, notation), integral_topic(itself, notation)
    topics += [
        *bracket_topics,
        motion.hamiltonian_topic(),
        unless_too_large("equations", itself, motion.equation_topic),
        integrals,
        kernel_topic(itself),
    ]
    return Report(name, itself.source, tuple(topics), (*failures, *refuted))


def _beneath(given: Any) -> tuple[System, list[Topic]]:
    """The system that is damped or shaken, and what is said of damping and noise."""
    from liepoisson.model.system import System

    if isinstance(own := getattr(given, "undamped", None), System):
        return own, [damping_topic(cast("DampedSystem", given))]
    if hasattr(given, "noise") and isinstance(own := getattr(given, "system", None), System):
        return own, [noise_topic(cast("HasNoise", given))]
    raise not_a_system(given)


def _bracket_topics(system: System, notation: VectorNotation) -> tuple[list[Topic], list[str]]:
    """Jacobi, and if it holds Casimirs, leaves and symmetries; and where Jacobi fails."""
    bracket = system.bracket
    if obstacle := too_large("bracket", system):
        return [not_computed(key, obstacle) for key in ("bracket", "casimirs", "rank", "strata", "symmetries")], []
    certificate = bracket.jacobi_certificate()
    jacobi, failures = jacobi_topic(bracket, certificate), [str(failure) for failure in certificate.failures]
    if not certificate.holds:  # there are no Casimirs and leaves to speak of
        return [jacobi], failures
    casimirs = Casimirs(bracket, notation)
    known = [jacobi, casimirs.topic(), rank_topic(casimirs), strata_topic(casimirs)]
    if not bracket.has_algebra:  # symmetries are looked for among maps of fields
        return known, failures
    symmetries = unless_too_large("symmetries", system, lambda: symmetry_topic(bracket, system.hamiltonian))
    return [*known, symmetries], failures


def describe(system: System) -> str:
    """Name, bracket, Hamiltonian, equations of motion and invariants of a system, one per line."""
    top, notation = system.top_parameters, VectorNotation(system.bracket)
    motion = Motion(system, notation)
    lines = [system.name, f"  bracket      {system.bracket!r}"]
    circles = [f"{name} by {notation.formula(period).write(NAMES)}" for name, period in system.periods.items()]
    lines += [f"  periodic     {', '.join(circles)}"] if circles else []
    lines += [f"  parameters   {top.describe()}"] if top is not None else []
    lines.append(f"  Hamiltonian  {Equation(Name('H'), motion.hamiltonian).write(NAMES)}")
    lines += ["  equations", *(f"    {line}" for line in _written_equations(motion, NAMES)), "  invariants"]
    for name, expression in system.invariants.items():
        lines.append(f"    {name} = {notation.formula(expression).write(NAMES)}")
    lines += [f"    ({missing})"] if (missing := shortage(system.bracket)) else []
    definitions = notation.definitions(notation.formula(e) for e in (*system.invariants.values(), system.hamiltonian))
    lines += [f"    {definition.write(NAMES)}" for definition in definitions]
    return "\n".join(lines)


def displayed(system: System) -> str:
    r"""Hamiltonian, equations of motion and invariants in LaTeX, in one display with aligned equality signs."""
    notation = VectorNotation(system.bracket)
    motion = Motion(system, notation)
    formulas = [Equation(Name("H"), motion.hamiltonian).write(LATEX), *_written_equations(motion, LATEX)]
    for name, expression in system.invariants.items():
        if name != "H":
            written = Equation(Name(name), notation.formula(expression)).write(LATEX)
            # an integral that is named by its formula is written once
            formulas.append(written if " = " in written else rf"{written} = \text{{const}}")
    rows = " \\\\\n".join(_aligned(formula) for formula in formulas)
    return f"$$\\begin{{aligned}}\n{rows}\n\\end{{aligned}}$$"


def displayed_bracket(bracket: Bracket) -> str | None:
    """The Poisson tensor of a bracket in LaTeX, by the coordinates; None where it is too large to be read."""
    if bracket.dimension > MOST_SHOWN:
        return None
    notation = VectorNotation(bracket)
    tensor: Any = bracket.poisson_tensor()
    rows = [
        " & ".join(notation.formula(tensor[i, j]).write(LATEX) for j in range(bracket.dimension))
        for i in range(bracket.dimension)
    ]
    state = ", ".join(notation.formula(x).write(LATEX) for x in bracket.variables)
    matrix = "\\begin{pmatrix}\n" + " \\\\\n".join(rows) + "\n\\end{pmatrix}"
    return f"$$J({state}) = {matrix}$$"


def displayed_algebra(algebra: LieAlgebra) -> str | None:
    """The brackets of a basis in LaTeX, those that are not zero; None where there are too many to be read."""
    from sympy import Add, Symbol, latex

    from liepoisson.algebra.exact_numbers import to_sympy

    if len(algebra.brackets) > MOST_SHOWN or algebra.dimension > MOST_SHOWN:
        return None
    e = [Symbol(f"e_{{{name}}}") for name in algebra.basis_names]
    rows = [
        f"[{latex(e[i])}, {latex(e[j])}] &= {latex(Add(*(to_sympy(c) * e[k] for k, c in row.items())))}"
        for (i, j), row in sorted(algebra.brackets.items())
        if any(c != 0 for c in row.values())
    ]
    head = LATEX.words(algebra.name)
    if not rows:
        return rf"$$\text{{{head}}}:\quad [e_i, e_j] = 0$$"
    body = " \\\\\n".join(rows)
    return f"$$\\text{{{head}}}:\\quad\\begin{{aligned}}\n{body}\n\\end{{aligned}}$$"


def _written_equations(motion: Motion, style: Style) -> list[str]:
    """Vector equations where all vectors have names of their own, else components."""
    vector = motion.vector
    if vector is not None and not any(isinstance(name, Gradient) for name, _ in vector.definitions):
        return [equation.write(style) for equation in (*motion.equations(), *motion.definitions())]
    if style is LATEX:
        return [
            rf"\dot{{{Name(name).write(style)}}} = {formula.write(style)}" for name, formula, _ in motion.components
        ]
    return [f"{name}' = {formula.write(style)}" for name, formula, _ in motion.components]


def _indented(title: str, lines: Sequence[Line], style: Style) -> list[str]:
    written = [row for line in lines for row in wrapped(line, style, _TEXT_WIDTH)]
    heads = [title, *[""] * (len(written) - 1)]
    return [f"  {head:<{_TITLE_WIDTH}}{row}" for head, row in zip(heads, written, strict=True)]


def _paragraphs(lines: Sequence[Line]) -> list[str]:
    """Lines in LaTeX: formulas that stand alone and fit on a line are displayed, those that follow each other aligned.

    TeX breaks a paragraph of words and formulas, also in sums.
    """
    written: list[str] = []
    displayed: list[str] = []
    for line in lines:
        if len(line) == 1 and not isinstance(line[0], str) and len(line[0].write(UNICODE)) <= _DISPLAY_WIDTH:
            displayed.append(line[0].write(LATEX))
            continue
        written += [*_display(displayed), f"{write_line(_with_mathematics(line), LATEX)}."]
        displayed = []
    return [*written, *_display(displayed)]


def _display(formulas: Sequence[str]) -> list[str]:
    """One formula in a display, several in one `align*`, at their equality signs."""
    if len(formulas) < 2:
        return [f"\\[ {formula} \\]" for formula in formulas]
    rows = " \\\\\n".join(f"  {_aligned(formula)}" for formula in formulas)
    return [f"\\begin{{align*}}\n{rows}\n\\end{{align*}}"]


def _aligned(formula: str) -> str:
    """The formula with the mark of alignment before its first relation outside of braces."""
    depth = 0
    for place, character in enumerate(formula):
        depth += {"{": 1, "}": -1}.get(character, 0)
        if not depth and formula.startswith((" = ", " \\mapsto "), place):
            return f"{formula[: place + 1]}&{formula[place + 1 :]}"
    return f"& {formula}"


def _with_mathematics(line: Line) -> Line:
    """The line with the mathematics among its words set off from them."""
    pieces: list[Any] = []
    for piece in line:
        if not isinstance(piece, str):
            pieces.append(piece)
            continue
        place = 0
        for match in _MATH.finditer(piece):
            pieces += [piece[place : match.start()], _sign(match)]
            place = match.end()
        pieces.append(piece[place:])
    kept = [piece for piece in pieces if piece]
    if isinstance(kept[0], str):  # a sentence
        kept[0] = kept[0][:1].upper() + kept[0][1:]
    return tuple(kept)


def _sign(match: re.Match[str]) -> Sign:
    """A piece of mathematics among words, in LaTeX."""
    if match["algebra"]:
        text = rf"\mathfrak{{{match['algebra']}}}{match['size']}"
    else:
        text = r"J\nabla C = 0" if match["casimir"] else Name(match["name"]).write(LATEX)
    return Sign(lambda _: text)
