r"""The stability of one state: the linearised flow and the energy-Casimir test, and what they say.

At a critical point of H on its leaf, $\nabla H = \sum_k\lambda_k\nabla C_k$, perhaps with integrals,
$\nabla H = \sum_k\lambda_k\nabla C_k + \sum_j\Omega_j\nabla K_j$.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.equilibrium.critical_points import VANISHES, CriticalEquations, HamiltonianFields, multipliers
from liepoisson.equilibrium.linearisation import (
    ComplexArray,
    LinearFlow,
    definite_combination,
    exact_linearisation,
    spectral_verdict,
)
from liepoisson.equilibrium.second_variation import Accuracy, CriticalPoint, Symmetries, accuracy, on_slice
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.arrays import Array, ReadOnlyArrays, norm
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed_names
from liepoisson.inputs.refusals import shown
from liepoisson.leaf.leaf import Leaf
from liepoisson.leaf.leaf_in_units import unit_length
from liepoisson.portable import linear
from liepoisson.streams import generator

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits
    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System


@dataclass(frozen=True, eq=False)
class Equilibrium(ReadOnlyArrays):
    r"""An equilibrium of a leaf, or a relative equilibrium with respect to integrals, and its stability.

    Example:
        >>> top = lp.catalog.system("lagrange")
        >>> hanging = lp.phase_space.equilibrium(top, [0, 0, 0, 0, 0, -1])
        >>> hanging.linear_stability, hanging.nonlinear_stability, hanging.frequencies.round(9)
        ('stable spectrum', 'stable', array([1., 1.]))

    Attributes:
        leaf: The leaf that it lies on.
        state: The state, shape (N,).
        energy: The value of H.
        omega: The multipliers $\Omega_j$ of the integrals, by name; empty for an equilibrium. An integral whose vector
            field vanishes here, or depends on those of the integrals before it, has 0.
        multipliers: The multipliers $\lambda_k$ of the Casimirs, by name; empty on singular leaves, where other
            equations than the Casimirs hold too.
        residual: $|f_H - \sum_j\Omega_j f_{K_j}|$ relative to the derivative of $f_H$ times $|x|$, in units in which
            the fields are of order one.
        asymmetry: Relative antisymmetric part of the second variation as computed; round-off if the linearised flow
            is Hamiltonian, so that its eigenvalues form quadruples $\pm\sigma, \pm\bar\sigma$.
        spectrum: Eigenvalues of the linearised flow of $H - \sum_j\Omega_j K_j$ on the symplectic slice, in inverse
            time, real parts below the round-off set to 0. The slice is the tangent space of the leaf; with integrals,
            that of their level set modulo their flows.
        growth_rate: The largest real part in the spectrum; 0 unless it exceeds the round-off.
        nullity: Dimension of the kernel of the linearised flow: at least the dimension of a family of equilibria.
        linear_stability: "stable spectrum" (all eigenvalues imaginary and not zero), "unstable", "degenerate" (stable
            but for zero eigenvalues) or "undecided" (imaginary eigenvalues collide, within round-off, or the family is
            "undecided").
        signature: Numbers $(n_+, n_-, n_0)$ of positive, negative and vanishing eigenvalues of the second variation of
            `combination` on the slice; $n_0$ is the number of all where the family is "undecided".
        combination: Coefficients of H and the integrals, by name. Where the vector fields of the integrals vanish or
            depend on each other there is a choice; a definite combination is taken if one is found.
        n_found: From how many starts a search came here, or to the same family; 1 if it was no search.
        family: What connected set of equilibria of its leaf it belongs to, as far as `equilibria` knows: "point" (it is
            isolated), "circle", "sphere", "all rotations" (like the group SO(3)), "family of dimension ...", or
            "degenerate": the linear equations are, and the algebra gives no family. "point" from `equilibrium` and
            `equilibrium_near`, which look at one state only. "undecided": the equations hold there to 1e-8, and
            doubles do not tell whether that is at one equilibrium, several, a family or none; `spectrum` and `nullity`
            are then those of the state.
        distance: How far the state is from the true (relative) equilibrium at most, relative to the length of the
            state; where the family is "undecided", the distance within which the linear equations may become singular,
            so that it is no bound. 0 where the state is known without Newton's method.
    """

    leaf: Leaf
    state: Array
    energy: float
    omega: dict[str, float]
    multipliers: dict[str, float]
    residual: float
    asymmetry: float
    spectrum: ComplexArray
    growth_rate: float
    nullity: int
    linear_stability: str
    signature: tuple[int, int, int]
    combination: dict[str, float]
    n_found: int = 1
    family: str = "point"
    distance: float = 0.0

    @property
    def system(self) -> System:
        """The system."""
        return self.leaf.system

    @property
    def casimirs(self) -> dict[str, float]:
        """The values of the Casimirs."""
        return self.leaf.casimirs

    @property
    def nonlinear_stability(self) -> str:
        r"""The energy-Casimir verdict: "stable", "no conclusion" or "undecided".

        - "stable": the second variation is definite. The (relative) equilibrium is stable for the nonlinear motion on
          its leaf, and on the leaves nearby if the leaf is regular; proved up to the accuracy of the numbers. With
          integrals, stable modulo their flows.
        - "no conclusion": it is indefinite. The state may be stable or not. A known integral in `along` may decide, as
          l3 does for an upright top that spins fast.
        - "undecided": it is semidefinite, up to round-off, or the family is "undecided".

        References: [arnold1965]; [holm1985]; with integrals: [simo1991].
        """
        if self.family == "undecided":
            return "undecided"
        positive, negative, zero = self.signature
        if positive and negative:
            return "no conclusion"
        return "undecided" if zero else "stable"

    @cached_property
    def frequencies(self) -> Array:
        """The positive imaginary parts in the spectrum, ascending, in inverse time."""
        return np.sort(self.spectrum.imag[self.spectrum.imag > 0])

    def __repr__(self) -> str:
        if self.family == "undecided":
            return (
                f"<Equilibrium of {self.system.name!r}: energy {self.energy:.6g}, undecided: the equations hold to "
                f"1e-8, but a zero is only sought within {self.distance:.2g} of the state's length, where the "
                "linear equations may become singular>"
            )
        grows = f" (grows at {self.growth_rate:.4g})" if self.linear_stability == "unstable" else ""
        return (
            f"<Equilibrium of {self.system.name!r}: energy {self.energy:.6g}, {self.linear_stability}{grows}, "
            f"signature {self.signature}: {self.nonlinear_stability}>"
        )


@explains_its_arguments
def equilibrium(system: System, state: ArrayLike, *, along: Sequence[str] = (), tol: float = 1e-8) -> Equilibrium:
    r"""Linear and energy-Casimir stability of an equilibrium, or of a relative equilibrium with respect to integrals.

    The linear one is the spectrum of the flow linearised on the leaf. The energy-Casimir one is the sign of the second
    variation of $H - \sum_k\lambda_k C_k - \sum_j\Omega_j K_j$ on the tangent space of the common level set, modulo the
    flows of the $K_j$: definite proves stability, up to the accuracy of the numbers. Where an integral is critical at
    x, such as $\ell_3$ at the sleeping top, its $\Omega$ is free, and a definite combination is looked for.

    Where the vector field vanishes exactly, H is a rational function with rational coefficients, and there are no more
    than 12 components, spectrum and signature are computed in exact numbers, whatever the sizes of the coefficients.
    Elsewhere an eigenvalue of the second variation counts as zero below 1e-9 of the largest. Zeros that are not those
    of symmetries, by known integrals of the system, and equations that may become singular within the bound on the
    distance of the state from the equilibrium, are "undecided".

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> [lp.phase_space.equilibrium(body, axis).linear_stability for axis in np.eye(3)]
        ['stable spectrum', 'unstable', 'stable spectrum']
        >>> round(lp.phase_space.equilibrium(body, [0, 1, 0]).growth_rate, 9)  # the root of 1/12
        0.288675135

    Args:
        system: A system whose parameters are all numbers.
        state: The state, shape (N,).
        along: Integrals, by their names in `system.invariants` or as formulas.
        tol: How large $|\dot x - \sum_j\Omega_j f_{K_j}|$ may be, relative to the size of the terms in it.

    Raises:
        ParameterError: `state` is not a (relative) equilibrium or too near zero, an integral is not constant or has no
            motion of its own, or `tol` is no finite number.
        ShapeError: `state` is not one state.

    References: [arnold1965]; [holm1985]; [simo1991].
    """
    leaf = not_tiny(Leaf.through(system, state), "state")
    integrals = integrals_of(system, along)
    tol = as_number(tol, "tol", "a finite number >= 0")
    if not 0 <= tol < np.inf:
        raise ParameterError(f"tol: wanted a finite number >= 0; got {tol}; try tol=1e-8")
    return with_all_energy(leaf, _at_state(leaf.moving, integrals, tol))


def _at_state(leaf: Leaf, integrals: Mapping[str, PhaseFunction], tol: float) -> Equilibrium:
    """The stability of the state of a leaf."""
    units = _units_of_top(leaf)
    view = _in_units(leaf, units)
    fields, y = _fields(view, integrals), leaf.state / view.units
    omega = multipliers(fields.fields(y)[None], fields.scale(y)[None])[0]
    if not _residual(fields, y, omega) <= tol:
        rates = fields.fields(y) * view.units[:, None]
        left = float(norm(rates[:, 0] - linear.matmul(rates[:, 1:], omega)))
        raise ParameterError(_not_an_equilibrium(left, float(norm(rates[:, 0])), integrals))
    equations = CriticalEquations(view, fields, np.array([float(f(y)) for f in fields.functions[1:]]))
    return judged(leaf, integrals, equations, y, units)[0]


def judged(
    leaf: Leaf,
    integrals: Mapping[str, PhaseFunction],
    equations: CriticalEquations,
    y: Array,
    units: Array | None = None,
) -> tuple[Equilibrium, Accuracy]:
    """The stability of a critical point that Newton's method gave, "undecided" where it is not known well enough.

    Args:
        leaf: Its leaf.
        integrals: Integrals for a relative equilibrium.
        equations: Its equations, in the units of `y`.
        y: The state, shape (N,), in these units.
        units: Sizes of the coordinates for `analysis`.
    """
    nullity = on_slice(equations.fields, equations.leaf, y)[1].kernel().shape[1]
    n_symmetries = 0
    if nullity or integrals:
        n_symmetries = Symmetries.of(equations.leaf, equations.fields).combinations(y).shape[1]
    how = accuracy(equations, y, n_symmetries)
    is_known = how.is_known and nullity == (0 if integrals else n_symmetries)
    one, is_exact = _analysis(leaf, y * equations.leaf.units, integrals, units, is_known=is_known)
    if is_exact:
        return one, how
    length = float(norm(y)) + equations.fields.unit
    one = replace(one, distance=how.distance / length if length else 0.0)
    if is_known:
        if how.n_regular < len(integrals) and one.nonlinear_stability == "stable" and one.combination["H"]:
            # where a combination of H and integrals that are at rest is definite there is no other on the level set
            h, *others = one.combination.values()
            alone = accuracy(equations, y, n_symmetries, -np.array(others) / h)
            how = replace(how, alone_within=alone.alone_within, is_alone=True) if alone.is_known else how
        return one, how
    nothing = (0, 0, sum(one.signature))
    undecided = replace(one, family="undecided", linear_stability="undecided", growth_rate=0.0, signature=nothing)
    return undecided, replace(how, alone_within=0.0)


def _units_of_top(leaf: Leaf) -> Array | None:
    """Natural sizes of the components of a state of a top, whose fields have units of their own; None for others."""
    from liepoisson.equilibrium.heavy_equilibria import exact_top
    from liepoisson.equilibrium.top_equilibria import natural_units

    top = exact_top(leaf.system)
    return None if top is None or not leaf.rank else natural_units(leaf, top, [])


def _in_units(leaf: Leaf, units: Array | None) -> LeafInUnits:
    """The leaf in these units, or in its own."""
    view = leaf.in_units()
    return view if units is None else replace(view, units=units)


def _fields(view: LeafInUnits, integrals: Mapping[str, PhaseFunction]) -> HamiltonianFields:
    """The vector fields of H and the integrals in units."""
    functions = view.system.functions
    return HamiltonianFields(view.system, [functions.energy, *map(functions.of, integrals.values())])


def _residual(fields: HamiltonianFields, y: Array, omega: Array) -> float:
    """What the motions of the integrals leave of that of H, relative to the size of the terms in it."""
    rates = fields.fields(y)
    scale = sum(float(norm(part[..., 0])) for part in fields.parts(y)) * float(norm(y))
    left = float(norm(rates[:, 0] - linear.matmul(rates[:, 1:], omega)))
    return left / scale if scale else left


def not_tiny(leaf: Leaf, name: str) -> Leaf:
    """The leaf, unless J at its state, linear without a constant part, has no inverse in doubles."""
    size = float(np.abs(leaf.state).max(initial=0.0))
    if leaf.rank and size < _TINY and not unit_length(leaf.system.bracket):
        raise ParameterError(
            f"{name} must be zero, or have a component of at least {_TINY:g}, so that its Poisson tensor has an "
            f"inverse in doubles; the largest is {size:.3g}. Choose units in which it is larger."
        )
    return leaf


_TINY = 1e-100
"""Nearer to zero the second variation, of the order of 1/|x|, and its squares leave the doubles."""


def _not_an_equilibrium(left: float, rate: float, integrals: Iterable[str]) -> str:
    named = ", ".join(integrals)
    if named:
        return (
            f"state must be a relative equilibrium with respect to {named}; |x'| = {rate:.3g}, of which {left:.3g} is "
            "not a motion of these integrals. equilibrium_near(system, x, along=...) looks for one nearby."
        )
    return (
        f"state must be an equilibrium; |x'| = {rate:.3g} there. equilibrium_near(system, x, along=()) looks for one "
        "nearby, equilibria(system, Leaf.through(system, state)) for those of its leaf; name integrals in along= for a "
        "steady motion."
    )


def integrals_of(system: System, along: Sequence[str]) -> dict[str, PhaseFunction]:
    """Integrals by name.

    Raises:
        ParameterError: not a sequence of texts; or one of them is not constant along the motion, is a Casimir, or has
            the motion of the Hamiltonian itself.
        ExpressionError: a formula is not in the grammar.
    """
    if isinstance(along, str):
        raise ParameterError(f"along must be a sequence of integrals; got the text {along!r}. Write ({along!r},).")
    given = listed_names(along, "along")
    if given is None or not all(isinstance(name, str) for name in given):
        example = "".join(f"along={(name,)!r} or " for name in _with_own_motion(system)[:1])
        raise ParameterError(
            f"along must be a sequence of integrals, each a name or a formula; got {shown(along)}. Write {example}"
            "along=() for an equilibrium."
        )
    found: dict[str, PhaseFunction] = {}
    for name in given:
        known = system.invariants.get(name)
        if known is None and not system.is_constant(name):
            raise ParameterError(
                f"along must name integrals of {system.name!r}; {name} is not constant: its derivative is "
                f"{system.derivative(name)}. Known: {', '.join(_with_own_motion(system)) or 'none'}."
            )
        found[name] = system.functions.of(name if known is None else known)
        _refuse_idle(system, name, found[name])
    return found


def _with_own_motion(system: System) -> list[str]:
    return [name for name in system.invariants if has_own_motion(system, name)]


def integrals_that_decide(found: Equilibrium) -> tuple[str, ...]:
    """The first known integral that, added to H, proves an equilibrium stable of which H alone says nothing."""
    if found.omega or found.linear_stability != "stable spectrum" or found.nonlinear_stability != "no conclusion":
        return ()
    for name in _with_own_motion(found.system):
        if equilibrium(found.system, found.state, along=(name,)).nonlinear_stability == "stable":
            return (name,)
    return ()


def _refuse_idle(system: System, name: str, integral: PhaseFunction) -> None:
    """Refuse a Casimir, and a multiple of H plus a Casimir: no relative equilibria belong to them."""
    ratio = _share_of_motion(system, integral)
    if ratio is None:
        return
    if ratio == 0:
        raise ParameterError(
            f"along must name integrals with a motion of their own; {name} is a Casimir: it has the same value on the "
            "whole leaf. Leave it out, or choose another leaf."
        )
    raise ParameterError(
        f"along must name integrals with a motion of their own; that of {name} is the motion itself"
        f"{'' if np.isclose(ratio, 1) else f', {ratio:.4g} times as fast'}: every state would be a relative "
        "equilibrium. Leave it out."
    )


def has_own_motion(system: System, name: str) -> bool:
    """Whether the motion of an invariant is neither none nor a multiple of the system's own."""
    return _share_of_motion(system, system.functions.of(system.invariants[name])) is None


