"""Lax pairs of systems of the catalog, as texts; `liepoisson.integrability.known_lax_pair` verifies what it gives.

L and M are elements of the Lie algebra of the bracket, in one text or by components, or matrices of texts, row by
row. Names are those of the system's file; z is the spectral parameter, i the imaginary unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Rows: TypeAlias = tuple[tuple[str, ...], ...]
Entries: TypeAlias = "str | tuple[str, ...] | Rows"


@dataclass(frozen=True)
class LaxTexts:
    """The texts of a Lax pair.

    Attributes:
        L: The matrix whose eigenvalues are constant.
        M: Its partner, dL/dt = [L, M].
        source: Where it is from: keys of docs/references.md.
    """

    L: Entries
    M: Entries
    source: str


def _rows(text: str) -> Rows:
    """A matrix written with a line for each row, and entries between bars."""
    return tuple(tuple(entry.strip() for entry in line.split("|")) for line in text.strip().splitlines())


def _hat(a: str, b: str, c: str) -> Rows:
    """The matrix of the cross product with a vector."""
    return _rows(f"0 | -({c}) | {b}\n{c} | 0 | -({a})\n-({b}) | {a} | 0")


def _diagonal(*entries: str) -> Rows:
    return tuple(tuple(e if i == j else "0" for j in range(len(entries))) for i, e in enumerate(entries))


def _square(field: str) -> Rows:
    """The matrix of the products of the components of a vector."""
    return tuple(tuple(f"{field}{i}*{field}{j}" for j in (1, 2, 3)) for i in (1, 2, 3))


def _sum(*terms: tuple[str, Rows]) -> Rows:
    """The sum of matrices with factors."""
    size = range(len(terms[0][1]))
    return tuple(
        tuple(" + ".join(f"({factor})*({m[i][j]})" for factor, m in terms if m[i][j] != "0") or "0" for j in size)
        for i in size
    )


def _antisymmetric(size: int, entry: str) -> Rows:
    """The matrix with these entries above the diagonal; {i} and {j} stand for the row and the column."""

    def at(i: int, j: int) -> str:
        low, high = sorted((i, j))
        text = entry.format(i=low, j=high)
        return "0" if i == j else text if i < j else f"-({text})"

    return tuple(tuple(at(i, j) for j in range(1, size + 1)) for i in range(1, size + 1))


def _lagrange(*fields: str, source: str = "musso2005") -> LaxTexts:
    """The chain of fields, each the moment of the next one: L = I1 a z^n + z^(n-1) l + ... ."""
    n = len(fields)
    terms = [f"I1*a*z^{n}", *(f"z^{n - 1 - k}*({field})" for k, field in enumerate(fields))]
    return LaxTexts(" + ".join(terms), "inv(I)*l + z*a", source)


def _leibniz_lagrange(*fields: str) -> LaxTexts:
    """The same where the parameter is a3 alone, by components; each field after the second brings a factor epsilon."""
    n = len(fields)

    def component(i: int) -> str:
        terms = [f"epsilon^{max(k - 1, 0)}*z^{n - 1 - k}*{field}{i}" for k, field in enumerate(fields)]
        return " + ".join([f"I1*a3*z^{n}"] * (i == 3) + terms)

    return LaxTexts(tuple(component(i) for i in (1, 2, 3)), ("l1/I1", "l2/I2", "l3/I3 + z*a3"), "musso2005")


def _kovalevskaya(alpha: str, beta: str, k: str) -> LaxTexts:
    """The pair of so(3, 2) in its representation by real 4 x 4 matrices, that is sp(4, R).

    In the 5 x 5 matrices of so(3, 2) L has the blocks hat(l) and, in so(2), 2k - l3; between them z + (alpha, beta)/z.
    """
    x = {f"{name}{i}": f"({text.format(i=i)})" for name, text in (("A", alpha), ("B", beta)) for i in (1, 2, 3)}
    if beta == "0":
        x |= {f"B{i}": "0" for i in (1, 2, 3)}
    first = """
    (A3 + B1)/z | (A1 - B3)/z + 2*K - l2 - l3 + 2*z | l3 - B2/z - 2*z | -A2/z - l1
    (A1 - B3)/z - 2*K + l2 + l3 + 2*z | -(A3 + B1)/z | l1 - A2/z | B2/z + l3 + 2*z
    -B2/z - l3 - 2*z | -A2/z - l1 | (A3 - B1)/z | 2*K + l2 - l3 - 2*z - (A1 + B3)/z
    l1 - A2/z | B2/z - l3 + 2*z | l3 - l2 - 2*z - 2*K - (A1 + B3)/z | (B1 - A3)/z
    """
    second = """
    0 | z/2 - l2/4 | (l3 - K - z)/2 | -l1/4
    z/2 + l2/4 | 0 | l1/4 | (l3 - K + z)/2
    (K - l3 - z)/2 | -l1/4 | 0 | l2/4 - z/2
    l1/4 | (K - l3 + z)/2 | -l2/4 - z/2 | 0
    """
    for name, text in (*x.items(), ("K", k)):
        first, second = first.replace(name, text), second.replace(name, text)
    return LaxTexts(_rows(first), _rows(second), "bobenko1989")


_BODY = [f"(I{j} + I{k} - I{i})/2" for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2))]
_WAVES = """
    0 | 3*({0}) | 5*i*({2})
    -3*({3}) | 0 | 4*({1})
    5*i*({5}) | -4*({4}) | 0
