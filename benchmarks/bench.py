"""The rows of the top: who takes part in each, with the setting that the measured errors allow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import calibrate
import families
import measure
import problem
import reference
from calibrate import Setting
from families import Family
from measure import Contender, Row

REPEATS = 5
LOOK_ROUNDS = 2
"""Rounds of the look that finds heyoka's batch size, and the family whose AVX2 kernel is measured too."""
SINGLE_LEVEL = 1e-14
"""Round-off: on both sides errors stop falling just below it."""
SINGLE_TOLERANCE = 1e-15
"""What a user types who wants round-off, on either side."""
SINGLE_PRECISION_LEVEL = 1e-4
BATCHES = {"double": (4, 8), "single": (8, 16)}
FAST_MATH: dict[str, Any] = {"flags": {"fast_math": True}}
"""Not heyoka's default, and it lets the compiler reorder roundings; faster on some machines, so it takes part."""
RESULTS = measure.HERE / "results"

Chosen = tuple[Setting, bool]
"""A setting, and whether it meets the level."""


def prepare(path: Path) -> tuple[problem.Array, problem.Array]:
    """Write starts and first tangent vectors for all sides; the latter are those that liepoisson itself draws."""
    from liepoisson.numeric.sampling import sample_tangents

    x0, tangents = problem.starts(), sample_tangents(9, problem.N_STARTS, seed=problem.SEED)
    path.parent.mkdir(exist_ok=True)
    np.save(path, np.concatenate([x0, tangents], axis=1))
    return x0, tangents


