"""How long do the proof of chaos, the search for a certificate, and a list of periodic orbits take?

`python benchmarks/proofs.py`.  Whole calls in one thread, without the imports: the check of the shipped certificate by
each arithmetic (once), the search for a new one (once), and distinct symmetric periodic orbits on the level of the
theorem (the least of three).  No other tool does these, so the times stand alone.
"""

from __future__ import annotations

import liepoisson as lp
from integrals import timed

TOP = lp.Top.twisted_kovalevskaya()
LEVEL, ENERGY = {"C1": "1", "C2": "1/2", "C3": "1"}, "1/2"


def main() -> None:
    """One line for each call."""
    lp.orbits.symmetric_periodic_orbits(TOP, LEVEL, ENERGY, n_starts=1, t_end=2, threads=1)  # imports
    proof, seconds = timed(lambda: lp.proofs.prove_chaos(TOP), 1)
    for margins in proof.margins:
        print(f"{margins.arithmetic:12} {margins.seconds:7.2f} s  {margins.n_steps} rigorous steps")
    print(f"{'prove, all':12} {seconds:7.2f} s  with the regularity of the level, exactly")
    found, seconds = timed(lambda: lp.proofs.find_certificate(TOP, LEVEL, ENERGY), 1)
    print(f"{'search':12} {seconds:7.2f} s  {len(found.chain.record()['sets'])} sets")
    orbits, seconds = timed(lambda: lp.orbits.symmetric_periodic_orbits(TOP, LEVEL, ENERGY, threads=1), 3)
    print(f"{'orbits':12} {seconds:7.2f} s  {len(orbits)} distinct orbits")


if __name__ == "__main__":
    main()
