"""What the package says of each system of the catalog: texts, values at fixed states, searches, verdicts, charts."""

from __future__ import annotations

import contextlib
import multiprocessing
import resource
import signal
import sys
import time
from collections.abc import Callable, Sequence
from functools import cache
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from verification.corpus.answer import answer, answers

import liepoisson as lp

MOST_COMPONENTS = 9
"""Of systems whose equilibria are looked for: in twelve components that takes minutes."""
LONG_PAINLEVE = {"compressible-reduced-mhd", "leibniz-top-4", "twisted-top"}
"""Where a balance is given up when its share of the time is over: the answer depends on the clock, or takes an hour."""
NO_LIMIT = 3600.0
"""Seconds, far more than a search takes."""
NOT_ASKED = "not asked, since it takes long"
SECONDS = 120.0
"""Of processors, for each question about a system; none that ends takes half a minute."""
BYTES = 8 * 2**30
"""Memory of the process that answers."""
NO_ANSWER = f"no answer within {SECONDS:g} s of processors and {BYTES / 2**30:g} GB"
CHARTS = ("EulerChart", "QuaternionChart", "ReducedLagrange", "OrdinaryLagrange")


def states(n_components: int) -> np.ndarray:
    """Three fixed states of quarters and eighths, none of them zero, shape (3, n_components)."""
    k, i = np.meshgrid(np.arange(3), np.arange(n_components), indexing="ij")
    return ((5 * i + 3 * k + i * k) % 7 + 1) / 8 * np.where((i + k) % 3 == 1, -1.0, 1.0)


def sample(system: Any) -> np.ndarray:
    """One random state of a fixed seed, as users draw it; it lies on a usual leaf."""
    return lp.sample_states(system, 1, seed=3)[0]


def record() -> dict[str, Any]:
    """All systems."""
    found: dict[str, Any] = {}
    for name in lp.catalog.names():
        began = time.perf_counter()
        found[name] = of_system(name)
        print(f"  {name}: {time.perf_counter() - began:.1f} s", file=sys.stderr, flush=True)
    return found


def of_system(name: str, asked: Sequence[str] = (), seconds: float = SECONDS) -> dict[str, Any]:
    """The answers about one system, from a process of its own; after a question without an answer from a new one."""
    context, left = multiprocessing.get_context("spawn"), [*(asked or QUESTIONS)]
    found: dict[str, Any] = {}
    while left:
        here, there = context.Pipe(duplex=False)
        process = context.Process(target=answer_each, args=(name, tuple(left), seconds, there), daemon=True)
        process.start()
        there.close()
        with here, contextlib.suppress(EOFError):  # of a process that its limits have ended
            while left:
                found[left[0]] = here.recv()
                del left[0]
        process.join()
        if left:
            print(f"  {name}, {left[0]}: {NO_ANSWER}", file=sys.stderr, flush=True)
            found[left.pop(0)] = NO_ANSWER
    return found


