"""Files of systems whose equations another compiler has written otherwise: what counts is the values."""

from dataclasses import replace

import numpy as np
import pytest

import liepoisson as lp

PAIR = lp.brackets.canonical(2)
POTENTIALS = {
    "as it is typed": "exp(q1 - q2) + cos(q1)",
    "grouped otherwise": "exp(q1)/exp(q2) + 1 - 2*sin(q1/2)^2",
    "another system": "exp(q1 - q2) + cos(q1)*1.0000001",
}


def with_tape_of(name, tmp_path):
    """An orbit of the first system that was integrated with the tape of another text."""
    typed, other = (lp.System(PAIR, f"p1^2/2 + p2^2/2 + {POTENTIALS[text]}") for text in ("as it is typed", name))
    assert typed.field() != other.field() or name == "as it is typed"
    run = lp.integrate(typed, [[0.1, 0.2, 0, 0.3], [0, 0, 0, 0]], t_end=2)
    return run, replace(run, field=other.field()).save(tmp_path / "orbit.nc")


def test_a_tape_with_the_same_values_is_that_of_the_system(tmp_path):
    run, path = with_tape_of("grouped otherwise", tmp_path)
    loaded = lp.load(path)
    assert loaded.field != run.field
    np.testing.assert_allclose(lp.rerun(path).state, run.state, atol=1e-13)


def test_a_tape_with_other_values_is_not(tmp_path):
    _, path = with_tape_of("another system", tmp_path)
    with pytest.raises(lp.errors.DamagedFileError, match="its equations are not those of the field"):
        lp.load(path)
