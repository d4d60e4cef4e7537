"""Integrals that survive a deformation, against tops whose integrals are known, and proofs that others do not."""

import time

import pytest
import sympy
from sympy import Symbol, expand, symbols

import liepoisson as lp
from liepoisson.algebra.linear_algebra import rank_mod
from liepoisson.errors import ParameterError, TimeLimitError

HEAVY = lp.so(3) @ lp.semidirect(2)
TWISTED = lp.so(3) @ lp.leibniz(3, "epsilon")
KOVALEVSKAYA = {"I": [2, 2, 1]}
KINETIC = "dot(l, inv(I)*l)/2"
LAGRANGE = "(l1^2 + l2^2)/(2*I1) + l3^2/(2*I3)"
QUARTIC = {"K": "((l1^2 - l2^2)/4 + alpha1)^2 + (l1*l2/2 + alpha2)^2"}


def kovalevskaya(bracket, energy=f"{KINETIC} - alpha1", **options):
    return lp.System(bracket, energy, KOVALEVSKAYA, name="Kovalevskaya", **options)


def surviving(found):
    return {str(f.start): f for f in found.integrals}


def is_integral(system, function):
    """By SymPy's brackets, which share nothing with the search."""
    return expand(system.bracket(function, system.hamiltonian)) == 0


@pytest.fixture(scope="module")
def twisted_kovalevskaya():
    return lp.deformations(kovalevskaya(TWISTED), parameter="epsilon", weight=10, order=1)


def test_no_integral_of_the_kovalevskaya_top_survives_the_twist(twisted_kovalevskaya):
    """The question of the paper, for every polynomial in K, l.alpha, H and Casimirs, of weight at most 10."""
    found = twisted_kovalevskaya
    assert found.weights["epsilon"] == 0
    assert (found.weights["l1"], found.weights["beta3"]) == (1, 3)
    assert found.known.keys() == {"K", "l.alpha"}
    assert found.integrals == ()
    assert len(found.obstructions) == found.n_starts == 27
    assert {o.order for o in found.obstructions} == {1}
    # nothing of weight 2 has beta in it: what is added to the Hamiltonian does not matter
    assert found.hamiltonian_terms == ()


@pytest.mark.parametrize("name", ["K", "l.alpha", "H*K"])
def test_an_obstruction_is_seen_by_brackets_alone(twisted_kovalevskaya, name):
    """The functional vanishes on {m, H}_0 for every monomial of its bidegree, and not on {F0, H}_1."""
    (obstruction,) = (o for o in twisted_kovalevskaya.obstructions if str(o.start) == name)
    system = twisted_kovalevskaya.system
    epsilon = Symbol("epsilon")
    x = system.variables

    def value(function):
        rate = sympy.Poly(expand(system.bracket(function, system.hamiltonian)), *x, epsilon)
        terms = {sympy.prod(v**k for v, k in zip((*x, epsilon), m, strict=True)): c for m, c in rate.terms()}
        return sum(c * obstruction.functional.get(m, 0) for m, c in terms.items() if m.as_powers_dict()[epsilon] <= 1)

    assert value(obstruction.function) == obstruction.value != 0
    weight = max(sum(w * k for w, k in zip([1] * 3 + [2] * 3 + [3] * 3, m, strict=True)) for m in
                 sympy.Poly(obstruction.function, *x).monoms())  # fmt: skip
    lower, vectors = weight - 3, x[:6]
    n = 0
    for m in sympy.itermonomials(vectors, lower):
        if sum(w * k for w, k in zip([1, 1, 1, 2, 2, 2], sympy.Poly(m, *vectors).monoms()[0], strict=True)) == lower:
            for b in x[6:]:
                n += 1
                assert value(epsilon * m * b) == 0
    assert n >= obstruction.n_corrections > 0


