"""The study of *The Twisted Top* by J.-L. Thiffeault and P. J. Morrison (2001), and what the paper says.

`study.reproduce` runs it all; `runs` says what is computed, `measurements` what is measured, `claims` has a check for
each claim of the paper, `findings` what the verdicts come to, `figures` and `report` show it.  `paper.toml` has the
claims, and the words for what is found of them.
"""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

PAPER = "J.-L. Thiffeault and P. J. Morrison, The twisted top, Physics Letters A 283 (2001) 335, arXiv:nlin/0101042"
# Caption of the paper's figure: 0.497/t + 0.113/sqrt(t) + 0.122.
PRINTED = {"lambda": 0.122, "c1": 0.113, "c0": 0.497}
_FILE = files("liepoisson.studies.twisted_top").joinpath("paper.toml")
TEXTS: dict[str, Any] = tomllib.loads(_FILE.read_text(encoding="utf-8"))
"""The tables of the file; its comments say what each is for."""
