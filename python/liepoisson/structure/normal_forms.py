r"""Normal forms of the local commutative algebras over the reals of dimension at most five, with residue field R.

A local algebra is $\mathbb R \oplus m$ with m nilpotent.  Its Hilbert function $(1, \dim m/m^2, \dim m^2/m^3, \dots)$
leaves these cases in dimension n <= 5:

* (1, 1, ..., 1): one generator, $\mathbb R[x]/(x^n)$.
* (1, d): $m^2 = 0$.
* (1, d, 1): multiplication is a quadratic form on $m/m^2$ up to a factor, so rank and signature up to sign decide.
* (1, 2, 2): two quadratic relations fewer than monomials: one relation, a binary quadratic form of rank one, indefinite
  or definite.
* (1, 2, 1, 1): x generates a chain $x, x^2, x^3$; then $xy = 0$ and $y^2 = 0$ or $y^2 = x^3$ can be reached.

This gives 1, 1, 2, 5, 12 algebras for n = 1..5.  Over the complex numbers signatures do not count: 1, 1, 2, 4, 9.

References: Poonen, "Isomorphism types of commutative algebras of finite rank over an algebraically closed field", in
Computational Arithmetic Geometry, Contemp. Math. 463 (2008) 111, for the complex list; Thiffeault and Morrison,
Physica D 136 (2000) 205, for extensions up to order four.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import reduce
from numbers import Integral
from operator import add

from liepoisson.errors import ParameterError, UnknownNameError, did_you_mean
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.structure.extension import Extension, Products

# name: (basis, products of two generators other than the unit).  The products of longer monomials follow from these.
_FORMS: dict[int, dict[str, tuple[str, dict[str, str]]]] = {
    1: {"R": ("1", {})},
    2: {"R[x]/(x^2)": ("1 x", {})},
    3: {
        "R[x]/(x^3)": ("1 x xx", {"x x": "xx"}),
        "R[x,y]/(x,y)^2": ("1 x y", {}),
    },
    4: {
        "R[x]/(x^4)": ("1 x xx xxx", {"x x": "xx", "x xx": "xxx"}),
        "R[x,y]/(x^3, xy, y^2)": ("1 x y xx", {"x x": "xx"}),
        "R[x,y]/(x^2, y^2)": ("1 x y xy", {"x y": "xy"}),
        "R[x,y]/(x^2 - y^2, xy)": ("1 x y xx", {"x x": "xx", "y y": "xx"}),
        "R[x,y,z]/(x,y,z)^2": ("1 x y z", {}),
    },
    5: {
        "R[x]/(x^5)": ("1 x xx xxx xxxx", {"x x": "xx", "x xx": "xxx", "x xxx": "xxxx", "xx xx": "xxxx"}),
        "R[x,y]/(x^4, xy, y^2)": ("1 x y xx xxx", {"x x": "xx", "x xx": "xxx"}),
        "R[x,y]/(x^3 - y^2, xy)": ("1 x y xx xxx", {"x x": "xx", "x xx": "xxx", "y y": "xxx"}),
        "R[x,y]/(x^3, x^2 y, y^2)": ("1 x y xx xy", {"x x": "xx", "x y": "xy"}),
        "R[x,y]/(x^3, xy, y^3)": ("1 x y xx yy", {"x x": "xx", "y y": "yy"}),
        "R[x,y]/(x^3, x^2 y, x^2 + y^2)": ("1 x y xx xy", {"x x": "xx", "x y": "xy", "y y": "-xx"}),
        "R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)": ("1 x y z xx", {"x x": "xx"}),
        "R[x,y,z]/(x^2, xz, y^2, yz, z^2)": ("1 x y z xy", {"x y": "xy"}),
        "R[x,y,z]/(x^2 - y^2, xy, xz, yz, z^2)": ("1 x y z xx", {"x x": "xx", "y y": "xx"}),
        "R[x,y,z]/(x^2, xy - z^2, xz, y^2, yz)": ("1 x y z xy", {"x y": "xy", "z z": "xy"}),
        "R[x,y,z]/(x^2 - y^2, x^2 - z^2, xy, xz, yz)": ("1 x y z xx", {"x x": "xx", "y y": "xx", "z z": "xx"}),
        "R[x,y,z,t]/(x,y,z,t)^2": ("1 x y z t", {}),
    },
}

# Real forms that become isomorphic over the complex numbers, each with the form that names them both.
_SAME_OVER_C = {
    "R[x,y]/(x^2 - y^2, xy)": "R[x,y]/(x^2, y^2)",
    "R[x,y]/(x^3, x^2 y, x^2 + y^2)": "R[x,y]/(x^3, xy, y^3)",
    "R[x,y,z]/(x^2 - y^2, xy, xz, yz, z^2)": "R[x,y,z]/(x^2, xz, y^2, yz, z^2)",
    "R[x,y,z]/(x^2 - y^2, x^2 - z^2, xy, xz, yz)": "R[x,y,z]/(x^2, xy - z^2, xz, y^2, yz)",
}


@explains_its_arguments
def normal_forms(n: int) -> list[Extension]:
    """The local real algebras of dimension n with residue field R, one of each isomorphism class.

    The basis of each is adapted to the powers of its maximal ideal: the unit, then generators, then products.

    Example:
        >>> [form.name for form in lp.extensions.normal_forms(4)]
        ['R[x]/(x^4)', 'R[x,y]/(x^3, xy, y^2)', 'R[x,y]/(x^2, y^2)', 'R[x,y]/(x^2 - y^2, xy)', 'R[x,y,z]/(x,y,z)^2']

    Args:
        n: Dimension, 1 to 5.

    Returns:
        1, 1, 2, 5, 12 extensions for n = 1, ..., 5, always in the same order; names such as "R[x]/(x^3)".

    Raises:
        ParameterError: n is not in 1..5.  (The list is finite for n = 6, too; from 7 on there are continuous families.)
    """
    if isinstance(n, bool) or not isinstance(n, Integral) or not 1 <= n <= 5:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"the normal forms are listed for dimensions 1 to 5; got {n!r}. Use a smaller algebra.")
    return [_extension(name, *form) for name, form in _FORMS[int(n)].items()]


@explains_its_arguments
def commutative_algebras(n: int) -> list[Extension]:
    r"""All commutative associative real algebras of dimension n, with or without a unit, one of each isomorphism class.

    An algebra is the direct product $U \times N$ of one with a unit and a nilpotent one (Peirce decomposition by its
    largest idempotent).  U is a product of local algebras with the residue fields R and C, and N the maximal ideal of
    $\mathbb R 1 \oplus N$, a local algebra of one dimension more.  The names are those that `Extension.classify` finds.

    Example:
        >>> for algebra in lp.extensions.commutative_algebras(2):
        ...     print(algebra.name, algebra.is_unital)
        R + R True
        R[x]/(x^2) True
        C True
        R + maximal ideal of R[x]/(x^2) False
        maximal ideal of R[x]/(x^3) False
        maximal ideal of R[x,y]/(x,y)^2 False

    Args:
        n: Dimension, 1 to 4.

    Returns:
        2, 6, 15, 42 extensions for n = 1, ..., 4, always in the same order: those with a unit first.

    Raises:
        ParameterError: n is not in 1..4.

    References: Thiffeault and Morrison (2000) for the nilpotent ones; [poonen2008] for the local ones over C.
    """
    if isinstance(n, bool) or not isinstance(n, Integral) or not 1 <= n <= 4:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"the algebras are listed for dimensions 1 to 4; got {n!r}. Use extension.classify().")
    size = int(n)
    found: list[Extension] = []
    for nilpotent in range(size + 1):
        ideals = normal_forms(nilpotent + 1) if nilpotent else []
        for parts in _unital(size - nilpotent, 0):
            for ideal in ideals or [None]:
                found.append(_product(parts, ideal))
    return found


def _unital(n: int, start: int) -> Iterator[list[Extension]]:
    """All products of local algebras with the dimension n, the factors in one order."""
    local = [form for m in range(1, 5) for form in normal_forms(m)]
    local += [complex_truncated_polynomials(1), complex_truncated_polynomials(2)]
    if n == 0:
        yield []
    for k in range(start, len(local)):
        if local[k].dimension <= n:
            yield from ([local[k], *others] for others in _unital(n - local[k].dimension, k))


def _product(parts: list[Extension], ideal: Extension | None) -> Extension:
    """The direct product of local algebras and of the maximal ideal of another one, named as by a classification."""
    ordered = sorted(parts, key=lambda form: (-form.dimension, form.name))
    names = [form.name for form in ordered]
    if ideal is not None:
        ordered.append(maximal_ideal(ideal))
        names.append(ordered[-1].name)
    total = reduce(add, ordered)
    total.name = " + ".join(names)
    return total


def maximal_ideal(form: Extension) -> Extension:
    """The maximal ideal of a normal form with residue field R, as an algebra without unit."""
    products = {
        (i - 1, j - 1): {k - 1: value for k, value in row.items()} for (i, j), row in form.products.items() if i > 0
    }
    return Extension.from_products(form.dimension - 1, products, f"maximal ideal of {form.name}", check=False)


def normal_form_named(name: str) -> Extension:
    """The normal form of a name, for example "R[x,y]/(x^2, y^2)".

    Raises:
        UnknownNameError: there is no such form.
    """
    for forms in _FORMS.values():
        if name in forms:
            return _extension(name, *forms[name])
    known = [other for forms in _FORMS.values() for other in forms]
    raise UnknownNameError(
        f"no normal form is called {name!r}. {did_you_mean(name, known)}The names are {', '.join(known)}."
    )


def truncated_polynomials(n: int) -> Extension:
    r"""$\mathbb R[x]/(x^n)$ in the basis $1, x, \dots, x^{n-1}$."""
    if n <= 5:
        return normal_forms(n)[0]
    products: Products = {(i, j): {i + j: Fraction(1)} for i in range(n) for j in range(i, n) if i + j < n}
    return Extension.from_products(n, products, f"R[x]/(x^{n})", check=False)


def null_square(n: int) -> Extension:
    r"""The algebra $\mathbb R \oplus m$ of dimension n with $m^2 = 0$."""
    if 2 < n <= 5:
        return normal_forms(n)[-1]
    if n <= 2:
        return truncated_polynomials(n)
    products: Products = {(0, i): {i: Fraction(1)} for i in range(n)}
    return Extension.from_products(n, products, f"R[x1,...,x{n - 1}]/(x1,...,x{n - 1})^2", check=False)


def complex_truncated_polynomials(n: int) -> Extension:
    r"""$\mathbb C[x]/(x^n)$ as a real algebra, basis $1, i, x, ix, x^2, \dots$: local with residue field C."""
    products: Products = {}
    for a in range(n):
        for b in range(a, n - a):
            products[2 * a, 2 * b] = {2 * (a + b): Fraction(1)}
            products[2 * a, 2 * b + 1] = {2 * (a + b) + 1: Fraction(1)}
            products[2 * a + 1, 2 * b + 1] = {2 * (a + b): Fraction(-1)}
            if a < b:
                products[2 * a + 1, 2 * b] = {2 * (a + b) + 1: Fraction(1)}
    return Extension.from_products(2 * n, products, "C" if n == 1 else f"C[x]/(x^{n})", check=False)


def complex_name(name: str) -> str:
    """What a normal form is over the complex numbers: real forms that coincide there get the same name."""
    return _SAME_OVER_C.get(name, name).replace("R", "C")


def _extension(name: str, basis: str, products: dict[str, str]) -> Extension:
    monomials = basis.split()
    place = {monomial: k for k, monomial in enumerate(monomials)}
    table: Products = {(0, k): {k: Fraction(1)} for k in range(len(monomials))}
    for factors, value in products.items():
        left, right = factors.split()
        table[place[left], place[right]] = {place[value.lstrip("-")]: Fraction(-1 if value.startswith("-") else 1)}
    return Extension.from_products(len(monomials), table, name, check=False)
