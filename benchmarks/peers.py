"""The other tools of Python users, once each at every level: how fast is what they use today?

A peer is scanned like everyone else, over its tolerances; since most are slow, errors are medians over fewer starts
and times are of fewer starts over a shorter time, and rates are compared.
"""

from __future__ import annotations

import subprocess
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import calibrate
import measure
import problem
from bench import RESULTS, Bench
from calibrate import Setting
from families import TAYLOR
from measure import Contender, Row

if TYPE_CHECKING:
    from reference import Extended

LEVELS = (1e-13, 1e-8, 1e-4)
TOLERANCES = [10.0 ** (-k / 4) for k in range(4, 64)]
"""Four to a decade, from 0.1 to 1.8e-16; relative and absolute alike: states and tangent vectors have size one."""
SCAN_LIMIT = 180.0
"""Seconds for the scan of one peer: a method of order 5 has step after step rejected near round-off."""
REPEATS = 3


@dataclass(frozen=True)
class Peer:
    """One tool.

    Attributes:
        side: Its worker's name.
        name: What the table calls it, with the method that it runs.
        scanned: Starts over which errors are measured.
        members: Starts of a timed run.
        t_end: Time of a timed run.
    """

    side: str
    name: str
    scanned: int
    members: int
    t_end: float


PEERS = (
    Peer("scipy", "SciPy solve_ivp, DOP853, right-hand side by Numba", 64, 8, 200.0),
    Peer("numbalsoda", "numbalsoda dop853", 512, 128, 200.0),
    Peer("diffrax", "diffrax Dopri8, vmap, CPU, float64", 512, 512, 50.0),
    Peer("jitcode", "jitcode, dop853, 18 equations", 128, 64, 200.0),
    Peer("pynamicalsys", "pynamicalsys rk45, 18 equations", 64, 16, 200.0),
)


class Peers:
    """The peers that are installed, with their errors at every tolerance."""

    def __init__(self, bench: Bench, absent: dict[str, str]) -> None:
        self.bench = bench
        self.absent = {peer.name: absent[peer.side] for peer in PEERS if peer.side in absent}
        self.scans: dict[str, list[Setting]] = {}
        for peer in PEERS:
            if peer.side not in absent:
                self._try(peer)

    def _try(self, peer: Peer) -> None:
        try:
            self.scans[peer.side] = scan(peer, self.bench.common, self.bench.exact)
        except RuntimeError as failure:
            self.absent[peer.name] = f"does not run: {str(failure).strip().splitlines()[-1]}"

    def row(self, level: float) -> Row:
        """The peers that reach a level, beside heyoka and the default method of liepoisson."""
        request: dict[str, Any] = {"task": "ensemble", "t_end": problem.T_END, "repeats": REPEATS}
        ours = calibrate.loosest(self.bench.ours(TAYLOR), level, level)
        contenders = [
            self.bench.contender("liepoisson Taylor", "liepoisson", request, ours, kind="double"),
            self.bench.heyoka_at(level, request)[0],
        ]
        absent = dict(self.absent)
        for peer in PEERS:
            if peer.side not in self.scans:
                continue
            setting, meets = calibrate.loosest(self.scans[peer.side], level, level)
            if not meets:
                absent[peer.name] = self._why_absent(peer, setting)
                continue
            asked = self.bench.common | request | {"members": peer.members, "t_end": peer.t_end} | setting.request
            shown = asdict(setting) | {"meets": meets}
            contenders.append(Contender(peer.name, peer.side, asked, shown, work=peer.members * peer.t_end))
        title = f"What other tools reach at {problem.shown(level)}"
        return Row(title, contenders, problem.N_STARTS * problem.T_END, absent=absent)

    def _why_absent(self, peer: Peer, best: Setting) -> str:
        why = f"does not reach it: errors {best.state:.1e} and {best.tangent:.1e} at best"
        n_scanned = len(self.scans[peer.side])
        if n_scanned == len(TOLERANCES):
            return why
        return f"{why}; tolerances below {TOLERANCES[n_scanned - 1]:.1e} were not tried, after {SCAN_LIMIT:g} seconds"


def scan(peer: Peer, common: dict[str, Any], exact: Extended, limit: float = SCAN_LIMIT) -> list[Setting]:
    """Errors of one peer, loosest tolerance first: at all of them, or at those for which it had the time.

    Raises:
        RuntimeError: the peer failed, or was not done with a single tolerance after `limit` seconds.
    """
    out = RESULTS / "peer-scan.npy"
    asked = {"task": "scan", "t_end": problem.T_ACCURACY, "members": peer.scanned, "tols": TOLERANCES}
    out.unlink(missing_ok=True)  # one that failed may have left some
    with suppress(subprocess.TimeoutExpired):
        measure.call(peer.side, common | asked | {"out": str(out)}, limit=limit)
    found = _arrays_of(out)
    out.unlink(missing_ok=True)
    if not found:
        raise RuntimeError(f"not done with tol = {TOLERANCES[0]:.1e} after {limit:g} seconds")
    return [_setting(tol, ends, exact[: peer.scanned]) for tol, ends in zip(TOLERANCES, found, strict=False)]


def _arrays_of(path: Path) -> list[problem.Array]:
    """All arrays that were written whole, one after the other."""
    found: list[problem.Array] = []
    if path.exists():
        with path.open("rb") as file, suppress(EOFError, ValueError, OSError):
            while True:
                found.append(np.load(file))
    return found


def _setting(tol: float, ends: problem.Array, exact: Extended) -> Setting:
    exponent = np.log(np.linalg.norm(ends[:, 9:], axis=1)) / problem.T_ACCURACY
    reached = {"state": ends[:, :9], "tangent": ends[:, 9:], "exponent": exponent}
    return calibrate.setting_of({"request": {"tol": tol}, "order": 0}, reached, exact)
