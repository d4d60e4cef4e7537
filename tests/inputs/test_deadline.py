"""One deadline for all parts of a call: it returns soon after, with what it has or with a sentence."""

import inspect
import os
import re
import time
from contextlib import suppress
from itertools import count
from types import ModuleType

import numpy as np
import pytest

import liepoisson as lp
import public_calls
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.errors import EnclosureError, MemoryLimitError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import as_deadline
from liepoisson.inputs import deadline
from liepoisson.inputs.deadline import Deadline, checkpoint, has_passed

Q, P = ("q1", "q2", "q3"), ("p1", "p2", "p3")
PAIRS = "1/(q1 - q2)^2 + 1/(q2 - q3)^2 + 1/(q1 - q3)^2"
CALOGERO = lp.systems.CanonicalSystem(Q, P, f"(p1^2 + p2^2 + p3^2 + q1^2 + q2^2 + q3^2)/2 + {PAIRS}")
"""Three particles of Calogero with an oscillator: superintegrable, which takes half a minute to prove."""
TOP = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
OF = lp.integrability
CALLS = {
    "report": lambda **limit: OF.integrability_report(CALOGERO, **limit),
    "report of a field": lambda **limit: OF.integrability_report(lp.catalog.system("zeitlin-5"), **limit),
    "galois": lambda **limit: OF.galois_obstruction(lp.catalog.system("leibniz-top-4"), **limit),
    "painleve": lambda **limit: OF.painleve_test(lp.catalog.system("leibniz-lagrange-5"), **limit),
    "darboux": lambda **limit: OF.darboux_polynomials(lp.catalog.system("manakov-so4"), degree=3, **limit),
    "deformations": lambda **limit: OF.deformations(
        lp.System(lp.so(3) @ lp.leibniz(3, "epsilon"), "dot(l, inv(I)*l)/2 - alpha1", {"I": [2, 2, 1]}),
        weight=14,
        order=2,
        **limit,
    ),
    "shifts": lambda **limit: OF.argument_shift(lp.so(6) @ lp.trivial(), list(range(1, 16)), **limit),
    "chains": lambda **limit: OF.lenard_chains(
        lp.so(5) @ lp.trivial(), (lp.so(5) @ lp.trivial()).frozen(list(range(1, 11))), **limit
    ),
    "families": lambda **limit: OF.integrable_families(TOP, degree=5, **limit),
    "lax": lambda **limit: OF.search_lax_pairs(lp.catalog.system("leibniz-lagrange-4"), degree=8, **limit),
    "lax families": lambda **limit: OF.lax_families(
        lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"]),
        degree=8,
        **limit,
    ),
    "scan": lambda **limit: OF.scan_integrals(TOP, axes={"J": range(1, 40), "a": [1, 2]}, degree=6, threads=1, **limit),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", CALLS)
def test_heavy_calls_return_soon_after_their_limit(name):
    """Seconds more are those of a step that is not interrupted, and of a machine with other work."""
    began = time.monotonic()
    with suppress(TimeLimitError):
        CALLS[name](time_limit=0.5)
    assert time.monotonic() - began < 0.5 + 10


QUICK = {
    "report": lambda: OF.integrability_report(lp.catalog.system("lagrange"), degree=2),
    "galois": lambda: OF.galois_obstruction(lp.catalog.system("henon-heiles")),
    "painleve": lambda: OF.painleve_test(lp.catalog.system("henon-heiles-kdv")),
}


@pytest.mark.parametrize("n", [0, 10, 50, 100, 1000])
@pytest.mark.parametrize("name", QUICK)
def test_whenever_the_deadline_passes_there_is_a_result_or_a_sentence(monkeypatch, name, n):
    """The clock stands still until it was looked at n times; little is looked at after that."""
    looks = count()
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 100.0 if next(looks) > n else 0.0)
    with suppress(TimeLimitError):
        QUICK[name]()
    assert next(looks) < n + 200


def test_a_part_sees_the_deadline_of_the_call_and_of_a_call_around_it():
    checkpoint("nothing")  # without a limit
    with Deadline(1e-9).running() as outer, Deadline(60).running():
        assert not outer.lasts()
        assert has_passed()
        with pytest.raises(TimeLimitError, match="a step was under way"):
            checkpoint("a step")
    assert not has_passed()