def _share_of_motion(system: System, integral: PhaseFunction) -> float | None:
    """The number c in $f_K = c f_H$, 0 for a Casimir; None where there is none. Decided at random states."""
    x = generator(0).normal(size=(_TRIED, system.bracket.dimension))
    with np.errstate(all="ignore"):  # a formula may be undefined at some of them; it is not judged there
        energy = system.moving.functions.energy
        fields = HamiltonianFields(system, [energy, integral])
        both = fields.fields(x)
        size = float(norm(fields.poisson(x)) * norm(integral.gradient(x)))
    motion, own = both[..., 0].ravel(), both[..., 1].ravel()
    if norm(own) <= VANISHES * size:
        return 0.0
    ratio = float(linear.matmul(motion, own) / linear.matmul(motion, motion)) if motion.any() else 0.0
    return ratio if norm(own - ratio * motion) <= VANISHES * size else None


_TRIED = 4
"""Random states at which two vector fields are compared."""


def analysis(leaf: Leaf, x: Array, integrals: Mapping[str, PhaseFunction], units: Array | None = None) -> Equilibrium:
    """The linear and the energy-Casimir stability of a critical point that is known for sure.

    Args:
        leaf: Its leaf.
        x: The state, shape (N,).
        integrals: Integrals for a relative equilibrium.
        units: Sizes of the coordinates, shape (N,), by default those of the leaf; an eigenvalue of the second variation
            counts as zero by its size in these units.
    """
    return _analysis(leaf, x, integrals, units, is_known=True)[0]


