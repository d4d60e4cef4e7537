r"""The bracket of invariants of a symmetry, $\{f_a, f_b\} = P_{ab}(f)$: Poisson reduction.

Functions that a group leaves invariant have brackets that it leaves invariant; where the functions generate all
invariants, these are functions of them.  With new variables y the ideal of $y_a - f_a(x)$ has a Gröbner basis in
lexicographic order, x first: a polynomial g(x) is one in f if and only if its normal form has no x left, and then the
normal form is it; the elements of the basis without x generate all relations between the $f_a$.  A denominator d gets a
variable t with t d = 1, and stays in the result where d is a polynomial in f.

Values of a momentum map, functions that commute with all invariants, are further variables y; they are parameters of
the result.

References: [cox2015], section 7.3; [marsden1999], section 10.5; Cushman and Bates, Global Aspects of Classical
Integrable Systems (2015), appendix B.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.algebra.ideals.components import irreducible_factors
from liepoisson.algebra.ideals.groebner import GroebnerBasis, groebner_basis, rational_context
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import in_context
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.errors import BracketError, JacobiError, ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import by_name
from liepoisson.inputs.names import check_name
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.circles import angles_among
from liepoisson.structure.given_functions import read_function, read_variables, scope_of
from liepoisson.structure.tensor_bracket import PoissonTensor, tensor_of
from liepoisson.structure.tensor_sources import known_casimirs

if TYPE_CHECKING:
    from sympy import Expr


def in_invariants(
    bracket: Bracket, invariants: Mapping[str, str | Expr], *, levels: Mapping[str, str | Expr] | None
) -> PoissonTensor:
    """The bracket of some functions; see `Bracket.in_invariants`."""
    bracket.check_without_time("a bracket of invariants")
    scope = scope_of(bracket.coordinate_names_in_order, bracket.symbols, ())
    given = by_name(invariants, "invariants", "functions of the coordinates", '{"r": "q1^2 + q2^2"}')
    names = read_variables(list(given))
    values = {} if levels is None else by_name(levels, "levels", "functions", '{"L": "q1*p2 - q2*p1"}')
    named = tuple(check_name(name, "the name of a level") for name in values)
    if clash := {*named} & {*names} | ({*named, *names} & bracket.symbols):
        raise BracketError(f"a name must stand for one thing; {min(clash)} is given twice. Choose another one.")
    functions = {name: read_function(given[name], scope, name) for name in names}
    momenta = {name: read_function(values[name], scope, name) for name in named}
    _check_levels(bracket, functions, momenta)
    angles = angles_among(functions, bracket.angle_variables)
    everything = [*momenta.items(), *functions.items()]
    try:
        made, ring = _closed(bracket, functions, dict(everything), None)
        candidates = [*ring.relations(), *_images(bracket, ring)]
    except NotDecidedError as error:
        raise BracketError(f"whether the brackets of the invariants are functions of them was {error}") from error
    made, casimirs = made.with_angles(angles), list[Any]()
    for candidate in candidates:
        own = candidate.free_symbols & {*made.variables}
        if own and not made.formulas.image(candidate):
            casimirs += [candidate] if made.formulas.n_independent([*casimirs, candidate]) > len(casimirs) else []
    made.given_casimirs = tuple(casimirs)
    return made


def _closed(
    bracket: Bracket, functions: Mapping[str, Expr], everything: Mapping[str, Expr], before: JacobiError | None
) -> tuple[PoissonTensor, _Ring]:
    """The tensor with its ring.

    Where relations hold the entries are not unique, and only there need they obey the Jacobi identity. The order of the
    variables says which are taken: levels first, so that powers of them are replaced, and then the other way round.

    Raises:
        BracketError: a bracket is no function of the invariants, or the identity holds in neither order.
    """
    ring = _Ring.of(bracket, everything)
    try:
        return tensor_of(tuple(functions), dict(_entries(bracket, functions, ring))), ring
    except JacobiError as error:
        if before is None and ring.relations():
            return _closed(bracket, functions, dict(reversed(list(everything.items()))), error)
        relations = ", ".join(f"{relation} = 0" for relation in ring.relations())
        raise BracketError(
            f"the brackets of the invariants obey the Jacobi identity only where {relations or 'they are invariants'}; "
            f"elsewhere the cyclic sum for ({', '.join(error.triple)}) is {error.residual:.100}. Leave out an "
            "invariant that is a function of the others."
        ) from error


def _check_levels(bracket: Bracket, functions: Mapping[str, Expr], momenta: Mapping[str, Expr]) -> None:
    for name, level in momenta.items():
        for other, function in {**functions, **momenta}.items():
            if not is_zero(found := bracket(level, function)):
                raise BracketError(
                    f"a level must have the bracket 0 with all invariants and levels; that of {name} and {other} is "
                    f"{found!s:.80}. Give it as an invariant, or correct one of them."
                )


def _entries(bracket: Bracket, functions: Mapping[str, Expr], ring: _Ring) -> Iterator[tuple[tuple[int, int], Any]]:
    listed = list(functions.items())
    for a, (first, f) in enumerate(listed):
        for b, (second, g) in enumerate(listed[a + 1 :], a + 1):
            checkpoint("brackets of invariants")
            if is_zero(found := bracket(f, g)):
                continue
            if (image := ring.image(found)) is None:
                raise BracketError(
                    f"the brackets of the invariants must be functions of them; {{{first}, {second}}} = "
                    f"{found!s:.120} is no polynomial in them, nor in their quotients. Add it, or an invariant that is "
                    "missing."
                )
            yield (a, b), image


def _images(bracket: Bracket, ring: _Ring) -> Iterator[Any]:
    """The Casimirs of the bracket that are functions of the invariants."""
    for casimir in known_casimirs(bracket):
        try:
            image = ring.image(casimir)
        except ParameterError:  # no rational function
            continue
        if image is not None:
            yield image


@dataclass(frozen=True)
class _Ring:
    """The polynomials in the coordinates and in new variables, modulo what the latter stand for.

    Attributes:
        basis: The Gröbner basis.
        kept: The names of the new variables and what they are called: invariants, levels, parameters.
        inverses: The variables that stand for one over a polynomial, with it and, where this is one in the invariants,
            its image.
    """

    basis: GroebnerBasis
    kept: Mapping[str, str]
    inverses: Mapping[str, tuple[Any, Any | None]]

    @classmethod
    def of(cls, bracket: Bracket, functions: Mapping[str, Expr]) -> _Ring:
        """The ring of invariants and levels, by their names."""
        x, parameters = bracket.coordinate_names_in_order, sorted(bracket.symbols)
        plain = rational_context([*x, *parameters])
        everything: list[Any] = list(functions.values())
        read = [_fraction(f, plain) for f in everything]
        brackets = [_fraction(bracket(f, g), plain) for k, f in enumerate(everything) for g in everything[:k]]
        factors = {str(q): q for _, denominator in (*read, *brackets) for q in irreducible_factors(denominator)}
        new = [f"y_{k}" for k in range(len(everything))]
        inverses = {f"t_{k}": q for k, q in enumerate(factors.values())}
        while {*new, *inverses} & {*x, *parameters}:
            new, inverses = [f"_{y}" for y in new], {f"_{t}": q for t, q in inverses.items()}
        kept = dict(zip([*new, *parameters], [*functions, *parameters], strict=True))

        def basis_of(order: Sequence[str]) -> GroebnerBasis:
            context = rational_context([*order, *new, *parameters], lexicographic=True)
            gens = dict(zip(context.names(), context.gens(), strict=True))
            equations = [
                gens[y] * in_context(d, context) - in_context(n, context) for y, (n, d) in zip(new, read, strict=True)
            ]
            equations += [gens[t] * in_context(q, context) - 1 for t, q in inverses.items()]
            return groebner_basis(equations, Limits())

        first = cls(basis_of([*x, *inverses]), kept, dict.fromkeys(inverses, (None, None)))
        known = {t: first._kept_form(in_context(q, first.basis.context)) for t, q in inverses.items()}
        inside = [t for t in inverses if known[t] is not None]
        if not inside:
            return cls(first.basis, kept, {t: (q, None) for t, q in inverses.items()})
        order = [*x, *(t for t in inverses if t not in inside), *inside]
        return cls(basis_of(order), kept, {t: (q, known[t]) for t, q in inverses.items()})

    def image(self, function: Any) -> Any | None:
        """The function as one of the invariants, levels and parameters; None if it is none.

        Raises:
            ParameterError: it is no rational function with rational coefficients.
        """
        context = self.basis.context
        numerator, denominator = (in_context(p, context) for p in _fraction(function, self._plain))
        gens = dict(zip(context.names(), context.gens(), strict=True))
        for t, (q, _) in self.inverses.items():
            factor = in_context(q, context)
            while not denominator.is_constant():
                quotient, remainder = divmod(denominator, factor)
                if remainder:
                    break
                numerator, denominator = numerator * gens[t], quotient
        if not denominator.is_constant():
            return None
        return self._kept_form(numerator / denominator.leading_coefficient())

    @property
    def _plain(self) -> Any:
        new = {y for y, name in self.kept.items() if y != name} | {*self.inverses}
        return rational_context([name for name in self.basis.names if name not in new])

    def relations(self) -> list[Any]:
        """The relations between the invariants."""
        found = (self._written(p) for p in self.basis.polynomials if self._occurring(p) <= {*self.kept})
        return [p for p in found if p is not None]

    def _occurring(self, p: Any) -> set[str]:
        return {name for name, power in zip(self.basis.names, p.degrees(), strict=True) if power}

    def _kept_form(self, p: Any) -> Any | None:
        """The normal form in the names of the result; None if coordinates are left."""
        form = self.basis.remainder(p)
        inside = {t for t, (_, image) in self.inverses.items() if image is not None}
        return self._written(form) if self._occurring(form) <= {*self.kept} | inside else None

    def _written(self, p: Any) -> Any:
        from sympy import Add, Mul, Rational, Symbol

        by_place: list[Any] = [
            Symbol(self.kept[name]) if name in self.kept else 1 / cast("Any", self.inverses[name][1])
            if name in self.inverses and self.inverses[name][1] is not None else None
            for name in self.basis.names
        ]  # fmt: skip
        terms = [
            Mul(Rational(int(c.p), int(c.q)), *(by_place[k] ** int(power) for k, power in enumerate(m) if power))
            for m, c in p.terms()
        ]
        total: Any = Add(*terms)
        return total.cancel() if self.inverses else total


def _fraction(function: Any, context: Any) -> tuple[Any, Any]:
    """Numerator and denominator.

    Raises:
        ParameterError: it is no rational function with rational coefficients.
    """
    from sympy import fraction, together

    numerator, denominator = fraction(together(function))
    try:
        return polynomial(numerator, context), polynomial(denominator, context)
    except ParameterError as error:
        raise ParameterError(
            f"invariants, levels and their brackets must be rational functions with rational coefficients; got "
            f"{function!s:.80}. Take others, such as the square of a root."
        ) from error
