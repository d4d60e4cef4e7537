r"""The search for a certificate of chaos on a level: a periodic orbit, a homoclinic orbit, and the chain along them.

Nothing here is rigorous and nothing need be: what is found is checked by a program that does not trust it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.equilibrium.leaf_equilibria import equilibria
from liepoisson.errors import EnclosureError, LeafError, OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_number
from liepoisson.inputs.calls import explains_its_methods, shows_progress
from liepoisson.inputs.deadline import checkpoint
from liepoisson.io.files import write_json
from liepoisson.leaf._checks import as_system
from liepoisson.numeric.run_options import RunOptions, part_of
from liepoisson.orbits.homoclinic import symmetric_homoclinic_orbits
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.symmetric_orbits import reversers_of, symmetric_periodic_orbits
from liepoisson.portable import linear
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.chain import Chain, ChainMaker, FloatCheck, float_check, with_polished_ends
from liepoisson.proofs.interval_checker import check_in_intervals
from liepoisson.proofs.polynomial_field import PolynomialField, polynomial_field

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.homoclinic_orbits import HomoclinicOrbit
    from liepoisson.orbits.multipliers import SymmetricOrbit

_MOST_ORBITS, _MOST_HOMOCLINIC, _COMPARED = 4, 12, 6
"""Periodic orbits that are tried, homoclinic orbits to each, and among how many of these the best is taken."""

_SMALLER = (1, 10, 100)
"""By how much the sets and the ball of levels are made smaller, in turn, until a chain is accepted in intervals."""

_CRITICAL = 1e-9
"""Energies this near to that of an equilibrium, relative to the range of equilibria, count as equal."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class CertificateCandidate:
    """A chain of sets that a checker may accept.

    Attributes:
        orbit: The periodic orbit.
        homoclinic: The homoclinic orbit.
        chain: Sets and edges.
        check: Its conditions in floating-point numbers, which prove nothing.
    """

    orbit: SymmetricOrbit
    homoclinic: HomoclinicOrbit
    chain: Chain
    check: FloatCheck

    def save(self, path: str | Path) -> Path:
        """Writes the certificate as JSON.

        Raises:
            OutputError: the file cannot be written.
            OrbitError: a value of the level is no rational number.
        """
        path = Path(path)
        write_json(path, self.chain.record())
        return path

    def __repr__(self) -> str:
        return (
            f"<CertificateCandidate of {self.orbit.system.name!r} on {self.orbit.level.text}: {len(self.chain.sets)} "
            f"sets, {len(self.chain.edges)} edges; covering {self.check.covering:.4f} (> 1), stable "
            f"{self.check.stable:.4f} (< 1), in floating-point numbers; not proved>"
        )