def answer_each(name: str, asked: Sequence[str], seconds: float, there: Connection) -> None:
    """Answer some questions about a system, one after the other."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    for question in asked:
        signal.setitimer(signal.ITIMER_PROF, seconds)  # its signal ends the process
        said = answer(lambda question=question: QUESTIONS[question](name, system_of(name)))
        there.send(NO_ANSWER if isinstance(said, dict) and said.get("raises") == "MemoryError" else said)


@cache
def system_of(name: str) -> Any:
    """The system that all questions of a process are about."""
    return lp.catalog.system(name)


@cache
def report_of(system: Any) -> Any:
    """Its report."""
    return lp.inspect(system)


def of_pair(name: str) -> Any:
    """The Lax pair of the literature, or the refusal."""
    pair = answer(lambda: lp.integrability.known_lax_pair(name))
    return pair if isinstance(pair, dict) else answers(lax_pair(name))


QUESTIONS: dict[str, Callable[[str, Any], Any]] = {
    "report as text": lambda name, system: str(report_of(system)),
    "report as LaTeX": lambda name, system: report_of(system).latex(),
    "report as JSON": lambda name, system: report_of(system).record(),
    "system": lambda name, system: answers(texts(name, system)),
    "values": lambda name, system: answers(values(system)),
    "bracket": lambda name, system: answers(bracket(system.bracket)),
    "integrals": lambda name, system: integrals(system),
    "discrete symmetries": lambda name, system: str(lp.systems.discrete_symmetries(system)),
    "equilibria": lambda name, system: equilibria(system),
    "Painlevé test": lambda name, system: NOT_ASKED if name in LONG_PAINLEVE else painleve(system),
    "Lax pair": lambda name, system: of_pair(name),
    "charts": lambda name, system: {chart: answer(lambda chart=chart: in_chart(chart, system)) for chart in CHARTS},
}
"""What is asked of each system."""


def texts(name: str, system: Any) -> dict[str, Callable[[], Any]]:
    """A system as it is written."""
    return {
        "printed": lambda: str(system),
        "shown": lambda: repr(system),
        "in a notebook": system._repr_latex_,
        "components": lambda: system.component_names,
        "parameters": lambda: {key: str(value) for key, value in system.parameters.items()},
        "hamiltonian": lambda: str(system.hamiltonian),
        "equations": lambda: {str(x): str(rate) for x, rate in system.equations.items()},
        "invariants": lambda: {key: str(value) for key, value in system.invariants.items()},
        "partial integrals": lambda: {key: str(value) for key, value in system.partial_integrals.items()},
        "field": lambda: type(system.field()).__name__,
        "top": lambda: str(system.top_parameters),
        "file": lambda: lp.catalog.entry(name).toml(),
        "description": lambda: lp.catalog.entry(name).description,
    }


def values(system: Any) -> dict[str, Callable[[], Any]]:
    """Numbers at the fixed states."""
    x = states(len(system.component_names))
    return {
        "states": lambda: {str(k): row.tolist() for k, row in enumerate(x)},
        "vector field": lambda: {str(k): system.vector_field(row).tolist() for k, row in enumerate(x)},
        "invariants": lambda: {key: value.tolist() for key, value in system.invariant_values(x).items()},
        "Poisson tensor": lambda: system.functions.poisson_tensor(x),
        "Jacobian": lambda: system.functions.jacobian(x),
        "gradient of H": lambda: system.functions.energy.gradient(x[0]),
        "Hessian of H": lambda: system.functions.energy.hessian(x[0]),
        "random state": lambda: sample(system).tolist(),
    }


def bracket(of: Any) -> dict[str, Callable[[], Any]]:
    """What is proved of a bracket."""
    return {
        "shown": lambda: repr(of),
        "entries": lambda: {str(place): str(entry) for place, entry in of.entries().items()},
        "constant part": lambda: {str(place): str(entry) for place, entry in of.constant.items()},
        "Casimirs": lambda: [str(one) for one in of.casimirs()],
        "report of Casimirs": lambda: str(of.casimir_report()),
        "Jacobi": lambda: str(of.jacobi_certificate()),
        "rank": lambda: str(of.rank_certificate()),
        "strata": lambda: [str(one) for one in of.strata()],
        "derivations": lambda: [str(one) for one in of.derivations()],
        "scalings": lambda: [str(one) for one in of.scalings()],
    }


def integrals(system: Any) -> dict[str, Any]:
    """All polynomial integrals up to degree 2."""
    found = lp.integrability.first_integrals(system, degree=2)
    return {"printed": str(found), "expressions": {one.name: str(one.expression) for one in found.found}}


def equilibria(system: Any) -> Any:
    """Those of the leaf of the random state, with their verdicts."""
    if len(system.component_names) > MOST_COMPONENTS:
        return NOT_ASKED
    found = lp.equilibria(system, lp.Leaf.through(system, sample(system)))
    return {
        "leaf": str(found.leaf),
        "completeness": found.completeness,
        "printed": str(found),
        "each": [
            {
                "state": one.state.tolist(),
                "energy": float(one.energy),
                "spectrum": [[value.real, value.imag] for value in one.spectrum.tolist()],
                "signature": list(map(int, one.signature)),
                "verdicts": f"{one.linear_stability}; {one.nonlinear_stability}; {one.family}",
            }
            for one in found
        ],
    }


def painleve(system: Any) -> dict[str, Any]:
    """Balances, exponents and the verdict."""
    found = lp.integrability.painleve_test(system, time_limit=NO_LIMIT)
    return {"verdict": found.verdict, "printed": str(found), "left": found.left, "special": found.special}


def lax_pair(name: str) -> dict[str, Callable[[], Any]]:
    """The pair of the literature, and what follows from it."""
    pair = lp.integrability.known_lax_pair(name)
    return {
        "printed": lambda: str(pair),
        "matrices": lambda: {"L": str(pair.L.tolist()), "M": str(pair.M.tolist())},
        "characteristic polynomial": lambda: str(pair.characteristic_polynomial),
        "integrals": lambda: str(pair.integrals()),
        "curve": lambda: str(pair.spectral_curve(seed=0)),
    }


def in_chart(name: str, system: Any) -> dict[str, Any]:
    """Canonical coordinates on the leaf of the random state, there and back."""
    state = sample(system)
    chart = getattr(lp.charts, name)(system, state=state)
    z = chart.from_body(state)
    return {
        "shown": repr(chart),
        "components": chart.component_names,
        "conditions": str(chart.conditions),
        "hamiltonian": str(chart.hamiltonian),
        "coordinates": z.tolist(),
        "vector field": chart.system.vector_field(z).tolist(),
        "margins": {key: float(value) for key, value in chart.margins(state).items()},
    }
