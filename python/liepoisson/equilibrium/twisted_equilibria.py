r"""All equilibria of a twisted top, epsilon != 0, on a leaf with beta != 0, by algebra.

An equilibrium has $\beta\times\omega = 0$, $\alpha\times\omega + \epsilon\beta\times a = 0$ and
$\ell\times\omega + \alpha\times a + \beta\times b = 0$. So $\omega = \kappa\beta$, and for $\kappa\ne0$, $a\ne0$ there
are numbers $\tau$, $\sigma$ with

$$\alpha = \tfrac{\epsilon}{\kappa}a - \tau\beta, \qquad \ell = \kappa I\beta, \qquad \kappa^2\beta = \gamma, \qquad
  (I + \sigma)\gamma = b - \tau a .$$

(The multipliers of $C_1 = |\alpha|^2+2\epsilon\,\ell\cdot\beta$, $C_2 = \alpha\cdot\beta$, $C_3 = |\beta|^2$ are
$\lambda_1 = \kappa/2\epsilon$, $\lambda_2 = \kappa\tau/\epsilon$ and
$2\lambda_3 = \kappa^2\sigma + \kappa\tau^2/\epsilon$.)
With $A = c_2 + c_3\tau$, $G = c_1 + 2c_2\tau + c_3\tau^2$ and $L = a\cdot\gamma$, $M = \gamma\cdot I\gamma$,
$S = |\gamma|^2$ the values of the Casimirs say

$$E_1 = 2\epsilon M + \epsilon^2|a|^2\kappa - G\kappa^3 = 0, \qquad E_2 = \epsilon L - A\kappa^3 = 0, \qquad
  E_3 = S - c_3\kappa^4 = 0 .$$

**Regular** $\sigma\ne-I_k$ wherever $(a_k,b_k)\ne0$: $\gamma = (I+\sigma)^{-1}(b-\tau a)$. From $E_1$ and $E_2$ follows
$GL - 2AM = \epsilon|a|^2A\kappa$; with $E_3$, every solution satisfies

$$|a|^2SA^2 = c_3L(GL-2AM), \qquad S(GL-2AM)^2 = c_3\epsilon^4|a|^4L^2 .$$

Their resultant is a polynomial in $\sigma$ (its part without known factors has degree 42 for random numbers). Its real
roots with the zeros $\tau$ of the first equation are candidates, $\kappa = \pm(S/c_3)^{1/4}$, and each
candidate is thrown away, or proved to be one solution, by interval arithmetic with $E_1, E_2, E_3$. Where b is parallel
to a, both contain the factor $(b-\tau a)$, which is never zero here ($\gamma\ne0$). Where A divides L as a polynomial
($b=0$, $c_2=0$, for example), both contain $A^2$; then A = 0 is a case of its own: $E_1 = E_3 = 0$ for
$(\sigma,\kappa)$.

**Special** The matrix $I+\sigma$ is singular, $\kappa=0$, or a = 0: see `liepoisson.equilibrium.twisted_singular`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

from flint import Ordering, arb, fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz_poly

from liepoisson.algebra.ideals.certified_roots import (
    UndecidedError,
    ball,
    enclosures,
    evaluate,
    in_powers,
    real_roots,
    resultant,
    unique_zero,
    without,
)
from liepoisson.equilibrium.heavy_equilibria import (
    BallVector,
    Critical,
    groups_of,
    is_zero,
)
from liepoisson.equilibrium.twisted_singular import (
    TwistedLeaf,
    at_rest,
    ratio_of,
    singular_with_mass,
    singular_without_mass,
    state_of,
    without_mass,
)


class NotProvedError(Exception):
    """The equations have a common factor that the derivation does not know."""


class TwistedEquilibria:
    """The search on one leaf; what needs no balls is computed once.

    Args:
        leaf: The problem, best with numbers of order one.

    Raises:
        NotProvedError: the equations of the regular branch have an unknown common factor.
    """

    def __init__(self, leaf: TwistedLeaf) -> None:
        self._leaf = leaf
        self._pairs = [] if is_zero(leaf.a) else _regular_pairs(leaf)

    def all(self) -> list[Critical]:
        """All equilibria at the present precision.

        Raises:
            UndecidedError: it does not suffice, as for an equilibrium that is degenerate and isolated.
        """
        found = [critical for branch in self._special() for critical in branch()]
        return found + self._states([box for pair in self._pairs for box in pair.solutions(self._leaf)])

    def some(self) -> list[Critical]:
        """Those that are decided at the present precision, and where others may be: solutions and candidates."""
        found: list[Critical] = []
        for branch in self._special():
            with suppress(UndecidedError):
                found += branch()
        boxes: list[list[arb]] = []
        for pair in self._pairs:
            with suppress(UndecidedError):
                boxes += pair.solutions(self._leaf, with_candidates=True)
        return found + self._states(boxes)

    def _special(self) -> list[Callable[[], list[Critical]]]:
        """The branches with formulas of their own."""
        leaf = self._leaf
        if is_zero(leaf.a):
            return [partial(without_mass, leaf)]
        branches = [partial(at_rest, leaf)]
        for group in groups_of(leaf.inertia):
            if not is_zero(leaf.a, group):
                branches.append(partial(singular_with_mass, leaf, group))
            elif is_zero(leaf.b, group):
                branches.append(partial(singular_without_mass, leaf, group))
        return [*branches]

    def _states(self, boxes: list[list[arb]]) -> list[Critical]:
        """The states of boxes (sigma, tau, kappa), equal ones once."""
        regular: list[list[arb]] = []
        for box in boxes:
            if not any(all(x.overlaps(y) for x, y in zip(box, known, strict=True)) for known in regular):
                regular.append(box)
        leaf = self._leaf
        return [state_of(leaf, tau, kappa, _gamma(leaf, sigma, tau)) for sigma, tau, kappa in regular]


def _gamma(leaf: TwistedLeaf, sigma: arb, tau: arb) -> BallVector:
    return [
        (ball(b) - tau * ball(a)) / (ball(moment) + sigma) if (a, b) != (0, 0) else arb(0)
        for moment, a, b in zip(leaf.inertia, leaf.a, leaf.b, strict=True)
    ]


# The regular branch


@dataclass(frozen=True)
class _Pair:
    """Two equations in (sigma, u), u = tau - shift or, where tau is known, kappa, reduced to one in sigma.

    Attributes:
        pieces: Polynomials in sigma, whose roots are all that can occur, each with the coefficients in powers of u
            (polynomials in sigma, too) of the first equation at these roots.
        shift: What u is counted from.
        tau: The known tau, or None.
    """

    pieces: list[tuple[fmpz_poly, list[fmpq_poly]]]
    shift: fmpq
    tau: fmpq | None

    def solutions(self, leaf: TwistedLeaf, *, with_candidates: bool = False) -> list[list[arb]]:
        """Boxes (sigma, tau, kappa) with exactly one solution each; equal solutions may occur twice.

        With candidates, boxes too that are not known to have one.

        Raises:
            UndecidedError: there are candidates, and they are not wanted; or these cannot be enclosed.
        """
        found: list[list[arb]] = []
        for roots, powers in self.pieces:
            for sigma in real_roots(roots):
                for other in enclosures([evaluate(power, sigma) for power in powers]):
                    for box in self._candidates(leaf, sigma, other + ball(self.shift)):
                        try:
                            proved = unique_zero(_Equations(leaf), box)
                        except UndecidedError:
                            if not with_candidates:
                                raise
                            proved = box
                        found += [proved] if proved is not None else []
        return found

    def _candidates(self, leaf: TwistedLeaf, sigma: arb, other: arb) -> list[list[arb]]:
        if self.tau is not None:
            return [[sigma, ball(self.tau), other]]
        size = sum((x * x for x in _gamma(leaf, sigma, other)), arb(0)) / ball(leaf.c3)
        if size.contains(0):  # the ball is too wide: gamma is not zero
            raise UndecidedError
        return [[sigma, other, sign * size.sqrt().sqrt()] for sign in (1, -1)]


class _Equations:
    """E1, E2 and E3 as functions of (sigma, tau, kappa) with their derivatives, in balls.

    Powers are written as products: FLINT's power of a ball around zero is undefined.
    """

    def __init__(self, leaf: TwistedLeaf) -> None:
        self._leaf = leaf

    def __call__(self, box: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
        sigma, tau, kappa = box
        leaf, cube = self._leaf, kappa * kappa * kappa
        eps, c1, c2, c3, aa = (ball(x) for x in (leaf.epsilon, leaf.c1, leaf.c2, leaf.c3, leaf.aa))
        gamma = _gamma(leaf, sigma, tau)
        used = [k for k in range(3) if (leaf.a[k], leaf.b[k]) != (0, 0)]
        a, moment = [ball(x) for x in leaf.a], [ball(x) for x in leaf.inertia]
        by_sigma = {k: -gamma[k] / (moment[k] + sigma) for k in used}
        by_tau = {k: -a[k] / (moment[k] + sigma) for k in used}
        total = sum((moment[k] * gamma[k] * gamma[k] for k in used), arb(0))
        slope, big = c2 + c3 * tau, c1 + 2 * c2 * tau + c3 * tau * tau
        values = [
            2 * eps * total + eps**2 * aa * kappa - big * cube,
            eps * sum((a[k] * gamma[k] for k in used), arb(0)) - slope * cube,
            sum((gamma[k] * gamma[k] for k in used), arb(0)) - c3 * cube * kappa,
        ]

        def along(move: dict[int, arb]) -> list[arb]:
            return [
                4 * eps * sum((moment[k] * gamma[k] * move[k] for k in used), arb(0)),
                eps * sum((a[k] * move[k] for k in used), arb(0)),
                2 * sum((gamma[k] * move[k] for k in used), arb(0)),
            ]

        first, second = along(by_sigma), along(by_tau)
        second = [second[0] - 2 * slope * cube, second[1] - c3 * cube, second[2]]
        third = [eps**2 * aa - 3 * big * kappa * kappa, -3 * slope * kappa * kappa, -4 * c3 * cube]
        return values, [list(row) for row in zip(first, second, third, strict=True)]


@dataclass(frozen=True)
class _Polynomials:
    """L, S, M with their denominators cleared by the product Pi of (I + sigma): L Pi, S Pi^2, M Pi^2."""

    pi: Any
    l: Any
    s: Any
    m: Any


def _polynomials(leaf: TwistedLeaf, sigma: Any, tau: Any) -> _Polynomials:
    zero = 0 * sigma
    pi = zero + 1
    for group in leaf.active:
        pi = pi * (sigma + leaf.inertia[group[0]])
    gamma: list[Any] = [zero] * 3
    for group in leaf.active:
        cofactor = zero + 1
        for other in leaf.active:
            cofactor = cofactor * (sigma + leaf.inertia[other[0]]) if other != group else cofactor
        for k in group:
            gamma[k] = (leaf.b[k] - tau * leaf.a[k]) * cofactor
    weighted = [leaf.a[k] * gamma[k] for k in range(3)]
    squares = [x * x for x in gamma]
    l, s = sum(weighted, zero), sum(squares, zero)
    return _Polynomials(pi, l, s, sum((leaf.inertia[k] * squares[k] for k in range(3)), zero))


def _regular_pairs(leaf: TwistedLeaf) -> list[_Pair]:
    sigma, u = fmpq_mpoly_ctx.get(("sigma", "u"), Ordering.lex).gens()
    ratio = ratio_of(leaf.b, leaf.a)
    shift = ratio if ratio is not None else fmpq(0)
    tau = u + shift
    p = _polynomials(leaf, sigma, tau)
    slope, big = leaf.c2 + leaf.c3 * tau, leaf.c1 + 2 * leaf.c2 * tau + leaf.c3 * tau**2
    l, divides = p.l, not (p.l % slope)
    if divides:
        l, slope = l // slope, 0 * sigma + 1
    w = big * l * p.pi - 2 * slope * p.m
    first = leaf.aa * p.s * slope**2 * p.pi - leaf.c3 * l * w
    second = p.s * w**2 - leaf.c3 * leaf.epsilon**4 * leaf.aa**2 * l**2 * p.pi**4
    # gamma is not zero; where b is parallel to a, gamma is a multiple of u
    pairs = [_Pair(_pieces(leaf, first, second, excludes_zero=ratio is not None), shift, None)]
    if divides and ratio != -leaf.c2 / leaf.c3:
        pairs.append(_resting_pair(leaf))
    return pairs


def _resting_pair(leaf: TwistedLeaf) -> _Pair:
    """The case A = 0 where L = 0 follows from it: E1 and E3 for sigma and kappa."""
    sigma, kappa = fmpq_mpoly_ctx.get(("sigma", "kappa"), Ordering.lex).gens()
    tau = -leaf.c2 / leaf.c3
    p = _polynomials(leaf, sigma, tau)
    big = leaf.c1 - leaf.c2**2 / leaf.c3
    third = p.s - leaf.c3 * kappa**4 * p.pi**2
    first = 2 * leaf.epsilon * p.m + p.pi**2 * (leaf.epsilon**2 * leaf.aa * kappa - big * kappa**3)
    return _Pair(_pieces(leaf, third, first, excludes_zero=True), fmpq(0), tau)


def _pieces(
    leaf: TwistedLeaf, first: Any, second: Any, *, excludes_zero: bool
) -> list[tuple[fmpz_poly, list[fmpq_poly]]]:
    """The roots of the resultant, each with an equation for u that is not trivial there.

    That is the first one, unless all its coefficients vanish: then it says nothing about u, and the second one does
    (both cannot, without a common factor). Where u = 0 is excluded, the powers of u that an equation has there are
    left out.
    """
    sigma, u = first.context().gens()
    known = [sigma + leaf.inertia[group[0]] for group in leaf.active] + ([u] if excludes_zero else [])
    for factor in known:
        first, second = (_stripped(f, factor) for f in (first, second))
    if first.gcd(second).total_degree() > 0:
        raise NotProvedError
    roots = fmpq_poly(resultant(first, second))
    for group in leaf.active:
        roots = without(roots, fmpq_poly([leaf.inertia[group[0]], 1]))
    pieces: list[tuple[fmpz_poly, list[fmpq_poly]]] = []
    for powers in (in_powers(first), in_powers(second)):
        trivial = fmpq_poly([0])
        for power in powers:
            trivial = trivial.gcd(power)
        here, roots = without(roots, trivial), roots.gcd(trivial)
        if not excludes_zero:
            pieces.append((here.numer(), powers))
            continue
        lowest = 0
        while here.degree() > 0:
            pieces.append((without(here, powers[lowest]).numer(), powers[lowest:]))
            here, lowest = here.gcd(powers[lowest]), lowest + 1
    if roots.degree() > 0:
        raise NotProvedError
    return pieces


def _stripped(f: Any, factor: Any) -> Any:
    while f and not f % factor:
        f = f // factor
    return f
