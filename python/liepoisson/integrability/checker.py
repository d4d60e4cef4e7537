"""A short, separate check of a certificate of integrability: Python's fractions, and nothing of the search.

A polynomial is a list of [coefficient, exponents], the Poisson matrix one of [i, j, polynomial], i < j.  What is
proved: these are Casimirs, these commute with H and each other, and at the point as many of them have independent
vector fields as half the rank of the matrix, which is the largest possible.
"""
# pyright: basic

import json
import sys
from fractions import Fraction
from pathlib import Path

FORMAT = "liepoisson certificate of Liouville integrability/1"
KEYS = {"format", "system", "variables", "poisson_matrix", "hamiltonian", "casimirs", "commuting", "point"}


def want(condition, words):
    if not condition:
        raise ValueError(words)


def once(pairs):
    want(len(dict(pairs)) == len(pairs), "a key occurs twice")
    return dict(pairs)


def number(text):
    digits = text.removeprefix("-").split("/") if type(text) is str and len(text) <= 1000 and text.isascii() else [""]
    want(len(digits) < 3 and all(map(str.isdigit, digits)), "numbers are texts such as '-1/2'")
    return Fraction(text)


def polynomial(terms, n):
    whole = all(len(m) == n and all(type(k) is int and k >= 0 for k in m) and sum(m) <= 100 for _, m in terms)
    want(whole and type(terms) is list, f"exponents are {n} whole numbers, together at most 100")
    want(len({tuple(m) for _, m in terms}) == len(terms), "a monomial occurs twice")
    return summed((tuple(m), number(c)) for c, m in terms)


def d(f, k):  # the derivative of f by coordinate k
    return {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] for m, c in f.items() if m[k]}


def product(f, g, sign=1):
    return [(tuple(map(int.__add__, m, n)), sign * c * d) for m, c in f.items() for n, d in g.items()]


def summed(pairs):
    total = {}
    for m, c in pairs:
        total[m] = total.get(m, 0) + c
    return {m: c for m, c in total.items() if c}


def bracket(f, g, matrix):  # the sum of J_ij (d_i f d_j g - d_j f d_i g) over i < j
    terms = [(e, summed(product(d(f, i), d(g, j)) + product(d(f, j), d(g, i), -1))) for i, j, e in matrix]
    return summed(pair for e, inner in terms for pair in product(e, inner))


def value(f, point):
    for k, x in enumerate(point):
        f = {m: c * x ** m[k] for m, c in f.items()}
    return sum(f.values(), Fraction(0))


def rank(rows):
    first = next((row for row in rows if any(row)), [])
    k = next((k for k, entry in enumerate(first) if entry), 0)
    return 1 + rank([[a - r[k] / first[k] * b for a, b in zip(r, first, strict=True)] for r in rows]) if first else 0


def fault(data):  # what is wrong with something that should be a certificate, as a text; empty if it is right
    try:
        return check(data)
    except ValueError as error:
        return str(error)
    except (KeyError, TypeError, IndexError, AttributeError, RecursionError, ArithmeticError) as error:
        return f"it is none ({error!r:.80})"


def check(data):  # the same for one that is well formed
    want(set(data) == KEYS, f"its entries should be {', '.join(sorted(KEYS))}")
    want(data["format"] == FORMAT and type(data["system"]) is str and data["system"].isprintable(), "another format")
    n, names = len(data["variables"]), (data["variables"], [*data["casimirs"], *data["commuting"]])
    want(0 < n <= 100 and len(data["point"]) == n, "the point has a coordinate for each of 1 to 100 variables")
    want(all(len({*a}) == len(a) and all(map(str.isprintable, a)) for a in names), "an unprintable name, or one twice")
    x = [{(*[0] * k, 1, *[0] * (n - k - 1)): Fraction(1)} for k in range(n)]
    casimirs, commuting = ({a: polynomial(f, n) for a, f in data[key].items()} for key in ("casimirs", "commuting"))
    point, matrix = [number(c) for c in data["point"]], [(i, j, polynomial(e, n)) for i, j, e in data["poisson_matrix"]]
    want(len({(i, j) for i, j, _ in matrix if i < j < n and f"{i}{j}".isdigit()}) == len(matrix), "wrong entries i, j")
    for i, j, k in [(a, b, c) for a in range(n) for b in range(a) for c in range(b)]:
        cyclic = [bracket(bracket(x[a], x[b], matrix), x[c], matrix) for a, b, c in ((i, j, k), (j, k, i), (k, i, j))]
        if summed(pair for f in cyclic for pair in f.items()):
            return f"the Jacobi identity fails for the coordinates {k}, {j}, {i}"
    wrong = [f"{name} is no Casimir" for name, f in casimirs.items() if any(bracket(f, y, matrix) for y in x)]
    meant = {**dict(zip(data["variables"], x, strict=True)), "H": polynomial(data["hamiltonian"], n)}
    for a, g in [("H", meant["H"]), *commuting.items()]:
        wrong += [f"{name} does not commute with {a}" for name, f in commuting.items() if bracket(f, g, matrix)]
    wrong += [f"{a} is another function" for a, f in {**casimirs, **commuting}.items() if meant.get(a, f) != f]
    tensor, fields = ([[value(bracket(f, y, matrix), point) for y in x] for f in fs] for fs in (x, commuting.values()))
    slopes = [[value(d(f, k), point) for k in range(n)] for f in casimirs.values()]
    if not any(map(any, tensor)) or rank(tensor) + rank(slopes) != n:
        wrong.append("the point lies on a leaf of lower dimension than others, or Casimirs are missing")
    if 2 * rank(fields) != rank(tensor):
        wrong.append("there are fewer independent commuting integrals than half the dimension of the leaves")
    return next(iter(wrong), "")


if __name__ == "__main__":
    try:
        wrong = fault(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"), object_pairs_hook=once))
    except (OSError, ValueError, RecursionError, IndexError) as error:
        wrong = f"it cannot be read ({error!r:.80})"
    print(f"REFUSED: {wrong}" if wrong else "accepted: Liouville integrable")
    sys.exit(bool(wrong))
