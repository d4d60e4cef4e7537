"""A first result of an installed package: does it import from where it was installed, and compute, save and read?

Run it with the Python of the environment that is asked; the folder does not matter:

    /path/to/environment/bin/python /path/to/repository/.ci/first_result.py
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import liepoisson as lp

EQUATION = "l2*l3/2"
"""The first equation of the twisted Kovalevskaya top, derived from its bracket."""


def main() -> None:
    """Computes sixteen exponents, writes them to a file and repeats them from it."""
    place = Path(lp.__file__).resolve()
    if not place.is_relative_to(Path(sys.prefix).resolve()):
        raise SystemExit(f"liepoisson comes from {place}, and not from the environment {sys.prefix}")
    top = lp.Top.twisted_kovalevskaya()
    found = str(next(iter(top.equations.values())))
    if found != EQUATION:
        raise SystemExit(f"l1' is {found}; {EQUATION} is right")
    growth = lp.finite_time_exponents(top, lp.sample_states(top, 16, seed=1), t_end=50)
    if not (growth.outcome == "finished").all():
        raise SystemExit(f"not all trajectories finished: {sorted(set(growth.outcome.tolist()))}")
    with tempfile.TemporaryDirectory() as folder:
        again = lp.rerun(growth.save(Path(folder) / "growth.nc"))
    if not np.array_equal(again.exponent, growth.exponent):
        raise SystemExit("the rerun of a saved result has other bits")
    exponent = growth.exponent[:, -1]
    print(f"liepoisson {lp.__version__} in {place.parent}")
    print(f"16 trajectories finished, kernel {growth.kernel}, mean exponent {exponent.mean():.6f}; rerun: the same")


if __name__ == "__main__":
    main()