FAST = lp.System(lp.canonical(1), "1e7*(p1^2 + q1^2)/2")
RUNS = {
    "integrate": lambda: lp.integrate(FAST, [1, 0], t_end=1e9, method=lp.Taylor(max_steps=10**12)),
    "section": lambda: lp.section(FAST, [1, 0], surface="q1", t_end=1e9, n_crossings=10**9),
    "exponent": lambda: lp.chaos.finite_time_exponents(FAST, [1, 0], t_end=1e9),
    "return map": lambda: lp.sections.return_map(FAST, "q1 - 2", t_end=1e9)([1, 0]),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_inside_a_call_ends_at_the_deadline_of_the_call(name):
    began = time.monotonic()
    with Deadline(0.2).running(), suppress(TimeLimitError):
        RUNS[name]()
    assert time.monotonic() - began < 10


def test_work_that_is_counted_ends_at_the_deadline_too():
    budget = Limits().budget()
    with Deadline(1e-9).running(), pytest.raises(NotDecidedError, match="the time limit was reached: a step"):
        budget.spend(1, "a step")


@pytest.mark.parametrize("limit", [0, -1, float("nan"), "soon", None])
def test_a_limit_is_a_positive_number(limit):
    with pytest.raises(ParameterError, match="time_limit: wanted a positive number of seconds"):
        as_deadline(limit)


def test_no_limit_is_a_limit():
    assert OF.painleve_test(lp.catalog.system("henon-heiles-kdv"), time_limit=float("inf")).verdict == "passes"


HENON_HEILES, DUFFING = lp.catalog.system("henon-heiles"), lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 + q1^4/4")
PRECESSIONS = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3", name="spherical")
LINE = lp.System(lp.canonical(1), "cosh(p1) + sin(q1)*exp(-q1^2)", name="no polynomial")
ON_A_SPHERE = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
DIAGRAM = lp.tori.diagram(ON_A_SPHERE, energy_max=2, n_starts=5)
SEARCHES = {
    "periodic orbits": lambda **limit: lp.orbits.symmetric_periodic_orbits(
        HENON_HEILES, {}, energy="1/10", n_starts=20, **limit
    ),
    "homoclinic orbits": lambda **limit: lp.orbits.symmetric_homoclinic_orbits(
        lp.phase_space.equilibrium(DUFFING, [0, 0]), n_starts=20, **limit
    ),
    "equilibria": lambda **limit: lp.equilibria(LINE, {}, n_starts=10, **limit),
    "relative equilibria": lambda **limit: lp.equilibria(
        PRECESSIONS, {"C1": "1/5", "C2": 1}, along=("l3",), values={"l3": 0.5}, n_starts=5, **limit
    ),
}


def rows(found):
    """The energies, periods or half flights of what was found, with its stability where it is known."""
    columns = list(found.columns().items())
    (_, values), words = columns[0], dict(columns).get("linear_stability", dict(columns).get("stability", [""] * 99))
    return {(round(float(value), 6), str(word)) for value, word in zip(values, words, strict=False)}


@pytest.mark.parametrize("name", SEARCHES)
def test_a_search_returns_what_it_found_before_the_limit(monkeypatch, name):
    """The clock stands still until it was looked at n times; what is found then is part of what there is."""
    whole = SEARCHES[name]()
    assert whole
    assert not whole.is_cut_short
    assert "time limit" not in repr(whole)
    numbers, looks = [], count()
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 0.0 * next(looks))
    SEARCHES[name](time_limit=60)
    n_looks = next(looks)
    for n in sorted({2, n_looks // 8, n_looks // 4, n_looks // 2, n_looks - 8, 2 * n_looks}):
        looks = count()
        monkeypatch.setattr(deadline.time, "monotonic", lambda looks=looks, n=n: 100.0 if next(looks) > n else 0.0)
        found = SEARCHES[name](time_limit=60)
        assert rows(found) <= rows(whole), (n, n_looks)
        assert ("the time limit ended the search" in repr(found)) == found.is_cut_short
        numbers.append((found.is_cut_short, len(found)))
    assert numbers[0] == (True, 0)
    assert numbers[-1] == (False, len(whole))


MANY = 100_000
"""Starts, or what else a call is asked for."""
LONG = {"t_end": 1e7}
TWISTED, START = lp.Top.twisted_kovalevskaya(), [1, 0, 1, 0, 0, 1, 0, 0, 1]
ON_LEAF = lp.Leaf.through(TWISTED, START)
STARTS = lp.sample_states(TWISTED, 2000, seed=1)
QUARTIC = lp.System(lp.canonical(2), "(p1^2 + p2^2 + q1^2 + q2^2)/2 + q1^4 + q2^4 + q1^4*q2^2", name="quartic")
ROD = lp.Top.lagrange(transverse=1, axial=1, a3=1)
TIMES = np.geomspace(10, 1000, 60)
CURVES = {
    "time": TIMES, "exponent": np.outer(np.linspace(0.1, 0.2, 50), np.ones(60)) + 0.3 / np.sqrt(TIMES),
    "n_bootstrap": 10**7,
}  # fmt: skip
SYMMETRIC = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + l2^2 + 6*l3^2)/2", name="with a circle of equilibria")
LOOP = {"start": [0, -0.1461901394453099, 0.4201732609406907, 0], "period": 6.794384826845275, "level": {"H": "1/10"}}
UPRIGHT = lp.catalog.system("lagrange")
SPHERE = {"level": {"C1": 1}, "box": lp.proofs.Box([-2, -2, -2], [2, 2, 2])}
COUNTED = {
    "integrability.galois_obstruction": lambda **limit: OF.galois_obstruction(
        lp.catalog.system("leibniz-top-4"), most=1000, **limit
    ),
    "chaos.exponents_by_energy": lambda **limit: lp.chaos.exponents_by_energy(
        QUARTIC, leaf=lp.Leaf(QUARTIC, {}), energies=[0.0, 0.5, 1.0], n_starts=MANY, **LONG, **limit
    ),
    "chaos.exponents_by_energy, of a top": lambda **limit: lp.chaos.exponents_by_energy(
        TWISTED, leaf=ON_LEAF, energies=[1, 2, 3], n_starts=MANY, **LONG, **limit
    ),
    "fits.finite_time_fit": lambda **limit: lp.fits.finite_time_fit(**CURVES, **limit),
    "fits.log_fit": lambda **limit: lp.fits.log_fit(**CURVES, **limit),
    "fits.orbit_fit": lambda **limit: lp.fits.orbit_fit(
        TWISTED, {"t": np.linspace(0, 1e7, 50), "l1": np.zeros(50)}, ["I1"], starts=START, most_steps=MANY, **limit
    ),
    "fits.window_scan": lambda **limit: lp.fits.window_scan(**CURVES, **limit),
    "fits.window_scan, many windows": lambda **limit: lp.fits.window_scan(
        **CURVES, windows=[(10 + k / MANY, 1000) for k in range(MANY)], **limit
    ),
    "orbits.connecting_orbits": lambda **limit: lp.orbits.connecting_orbits(
        lp.phase_space.equilibrium(DUFFING, [0, 0]), n_starts=MANY, **limit
    ),
    "orbits.orbit_family": lambda **limit: lp.orbits.orbit_family(
        DUFFING, lp.phase_space.equilibrium(DUFFING, [1, 0]), max_orbits=100_000, longest_step=1e-5, **limit
    ),
    "orbits.periodic_orbit": lambda **limit: lp.orbits.periodic_orbit(
        HENON_HEILES, [0, 0, 0, 0.2], period=1e6, n_segments=256, **limit
    ),
    "orbits.periodic_orbits": lambda **limit: lp.orbits.periodic_orbits(
        HENON_HEILES, {}, energy="1/10", n_starts=MANY, **limit
    ),
    "orbits.periodic_orbits, guesses": lambda **limit: lp.orbits.periodic_orbits(
        HENON_HEILES, {}, energy="1/10", guesses=np.full((1000, 4), 0.2), periods=1e6, **limit
    ),
    "results.ReturnMap.cycles": lambda **limit: lp.sections.return_map(HENON_HEILES, "x", t_end=100).cycles(
        {}, "1/10", n_starts=MANY, **limit
    ),
    "orbits.rod": lambda **limit: lp.orbits.rod(ROD, STARTS[:10], length=1e7, n_points=MANY, **limit),
    "orbits.symmetric_homoclinic_orbits": lambda **limit: lp.orbits.symmetric_homoclinic_orbits(
        lp.phase_space.equilibrium(DUFFING, [0, 0]), n_starts=MANY, **limit
    ),
    "orbits.symmetric_periodic_orbits": lambda **limit: lp.orbits.symmetric_periodic_orbits(
        HENON_HEILES, {}, energy="1/10", n_starts=MANY, **limit
    ),
    "phase_space.equilibrium_family": lambda **limit: lp.phase_space.equilibrium_family(
        UPRIGHT,
        lp.phase_space.equilibrium(UPRIGHT, [0, 0, 3, 0, 0, 1]),
        along="C1",
        max_equilibria=100_000,
        longest_step=1e-5,
        **limit,
    ),
    "phase_space.equilibria": lambda **limit: lp.equilibria(LINE, {}, n_starts=MANY, **limit),
    "phase_space.equilibria, relative": lambda **limit: lp.equilibria(
        PRECESSIONS, {"C1": "1/5", "C2": 1}, along=("l3",), values={"l3": 0.5}, n_starts=MANY, **limit
    ),
    "proofs.enclose_equilibria": lambda **limit: lp.proofs.enclose_equilibria(
        SYMMETRIC, **SPHERE, max_boxes=10**9, **limit
    ),
    "proofs.find_certificate": lambda **limit: lp.proofs.find_certificate(
        lp.catalog.heavy_top_on("so(3)", [1, 1, 2], [1, 0, 0]), {"C1": "1/2", "C2": 1}, 1, n_starts=MANY, **limit
    ),
    "proofs.prove_periodic_orbit": lambda **limit: lp.proofs.prove_periodic_orbit(
        HENON_HEILES, **LOOP, n_sections=250, **limit
    ),
    "tori.critical_states": lambda **limit: lp.tori.critical_states(ON_A_SPHERE, n_starts=MANY, **limit),
    "tori.diagram": lambda **limit: lp.tori.diagram(ON_A_SPHERE, n_starts=MANY, **limit),
    "tori.diagram, a slice": lambda **limit: lp.tori.diagram(
        lp.Leaf(lp.catalog.system("toda"), {}), at={"P": 0}, n_starts=MANY, **limit
    ),
    "tori.regions": lambda **limit: lp.tori.regions(DIAGRAM, n_states=MANY, **limit),
    "tori.molecule": lambda **limit: lp.tori.molecule(ON_A_SPHERE, 0.5, n_states=MANY, **limit),
    "tori.fibre": lambda **limit: lp.tori.fibre(ON_A_SPHERE, [0.5, 0.2], n_states=MANY, **limit),
}
"""Calls that are asked for far more than there is time for; what comes after a comma is another call of a function.

Runs of many starts over long times are made from the table of public calls.
"""


def long_run(name):
    """A run of the table, with what it must be given: from many starts, over a long time."""
    row = public_calls.rows()[name]
    taken = inspect.signature(row.function).parameters.values()
    needed = {one.name: row.arguments[one.name] for one in taken if one.default is one.empty}
    until = {"times": [1e7]} if "times" in needed else {"t_end": 1e7}
    starts = np.outer(np.linspace(0.9, 1.1, 100), needed["starts"])
    counted = {one.name: MANY for one in taken if one.name in ("n_crossings", "n_samples")}
    return lambda **limit: row.function(**needed | until | {"starts": starts} | counted | limit)


def functions_with_a_limit_and_a_count():
    """The public functions that take `time_limit` and a number of things to do, by name: whether they are runs."""
    chapters = {name: module for name in lp.__all__ if isinstance(module := getattr(lp, name), ModuleType)}
    for chapter, module in chapters.items():
        for name in () if chapter == "results" else module.__all__:
            if inspect.isfunction(function := getattr(module, name)):
                taken = inspect.signature(function).parameters
                if "time_limit" in taken and any(re.match("n_|max_|most", one) for one in taken):
                    yield f"{chapter}.{name}", "starts" in taken and {"t_end", "times"} & taken.keys()


LIMITED = dict(functions_with_a_limit_and_a_count())
LONG_RUNS = [name for name, is_run in LIMITED.items() if is_run]


def test_all_functions_with_a_limit_and_a_count_are_in_the_table():
    named = {name.partition(",")[0] for name in COUNTED if not name.startswith("results.")}  # methods
    assert named | {*LONG_RUNS} == LIMITED.keys()


@pytest.mark.parametrize("name", [*COUNTED, *LONG_RUNS])
def test_whatever_is_asked_for_a_call_ends_at_its_limit_and_says_so(name):
    """Seconds that the process computes; two are for what goes on.

    Those of the clock are also those of other programs, and those of the system those of pages of memory, for which a
    virtual machine may take long.
    """
    call = COUNTED[name] if name in COUNTED else long_run(name)
    began = os.times().user
    try:
        found = call(time_limit=0.2)
        said = " ".join([repr(found), str(found), *np.unique(getattr(found, "outcome", "")).tolist()])
    except (TimeLimitError, EnclosureError) as error:
        said = str(error)
    assert os.times().user - began < 2.2
    assert "time limit" in said
    for n in re.findall(r"from up to (\d+)", said):
        assert int(n) < MANY


@pytest.mark.parametrize("t_end", [1e12, 1e300])
@pytest.mark.parametrize("name", ["periodic orbits", "homoclinic orbits"])
def test_too_long_a_search_is_refused_before_anything_is_made(name, t_end):
    with pytest.raises(MemoryLimitError, match=r"t_end: wanted what fits into memory; got [\d,]+ bytes"):
        SEARCHES[name](t_end=t_end)
