"""The audit's modules lie beside each other in verification/, which is no package."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "verification"))
