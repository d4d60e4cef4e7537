r"""Equilibria on symplectic leaves and relative equilibria: by algebra where it decides, else by a search.

An equilibrium of a Lie-Poisson system is a relative equilibrium of the system that it was reduced from: a steady
rotation, for a top. It is a critical point of H on its leaf, $\nabla H = \sum_k\lambda_k\nabla C_k$. With a further
integral K (such as $\ell_3$ of a Lagrange top) there are critical points of H on the common level set,
$\nabla H = \sum_k\lambda_k\nabla C_k + \Omega\nabla K$: the motion there is that of $\Omega K$ alone.

**By algebra**, on a regular leaf, all are found where they are finitely many. An equilibrium is a zero of $J\nabla H$
at which the Casimirs have the values of the leaf. Where bracket, Hamiltonian and Casimirs are polynomials with rational
coefficients, these equations are a polynomial system over the rationals (doubles are rational), and
`liepoisson.algebra.ideals` finds all of its real solutions. There are no multipliers in them, so they hold at singular
points of the level set, too. A solution at which J has the rank of the leaf lies on a leaf of this level set; where
ball arithmetic does not show this rank, nothing is decided.

Families of equilibria, real or complex, are left to the search.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, arb_mat
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.ideals.certified_roots import ball, precision
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem, polynomial
from liepoisson.equilibrium.critical_points import (
    CriticalEquations,
    HamiltonianFields,
    critical_points,
    finished,
)
from liepoisson.equilibrium.equilibrium_list import Equilibria, signed_sum
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch, at_rest, is_critical
from liepoisson.equilibrium.euler_characteristic import euler_characteristic
from liepoisson.equilibrium.heavy_equilibria import exact_top
from liepoisson.equilibrium.stability import (
    Equilibrium,
    analysis,
    integrals_of,
    judged,
    not_tiny,
    with_all_energy,
)
from liepoisson.equilibrium.top_equilibria import equilibria_of_top, euler_characteristic_of_leaf, natural_units
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_deadline, as_number, as_seed
from liepoisson.inputs.arrays import Array, norm
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import named
from liepoisson.inputs.refusals import shown
from liepoisson.leaf._checks import are_equal, as_system
from liepoisson.leaf.leaf import Leaf

if TYPE_CHECKING:
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System

_MOST, _ONCE = 16, 4
"""The search takes at most this many times `n_starts`, unless the caller says otherwise: where the check fails, and
where an equilibrium was met once only."""


@explains_its_arguments
def equilibria(
    system: System,
    leaf: Leaf | Mapping[str, float],
    *,
    along: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
    n_starts: int = 200,
    most_starts: int | None = None,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Equilibria:
    r"""The equilibria on a leaf: all of them for a top, elsewhere those that a search finds, with a check.

    **Tops** with rational parameters (doubles are rational): the equations are polynomial, and their real solutions are
    computed with a proof that there are no others, isolated ones and families. `proved` is then true. Heavy tops of six
    components, on so(3) @ semidirect(2), and free rigid bodies on so(3) are tops, too, by whatever name.

    **Other polynomial systems** with rational numbers, on regular leaves: the same, where the equations have finitely
    many solutions, complex ones too, and are solved within limits of about three seconds.

    **Other systems**, relative equilibria (`along`), families, and leaves of tops on which the algebra does not decide
    whether an isolated equilibrium is one or two: Newton's method from random starts, and from what the algebra
    found. What is found are equilibria; that there are no others is not proved. There is one check: where H is proper
    on the leaf, the sum of $(-1)^{\rm index}$ over nondegenerate equilibria is the Euler characteristic of the leaf
    (a family counts with its own, a circle with 0). It is necessary and not sufficient. While it fails, the number of
    starts is doubled, up to `most_starts`, and up to four times `n_starts` while an equilibrium was met from one
    start only.
    `completeness` says which of these is the case, and so does the printed result. The starts
    depend on the values of the Casimirs and the seed; the state from which a regular leaf was made does not matter.

    Equilibria that come in families (with the symmetry of the system, as circles) are listed once for each connected
    family, with the spectrum of one member; `family` says what it is. The search knows the families that the known
    integrals of the system make. Where it is not known that there is one equilibrium, or one such family, it lists
    what it found as "undecided".

    Example:
        >>> system = lp.catalog.system("lagrange")
        >>> len(lp.equilibria(system, lp.Leaf(system, {"C1": "1/5", "C2": 1})))
        2

    Args:
        system: A system whose parameters are all numbers.
        leaf: The leaf, or the values of the Casimirs by name.
        along: Integrals, by their names in `system.invariants` or as formulas, for relative equilibria.
        values: Their values, by name.
        n_starts: Number of starts of a search, random states projected to the leaf.
        most_starts: What it may be doubled to; 16 times `n_starts` by default.
        seed: Draws them.
        time_limit: Seconds after which the search ends with what it has found, and `is_cut_short` is true.

    Returns:
        The equilibria by increasing energy, a sequence that knows what is proved about it.

    Raises:
        LeafError: the Casimirs have no state, or the equations of the leaf are not known.
        ParameterError: the Hamiltonian depends on time; `leaf` is neither a leaf of the system nor values of its
            Casimirs; `values` does not name the integrals of `along`; one of these is not constant, or has no motion of
            its own; or `n_starts`, `most_starts` or `seed` is no whole number.
        TimeLimitError: the time limit passes before the search begins.

    References: [holm1985], for the equations; [milnor1963], for the sum.
    """
    system = as_system(system)
    if system.clock is not None:
        raise ParameterError(
            f"system: wanted one that may rest; got {system.name}, whose Hamiltonian depends on time. Its orbits with "
            f'the period of the drive are fixed points of first_return(system, starts, surface="{system.clock}", ...).'
        )
    leaf = _leaf(system, leaf)
    n_starts, seed = as_count(n_starts, "n_starts", least=1), as_seed(seed)
    most = _MOST * n_starts if most_starts is None else as_count(most_starts, "most_starts", least=1)
    integrals = integrals_of(system, along)
    wanted = _level(integrals, values, None)
    with as_deadline(time_limit).running():
        found = _equilibria(leaf.moving, integrals, wanted, n_starts=n_starts, most=most, seed=seed)
    known = [with_all_energy(leaf, one) for one in found.found]
    return replace(found, leaf=leaf, found=tuple(one for one in known if np.isfinite(one.energy)))  # where H is real


def _equilibria(
    leaf: Leaf, integrals: Mapping[str, PhaseFunction], wanted: Array, *, n_starts: int, most: int, seed: int
) -> Equilibria:
    """As `equilibria`, before the deadline of the call."""
    seeds: Array = np.zeros((0, len(leaf.state)))
    if not integrals:
        found, seeds = _by_algebra(leaf)
        if found is not None:
            return found
    expected = None if integrals else euler_characteristic(leaf)
    search = EquilibriumSearch(leaf, integrals, wanted, seed)
    if len(seeds):
        search.add_from(seeds)
    search.extend(n_starts)
    search.until_all_were_met_again(min(most, _ONCE * n_starts))
    search.until_the_sum_is(expected, most)
    total = None if integrals else search.signed_sum()  # with integrals it would belong to another space
    return Equilibria(
        leaf, tuple(search.found), False, expected, total, search.n_starts, is_cut_short=search.is_cut_short
    )


def _by_algebra(leaf: Leaf) -> tuple[Equilibria | None, Array]:
    """All equilibria with a proof, or None: also where their signs do not sum to the Euler characteristic.

    The sum is independent of the proof. If it is wrong, the proof has a gap or a state was rounded to another sign, and
    a search answers instead, with what it cannot prove in words; it may start from the states in the second place.
    """
    if leaf.rank == 0:
        return Equilibria(leaf, (analysis(leaf, leaf.state, {}),), True, 1, 1, 0), leaf.state[None]
    top = exact_top(leaf.system)
    if top is None:
        return _by_elimination(leaf)
    by_algebra, is_all = equilibria_of_top(leaf, top)
    states = np.array([one.state for one in by_algebra]).reshape(-1, len(leaf.state))
    if not is_all:
        return None, states
    units = natural_units(leaf, top, by_algebra)
    found = [_with_family(analysis(leaf, one.state, {}, units), one.kind) for one in by_algebra]
    found.sort(key=lambda e: e.energy)
    expected, total = euler_characteristic_of_leaf(leaf, top), signed_sum(found)
    if expected is not None and total is not None and total != expected:
        return None, states
    return Equilibria(leaf, tuple(found), True, expected, total, 0), states


def _by_elimination(leaf: Leaf) -> tuple[Equilibria | None, Array]:
    """The same for a polynomial system that is no top."""
    proved = polynomial_equilibria(leaf)
    if proved is None:
        return None, np.zeros((0, len(leaf.state)))
    found = sorted((_with_family(analysis(leaf, x, {}), "point") for x in proved.states), key=lambda e: e.energy)
    expected, total = euler_characteristic(leaf), signed_sum(found)
    if expected is not None and total is not None and total != expected:
        return None, proved.states
    return Equilibria(leaf, tuple(found), True, expected, total, 0, proved.degree), proved.states


def _with_family(equilibrium: Equilibrium, kind: str) -> Equilibrium:
    return replace(equilibrium, family="degenerate" if kind == "point" and equilibrium.nullity else kind)


def _leaf(system: System, given: Any) -> Leaf:
    if isinstance(given, Leaf):
        if not are_equal(given.system, system):
            raise ParameterError(
                f"leaf must be one of {shown(system)}; got one of {given.system.name!r}. Make it with "
                "Leaf.through(system, state) or Leaf(system, casimirs)."
            )
        return given
    if (casimirs := named(given, "leaf")) is None:
        raise ParameterError(
            f"leaf must be a Leaf, or values of the Casimirs by name; got {shown(given)}. Write for example "
            "Leaf.through(system, state)."
        )
    return Leaf(system, casimirs)


@explains_its_arguments
def equilibrium_near(
    system: System,
    guess: ArrayLike,
    *,
    along: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
) -> Equilibrium:
    r"""The relative equilibrium that Newton's method reaches from a guess.

    A critical point of H on the leaf of the guess and on the level set of the integrals,
    $f_H = \sum_j\Omega_j f_{K_j}$; without integrals an equilibrium.

    Example:
        >>> top = lp.catalog.system("lagrange")
        >>> found = lp.phase_space.equilibrium_near(top, [0.1, 0, 2, 0.3, 0, 0.9], along=("l3",))  # a steady precession
        >>> found.linear_stability, round(found.omega["l3"], 6)  # it turns about its own axis at this rate
        ('stable spectrum', 3.384308)

    Args:
        system: A system whose parameters are all numbers.
        guess: One state, shape (N,); its leaf is kept.
        along: The integrals, by their names in `system.invariants` or as formulas; `along=("l3",)` for the steady
            precessions of a Lagrange top.
        values: Their values, by name; by default those of the guess.

    Raises:
        ParameterError: there is none near the guess, the guess is too near zero, an integral is not constant or has no
            motion of its own, or `values` does not name them.
        LeafError: the equations of the leaf are not known.
        ShapeError: `guess` is not one state.
    """
    leaf = not_tiny(Leaf.through(system, guess), "guess")
    integrals = integrals_of(system, along)
    return with_all_energy(leaf, _near(leaf.moving, integrals, values))


def _near(leaf: Leaf, integrals: Mapping[str, PhaseFunction], values: Mapping[str, float] | None) -> Equilibrium:
    """The equilibrium near the state of a leaf."""
    view = leaf.in_units()
    functions = view.system.functions
    fields = HamiltonianFields(view.system, [functions.energy, *map(functions.of, integrals.values())])
    level = _level(integrals, values, leaf.state)
    equations = CriticalEquations(view, fields, level)
    states, residual = critical_points(equations, view.state[None])
    if not len(states) or not is_critical(equations, states, residual)[0]:
        reached = (
            f"a relative residual of {residual[0]:.1e}" if len(states) else "no state where H has finite derivatives"
        )
        checkpoint("Newton's method for an equilibrium")
        raise ParameterError(
            f"guess must be near a critical point of H on its leaf{_named(integrals)}; Newton's method ends with "
            f"{reached}. Search with equilibria(system, leaf, along=..., values=...)."
        )
    state = finished(equations, states[0])
    one, how = judged(leaf, integrals, equations, state)
    if not how.is_known and (rest := at_rest(equations, state)) is not None:
        resting, its = judged(leaf, integrals, equations, rest)
        one = resting if its.is_alone and norm(rest - state) <= its.alone_within else one
    return one


def _level(integrals: Mapping[str, PhaseFunction], values: Mapping[str, float] | None, x: Array | None) -> Array:
    """The values of the integrals that are asked for, or those at x."""
    if values is None and x is not None:
        return np.array([float(f(x)) for f in integrals.values()])
    asked: Any = {} if values is None else values
    given = named(asked, "values")
    if given is None or set(given) != set(integrals):
        given = None
    numbers = {name: as_number(given[name], f"values[{name!r}]", "a finite number") for name in integrals if given}
    if given is None or not np.isfinite([*numbers.values()]).all():
        example = f"Write for example values={dict.fromkeys(integrals, 0.5)}." if integrals else "Leave values out."
        raise ParameterError(
            f"values must give a finite number for each integral of along, {', '.join(integrals) or 'none'}; "
            f"got {shown(asked)}. {example}"
        )
    return np.array([*numbers.values()])


def _named(integrals: Mapping[str, PhaseFunction]) -> str:
    return f" at fixed {', '.join(integrals)}" if integrals else ""


LIMITS = Limits(work=3_000_000, degree=150)
"""What the proof may cost: about three seconds. Kirchhoff's equations have degree 30 in general and take one half."""

