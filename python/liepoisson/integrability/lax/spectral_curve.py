r"""The spectral curve $\det(w - L(z)) = 0$ of a Lax pair at a state: its components, their genus, and quotients.

The motion does not change the curve. Scope: a state with rational coordinates at which the polynomial has rational
coefficients; it is divided into factors over the rational numbers, and the genus of each is computed as
`liepoisson.integrability.lax.genus` says, exactly. The genus is that of the curve at this state; at states outside of a
set on which some polynomial vanishes it is the same, and nowhere larger.

Of the symmetries those that change signs are found: (z, w) -> (-z, w), (z, -w), (-z, -w). The curve covers its quotient
by one of them twice; the difference of both genera is the dimension of the Prym variety.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING, Any

from flint import Ordering, fmpq_mpoly_ctx
from sympy import Add, Expr, Rational, Symbol, exp, log

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.number_fields import as_fmpq, as_fraction
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import as_seed
from liepoisson.inputs.given import listed, named
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.lax.entries import EntryArithmetic
from liepoisson.integrability.lax.genus import Curve, genus, interior_points

if TYPE_CHECKING:
    from liepoisson.integrability.lax.pair import LaxPair

_LARGEST = 9
"""Coordinates of random states are whole numbers up to this one, with either sign."""


@dataclass(frozen=True)
class CurveQuotient:
    """The quotient of a component by a change of signs.

    Example:
        >>> curve = lp.integrability.known_lax_pair("kovalevskaya").spectral_curve([1, 2, 3, 1, 1, -1])
        >>> quotient = curve.components[0].quotients[0]
        >>> quotient.symmetry, curve.components[0].genus, quotient.genus
        ('(z, w) -> (-z, w)', 3, 2)

    Attributes:
        symmetry: What it does, such as "(z, w) -> (-z, w)".
        polynomial: The equation of the quotient in Z and W.
        coordinates: What Z and W are, such as "Z = z^2, W = w/z".
        genus: Its genus; None if it was not decided.
    """

    symmetry: str
    polynomial: Expr
    coordinates: str
    genus: int | None


@dataclass(frozen=True)
class CurveComponent:
    """A component of the spectral curve.

    Example:
        >>> curve = lp.integrability.known_lax_pair("lagrange").spectral_curve([1, 2, 3, 1, 1, -1])
        >>> [(component.degree, component.genus) for component in curve.components]
        [(1, 0), (2, 1)]

    Attributes:
        polynomial: Its irreducible equation, monic in w.
        multiplicity: How often it occurs in the characteristic polynomial.
        degree: Its degree in w: the number of sheets over the z-plane.
        genus: The genus of its smooth model; None if it was not decided.
        reason: Why it was not decided.
        interior_points: Lattice points inside the Newton polygon, an upper bound of the genus.
        n_branch_points: Points of the z-sphere over which sheets meet in a branch point.
        quotients: By changes of signs.
    """

    polynomial: Expr
    multiplicity: int
    degree: int
    genus: int | None
    reason: str
    interior_points: int
    n_branch_points: int
    quotients: tuple[CurveQuotient, ...]

    @property
    def prym_dimensions(self) -> dict[str, int]:
        """The dimension of the Prym variety for each quotient by one change of signs, by the symmetry."""
        single = (q for q in self.quotients if "+-" not in q.symmetry)
        return {q.symmetry: self.genus - q.genus for q in single if self.genus is not None and q.genus is not None}


@dataclass(frozen=True, repr=False)
class SpectralCurve:
    """The spectral curve of a Lax pair at a state.

    Example:
        >>> curve = lp.integrability.known_lax_pair("kovalevskaya").spectral_curve([1, 2, 3, 1, 1, -1])
        >>> curve.genus, len(curve.components)
        (3, 1)

    Attributes:
        pair: The Lax pair.
        point: The values of the coordinates, and of parameters that are symbols.
        polynomial: The characteristic polynomial in w and the spectral parameter.
        components: Those of degree one in w are spheres.
    """

    pair: LaxPair
    point: dict[str, Fraction] = field(hash=False)
    polynomial: Expr
    components: tuple[CurveComponent, ...]

    @property
    def genus(self) -> int | None:
        """The largest genus of a component; None if one was not decided."""
        values = [c.genus for c in self.components]
        return None if None in values else max((g for g in values if g is not None), default=0)

    def __repr__(self) -> str:
        found = ", ".join(_genus_in_words(c.genus) for c in self.components)
        n = len(self.components)
        return f"<SpectralCurve of {self.pair.system.name}: {n} component{'s' * (n != 1)}, {found}>"

    def __str__(self) -> str:
        """The components with their genus and quotients."""
        where = ", ".join(f"{name} = {value}" for name, value in self.point.items())
        lines = [f"{self.pair.system.name}: spectral curve det(w - L({self.pair.spectral})) = 0 at {where}"]
        for c in self.components:
            times = f", {c.multiplicity} times" if c.multiplicity > 1 else ""
            lines.append(f"{_written(c.polynomial, self.pair.spectral)} = 0{times}")
            why = f" ({c.reason})" if c.reason else ""
            lines.append(
                f"  {_genus_in_words(c.genus)}{why}; degree {c.degree} in w, {c.n_branch_points} branch points, "
                f"{c.interior_points} points inside the Newton polygon"
            )
            lines += [f"  quotient by {q.symmetry}: {_genus_in_words(q.genus)}; {q.coordinates}" for q in c.quotients]
        return "\n".join(lines)


def _written(polynomial: Any, z: Any) -> str:
    """A polynomial in w and z by falling powers."""
    terms: list[tuple[tuple[int, int], Any]] = []
    for term in Add.make_args(polynomial):
        powers = term.as_powers_dict()
        terms.append(((int(powers.get(Symbol("w"), 0)), int(powers.get(z, 0))), term.as_coeff_Mul()[0]))
    text = ""
    for (j, i), c in sorted(terms, reverse=True):
        factors = [f"{name}^{k}" if k > 1 else name for name, k in (("w", j), (str(z), i)) if k > 0]
        if abs(c.p) > 1 or not factors:
            factors.insert(0, str(abs(c.p)))
        below = [str(c.q)] * (c.q > 1) + [f"{z}^{-i}" if i < -1 else str(z)] * (i < 0)
        divided = f"/({'*'.join(below)})" if len(below) > 1 else "".join(f"/{b}" for b in below)
        text += f"{' - ' if c < 0 else ' + '}{'*'.join(factors)}{divided}"
    return text[3:] if text.startswith(" + ") else "-" + text[3:]


def _genus_in_words(value: int | None) -> str:
    return "genus not decided" if value is None else f"genus {value}"


def spectral_curve(pair: LaxPair, point: Mapping[str, Any] | Sequence[Any] | None, *, seed: int = 0) -> SpectralCurve:
    """The spectral curve at a state; see `LaxPair.spectral_curve`."""
    if pair.spectral is None:
        raise ParameterError(
            "spectral: wanted a Lax pair with a spectral parameter, whose eigenvalues are a curve; got none"
        )
    values, numbers = _values(pair, point, as_seed(seed))
    matrix: Any = pair.L.xreplace(numbers).expand()
    arithmetic = EntryArithmetic(list(matrix))
    rows = [[arithmetic.read(e) for e in row] for row in matrix.tolist()]
    n, curve = pair.size, dict[tuple[int, int], Fraction]()
    for k, c in enumerate(arithmetic.characteristic_coefficients(rows)):
        for power, coefficient in arithmetic.by_power(c, pair.spectral).items():
            value: Any = arithmetic.write(coefficient)
            if not value.is_Rational:
                raise ParameterError(
                    f"wanted a characteristic polynomial with rational coefficients; got {shown(value)} at w^{n - k}; "
                    "choose other values of the coordinates and parameters"
                )
            if value:
                curve[power, n - k] = as_fraction(value)
    z, w = pair.spectral, Symbol("w")

    def expression(f: Curve, x: Any = z, y: Any = w) -> Expr:
        return Add(*(Rational(c.numerator, c.denominator) * x**i * y**j for (i, j), c in f.items()))

    components: list[CurveComponent] = []
    for factor, multiplicity in _factors(curve):
        found = genus(factor)
        quotients = tuple(
            CurveQuotient(
                f"({z}, w) -> {text}", expression(q, Symbol("Z"), Symbol("W")), coordinates.format(z=z), genus(q).value
            )
            for text, coordinates, q in _quotients(factor, str(z))
        )
        components.append(
            CurveComponent(
                expression(factor),
                multiplicity,
                max(j for _, j in factor),
                found.value,
                found.reason,
                interior_points(factor),
                found.n_branch_points,
                quotients if max(j for _, j in factor) > 1 else (),
            )
        )
    return SpectralCurve(pair, values, expression(curve), tuple(components))


def _values(
    pair: LaxPair, point: Mapping[str, Any] | Sequence[Any] | None, seed: int
) -> tuple[dict[str, Fraction], dict[Any, Any]]:
    """The values by name, and what is inserted for the symbols; coordinates in exponents are twice logarithms."""
    matrix: Any = pair.L
    used = {s for s in matrix.free_symbols if s != pair.spectral}
    in_exponents = {str(s) for e in matrix.atoms(exp) for s in e.free_symbols} if point is None else set[str]()
    names = [*pair.system.component_names, *sorted(str(s) for s in used - set(pair.system.variables))]
    if point is None:
        random = Random(seed)
        sizes = random.choices(range(1, _LARGEST + 1), k=len(names))
        free = in_exponents | set(names[len(pair.system.component_names) :])
        given: dict[str, Any] = {
            name: size if name in free else random.choice((-1, 1)) * size
            for name, size in zip(names, sizes, strict=True)
        }
    elif (by_name := named(point, "point")) is not None:
        given = by_name
    else:
        values_in_order = listed(point, "point") or []
        if len(values_in_order) != len(names):
            raise ParameterError(f"point: wanted values of {', '.join(names)}; got {shown(point)}")
        given = dict(zip(names, values_in_order, strict=True))
    values: dict[str, Fraction] = {}
    for name in names:
        if name not in given:
            raise ParameterError(f"point: wanted values of {', '.join(names)}; got none of {name}")
        value = read_parameter(given[name], name)
        if not isinstance(value, Fraction):
            raise ParameterError(f"point: wanted rational numbers; got {name} = {shown(given[name])}")
        values[name] = value
    inserted = {s: to_sympy(values[str(s)]) for s in used}
    turned = {s: 2 * log(value) if str(s) in in_exponents else value for s, value in inserted.items()}
    return {f"exp({name}/2)" if name in in_exponents else name: v for name, v in values.items()}, turned


def _factors(curve: Curve) -> Iterator[tuple[Curve, int]]:
    """The irreducible factors over the rationals that contain w, monic in w, with multiplicities; low degrees first."""
    lowest = min(i for i, _ in curve)
    context = fmpq_mpoly_ctx.get(["z", "w"], Ordering.lex)
    f = context.from_dict({(i - lowest, j): as_fmpq(c) for (i, j), c in curve.items()})
    found: list[tuple[Curve, int]] = []
    for factor, multiplicity in f.factor()[1]:
        terms = {(int(m[0]), int(m[1])): as_fraction(c) for m, c in factor.terms()}
        d = max(j for _, j in terms)
        if d:
            [(power, lead)] = [(i, c) for (i, j), c in terms.items() if j == d]
            found.append(({(i - power, j): c / lead for (i, j), c in terms.items()}, multiplicity))
    return iter(sorted(found, key=lambda item: (max(j for _, j in item[0]), len(item[0]))))


def _quotients(curve: Curve, z: str) -> Iterator[tuple[str, str, Curve]]:
    """The quotients by changes of signs that are symmetries: what changes, their coordinates, their equations."""
    d = max(j for _, j in curve)
    is_even_in_z = all(i % 2 == 0 for i, _ in curve)
    is_even_in_w = all(j % 2 == 0 for _, j in curve)
    if is_even_in_z:
        yield f"(-{z}, w)", "Z = {z}^2, W = w", {(i // 2, j): c for (i, j), c in curve.items()}
    if is_even_in_w:
        yield f"({z}, -w)", "Z = {z}, W = w^2", {(i, j // 2): c for (i, j), c in curve.items()}
    if all((i + j - d) % 2 == 0 for i, j in curve):
        turned = {((i + j - d) // 2, j): c for (i, j), c in curve.items()}
        yield f"(-{z}, -w)", "Z = {z}^2, W = w/{z}", turned
    if is_even_in_z and is_even_in_w:
        both = {(i // 2, j // 2): c for (i, j), c in curve.items()}
        yield f"(+-{z}, +-w)", "Z = {z}^2, W = w^2", both