def _analysis(
    leaf: Leaf, x: Array, integrals: Mapping[str, PhaseFunction], units: Array | None, *, is_known: bool
) -> tuple[Equilibrium, bool]:
    """The same, and whether it was done in exact numbers; where it is not known for sure, zeros are not divided out."""
    view = _in_units(leaf, units)
    fields, y = _fields(view, integrals), x / view.units
    point, flow, basis, asymmetry = on_slice(fields, view, y)
    omega = point.omega
    reduced = flow.without_zeros() if is_known else flow
    if flow.has_more_than(reduced):
        reduced = flow
    eigenvalues, bounds = reduced.eigenvalues()
    n_zero = flow.size - reduced.size
    verdict = spectral_verdict(eigenvalues, bounds, n_zero)
    growth = float(eigenvalues.real.max(initial=0.0))
    if reduced.has_odd_index() and growth > 0:
        # a real pair, though beside fast frequencies it is below the bound on their round-off
        verdict = "unstable"
        bounds = np.where(np.abs(eigenvalues.real) >= growth, 0.0, bounds)
    eigenvalues.real[np.abs(eigenvalues.real) <= bounds] = 0.0
    combination, best = _best_combination(point, flow, basis)
    found = Equilibrium(
        leaf=leaf,
        state=x,
        energy=float(leaf.system.functions.energy(x)),
        omega=dict(zip(integrals, (omega + 0.0).tolist(), strict=True)),
        multipliers=_casimir_multipliers(leaf, point),
        residual=_residual(fields, y, omega),
        asymmetry=asymmetry,
        spectrum=_ordered(np.append(eigenvalues, np.zeros(n_zero, dtype=np.complex128))),
        growth_rate=growth if verdict == "unstable" else 0.0,
        nullity=flow.kernel().shape[1],
        linear_stability=verdict,
        signature=best.signature(),
        combination=dict(zip(("H", *integrals), (combination + 0.0).tolist(), strict=True)),
    )
    exact = None if integrals else exact_linearisation(leaf.system, x)
    if exact is None:
        return found, False
    found = replace(
        found,
        spectrum=_ordered(exact.spectrum),
        growth_rate=exact.growth_rate,
        nullity=exact.nullity,
        linear_stability=exact.verdict,
        signature=exact.signature,
    )
    return found, True