_MOST_COORDINATES, _MOST_TERMS = 12, 1000
_BITS = 100


@dataclass(frozen=True)
class AllEquilibria:
    """The equilibria of a leaf, all of them.

    Attributes:
        states: The states, rounded to doubles, shape (n, N).
        degree: How many complex solutions the equations have, with multiplicities.
    """

    states: Array
    degree: int


def polynomial_equilibria(leaf: Leaf, limits: Limits = LIMITS) -> AllEquilibria | None:
    """All equilibria on a leaf; None where this is not decided.

    That is so on singular leaves, for equations or Casimirs that are no polynomials with rational coefficients, where
    equilibria come in families, and where the limits are reached.

    Args:
        leaf: The leaf; on a level set of several leaves, such as the sheets of a hyperboloid, all of them are meant.
        limits: What it may cost.
    """
    if not leaf.is_regular or not leaf.place.is_known or len(leaf.state) > _MOST_COORDINATES:
        return None
    try:
        system = _equations(leaf, limits)
        if system is None or system.dimension > 0:
            return None
        points = [s.values for s in system.real_solutions(_BITS)]
    except (NotDecidedError, ParameterError):
        return None
    on_leaf = [_is_on_leaf(leaf, point) for point in points]
    if None in on_leaf:
        return None
    states = [[float(x.mid()) for x in point] for point, is_on in zip(points, on_leaf, strict=True) if is_on]
    return AllEquilibria(np.array(states).reshape(-1, len(leaf.state)), max(system.degree, 0))


