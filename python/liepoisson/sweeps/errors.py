"""How a sweep as a whole fails; pieces that fail are reported in its result."""

from __future__ import annotations

from liepoisson.errors import LiePoissonError


class SweepError(LiePoissonError):
    """A sweep that cannot go on: no scheduler, or no worker that may compute its pieces."""


class WorkerVersionError(LiePoissonError):
    """A worker has another version of liepoisson than the sweep that asks it; its bits could be others."""


class OtherSweepError(LiePoissonError):
    """A store holds the numbers of another sweep, or of another version of liepoisson."""