"""

LAX_PAIRS: dict[str, LaxTexts] = {
    "charged-lagrange": _lagrange("l", "alpha + b3/a3*beta", source="ratiu1982"),
    "charged-twisted-lagrange": _lagrange("l", "alpha + b3/a3*beta", "epsilon*beta"),
    "clebsch": LaxTexts(
        _sum(("z^2", _diagonal("a1", "a2", "a3")), ("z", _hat("m1", "m2", "m3")), ("1", _square("p"))),
        _sum(("-z", _diagonal("a2*a3", "a1*a3", "a1*a2")), ("1", _hat("a1*m1", "a2*m2", "a3*m3"))),
        "perelomov1981",
    ),
    "free-rigid-body": LaxTexts(
        _sum(("z", _diagonal(*(f"({j})^2" for j in _BODY))), ("1", _hat("l1", "l2", "l3"))),
        _sum(("z", _diagonal(*_BODY)), ("1", _hat("l1/I1", "l2/I2", "l3/I3"))),
        "manakov1976",
    ),
    "kovalevskaya": _kovalevskaya("-a1*alpha{i}", "0", "0"),
    "kovalevskaya-gyrostat": _kovalevskaya("-a1*alpha{i}", "0", "k"),
    "lagrange": _lagrange("l", "alpha", source="ratiu1982"),
    "leibniz-lagrange-4": _leibniz_lagrange("l", "alpha", "beta", "gamma"),
    "leibniz-lagrange-5": _leibniz_lagrange("l", "alpha", "beta", "gamma", "delta"),
    "manakov-so4": LaxTexts(
        _sum(("z", _diagonal("J1^2", "J2^2", "J3^2", "J4^2")), ("1", _antisymmetric(4, "M{i}{j}"))),
        _sum(("z", _diagonal("J1", "J2", "J3", "J4")), ("1", _antisymmetric(4, "M{i}{j}/(J{i} + J{j})"))),
        "manakov1976",
    ),
    "neumann": LaxTexts(
        _sum(("-z^2", _diagonal("A1", "A2", "A3")), ("z", _hat("l1", "l2", "l3")), ("1", _square("alpha"))),
        _sum(("-z", _diagonal("A1", "A2", "A3")), ("1", _hat("l1", "l2", "l3"))),
        "moser1980",
    ),
    "three-wave": LaxTexts(
        _sum(
            ("-i", _rows(_WAVES.format("q1 + i*p1", "q2 + i*p2", "q3 + i*p3", "q1 - i*p1", "q2 - i*p2", "q3 - i*p3"))),
            ("z", _diagonal("25", "16", "0")),
        ),
        _sum(
            (
                "V",
                _rows("0 | 0 | 4/3*i*(q3 + i*p3)\n0 | 0 | 5/3*(q2 + i*p2)\n4/3*i*(q3 - i*p3) | -5/3*(q2 - i*p2) | 0"),
            ),
            ("i*z*V", _diagonal("20/3", "20/3", "0")),
        ),
        "zakharov1973",
    ),
    "toda": LaxTexts(
        _rows(
            """
            p1 | exp((q1 - q2)/2) | exp((q3 - q1)/2)/z
            exp((q1 - q2)/2) | p2 | exp((q2 - q3)/2)
            z*exp((q3 - q1)/2) | exp((q2 - q3)/2) | p3
            """
        ),
        _rows(
            """
            0 | exp((q1 - q2)/2)/2 | -exp((q3 - q1)/2)/(2*z)
            -exp((q1 - q2)/2)/2 | 0 | exp((q2 - q3)/2)/2
            z*exp((q3 - q1)/2)/2 | -exp((q2 - q3)/2)/2 | 0
            """
        ),
        "flaschka1974",
    ),
    "twisted-lagrange": _lagrange("l", "alpha", "epsilon*beta"),
    "two-field-kovalevskaya": _kovalevskaya("-a1*alpha{i}", "-b2*beta{i}", "0"),
}
"""The pairs by the name of the system."""

MADE = ("kovalevskaya-so4", "three-field-kovalevskaya", "twisted-two-field-kovalevskaya")
"""Further systems of the catalog with a pair, which `liepoisson.catalog.unital_tops` makes."""
