r"""Traces of products of matrices of coordinates, $\operatorname{tr}(X Y \cdots)$: SymPy expressions that stay traces.

Expanded, $\operatorname{tr} X^7$ in 48 coordinates has millions of terms.  A `Trace` is one function of its
coordinates: it is differentiated and evaluated by products of matrices, printed as "tr(X^7)", and written out only by
`expression.expand(trace=True)`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakValueDictionary

from sympy import AtomicExpr, Function, Integer, Rational, Tuple
from sympy.core.symbol import Str

from liepoisson.algebra.exact_numbers import as_expression
from liepoisson.structure.lie.defining_matrices import DefiningMatrices, Entries, sparse_product
from liepoisson.structure.trace_words import Word, canonical, chain

if TYPE_CHECKING:
    import numpy as np

    from liepoisson.inputs.arrays import Array

_KNOWN: WeakValueDictionary[str, MatrixMap] = WeakValueDictionary()


@dataclass(frozen=True)
class _Data:
    """What defines a map: the matrices F^k, and the number that tells summands of an algebra apart (0: no sum)."""

    matrices: tuple[tuple[tuple[tuple[int, int], Any], ...], ...]
    size: int
    order: int
    copies: int
    number: int


class MatrixMap(AtomicExpr):
    r"""The linear map from coordinates to matrices, $x \mapsto X = \sum_k x_k F^k$."""

    data: _Data
    key: str

    def __new__(cls, data: _Data) -> MatrixMap:
        """The map with these matrices."""
        made = cast("Any", AtomicExpr.__new__(cls))
        made.data = data
        made.key = hashlib.sha256(repr(data).encode()).hexdigest()[:24]
        return _KNOWN.setdefault(made.key, made)

    @classmethod
    def of(cls, given: DefiningMatrices, number: int = 0) -> MatrixMap:
        """The map of the matrices of a Lie algebra, of its summand with this number if it is a sum."""
        matrices = tuple(tuple(sorted(matrix.items())) for matrix in given.matrices)
        return cls(_Data(matrices, given.size, given.order, given.copies, number))

    def __getnewargs__(self) -> Any:
        """What it is pickled as."""
        return (self.data,)

    def _hashable_content(self) -> Any:
        return (self.key,)

    def _sympystr(self, _printer: Any) -> str:
        return f"X{self.data.number or ''}"

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.data.matrices)

    @cached_property
    def entries(self) -> tuple[Entries, ...]:
        """The F^k by their nonzero entries."""
        return tuple(map(dict, self.data.matrices))

    @cached_property
    def arrays(self) -> Array | np.ndarray[Any, np.dtype[np.complex128]]:
        """The F^k as an array, shape (coordinate, row, column), real if they are."""
        import numpy as np

        from liepoisson.portable import elementary

        m, order = self.data.size, self.data.order
        arrays = np.zeros((self.dimension, m, m), dtype=np.complex128)
        for k, matrix in enumerate(self.entries):
            for place, roots in matrix.items():
                arrays[k][place] = sum(float(q) * elementary.exp(2j * np.pi * a / order) for q, a in roots)
        return arrays.real.copy() if order == 1 else arrays

    def matrix(self, coordinates: Any) -> Any:
        """X for coordinates of shape (..., coordinate), shape (..., row, column)."""
        from liepoisson.portable import linear

        m = self.data.size
        flat = linear.matmul(coordinates, self.arrays.reshape(self.dimension, m * m))
        return flat.reshape(*coordinates.shape[:-1], m, m)


class Trace(Function):
    r"""The trace of a product of matrices $X_f = \sum_k x_{fk} F^k$ of some fields f, and of constant matrices $F^k$.

    Its arguments are the map, the names of the fields, the word and the coordinates, field by field.  A letter f of the
    word stands for the matrix of the field number f, and -1-k for $F^k$.  Cyclic rotations of a word are one trace.
    Each derivative is a trace again.  With rational numbers for all coordinates and rational $F^k$ it is a number.
    """

    is_commutative = True
    is_trace = True

    def __new__(cls, matrices: Any, fields: Any, word: Any, *coordinates: Any) -> Any:
        """The trace, or its value where the coordinates are numbers."""
        from sympy import S

        letters = canonical(tuple(int(letter) for letter in word))
        values: list[Any] = [as_expression(c, "a coordinate") for c in coordinates]
        d = matrices.dimension
        if any(not any(values[f * d : (f + 1) * d]) for f in set(letters) if f >= 0):
            return S.Zero
        if matrices.data.order == 1 and all(value.is_Rational for value in values):
            return _rational_value(matrices, letters, values)
        names = fields if isinstance(fields, Tuple) else Tuple(*map(Str, fields))
        return Function.__new__(cls, matrices, names, Tuple(*map(Integer, letters)), *values, evaluate=False)

    @property
    def word(self) -> Word:
        """The letters."""
        return tuple(int(letter) for letter in cast("Any", self.args[2]))

    @property
    def matrices(self) -> MatrixMap:
        """The map from coordinates to matrices."""
        return cast("MatrixMap", self.args[0])

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields in the word."""
        return tuple(str(name) for name in cast("Any", self.args[1]))

    @property
    def coordinates(self) -> tuple[Any, ...]:
        """The arguments that are coordinates, field by field."""
        return self.args[3:]

    def fdiff(self, argindex: int = 1) -> Any:
        """The derivative along a coordinate: the sum over its places in the word."""
        from sympy import Add, S

        field, k = divmod(argindex - 4, self.matrices.dimension)
        if argindex < 4:
            return S.Zero
        word = self.word
        replaced = [(*word[:s], -1 - k, *word[s + 1 :]) for s, letter in enumerate(word) if letter == field]
        return Add(*(Trace(self.args[0], self.args[1], other, *self.coordinates) for other in replaced))

    def _eval_derivative(self, s: Any) -> Any:
        from sympy import Add

        terms = ((n, c.diff(s)) for n, c in enumerate(self.coordinates, start=4) if c.has(s))
        return Add(*(self.fdiff(n) * slope for n, slope in terms))

    def _eval_is_real(self) -> bool | None:
        return True if all(c.is_real for c in self.coordinates) else None

    def _eval_evalf(self, prec: int) -> Any:
        from mpmath import workprec
        from sympy import Float

        values = [c.evalf() for c in self.coordinates]
        if not all(value.is_Float or value.is_Rational for value in values):
            return None
        with workprec(prec + 20):
            return Float(_mp_value(self, [c._to_mpmath(prec + 20) for c in self.coordinates]), precision=prec)

    def _eval_expand_trace(self, **_hints: Any) -> Any:
        """The polynomial, written out; millions of terms for high degrees in many coordinates."""
        return _expanded(self)

    @property
    def text(self) -> list[tuple[str, int]]:
        """The word as runs of one letter: names of fields (F_k for constant matrices), counted from 1, and powers."""
        names = self.field_names
        letters = [names[f] if f >= 0 else f"F_{-f}" for f in self.word]
        return [(name, len(list(run))) for name, run in groupby(letters)]

    @property
    def function_name(self) -> str:
        """The name tr, with the number of the summand if the algebra is a direct sum."""
        return f"tr{self.matrices.data.number or ''}"

    def _sympystr(self, printer: Any) -> str:
        from sympy import Symbol

        inside = "*".join(name if n == 1 else f"{name}**{n}" for name, n in self.text)
        if all(isinstance(c, Symbol) for c in self.coordinates):
            return f"{self.function_name}({inside})"
        return f"{self.function_name}({inside})({', '.join(map(printer.doprint, self.coordinates))})"

    def _latex(self, printer: Any, exp: Any = None) -> str:
        from liepoisson.formula.styles import LATEX

        inside = r"\,".join(LATEX.vector(name) if n == 1 else f"{LATEX.vector(name)}^{{{n}}}" for name, n in self.text)
        name = (
            rf"\operatorname{{tr}}_{{{self.matrices.data.number}}}"
            if self.matrices.data.number
            else r"\operatorname{tr}"
        )
        text = rf"{name}\left({inside}\right)"
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"

    def _pretty(self, _printer: Any) -> Any:
        from sympy.printing.pretty.stringpict import prettyForm

        return prettyForm(str(self))

    def _code(self, printer: Any) -> str:
        arguments = ", ".join(printer.doprint(c) for c in self.coordinates)
        return f"Trace({self.matrices.key!r}, {self.word!r}, {arguments})"

    _numpycode = _scipycode = _pythoncode = _lambdacode = _mpmathcode = _code

    @staticmethod
    def _imp_(key: str, word: Word, *coordinates: Any) -> Any:
        """The value for numbers or arrays: what `sympy.lambdify` calls."""
        return value(_KNOWN[key], word, coordinates)


