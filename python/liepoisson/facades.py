"""The methods that are computed in a layer above their class: the one list of these arrows.

An import runs down. A method that a user looks for on a bracket, such as how a notebook shows it, but that needs what
stands on brackets, asks for its function by name.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

FACADES = {
    "LieAlgebra._repr_latex_": "report.describe.displayed_algebra",
    "Bracket._repr_latex_": "report.describe.displayed_bracket",
    "PoissonStructure.casimir_certificate": "structure.poisson.casimir_check.certificate_of",
    "Bracket.casimir_report": "structure.tensor_leaves.casimir_report",
    "Bracket.strata": "structure.strata.strata",
    "Bracket.given_casimirs": "structure.tensor_leaves.TensorCasimirs",
    "PoissonStructure.gradient": "structure.trace_casimirs.modulo_casimirs",
    "PoissonStructure.rank_certificate": "structure.casimirs.rank_certificate",
    "Reductions.in_variables": "structure.tensor_sources.changed",
    "Reductions.in_invariants": "structure.invariant_reduction.in_invariants",
    "Reductions.dirac_bracket": "structure.dirac_bracket.dirac_bracket",
    "PoissonStructure.with_casimirs": "structure.poisson.casimir_check.checked_casimirs",
    "System.__str__": "report.describe.describe",
    "System._repr_latex_": "report.describe.displayed",
    "System.text": "model.system_text.system_text",
    "VectorField.file_text": "model.system_text.vector_field_text",
    "_Reader.damped": "damping.damped_file.damped_file",
    "_Reader.noisy": "noise.noisy_system.NoisyFile",
}
"""The function of each such method, in its module within the package."""


def function_of(method: str) -> Callable[..., Any]:
    """The function that computes a method of `FACADES`; its module is imported when it is first called."""
    module, _, name = FACADES[method].rpartition(".")
    return getattr(import_module(f"liepoisson.{module}"), name)
