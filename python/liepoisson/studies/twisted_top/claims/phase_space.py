"""Tops with symbolic parameters on the phase space of a given bracket, and the steps that several checks share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Context, Evidence, checks, written
from liepoisson.studies.twisted_top.typography import show, typeset

# A point at which nothing special happens: small integers without relations between the three vectors.
GENERIC_POINT = (1, 2, -1, 3, 1, 2, 2, -1, 1)
# The same with alpha = 2 beta.
COLLINEAR = (1, 2, -1, 4, -2, 2, 2, -1, 1)
# The top of the discussion.
KOVALEVSKAYA, CENTRE_OF_MASS, UNCHARGED = (2, 2, 1), (-1, 0, 0), (0, 0, 0)
_CASIMIR_DEGREE = 3


@dataclass(frozen=True)
class SymbolicTop:
    """The Hamiltonian of the paper on the phase space of a bracket; all parameters are SymPy objects."""

    bracket: lp.Bracket
    inertia: Any
    a: Any
    b: Any
    epsilon: Any

    @property
    def vectors(self) -> tuple[Any, Any, Any]:
        """The columns l, alpha, beta."""
        l, alpha, beta = self.bracket.fields.values()
        return l, alpha, beta

    @property
    def omega(self) -> Any:
        """Angular velocity, the inverse inertia times l."""
        return column(*(l / moment for l, moment in zip(self.vectors[0], self.inertia, strict=True)))

    @property
    def hamiltonian(self) -> Any:
        """Kinetic energy plus the potentials of the two fields."""
        l, alpha, beta = self.vectors
        return l.dot(self.omega) / 2 + self.a.dot(alpha) + self.b.dot(beta)

    @property
    def system(self) -> lp.System:
        """The bracket with this Hamiltonian."""
        free = {*self.hamiltonian.free_symbols, *self.epsilon.free_symbols} - set(self.bracket.variables)
        return lp.System(self.bracket, self.hamiltonian, symbols=sorted(map(str, free)))

    @property
    def casimirs(self) -> tuple[Any, Any, Any]:
        """C1, C2, C3 as the paper prints them."""
        l, alpha, beta = self.vectors
        return alpha.dot(alpha) + 2 * self.epsilon * l.dot(beta), alpha.dot(beta), beta.dot(beta)

    def rate(self, f: Any) -> Any:
        """The time derivative {f, H}; of a matrix entry by entry."""
        from sympy.matrices import MatrixBase

        if isinstance(f, MatrixBase):
            return f.applyfunc(self.rate)
        return self.bracket(f, self.hamiltonian)


def symbolic_top(
    context: Context,
    *,
    inertia: Sequence[Any] = ("I1", "I2", "I3"),
    a: Sequence[Any] = ("a1", "a2", "a3"),
    b: Sequence[Any] = ("b1", "b2", "b3"),
    epsilon: Any = "epsilon",
) -> SymbolicTop:
    """A top with the bracket of the context; parameters are names (kept symbolic) or exact numbers."""
    moments, mass, charge = (column(*map(_exact, vector)) for vector in (inertia, a, b))
    return SymbolicTop(context.bracket(epsilon), moments, mass, charge, _exact(epsilon))


def _exact(parameter: Any) -> Any:
    from sympy import Rational, S, Symbol

    if isinstance(parameter, str):
        return Symbol(parameter) if parameter.isidentifier() else Rational(parameter)
    return S.Zero + parameter


def lagrange_top(context: Context, *, charged: bool = False, epsilon: Any = "epsilon") -> SymbolicTop:
    """I1 = I2 and a on the axis; b = 0, or on the axis too."""
    b3 = "b3" if charged else 0
    return symbolic_top(context, inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, b3), epsilon=epsilon)


def kovalevskaya_top(context: Context, epsilon: int) -> SymbolicTop:
    """The top of the discussion, with I1 = I2 = 2 I3 and b = 0."""
    return symbolic_top(context, inertia=KOVALEVSKAYA, a=CENTRE_OF_MASS, b=UNCHARGED, epsilon=epsilon)


def kovalevskaya_quartic(top: SymbolicTop) -> Any:
    """Kovalevskaya's integral for I = (2k, 2k, k), a = (a1, a2, 0), b = 0."""
    _, alpha, _ = top.vectors
    omega, kappa, (a1, a2, _) = top.omega, top.inertia[2], top.a
    real = omega[0] ** 2 - omega[1] ** 2 - (a1 * alpha[0] - a2 * alpha[1]) / kappa
    imaginary = 2 * omega[0] * omega[1] - (a1 * alpha[1] + a2 * alpha[0]) / kappa
    return real**2 + imaginary**2


def column(*entries: Any) -> Any:
    """A SymPy column of the entries."""
    from sympy import Matrix

    return Matrix(entries)


def substitution(coordinates: Iterable[Any], values: Iterable[Any]) -> dict[Any, Any]:
    """A dictionary for `subs`, coordinate by coordinate."""
    return dict(zip(coordinates, values, strict=True))


def poisson_map_residual(bracket: lp.Bracket, images: Any, target: lp.Bracket) -> Any:
    """D J D^T - J' o Phi for a map into the phase space of `target`, given by its images: zero if it is Poisson."""
    x: Any = column(*bracket.variables)
    D = images.jacobian(x)
    image: Any = target.poisson_tensor()
    there = image.subs(substitution(target.variables, images), simultaneous=True)
    return D * bracket.poisson_tensor() * D.T - there


