r"""A Hamiltonian with unknown coefficients: all polynomials of a degree with given symmetries.

A symmetry is a linear change of coordinates $\sigma$ with $H\circ\sigma = H$, such as a change of signs, or a function
F whose flow keeps H, $\{H, F\} = 0$.  Both are linear in the coefficients.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.exact_numbers import is_sympy
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import is_named, listed, named, sequence
from liepoisson.inputs.names import check_name
from liepoisson.inputs.refusals import check_kind, shown
from liepoisson.integrability.derivation import Exponents, n_monomials, of_degree, polynomial_terms
from liepoisson.model.system import System
from liepoisson.report.printing import Formula
from liepoisson.structure.bracket import Bracket

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Exact

Symmetry: TypeAlias = "Mapping[str, str | Expr] | str | Expr"

_MOST_MONOMIALS = 2000
"""Of the polynomials among which those with the symmetries are found."""


@explains_its_arguments
def general_system(
    bracket: Bracket,
    *,
    degree: int | Sequence[int] = 2,
    symmetries: Sequence[Symmetry] = (),
    modulo_casimirs: bool = False,
    letter: str = "h",
    name: str | None = None,
) -> System:
    r"""The system whose Hamiltonian is the general polynomial of a degree with given symmetries.

    Its coefficients are symbols, for `integrable_families`.  The symbol of a term is named by the numbers of its
    coordinates: h12 belongs to $x_1 x_2$.  Where the symmetries tie several terms together, it is named by the first.

    Example:
        >>> turns = [{"l1": "-l1", "l2": "-l2"}, {"l2": "-l2", "l3": "-l3"}]
        >>> lp.integrability.general_system(lp.so(3) @ lp.trivial(), symmetries=turns).hamiltonian
        h11*l1**2 + h22*l2**2 + h33*l3**2

    Args:
        bracket: The bracket.
        degree: The degree of all terms, or several degrees.
        symmetries: Each is a change of coordinates, {"l1": "-l1", "l2": "-l2"}, in which the others stay as they are:
            all are inserted at once, and H must not change; or a function of which the Poisson bracket with H vanishes.
        modulo_casimirs: Leave out as many terms as Casimirs, and their products, can be added to H: they do not change
            the equations of motion.
        letter: What the names of the symbols begin with.
        name: How the system is called.

    Raises:
        ParameterError: no such polynomial is left, a change of coordinates is not linear, or the degree is too large.
        ExpressionError: a text cannot be read.
    """
    check_kind(bracket, Bracket, "bracket", "a Bracket", "write for example so(3) @ semidirect(2)")
    several = listed(degree, "degree")
    degrees = [as_count(d, "degree", least=1) for d in ([degree] if several is None else several)]
    n = len(bracket.variables)
    size = n_monomials(n, max(degrees, default=_MOST_MONOMIALS))
    if size > _MOST_MONOMIALS:
        raise ParameterError(
            f"degree: wanted one or several with at most {_MOST_MONOMIALS:,} monomials; got {shown(degree)}"
            + (f", with {size:,}" if degrees else "")
        )
    monomials = sorted(
        chain.from_iterable(of_degree(n, d) for d in set(degrees)), key=lambda m: (sum(m), *(-k for k in m))
    )
    form = _Form(System(bracket, "0*" + bracket.coordinate_names_in_order[0]), monomials)
    one = isinstance(symmetries, str) or is_named(symmetries) or is_sympy(symmetries)
    wanted = "changes of coordinates or functions"
    given = [symmetries] if one else sequence(symmetries, "symmetries", wanted, '[{"l1": "-l1"}, "l3"]')
    for symmetry in given:
        form.require(cast("Symmetry", symmetry))
    terms = form.terms(form.casimirs(max(degrees)) if modulo_casimirs else ())
    if not terms:
        raise ParameterError(
            "symmetries: wanted some that a polynomial of this degree has which is no Casimir; there is none; take "
            "fewer of them, or another degree"
        )
    letter = check_name(letter, "letter")
    names = [letter + _indices(monomial) for monomial, _ in terms]
    text = " + ".join(f"{symbol}*{_factor(term)}" for symbol, (_, term) in zip(names, terms, strict=True))
    return System(bracket, text, symbols=names, name=name or "general Hamiltonian")


def _factor(term: Expr) -> str:
    text = Formula(term).plain
    return f"({text})" if term.is_Add else text


def _indices(monomial: Exponents) -> str:
    """The numbers of the coordinates of a monomial, from 1: "112" for x1^2 x2."""
    numbers = [str(k + 1) for k, power in enumerate(monomial) for _ in range(power)]
    return ("" if len(monomial) < 10 else "_").join(numbers)


class _Form:
    """Linear combinations of monomials, and equations for their coefficients."""

    def __init__(self, system: System, monomials: list[Exponents]) -> None:
        from sympy import Mul

        self.system, self.monomials = system, monomials
        x = system.variables
        self.products: list[Any] = [Mul(*(v**k for v, k in zip(x, m, strict=True) if k)) for m in monomials]
        self._equations: list[dict[int, Exact]] = []

    def require(self, symmetry: Symmetry) -> None:
        """Add the equations of a symmetry."""
        if is_named(symmetry):
            inserted = self._linear(symmetry)
            changes = [p.xreplace(inserted) - p for p in self.products]
        else:
            function = self.system.expression(cast("str | Expr", symmetry))
            changes = [self.system.bracket(p, function) for p in self.products]
        what = f"symmetry {shown(symmetry)}"
        self._equations += transposed(polynomial_terms(change, self.system.variables, what) for change in changes)

    def _linear(self, symmetry: Mapping[str, str | Expr]) -> dict[Any, Any]:
        names = dict(zip(self.system.component_names, self.system.variables, strict=True))
        inserted: dict[Any, Any] = {}
        for name, text in (named(symmetry, "symmetry") or {}).items():
            image = self.system.expression(text)
            terms = polynomial_terms(image, self.system.variables, f"symmetry {name}")
            if name not in names or any(sum(m) != 1 for m in terms) or not terms:
                raise ParameterError(
                    f"symmetry: wanted coordinates as linear functions of {', '.join(names)}; got {name} = "
                    f"{shown(text)}; write for example {{'{next(iter(names))}': '-{next(iter(names))}'}}"
                )
            inserted[names[name]] = image
        return inserted

    def casimirs(self, degree: int) -> list[Any]:
        """Products of Casimirs up to a degree."""
        from sympy import Poly

        generators = [(Poly(c, *self.system.variables).total_degree(), c) for c in self.system.bracket.casimirs()]
        found: list[tuple[int, Any]] = [(0, 1)]
        for d, c in generators:
            found = [
                (total + power * d, product * c**power)
                for total, product in found
                for power in range((degree - total) // d + 1)
            ]
        return [product for total, product in found if total]

    def terms(self, without: Iterable[Any] = ()) -> list[tuple[Exponents, Expr]]:
        """A basis of the polynomials with the symmetries, each with its first monomial, modulo other polynomials."""
        places = {m: k for k, m in enumerate(self.monomials)}
        read = [polynomial_terms(c, self.system.variables, "a Casimir") for c in without]
        others = [{places[m]: v for m, v in terms.items()} for terms in read if terms.keys() <= places.keys()]
        values = [v for row in (*self._equations, *others) for v in row.values()]
        field = Coefficients.containing(values)
        rows, left_out = (
            [{k: field.read(v) for k, v in row.items()} for row in part] for part in (self._equations, others)
        )
        basis, dropped = Echelon(field), Echelon(field)
        for vector in nullspace(rows, len(self.monomials), field).vectors:
            basis.insert(vector)
        for row in left_out:
            if not basis.reduce(row):
                dropped.insert(row)
        return [
            (
                self.monomials[min(row)],
                cast("Any", sum(field.to_sympy(v) * self.products[k] for k, v in row.items())),
            )
            for row in basis.basis()
            if min(row) not in dropped.rows
        ]
