"""The check of a certificate of chaos in Arb's balls: every condition of the theorem, in the order of docs/proof.md."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import product

from flint import acb, arb, arb_mat

from liepoisson.algebra.sparse_polynomials import along
from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.covering import (
    CoveringMargins,
    Landing,
    Transition,
    covering,
    crossing_rate,
    diagonal,
    landing,
    length,
    transition,
)
from liepoisson.proofs.balls.field import BallField, Vector, ball, constants_of, magnitude, working
from liepoisson.proofs.balls.flow import Tube
from liepoisson.proofs.balls.sets import LARGEST_W, BallSet, Chart, chart, states_of
from liepoisson.proofs.certificate import ChainGraph, CoveringCertificate, Edge, Margins, Rotation, chain_graph
from liepoisson.proofs.polynomial_field import PolynomialField

SMALL = Fraction(1, 10)
"""Factor of the sets in which gamma is shown to be symmetric."""
TINY = Fraction(1, 10**12)
"""Factor of the sets in which the rotation numbers are measured."""
OFF_LEVEL = Fraction(1, 2**36)
"""Centers lie on the level up to this; a certificate is about the level that it names, not one nearby."""
NEAR = 0.3
"""Orbits near the middle set at times less than this from their own passage are no other passage."""
_NEWTON_STEPS = 2
"""After two, the orbit on a neighbouring level is known to 1e-12 of the size of its sets, and its times to 1e-16."""
_MOST_UNSTABLE = 2


def check_in_balls(
    certificate: CoveringCertificate, field: PolynomialField, keep_going: Callable[[float], object] | None = None
) -> Margins:
    """Verify a certificate.

    Args:
        certificate: What is claimed.
        field: The equations and constants of motion.
        keep_going: Called with the fraction that is done; whatever it raises ends the check.

    Raises:
        EnclosureError: a condition fails; the message names the first one.
    """
    started = time.perf_counter()
    with working():
        checker = _Checker(certificate, field, keep_going or (lambda _: None))
        return checker.margins(started)


class _Checker:
    """The sets of a certificate, and what was proved of them."""

    def __init__(
        self, certificate: CoveringCertificate, field: PolynomialField, keep_going: Callable[[float], object]
    ) -> None:
        self.k = self._unstable_directions(certificate, field)
        self.certificate, self.exact, self.keep_going = certificate, field, keep_going
        self.field = BallField(field)
        self.signs = certificate.symmetry
        self.graph: ChainGraph = chain_graph(
            len(certificate.sets), [(e.source, e.target, e.symmetry) for e in certificate.edges]
        )
        self.level = constants_of(certificate.level, self.field.constant_names, certificate.level_radius)
        self.sets = [
            BallSet(s.name, [arb(c) for c in s.center], arb_mat([[arb(e) for e in row] for row in s.frame]), self.k)
            for s in certificate.sets
        ]
        self.n_steps = 0
        self.n_done = 0

    def margins(self, started: float) -> Margins:
        """All conditions in their order."""
        edges = self.certificate.edges
        self._require_level()
        charts = [chart(self.field, s, self.level, s.unit) for s in self.sets]
        found: list[Transition] = []
        judged: list[CoveringMargins] = []
        for e in edges:
            found.append(self._transition(e, self.sets[e.source], charts[e.source], self.sets[e.target]))
            judged.append(covering(self._name(e), found[-1].landing))
        self._require_charts_over_images(found)
        self._require_single_visits(charts, found)
        small, small_charts, small_loop = self._small_loop()
        symmetric_q, reversers = self._require_symmetric_orbit(small, small_charts, small_loop, found)
        apart = self._require_separation(charts, found)
        times = self._loop_times(found)
        discriminant, rotations, undecided = self._rotation_margins(small_loop, found)
        return Margins(
            arithmetic="Arb balls",
            n_unstable=self.k,
            n_edges=len(edges),
            n_steps=self.n_steps,
            level_radius=str(self.certificate.level_radius),
            expansion=_down(min_of([m.expansion for m in judged])),
            contraction=_up(max_of([m.contraction for m in judged])),
            cone=_down(min_of([m.cone for m in judged])),
            reversers=reversers,
            symmetric_q=_up(symmetric_q),
            apart_from_orbit=_down(apart[0]),
            apart_from_excursion=_down(apart[1]),
            apart_from_image=_down(apart[2]),
            loop_times=(_up(times[0]), _up(times[1])),
            entropy=entropy_bound(*times),
            discriminant=discriminant,
            rotations=rotations,
            undecided=undecided,
            seconds=time.perf_counter() - started,
        )

    # form

    @staticmethod
    def _unstable_directions(certificate: CoveringCertificate, field: PolynomialField) -> int:
        """The number k of unstable directions: n coordinates are 2k, the flow, and the constants of motion.

        Raises:
            EnclosureError: the certificate has another form, or the system another dimension.
        """
        n, n_constants = len(field.names), len(field.constants)
        k, odd = divmod(n - 1 - n_constants, 2)
        if odd or not 1 <= k <= _MOST_UNSTABLE or len(certificate.symmetry) != n:
            raise EnclosureError(
                "the system: wanted levels of dimension 3 or 5, with a sign of the symmetry for each coordinate; got "
                f"{n} coordinates, {n_constants} constants of motion and {len(certificate.symmetry)} signs"
            )
        if set(certificate.level) != set(field.constants):
            raise EnclosureError(
                f"the level: wanted values of {', '.join(field.constants)}; got {', '.join(certificate.level)}"
            )
        for name, f in field.constants.items():
            if along(f, field.rates):
                raise EnclosureError(f"the system: {name} is not constant along orbits")
        if not field.is_kept_by(certificate.symmetry) or all(s == 1 for s in certificate.symmetry):
            raise EnclosureError(
                "the symmetry: the equations and constants of motion do not have it, or it changes nothing"
            )
        return k

    def _require_level(self) -> None:
        if not self.certificate.level_radius > 0:
            raise EnclosureError("the level: wanted a positive radius of the ball of levels")
        exact = constants_of(self.certificate.level, self.field.constant_names)
        for s in self.sets:
            for name, value, wanted in zip(
                self.field.constant_names, self.field.constants(s.center), exact, strict=True
            ):
                if not magnitude(value - wanted) < ball(OFF_LEVEL):
                    raise EnclosureError(f"set {s.name}: its center is not on the level, {name} differs")

    # coverings

    def _transition(
        self, edge: Edge, source: BallSet, proved: Chart, target: BallSet, time: arb | None = None
    ) -> Transition:
        self.keep_going(min(1.0, self.n_done / (len(self.certificate.edges) + 14)))
        self.n_done += 1
        after = arb(edge.time) if time is None else time
        found = transition(self.field, source, proved, target, time=after, signs=self.signs if edge.symmetry else None)
        self.n_steps += len(found.tubes) - 1
        return found

    def _name(self, edge: Edge) -> str:
        return f"edge {self.sets[edge.source].name} -> {self.sets[edge.target].name}"

    def _require_charts_over_images(self, found: Sequence[Transition]) -> None:
        """The charts are charts over all images, so that w is the only one there, too."""
        for number, target in enumerate(self.sets):
            q = target.unit
            for edge, t in zip(self.certificate.edges, found, strict=True):
                if edge.target == number:
                    q = [a.union(b) for a, b in zip(q, t.landing.q, strict=True)]
            chart(self.field, target, self.level, q)

    def _require_single_visits(self, charts: Sequence[Chart], found: Sequence[Transition]) -> None:
        """An orbit visits a set once at a time, and p_a in one of its two images only: so words belong to points.

        Two points of a set that an edge takes to one point lie on one orbit, at times that differ by less than twice
        the window; there is no zero of n . f on the first step, which is longer, so they are one point.
        """
        for edge, one in zip(self.certificate.edges, found, strict=True):
            first = one.tubes[0]
            rate = crossing_rate(self.field, self.sets[edge.source], first.box)
            if rate < 0:
                raise EnclosureError(
                    f"set {self.sets[edge.source].name}: wanted orbits that cross the section in the direction of the "
                    "frame's third part, the column of the flow"
                )
            if not (rate > 0 and 2 * one.landing.window < first.end):
                raise EnclosureError(
                    f"{self._name(edge)}: orbits may come back to the section where they start within twice the window"
                )
        start = self.graph.start
        box = self._box(start, charts)
        if not _distance(box, self._image(box)) > 0:
            raise EnclosureError(f"set {self.sets[start].name}: it may meet its image under the symmetry")

    # gamma

    def _small_loop(self) -> tuple[list[BallSet], list[Chart], list[Transition]]:
        """The short loop with sets that are smaller; it closes, too."""
        ends = (self.graph.start, self.graph.other)
        small = [self.sets[k].scaled(ball(SMALL)) for k in ends]
        charts = [chart(self.field, s, self.level, s.unit) for s in small]
        edges = [self.certificate.edges[e] for e in self.graph.short]
        loop = [self._transition(edges[k], small[k], charts[k], small[1 - k]) for k in (0, 1)]
        for k in (0, 1):
            covering(f"edge {small[k].name} -> {small[1 - k].name}", loop[k].landing)
        return small, charts, loop

    def _require_symmetric_orbit(
        self, small: Sequence[BallSet], charts: Sequence[Chart], loop: Sequence[Transition], found: Sequence[Transition]
    ) -> tuple[arb, tuple[tuple[int, ...], ...]]:
        """The images of gamma under a reverser pass through the sets, too: gamma is symmetric.

        A bound of their size, and two reversers: the loop carries the symmetry once, so it maps gamma to itself, too.
        """
        best: EnclosureError | None = None
        for signs in product((1, -1), repeat=self.field.n):
            if not self.exact.is_kept_by(signs, reverses_time=True):
                continue
            try:
                size = self._same_orbit(small, charts, loop, found, signs)
            except EnclosureError as error:
                best = best or error
                continue
            return size, (signs, tuple(a * b for a, b in zip(signs, self.signs, strict=True)))
        raise EnclosureError(f"the symmetry of gamma: no reverser maps it to itself provably ({best})")

    def _same_orbit(
        self,
        sets: Sequence[BallSet],
        charts: Sequence[Chart],
        loop: Sequence[Transition],
        found: Sequence[Transition],
        reverser: Sequence[int] | None,
    ) -> arb:
        """Prove that the orbit in small sets near p_a and p_b, or its image under a reverser, is gamma.

        Its points are moved along it to the sections of p_a and p_b, where they lie in the sets, and the flight times
        between them are those of the edges; there is one orbit only that does this. A bound of |q_u| and |q_s|.
        """
        ends = (self.graph.start, self.graph.other)
        landings: list[Landing] = []
        for k in (0, 1):
            states = states_of(sets[k], charts[k], sets[k].unit)
            if reverser is not None:
                # the loop carries the symmetry once, so the reversers at its two sets differ by it
                signs = reverser if k == 0 else [a * b for a, b in zip(reverser, self.signs, strict=True)]
                states = states.mapped(diagonal(signs))
            landings.append(landing(self.field, states, charts[k], self.sets[ends[k]]))
        sizes = [length(part) for one in landings for part in (one.q[: self.k], one.q[self.k :])]
        if not all(size < 1 for size in sizes) or not all(magnitude(w) < LARGEST_W for one in landings for w in one.w):
            raise EnclosureError("the orbit does not provably pass through the sets")
        shift = arb(0, 1) * (landings[0].window + landings[1].window)
        for k in (0, 1):
            # run backward, the flight from p_a to p_b is one from p_b to p_a
            edge = self.graph.short[k if reverser is None else 1 - k]
            difference = loop[k].time + shift - arb(self.certificate.edges[edge].time)
            if not magnitude(difference) < found[edge].landing.window:
                raise EnclosureError("the flight times of the orbit are not provably those of the edges")
        return max_of(sizes)

    def _rotation_margins(
        self, small_loop: Sequence[Transition], found: Sequence[Transition]
    ) -> tuple[float | None, tuple[Rotation, Rotation] | None, str]:
        """What is proved of the angle of the multipliers, and why that is not all.

        Two unstable multipliers may be real; everything but the theorem on integrals is true then, too.
        """
        if self.k == 1:
            return None, None, ""
        discriminant: float | None = None
        try:
            discriminant = _up(self._require_complex_multipliers(small_loop))
            return discriminant, self._rotations(small_loop, found), ""
        except EnclosureError as error:
            return discriminant, None, str(error)

    def _require_complex_multipliers(self, loop: Sequence[Transition]) -> arb:
        """T^2/4 - S + 2 < 0: no multiplier of gamma is real or on the unit circle, on any level of the ball."""
        trace, second = _coefficients(loop)
        discriminant = trace**2 / 4 - second + 2
        if not discriminant < 0:
            raise EnclosureError("the multipliers of gamma: they may be real")
        return discriminant

    def _rotations(self, small_loop: Sequence[Transition], found: Sequence[Transition]) -> tuple[Rotation, Rotation]:
        """The rotation numbers on two levels of the ball, which differ."""
        numbers: list[tuple[arb, Fraction]] = []
        step = Fraction(1, 2)
        while 2 * step > self.certificate.level_radius:  # both levels are in the ball
            step /= 2
        for shift in (-step, step):
            energies = {**self.certificate.level, "H": self.certificate.level["H"] + shift}
            level = constants_of(energies, self.field.constant_names)
            numbers.append((self._rotation(level, small_loop, found), energies["H"]))
        if numbers[0][0].overlaps(numbers[1][0]):
            raise EnclosureError("the rotation numbers on two levels: they may be equal")
        first, second = (Rotation(str(e), _down(r), _up(r)) for r, e in numbers)
        return first, second

    def _rotation(self, level: Vector, small_loop: Sequence[Transition], found: Sequence[Transition]) -> arb:
        """theta/pi on one level, from sets about the periodic orbit there that are shown to belong to gamma."""
        ends = (self.graph.start, self.graph.other)
        edges = [self.certificate.edges[e] for e in self.graph.short]
        sets = [self.sets[k].scaled(ball(TINY)) for k in ends]
        maps = [t.landing.slopes.mid() for t in small_loop]
        times = [arb(e.time) for e in edges]
        for _ in range(_NEWTON_STEPS):  # proposals, of which nothing is claimed
            charts, loop = self._loop(level, edges, sets, times)
            sets = self._moved(sets, charts, loop, maps)
            times = [arb(t.time.mid()) for t in loop]
        charts, loop = self._loop(level, edges, sets, times)
        for k in (0, 1):
            covering(f"edge {sets[k].name} -> {sets[1 - k].name} on a neighbouring level", loop[k].landing)
        self._same_orbit(sets, charts, loop, found, None)
        trace, second = _coefficients(loop)
        y = acb(trace / 2, (4 * (second - 2) - trace**2).sqrt() / 2)
        z = (y + (y * y - 4).sqrt()) / 2
        return abs(z.arg()) / arb.pi()

    def _loop(
        self, level: Vector, edges: Sequence[Edge], sets: Sequence[BallSet], times: Sequence[arb]
    ) -> tuple[list[Chart], list[Transition]]:
        """The charts of two sets on a level, and the maps between them."""
        charts = [chart(self.field, s, level, s.unit) for s in sets]
        return charts, [self._transition(edges[k], sets[k], charts[k], sets[1 - k], times[k]) for k in (0, 1)]

    @staticmethod
    def _moved(
        sets: Sequence[BallSet], charts: Sequence[Chart], loop: Sequence[Transition], maps: Sequence[arb_mat]
    ) -> list[BallSet]:
        """The sets about the periodic orbit that a step of Newton's method proposes; nothing is claimed of it."""
        n, (A, B) = maps[0].nrows(), maps
        a, b = [arb_mat(n, 1, [o.mid() for o in t.landing.offset]) for t in loop]
        identity = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        q_start = (identity - B * A).solve(B * a + b)
        q_other = A * q_start + a
        moved: list[BallSet] = []
        for s, c, q in zip(sets, charts, (q_start, q_other), strict=True):
            w = arb_mat(len(c.w), 1, c.w_center) + c.slopes * q
            center = s.states([arb(e.mid()) for e in q.entries()], [arb(e.mid()) for e in w.entries()])
            moved.append(BallSet(s.name, [arb(x.mid()) for x in center], s.frame, s.k))
        return moved

    # the excursion

    def _require_separation(self, charts: Sequence[Chart], found: Sequence[Transition]) -> tuple[arb, arb, arb]:
        """The middle set is away from gamma, from the excursion at other times, and from the image of all of it."""
        graph, middle = self.graph, self._box(self.graph.middle, charts)
        orbit = [t.box for e in graph.short for t in found[e].tubes]
        excursion = [t.box for e in graph.long for t in found[e].tubes]
        at_other_times, passage = self._away_from_passage(found)
        distances = (
            min_of([_distance(middle, b) for box in orbit for b in (box, self._image(box))]),
            min_of([_distance(middle, box) for box in at_other_times]),
            min_of([_distance(middle, self._image(box)) for box in excursion]),
        )
        for d, what in zip(
            distances, ("gamma", "the excursion at other times", "the image of the excursion"), strict=True
        ):
            if not d > 0:
                raise EnclosureError(f"separation: the middle set may meet {what}")
        self._require_times_apart(found, passage)
        return distances

    def _box(self, number: int, charts: Sequence[Chart]) -> Vector:
        """A box that contains a set."""
        return states_of(self.sets[number], charts[number], self.sets[number].unit).box()

    def _away_from_passage(self, found: Sequence[Transition]) -> tuple[list[Vector], arb]:
        """Boxes of the excursion away from the middle set's own passage, and a bound of |t| in those left out."""
        graph = self.graph
        kept: list[Vector] = []
        passage = arb(0)
        for place, e in enumerate(graph.long):
            one = found[e]
            for tube in one.tubes:
                span = _before(one, tube) if place == graph.middle_edge else tube.end
                near = not (_after(one, tube) > NEAR) if place == graph.middle_edge else not (tube.start > NEAR)
                if place in (graph.middle_edge, graph.middle_edge + 1) and near:
                    passage = passage.max(span.upper())
                else:
                    kept.append(tube.box)
        return kept, passage

    def _require_times_apart(self, found: Sequence[Transition], passage: arb) -> None:
        """Passages of two different sequences of loops do not coincide in time, so that the coding is injective."""
        graph = self.graph
        first = sum((found[e].time for e in graph.long[: graph.middle_edge + 1]), arb(0))
        whole = sum((found[e].time for e in graph.long), arb(0))
        short = sum((found[e].time for e in graph.short), arb(0))
        rest = whole - first
        spread = lambda t: t.upper() - t.lower()  # noqa: E731
        for holds in (
            short.lower() > spread(first) + spread(rest) + 2 * passage,
            first.lower() + rest.lower() - spread(first) - spread(rest) > 3 * passage,
        ):
            if not holds:
                raise EnclosureError("separation: passages of different loops may coincide in time")

    def _image(self, box: Vector) -> Vector:
        return [s * b for s, b in zip(self.signs, box, strict=True)]

    def _loop_times(self, found: Sequence[Transition]) -> tuple[arb, arb]:
        short, long = (sum((found[e].time for e in loop), arb(0)) for loop in (self.graph.short, self.graph.long))
        if not (short > 0 and long > 0):
            raise EnclosureError("the flight times of the loops: they are not provably positive")
        return arb(short.upper()), arb(long.upper())