def _best_combination(point: CriticalPoint, flow: LinearFlow, basis: Array) -> tuple[Array, LinearFlow]:
    """Coefficients of H and the integrals with a definite second variation on the slice, if they can be found.

    There is a choice where combinations of the integrals are critical themselves, as l3 at the sleeping top.
    """
    own = np.array([1.0, *-point.omega])
    others = [np.array([0.0, *row]) for row in point.free()]
    flows = [point.linear_flow(row)[0].restricted(basis) for row in others]
    # on a slice of dimension 0 nothing is left to be definite
    found = definite_combination([flow.hessian, *(o.hessian for o in flows)]) if others and flow.size else None
    if found is None:
        return own, flow
    total = linear.tensordot(found, np.array([own, *others]), axes=1)
    scale = abs(total[0]) if abs(total[0]) > 1e-6 * np.abs(total).max() else np.abs(total).max()
    hessian = linear.tensordot(found, np.array([flow.hessian, *(other.hessian for other in flows)]), axes=1)
    return total / scale, flow.with_hessian(hessian / scale)


def _casimir_multipliers(leaf: Leaf, point: CriticalPoint) -> dict[str, float]:
    if not leaf.is_regular or not leaf.casimir_functions:
        return {}
    functions = point.leaf.system.functions
    slopes = linear.matmul(
        np.stack([f.gradient(point.x) for f in point.fields.functions], axis=-1), np.array([1.0, *-point.omega])
    )
    gradients = np.stack([functions.of(f).gradient(point.x) for f in leaf.casimir_functions.values()], axis=-1)
    return dict(zip(leaf.casimir_functions, _coefficients(gradients, slopes).tolist(), strict=True))