def test_what_is_trivial_is_not_counted(twisted_kovalevskaya):
    """The Casimirs of the twisted bracket have limits, which survive with H."""
    assert list(twisted_kovalevskaya.trivial) == ["H", "C1", "C2", "C3"]
    names = {str(o.start) for o in twisted_kovalevskaya.obstructions}
    assert "H" not in names
    assert "C1*H" not in names


def test_the_twisted_lagrange_top_keeps_its_second_integral():
    top = lp.System(TWISTED, f"{LAGRANGE} + a3*alpha3", symbols=["I1", "I3", "a3"])
    found = surviving(lp.deformations(top, parameter="epsilon", weight=3))
    x = dict(zip(map(str, top.variables), top.variables, strict=True))
    i1, a3, epsilon = symbols("I1 a3 epsilon")
    spin = sum(x[f"l{k}"] * x[f"alpha{k}"] for k in (1, 2, 3))
    second = found["l.alpha"].function
    assert expand(second - spin - epsilon * i1 * a3 * x["beta3"]) == 0
    assert all(f.is_exact for f in found.values())


def test_the_charged_twisted_lagrange_top_keeps_its_second_integral():
    top = lp.System(TWISTED, f"{LAGRANGE} + a3*alpha3 + b3*beta3", symbols=["I1", "I3", "a3", "b3"])
    a3, b3, i1, epsilon = symbols("a3 b3 I1 epsilon")
    l, alpha, beta = (list(top.variables[k : k + 3]) for k in (0, 3, 6))
    at_0 = sum(p * (a3 * q + b3 * r) for p, q, r in zip(l, alpha, beta, strict=True))
    found = lp.deformations(top, parameter="epsilon", integrals={"P0": at_0}, degree=2)
    (second,) = (f for f in found.exact if f.start == Symbol("P0"))
    assert expand(second.function - at_0 - epsilon * a3**2 * i1 * beta[2]) == 0
    assert is_integral(top, second.function)


def test_kovalevskaya_keeps_its_quartic_with_a_rotor_along_the_axis():
    """Yehia's gyrostat, and no other rotor."""
    axial = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*l3", symbols=["k"])
    found = lp.deformations(axial, parameter="k", weight=4, integrals=QUARTIC)
    (quartic,) = found.integrals
    assert str(quartic.start) == "K"
    assert quartic.is_exact
    assert is_integral(axial, quartic.function)
    k = Symbol("k")
    assert quartic.function.coeff(k, 1) != 0
    for other in ("l1", "l2", "l2 - l3/3"):
        tilted = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*({other})", symbols=["k"])
        assert lp.deformations(tilted, parameter="k", weight=4, integrals=QUARTIC).exact == ()


def test_rotors_that_keep_the_quartic_are_found_among_all():
    """Three parameters at once: the conditions say k1 = k2 = 0."""
    gyrostat = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k1*l1 + k2*l2 + k3*l3", symbols=["k1", "k2", "k3"])
    found = lp.deformations(gyrostat, parameter=["k1", "k2", "k3"], weight=4, integrals=QUARTIC)
    (case,) = found.cases
    assert {str(c) for c in case.conditions} == {"k1", "k2"}
    assert case.is_exact
    assert case.dimension == 1
    cut = lp.deformations(gyrostat, parameter=["k1", "k2", "k3"], weight=4, integrals=QUARTIC, order=1)
    assert not cut.cases[0].is_exact
    at = gyrostat.hamiltonian.subs({"k1": 0, "k2": 0})
    assert expand(gyrostat.bracket(case.function, at)) == 0


def test_kovalevskaya_survives_on_so4_and_so31():
    """Komarov: so(3) (x) R[z]/z^2 with e1 e1 = t e0 is so(4) for t > 0 and so(3,1) for t < 0."""
    t = Symbol("t")
    extension = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: t}})
    top = kovalevskaya(lp.so(3) @ extension)
    (quartic,) = lp.deformations(top, parameter="t", weight=4, integrals=QUARTIC).integrals
    assert quartic.is_exact
    assert is_integral(top, quartic.function)
    third = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {1: t}})
    assert lp.deformations(kovalevskaya(lp.so(3) @ third), parameter="t", weight=4, integrals=QUARTIC).exact == ()


