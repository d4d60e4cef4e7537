r"""Recognising vector algebra in expressions: $|\alpha|^2$, $\ell\cdot\beta$, $\ell\cdot I^{-1}\ell$, $a\cdot\alpha$.

An expression in components is sorted by its degree in each field, each part is compared with the invariants that it
could be, and the result is expanded and compared with what was given: a formula is printed in vector notation only if
it is the same expression, and in components otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import as_expression, is_zero, to_sympy
from liepoisson.errors import UnknownNameError, did_you_mean
from liepoisson.formula.styles import LATEX, PLAIN, UNICODE, split_name
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.report.lines import Equation
from liepoisson.report.printing import Atom, Dot, Form, Formula, Shifted, Square, Triple

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.lie_algebra import LieAlgebra

_QUADRATIC = 2
_MOST_TERMS = 2000
"""Longer expressions are printed as they are: nobody would read them, and looking for invariants takes time."""

_MOST_FACTORED = 50
"""Coefficients with more terms are not factored."""


def invariant_metric(algebra: LieAlgebra) -> tuple[int, ...] | None:
    r"""The signs $\eta_i$ of a diagonal invariant form, or None if the Killing form is not such a form.

    For so(n) in the usual basis all are 1, for so(2,1) they are (1, 1, -1): $u\cdot v = \sum_i \eta_i u_i v_i$ is then
    constant under the coadjoint action.  Found from the Killing form $\mathrm{tr}(\mathrm{ad}_i\,\mathrm{ad}_j)$.
    """
    killing = algebra.killing_form()
    n = len(killing)
    if is_zero(killing[0][0]) or any(killing[i][j] != 0 for i, j in product(range(n), repeat=2) if i != j):
        return None
    signs = [to_sympy(killing[i][i]) / to_sympy(killing[0][0]) for i in range(n)]
    return tuple(int(sign) for sign in signs) if all(sign in (1, -1) for sign in signs) else None


_STYLES = {"plain": PLAIN, "unicode": UNICODE, "latex": LATEX}


@explains_its_arguments
def vector_notation(
    function: Expr,
    bracket: Bracket,
    *,
    style: str = "unicode",
    in_vectors: bool = True,
    most_terms: int | None = None,
) -> str:
    r"""A function on the phase space of a bracket as text, in vector notation where it is recognised.

    Example:
        >>> bracket = lp.so(3) @ lp.leibniz(3, "epsilon")
        >>> [lp.systems.vector_notation(casimir, bracket) for casimir in bracket.casimirs()]
        ['|α|² + 2ε l·β', 'α·β', '|β|²']

    Args:
        function: An expression of SymPy in the coordinates of the bracket.
        bracket: The bracket.
        style: "plain" in ASCII, "unicode" or "latex".
        in_vectors: Whether vectors are looked for, which takes long in expressions of hundreds of terms; or the
            function is written in components.
        most_terms: Of a longer sum so many terms are written, and the others counted.

    Raises:
        ParameterError: it is no expression, or no bracket.
        UnknownNameError: there is no such style.
    """
    if not hasattr(bracket, "coordinate_names_in_order"):
        raise not_a("a bracket", bracket, "bracket", "try system.bracket")
    if style not in _STYLES:
        hint = did_you_mean(str(style), _STYLES)
        raise UnknownNameError(f"style: wanted one of {', '.join(_STYLES)}; got {shown(style)}. {hint}".strip())
    notation = VectorNotation(bracket)
    write = notation.formula if in_vectors else notation.components
    return write(as_expression(function, "function")).write(_STYLES[style], most_terms)


class VectorNotation:
    """Writes expressions on one phase space in vector notation where it can."""

    def __init__(self, bracket: Bracket) -> None:
        self.algebra = bracket.algebra if bracket.has_algebra else None
        self.n = bracket.field_lengths[0]
        self.field_names: tuple[str, ...] = tuple(bracket.fields)
        self.fields: dict[str, list[Any]] = {name: list(column) for name, column in bracket.fields.items()}
        self.variables: tuple[Any, ...] = bracket.variables
        self.places = {variable: divmod(k, self.n) for k, variable in enumerate(self.variables)}
        bases = ("",) if self.algebra is None else self.algebra.basis_names
        self.coordinates = {
            str(variable): (self.field_names[f], bases[i]) for variable, (f, i) in self.places.items() if bases[i]
        }

    @cached_property
    def metric(self) -> tuple[int, ...] | None:
        """The signs of the scalar product of two fields, if there is one."""
        return None if self.algebra is None else invariant_metric(self.algebra)

    @property
    def is_euclidean(self) -> bool:
        """Whether all signs of the scalar product are positive."""
        return self.metric is not None and min(self.metric) == 1

    def formula(self, expression: Expr) -> Formula:
        """The expression in vector notation as far as it is recognised, exactly equal to what was given."""
        from liepoisson.structure.trace import traces_in

        if traces_in(expression):
            return self.components(expression)
        recognised = _Recognition(self, expression)
        rewritten = recognised.rewrite(expression)
        if not recognised.atoms or not self._same(rewritten, recognised.meanings, expression):
            return self.components(expression)
        return Formula(rewritten, recognised.atoms, self.coordinates)

    def definitions(self, formulas: Iterable[Formula]) -> list[Equation]:
        r"""What $u\cdot v$ and $|u|^2$ are, if one of the formulas has them and they are not the usual ones."""
        kinds = {type(atom) for formula in formulas for atom in formula.atoms.values()}
        if self.metric is None or self.is_euclidean or not kinds & {Dot, Square}:
            return []
        from sympy import symbols

        u, v = (symbols(f"{name}1:{self.n + 1}") for name in "uv")
        found = [Equation(_scalar(Dot("u", "v")), Formula(_paired(u, v, self.metric)))]
        return found + ([Equation(_scalar(Square("u")), _scalar(Dot("u", "u")))] if Square in kinds else [])

    def meaning(self, atom: Atom, expression: Expr) -> Expr:
        """What a scalar in the formula of an expression is in components."""
        return _Recognition(self, expression).meaning(atom)

    def components(self, expression: Expr) -> Formula:
        """The expression as it is, in components."""
        return Formula(expression, {}, self.coordinates)

    def parameter_vectors(self, expression: Expr) -> dict[str, list[Any]]:
        """Parameters that are components 1 to n of a vector and all occur: a1, a2, a3 are the vector a.

        Where fields are single coordinates there are none: k1 is no vector k.
        """
        if self.n < 2:
            return {}
        names = {str(symbol): symbol for symbol in expression.free_symbols if symbol not in self.places}
        stems = sorted({split_name(name)[0] for name in names})
        wanted = {stem: [f"{stem}{i + 1}" for i in range(self.n)] for stem in stems if stem not in self.fields}
        return {stem: [names[name] for name in row] for stem, row in wanted.items() if set(row) <= set(names)}

    def vectors(self, expression: Expr) -> dict[str, list[Any]]:
        """The fields and the vectors of parameters in the expression, in components."""
        return {**self.parameter_vectors(expression), **self.fields}

    def parameter_matrices(self, expression: Expr) -> dict[str, list[list[Any]]]:
        """Parameters that are the entries of a matrix and all occur, A11, A12, ...; of a symmetric one A21 need not."""
        names = {str(symbol): symbol for symbol in expression.free_symbols if symbol not in self.places}
        stems = sorted({split_name(name)[0] for name in names})
        found: dict[str, list[list[Any]]] = {}
        for stem in stems if 1 < self.n < 10 else ():  # with ten columns, A111 may be (1, 11) or (11, 1)
            upper = {(i, j): f"{stem}{i + 1}{j + 1}" for i, j in product(range(self.n), repeat=2)}
            if stem not in self.fields and all(upper[i, j] in names for i, j in upper if i <= j):
                rows = [
                    [names.get(upper[i, j], names[upper[min(i, j), max(i, j)]]) for j in range(self.n)]
                    for i in range(self.n)
                ]
                found[stem] = rows
        return found

    def _same(self, rewritten: Expr, meanings: Mapping[Any, Expr], expression: Expr) -> bool:
        return is_zero(cast("Expr", rewritten.xreplace(dict(meanings))).expand() - expression.expand())


class _Recognition:
    """The formal symbols of one formula, made as they are needed."""

    def __init__(self, notation: VectorNotation, expression: Expr) -> None:
        self.notation = notation
        self.atoms: dict[Symbol, Atom] = {}
        self.meanings: dict[Any, Expr] = {}
        self._symbols: dict[Atom, Any] = {}
        self._vectors = notation.parameter_vectors(expression)
        self._matrices = notation.parameter_matrices(expression)

    def rewrite(self, expression: Expr) -> Expr:
        """The expression in formal symbols: a polynomial by its parts, anything else by its arguments."""
        from sympy import Add, Poly, PolynomialError, total_degree

        variables = [variable for variable in self.notation.variables if expression.has(variable)]
        if len(variables) < 2:
            return expression
        try:
            terms = Poly(expression, *variables).terms()
        except PolynomialError:
            terms = []
        if terms and len(terms) <= _MOST_TERMS:
            places = [self.notation.places[variable] for variable in variables]
            found = self._polynomial([_term(powers, coefficient, places) for powers, coefficient in terms])
            if found is not None:
                return found
        if expression.is_Add:
            parts: list[Any] = list(expression.args)
            polynomial = [part for part in parts if part.is_polynomial(*variables)]
            rest = [part for part in parts if part not in polynomial]
            if not rest:  # something of a high degree was not recognised; the rest may be
                rest = [part for part in parts if total_degree(part, *variables) > _QUADRATIC]
                polynomial = [part for part in parts if part not in rest]
            if polynomial and rest:
                return self.rewrite(Add(*polynomial)) + self.rewrite(Add(*rest))
        if expression.is_Add or expression.is_Mul or expression.is_Pow or expression.is_Function:
            return expression.func(*[self.rewrite(cast("Any", part)) for part in expression.args])
        return expression

    def _polynomial(self, terms: list[tuple[tuple[tuple[int, int], ...], Expr]]) -> Expr | None:
        """The sum of the parts of each degree in the fields, or None if one of degree above two is not recognised."""
        from sympy import S

        blocks: dict[tuple[int, ...], dict[tuple[int, ...], Expr]] = {}
        for factors, coefficient in terms:
            fields = tuple(field for field, _ in factors)
            blocks.setdefault(fields, {})[tuple(i for _, i in factors)] = coefficient
        total = S.Zero
        for fields, entries in blocks.items():
            part = self._part(fields, entries)
            if part is None and len(fields) > 2:
                return None
            total += self._in_components(fields, entries) if part is None else part
        return self._with_squares_completed(total)

    def _with_squares_completed(self, total: Any) -> Any:
        r"""The sum with $k(|x|^2 \pm 2 r\cdot x + |r|^2)$ written as $k|x \pm r|^2$, for parameter vectors r."""
        for name, field in product(self._vectors, self.notation.field_names if self.notation.is_euclidean else ()):
            dot, square = self._symbols.get(Dot(name, field)), self._symbols.get(Square(field))
            if dot is None or square is None:
                continue
            weight = total.coeff(square)
            sign = (total.coeff(dot) / (2 * weight)).cancel() if weight != 0 else 0
            if sign not in (1, -1):
                continue
            shifted = Square(Shifted(field, int(sign), name))
            length = sum(r**2 for r in self._vectors[name])
            rest = (total - weight * (square + 2 * sign * dot + length)).expand()
            if not rest.has(*self._vectors[name], dot, square):
                total = rest + weight * self.symbol(shifted)
        return total

    def _part(self, fields: tuple[int, ...], entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        match len(fields):
            case 1:
                return self._linear(fields[0], entries)
            case 2:
                return self._quadratic(fields, entries)
            case 3:
                return self._triple(fields, entries)
            case _:
                return None

    def _in_components(self, fields: tuple[int, ...], entries: Mapping[tuple[int, ...], Expr]) -> Expr:
        from sympy import Mul, S

        variables = self.notation.variables
        n = self.notation.n
        return sum(
            (
                _factored(c) * Mul(*[variables[f * n + i] for f, i in zip(fields, place, strict=True)])
                for place, c in entries.items()
            ),
            S.Zero,
        )

    def _linear(self, field: int, entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        r"""$k\,a\cdot x$, $k\,a\cdot D^{\pm1}x$ and the rest, for parameter vectors a and diagonal matrices D.

        A parameter vector lies in the algebra and a field in its dual.  If fields have a scalar product with signs,
        this pairing without signs has no other sign than the same dot, and stays in components.
        """
        from sympy import S

        if self.notation.metric is not None and not self.notation.is_euclidean:
            return None
        row: list[Any] = [entries.get((i,), S.Zero).expand() for i in range(self.notation.n)]
        total = S.Zero
        for name, vector in self._vectors.items():
            slopes = [c.coeff(component) for c, component in zip(row, vector, strict=True)]
            factor, atom = self._linear_form(name, slopes, self.notation.field_names[field])
            rest = [(c - d * a).expand() for c, d, a in zip(row, slopes, vector, strict=True)]
            if atom is not None and not any(c.has(*vector) for c in rest):
                row = rest
                total += factor * self.symbol(atom)
        if total == 0:
            return None
        return total + self._in_components((field,), {(i,): c for i, c in enumerate(row) if c != 0})

    def _linear_form(self, name: str, slopes: Sequence[Any], field: str) -> tuple[Any, Atom | None]:
        if 0 in slopes:
            return 0, None
        if len(set(slopes)) == 1:
            return slopes[0], None if slopes[0].has(*self._vectors[name]) else Dot(name, field)
        for (matrix, entries), power in product(self._vectors.items(), (1, -1)):
            factors = {(d / entry**power).cancel() for d, entry in zip(slopes, entries, strict=True)}
            if len(factors) == 1 and matrix != name:
                return factors.pop(), Form(name, matrix, power, field)
        return 0, None

    def _quadratic(self, fields: tuple[int, ...], entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        """A multiple of u.v, of a form with diagonal matrix, or of a triple product with a parameter vector."""
        from sympy import S

        u, v = (self.notation.field_names[field] for field in fields)
        n, metric = self.notation.n, self.notation.metric
        diagonal = [entries.get((i, i), S.Zero) for i in range(n)]
        if (full := self._full_form(u, v, entries)) is not None:
            return full
        if any(i != j for i, j in entries):
            return self._axial(u, v, entries) if u != v and n == 3 and self.notation.is_euclidean else None
        if metric is not None and all(
            (c - s * metric[0] * diagonal[0]).expand() == 0 for c, s in zip(diagonal, metric, strict=True)
        ):
            return diagonal[0] * metric[0] * self.symbol(Square(u) if u == v else Dot(u, v))
        if not self.notation.is_euclidean:
            return None
        for (name, vector), power in product(self._vectors.items(), (1, -1)):
            factors = [(c / component**power).cancel() for c, component in zip(diagonal, vector, strict=True)]
            if len(set(factors)) == 1 and not factors[0].has(*vector):
                return factors[0] * self.symbol(Form(u, name, power, v))
        return None

    def _full_form(self, u: str, v: str, entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        r"""$k\,u\cdot A v$ with a matrix A of parameters that need not be diagonal."""
        from sympy import S

        places = list(product(range(self.notation.n), repeat=2))
        for name, A in self._matrices.items() if self.notation.is_euclidean else ():
            factor = (entries.get((0, 0), S.Zero) / A[0][0]).cancel()
            if factor == 0 or factor.has(*(symbol for row in A for symbol in row)):
                continue
            for first, second in ((u, v), (v, u)):
                M = A if first == u else [list(column) for column in zip(*A, strict=True)]
                wanted = {(i, j): factor * M[i][j] for i, j in places}
                if u == v:  # x1 x2 and x2 x1 are one monomial
                    wanted = {(i, j): wanted[i, j] + (wanted[j, i] if i < j else 0) for i, j in places if i <= j}
                if all((entries.get(place, S.Zero) - c).expand() == 0 for place, c in wanted.items()):
                    return factor * self.symbol(Form(first, name, 1, second))
        return None

    def _axial(self, u: str, v: str, entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        r"""$k\,a\cdot(u\times v)$."""
        from sympy import LeviCivita, S

        for name, vector in self._vectors.items():
            factor = entries.get((0, 1), S.Zero).expand().coeff(vector[2])
            expected = {
                (i, j): sum((factor * LeviCivita(i, j, k) * vector[k] for k in range(3)), S.Zero)
                for i, j in product(range(3), repeat=2)
            }
            if factor != 0 and all((c - entries.get(p, S.Zero)).expand() == 0 for p, c in expected.items()):
                return factor * self.symbol(Triple(name, u, v))
        return None

    def _triple(self, fields: tuple[int, ...], entries: Mapping[tuple[int, ...], Expr]) -> Expr | None:
        r"""$k\,u\cdot(v\times w)$, in three dimensions."""
        from sympy import LeviCivita, S

        if self.notation.n != 3 or not self.notation.is_euclidean or len(set(fields)) < 3:
            return None
        factor = entries.get((0, 1, 2), S.Zero)
        if any(
            (entries.get(place, S.Zero) - factor * LeviCivita(*place)).expand() != 0
            for place in product(range(3), repeat=3)
        ):
            return None
        u, v, w = (self.notation.field_names[field] for field in fields)
        return factor * self.symbol(Triple(u, v, w))

    def symbol(self, atom: Atom) -> Any:
        """The formal symbol of a vector expression."""
        from sympy import Dummy

        if atom not in self._symbols:
            symbol = Dummy(type(atom).__name__)
            self._symbols[atom] = symbol
            self.atoms[symbol] = atom
            self.meanings[symbol] = self.meaning(atom)
        return self._symbols[atom]

    def meaning(self, atom: Atom) -> Expr:
        """What the vector expression is in components."""
        from sympy import LeviCivita, S

        vectors = {**self._vectors, **self.notation.fields}
        ones = self.notation.metric or (1,) * self.notation.n
        match atom:
            case Square(str(u)):
                return _paired(vectors[u], vectors[u], ones)
            case Dot(str(u), str(v)):
                both = u in self.notation.fields and v in self.notation.fields  # see _linear
                return _paired(vectors[u], vectors[v], ones if both else (1,) * len(ones))
            case Square(Shifted(x, sign, r)):
                moved = [c + sign * s for c, s in zip(vectors[x], vectors[r], strict=True)]
                return _paired(moved, moved, ones)
            case Form(str(u), matrix, 1, str(v)) if matrix in self._matrices:
                rows = self._matrices[matrix]
                return _paired(vectors[u], [_paired(row, vectors[v], ones) for row in rows], ones)
            case Form(str(u), matrix, power, str(v)):
                return _paired(vectors[u], vectors[v], [entry**power for entry in vectors[matrix]])
            case Triple(str(u), str(v), str(w)):
                rows = (vectors[name] for name in (u, v, w))
                a, b, c = rows
                return sum(
                    (LeviCivita(i, j, k) * a[i] * b[j] * c[k] for i, j, k in product(range(3), repeat=3)), S.Zero
                )
            case _:
                raise AssertionError(f"{atom} is not a scalar")


def _term(
    powers: Sequence[int], coefficient: Expr, places: Sequence[tuple[int, int]]
) -> tuple[tuple[tuple[int, int], ...], Expr]:
    """The factors of a monomial, each (field, component) repeated by its power, and the coefficient."""
    return tuple(place for place, power in zip(places, powers, strict=True) for _ in range(power)), coefficient


def _factored(coefficient: Expr) -> Expr:
    """A sum that is a product, as one: as a coefficient it was expanded."""
    from sympy import factor

    if not coefficient.is_Add or len(coefficient.args) > _MOST_FACTORED:
        return coefficient
    product_form: Any = factor(coefficient)
    return product_form if product_form.is_Mul or product_form.is_Pow else coefficient


def _scalar(atom: Atom) -> Formula:
    """A vector expression by itself."""
    from sympy import Dummy

    symbol: Any = Dummy()
    return Formula(symbol, {symbol: atom})


def _paired(u: Sequence[Any], v: Sequence[Any], weights: Sequence[Any]) -> Expr:
    from sympy import S

    return sum((w * a * b for a, b, w in zip(u, v, weights, strict=True)), S.Zero)
