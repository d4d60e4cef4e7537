"""Certificates: what proves that a system is Liouville integrable, as plain data that others can check."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import combinations, count
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.number_fields import as_fraction
from liepoisson.errors import DamagedFileError, MissingFileError, OutputError, ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import by_name, named
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.integrability import checker
from liepoisson.integrability.search_problem import functions_by_name
from liepoisson.io.files import another_format, read_text, write_atomically

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System

FORMAT = checker.FORMAT
MOST_BYTES = 100_000_000
"""Of a certificate or a report that is read."""
_MOST_POINTS = 50
_LARGEST = 7
"""Coordinates of the point are whole numbers up to this."""


def unknown_casimirs(system: System) -> str:
    """How many Casimirs of the bracket were not found, in words; empty if none is missing."""
    n = system.bracket.n_unknown_casimirs
    return f"{n} of {system.bracket.corank()} Casimirs {'is' if n == 1 else 'are'} unknown" if n else ""


@explains_its_arguments
def certificate(system: System, commuting: Mapping[str, Expr | str]) -> dict[str, Any]:
    """The certificate that functions on phase space, as many as half the rank, make a system integrable; checked.

    Example:
        >>> top = lp.catalog.system("kovalevskaya")
        >>> proof = lp.integrability.certificate(top, {"H": top.hamiltonian, "K": top.integrals["K"]})
        >>> list(proof["commuting"]), list(proof["casimirs"])
        (['H', 'K'], ['C1', 'C2'])

    Args:
        system: A system with rational coefficients.
        commuting: Polynomials that commute with H and with each other, by name.

    Raises:
        ExpressionError: a text is no formula.
        ParameterError: coefficients are not rational, Casimirs are unknown, or the functions do not prove it; the
            message says what fails.
    """
    x, casimirs = system.bracket.variables, system.bracket.casimirs()  # quadratures are no functions on phase space
    if unknown := unknown_casimirs(system):
        raise ParameterError(
            f"a certificate of integrability: wanted a bracket of which all Casimirs are known; {unknown}: no "
            "polynomials were found. Prove single integrals, system.is_constant(f)"
        )
    # a name in a certificate stands for one function: a Casimir is not called like a coordinate
    functions = functions_by_name(commuting, "commuting")
    taken = {*map(str, x), *functions}
    names = (name for k in count(1) if (name := f"C{k}") not in taken)
    data: dict[str, Any] = {
        "format": FORMAT,
        "system": system.name,
        "variables": [str(v) for v in x],
        "poisson_matrix": [
            [i, j, _terms(system.bracket(x[i], x[j]), x)]
            for i, j in combinations(range(len(x)), 2)
            if system.bracket(x[i], x[j]) != 0
        ],
        "hamiltonian": _terms(system.hamiltonian, x),
        "casimirs": {name: _terms(c, x) for c, name in zip(casimirs, names, strict=False)},
        "commuting": {name: _terms(system.expression(f), x) for name, f in functions.items()},
    }
    random, wrong = Random(1), ""
    for _ in range(_MOST_POINTS):
        data["point"] = [str(random.randint(-_LARGEST, _LARGEST)) for _ in x]
        wrong = checker.check(data)
        if "leaf" not in wrong:
            break
    if wrong:
        raise ParameterError(f"a certificate of integrability: wanted a proof; got one that fails: {wrong}")
    return data


@explains_its_arguments
def save_certificate(data: Mapping[str, Any], path: str | Path) -> Path:
    """Check a certificate and write it as JSON.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> top = lp.catalog.system("lagrange")
        >>> proof = lp.integrability.certificate(top, {"H": top.hamiltonian, "l3": "l3"})
        >>> lp.integrability.save_certificate(proof, Path(mkdtemp()) / "lagrange.json").name
        'lagrange.json'

    Raises:
        ParameterError: it proves nothing; the message says what fails.
        OutputError: the file cannot be written, or its name does not end in .json.
    """
    path = Path(path)
    if named(data, "data") is None:
        raise not_a("a certificate", data, "data", "try what certificate(...) returns, or report.certificate")
    data = by_name(data, "data", "parts of a certificate", "certificate(system, commuting)")
    if wrong := checker.fault(data):
        raise ParameterError(f"a certificate of integrability: wanted a proof; got one that fails: {wrong}")
    if path.suffix != ".json":
        raise OutputError(f"wanted a name that ends in .json; got {shown(str(path))}; write for example top.json")
    write_atomically(path, (json.dumps(data, indent=1) + "\n").encode())
    return path


@explains_its_arguments
def load_certificate(path: str | Path) -> dict[str, Any]:
    """Read a certificate and check it: nothing in the file is trusted.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> top = lp.catalog.system("lagrange")
        >>> proof = lp.integrability.certificate(top, {"H": top.hamiltonian, "l3": "l3"})
        >>> file = lp.integrability.save_certificate(proof, Path(mkdtemp()) / "lagrange.json")
        >>> lp.integrability.load_certificate(file)["commuting"]["l3"]  # coefficients and exponents
        [['1', [0, 0, 1, 0, 0, 0]]]

    Raises:
        MissingFileError: there is no such file.
        DamagedFileError: it is no certificate, no regular file of at most 100 MB, or one that proves nothing; the
            message says what fails.
    """
    try:
        data = json.loads(read_text(path, most=MOST_BYTES), object_pairs_hook=checker.once)
    except FileNotFoundError as error:
        raise MissingFileError(f"{path}: wanted a certificate; there is no such file; look at the name") from error
    except (OSError, ValueError, RecursionError) as error:
        raise DamagedFileError(f"{path}: wanted a certificate; got a file that is none ({error!r:.80})") from error
    named = data.get("format") if isinstance(data, dict) else None
    if named != FORMAT and isinstance(named, str) and named.rpartition("/")[0] == FORMAT.rpartition("/")[0]:
        raise DamagedFileError(f"{path}: {another_format(named, FORMAT)}")
    if wrong := checker.fault(data):
        raise DamagedFileError(f"{path}: the certificate is refused: {wrong}; it was altered, or proves nothing")
    return data


def _terms(expression: Any, variables: Sequence[Any]) -> list[list[Any]]:
    from sympy import Poly

    if not expression.is_polynomial(*variables):
        raise ParameterError(f"a certificate: wanted polynomials, which a short checker understands; got {expression}")
    found: list[list[Any]] = []
    for monomial, coefficient in Poly(expression, *variables).terms():
        if not coefficient.is_Rational:
            raise ParameterError(
                f"a certificate: wanted rational coefficients, which a short checker understands; got {coefficient}"
            )
        if coefficient != 0:
            found.append([str(as_fraction(coefficient)), list(map(int, monomial))])
    return found