class Bench:
    """Makes the rows; what a side reaches with each setting is found when it is first asked for."""

    def __init__(self, problem_file: Path, exact: reference.Extended, avx2: bool) -> None:
        self.exact = exact
        self.common: dict[str, Any] = {"problem": str(problem_file)}
        self.avx2 = avx2
        self._scans: dict[str, list[Setting]] = {}

    def _scan(self, name: str, side: str, request: Callable[[], dict[str, Any]]) -> list[Setting]:
        if name not in self._scans:
            asked = self.common | {"single": False} | request()
            self._scans[name] = calibrate.scan(side, asked, self.exact, RESULTS)
        return self._scans[name]

    def ours(self, family: Family, single: bool = False) -> list[Setting]:
        """Errors of one of our families."""
        return self._scan(
            f"{family.name}{' single' if single else ''}",
            "liepoisson",
            lambda: {"methods": family.requests(), "single": single},
        )

    def heyoka(self, precision: str = "double", single: bool = False) -> list[Setting]:
        """Errors of heyoka, by the order of its series."""
        orders = calibrate.HEYOKA_ORDERS if precision == "double" else calibrate.HEYOKA_SINGLE_ORDERS
        batch = BATCHES[precision][-1]  # a scan's result does not depend on it
        return self._scan(
            f"heyoka {precision}{' single' if single else ''}",
            "heyoka",
            lambda: {"orders": list(orders), "batch": batch, "precision": precision, "single": single},
        )

    def contender(self, name: str, side: str, request: dict[str, Any], chosen: Chosen, **more: Any) -> Contender:
        """One side with its choice added to the request."""
        setting, meets = chosen
        asked = self.common | request | setting.request
        return Contender(name, side, asked, asdict(setting) | {"meets": meets}, **more)

    def _of_family(self, family: Family, request: dict[str, Any], level: tuple[float, float]) -> Contender:
        chosen = calibrate.loosest(self.ours(family), *level, family.judged_by_tangent)
        return self.contender(f"liepoisson {family.name}", "liepoisson", request, chosen, kind=family.precision)

    def heyoka_at(self, level: float, request: dict[str, Any], precision: str = "double") -> list[Contender]:
        """heyoka with the batch size that is fastest here, with its default flags and with `fast_math`."""
        chosen = calibrate.loosest(self.heyoka(precision), level, level)
        request = request | {"precision": precision}
        batches = [
            self.contender(f"{batch}", "heyoka", request | {"batch": batch}, chosen) for batch in BATCHES[precision]
        ]
        batch = int(quickest(batches).name)
        name = "heyoka" + ("" if precision == "double" else ", single precision") + f", batch {batch}"
        request = request | {"batch": batch}
        fast = self._scan(
            f"heyoka {precision} fast_math {chosen[0].order}",
            "heyoka",
            lambda: request | FAST_MATH | {"orders": [chosen[0].order]},
        )
        reordered = calibrate.loosest(fast, level, level)
        return [
            self.contender(name, "heyoka", request, chosen),
            self.contender(f"{name}, fast_math", "heyoka", request | FAST_MATH, reordered),
        ]

    def _level(self, level: float, members: list[Family], title: str, precision: str) -> Row:
        """All families at one level; the quickest also with errors as small as heyoka's, and each precision by AVX2."""
        request: dict[str, Any] = {"task": "ensemble", "t_end": problem.T_END, "repeats": REPEATS}
        theirs = self.heyoka_at(level, request, precision)
        ours = [self._of_family(family, request, (level, level)) for family in members]
        best = quickest([one for one in ours if one.kind != "mixed"])
        family = members[ours.index(best)]
        errors = (theirs[0].setting["state"], theirs[0].setting["tangent"])
        strict = self._of_family(family, request, errors)
        extra = [Contender(f"{best.name}, both errors at most heyoka's", "liepoisson", strict.request, strict.setting)]
        if self.avx2:
            chosen = [best, *(one for one in ours if one.kind == "mixed")]
            extra += [Contender(f"{one.name}, AVX2", one.side, one.request, one.setting, "avx2") for one in chosen]
        return Row(title, [*theirs, *ours, *extra], problem.N_STARTS * problem.T_END)

    def ensemble(self, level: float) -> Row:
        """Exponents of the whole ensemble at one level of accuracy, in double and in mixed precision."""
        title = f"Ensemble exponent at {problem.shown(level)}: {problem.N_STARTS} starts, t = 0..{problem.T_END:g}"
        return self._level(level, families.AT_LEVEL[level], title, "double")

    def single_precision(self) -> Row:
        """Statistics of exponents, all in single precision on both sides."""
        level = SINGLE_PRECISION_LEVEL
        size = f"{problem.N_STARTS} starts, t = 0..{problem.T_END:g}"
        title = f"Statistics of exponents in single precision at {problem.shown(level)}: {size}"
        return self._level(level, families.SINGLE, title, "single")

    def single(self, level: float | None) -> Row:
        """One trajectory at round-off: each side's fastest that meets the level, or the tolerance that users type."""
        request = {"task": "single", "t_end": problem.T_SINGLE, "repeats": REPEATS}
        scans = {"heyoka": self.heyoka(single=True), "liepoisson": self.ours(families.TAYLOR, single=True)}
        if level is None:
            chosen = {side: (min(scan, key=_distance_to_typed), True) for side, scan in scans.items()}
            what = f"tol = {SINGLE_TOLERANCE:g} on both sides"
        else:
            chosen = {side: calibrate.loosest(scans[side], level, level) for side in scans}
            what = f"errors at most {level:g}"
        return Row(
            f"Single trajectory at round-off, {what}: state only, t = 0..{problem.T_SINGLE:g}",
            [
                self.contender("heyoka", "heyoka", request, chosen["heyoka"]),
                # the kernel for one trajectory is the same on every processor with AVX2
                self.contender("liepoisson Taylor", "liepoisson", request, chosen["liepoisson"], kind="double"),
            ],
            problem.T_SINGLE,
        )

    def cold(self, t_end: float) -> Row:
        """From starting Python to the mean exponent of the ensemble at the tightest level."""
        request = {"task": "cold", "t_end": t_end, "batch": BATCHES["double"][-1]}
        peer = calibrate.loosest(self.heyoka(), 1e-13, 1e-13)
        ours = calibrate.loosest(self.ours(families.TAYLOR), 1e-13, 1e-13)
        variants: dict[str, dict[str, Any]] = {
            "heyoka, default flags": {},
            "heyoka, opt_level=0 (compiles faster)": {"flags": {"opt_level": 0}},
            "heyoka, code already in its disk cache": {"diskcache": str(RESULTS / "heyoka-cache")},
        }
        return Row(
            f"Cold start: new Python process to {problem.N_STARTS} exponents at t = {t_end:g}, 1e-13 level",
            [
                *(self.contender(name, "heyoka", request | extra, peer) for name, extra in variants.items()),
                self.contender("liepoisson Taylor", "liepoisson", request, ours, kind="double"),
            ],
            problem.N_STARTS * t_end,
            wall=True,
        )


def _distance_to_typed(setting: Setting) -> float:
    """How far a tolerance is from the one that a user types."""
    tol = setting.request.get("method", setting.request)["tol"]
    return abs(tol - SINGLE_TOLERANCE)


def quickest(contenders: list[Contender]) -> Contender:
    """The fastest that meets its level, by a short look; of those that do not, if none does."""
    meeting = [one for one in contenders if one.setting["meets"]] or contenders
    if len(meeting) == 1:
        return meeting[0]
    look = [Contender(one.name, one.side, one.request | {"repeats": 2}, one.setting, one.simd) for one in meeting]
    measured = measure.run_row(Row("look", look, 1.0), LOOK_ROUNDS)
    return meeting[min(range(len(meeting)), key=lambda k: min(measured[k].seconds))]