def test_a_potential_that_spoils_the_quartic_is_found_out():
    good = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*(alpha1^2 - alpha2^2)", symbols=["k"])
    bad = kovalevskaya(HEAVY, f"{KINETIC} - alpha1 + k*(alpha1^2 + alpha2^2)", symbols=["k"])
    assert not lp.deformations(bad, parameter="k", degree=4, integrals=QUARTIC).exact
    assert not lp.deformations(good, parameter="k", degree=4, integrals=QUARTIC).exact  # on C1 = 0 alone (Chaplygin)


def cubic(a, b, c, d):
    """The unital algebra of two fields of the binary cubic a X^3 + b X^2 Y + c X Y^2 + d Y^3."""
    products = {
        (0, 0): {0: 1}, (0, 1): {1: 1}, (0, 2): {2: 1},
        (1, 1): {0: -a * c, 1: b, 2: -a}, (2, 2): {0: -b * d, 1: d, 2: -c}, (1, 2): {0: -a * d},
    }  # fmt: skip
    return lp.Extension.from_products(3, products)


TWO_FIELDS = f"{KINETIC} - alpha1 - beta2"
TWO_FIELD_QUARTIC = "((l1^2 - l2^2)/4 + alpha1 - beta2)^2 + (l1*l2/2 + alpha2 + beta1)^2"
CUBIC = ["a", "b", "c", "d"]
ROTORS = " + k1*l1 + k2*l2 + k3*l3"


@pytest.fixture(scope="module")
def untwisted():
    """The two-field top, and its integrals that are no polynomials in H and Casimirs, found and counted by a search."""
    top = kovalevskaya(lp.so(3) @ lp.semidirect(3), TWO_FIELDS)
    known = {"H": top.hamiltonian} | {f"C{k}": c for k, c in enumerate(top.bracket.casimirs(), start=1)}
    known["K"] = top.expression(TWO_FIELD_QUARTIC)
    searched = {k: lp.integrability.first_integrals(top, weight=k, known=known) for k in range(1, 7)}
    assert all(found.complete for found in searched.values())
    assert not any(searched[k].found for k in range(1, 6))
    (sextic,) = searched[6].found
    return {"K": known["K"], "L": sextic.expression}


@pytest.fixture(scope="module")
def all_twists(untwisted):
    """All twists and all rotors at once, by the weights 1, 2, 2 of l, alpha, beta and 1 of the parameters."""
    top = kovalevskaya(lp.so(3) @ cubic(*symbols("a b c d")), TWO_FIELDS + ROTORS, symbols=["k1", "k2", "k3"])
    return lp.deformations(top, parameter=[*CUBIC, "k1", "k2", "k3"], weight=6, order=6, integrals=untwisted)


@pytest.mark.thorough
def test_the_twists_that_keep_the_two_field_quartic(all_twists):
    """They are (a X + b Y)(X^2 + Y^2), whatever polynomial is added to the Hamiltonian in first order."""
    assert {str(t) for t in all_twists.hamiltonian_terms} == {"l1", "l2", "l3"}
    (quartic,) = (case for case in all_twists.cases if str(case.start) == "K")
    assert {str(c) for c in quartic.conditions} == {"a - c", "b - d", "k1", "k2"}
    assert quartic.is_exact
    # the first order decides: its conditions are linear, and those of higher orders follow
    first = sympy.Matrix([[sympy.Poly(c, *symbols("a b c d k1 k2 k3")).coeff_monomial(x)
                           for x in symbols("a b c d k1 k2 k3")] for c in all_twists.conditions[0]])  # fmt: skip
    assert first.rank() == 4


