"""Functions on phase space as functions of arrays."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError


def test_exact_numbers_beyond_doubles_are_refused_where_they_are_evaluated():
    system = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2")
    function = system.functions.of(10**400 * system.variables[1] ** 2)
    for evaluate in (function, function.gradient):
        with pytest.raises(ParameterError, match=r"numbers that fit into doubles .*Rescale the system"):
            evaluate(np.ones(3))