def _equations(leaf: Leaf, limits: Limits) -> PolynomialSystem | None:
    """J grad H = 0 and C = c; None if they are too long to be read, or J is no polynomial.

    Raises:
        ParameterError: they are no polynomials with rational coefficients.
    """
    from sympy import Rational

    from liepoisson.formula.arithmetic import expanded_terms

    system = leaf.system
    rates = [rate for rate in system.equations.values() if rate != 0]
    casimirs = {name: function.expression for name, function in leaf.casimir_functions.items()}
    entries: list[Any] = [] if system.bracket.is_linear else [to_sympy(c) for *_, c in system.bracket.terms()]
    if any(expanded_terms(e) > _MOST_TERMS for e in (*rates, *casimirs.values())):
        return None
    if not all(entry.is_polynomial(*system.variables) for entry in entries):
        return None
    levels: list[Any] = [
        casimir - Rational(*leaf.casimirs[name].as_integer_ratio()) for name, casimir in casimirs.items()
    ]
    return PolynomialSystem.of([*rates, *levels], system.variables, limits=limits)


def _is_on_leaf(leaf: Leaf, point: tuple[arb, ...]) -> bool | None:
    """Whether J has the rank of the leaf at a point, if it has; else None.

    Its rank is at most that of the leaf, which is regular, and it has it if a principal minor of this size is not 0.
    """
    state = np.array([float(x.mid()) for x in point])
    chosen = _principal(np.asarray(leaf.system.functions.poisson_tensor(state)), leaf.rank)
    if chosen is None:
        return None
    tensor: Any = leaf.system.bracket.poisson_tensor()
    context = rational_context([str(v) for v in leaf.system.variables])
    with precision(4 * _BITS):
        minor = [[_value(polynomial(tensor[i, j], context), point) for j in chosen] for i in chosen]
        return None if arb_mat(minor).det().contains(0) else True


def _principal(matrix: Array, rank: int) -> list[int] | None:
    """Rows and columns of a principal part that is far from singular, two by two; None if there is none."""
    left, chosen = matrix.copy(), list[int]()
    for _ in range(rank // 2):
        i, j = (int(k) for k in np.unravel_index(int(np.argmax(np.abs(left))), left.shape))
        if not left[i, j]:
            return None
        chosen += [i, j]
        # what is left of an antisymmetric matrix when a 2 x 2 block is eliminated
        left = left + (np.outer(left[:, i], left[j]) - np.outer(left[:, j], left[i])) / left[i, j]
        left[[i, j]] = 0.0
        left[:, [i, j]] = 0.0
    return sorted(chosen)


def _value(p: Any, point: tuple[arb, ...]) -> arb:
    """A polynomial at balls."""
    total = arb(0)
    for powers, c in p.terms():
        term = ball(c)
        for x, k in zip(point, powers, strict=True):
            for _ in range(int(k)):
                term = term * x
        total += term
    return total