@checks("charged-jacobi", epsilon=0)
@checks("leibniz-jacobi", epsilon="epsilon")
def poisson_identities(evidence: Evidence, context: Context, epsilon: int | str) -> None:
    """Antisymmetry and the 84 Jacobi identities of the bracket of the context."""
    bracket = context.bracket(epsilon)
    proof = bracket.jacobi_certificate()
    what = f"J is antisymmetric, and the cyclic sum vanishes for all {proof.n_triples} triples of coordinates"
    evidence.proof("identity", what, proof.holds, [str(proof)], decisive=True)
    l, alpha, _ = bracket.fields.values()
    for x, y, z in ((l[0], l[1], alpha[0]), (l[0], alpha[0], alpha[1])):
        terms = {(u, v, w): bracket(bracket(u, v), w) for u, v, w in ((x, y, z), (y, z, x), (z, x, y))}
        computed = [f"{{{{{show(u)}, {show(v)}}}, {show(w)}}} = {show(value)}" for (u, v, w), value in terms.items()]
        evidence.zero(f"for example the triple {show(x)}, {show(y)}, {show(z)}", sum(terms.values()), computed)
    evidence.note("The cyclic sum is a derivation in each argument, so this is the Jacobi identity for all functions.")
    evidence.data = {
        "triples": proof.n_triples,
        "holds": proof.holds,
        "failures": [str(failure) for failure in proof.failures],
    }


@checks("charged-casimirs", epsilon=0)
@checks("leibniz-casimirs", epsilon="epsilon")
def casimir_identities(evidence: Evidence, context: Context, epsilon: int | str) -> None:
    """The three Casimirs as printed, their independence, the corank, and that there are no others."""
    top = symbolic_top(context, epsilon=epsilon)
    for name, casimir in zip(("C₁", "C₂", "C₃"), top.casimirs, strict=True):
        computed = [f"{name} = {written(casimir, top.bracket)}"]
        evidence.zero(f"J ∇{name} = 0", list(top.bracket.vector_field(casimir)), computed, decisive=True)
    numbers = dict.fromkeys(top.epsilon.free_symbols, 2)
    generic = context.bracket(2 if numbers else 0)
    what = "rank of the differentials of the three at a rational point"
    evidence.independent(what, [c.subs(numbers) for c in top.casimirs], generic, GENERIC_POINT)
    what = "rank of J there, so there is no fourth independent Casimir"
    rank = evidence.rank(what, generic, GENERIC_POINT, 6)
    _all_polynomial_casimirs(evidence, top)
    evidence.data["casimirs"] = [show(c) for c in top.casimirs]
    evidence.data["rank"] = rank


def _all_polynomial_casimirs(evidence: Evidence, top: SymbolicTop) -> None:
    """The finder of all polynomial Casimirs gives the three and no more, for every value of the parameter."""
    report = top.bracket.casimir_report(_CASIMIR_DEGREE)
    found = report.independent == report.corank == len(report.generators) == len(top.casimirs)
    sizes = ", ".join(f"{n} of degree {degree}" for degree, n in report.dimensions.items())
    computed = [
        "generators: " + "; ".join(written(c, top.bracket) for c in report.generators),
        f"linearly independent Casimirs: {sizes}; functionally independent: {report.independent}; "
        f"corank of J: {report.corank}",
    ]
    if report.examined:
        more = ", ".join(typeset(case.condition) for case in report.exceptional) or "none"
        examined = ", ".join(map(typeset, report.examined))
        computed.append(f"special values looked at: {examined}; with more Casimirs: {more}")
    what = f"all homogeneous Casimirs of degree ≤ {_CASIMIR_DEGREE}, from the null space of J∇ on all monomials"
    evidence.proof("search", what, found and not report.exceptional, computed)
    evidence.data = {"dimensions_by_degree": {str(degree): n for degree, n in report.dimensions.items()}}


def complete_integrability(evidence: Evidence, top: SymbolicTop, integrals: dict[str, Any]) -> None:
    """State that three integrals are constant, in involution, and independent together with the Casimirs."""
    integral_names = list(integrals)
    texts = {name: written(integral, top.bracket) for name, integral in integrals.items()}
    formulas = [f"{name} = {text}" for name, text in texts.items() if text != name]
    for formula in formulas:
        evidence.note(formula)
    for i, first in enumerate(integral_names):
        for second in integral_names[i + 1 :]:
            evidence.zero(f"{{{first}, {second}}} = 0", top.bracket(integrals[first], integrals[second]))
    functions = _at_generic_parameters([*integrals.values(), *top.casimirs], top.bracket.variables)
    what = f"rank of d({', '.join(integrals)}, C₁, C₂, C₃) at a rational point, with primes for the parameters"
    evidence.independent(what, functions, top.bracket, GENERIC_POINT, formulas)


def _at_generic_parameters(functions: list[Any], variables: Iterable[Any]) -> list[Any]:
    """The functions with a different prime for each parameter, the same in all of them."""
    from sympy import prime

    free = sorted({s for f in functions for s in f.free_symbols} - set(variables), key=str)
    values = {symbol: prime(k + 2) for k, symbol in enumerate(free)}
    return [f.subs(values) for f in functions]


def strata_steps(evidence: Evidence, bracket: lp.Bracket, wanted: dict[lp.brackets.Locus, int]) -> None:
    """State by the Pfaffians of J on which loci it has which rank, the open stratum first."""
    strata = bracket.strata()
    for stratum in strata:
        casimirs = "; ".join(written(c, bracket) for c in stratum.casimirs)
        computed = [_readable(stratum.certificate), *([f"Casimirs there: {casimirs}"] if casimirs else [])]
        what = f"{_readable(str(stratum.locus)).replace(' x ', ' × ')}: rank {stratum.rank} at every point"
        good = stratum.proved and wanted.get(stratum.locus) == stratum.rank
        evidence.proof("rank", what, good, computed, decisive=True)
    evidence.equal("number of strata", len(strata), len(wanted))


def _readable(text: str) -> str:
    return show(text).replace("!=", "≠")