def _coefficients(gradients: Array, slopes: Array) -> Array:
    """The numbers before the gradients of Casimirs that make up some slopes."""
    lengths = norm(gradients, axis=0)  # a Casimir is in units of its own
    lengths = np.where(lengths > 0, lengths, 1.0)
    return np.asarray(linear.lstsq(gradients / lengths, slopes)[0] / lengths)


def with_all_energy(leaf: Leaf, found: Equilibrium) -> Equilibrium:
    """An equilibrium of the moving part of H on a leaf, with the energy and the multipliers of H itself."""
    if leaf.moving is leaf:
        return found
    functions, x = leaf.system.functions, found.state
    if multipliers := dict(found.multipliers):
        slope = functions.energy.gradient(x) - leaf.moving.system.functions.energy.gradient(x)
        gradients = np.stack([functions.casimirs[name].gradient(x) for name in multipliers], axis=-1)
        more = _coefficients(gradients, slope).tolist()
        multipliers = {name: value + m for (name, value), m in zip(multipliers.items(), more, strict=True)}
    return replace(found, leaf=leaf, energy=float(functions.energy(x)), multipliers=multipliers)


def _ordered(values: ComplexArray) -> ComplexArray:
    """By decreasing real part, then imaginary part; real parts that differ by round-off count as equal."""
    unit = 1e-9 * float(np.abs(values).max(initial=0.0)) or 1.0
    return (values + 0j)[np.lexsort((values.imag, -np.round(values.real / unit)))]
