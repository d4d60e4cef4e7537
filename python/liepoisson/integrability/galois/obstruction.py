r"""Obstructions to integrability from the differential Galois group of the variational equations along a solution.

**Theorem** (Morales-Ruiz and Ramis [morales2001]; for systems with commuting fields Ayoul and Zung [ayoul2010]).  If a
vector field in N dimensions has p commuting meromorphic fields, itself among them, and q = N - p common meromorphic
first integrals, all independent almost everywhere, in a neighbourhood of a solution that is no equilibrium, then the
identity component $G^0$ of the Galois group of the variational equations along it is abelian.

A Lie-Poisson system that is integrable in the sense of Liouville with meromorphic integrals has p half of the rank of
J, and q of them with the Casimirs.  Its solutions may lie on leaves of any dimension: Ayoul and Zung need no regular
leaf.

Monodromy matrices belong to the Galois group also over the functions that are meromorphic near the curve, from which
its points at infinity and equilibria are left out, since these functions return to themselves along each loop.  So two
such matrices decide here (`liepoisson.integrability.galois.criteria`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Literal

from liepoisson.algebra.function_fields import root_text
from liepoisson.errors import EnclosureError, TimeLimitError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import SEARCH_LIMIT
from liepoisson.inputs.refusals import not_a
from liepoisson.integrability.galois.criteria import Commutator, ExactObstruction, commutators, exact_obstruction
from liepoisson.integrability.galois.linear_systems import MOST_COMPONENTS
from liepoisson.integrability.galois.solutions import ParticularSolution, check_polynomial, solutions_on_planes
from liepoisson.integrability.galois.variational import Flag, flag, variational_equations
from liepoisson.io.display import as_text
from liepoisson.model.system import System

if TYPE_CHECKING:
    from liepoisson.integrability.galois.linear_systems import LinearSystem

Verdict = Literal["not integrable", "no obstruction found", "open"]
How = Literal["checked exactly", "enclosed", "theorem", "not decided"]


@dataclass(frozen=True)
class GaloisStep:
    """A step of the argument.

    Attributes:
        text: The fact.
        how: "checked exactly" in exact arithmetic, "enclosed" in balls that contain the true numbers, "theorem" if it
            is quoted, "not decided" for what was left.
    """

    text: str
    how: How

    def __str__(self) -> str:
        return f"{self.text}: {self.how}"


@dataclass(frozen=True, eq=False, repr=False)
class GaloisObstruction:
    """What the variational equations along solutions say about integrability.

    Attributes:
        system: The system.
        verdict: "not integrable"; "no obstruction found", if all that was examined commutes, which proves nothing; or
            "open", if there was no solution, a singular point was not recognised as regular, or time was short.
        theorem: The theorem that is used.
        statement: What is proved, in words; empty if nothing is.
        solutions: The solutions along which was looked, the decisive one last.
        steps: The steps of the argument along the decisive solution, or along all of them if none is.
        exact: The exact criterion, if it holds.
        commutator: The commutator that is enclosed away from zero, if the exact criterion does not hold.
    """

    system: System
    verdict: Verdict
    theorem: str
    statement: str
    solutions: tuple[ParticularSolution, ...]
    steps: tuple[GaloisStep, ...]
    exact: ExactObstruction | None = None
    commutator: Commutator | None = None

    @property
    def is_proved_exactly(self) -> bool:
        """Whether all steps are exact, but for the theorem."""
        return self.verdict == "not integrable" and self.exact is not None

    def __repr__(self) -> str:
        return f"<GaloisObstruction of {self.system.name}: {self.verdict}>"

    def __str__(self) -> str:
        """The verdict and the steps."""
        lines = [f"{self.system.name}: {self.verdict}", *(f"- {step}" for step in self.steps)]
        return "\n".join([*lines, *([self.statement] if self.statement else [])])

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return as_text(str(self))


@shows_progress
def galois_obstruction(
    system: System,
    *,
    solution: ParticularSolution | None = None,
    most: int = 4,
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> GaloisObstruction:
    """Look for a proof that a system is not integrable, in the variational equations along particular solutions.

    Example:
        >>> found = lp.integrability.galois_obstruction(lp.Top.twisted_kovalevskaya())
        >>> found.verdict, found.is_proved_exactly
        ('not integrable', True)

    Args:
        system: A system with polynomial equations and rational coefficients.
        solution: A solution; by default those that `particular_solutions` finds are tried.
        most: How many of them at most.
        time_limit: Seconds after which no further matrix is computed.
        progress: As for `integrate`.

    Raises:
        ParameterError: the equations are not polynomial, or have coefficients that are not rational.
    """
    with as_deadline(time_limit).running():
        return _obstruction(system, solution, most, progress or (lambda _: None))


def _obstruction(
    system: System, solution: ParticularSolution | None, most: int, listen: Callable[[float], Any]
) -> GaloisObstruction:
    """As `galois_obstruction`, before the deadline of the call."""
    check_polynomial(system)
    if solution is not None and not isinstance(solution, ParticularSolution):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a ParticularSolution", solution, "solution", "write particular_solution(system, ...)")
    count = as_count(most, "most", least=1)
    found = iter((solution,)) if solution is not None else islice(solutions_on_planes(system), count)
    theorem, hypotheses, statement = _theorem(system)
    tried: list[tuple[ParticularSolution, LinearSystem, list[Flag]]] = []
    left: list[GaloisStep] = []
    for k in range(count):
        try:
            one = next(found, None)
            if one is None:
                break
            whole = variational_equations(system, one)
            pieces = [flag(whole.part(places)) for places in whole.summands if len(places) <= MOST_COMPONENTS]
            proved = next(((p, exact) for p in pieces if (exact := exact_obstruction(p)) is not None), None)
        except TimeLimitError:
            left.append(GaloisStep("further solutions were not tried: the time limit was reached", "not decided"))
            break
        if large := [places for places in whole.summands if len(places) > MOST_COMPONENTS]:
            text = f"a part of the variational equations with {len(large[0])} components was left out"
            left.append(GaloisStep(text, "not decided"))
        tried.append((one, whole, pieces))
        if proved is not None:
            steps = (*_along(one, whole, pieces), *_exact_steps(*proved), hypotheses)
            solutions = tuple(s for s, _, _ in tried)
            return GaloisObstruction(system, "not integrable", theorem, statement, solutions, steps, proved[1])
        listen((k + 1) / (2 * count))
    undecided = not tried or bool(left)
    about: dict[int, list[GaloisStep]] = {k: [] for k in range(len(tried))}
    # a part whose flag has steps of dimension one only has a solvable group, which is abelian more often
    waiting = [(max(piece.sizes) == 1, piece.system.n, k, piece) for k, (_, _, ps) in enumerate(tried) for piece in ps]
    for done, (_, _, k, piece) in enumerate(sorted(waiting, key=lambda one: one[:3]), start=1):
        proof, more = _enclosed(piece.system)
        if proof is not None:
            steps = (*_along(*tried[k]), *(s for s in more if s.how != "not decided"), hypotheses)
            solutions = (*(s for j, (s, _, _) in enumerate(tried) if j != k), tried[k][0])
            return GaloisObstruction(system, "not integrable", theorem, statement, solutions, steps, commutator=proof)
        undecided |= any(step.how == "not decided" for step in more)
        about[k] += more
        listen(0.5 + done / (2 * len(waiting)))
    left = [step for k, one in enumerate(tried) for step in (*_along(*one), *about[k])] + left
    if not left:
        left.append(GaloisStep("an invariant plane with one degree of freedom: none was found", "not decided"))
    verdict: Verdict = "open" if undecided else "no obstruction found"
    return GaloisObstruction(system, verdict, theorem, "", tuple(s for s, _, _ in tried), tuple(left))


def _theorem(system: System) -> tuple[str, GaloisStep, str]:
    """The theorem, its hypotheses, and what follows if the identity component is not abelian."""
    n, rank = len(system.variables), system.bracket.rank()
    casimirs = len(system.bracket.casimirs())
    fields, integrals = rank // 2, n - rank // 2
    if rank == n:
        name = "Morales-Ruiz and Ramis"
        text = (
            f"the theorem of {name}: with {fields} commuting integrals, meromorphic near the curve and independent, "
            "the identity component of the Galois group would be abelian"
        )
        statement = (
            f"There are no {fields} commuting independent integrals that are meromorphic in a neighbourhood of this "
            "curve: the system is not Liouville integrable with meromorphic integrals."
        )
        return name, GaloisStep(text, "theorem"), statement
    name = "Ayoul and Zung"
    text = (
        f"the theorem of {name}: with {fields} commuting fields and {integrals} common integrals, meromorphic near the "
        "curve and independent, the identity component of the Galois group would be abelian"
    )
    also = f", the {casimirs} Casimirs among them," if casimirs == n - rank and casimirs else ""
    statement = (
        f"There are no {fields} commuting fields, that of the system among them, with {integrals} common independent "
        f"integrals{also} all meromorphic in a neighbourhood of this curve: the system is not Liouville integrable "
        "with meromorphic integrals."
    )
    return name, GaloisStep(text, "theorem"), statement


def _along(solution: ParticularSolution, whole: LinearSystem, pieces: list[Flag]) -> list[GaloisStep]:
    """The solution, and how the variational equations decompose."""
    blocks = "; ".join(f"{', '.join(p.system.names)} (flag {'+'.join(map(str, p.sizes))})" for p in pieces)
    points = [root_text(f, whole.variable) for f in whole.singular_points]
    points += ["infinity"] * whole.infinity_is_singular
    return [
        GaloisStep(f"{solution} solves the equations ({solution.origin})", "checked exactly"),
        GaloisStep(f"the variational equations decompose into the parts {blocks}", "checked exactly"),
        GaloisStep(f"they are singular at {', '.join(points) or 'no point'}", "checked exactly"),
    ]


def _exact_steps(piece: Flag, exact: ExactObstruction) -> list[GaloisStep]:
    log, system = exact.logarithm, piece.system
    a, b = log.low, log.high
    local, other = system.local(log.point), system.local(exact.other)
    power = local.exponents.neat_power
    monodromy = "the monodromy" if local.exponents.all_integers else f"power {power} of the monodromy"
    facts = [
        f"on ({', '.join(system.names)}) the exponents at {local.place} are {local.exponents.text}: {monodromy} there "
        "is unipotent",
        f"{local.n_without_logarithm} of {system.n} solutions have no logarithm there; with F_k the invariant "
        f"subspaces of dimension {', '.join(map(str, piece.dimensions))}, the logarithm N of the monodromy, of rank "
        f"{log.rank} on F_{b}/F_{a}, maps F_{b}/F_{b - 1} to F_{a + 1}/F_{a} and all else to 0",
    ]
    commutes = "is rational, so that no power of this monodromy commutes with N"
    if b - a == 1:
        facts.append(
            f"at {other.place} the exponents on F_{b}/F_{a} are {exact.image.text}: no difference of two of them "
            f"{commutes}"
        )
    else:
        facts.append(
            f"at {other.place} the exponents on F_{a + 1}/F_{a} are {exact.image.text}, those on F_{b}/F_{b - 1} are "
            f"{exact.source.text}: no difference {commutes}"
        )
    return [GaloisStep(fact, "checked exactly") for fact in facts]


def _enclosed(system: LinearSystem) -> tuple[Commutator | None, list[GaloisStep]]:
    """Commutators of a part of the variational equations."""
    names = ", ".join(system.names)
    if system.n == 1 or not system.singular_points:
        return None, []
    try:
        found, left = commutators(system)
    except (EnclosureError, TimeLimitError) as error:
        return None, [GaloisStep(f"on ({names}) monodromy matrices were not computed ({error})", "not decided")]
    steps = [GaloisStep(f"on ({names}) {text}", "not decided") for text in left]
    if proof := next((c for c in found if c.is_proved), None):
        where = ", ".join(
            f"{system.local(f).place}: {system.local(f).exponents.text}"
            for f in [*system.singular_points, *([None] if system.infinity_is_singular else [])]
            if system.local(f).is_regular
        )
        steps.append(
            GaloisStep(
                f"on ({names}) the exponents are {where}; so no quotient of two different eigenvalues of these powers "
                "is a root of unity, and if the identity component were abelian they would commute",
                "checked exactly",
            )
        )
        steps.append(GaloisStep(f"on ({names}) {proof.text}", "enclosed"))
        return proof, steps
    if found:
        worst = max(found, key=lambda c: c.error / max(c.scale, 1.0))
        steps.append(
            GaloisStep(
                f"on ({names}) {len(found)} commutators of monodromy matrices contain 0: entries of gh - hg are at "
                f"most {worst.error:.1e}, those of gh up to {worst.scale:.1e}",
                "enclosed",
            )
        )
    return None, steps