def entropy_bound(short: arb, long: arb) -> float:
    """A number h, proved to be below the solution of e^(-h t_1) + e^(-h t_2) = 1, which bounds entropy from below."""
    below, above = 0.0, math.log(2.0) / float(short.lower()) + 1
    while (middle := (below + above) / 2) not in (below, above) and above - below > 1e-12:
        if (-arb(middle) * short).exp() + (-arb(middle) * long).exp() > 1:
            below = middle
        else:
            above = middle
    return below


def _coefficients(loop: Sequence[Transition]) -> tuple[arb, arb]:
    """The coefficients T and S of z^4 - T z^3 + S z^2 - T z + 1, the characteristic polynomial of the loop."""
    matrix = loop[1].landing.slopes * loop[0].landing.slopes
    trace = matrix.trace()
    return trace, (trace**2 - (matrix * matrix).trace()) / 2


def _before(one: Transition, tube: Tube) -> arb:
    return one.time + one.landing.window - tube.start


def _after(one: Transition, tube: Tube) -> arb:
    return one.time - one.landing.window - tube.end


def _distance(a: Vector, b: Vector) -> arb:
    """A lower bound of the distance of two boxes, in the largest component."""
    return max_of([abs(x - y).lower() if (x - y).is_finite() else arb(0) for x, y in zip(a, b, strict=True)])


def max_of(values: Sequence[arb]) -> arb:
    """The largest of several balls, as a ball."""
    found = values[0]
    for value in values[1:]:
        found = found.max(value)
    return found


def min_of(values: Sequence[arb]) -> arb:
    """The smallest of several balls, as a ball."""
    found = values[0]
    for value in values[1:]:
        found = found.min(value)
    return found


def _down(x: arb) -> float:
    """A double below a ball, for printing."""
    return math.nextafter(float(x.lower()), -math.inf)


def _up(x: arb) -> float:
    """A double above a ball, for printing."""
    return math.nextafter(float(x.upper()), math.inf)
