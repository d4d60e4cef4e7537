r"""Lie algebras by their structure constants, $[e_i, e_j] = c_{ij}^k e_k$.

The algebras with a name (so(n), su(n), ...) are in `structure.lie_algebras`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import combinations, product
from numbers import Integral
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Coefficient, Exact, ExactMatrix, is_zero, substituted, symbols_of, to_sympy
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.facades import function_of
from liepoisson.formula.parameters import Parameter, values_of_symbols
from liepoisson.formula.tensors import (
    Brackets,
    Rows,
    Tensor3,
    in_sympy,
    nonzero_brackets,
    read_brackets,
    read_components,
    read_names,
    read_tensor,
)
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import listed
from liepoisson.inputs.names import check_title
from liepoisson.inputs.refusals import check_kind

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie.lie_structure import LieStructure, Subspace, Triple
    from liepoisson.structure.lie.matrix_family import MatrixFamily

MAX_DIMENSION = 1000
"""The largest dimension: beyond it even sparse structure constants outgrow what anything here can work with."""

_MAX_DENSE = 200  # 8 million entries
_NAME_PART = re.compile(r"[A-Za-z_0-9]{1,100}")


@explains_its_methods
class LieAlgebra:
    r"""A finite-dimensional Lie algebra, $[e_i, e_j] = c_{ij}^k e_k$.

    Example:
        >>> so3 = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}})
        >>> so3.is_semisimple
        True

    Args:
        structure_constants: `c[i][j][k]`, exact, shape (n, n, n).
        name: How it is printed.
        basis_names: Names of $e_1, \dots, e_n$; "1", "2", ... if left out.  A single one may be "": then a coordinate
            has the name of its field.
        check: Verify the Jacobi identity.  Switch this off only to study what goes wrong.

    Attributes:
        rows: The nonzero $c_{ij}^k$ as they are kept, before SymPy is asked for them.
        dimension: The dimension n.
        basis_names: Names of the basis elements.
        name: How it is printed.
        family: The matrices that it consists of, if one of the constructors of `structure.lie_algebras` made it.
        summands: The algebras of which it is the direct sum, if it was made as one.

    Raises:
        ShapeError: `structure_constants` is not n x n x n, or `basis_names` has another length.
        ParameterError: a basis name cannot be part of the name of a coordinate, or is given twice, or is the number
            of another basis element.
        BracketError: antisymmetry or the Jacobi identity fails; the message names the entry.
        ParameterError: an entry is not exact, or n is more than 1000.
    """

    def __init__(
        self,
        structure_constants: Sequence[Sequence[Sequence[Parameter]]],
        name: str = "g",
        basis_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> None:
        tensor = read_tensor(structure_constants, "structure_constants")
        _check_antisymmetry(tensor)
        n = len(tensor)
        pairs = {(i, j): dict(enumerate(tensor[i][j])) for i, j in combinations(range(n), 2)}
        self._set(n, nonzero_brackets(pairs), name, basis_names, check=check)

    @classmethod
    def from_brackets(
        cls,
        n: int,
        brackets: Mapping[tuple[int, int], Mapping[int, Parameter]],
        name: str = "g",
        basis_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> LieAlgebra:
        r"""An algebra by its brackets, $[e_i, e_j] = \sum_k$ `brackets[i, j][k]` $e_k$, the nonzero ones only.

        Args:
            n: The dimension.
            brackets: By (i, j), then by k, counted from 0; each pair in one order only.
            name: How it is printed.
            basis_names: Names of the basis elements; "1", "2", ... if left out.
            check: Verify the Jacobi identity.

        Raises:
            BracketError: an index is out of range, a pair is given twice or with itself, or Jacobi fails.
            ParameterError: an entry is not exact, or n is not an integer from 1 to 1000.
            ShapeError: `basis_names` does not have n names.
        """
        check_dimension(n)
        n = int(n)  # NumPy's and SymPy's integers are read, too
        algebra = cls.__new__(cls)
        algebra._set(n, read_brackets(n, brackets), name, basis_names, check=check)
        return algebra

    @classmethod
    def from_matrices(
        cls,
        matrices: Sequence[object],
        name: str = "g",
        basis_names: Sequence[str] | None = None,
        *,
        hermitian: bool = False,
    ) -> LieAlgebra:
        r"""The algebra that square matrices span, $M_i M_j - M_j M_i = c_{ij}^k M_k$.

        Args:
            matrices: Exact entries, shape (n, m, m); complex ones (with SymPy's `I`) if the $c_{ij}^k$ are real.
            name: How it is printed.
            basis_names: Names of the matrices; "1", "2", ... if left out.
            hermitian: Whether they are hermitian generators, $M_i M_j - M_j M_i = i\,c_{ij}^k M_k$, as in physics.

        Raises:
            ShapeError: not a sequence of square matrices of one size.
            BracketError: linearly dependent, or a commutator outside of the span; the message names the matrices.
                `algebras.closure` adds those that are missing.
            ParameterError: an entry is not exact, or a matrix is not hermitian.
        """
        from liepoisson.structure.lie.sparse_matrices import brackets_of_matrices

        if (given := listed(matrices, "matrices")) is None:
            raise ShapeError(
                f"matrices must be a sequence of square matrices; got {type(matrices).__name__}. Write a list of them, "
                "and their names as basis_names."
            )
        brackets = brackets_of_matrices(given, hermitian=hermitian)
        # Commutators of matrices obey the Jacobi identity.
        return cls.from_brackets(len(given), brackets, name, basis_names, check=False)

    def _set(self, n: int, rows: Rows, name: str, basis_names: Sequence[str] | None, *, check: bool) -> None:
        check_dimension(n)
        self.dimension: int = int(n)
        self.rows: Rows = rows
        self.family: MatrixFamily | None = None
        self.summands: tuple[LieAlgebra, ...] = ()
        self.name: str = check_title(name, "the name of a Lie algebra", None)
        self.basis_names: tuple[str, ...] = read_names(basis_names, "basis_names", tuple(str(i + 1) for i in range(n)))
        if len(self.basis_names) != n:
            raise ShapeError(f"basis_names must be {n} names; got {len(self.basis_names)}. Give one per basis element.")
        if basis_names is not None:
            _check_basis_names(self.basis_names)
        if check:
            self._check_jacobi()

    @property
    def brackets(self) -> Brackets:
        """The nonzero $c_{ij}^k$ for i < j, by (i, j), then by k; counted from 0."""
        return self._brackets

    @cached_property
    def _brackets(self) -> Brackets:
        return in_sympy(self.rows)

    @property
    def structure_constants(self) -> Tensor3:
        """The dense tensor `c[i][j][k]`, shape (n, n, n); made on demand.

        Raises:
            ParameterError: n is more than 200; use `brackets`.
        """
        n, zero = self.dimension, self._zero
        if n > _MAX_DENSE:
            raise ParameterError(
                f"the dense tensor is made for up to {_MAX_DENSE} dimensions; {self.name} has {n}. Use .brackets."
            )

        def row(i: int, j: int) -> tuple[Exact, ...]:
            entries = self.brackets.get((min(i, j), max(i, j)), {})
            return tuple((entries[k] if i < j else -entries[k]) if k in entries else zero for k in range(n))

        return tuple(tuple(row(i, j) for j in range(n)) for i in range(n))

    @property
    def symbols(self) -> set[str]:
        """Names of the free symbols in the structure constants."""
        return {name for value in self._values for name in symbols_of(value)}

    def substitute(self, values: Mapping[str, Coefficient]) -> LieAlgebra:
        """The same algebra with values for some of its symbols.

        Raises:
            ParameterError: not a mapping from names, or symbols, to exact values, or a name is none of them.
        """
        values = values_of_symbols(values, self.symbols)
        if not values:
            return self
        changed = {value: substituted(value, values) for value in self._values}
        brackets: Any = {pair: {k: changed[c] for k, c in row.items()} for pair, row in self.rows.items()}
        return LieAlgebra.from_brackets(self.dimension, brackets, self.name, self.basis_names, check=False)

    def bracket(self, u: Sequence[Parameter], v: Sequence[Parameter]) -> tuple[Exact, ...]:
        r"""The bracket $[u, v]$ of two elements by their coordinates, shape (n,).

        Raises:
            ShapeError: `u` or `v` does not have n components.
            ParameterError: a component is not exact.
        """
        first, second = (read_components(w, name, self.basis_names) for w, name in ((u, "u"), (v, "v")))
        if not all(isinstance(value, Fraction) for value in (*first, *second, *self._values)):
            first, second = ([to_sympy(value) for value in w] for w in (first, second))
        result = [first[0] * 0] * self.dimension
        for (i, j), row in self.brackets.items():
            weight = first[i] * second[j] - first[j] * second[i]
            if weight != 0:
                for k, c in row.items():
                    result[k] += weight * c
        return tuple(result)

    def jacobi_residuals(self) -> dict[Triple, dict[int, Exact]]:
        r"""Where Jacobi fails: $[[e_i, e_j], e_k]$ + cyclic by i < j < k, then by component; empty if nowhere."""
        return self._structure().jacobi_residuals()

    def killing_form(self) -> ExactMatrix:
        r"""The matrix $\kappa_{ij} = \operatorname{tr}(\mathrm{ad}_i\, \mathrm{ad}_j)$, exact, shape (n, n)."""
        return self._structure().killing_form()

    def killing_signature(self) -> tuple[int, int, int]:
        """Numbers of positive, negative and zero eigenvalues of the Killing form.

        Raises:
            ParameterError: symbols leave the signs open.
        """
        from liepoisson.structure.lie.lie_structure import signature

        return signature(self.killing_form())

    def derived_series(self) -> tuple[Subspace, ...]:
        r"""The ideals $g \supset [g, g] \supset [[g, g], [g, g]] \supset \dots$, each once, with bases."""
        return self._structure().derived_series()

    def lower_central_series(self) -> tuple[Subspace, ...]:
        r"""The ideals $g \supset [g, g] \supset [g, [g, g]] \supset \dots$, each once, with bases."""
        return self._structure().lower_central_series()

    def centre(self) -> Subspace:
        r"""The elements that commute with all, $[z, g] = 0$: the linear Casimirs of the bracket."""
        return self._structure().centre()

    def radical(self) -> Subspace:
        r"""The largest solvable ideal: the x with $\kappa(x, [g, g]) = 0$."""
        from liepoisson.structure.lie import levi

        return (g := self._structure()).subspace(levi.radical(g))

    def nilradical(self) -> Subspace:
        """The largest nilpotent ideal: the elements x of the radical for which ad x is nilpotent."""
        from liepoisson.structure.lie import levi

        return (g := self._structure()).subspace(levi.nilradical(g))

    def levi_factor(self) -> Subspace:
        r"""A semisimple subalgebra s, with $g = s \oplus r$ for the radical r (Levi's theorem), over the same numbers.

        Its basis has one vector $e_k + \dots$ for each k at which no vector of the radical begins.
        `g.subalgebra(g.levi_factor())` is the algebra s.

        Example:
            >>> galilei = lp.algebras.galilei(3)
            >>> s = galilei.levi_factor()
            >>> s.dimension, galilei.subalgebra(s).is_semisimple, galilei.radical().dimension
            (3, True, 7)
        """
        from liepoisson.structure.lie import levi

        return (g := self._structure()).subspace(levi.levi_factor(g))

    def subalgebra(self, vectors: Subspace | Sequence[Sequence[Parameter]], name: str | None = None) -> LieAlgebra:
        r"""The subalgebra that vectors span, with these as its basis "1", "2", ...

        Args:
            vectors: The basis, in the coordinates of this algebra, shape (m, n).
            name: How it is printed.

        Raises:
            BracketError: they are linearly dependent, or the bracket of two is outside of their span; with their
                numbers.
            ShapeError: no sequence of vectors with n components.
            ParameterError: a component is not exact.
        """
        from liepoisson.structure.lie import levi

        g, read = self._with_vectors(vectors, "vectors")
        brackets: Any = levi.subalgebra(g, read)
        return LieAlgebra.from_brackets(len(read), brackets, name or f"subalgebra of {self.name}", check=False)

    def quotient(self, ideal: Subspace | Sequence[Sequence[Parameter]], name: str | None = None) -> LieAlgebra:
        r"""The algebra g / i, in the basis of those $e_k$ at which no vector of an echelon basis of i begins.

        They keep their names, but where these are numbers.

        Example:
            >>> g = lp.algebras.se(3)
            >>> g.quotient(g.radical()).basis_names
            ('r23', 'r13', 'r12')

        Args:
            ideal: Vectors that span the ideal, shape (m, n).
            name: How it is printed.

        Raises:
            BracketError: they do not span an ideal, or all of g.
            ShapeError: no sequence of vectors with n components.
            ParameterError: a component is not exact.
        """
        from liepoisson.structure.lie import levi

        g, read = self._with_vectors(ideal, "ideal")
        kept, brackets = levi.quotient(g, read)
        if not kept:
            raise BracketError(
                f"the ideal must not be all of {self.name}; got {len(read)} vectors that span it. Leave some out."
            )
        names = [self.basis_names[k] for k in kept]
        own = None if any(one.isdecimal() for one in names) else names
        made: Any = brackets
        return LieAlgebra.from_brackets(len(kept), made, name or f"quotient of {self.name}", own, check=False)

    def opposite(self) -> LieAlgebra:
        r"""The algebra with the bracket $[x, y]' = -[x, y]$; $x \mapsto -x$ is an isomorphism.

        Its minus Lie-Poisson bracket is the plus bracket of this algebra, see `Bracket.plus`.
        """
        brackets: Any = {pair: {k: -c for k, c in row.items()} for pair, row in self.rows.items()}
        return LieAlgebra.from_brackets(
            self.dimension, brackets, f"opposite of {self.name}", self.basis_names, check=False
        )

    @property
    def is_abelian(self) -> bool:
        """Whether all brackets vanish."""
        return not self.rows

    @property
    def is_semisimple(self) -> bool:
        """Whether the Killing form is not degenerate (Cartan's criterion); symbols are taken as generic."""
        return self._structure().killing_rank() == self.dimension

    @property
    def is_solvable(self) -> bool:
        """Whether the derived series ends at zero."""
        return self.derived_series()[-1].dimension == 0

    @property
    def is_nilpotent(self) -> bool:
        """Whether the lower central series ends at zero."""
        return self.lower_central_series()[-1].dimension == 0

    def adjoint_representation(self) -> tuple[ExactMatrix, ...]:
        r"""The matrices $(\operatorname{ad}_i)_{kj} = c_{ij}^k$, one per basis element."""
        return tuple(tuple(zip(*plane, strict=True)) for plane in self.structure_constants)

    def __add__(self, other: LieAlgebra) -> LieAlgebra:
        r"""The direct sum $g \oplus h$, the basis of g first."""
        check_kind(other, LieAlgebra, "+", "a Lie algebra to add", "write for example so(3) + so(3)")
        n, m = self.dimension, other.dimension
        moved = {(i + n, j + n): {k + n: c for k, c in row.items()} for (i, j), row in other.rows.items()}
        names = joined_names(self.basis_names, other.basis_names)
        name = f"{self.name} + {other.name}"
        brackets: Any = {**self.rows, **moved}
        total = LieAlgebra.from_brackets(n + m, brackets, name, names, check=False)
        total.summands = (*(self.summands or (self,)), *(other.summands or (other,)))
        return total

    def __matmul__(self, extension: Extension) -> Bracket:
        """The Lie-Poisson bracket of g (x) A."""
        from liepoisson.structure.bracket import Bracket

        return Bracket(self, extension)

    def _repr_latex_(self) -> str | None:
        """What a notebook shows: the brackets of the basis, up to 12 of them."""
        return function_of("LieAlgebra._repr_latex_")(self)

    def __repr__(self) -> str:
        return self.name

    @property
    def _values(self) -> list[Coefficient]:
        return list(dict.fromkeys(c for row in self.rows.values() for c in row.values()))

    @property
    def _zero(self) -> Exact:
        value = next((c for row in self.brackets.values() for c in row.values()), Fraction(0))
        return value - value

    def _structure(self) -> LieStructure:
        from liepoisson.structure.lie.lie_structure import LieStructure

        return LieStructure(self.dimension, self.brackets)

    def _with_vectors(self, given: object, name: str) -> tuple[LieStructure, list[dict[int, Any]]]:
        """The structure over a field that contains the vectors, too, and these."""
        from liepoisson.structure.lie.lie_structure import LieStructure, Subspace

        items = given.basis if isinstance(given, Subspace) else listed(given, name)
        if items is None:
            raise ShapeError(
                f"{name} must be a sequence of vectors with {self.dimension} components; got {given!r:.60}. Write a "
                "list of them."
            )
        rows = [read_components(item, f"{name}[{a}]", self.basis_names) for a, item in enumerate(items)]
        g = LieStructure(self.dimension, self.brackets, [c for row in rows for c in row])
        return g, [{k: g.field.read(c) for k, c in enumerate(row) if not is_zero(c)} for row in rows]

    def _check_jacobi(self) -> None:
        for (i, j, k), residual in self.jacobi_residuals().items():
            m, value = next(iter(residual.items()))
            raise BracketError(
                f"structure constants must obey the Jacobi identity; for (i, j, k) = ({i}, {j}, {k}) the cyclic sum of "
                f"[[e_i, e_j], e_k] has component {value} along e_{m} instead of 0. Check the entries c[.][.][.]."
            )


def joined_names(first: tuple[str, ...], second: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the basis of a sum: numbered through, or with a suffix _2, _3, ... on the second where names clash."""
    if not set(first) & set(second) and _misplaced(first + second) is None:
        return first + second
    n, m = len(first), len(second)
    if first == tuple(str(i + 1) for i in range(n)) and second == tuple(str(i + 1) for i in range(m)):
        return tuple(str(i + 1) for i in range(n + m))
    suffix = next(k for k in range(2, n + 3) if not {f"{name}_{k}" for name in second} & set(first))
    return first + tuple(f"{name}_{suffix}" for name in second)


def check_dimension(n: object) -> None:
    """Refuse a dimension that is not an integer from 1 to 1000.

    Raises:
        ParameterError: it is not.
    """
    if isinstance(n, bool) or not isinstance(n, Integral) or not 1 <= int(n) <= MAX_DIMENSION:
        raise ParameterError(
            f"the dimension of a Lie algebra must be an integer from 1 to {MAX_DIMENSION}; got {n!r}. "
            "Take a smaller algebra."
        )


def _check_basis_names(names: tuple[str, ...]) -> None:
    """Refuse names with which a coordinate such as l2 could not be written in a formula, or might be mistaken for l[2].

    Raises:
        ParameterError: there are such names.
    """
    if names == ("",):  # each coordinate is a field, with its name
        return
    for name in names:
        if not _NAME_PART.fullmatch(name):
            raise ParameterError(
                f"a basis name must be 1 to 100 letters, digits and _; got {name!r:.60}, so that no formula could name "
                f"the coordinate. Write for example basis_names={[str(i + 1) for i in range(len(names))]}."
            )
    if (k := _misplaced(names)) is not None:
        raise ParameterError(
            f"a basis name that is a number must be that of its own place; got {names[k]!r} at place {k + 1}, so that "
            f"l{names[k]} would not be l[{names[k]}]. Take other names, or another order."
        )
    if len(set(names)) < len(names):
        raise ParameterError(f"basis names must be distinct; got {list(names)}. Rename one of them.")


def _misplaced(names: tuple[str, ...]) -> int | None:
    """Where a name is the number of another basis element; None if nowhere.

    Where all numbers have two digits or more they are pairs of indices, as in so(6), and no numbering.
    """
    numbers = [(k, name) for k, name in enumerate(names) if name.isdecimal()]
    if not any(len(number) == 1 for _, number in numbers):
        return None
    return next((k for k, name in numbers if name != str(k + 1) and 1 <= int(name) <= len(names)), None)


def _check_antisymmetry(c: Sequence[Sequence[Sequence[Coefficient]]]) -> None:
    n = len(c)
    for i, j, k in product(range(n), repeat=3):
        if not is_zero(c[i][j][k] + c[j][i][k]):
            raise BracketError(
                f"structure constants must be antisymmetric, c[i][j][k] = -c[j][i][k]; got c[{i}][{j}][{k}] = "
                f"{c[i][j][k]} and c[{j}][{i}][{k}] = {c[j][i][k]}. Correct one of the two."
            )
