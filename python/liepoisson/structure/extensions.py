r"""Named extensions: trivial, semidirect, Leibniz, compressible reduced magnetohydrodynamics, binary cubics.

References: Thiffeault and Morrison, Physica D 136 (2000) 205; Hazeltine, Kotschenreuther and Morrison, Phys. Fluids 28
(1985) 2466; Thiffeault and Morrison (2001) for the twisted top.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from numbers import Integral
from typing import Any

from liepoisson.algebra.exact_numbers import Coefficient, is_zero
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_coefficient
from liepoisson.formula.tensors import Rows, of_one_kind
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.structure.extension import Extension, read_field_count


@explains_its_arguments
def trivial() -> Extension:
    r"""The one-dimensional algebra $\mathbb R$, $e_0 e_0 = e_0$: g (x) R = g, one field.

    Example:
        >>> (lp.so(3) @ lp.trivial()).casimirs()
        [l1**2 + l2**2 + l3**2]
    """
    return Extension.from_products(1, {(0, 0): {0: 1}}, name="trivial")


@explains_its_arguments
def leibniz(n: int, epsilon: Parameter = 1) -> Extension:
    r"""The Leibniz extension of order n: $\mathbb R[z]/(z^n)$, with the products of non-units scaled by epsilon.

    $e_0 e_\mu = e_\mu$ and $e_\mu e_\nu = \epsilon\, e_{\mu+\nu}$ for $\mu, \nu \ge 1$, zero when $\mu + \nu \ge n$.
    For n = 3 the only cocycle is $e_1 e_1 = \epsilon e_2$: the twisted top.

    Example:
        >>> lp.leibniz(3, "epsilon").products
        {(0, 0): {0: 1}, (0, 1): {1: 1}, (0, 2): {2: 1}, (1, 1): {2: epsilon}}
        >>> (lp.so(3) @ lp.leibniz(3)).casimirs()[0]
        alpha1**2 + alpha2**2 + alpha3**2 + 2*beta1*l1 + 2*beta2*l2 + 2*beta3*l3

    Args:
        n: Number of fields, 1 to 100.
        epsilon: Strength of the cocycle; 0 gives `semidirect(n)`.

    Raises:
        ParameterError: n is not in the range, or epsilon is not exact.
    """
    return _with_strength(partial(_graded, n, name=f"leibniz({n})"), epsilon, "epsilon", f"Leibniz({n}, ")


@explains_its_arguments
def semidirect(n: int) -> Extension:
    r"""The semidirect product with n - 1 passive fields: $e_0 e_\mu = e_\mu$, all other products zero.

    For n = 3: the charged heavy top.

    Example:
        >>> (lp.so(3) @ lp.semidirect(2)).casimirs()  # heavy top: the length of alpha, and the spin about it
        [alpha1*l1 + alpha2*l2 + alpha3*l3, alpha1**2 + alpha2**2 + alpha3**2]

    Raises:
        ParameterError: n is not in 1..100.
    """
    return _graded(n, Fraction(0), f"semidirect({n})")


@explains_its_arguments
def crmhd(beta_e: Parameter = "beta_e") -> Extension:
    r"""Compressible reduced magnetohydrodynamics: fields omega, v, p, psi with $e_1 e_2 = -\beta_e\, e_3$.

    $e_0$ is the unit; $\omega$ is the vorticity, v the parallel velocity, p the pressure and psi the magnetic flux.
    In the plasma g is the algebra of functions of the plane with the canonical bracket; with so(3) in its place the
    Casimirs are $\psi\cdot\psi$, $v\cdot\psi$, $p\cdot\psi$ and $v\cdot p - \beta_e\, \omega\cdot\psi$.

    Example:
        >>> plasma = lp.extensions.crmhd()
        >>> plasma.field_names
        ('omega', 'v', 'p', 'psi')
        >>> plasma.products
        {(0, 0): {0: 1}, (0, 1): {1: 1}, (0, 2): {2: 1}, (0, 3): {3: 1}, (1, 2): {3: -beta_e}}
        >>> (lp.so(3) @ plasma).casimir_report().complete
        True

    Args:
        beta_e: Electron beta, a parameter of compressibility.

    Raises:
        ParameterError: beta_e is not exact.

    References: Hazeltine, Kotschenreuther and Morrison (1985); Thiffeault and Morrison (2000).
    """
    return _with_strength(_crmhd, beta_e, "beta_e", "CRMHD(")


def _crmhd(strength: Coefficient) -> Extension:
    products: Any = _with_unit(4, {(1, 2): {3: -strength}})
    return Extension.from_products(4, products, "CRMHD", ("omega", "v", "p", "psi"), check=False)


@explains_its_arguments
def binary_cubic(a: Parameter = "a", b: Parameter = "b", c: Parameter = "c", d: Parameter = "d") -> Extension:
    r"""The algebra of dimension 3 of a binary cubic form, $aX^3 + bX^2Y + cXY^2 + dY^3$, with unit $e_0$.

    $e_1 e_1 = -ac\, e_0 + b\, e_1 - a\, e_2$, $e_1 e_2 = -ad\, e_0$ and $e_2 e_2 = -bd\, e_0 + d\, e_1 - c\, e_2$.

    These are all unital algebras of dimension 3, up to the choice of $e_1$ and $e_2$ modulo the unit: the twists of
    the charged heavy top.  Over the reals there are five: the cubic 0 gives `semidirect(3)`, a triple root
    `leibniz(3)`, a double root $\mathbb R\times\mathbb R[z]/z^2$, three real roots $\mathbb R^3$, one real root
    $\mathbb R\times\mathbb C$.

    Example:
        >>> lp.extensions.binary_cubic("a", 0, 0, "d").products
        {(0, 0): {0: 1}, (0, 1): {1: 1}, (0, 2): {2: 1}, (1, 1): {2: -a}, (1, 2): {0: -a*d}, (2, 2): {1: d}}
        >>> [lp.extensions.binary_cubic(*form).classify().name for form in ((0, 1, -1, 0), (0, 1, 0, 1), (0, 1, 0, 0))]
        ['R + R + R', 'C + R', 'R[x]/(x^2) + R']

    Args:
        a: Coefficient of $X^3$; $-a$ is the strength of the cocycle of the twisted top.
        b: Coefficient of $X^2 Y$.
        c: Coefficient of $X Y^2$.
        d: Coefficient of $Y^3$.

    Raises:
        ParameterError: a coefficient is not exact.

    References: Delone and Faddeev (1964).
    """
    read = {k: read_coefficient(value, "abcd"[k]) for k, value in enumerate((a, b, c, d))}
    form: list[Any] = list(of_one_kind({(0, 0): read})[0, 0].values())
    p, q, r, s = form
    squares = {(1, 1): {0: -p * r, 1: q, 2: -p}, (1, 2): {0: -p * s}, (2, 2): {0: -q * s, 1: s, 2: -r}}
    products = {pair: {k: v for k, v in row.items() if not is_zero(v)} for pair, row in squares.items()}
    rows: Any = _with_unit(3, {}) | {pair: row for pair, row in products.items() if row}
    return Extension.from_products(3, rows, f"binary cubic ({', '.join(map(str, form))})", check=False)


def normal_form(n: int, k: int) -> Extension:
    """The k-th normal form of local algebras of dimension n, counted from 1; see `normal_forms.normal_forms`.

    Raises:
        ParameterError: n is not in 1..5, or k is not the number of a form.
    """
    from liepoisson.structure.normal_forms import normal_forms

    forms = normal_forms(n)
    if isinstance(k, bool) or not isinstance(k, Integral) or not 1 <= k <= len(forms):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(
            f"there are {len(forms)} normal forms of dimension {n}, counted from 1; got k = {k!r}. "
            f"They are {', '.join(form.name for form in forms)}."
        )
    return forms[k - 1]


EXTENSIONS: dict[str, Callable[..., Extension]] = {
    "trivial": trivial,
    "semidirect": semidirect,
    "leibniz": leibniz,
    "crmhd": crmhd,
    "binary_cubic": binary_cubic,
    "normal_form": normal_form,
}
"""Constructors by the name that system files use."""


def _with_strength(make: Callable[[Coefficient], Extension], given: Parameter, parameter: str, head: str) -> Extension:
    """The extension with this parameter, printed behind the head."""
    strength = read_coefficient(given, parameter)
    extension = make(strength)
    extension.name = f"{head}{parameter} = {strength})" if isinstance(strength, Fraction) else f"{head}{strength})"
    return extension


def _graded(n: int, strength: Coefficient, name: str) -> Extension:
    n = read_field_count(n)
    cocycle: Rows = {(i, j): {i + j: strength} for i in range(1, n) for j in range(i, n) if i + j < n}
    # The products are those of powers of z, or zero: associative, which tests verify.
    products: Any = _with_unit(n, cocycle)
    return Extension.from_products(n, products, name, check=False)


def _with_unit(n: int, products: Rows) -> Rows:
    """Add the unit e_0; leave out products that vanish."""
    unit: Rows = {(0, m): {m: Fraction(1)} for m in range(n)}
    return unit | {pair: row for pair, row in products.items() if not any(is_zero(v) for v in row.values())}