@pytest.mark.thorough
def test_no_other_twist_keeps_the_sextic(all_twists):
    """Of weight 6 combinations with H K and H^3 are looked at, too."""
    cases = [case for case in all_twists.cases if str(case.start) != "K"]
    assert len(cases) == 2
    for case in cases:
        assert {"a - c", "b - d", "k1", "k2"} <= {str(c) for c in case.conditions}


@pytest.mark.thorough
def test_the_twisted_two_field_top_is_integrable(untwisted):
    """On these twists, with any rotor along the axis: both integrals, in involution, to all orders."""
    a, b, k3 = symbols("a b k3")
    top = kovalevskaya(lp.so(3) @ cubic(a, b, a, b), f"{TWO_FIELDS} + k3*l3", symbols=["k3"])
    found = lp.deformations(top, parameter=["a", "b", "k3"], weight=6, order=6, integrals=untwisted)
    quartic, sextic = found.cases
    assert (str(quartic.start), str(sextic.start)) == ("K", "L")
    for case in found.cases:
        assert case.conditions == ()
        assert case.is_exact
        assert is_integral(top, case.function)
    assert expand(top.bracket(quartic.function, sextic.function)) == 0
    for values in ({a: 1, b: 0, k3: 0}, {a: 2, b: -1, k3: sympy.Rational(1, 3)}):
        numbers = {str(s): v for s, v in values.items()}
        member = kovalevskaya(
            lp.so(3) @ cubic(*(values[s] for s in (a, b, a, b))), f"{TWO_FIELDS} + {numbers['k3']}*l3"
        )
        functions = {name: case.function.subs(values) for name, case in zip("KL", found.cases, strict=True)}
        proof = lp.integrability.certificate(member, {"H": member.hamiltonian, **functions})
        assert list(proof["commuting"]) == ["H", "K", "L"]
        assert str(member.bracket.extension.classify()).endswith("C + R")


@pytest.mark.parametrize("coefficients", [(1, 0, 0, 0), (0, 0, 0, 1), (1, 0, -1, 0), (1, 0, 1, 1), (1, 0, -3, 0)])
def test_other_twists_do_not_keep_the_quartic(coefficients):
    """Powers, three real roots, a wrong sign, and the harmonic cubic; the search of all integrals agrees."""
    epsilon = Symbol("epsilon")
    top = kovalevskaya(lp.so(3) @ cubic(*(epsilon * c for c in coefficients)), TWO_FIELDS)
    found = lp.deformations(top, parameter="epsilon", weight=4, integrals={"K": TWO_FIELD_QUARTIC})
    (obstruction,) = found.obstructions
    assert obstruction.order == 1
    member = kovalevskaya(lp.so(3) @ cubic(*coefficients), TWO_FIELDS)
    assert lp.integrability.first_integrals(member, degree=4).independent == ()


def test_one_field_keeps_the_quartic_where_it_generates_a_smaller_algebra():
    """a = 0: e1 e1 = b e1, so that l and alpha move by themselves, on so(4); beta is carried along."""
    top = kovalevskaya(lp.so(3) @ cubic(*symbols("a b c d")), f"{KINETIC} - alpha1{ROTORS}", symbols=["k1", "k2", "k3"])
    known = {"P": "dot(l, alpha)", **QUARTIC}
    found = lp.deformations(top, parameter=[*CUBIC, "k1", "k2", "k3"], weight=4, order=6, integrals=known)
    spin, quartic = found.cases
    assert [str(c) for c in spin.conditions] == ["a"]
    assert {str(c) for c in quartic.conditions} == {"a", "b - 2*k1", "k2"}
    assert quartic.is_exact


