"""Modules of folders of scripts, which are no packages: their short names meet neither each other nor the tests."""

import importlib
import sys
from pathlib import Path
from types import ModuleType


def modules_of(folder: Path, *names: str) -> list[ModuleType]:
    """These modules of `folder`, imported beside whatever else has one of its short names."""
    own = {path.stem for path in folder.glob("*.py")}
    hidden = {name: sys.modules.pop(name) for name in own if name in sys.modules}
    sys.path.insert(0, str(folder))
    try:
        return [importlib.import_module(name) for name in names]
    finally:
        sys.path.remove(str(folder))
        for name in own:
            sys.modules.pop(name, None)
        sys.modules.update(hidden)
