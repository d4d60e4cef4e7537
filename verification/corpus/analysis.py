"""Answers of the exact algebra that no system of the catalog asks for: algebras, extensions, searches, proofs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from verification.corpus.answer import answer, answers, digest
from verification.corpus.results import STARTS, TOP, WELL

import liepoisson as lp

NO_LIMIT = 3600.0
"""Seconds, far more than a search takes."""
ALGEBRAS: dict[str, Callable[[], Any]] = {
    **{f"so({n})": (lambda n=n: lp.so(n)) for n in (3, 4)},
    "so(2, 1)": lambda: lp.so(2, 1),
    **{f"sl({n})": (lambda n=n: lp.sl(n)) for n in (2, 3)},
    **{f"su({n})": (lambda n=n: lp.su(n)) for n in (2, 3)},
    "gl(2)": lambda: lp.algebras.gl(2),
    "se(3)": lambda: lp.algebras.se(3),
    "affine(1)": lambda: lp.algebras.affine(1),
    "heisenberg(2)": lambda: lp.algebras.heisenberg(2),
    "sine(3)": lambda: lp.algebras.sine(3),
    "abelian(2)": lambda: lp.algebras.abelian(2),
}
EXTENSIONS: dict[str, Callable[[], Any]] = {
    "trivial": lp.trivial,
    "leibniz(3)": lambda: lp.leibniz(3),
    "leibniz(3, epsilon)": lambda: lp.leibniz(3, "epsilon"),
    "semidirect(3)": lambda: lp.semidirect(3),
    "crmhd": lp.extensions.crmhd,
}
FAMILIES: dict[str, Callable[[], Any]] = {
    "euler_top_on": lambda: lp.catalog.euler_top_on("sl(2)", inertia=(3, 2, 1)),
    "heavy_top_on": lambda: lp.catalog.heavy_top_on("so(2,1)", inertia=(3, 2, 1), a=(1, 0, 2)),
    "twisted_top_on": lambda: lp.catalog.twisted_top_on("so(3)", inertia=(3, 2, 1), a=(1, 0, 2), b=(0, 1, 3)),
    "leibniz_top": lambda: lp.catalog.leibniz_top(3, inertia=(3, 2, 1), vectors=[(1, 0, 2), (0, 1, 0)]),
    "manakov": lambda: lp.catalog.manakov(4, J=(4, 3, 2, 1)),
    "su_top": lambda: lp.catalog.su_top(2, J=(3, 2)),
    "toda": lambda: lp.catalog.toda(4),
    "zeitlin": lambda: lp.catalog.zeitlin(3),
    "reduced_mhd": lambda: lp.catalog.reduced_mhd(3),
    "henon_heiles": lp.catalog.henon_heiles,
}
"""Families of the catalog, one member of each."""


def record() -> dict[str, Any]:
    """All topics."""
    return {
        "algebras": {name: answer(lambda make=make: of_algebra(make())) for name, make in ALGEBRAS.items()},
        "extensions": {name: answer(lambda make=make: of_extension(make())) for name, make in EXTENSIONS.items()},
        "normal forms": {
            str(n): answer(lambda n=n: [str(one) for one in lp.extensions.normal_forms(n)]) for n in (1, 2, 3)
        },
        "families": {name: answer(lambda make=make: of_member(make())) for name, make in FAMILIES.items()},
        "tops": answers(tops()),
        "integrability": answers(integrability()),
        "files": answers(files()),
        "citations": {
            name: answer(lambda name=name: str(lp.cite(lp.catalog.entry(name)))) for name in lp.catalog.names()
        },
        "page": answer(page),
    }


def of_algebra(algebra: Any) -> dict[str, Any]:
    """An algebra and its bracket."""
    found = answers(
        {
            "shown": lambda: repr(algebra),
            "structure constants": lambda: str(algebra.structure_constants),
            "centre": lambda: str(algebra.centre),
            "derived series": lambda: str(algebra.derived_series()),
            "Killing form": lambda: str(algebra.killing_form),
        }
    )
    return {**found, "report": str(lp.inspect(lp.System(algebra @ lp.trivial(), quadratic(algebra))))}


def quadratic(algebra: Any) -> str:
    """A Hamiltonian of the coordinates of an algebra."""
    names = (algebra @ lp.trivial()).coordinate_names_in_order
    return " + ".join(f"{k}/2*{name}^2" for k, name in enumerate(names, start=1))


def of_extension(extension: Any) -> dict[str, Any]:
    """An extension, its class, and its bracket on so(3)."""
    bracket = lp.so(3) @ extension
    return answers(
        {
            "shown": lambda: repr(extension),
            "tensor": lambda: str(extension.tensor),
            "classification": lambda: str(extension.classify()),
            "bracket": lambda: repr(bracket),
            "Casimirs": lambda: [str(one) for one in bracket.casimirs()],
            "strata": lambda: [str(one) for one in bracket.strata()],
        }
    )


def of_member(system: Any) -> dict[str, Any]:
    """A member of a family."""
    return {"report": str(lp.inspect(system)), "equations": {str(x): str(f) for x, f in system.equations.items()}}


def tops() -> dict[str, Callable[[], Any]]:
    """The named tops, without their values."""
    made: dict[str, Callable[[], Any]] = {
        "free_rigid_body": lambda: lp.Top.free_rigid_body((3, 2, "3/2")),
        "heavy": lambda: lp.Top.heavy(inertia=(3, 2, "3/2"), a=(1, 0, 2)),
        "lagrange": lp.Top.lagrange,
        "kovalevskaya": lambda: lp.Top.kovalevskaya(epsilon="1/3"),
        "charged_heavy": lambda: lp.Top.charged_heavy(inertia=(3, 2, "3/2"), a=(1, 0, 2), b=(0, 1, 0)),
        "charged_lagrange": lp.Top.charged_lagrange,
        "twisted": lambda: lp.Top.twisted(inertia=(3, 2, "3/2"), a=(1, 0, 2), epsilon=1),
        "twisted_lagrange": lp.Top.twisted_lagrange,
        "twisted_kovalevskaya": lp.Top.twisted_kovalevskaya,
    }
    return {name: (lambda make=make: [repr(make()), str(lp.inspect(make()))]) for name, make in made.items()}


def integrability() -> dict[str, Callable[[], Any]]:
    """Searches and proofs."""
    it, bracket = lp.integrability, lp.so(3) @ lp.semidirect(2)
    family = lp.System(bracket, "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
    symbolic = lp.System(bracket, "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])
    axial = lp.System(bracket, "(l1^2 + l2^2)/4 + l3^2/2 + alpha3")
    free = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + 2*l2^2 + 6*l3^2)/2")
    x = sympy.Symbol("x")
    general = ({"l1": "-l1"}, "l3")
    return {
        "families": lambda: str(it.integrable_families(family, degree=2, positive=["J"], time_limit=NO_LIMIT)),
        "Lax families": lambda: str(it.lax_families(symbolic, degree=1, positive=["I1", "I2", "I3"], nonzero=["a3"])),
        "search of Lax pairs": lambda: str(it.search_lax_pairs(axial)),
        "Darboux polynomials": lambda: str(it.darboux_polynomials(free, degree=1, time_limit=NO_LIMIT)),
        "integrals on a level": lambda: str(it.first_integrals(free, degree=2, on=["C1 = 1"])),
        "general system": lambda: str(
            it.general_system(lp.so(3) @ lp.trivial(), degree=(1, 2), symmetries=list(general))
        ),
        "certificate": lambda: str(it.certificate(axial, {"H": axial.hamiltonian, "l3": "l3"})),
        "report": lambda: str(it.integrability_report(axial, degree=2, time_limit=NO_LIMIT)),
        "Galois obstruction": lambda: str(it.galois_obstruction(WELL)),
        "particular solutions": lambda: str(it.particular_solutions(WELL)),
        "linear system": lambda: str(it.linear_system([[0, 1], [x, 0]], x)),
    }


def files() -> dict[str, Callable[[], Any]]:
    """Systems as files."""

    def written(system: Any) -> str:
        with tempfile.TemporaryDirectory() as folder:
            return lp.systems.write_system(system, Path(folder) / "system.toml").read_text(encoding="utf-8")

    systems = {"top": TOP, "well": WELL, "toda": lp.catalog.toda(3), "clebsch": lp.catalog.system("clebsch")}
    return {name: (lambda system=system: written(system)) for name, system in systems.items()}


def page() -> dict[str, str]:
    """The laboratory's page of a top."""
    made = lp.laboratory.page_of(TOP, start=STARTS[0])
    return {"shown": str(made), "text": digest(np.frombuffer(made.html.encode(), dtype=np.uint8))}
