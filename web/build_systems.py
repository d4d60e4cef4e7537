"""Writes what the page offers to somebody who types a system, `src/data/systems.json`: brackets and examples.

    python web/build_systems.py

The terms of the brackets, their Casimirs and the examples are those of the package; `tests/web/test_typed_systems.py`
repeats it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import liepoisson as lp
from liepoisson.compile.typed import names_of
from liepoisson.laboratory.pages import unit_of
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.numeric.sampling import sample_states
from liepoisson.structure.bracket import Bracket

FILE = Path(__file__).resolve().parent / "src" / "data" / "systems.json"

BRACKETS = (
    ("so3", "so(3), a rigid body", "so(3)", "trivial()", ("l",)),
    ("e3", "e(3), a heavy top", "so(3)", "semidirect(2)", ("l", "alpha")),
    ("charged", "so(3) with two vectors, a charged heavy top", "so(3)", "semidirect(3)", ("l", "alpha", "beta")),
    ("leibniz3", "Leibniz extension of order 3, a twisted top", "so(3)", "leibniz(3, epsilon)", ("l", "alpha", "beta")),
    ("leibniz4", "Leibniz extension of order 4", "so(3)", "leibniz(4, epsilon)", ("l", "alpha", "beta", "gamma")),
    (
        "leibniz5",
        "Leibniz extension of order 5",
        "so(3)",
        "leibniz(5, epsilon)",
        ("l", "alpha", "beta", "gamma", "delta"),
    ),
    ("so4", "so(4), a rigid body in four dimensions", "so(4)", "trivial()", ("M",)),
    ("so21", "so(2,1)", "so(2,1)", "trivial()", ("l",)),
    ("so21e", "so(2,1) with a vector", "so(2,1)", "semidirect(2)", ("l", "alpha")),
)
"""Key, words, and what a system file has of it: algebra, extension, variables."""

EXAMPLES = {
    "henon-heiles": "Hénon–Heiles",
    "double-pendulum": "Double pendulum",
    "spring-pendulum": "Spring pendulum",
    "toda": "Toda, three particles",
    "free-rigid-body": "Free rigid body",
    "heavy-top": "Heavy top",
    "kovalevskaya": "Kovalevskaya's top",
    "charged-heavy-top": "Charged heavy top",
    "twisted-kovalevskaya": "Twisted Kovalevskaya top",
    "leibniz-top-4": "Top with four fields",
    "manakov-so4": "Rigid body in four dimensions",
    "so21-heavy-top": "Heavy top of so(2,1)",
    "lotka-volterra-3": "Three species",
    "sklyanin": "Sklyanin's bracket",
}
"""Systems of the catalog, and how the page calls them."""

ANGLES = {"double-pendulum": ("theta1", "theta2")}
"""Coordinates that are drawn as angles, which the entry does not say."""


def brackets() -> dict[str, Any]:
    """Terms `(i, j, m, c)` with {x_i, x_j} = sum of c x_m, and Casimirs as formulas, by key."""
    found = {}
    for key, words, algebra, extension, variables in BRACKETS:
        bracket = Bracket(read_algebra(algebra), read_extension(extension, ("epsilon",)), variables)
        found[key] = {
            "words": words,
            "algebra": algebra,
            "extension": extension,
            "fields": dict(names_of(bracket)),
            "terms": [[i, j, m, str(c)] for i, j, m, c in bracket.kept_entries()],
            "casimirs": [formula(casimir) for casimir in bracket.casimirs()],
        }
    return found


def formula(expression: Any) -> str:
    """A polynomial of SymPy in the grammar."""
    return str(expression).replace("**", "^").replace(" ", "")


def examples() -> list[dict[str, Any]]:
    """Systems of the catalog as somebody would type them."""
    found = []
    for key, words in EXAMPLES.items():
        file = lp.catalog.entry(key)
        system = lp.catalog.system(key)
        start = start_of(file, system)
        found.append(
            {
                "key": key,
                "words": words,
                **bracket_of(key, file),
                "hamiltonian": " ".join(file.hamiltonian.split()),
                "parameters": {name: as_texts(value) for name, value in file.parameters.items()},
                "start": [repr(float(value)).removesuffix(".0") for value in start],
                "unit": unit_of(system, start),
            }
        )
    return found


def bracket_of(key: str, file: Any) -> dict[str, Any]:
    """What is chosen and typed for the bracket of an entry."""
    tables = file.toml.tables["bracket"]
    names = list(file.bracket.coordinate_names_in_order)
    typed = {"coordinates": "", "momenta": "", "angles": "", "entries": ""}
    if "canonical" in tables:
        given = tables["canonical"]
        angles = ANGLES.get(key, file.bracket.angles)
        written = str(given) if isinstance(given, int) else ", ".join(given)
        momenta = ", ".join(tables.get("momenta", ()))
        found = {"coordinates": written, "momenta": momenta, "angles": ", ".join(angles)}
        return {**typed, "bracket": "canonical", **found}
    if "tensor" in tables:
        rows = [(first, second, entry) for first, row in tables["tensor"].items() for second, entry in row.items()]
        entries = "\n".join(f"{{{first}, {second}}} = {entry}" for first, second, entry in rows)
        return {**typed, "bracket": "tensor", "coordinates": ", ".join(names), "entries": entries}
    wanted = (tables["algebra"], tables.get("extension", "trivial()"))
    for name, _, algebra, extension, _ in BRACKETS:
        if (algebra, extension) == wanted:
            return {**typed, "bracket": name}
    raise SystemExit(f"{key}: the page has no bracket {wanted}")


def start_of(file: Any, system: Any) -> Any:
    """The first state among the reference values that is chaotic or else any; without one a random unit state."""
    states = [(one.quantity != "lyapunov", k, one.state) for k, one in enumerate(file.references) if one.state]
    if not states:
        return sample_states(system, 1, seed=0)[0]
    state = min(states, key=lambda one: one[:2])[2]
    return np.array([float(value) for value in state])


def as_texts(value: Any) -> Any:
    """An exact parameter as text, vectors and matrices as lists."""
    return [as_texts(one) for one in value] if isinstance(value, tuple) else str(value)


def text() -> str:
    """What the file contains."""
    record = {"brackets": brackets(), "examples": examples()}
    return json.dumps(record, allow_nan=False, ensure_ascii=False, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
