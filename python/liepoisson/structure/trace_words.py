r"""Words in the matrices of several fields whose traces are Casimirs of g (x) A.

With $X_\lambda$ the matrix of the field of $e_\lambda$,
$\{X_\lambda, x_{\nu j}\} = \sum_\kappa W_\kappa{}^{\lambda\nu} [X_\kappa, e_j]$.  So the sum
$\sum T^{\lambda_1\cdots\lambda_k}\operatorname{tr}(X_{\lambda_1}\cdots X_{\lambda_k})$ is a Casimir if T does not
change under cyclic rotations, and if it makes no difference which of its places is multiplied by $e_\nu$:

$$\sum_\lambda W_\kappa{}^{\lambda\nu}\, T^{\lambda\mu\cdots}
  = \sum_\lambda W_\mu{}^{\lambda\nu}\, T^{\kappa\lambda\cdots}
  \qquad\text{for all } \kappa, \mu, \dots, \nu. \tag{1}$$

For a Leibniz extension these are the coefficients of the powers of z in $\operatorname{tr} X^k$,
$X = \epsilon x_0 z^{n-1} + x_1 z^{n-2} + \dots + x_{n-1}$, see `liepoisson.structure.poisson.casimir_search`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import product
from math import gcd
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from liepoisson.structure.extension import Extension

Word: TypeAlias = tuple[int, ...]
"""Letters; cyclic rotations are the same word."""

Combination: TypeAlias = dict[Word, Any]
"""Words with their coefficients."""

MOST_WORDS = 1100
"""Of one length, where equation (1) is solved; six letters of three kinds, four of five."""


def canonical(word: Word) -> Word:
    """The rotation of a word that comes first."""
    return min(word[s:] + word[:s] for s in range(len(word)))


def rotations(word: Word) -> set[Word]:
    """The different rotations of a word."""
    return {word[s:] + word[:s] for s in range(len(word))}


def chain(word: Word, factors: Mapping[int, Any], times: Callable[[Any, Any], Any]) -> Any:
    """The product of the factors of a word, from the left; None for the empty word."""
    total: Any = None
    for letter in word:
        total = factors[letter] if total is None else times(total, factors[letter])
    return total


def leibniz_combinations(n: int, degree: int, strength: Any) -> Iterator[Combination]:
    """The coefficients of z^(n-1), ..., z^0 in tr X^degree, each without the common factor of its multiplicities.

    Args:
        n: Order of the extension.
        degree: Number of letters.
        strength: Epsilon, which multiplies each letter 0 for n > 1.
    """
    for power in reversed(range(n)):
        counted = {word: len(rotations(word)) for word in _words_of_power(n, degree, power)}
        common = gcd(*counted.values())
        yield {word: (count // common) * (strength ** word.count(0) if n > 1 else 1) for word, count in counted.items()}


def _words_of_power(n: int, degree: int, power: int) -> list[Word]:
    """The words whose letters have this power of z together; the letter k has z^(n-1-k)."""

    def extended(left: int, places: int) -> Iterator[Word]:
        if not places:
            if not left:
                yield ()
            return
        for used in range(min(left, n - 1) + 1):
            yield from ((n - 1 - used, *rest) for rest in extended(left - used, places - 1))

    return sorted({canonical(word) for word in extended(power, degree)})


def balanced_combinations(extension: Extension, degree: int) -> list[Combination]:
    """A basis of the solutions of (1), by linear algebra on the words of one length; coefficients are SymPy numbers.

    There are none where the words are too many, see `MOST_WORDS`.
    """
    from liepoisson.algebra.coefficients import Coefficients
    from liepoisson.algebra.exact_numbers import is_zero
    from liepoisson.algebra.linear_algebra import nullspace

    n = extension.dimension
    if n**degree > MOST_WORDS:
        return []
    W = extension.tensor
    letters = range(n)
    table = {
        (k, nu): [(lam, W[k][lam][nu]) for lam in letters if not is_zero(W[k][lam][nu])]
        for k, nu in product(letters, repeat=2)
    }
    field = Coefficients.containing(value for row in table.values() for _, value in row)
    words = sorted({canonical(word) for word in product(letters, repeat=degree)})
    place = {word: column for column, word in enumerate(words)}
    rows: dict[tuple[tuple[int, Any], ...], dict[int, Any]] = {}
    for word, nu in product(product(letters, repeat=degree), letters) if degree > 1 else ():
        first, second, rest = word[0], word[1], word[2:]
        row: dict[int, Any] = {}
        for sign, terms in (
            (1, [((lam, second, *rest), c) for lam, c in table[first, nu]]),
            (-1, [((first, lam, *rest), c) for lam, c in table[second, nu]]),
        ):
            for other, c in terms:
                column, element = place[canonical(other)], field.read(c)
                term = element if sign > 0 else -element
                row[column] = row[column] + term if column in row else term
        row = {column: value for column, value in sorted(row.items()) if value}
        if row:
            rows[tuple(row.items())] = row
    found = nullspace(list(rows.values()), len(words), field).vectors
    # A coefficient of T belongs to every rotation of its word.
    counted = [{words[c]: (field.to_sympy(value), len(rotations(words[c]))) for c, value in v.items()} for v in found]
    common = [gcd(*(n_rotations for _, n_rotations in terms.values())) for terms in counted]
    return [{word: q * (m // g) for word, (q, m) in terms.items()} for terms, g in zip(counted, common, strict=True)]