def test_every_twist_keeps_the_lagrange_top():
    top = lp.System(
        lp.so(3) @ cubic(*symbols("a b c d")), f"{KINETIC} + alpha3 + 2*beta3 + k3*l3", KOVALEVSKAYA, symbols=["k3"]
    )
    known = {"l3": "l3", "P": "dot(l, alpha + 2*beta)"}
    found = lp.deformations(top, parameter=[*CUBIC, "k3"], weight=3, integrals=known)
    assert [str(case.start) for case in found.cases] == ["l3", "P"]
    assert str(found).splitlines()[-2:] == ["l3 survives for all values", "P survives for all values"]
    assert all(case.is_exact and case.conditions == () for case in found.cases)
    assert is_integral(top, found.cases[1].function)


def test_no_twist_keeps_the_cubic_of_the_spherical_top():
    top = lp.System(
        lp.so(3) @ cubic(*symbols("a b c d")), f"dot(l, l)/2 + alpha1 + beta2{ROTORS}", symbols=["k1", "k2", "k3"]
    )
    free = lp.System(lp.so(3) @ lp.semidirect(3), "dot(l, l)/2 + alpha1 + beta2")
    (integral,) = lp.integrability.first_integrals(free, weight=4).found
    found = lp.deformations(top, parameter=[*CUBIC, "k1", "k2", "k3"], weight=4, integrals={"N": integral.expression})
    (case,) = found.cases
    assert {str(c) for c in case.conditions} == {*CUBIC, "k1", "k2", "k3"}


