"""What a checker of a chain of covering relations reports: how far each condition of the theorem holds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Rotation:
    """The rotation number theta/pi of the multipliers of the periodic orbit on one level, between two bounds.

    Attributes:
        energy: The energy, as text.
        lower: Bound from below.
        upper: Bound from above.
    """

    energy: str
    lower: float
    upper: float


@dataclass(frozen=True)
class Margins:
    """The conditions of a certificate that one arithmetic has verified, rounded to the safe side for printing.

    All numbers hold for every level in the ball |H - H_0|, |C_k - C_k0| <= `level_radius`.

    Attributes:
        arithmetic: Which arithmetic it was.
        n_unstable: Number of unstable multipliers of the periodic orbit, k; as many are stable.
        n_edges: Number of covering relations.
        n_steps: Number of rigorous steps of integration.
        level_radius: Radius of the ball of levels.
        expansion: The least |q_u| of images of |q_u| = 1, over all edges; above 1.
        contraction: The largest |q_s| of images; below 1.
        cone: The least margin of the cone conditions; positive.
        reversers: The changes of signs that map the periodic orbit to itself, run backward.
        symmetric_q: The largest |q_u| and |q_s| of images of the small sets under the reversers; below 1.
        apart_from_orbit: Least distance, in the largest component, of the middle set to the orbits near gamma.
        apart_from_excursion: Least distance to the excursion at other times.
        apart_from_image: Least distance to the image of the excursion under the symmetry.
        loop_times: Upper bounds of the flight times of the two loops.
        entropy: Lower bound of the topological entropy of the flow on the invariant set, in E/R and in E.
        discriminant: Upper bound of T^2/4 - S + 2 of the characteristic polynomial of gamma; negative. None where it is
            not proved to be, and for one unstable multiplier.
        rotations: Rotation numbers on two levels, which differ; None where that is not proved.
        undecided: What was not proved of the multipliers; empty where nothing is missing.
        seconds: Time of the check.
    """

    arithmetic: str
    n_unstable: int
    n_edges: int
    n_steps: int
    level_radius: str
    expansion: float
    contraction: float
    cone: float
    reversers: tuple[tuple[int, ...], ...]
    symmetric_q: float
    apart_from_orbit: float
    apart_from_excursion: float
    apart_from_image: float
    loop_times: tuple[float, float]
    entropy: float
    discriminant: float | None
    rotations: tuple[Rotation, Rotation] | None
    undecided: str
    seconds: float

    @property
    def excludes_integrals(self) -> bool:
        """Whether the theorem on further analytic constants of motion applies.

        One unstable multiplier asks for nothing beyond the transversal homoclinic orbit, two for a rotation number that
        is irrational on almost all levels.
        """
        return self.n_unstable == 1 or self.rotations is not None
