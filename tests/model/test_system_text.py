"""Systems as texts: what is written is read back as the same system, or refused."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.model.system_text import read_system_text, system_text, write_system

TWO_FIELDS = lp.Extension([[[1, 0], [0, 0]], [[0, 1], [1, 0]]])
OWN = lp.LieAlgebra.from_brackets(
    3, {(0, 1): {2: 1}, (1, 2): {0: "1/3"}, (2, 0): {1: "sqrt(2)"}}, "mine", ["a", "b", "c"]
)


def systems():
    so3 = lp.so(3) @ lp.leibniz(3, "epsilon")
    return {
        "top": lp.Top(inertia=("sqrt(2)", "5/2", 2), a=("1/3", 0, 0.1), b=(0, 1, 0), epsilon="sqrt(2)/3"),
        "symbolic top": lp.Top.twisted((1, 1, 1), ("a1", 0, 0)),
        "symbolic bracket": lp.System(so3, "dot(l, l)/2 + dot(alpha, g)", {"g": [1, "pi", 3]}),
        "declared": lp.System(so3, "dot(l, l)/2 + dot(alpha, g)", {"epsilon": "1/7"}, symbols=["g[3]"]),
        "function": lp.System(lp.so(3) @ TWO_FIELDS, lambda l, p: l.dot(l) / 2 + p[0] ** 3),
        "expression": lp.System(lp.so(3) @ lp.trivial(), "sin(l1)/(1 + l2^2) + sqrt(2)*l3"),
        "own algebra": lp.System(OWN @ lp.semidirect(2), "la^2 + alphaa*lb"),
        "own extension": lp.System((lp.so(3) @ TWO_FIELDS).rename("u", "v"), "dot(u, v)"),
        "su": lp.System(lp.su(3) @ lp.trivial(), "lh1^2"),
        "gyrostat": lp.System((lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k"}), "dot(l, l)", {"k": "1/3"}),
        "canonical": lp.System(lp.canonical(2), "p1^2 + p2^4 + q1*q2"),
        "named": lp.System(lp.canonical(names=["theta"], momenta=["w"]), "w^2/2 - cos(theta)"),
        "quadratures": lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2 + cos(x)", quadratures={"s": "p^2"}),
        "integrals": lp.System(
            lp.so(3) @ lp.semidirect(2),
            "(l1^2 + l2^2 + 4*l3^2)/2 - alpha1",
            integrals={"two": "2*dot(l, alpha)"},
            partial_integrals={"F": ("l3*(l1^2 + l2^2) + l1*alpha3", "dot(l, alpha)")},
            source='Somebody, "A title", with \\ and é',
            name="Goryachev's",
        ),
    }


def has_symbols(system):
    return bool(system.bracket.symbols or system.hamiltonian.free_symbols - set(system.variables))


@pytest.mark.parametrize("name", systems())
def test_what_is_written_is_read_back(name):
    system = systems()[name]
    kind = "CanonicalSystem" if name == "quadratures" else "System"
    again = read_system_text(system_text(system), kind)
    assert (again.name, again.source) == (system.name, system.source)
    assert again.component_names == system.component_names
    assert again.bracket.entries() == system.bracket.entries()
    assert again.bracket.constant == system.bracket.constant
    assert (again.hamiltonian - system.hamiltonian).expand() == 0
    assert again.integrals == system.integrals
    assert again.partial_integrals == system.partial_integrals
    assert {str(k): str(v) for k, v in again.equations.items()} == {str(k): str(v) for k, v in system.equations.items()}
    if not has_symbols(system):
        assert again.field() == system.field()


@pytest.mark.thorough
@pytest.mark.parametrize("name", lp.catalog.names())
def test_entries_of_the_catalog_are_written_and_read_back(name):
    system = lp.catalog.system(name)
    again = read_system_text(system_text(system))
    if not has_symbols(system):
        assert again.field() == system.field()
    assert again.equations == system.equations
    assert again.parameters == system.parameters
    assert again.integrals == system.integrals


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["a" * 200, "Größe α, β = (1, 2)", "a.b/c", '"quoted"'])
def test_files_keep_names_exactly(name, tmp_path):
    for system in (lp.Top.twisted_kovalevskaya("sqrt(2)"), lp.System(lp.canonical(1), "p1^2 + q1^4", name=name)):
        again = lp.read_system(write_system(system, tmp_path / "a.toml"))
        assert again.name == system.name
        assert again.top_parameters == system.top_parameters
        orbit = lp.integrate(system, np.full(len(system.component_names), 0.1), times=[0, 1])
        assert lp.load(orbit.save(tmp_path / "a.nc")).system.name == system.name


def test_what_has_no_text_is_known_by_its_field():
    large = lp.System(lp.LieAlgebra.from_brackets(41, {(0, 1): {2: 1}}, "large") @ lp.trivial(), "l1^2/2 + l2^2 + l3")
    assert large.text is None
    orbit = lp.integrate(large, np.ones(41), times=[0, 1])
    assert np.array_equal(lp.rerun(orbit.dataset).state, orbit.state)


def test_the_number_e_is_no_coordinate_called_e():
    """SymPy prints it as E."""
    system = lp.systems.CanonicalSystem(["E"], ["p"], "p^2/2 + cos(E)", quadratures={"s": "exp(1)*p"})
    again = read_system_text(system_text(system), "CanonicalSystem")
    assert np.array_equal(again.vector_field([0.5, 0.3, 0.0]), system.vector_field([0.5, 0.3, 0.0]))
    partial = {"P": (sp.E * sp.Symbol("l1"), sp.Symbol("l2"))}
    other = lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)/2 + E*l1", {"E": "exp(1)/3"}, partial_integrals=partial)
    found = read_system_text(system_text(other))
    assert (found.partial_integrals, found.parameters) == (other.partial_integrals, other.parameters)


def test_a_notebook_shows_equations():
    shown = lp.Top.twisted_lagrange()._repr_latex_()
    assert r"\boldsymbol{\alpha}' &= \boldsymbol{\alpha}\times \boldsymbol{\omega} + \epsilon" in shown
    assert r"\dot{x} &= p" in lp.systems.CanonicalSystem(["x"], ["p"], "p^2/2")._repr_latex_()
