"""The general Hamiltonian of a degree with symmetries: it has them, and all that have them are in it."""

import pytest
from sympy import expand, sympify

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.hamiltonian_forms import general_system

E3 = lp.so(3) @ lp.semidirect(2).rename("m", "p")


def coefficients(system):
    return sorted(map(str, system.hamiltonian.free_symbols - set(system.variables)))


@pytest.mark.parametrize(("degree", "count"), [(1, 6), (2, 21), ((1, 2), 27)])
def test_without_symmetries_there_is_one_coefficient_for_each_monomial(degree, count):
    assert len(coefficients(general_system(E3, degree=degree))) == count


def test_changes_of_coordinates():
    """m -> m, p -> -p; and the cyclic change of the axes, which ties three terms together."""
    cyclic = {"m1": "m2", "m2": "m3", "m3": "m1", "p1": "p2", "p2": "p3", "p3": "p1"}
    system = general_system(E3, symmetries=[{f"p{k}": f"-p{k}" for k in (1, 2, 3)}, cyclic])
    assert expand(system.hamiltonian) == expand(
        sympify("h11*(m1**2 + m2**2 + m3**2) + h12*(m1*m2 + m2*m3 + m1*m3) + h44*(p1**2 + p2**2 + p3**2)"
                "+ h45*(p1*p2 + p2*p3 + p1*p3)")
    )  # fmt: skip


def test_a_function_whose_flow_keeps_the_hamiltonian():
    """{H, m3} = 0: a body of revolution, seven coefficients."""
    system = general_system(E3, symmetries=["m3"])
    assert system.bracket(system.hamiltonian, system.variables[2]) == 0
    # m1^2 + m2^2, m3^2, the same of p, and the two of m.p, and (m x p)_3
    assert coefficients(system) == ["h11", "h14", "h15", "h33", "h36", "h44", "h66"]


def test_a_linear_change_by_fractions():
    """A boost of so(1, 1), as it were: invariant are functions of m1 m2 and m3."""
    system = general_system(lp.so(3) @ lp.trivial(), symmetries={"l1": "3*l1/2", "l2": "2*l2/3"})
    assert coefficients(system) == ["h12", "h33"]


def test_modulo_casimirs_the_equations_are_the_same():
    """m.p and p^2 take away one coefficient each; so does a linear Casimir, with all of its products."""
    whole, reduced = general_system(E3), general_system(E3, modulo_casimirs=True)
    assert set(coefficients(whole)) - set(coefficients(reduced)) == {"h14", "h44"}
    central = lp.so(3) @ lp.leibniz(2, 0).rename("l", "c")
    for bracket, n_casimirs in ((lp.so(4) @ lp.trivial(), 2), (central, None)):
        whole, reduced = general_system(bracket), general_system(bracket, modulo_casimirs=True)
        left_out = set(coefficients(whole)) - set(coefficients(reduced))
        assert n_casimirs in (None, len(left_out))
        rates = [sympify(rate) for rate in whole.equations.values()]
        rates = {c for rate in rates for c in expand(rate).as_coefficients_dict()}
        assert rates or not left_out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"degree": 0}, "degree"),
        ({"degree": ()}, "one or several"),
        ({"degree": 30}, "at most"),
        ({"symmetries": [{"m1": "m1^2"}]}, "linear functions"),
        ({"symmetries": [{"q": "m1"}]}, "linear functions"),
        ({"symmetries": [{"m1": "0"}]}, "linear functions"),
        ({"symmetries": [{f"{v}{k}": f"2*{v}{k}" for v in "mp" for k in (1, 2, 3)}]}, "there is none"),
        ({"degree": 1, "letter": "m"}, "one thing"),
    ],
)
def test_what_makes_no_sense_is_refused(options, words):
    with pytest.raises(ParameterError, match=words):
        general_system(E3, **options)