REFUSED = {
    "no parameter": (lambda: lp.deformations(lp.Top.kovalevskaya(), parameter="epsilon"), "Leave it without a value"),
    "a coordinate": (lambda: lp.deformations(kovalevskaya(TWISTED), parameter="l1"), "wanted a symbol"),
    "twice": (lambda: lp.deformations(kovalevskaya(TWISTED), parameter=["epsilon"] * 2), "different names"),
    "no integral": (
        lambda: lp.deformations(kovalevskaya(TWISTED), parameter="epsilon", integrals={"K": "l1^2"}),
        "wanted integrals of Kovalevskaya at epsilon = 0; got K = l1",
    ),
    "a name that is taken": (
        lambda: lp.deformations(kovalevskaya(TWISTED), integrals={"H": "dot(l, alpha)"}),
        "names that nothing else has; got 'H' for alpha1",
    ),
    "no name": (
        lambda: lp.deformations(kovalevskaya(TWISTED), integrals={5: "dot(l, alpha)"}),
        "wanted names of functions; got 5",
    ),
    "the name of a parameter": (
        lambda: lp.deformations(kovalevskaya(TWISTED), integrals={"epsilon": "dot(l, alpha)"}),
        "got 'epsilon'",
    ),
    "nothing known": (lambda: lp.deformations(kovalevskaya(TWISTED), integrals={}), "none is known"),
    "too large": (
        lambda: lp.deformations(kovalevskaya(TWISTED), weight=16, order=2),
        r"at most 20,000 monomials; got 16, with .* Take weight=\d+",
    ),
    "both": (lambda: lp.deformations(kovalevskaya(TWISTED), weight=3, degree=3), "a degree or a weight"),
    "no weights": (
        lambda: lp.deformations(
            lp.System(HEAVY, "l3^2 + l1^2 + l2^2 + alpha3 + alpha3^2 + alpha3^3 + k*l1", symbols=["k"]),
            parameter="k", weight=3, integrals={"l3": "l3"},
        ),
        "give a degree instead",
    ),
    "a denominator": (
        lambda: lp.deformations(kovalevskaya(HEAVY, f"{KINETIC} - alpha1/(1 + k)", symbols=["k"]), parameter="k"),
        "wanted a polynomial",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_asked_is_refused(name):
    call, words = REFUSED[name]
    with pytest.raises(ParameterError, match=words):
        call()


def henon_heiles(s):
    return lp.System(lp.canonical(2), f"(dot(p, p) + dot(q, q))/2 + e*(q1^2*q2 + ({s})*q2^3)", symbols=["e"])


OSCILLATOR = {"A": "p1*p2 + q1*q2", "L": "q1*p2 - q2*p1", "B": "p1^2 + q1^2"}


@pytest.mark.parametrize(("s", "kept"), [("1/3", "A"), ("2", "B"), ("-1/3", None), ("1", None)])
def test_the_integrable_henon_heiles_systems_keep_an_integral(s, kept):
    """The parameter has the weight -1, so that orders do not end by themselves; obstructions come from order 2 on."""
    system = henon_heiles(s)
    found = lp.deformations(system, parameter="e", weight=2, integrals=OSCILLATOR)
    assert found.weights["e"] == -1
    assert found.hamiltonian_terms is None  # H1 would be of weight 3, and lighter terms may count
    assert [str(f.start) for f in found.exact] == ([kept] if kept else [])
    assert all(is_integral(system, f.function) for f in found.exact)
    assert {str(o.start) for o in found.obstructions} == OSCILLATOR.keys() - {kept}
    assert all(o.order >= 2 for o in found.obstructions)


def test_a_constant_part_of_the_bracket_is_a_rotor():
    """{l1, l2} = -l3 + k is Yehia's gyrostat in other coordinates."""
    top = kovalevskaya(HEAVY.with_constant({("l1", "l2"): "k"}))
    (quartic,) = lp.deformations(top, parameter="k", weight=4, integrals=QUARTIC).integrals
    assert quartic.is_exact
    assert is_integral(top, quartic.function)


def test_the_limit_of_time_leaves_what_was_not_decided():
    found = None
    with pytest.raises(TimeLimitError, match="time limit"):
        found = lp.deformations(kovalevskaya(TWISTED), weight=12, order=2, time_limit=1e-6)
    assert found is None


def test_integrals_that_a_system_has_are_known():
    """Where the functions that it is given are constant at 0; K is not when the parameter is not."""
    top = lp.System(HEAVY, f"{KINETIC} - alpha1 + k*l3", KOVALEVSKAYA, symbols=["k"], integrals=QUARTIC)
    found = lp.deformations(top, parameter="k", weight=4)
    assert [str(f.start) for f in found.exact] == ["K"]


def test_integrals_at_0_may_be_needed_in_corrections():
    """l.alpha, a Casimir of l and alpha alone, becomes l.alpha - b |l|^2/2 for e1 e1 = b e1: the part l3^2 is one."""
    b, k1 = symbols("b k1")
    top = kovalevskaya(lp.so(3) @ cubic(0, b, 0, 0), f"{KINETIC} + alpha3 + k1*l1", symbols=["k1"])
    found = lp.deformations(top, parameter=["b", "k1"], weight=3, integrals={"l3": "l3", "P": "dot(l, alpha)"})
    (case,) = (c for c in found.cases if c.is_exact and all(k1 not in p.free_symbols for p in c.conditions))
    assert case.dimension == 2
    assert case.function.free_symbols <= {*top.variables, b, k1}  # the number of times l3^2 is determined
    assert is_integral(top, case.function)
    assert case.function.coeff(b) != 0


@pytest.mark.thorough
@pytest.mark.parametrize("start", ["K + 3*P", "P - 2*H*P + H^2*C2", "K + P*C2 - H^3"])
def test_no_change_of_the_hamiltonian_helps_by_brute_force(start):
    """Mixed F0, every F1 of weight at most 9 and every H1 of weight at most 4, no grading; one more rank is no."""
    untwisted = kovalevskaya(lp.so(3) @ lp.semidirect(3))
    twisted = kovalevskaya(lp.so(3) @ lp.leibniz(3))
    x = untwisted.variables
    names = {"K": QUARTIC["K"], "P": "dot(l, alpha)", "C2": "dot(alpha, beta)"}
    functions = {Symbol(name): untwisted.expression(f) for name, f in names.items()}
    f0 = sympy.sympify(start.replace("^", "**")).xreplace(functions | {Symbol("H"): untwisted.hamiltonian})
    p = 2**61 - 1

    def polynomial(function):
        terms = sympy.Poly(function, *x).terms() if function != 0 else []
        return {m: int(c.p) * pow(int(c.q), -1, p) % p for m, c in terms}

    def along(field, monomial):
        image = {}
        for k, power in enumerate(monomial):
            for m, c in field[k].items() if power else ():
                key = tuple(a + b - (i == k) for i, (a, b) in enumerate(zip(monomial, m, strict=True)))
                image[key] = (image.get(key, 0) + power * c) % p
        return image

    def of_weight_up_to(most):
        weights, found = (1, 1, 1, 2, 2, 2, 3, 3, 3), [()]
        for w in weights:
            found = [(*m, k) for m in found for k in range(most // w + 1)]
            found = [m for m in found if sum(k * v for k, v in zip(m, weights, strict=False)) <= most]
        return found

    flow = [polynomial(rate) for rate in untwisted.equations.values()]
    of_f0 = [polynomial(-rate) for rate in untwisted.bracket.vector_field(expand(f0))]
    columns = [along(flow, m) for m in of_weight_up_to(9)] + [along(of_f0, m) for m in of_weight_up_to(4)]
    square = untwisted.expression("dot(alpha, alpha)")  # the limit of a Casimir has a correction, and so has H times it
    targets = [f0, expand(square * untwisted.hamiltonian)]
    images = [polynomial(expand(twisted.bracket(expand(f), twisted.hamiltonian))) for f in targets]
    assert all(images)
    numbers = {}
    rows = [{numbers.setdefault(m, len(numbers)): c for m, c in column.items()} for column in [*columns, *images]]
    without, *ranks = (
        rank_mod([*rows[: len(columns)], *more], len(numbers), p) for more in ([], rows[-2:-1], rows[-1:])
    )
    assert ranks == [without + 1, without]


def test_what_is_heavier_than_what_was_looked_at_is_named():
    """With epsilon^2 l3 in H the weights are doubled: K has 8."""
    quartic = "(l1^2/4 - l2^2/4 - alpha1)^2 + (l1*l2/2 - alpha2)^2"
    energy = "l1^2/4 + l2^2/4 + l3^2/2 + alpha1 + epsilon^2*l3"
    gyrostat = lp.System(lp.so(3) @ lp.semidirect(2), energy, symbols=["epsilon"])
    assert lp.deformations(gyrostat, integrals={"K": quartic}).left == ("not looked at: K, of weight 8",)
    (found,) = lp.deformations(gyrostat, integrals={"K": quartic}, weight=8).exact
    assert found.start == Symbol("K")


def test_corrections_have_the_degree_that_is_asked_for():
    """In q1 + q2 and q1 - q2 this separates: M + 4 epsilon q1 q2 (q1^2 + q2^2), of degree 4, is an integral."""
    energy = "(p1^2 + p2^2 + q1^2 + q2^2)/2 + epsilon*(q1^4 + 6*q1^2*q2^2 + q2^4)"
    pair = lp.System(lp.canonical(2), energy, symbols=["epsilon"])
    known = {"M": "q1*q2 + p1*p2"}
    q1, q2, p1, p2 = pair.variables
    (found,) = lp.deformations(pair, integrals=known, degree=4).exact
    assert expand(found.function - (q1 * q2 + p1 * p2 + 4 * Symbol("epsilon") * q1 * q2 * (q1**2 + q2**2))) == 0
    below = lp.deformations(pair, integrals=known, degree=3)
    assert not below.integrals
    assert "M: no correction of degree up to 3 of order 1: proved" in str(below)
    of_two = "(p1^2 + p2^2 + q1^2 + q2^2)/2 + a*(q1^4 + q2^4) + b*q1^2*q2^2"
    two = lp.System(lp.canonical(2), of_two, symbols=["a", "b"])
    cases = lp.deformations(two, parameter=["a", "b"], integrals=known, degree=4, order=1).cases
    a, b = symbols("a b")
    assert any(6 * a - b in case.conditions for case in cases)


def test_parameters_of_negative_weight_have_cases_without_unknown_numbers():
    """alpha1^2 + alpha2^2 turns with the axis; squares of l3 and products with H say nothing new."""
    energy = "dot(l, inv(I)*l)/2 + alpha3 + a*alpha1^2 + b*alpha1*alpha2 + c*alpha2^2"
    top = lp.System(lp.so(3) @ lp.semidirect(2), energy, KOVALEVSKAYA, symbols=["a", "b", "c"])
    found = lp.deformations(top, parameter=["a", "b", "c"], integrals={"l3": "l3"}, weight=2)
    assert found.weights["a"] == -2
    (case,) = found.cases
    assert (str(case.start), str(case.function), case.is_exact, case.dimension) == ("l3", "l3", True, 1)
    assert {str(c) for c in case.conditions} == {"a - c", "b"}


SEXTIC = "p1^2 + q1^2 + p2^2 + q2^2"


def test_a_limit_of_the_degree_counts_for_the_hamiltonian_too():
    """H + epsilon q1^6 has the integral H - A of degree two, which needs no correction; A needs one of degree six."""
    system = lp.System(lp.canonical(2), f"{SEXTIC} + epsilon*q1^6", symbols=["epsilon"])
    known = {"A": "p1^2 + q1^2"}
    (rest,) = lp.deformations(system, integrals=known, degree=4).exact
    assert (str(rest.start), str(rest.function)) == ("A - H", "-p2**2 - q2**2")
    (whole,) = lp.deformations(system, integrals=known, degree=6).exact
    assert is_integral(system, whole.function)
    top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3 + epsilon*alpha3^3", symbols=["epsilon"])
    (axis,) = lp.deformations(top, integrals={"F": "2*l3^2 - dot(l, l) - 2*alpha3"}, degree=2).exact
    assert str(axis.function) == "2*l3**2"


def test_a_limit_of_the_degree_counts_for_several_parameters():
    system = lp.System(lp.canonical(2), f"{SEXTIC} + a*q1^6 + b*q2^6", symbols=["a", "b"])
    below, whole = (
        lp.deformations(system, parameter=["a", "b"], integrals={"A": "p1^2 + q1^2"}, degree=degree, order=1).cases
        for degree in (2, 6)
    )
    assert [[str(c) for c in case.conditions] for case in below] == [["b"], ["a"]]
    assert all(case.is_exact for case in below)
    (case,) = whole
    assert case.is_exact
    assert case.conditions == ()
    assert is_integral(system, case.function)


def test_obstructions_have_coefficients_in_any_field():
    top = lp.System(HEAVY, "(l1^2 + l2^2)/4 + l3^2/2 + alpha3 + sqrt(2)*k1*l1", symbols=["k1"])
    (axis,) = lp.deformations(top, parameter="k1", integrals={"l3": "l3"}, weight=1).obstructions
    assert axis.order == 1
    turned = lp.System(HEAVY, "(l1^2 + l2^2)/4 + l3^2/2 + alpha3 + sqrt(2)*k1*l3", symbols=["k1"])
    found = lp.deformations(turned, parameter="k1", integrals={"m": "sqrt(2)*l3"}, weight=3)
    assert [str(f.start) for f in found.exact] == ["m"]
    assert list(found.known) == ["m"]  # the Casimirs are among the limits


@pytest.mark.parametrize("weight", [10**4, 10**9])
def test_a_search_that_is_too_large_is_refused_at_once(weight):
    began = time.process_time()
    with pytest.raises(ParameterError, match=r"Take weight=\d+"):
        lp.deformations(kovalevskaya(TWISTED), weight=weight)
    assert time.process_time() - began < 2
