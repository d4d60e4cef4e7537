"""The search for a certificate of chaos, its chain of sets, and the check in floating-point numbers."""

import json
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, OrbitError, ParameterError
from liepoisson.proofs.certificate import FORMAT
from liepoisson.proofs.chain import Chain, Edge, float_check
from liepoisson.proofs.search import find_certificate

TOP = lp.Top.kovalevskaya(epsilon=1)
LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}
R1 = (1, -1, -1) * 3


@pytest.fixture(scope="session")
def candidate(shared_by_workers):
    return shared_by_workers("candidate", lambda: find_certificate(TOP, LEVEL, "1/2"))


def changed(chain, name, center=None, frame=None):
    """The chain with another centre or frame of one set."""
    sets = tuple(
        replace(
            one,
            center=one.center if center is None else center(one.center),
            frame=one.frame if frame is None else frame(one.frame),
        )
        if one.name == name
        else one
        for one in chain.sets
    )
    return Chain(chain.level, chain.symmetry, sets, chain.edges)


@pytest.mark.thorough
def test_the_twisted_kovalevskaya_top_has_a_candidate(candidate):
    """27 sets; rigorous bounds of such a chain are 1.2754 and 0.8180, so what is not rigorous is better."""
    chain, check = candidate.chain, candidate.check
    assert len(chain.sets) == 27
    assert len(chain.edges) == 28
    assert chain.symmetry == R1
    assert check.passes
    assert 1.2754 < check.covering < 1.4
    assert 0.7 < check.stable < 0.8180
    assert abs(sum(e.time for e in chain.edges[2:]) - 40.6756) < 5e-5
    assert [e.symmetry for e in chain.edges] == [False, True, *[False] * 25, True]
    assert "not proved" in repr(candidate)


@pytest.mark.thorough
def test_every_edge_leads_to_the_next_set(candidate):
    """Centres are points of one orbit to round-off, but for the ends of the excursion near the periodic orbit."""
    chain = candidate.chain
    by_name = {one.name: one for one in chain.sets}
    for edge in chain.edges:
        end = lp.integrate(TOP, by_name[edge.source].center, times=[0, edge.time]).state[0, -1]
        end = end * np.array(R1) if edge.symmetry else end
        near = 2e-4 if {edge.source, edge.target} == {"p_a", "q1"} or edge.source == "q25" else 1e-9
        np.testing.assert_allclose(end, by_name[edge.target].center, atol=near, err_msg=repr(edge))


@pytest.mark.thorough
def test_frames_are_what_they_say(candidate):
    """u and s in the level across the flow, then the flow, then the gradients; s is the mirror image of u."""
    chain = candidate.chain
    by_name = {one.name: one for one in chain.sets}
    for one in chain.sets:
        c, B = one.center, one.frame
        np.testing.assert_allclose(B[:, 2], TOP.vector_field(c), atol=1e-14)
        np.testing.assert_allclose(B[:, 5:].T, chain.level.gradients(c), atol=1e-14)
        np.testing.assert_allclose(B[:, 2:3].T @ B[:, [0, 1, 3, 4]], 0, atol=1e-16)
        np.testing.assert_allclose(B[:, 5:].T @ B[:, [0, 1, 3, 4]], 0, atol=1e-16)
        # the adapted norm is larger than the plain one
        assert np.linalg.norm(B[:, :2], 2) <= 1e-4
    rho = candidate.homoclinic.reverser
    np.testing.assert_allclose(by_name["q5"].frame[:, 3:5], rho(by_name["q21"].frame[:, :2].T).T, atol=1e-18)
    np.testing.assert_allclose(by_name["q5"].center, rho(by_name["q21"].center), atol=1e-15)


@pytest.mark.thorough
def test_the_check_refuses_what_is_wrong(candidate):
    chain = candidate.chain
    assert not float_check(changed(chain, "q13", center=lambda c: c + 2e-4 * np.eye(9)[0])).passes
    assert not float_check(changed(chain, "q7", frame=lambda B: B[:, [3, 4, 2, 0, 1, 5, 6, 7, 8]])).passes
    assert not float_check(changed(chain, "p_a", frame=lambda B: B @ np.diag([9, 9, 1, 1, 1, 1, 1, 1, 1]))).passes
    without = tuple(replace(e, symmetry=False) for e in chain.edges)
    assert not float_check(Chain(chain.level, chain.symmetry, chain.sets, without)).passes
    crossed = (Edge("q3", "q5", chain.edges[4].time, False),)
    assert not float_check(Chain(chain.level, chain.symmetry, chain.sets, crossed)).passes


@pytest.mark.thorough
def test_the_record_is_the_chain(candidate, tmp_path):
    found = json.loads(candidate.save(tmp_path / "certificate.json").read_text())
    assert list(found) == ["format", "system", "level", "level_radius", "symmetry", "sets", "edges"]
    assert found["format"] == FORMAT
    assert found["system"]["name"] == "twisted Kovalevskaya top"
    assert found["system"]["equations"]["alpha2"] == "-alpha1*l3 + alpha3*l1/2 - beta3"
    assert found["level"] == {"H": "1/2", "C1": "1", "C2": "1/2", "C3": "1"}
    for one, wanted in zip(found["sets"], candidate.chain.sets, strict=True):
        assert [float.fromhex(v) for v in one["center"]] == wanted.center.tolist()
        assert [[float.fromhex(v) for v in row] for row in one["frame"]] == wanted.frame.tolist()
    assert found["edges"][1]["symmetry"] is True
    assert float.fromhex(found["edges"][0]["time"]) == candidate.orbit.time


@pytest.mark.slow
def test_the_search_is_deterministic_and_near_the_file_of_the_package(candidate):
    """The same bits again; the file may have been made on another machine: centres agree to 1e-9."""
    again = find_certificate(TOP, LEVEL, "1/2")
    assert again.chain.record() == candidate.chain.record()
    shipped = json.loads(files("liepoisson.proofs").joinpath("twisted_kovalevskaya.json").read_text())
    ours = candidate.chain.record()
    assert shipped["system"] == ours["system"]
    assert shipped["level"] == ours["level"]
    assert shipped["symmetry"] == ours["symmetry"]
    for one, other in zip(shipped["sets"], ours["sets"], strict=True):
        assert one["name"] == other["name"]
        got = [[float.fromhex(v) for v in each["center"]] for each in (one, other)]
        np.testing.assert_allclose(*got, atol=1e-9)


@pytest.mark.thorough
def test_other_levels_and_systems_fail_honestly():
    with pytest.raises(LeafError, match="has an equilibrium"):
        find_certificate(TOP, {"C1": "9.6", "C2": -2, "C3": 1}, "3.96")
    integrable = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/4 + l2^2/4 + l3^2/2 - alpha1")
    with pytest.raises(OrbitError, match="no chain of sets"):
        find_certificate(integrable, {"C1": "1/2", "C2": 1}, 1, n_starts=40)
    with pytest.raises(ParameterError, match="must have a reverser"):
        find_certificate(lp.Top.twisted((3, 2, 1), (1, "1/2", "1/3"), (1, 0, 1)), LEVEL, 1)
    with pytest.raises(ParameterError, match="kappa"):
        find_certificate(TOP, LEVEL, "1/2", kappa=1)
    with pytest.raises(ParameterError, match="radius"):
        find_certificate(TOP, LEVEL, "1/2", radius=-1)