def value(matrices: MatrixMap, word: Word, coordinates: Sequence[Any]) -> Any:
    """The trace for arrays of coordinates that broadcast to one shape."""
    import numpy as np

    from liepoisson.portable import linear

    x = np.stack(np.broadcast_arrays(*coordinates), axis=-1)
    d = matrices.dimension
    factors = {
        f: matrices.matrix(x[..., f * d : (f + 1) * d]) if f >= 0 else matrices.arrays[-1 - f] for f in set(word)
    }
    return trace_of(chain(word[:-1], factors, linear.matmul), factors[word[-1]]) / matrices.data.copies


def trace_of(first: Any, second: Any) -> Any:
    """The real part of the trace of a product, or of the second alone."""
    from liepoisson.portable import linear

    if first is None:
        return linear.einsum("...ii->...", second).real
    return linear.einsum("...ij,...ji->...", first, second).real


def traces_in(expression: Any) -> set[Trace]:
    """The traces that occur in an expression."""
    return expression.atoms(Trace)


def abbreviated(expression: Any) -> tuple[Any, dict[Any, Any]]:
    """The expression with a symbol in place of each trace, and what the symbols stand for: to simplify it."""
    from sympy import Dummy

    symbols = {trace: Dummy(str(trace)) for trace in sorted(traces_in(expression), key=str)}
    return expression.xreplace(symbols), {symbol: trace for trace, symbol in symbols.items()}