@shows_progress
def find_certificate(
    system: System,
    leaf: Leaf | Mapping[str, float | str],
    energy: float | str,
    *,
    radius: float = 1e-4,
    kappa: float = 1.3,
    n_starts: int = 200,
    t_end: float | None = None,
    seed: int = 0,
    threads: int | None = 1,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> CertificateCandidate:
    """Searches a periodic orbit with a transversal homoclinic orbit and sets along both that map across one another.

    The hyperbolic periodic orbits between the fixed sets of two reversers, whose product is then a symmetry that closes
    half of the loop, are tried in turn, those with the largest growth rates first, with the symmetric homoclinic orbits
    to them that the symmetry closes, too, and that have the shortest flights. The first chains whose conditions hold in
    floating-point numbers are checked in intervals, those with the largest margins first, with smaller sets and a
    smaller ball of levels where they are not accepted. If none is, the one with the largest margins is returned, and a
    checker will say what it lacks.

    Example:
        >>> top = lp.catalog.heavy_top_on("so(3)", [1, 1, 2], [1, 0, 0])
        >>> found = lp.proofs.find_certificate(top, {"C1": "1/2", "C2": 1}, 1, n_starts=20)
        >>> len(found.chain.sets), found.check.passes  # in floating-point numbers
        (17, True)
        >>> lp.proofs.prove_chaos(top, found, arithmetics=["intervals"]).excludes_integrals
        True

    Args:
        system: A system with polynomial equations and reversers.
        leaf: A regular leaf, or the values of the Casimirs by name; texts are exact.
        energy: The value of the Hamiltonian; a text is exact.
        radius: The size of the sets.
        kappa: The growth per segment that the adapted norm is made for.
        n_starts: How many starts the searches for orbits have, for each pair of reversers.
        t_end: The longest segment of a periodic orbit.
        seed: Draws them.
        threads: How many.
        time_limit: Seconds after which the search is given up.  What is found does not depend on it.

    Raises:
        LeafError: the leaf is not regular, or the level has an equilibrium.
        OrbitError: no chain was found; the message says how far the search came.
        ParameterError: the system has no suitable reversers, or no polynomial equations.
        TimeLimitError: the time limit has passed.
    """
    system, radius = as_system(system), _positive(radius, "radius")
    kappa = _positive(kappa, "kappa")
    n_starts, run = (
        as_count(n_starts, "n_starts", least=1),
        RunOptions.read(None, threads, time_limit, progress, seed=seed),
    )
    if kappa <= 1:
        raise ParameterError(f"kappa: wanted a number above 1; got {kappa:g}; try 1.3")
    with run.deadline.running():
        return _found(system, leaf, energy, run, radius=radius, kappa=kappa, n_starts=n_starts, t_end=t_end)


def _found(
    system: System,
    leaf: Leaf | Mapping[str, float | str],
    energy: float | str,
    run: RunOptions,
    *,
    radius: float,
    kappa: float,
    n_starts: int,
    t_end: float | None,
) -> CertificateCandidate:
    """As `find_certificate`, before the deadline of the call: a search that it cut short would find something else."""
    field = polynomial_field(system)
    level = level_of(system, leaf, energy)
    _check_that_it_has_no_equilibrium(level, run.left)
    families = _closed_by_signs(reversers_of(level))
    orbits: list[SymmetricOrbit] = []
    without: list[LeafError] = []
    for k, reversers in enumerate(families):
        try:
            orbits += symmetric_periodic_orbits(
                system,
                leaf,
                energy,
                reversers=reversers,
                n_starts=n_starts,
                t_end=t_end,
                seed=run.seed,
                threads=run.threads,
                time_limit=run.left,
                progress=part_of(run.progress, 0.4 * k / len(families), 0.4 / len(families)),
            )
        except LeafError as error:  # the fixed sets of these do not meet the level
            without.append(error)
        checkpoint("the search for periodic orbits")
    if len(without) == len(families):
        raise without[0]
    # the adapted norm needs a growth of kappa in each half of a loop, and the checkers a symmetry that closes it
    hyperbolic = [one for one in orbits if one.slowest > kappa**2 and one.first is not one.last]
    hyperbolic.sort(key=lambda one: (-round(one.rate, 9), one.period))
    tried: list[str] = []
    refused: list[CertificateCandidate] = []
    for k, orbit in enumerate(hyperbolic[:_MOST_ORBITS]):
        maker = ChainMaker(with_polished_ends(orbit), radius, kappa)
        found = symmetric_homoclinic_orbits(
            orbit,
            reversers=[orbit.last],  # then the excursion is closed by the symmetry, too
            n_starts=2 * n_starts,
            seed=run.seed,
            threads=run.threads,
            time_limit=run.left,
            progress=part_of(run.progress, 0.4 + 0.6 * k / _MOST_ORBITS, 0.6 / _MOST_ORBITS),
        )
        checkpoint("the search for homoclinic orbits")
        tried.append(f"{len(found)} homoclinic orbits to that of period {orbit.period:.6g}")
        passed: list[CertificateCandidate] = []
        for number, homoclinic in enumerate(found[:_MOST_HOMOCLINIC]):
            if passed and number >= _COMPARED:
                break
            checkpoint("a chain along a homoclinic orbit")
            try:
                chain = maker.along(homoclinic)
            except OrbitError as error:
                tried.append(str(error))
                break
            check = float_check(chain, seed=run.seed)
            angle = float(homoclinic.angles.min())
            tried.append(f"manifolds at {angle:.2g} rad: covering {check.covering:.3g}, stable {check.stable:.3g}")
            if check.passes:
                passed.append(CertificateCandidate(maker.orbit, homoclinic, chain, check))
        passed.sort(key=lambda one: -min(one.check.covering - 1, 1 - one.check.stable))
        accepted = _accepted(passed, maker, field, run.seed)
        if accepted is not None:
            return accepted
        refused += passed
    if refused:
        return refused[0]
    raise OrbitError(
        f"no chain of sets was found on {level.text}, with covering above 1 and stable below 1: {len(orbits)} "
        f"symmetric periodic orbits, {len(hyperbolic)} of them between two reversers and with all unstable "
        f"multipliers above kappa^2; {'; '.join(tried) or 'nothing to try'}. "
        + (
            "Manifolds that meet at small angles need a smaller radius or another level; or take more starts."
            if tried
            else "Take more starts, a larger t_end, or another level."
        )
    )


def _closed_by_signs(reversers: Sequence[DiscreteSymmetry]) -> list[list[DiscreteSymmetry]]:
    """The reversers in families that exchange the same components: products of two of one only change signs.

    A certificate says the symmetry that closes half of a loop by signs.  An orbit that meets fixed sets of several
    families is found in each, with another half of its loop.
    """
    families: dict[tuple[int, ...], list[DiscreteSymmetry]] = {}
    for one in reversers:
        families.setdefault(one.permutation, []).append(one)
    return list(families.values())


def _accepted(
    candidates: list[CertificateCandidate], maker: ChainMaker, field: PolynomialField, seed: int
) -> CertificateCandidate | None:
    """The first candidate that is accepted in intervals, from which all of the theorem follows if there is one."""
    less: CertificateCandidate | None = None
    for factor in _SMALLER:
        for candidate in candidates:
            checkpoint("the check of a chain in intervals")
            smaller = candidate if factor == 1 else _made_smaller(candidate, maker, factor, seed)
            if smaller is None:
                continue
            try:
                margins = check_in_intervals(read_certificate(smaller.chain.record()), field)
            except EnclosureError:
                continue
            if margins.excludes_integrals:
                return smaller
            less = less or smaller
    return less


def _made_smaller(
    candidate: CertificateCandidate, maker: ChainMaker, factor: int, seed: int
) -> CertificateCandidate | None:
    """The candidate with smaller sets and a smaller ball of levels; None if these fail in floating-point numbers.

    Images are curved less over smaller sets, but a change of level moves them by a larger part of their size.
    """
    try:
        chain = replace(maker, radius=maker.radius / factor).along(candidate.homoclinic)
    except (OrbitError, linear.LinAlgError):
        return None
    chain = replace(chain, level_radius=chain.level_radius / factor)
    check = float_check(chain, seed=seed)
    return replace(candidate, chain=chain, check=check) if check.passes else None


def _check_that_it_has_no_equilibrium(level: Level, time_limit: float) -> None:
    """Refuse a level on which H is critical: it is not regular there."""
    every = equilibria(level.system, level.leaf, n_starts=50, time_limit=time_limit)
    checkpoint("the search for equilibria")
    energies = np.array([one.energy for one in every])
    wanted = float(level.values["H"])  # pyright: ignore[reportArgumentType]  # a number
    if not len(energies):
        return
    scale = max(float(np.ptp(energies)), abs(wanted), 1e-300)
    near = np.abs(energies - wanted) <= _CRITICAL * scale
    if near.any():
        raise LeafError(
            f"a level must be regular; {level.text} has an equilibrium, {every[int(np.argmax(near))].state}. "
            "Take another energy."
        )


def _positive(value: Any, name: str) -> float:
    number = as_number(value, name, "a positive number")
    if not (np.isfinite(number) and number > 0):
        raise ParameterError(f"{name}: wanted a positive number; got {number!r}")
    return number
