r"""Discrete symmetries and reversers of a system: signed permutations of its components, decided from its equations.

The map $(Sx)_i = s_i x_{\pi(i)}$, $s_i = \pm1$, takes orbits to orbits if

$$ f(Sx) = \sigma\,S f(x), \qquad \dot x = f(x) . $$

For $\sigma = 1$ it is a symmetry; for $\sigma = -1$ it reverses time, and an involution among these is a **reverser**:
its fixed points are where orbits meet their own mirror images.  Whether S keeps the bracket, $\{f\circ S, g\circ S\} =
\pm\{f, g\}\circ S$, and whether it keeps H, are questions of their own: a map that reverses time may be neither Poisson
nor anti-Poisson, and a Poisson map with $H\circ S = -H$ reverses time, too.

The twisted top with $a = (a_1, 0, 0)$, $b = 0$ has $R_1$, which changes the sign of components 2 and 3 of each vector,
$\rho_2$ and $\rho_3$, which change that of components 2, or 3, and reverse time ($\rho_2\rho_3 = R_1$), and the
reversal $\ell, \beta \mapsto -\ell, -\beta$, which takes $C_2$ to $-C_2$.

References: [devaney1976]; [lamb1998].
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.given import by_name
from liepoisson.io.display import Found
from liepoisson.model.signed_permutations import (
    MOST_TRIED,
    SignedPermutation,
    of_polynomial_field,
    sign_changes_that_may_be,
)

if TYPE_CHECKING:
    from liepoisson.model.system import System

_KIND = {1: "Poisson", -1: "anti-Poisson", 0: "neither"}
_WIDEST = 99
"""Letters of a map in a table."""

_NOUNS = {True: ("signed permutation", "signed permutations"), False: ("change of signs", "changes of signs")}


@explains_its_methods
@dataclass(frozen=True)
class DiscreteSymmetry:
    r"""A signed permutation of the components, $(Sx)_i = s_i x_{\pi(i)}$, that takes orbits to orbits.

    Example:
        >>> for symmetry in lp.systems.discrete_symmetries(lp.catalog.system("henon-heiles")):
        ...     print(f"{symmetry.text} ({symmetry.bracket})")
        x, p_x -> -x, -p_x (Poisson)
        x, p_y -> -x, -p_y; t -> -t (anti-Poisson)
        p_x, p_y -> -p_x, -p_y; t -> -t (anti-Poisson)

    Attributes:
        system: The system.
        permutation: $\pi(i)$, counted from 0, shape (N,).
        signs: $s_i$, 1 or -1.
        reverses_time: Whether orbits are run through backwards, $f(Sx) = -Sf(x)$.
        bracket: "Poisson", "anti-Poisson" or "neither".
        invariants: The factor of H and of each Casimir, by name: 1 if $C\circ S = C$, -1 if $C\circ S = -C$, 0 if it
            becomes another function.  That of H is 1, too, if only a function of the Casimirs in H changes.
    """

    system: System
    permutation: tuple[int, ...]
    signs: tuple[int, ...]
    reverses_time: bool
    bracket: str
    invariants: Mapping[str, int] = field(hash=False)

    def __call__(self, states: ArrayLike) -> Array:
        """The images of states, shape (..., N).

        Raises:
            ShapeError: the last axis of `states` is not N.
        """
        x = as_array(states, "states", self.system.component_names)
        if x.ndim == 0 or x.shape[-1] != len(self.signs):
            raise ShapeError(f"states must end in {len(self.signs)} components; got shape {x.shape}.")
        return x[..., list(self.permutation)] * np.array(self.signs, dtype=np.float64)

    @property
    def matrix(self) -> Array:
        """The matrix of the map, shape (N, N)."""
        found = np.zeros((len(self.signs), len(self.signs)))
        found[range(len(self.signs)), self.permutation] = self.signs
        return found

    @property
    def order(self) -> int:
        """The smallest power that is the identity; 2 for an involution."""
        one, power, k = _identity(len(self.signs)), self._pair, 1
        while power != one:
            power, k = power.after(self._pair), k + 1
        return k

    @property
    def is_reverser(self) -> bool:
        """Whether this reverses time and is an involution."""
        return self.reverses_time and self.order == 2

    @property
    def keeps_every_level(self) -> bool:
        """Whether H and every Casimir are as before, so that each level is mapped to itself."""
        return all(factor == 1 for factor in self.invariants.values())

    @cached_property
    def fixed_space(self) -> tuple[tuple[int, ...], ...]:
        """A basis of the states with S x = x, integer vectors of N components with disjoint supports."""
        found: list[tuple[int, ...]] = []
        seen: set[int] = set()
        for first in range(len(self.signs)):
            cycle = {first: 1}
            i, value = first, 1
            while first not in seen:
                # (S x)_i = s_i x_{pi(i)} = x_i
                value, i = value * self.signs[i], self.permutation[i]
                if i == first:
                    if value == 1:
                        found.append(tuple(cycle.get(k, 0) for k in range(len(self.signs))))
                    break
                cycle[i] = value
            seen |= set(cycle)
        return tuple(found)

    @cached_property
    def fixed_dimension(self) -> int:
        r"""The dimension of the fixed set on a generic level of H and the Casimirs that it meets.

        That is the dimension of `fixed_space` less the number of these functions that are independent on it.  For a
        reverser whose orbits meet it and its likes in isolated orbits it is half of the rank of J, less one.
        """
        from sympy import Matrix, Rational

        if not self.fixed_space:
            return 0
        draw = random.Random(1)
        free = [Rational(draw.randint(-999, 999), draw.randint(1, 99)) for _ in self.fixed_space]
        point = [sum(c * v[i] for c, v in zip(free, self.fixed_space, strict=True)) for i in range(len(self.signs))]
        at = dict(zip(self.system.variables, point, strict=True))
        rows = [
            [
                sum(function.diff(x).subs(at) * v[i] for i, x in enumerate(self.system.variables) if v[i])
                for v in self.fixed_space
            ]
            for function in _levels(self.system).values()
        ]
        return len(self.fixed_space) - int(Matrix(rows).rank())

    def meets(self, values: Mapping[str, object]) -> bool:
        """Whether it maps a level to itself: what changes its sign must vanish there.

        Args:
            values: The values of H and the Casimirs, by name; names that are left out are not compared.
        """
        given = by_name(values, "values", "values", '{"H": 1, "C2": 0}')
        return all(
            factor == 1 or (factor == -1 and is_zero(_exact(given[name])))
            for name, factor in self.invariants.items()
            if name in given
        )

    @property
    def text(self) -> str:
        """What it does, for example "l2, alpha2, beta2 -> -l2, -alpha2, -beta2; t -> -t"."""
        names = self.system.component_names
        moved = [k for k, (p, s) in enumerate(zip(self.permutation, self.signs, strict=True)) if (p, s) != (k, 1)]
        left = ", ".join(names[k] for k in moved)
        right = ", ".join(("" if self.signs[k] == 1 else "-") + names[self.permutation[k]] for k in moved)
        map_ = f"{left} -> {right}" if moved else "every component stays"
        return f"{map_}; t -> -t" if self.reverses_time else map_

    @property
    def _pair(self) -> SignedPermutation:
        return SignedPermutation(self.permutation, self.signs)

    def __repr__(self) -> str:
        return f"<DiscreteSymmetry of {self.system.name!r}: {self.text}>"


@dataclass(frozen=True, repr=False)
class DiscreteSymmetries(Found[DiscreteSymmetry]):
    """The discrete symmetries of a system, those that keep the direction of time first; the identity is left out.

    Example:
        >>> found = lp.systems.discrete_symmetries(lp.catalog.system("henon-heiles"))
        >>> [symmetry.text for symmetry in found.reversers]
        ['x, p_y -> -x, -p_y; t -> -t', 'p_x, p_y -> -p_x, -p_y; t -> -t']

    Attributes:
        system: The system.
        found: The symmetries.
        with_permutations: Whether all signed permutations were searched, or changes of signs only.
    """

    titles = ("time", "bracket", "changes", "fixed set on a level", "map")
    most_rows = 40

    system: System
    found: tuple[DiscreteSymmetry, ...]
    with_permutations: bool

    @property
    def reversers(self) -> tuple[DiscreteSymmetry, ...]:
        """The involutions that reverse time."""
        return tuple(one for one in self.found if one.is_reverser)

    def _head(self) -> str:
        n = len(self.found)
        one, many = _NOUNS[self.with_permutations]
        return (
            f"{n or 'No'} {one if n == 1 else many} of the components of {self.system.name!r} "
            f"{'takes' if n == 1 else 'take'} orbits to orbits, besides the identity."
        )

    def _row(self, one: DiscreteSymmetry, /) -> tuple[str, ...]:
        changed = [f"{n} -> {'-' + n if f else 'another'}" for n, f in one.invariants.items() if f != 1]
        time, levels = "reversed" if one.reverses_time else "kept", ", ".join(changed) or "no level"
        fixed = f"dimension {one.fixed_dimension}" if one.fixed_space else "the origin"
        text = one.text if len(one.text) <= _WIDEST else one.text[: _WIDEST - 3] + "..."
        return time, one.bracket, levels, fixed, text


@explains_its_arguments
def discrete_symmetries(system: System, *, permutations: bool = True, most: int = 1000) -> DiscreteSymmetries:
    r"""All signed permutations of the components that take orbits to orbits, with time kept or reversed.

    For polynomial equations the search is complete: a permutation must carry the terms of the equations to one another
    up to their signs (found by backtracking among components that play the same part in the equations), and the signs
    then solve linear equations modulo 2.  For other equations all changes of signs are tried at random states and
    those that remain are decided by SymPy; permutations are not searched.  Nothing is assumed about the bracket.

    Example:
        >>> found = lp.systems.discrete_symmetries(lp.Top.twisted(inertia=(3, 2, 1), a=(1, 0, 0)))
        >>> [one.text for one in found if one.keeps_every_level and one.reverses_time]
        ['l2, alpha2, beta2 -> -l2, -alpha2, -beta2; t -> -t', 'l3, alpha3, beta3 -> -l3, -alpha3, -beta3; t -> -t']

    Args:
        system: The system; its parameters may be symbols, which are generic then.
        permutations: Whether components may be exchanged, besides changes of signs.
        most: More symmetries than this are refused.

    Raises:
        ParameterError: there are more than `most`, `system` has components besides those of its bracket, or the
            equations are no polynomials and have too many components.
    """
    most = as_count(most, "most", least=1)
    n = len(system.variables)
    if n != system.bracket.dimension:
        raise ParameterError(
            f"system: wanted one whose state is a point of its phase space; {system.name} has components found by "
            "quadrature; make it without quadratures"
        )
    equations: list[Any] = list(system.equations.values())
    if all(e.is_polynomial(*system.variables) for e in equations):
        pairs = of_polynomial_field(equations, system.variables, permutations=permutations, most=most + 2)
        with_permutations = permutations
    else:
        pairs = _tried(system, equations)
        with_permutations = False
    found = [one for one in pairs if one[0] != _identity(n)]
    if len(found) > most:
        raise ParameterError(
            f"{system.name} has more than {most} signed permutations that take orbits to orbits; ask for a larger "
            "`most`, or for changes of signs only with permutations=False"
        )
    made = [_described(system, pair, reverses) for pair, reverses in found]
    made.sort(key=lambda one: (one.reverses_time, not one.keeps_every_level, _moved(one), one.permutation))
    return DiscreteSymmetries(system, tuple(made), with_permutations)


def _moved(one: DiscreteSymmetry) -> tuple[Any, ...]:
    """Sorts changes of signs before exchanges, few before many."""
    exchanged = sum(p != k for k, p in enumerate(one.permutation))
    negative = tuple(k for k, s in enumerate(one.signs) if s < 0)
    return exchanged, len(negative), negative


def _identity(n: int) -> SignedPermutation:
    return SignedPermutation(tuple(range(n)), (1,) * n)


def _levels(system: System) -> dict[str, Any]:
    """H and the Casimirs, by name."""
    casimirs = {f"C{k}": casimir for k, casimir in enumerate(system.bracket.casimirs(), start=1)}
    return {"H": system.hamiltonian, **casimirs}


def _exact(value: Any) -> Any:
    from liepoisson.formula.parameters import read_parameter

    return read_parameter(value, "value")


def _described(system: System, pair: SignedPermutation, reverses: bool) -> DiscreteSymmetry:
    images = dict(
        zip(
            system.variables,
            (s * system.variables[p] for p, s in zip(pair.permutation, pair.signs, strict=True)),
            strict=True,
        )
    )
    factors = {name: _factor(f, f.subs(images, simultaneous=True)) for name, f in _levels(system).items()}
    if not factors["H"] and system.moving is not system:
        moving: Any = system.moving.hamiltonian
        factors["H"] = max(_factor(moving, moving.subs(images, simultaneous=True)), 0)
    return DiscreteSymmetry(
        system, pair.permutation, pair.signs, reverses, _KIND[_factor_of_bracket(system, pair)], factors
    )


def _factor(function: Any, image: Any) -> int:
    """1 or -1 if the image is that multiple of the function, else 0."""
    if is_zero((image - function).expand()):
        return 1
    return -1 if is_zero((image + function).expand()) else 0


def _factor_of_bracket(system: System, pair: SignedPermutation) -> int:
    """1 or -1 if {x_i, x_j} at S x is that multiple of {(Sx)_i, (Sx)_j}, for all i and j; else 0."""
    before: dict[tuple[int, int, int], Any] = {}
    after: dict[tuple[int, int, int], Any] = {}
    entries = [(i, j, m, c) for i, j, m, c in system.bracket.entries()]
    entries += [(i, j, -1, c) for (i, j), c in system.bracket.constant.items()]
    position = {p: k for k, p in enumerate(pair.permutation)}

    def add(table: dict[tuple[int, int, int], Any], i: int, j: int, m: int, c: Any) -> None:
        key, value = ((i, j, m), c) if i < j else ((j, i, m), -c)
        table[key] = table.get(key, 0) + value

    for i, j, m, c in entries:
        s = pair.signs
        # {x_i, x_j} at S x has the term c s_m x_{pi(m)} ...
        add(before, i, j, pair.permutation[m] if m >= 0 else -1, c * (s[m] if m >= 0 else 1))
        # ... and {(Sx)_k, (Sx)_l} = s_k s_l {x_i, x_j} for i = pi(k), j = pi(l)
        k, l = position[i], position[j]
        add(after, k, l, m, c * s[k] * s[l])
    for factor in (1, -1):
        keys = before.keys() | after.keys()
        if all(is_zero(after.get(key, 0) - factor * before.get(key, 0)) for key in keys):
            return factor
    return 0


def _tried(system: System, equations: Sequence[Any]) -> list[tuple[SignedPermutation, bool]]:
    """Changes of signs of a field that is no polynomial: those that pass at random states, decided by SymPy."""
    n = len(system.variables)
    if n > MOST_TRIED:
        raise ParameterError(
            f"the equations of {system.name} are no polynomials, and changes of signs are then tried one by one, for "
            f"up to {MOST_TRIED} components; got {n}"
        )
    rate: Callable[[Array], Array] = system.vector_field
    found: list[tuple[SignedPermutation, bool]] = []
    for signs, factor in sign_changes_that_may_be(rate, n):
        images: Any = {x: s * x for x, s in zip(system.variables, signs, strict=True)}
        rests: Iterator[Any] = (
            f.subs(images, simultaneous=True) - factor * s * f for f, s in zip(equations, signs, strict=True)
        )
        if all(is_zero(rest) for rest in rests):
            found.append((SignedPermutation(tuple(range(n)), signs), factor == -1))
    return found