def _rational_value(matrices: MatrixMap, word: Word, values: Sequence[Any]) -> Any:
    d = matrices.dimension
    factors = {f: _rational_matrix(matrices, f, values[f * d : (f + 1) * d]) for f in set(word)}
    total = chain(word, factors, sparse_product)
    diagonal = sum((c for (i, j), c in total.items() if i == j), Rational(0))
    return diagonal / matrices.data.copies


def _rational_matrix(matrices: MatrixMap, letter: int, values: Sequence[Any]) -> dict[tuple[int, int], Any]:
    """The matrix of a letter with entries of the type of the values."""
    weights = [(k, v) for k, v in enumerate(values) if v] if letter >= 0 else [(-1 - letter, Integer(1))]
    found: dict[tuple[int, int], Any] = {}
    for k, weight in weights:
        for place, roots in matrices.entries[k].items():
            q = sum(q for q, _ in roots)
            term = weight * Rational(q.numerator, q.denominator)
            found[place] = found[place] + term if place in found else term
    return found


def _mp_value(trace: Trace, values: Sequence[Any]) -> Any:
    from mpmath import exp, mp, mpf, pi

    matrices, d = trace.matrices, trace.matrices.dimension
    order = matrices.data.order

    def matrix(letter: int) -> dict[tuple[int, int], Any]:
        weights = enumerate(values[letter * d : (letter + 1) * d]) if letter >= 0 else [(-1 - letter, mpf(1))]
        found: dict[tuple[int, int], Any] = {}
        for k, weight in weights:
            for place, roots in matrices.entries[k].items():
                for q, a in roots:
                    term = weight * (mpf(q.numerator) / q.denominator) * exp(2j * pi * a / order)
                    found[place] = found.get(place, mp.mpf(0)) + term
        return found

    total = chain(trace.word, {f: matrix(f) for f in set(trace.word)}, sparse_product)
    return sum((c for (i, j), c in total.items() if i == j), mp.mpf(0)).real / matrices.data.copies


def _expanded(trace: Trace) -> Any:
    """The polynomial in the coordinates, by matrices whose entries are polynomials over an exact field."""
    from sympy import Add, Mul

    from liepoisson.algebra.coefficients import Coefficients
    from liepoisson.algebra.cyclotomic import CyclotomicField
    from liepoisson.structure.lie.defining_matrices import in_field
    from liepoisson.structure.poisson.polynomials import multiply

    order, d = trace.matrices.data.order, trace.matrices.dimension
    field = Coefficients() if order == 1 else Coefficients(CyclotomicField(order))
    elements = [in_field(matrix, field, order) for matrix in trace.matrices.entries]

    def matrix(letter: int) -> dict[tuple[int, int], Any]:
        found: dict[tuple[int, int], Any] = {}
        for k in range(d) if letter >= 0 else (-1 - letter,):
            for place, c in elements[k].items():
                found.setdefault(place, {})[(letter * d + k,) if letter >= 0 else ()] = c
        return found

    def times(a: dict[tuple[int, int], Any], b: dict[tuple[int, int], Any]) -> dict[tuple[int, int], Any]:
        found: dict[tuple[int, int], Any] = {}
        for (i, j), p in a.items():
            for (k, l), q in b.items():
                if j == k:
                    _add(found.setdefault((i, l), {}), multiply(p, q))
        return found

    total: dict[Any, Any] = {}
    for (i, j), polynomial in chain(trace.word, {f: matrix(f) for f in set(trace.word)}, times).items():
        if i == j:
            _add(total, polynomial)
    copies = Integer(trace.matrices.data.copies)
    terms = [
        Mul(field.to_sympy(c) / copies, *(trace.coordinates[v] for v in monomial)) for monomial, c in total.items() if c
    ]
    return Add(*terms)


def _add(total: dict[Any, Any], polynomial: dict[Any, Any]) -> None:
    for monomial, c in polynomial.items():
        total[monomial] = total[monomial] + c if monomial in total else c
